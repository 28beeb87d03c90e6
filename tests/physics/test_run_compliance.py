"""A KR 10 whose gears give way at once under its cut: floors and walls of whole runs against J K⁻¹ Jᵀ F."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.kinematics import compliance, shift_jacobian
from gcodesim.kinematics.models import MODELS
from gcodesim.units import MM
from tests.physics.runs import Ran, height_at, run_texts

FULL = np.array(MODELS["kuka_kr10_r1100_2"].stiffness)
RESOLUTION = 0.15

CELL = """
gcodesim: 1
robots:
  arm:
    model: kuka_kr10_r1100_2
    home: [0, -90, 90, 0, 90, 0]
    stiffness: {stiffness}
    controller: {{type: ideal}}
    payload: {{mass: 3 kg, xyz: [0, 0, 60]}}
frames:
  table: {{in: world, xyz: [550, 100, 300]}}
work_offsets: {{G54: {{in: table}}}}
orientation: {{tool_axis: -Z of G54, spin: free}}
stock: {{min: [0, 0, -8], max: [16, 20, 0], in: table, material: seed_42crmo4, resolution: {resolution}}}
tools:
  1: {{type: flat_end_mill, diameter: 6, flutes: 2, helix: 30, length: 60}}
log: {{period: 4 ms}}
"""

SLOT = """G21 G90 G17 G94 G61
T1 M6
G43 H1
S2000 M3
G0 X{begin} Z5
G0 Z-{depth}
G1 X{end} F{feed}
G0 Z20
M5
M2
"""

SIDE = """G21 G90 G17 G94 G61
T1 M6
G43 H1
S2000 M3
G0 X20 Y-2 Z5
G0 Z-3
G1 X-4 F{feed}
G0 Z20
M5
M2
"""


STRAIGHT = ("-6 Y10", "20 Y10")

# begin and end of a slot whose middle is (8, 10)
SLOTS = {
    "along X": STRAIGHT,
    "against X": STRAIGHT[::-1],
    "against Y": ("8 Y24", "8 Y-6"),
    "diagonal": ("-4 Y-2", "20 Y22"),
    "at 30 degrees": ("-5.856 Y2", "21.856 Y18"),
}


def cell(stiffness: float | None, resolution: float = RESOLUTION) -> str:
    """The cell with `stiffness` times what the model ships with, None for rigid gears."""
    text = "rigid"
    if stiffness is not None:
        text = "[" + ", ".join(f"{k * stiffness:.6g}" for k in FULL) + " N·m/rad]"
    return CELL.format(stiffness=text, resolution=resolution)


def run_cut(
    folder: Path,
    program: str,
    stiffness: float | None,
    world: str,
    feed: float = 200.0,
    depth: float = 1.0,
    slot: tuple[str, str] = STRAIGHT,
    resolution: float = RESOLUTION,
) -> Ran:
    text = program.format(feed=feed, depth=depth, begin=slot[0], end=slot[1])
    ran = run_texts(text, cell(stiffness, resolution), folder, world=world)
    assert not ran.bad, [f.message for f in ran.bad]
    return ran


def cutting(ran: Ran, x: float, y: float, reach: float) -> np.ndarray:
    """Flags (n,) of the log's rows at which the commanded tip is within `reach` of (x, y) [m] of G54, and down."""
    tip = ran.column("/motion", "x_m", "y_m", "z_m")
    force = ran.column("/process", "force_n")[:, 0]
    return (np.hypot(tip[:, 0] - x, tip[:, 1] - y) < reach) & (tip[:, 2] < -0.1 * MM) & (force > 0.0)


def bend(ran: Ran, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of the log's `rows`: how far (n, 3) [m] the tip is off the command in G54, and J K⁻¹ Jᵀ of the logged wrench."""
    xyz = [f"pose.position.{axis}" for axis in "xyz"]
    moved = (ran.column("/tcp", *xyz) - ran.column("/target", *xyz))[rows]
    names = [f"{what}.{axis}" for what in ("force", "torque") for axis in "xyz"]
    wrench = ran.column("/wrench", *names)[rows]
    q = ran.column("/joint_states", *[f"joints[{i}].position" for i in range(6)])[rows]
    kinematics = ran.shop.kinematics
    tool = ran.shop.tool(1)
    assert tool is not None
    C = compliance(shift_jacobian(kinematics.jacobian(q), kinematics.forward(q), tool.X_FT.p), ran.shop.stiffness)
    return moved, np.einsum("nij,nj->ni", C[:, :3], wrench)


@pytest.mark.parametrize(
    ("world", "slot", "resolution"),
    [
        ("kinematic", "along X", 0.15),
        ("kinematic", "against X", 0.25),
        ("kinematic", "against Y", 0.5),
        ("kinematic", "diagonal", 0.5),
        ("kinematic", "at 30 degrees", 0.25),
        ("kinematic", "along X", 1.0),
        ("bullet", "along X", 0.25),
        ("bullet", "diagonal", 0.5),
    ],
)
def test_the_floor_of_a_slot_follows_the_arm(world: str, slot: str, resolution: float, tmp_path: Path) -> None:
    """Floor in the stock = floor of a rigid arm + z of J K⁻¹ Jᵀ F of the mean wrench, on any grid, in any direction."""
    cut = {"slot": SLOTS[slot], "resolution": resolution}
    soft = run_cut(tmp_path / "soft", SLOT, 1.0, world, **cut)
    rigid = run_cut(tmp_path / "rigid", SLOT, None, world, **cut)
    assert height_at(rigid, 8 * MM, 10 * MM) == pytest.approx(-1.0 * MM, abs=1e-9)
    rows = cutting(soft, 8 * MM, 10 * MM, 3 * MM)
    _, closed = bend(soft, rows)
    mean = closed[:, 2].mean()
    floor = height_at(soft, 8 * MM, 10 * MM) - height_at(rigid, 8 * MM, 10 * MM)
    assert abs(mean) > 10e-6
    assert floor == pytest.approx(mean, rel=0.02)
    # the lowest of all that passes over a place makes its floor; the arm is a little softer the farther it reaches
    assert floor == pytest.approx(closed[:, 2].min(), rel=0.002)
    ripple = closed[:, 2] - np.polyval(np.polyfit(np.arange(len(closed)), closed[:, 2], 2), np.arange(len(closed)))
    assert np.abs(ripple).max() < 1e-4 * abs(mean)


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_a_wall_gives_way_sideways(world: str, tmp_path: Path) -> None:
    """Milling along a side: the wall in the stock stands where J K⁻¹ Jᵀ F moves the cutter, within half a cell."""
    soft = run_cut(tmp_path / "soft", SIDE, 1.0, world)
    rigid = run_cut(tmp_path / "rigid", SIDE, None, world)
    for x in (6, 8, 10):
        rows = cutting(soft, x * MM, -2 * MM, 0.5 * MM)
        _, closed = bend(soft, rows)
        stands, stood = wall_at(soft, x * MM, -2 * MM), wall_at(rigid, x * MM, -2 * MM)
        assert stood == pytest.approx(1.0 * MM, abs=0.5 * RESOLUTION * MM)
        assert closed[:, 1].mean() < -RESOLUTION * MM
        assert stands == pytest.approx(1.0 * MM + closed[:, 1].mean(), abs=0.5 * RESOLUTION * MM)


def wall_at(ran: Ran, x: float, z: float) -> float:
    """Y [m] of the wall: where the material that is at height z in column row x begins."""
    (placed,) = ran.shop.stocks.values()
    stock = placed.stock
    (_, y0), (_, dy) = stock.origin, stock.spacing
    there = [
        any(low < z < high for low, high in stock.intervals_at(x, y0 + (j + 0.5) * dy))
        for j in range(stock.relief().tops.shape[1])
    ]
    return float(y0 + dy * there.index(True))  # half-way between the centres beside it


@pytest.mark.parametrize("share", [1.0, 0.3, 0.1])
@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_constant_engagement_settles_without_ringing(world: str, share: float, tmp_path: Path) -> None:
    """Every step of a slot stands at its own J K⁻¹ Jᵀ F; from step to step nothing swings to and fro."""
    ran = run_cut(tmp_path, SLOT, share, world, feed=60.0, depth=0.3)
    rows = cutting(ran, 8 * MM, 10 * MM, 4 * MM)
    moved, closed = bend(ran, rows)
    size = np.linalg.norm(closed, axis=1)
    miss = np.linalg.norm(moved - closed, axis=1) / size
    swing = (moved[2:] - 2.0 * moved[1:-1] + moved[:-2]) / 4.0  # of a bend that flips every step: its amplitude
    assert miss.max() < 0.01
    assert np.linalg.norm(swing, axis=1).mean() < 0.005 * size.mean()


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize("slot", ["along X", "against X"])
def test_a_heavy_cut_of_a_soft_arm_stands_at_its_own_bend(slot: str, world: str, tmp_path: Path) -> None:
    """A tenth of the stiffness, 1 mm of steel: the tip is off by millimetres and still where the force puts it."""
    ran = run_cut(tmp_path, SLOT, 0.1, world, slot=SLOTS[slot], resolution=0.25)
    moved, closed = bend(ran, cutting(ran, 8 * MM, 10 * MM, 5 * MM))
    size = np.linalg.norm(closed, axis=1)
    assert size.min() > 1.5 * MM
    assert (np.linalg.norm(moved - closed, axis=1) < 0.01 * size).all()

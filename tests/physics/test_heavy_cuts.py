"""Cuts that bend a machine by millimetres: every step stands at its own C F, and the tool goes on."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from gcodesim.kinematics import compliance, kinematics_of, load_urdf, shift_jacobian
from gcodesim.kinematics.models import MODELS
from gcodesim.material.stock import Stock
from gcodesim.processes.laws import Kienzle, Law, LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.processes.window import ProcessStep, Window
from gcodesim.tools import TOOLS
from gcodesim.units import DEG, MM

STEEL = Kienzle.from_table(2500.0, 0.26)
ALUMINIUM = LinearEdge.from_table(631.0, 13.0, 99.0, 10.0, 273.0, 2.8)
DT, FEED, SPINDLE = 4e-3, 200.0 * MM / 60.0, 2000.0 * 2.0 * math.pi / 60.0
LENGTH = 32e-3  # of the whole way


def arm() -> np.ndarray:
    """Compliance (6, 6) of the KR 10 with its tool pointing down."""
    model = MODELS["kuka_kr10_r1100_2"]
    kinematics = kinematics_of(load_urdf(model.path)[0])
    q = np.array([[0.0, -90.0, 90.0, 0.0, 90.0, 0.0]]) * DEG
    J = shift_jacobian(kinematics.jacobian(q), kinematics.forward(q), np.array([0.0, 0.0, 60e-3]))
    return compliance(J, np.array(model.stiffness))[0]


def gantry() -> np.ndarray:
    """Compliance (6, 6) of a weak portal: 0.4 N/µm across, 2 N/µm along the spindle."""
    C = np.zeros((6, 6))
    C[0, 0], C[1, 1], C[2, 2] = 1.0 / 4e5, 1.0 / 4e5, 1.0 / 2e6
    return C


def cut(C: np.ndarray, law: Law, begin: float, way: float, y: float, depth: float) -> tuple[ProcessStep, np.ndarray]:
    """A straight cut along X by a 6 mm end mill in a block that ends at y = 0; C F (n, 3) of its wrenches beside it."""
    return cut_along(C, law, [(begin, y), (begin + way, y)], depth)


def cut_along(
    C: np.ndarray, law: Law, corners: list[tuple[float, ...]], depth: float, cell: float = 0.5e-3, dt: float = DT
) -> tuple[ProcessStep, np.ndarray]:
    """The same along straight lines between `corners` (x, y) or (x, y, z) [m], which are passed at full feed."""
    ends = np.array([(*corner, -depth)[:3] for corner in corners])
    parts = [ends[:1]]
    for a, b in itertools.pairwise(ends):
        n = round(float(np.linalg.norm(b - a)) / (FEED * dt))
        parts.append(a + np.linspace(0.0, 1.0, n + 1)[1:, None] * (b - a))
    points = np.concatenate(parts)
    n = len(points) - 1
    process = Milling(cutter=TOOLS["flat_end_mill"](number=1, diameter=6e-3, length=60e-3), law=law)
    window = Window(
        piece_start=points[:-1],
        piece_end=points[1:],
        piece_step=np.arange(n),
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        velocity=np.diff(points, axis=0) / dt,
        rapid=np.zeros(n, dtype=bool),
        signals={"spindle": np.full(n, SPINDLE), "active": np.zeros(n, dtype=bool)},
        dt=dt,
        compliance=np.tile(C, (n, 1, 1)),
    )
    stock = Stock.box((0.0, 0.0, -12e-3), (44e-3, 40e-3, 0.0), cell)
    found = process.run(stock, window, process.begin())
    return found, np.einsum("ij,nj->ni", C[:3], found.wrench)


@pytest.mark.parametrize("share", [1.0, 0.3, 0.1])
@pytest.mark.parametrize("machine", [arm, gantry])
@pytest.mark.parametrize("law", [STEEL, ALUMINIUM])
@pytest.mark.parametrize(("begin", "way"), [(-4e-3, LENGTH), (48e-3, -LENGTH)])
@pytest.mark.parametrize("y", [20e-3, -1e-3])
def test_every_step_stands_at_its_own_bend(
    y: float, begin: float, way: float, law: Law, machine: object, share: float
) -> None:
    """Slots (y = 20 mm) and shoulders 2 mm wide, both ways, 1 mm deep, down to a tenth of the stiffness."""
    assert callable(machine)
    found, closed = cut(machine() / share, law, begin, way, y, 1e-3)
    size = np.linalg.norm(closed, axis=1)
    miss = np.linalg.norm(found.deflection - closed, axis=1)
    swing = np.linalg.norm(found.deflection[2:] - 2.0 * found.deflection[1:-1] + found.deflection[:-2], axis=1) / 4.0
    late = slice(len(size) * 5 // 6, None)

    assert size[late].min() > 10e-6
    at_balance = miss <= 0.01 * size + 0.5e-6
    first = int(np.flatnonzero(size)[0])
    at_balance[first : first + 3] = True  # it comes to the block, and is flung off: for some steps all of it changes
    if y < 0.0 and size.max() > 2e-3:
        # a shoulder that bends the machine by more than its own width slips aside, and back: no balance meanwhile
        assert at_balance.mean() > 0.85
        return
    # a slot that bends it by a quarter of the tool: it moves off its own walls as it enters, and back
    assert at_balance.mean() > 0.985 if size.max() > 1.5e-3 else at_balance.all()
    assert swing[len(swing) * 5 // 6 :].max() < 1e-3 * size[late].mean()
    # it has come as far as its feed, but for what it is bent
    assert np.ptp(found.deflection[late, 0]) < 0.1 * LENGTH / 6.0


def test_a_tool_that_is_pushed_back_cuts_thinner_chips() -> None:
    """While the bend of a slot grows, the chip is feed less retreat; Kienzle's force follows it."""
    found, _ = cut(arm() / 0.3, STEEL, -4e-3, LENGTH, 20e-3, 1e-3)
    retreat = np.diff(found.deflection[:, 0]) / (FEED * DT)
    full = FEED * math.pi / SPINDLE  # feed per tooth of two
    busy = np.flatnonzero(found["chip_thickness"][1:] > 0.2 * found["chip_thickness"].max())

    assert found["chip_thickness"][-1] == pytest.approx(full, rel=2e-3)
    assert retreat[busy].min() < -0.2
    assert found["chip_thickness"][1:][busy] / full == pytest.approx(1.0 + retreat[busy], abs=0.05)


def test_a_slot_in_a_soft_arm_settles_at_the_balance_of_depth_and_bend() -> None:
    """Force is proportional to depth and depth gives way with force: bend z = -k (ap - bend z)."""
    C = arm()
    _, stiff = cut(C * 1e-3, STEEL, -4e-3, 1.25 * LENGTH, 20e-3, 1e-3)
    gain = 1e3 * stiff[-1] / 1e-3  # bend over depth of cut
    for share in (1.0, 0.3, 0.1):
        found, closed = cut(C / share, STEEL, -4e-3, 1.25 * LENGTH, 20e-3, 1e-3)
        depth = 1e-3 / (1.0 + gain[2] / share)
        assert closed[-1] == pytest.approx(gain / share * depth, rel=0.02)
        assert found["axial_depth"][-1] == pytest.approx(depth, rel=0.02)


@pytest.mark.parametrize("share", [1.0, 0.3])
@pytest.mark.parametrize("machine", [arm, gantry])
@pytest.mark.parametrize("turn", [-45.0, -90.0, -135.0])
def test_a_tool_that_is_bent_goes_round_a_corner(turn: float, machine: object, share: float) -> None:
    """The bend swings round with the force by cutting its way, not from one step to the next; then all is as on a
    straight line in the new direction."""
    assert callable(machine)
    C = machine() / share
    corner = (22e-3, 24e-3)
    end = (corner[0] + 16e-3 * math.cos(turn * DEG), corner[1] + 16e-3 * math.sin(turn * DEG))
    found, closed = cut_along(C, STEEL, [(-4e-3, 24e-3), corner, end], 1e-3, 0.25e-3)
    n = round(26e-3 / (FEED * DT))
    size, miss = np.linalg.norm(closed, axis=1), np.linalg.norm(found.deflection - closed, axis=1)
    swing = np.linalg.norm(np.diff(found.deflection, axis=0), axis=1)[n - 1 :] / (FEED * DT)
    force = np.linalg.norm(found.wrench[:, :3], axis=1)

    assert size[n - 1] > 5.0 * FEED * DT  # it has something to swing round
    assert swing.max() < 3.0
    assert found["removed"][n:].max() < 8.0 * found["removed"][n - 100 : n].mean()
    assert force[n:].max() < 2.5 * max(force[n - 1], force[-1])
    assert (miss <= 0.01 * size + 0.5e-6).mean() > 0.99
    before = (corner[0] - 40e-3 * math.cos(turn * DEG), corner[1] - 40e-3 * math.sin(turn * DEG))
    straight, _ = cut_along(C, STEEL, [before, end], 1e-3, 0.25e-3)
    assert found.wrench[-1, :3] == pytest.approx(straight.wrench[-1, :3], rel=0.03, abs=0.01 * force[-1])


@pytest.mark.parametrize("machine", [arm, gantry])
@pytest.mark.parametrize("turn", [-45.0, -90.0, -135.0])
def test_the_force_behind_a_corner_hardly_depends_on_the_step(turn: float, machine: object) -> None:
    """A bend that swings round is seen at each rate: finer steps move the greatest force by less and less."""
    assert callable(machine)
    corner = (8e-3, 12e-3)
    end = (corner[0] + 4e-3 * math.cos(turn * DEG), corner[1] + 4e-3 * math.sin(turn * DEG))
    greatest = []
    for part in (4, 2, 1, 0.5):
        found, _ = cut_along(machine(), ALUMINIUM, [(-4e-3, 12e-3), corner, end], 2e-3, 0.25e-3, part * DT)
        greatest.append(np.linalg.norm(found.wrench[:, :3], axis=1).max())

    assert greatest[1] == pytest.approx(greatest[3], rel=0.25)
    assert greatest[2] == pytest.approx(greatest[3], rel=0.06)


def test_a_cut_after_a_plunge_begins_in_its_own_direction() -> None:
    """Where the tool came from before it went down does not matter."""
    top, bottom, end = (24e-3, 20e-3, 1e-3), (24e-3, 20e-3, -1e-3), (24e-3, 26e-3, -1e-3)
    steps = round(6e-3 / (FEED * DT))
    wrenches = []
    for start in ((20e-3, 20e-3, 1e-3), (28e-3, 20e-3, 1e-3), (24e-3, 16e-3, 1e-3)):
        found, _ = cut_along(arm() / 0.3, STEEL, [start, top, bottom, end], 1e-3, 0.25e-3)
        wrenches.append(found.wrench[-steps:, :3])

    scale = np.linalg.norm(wrenches[0], axis=1).max()
    for other in wrenches[1:]:
        assert np.abs(other - wrenches[0]).max() < 0.02 * scale

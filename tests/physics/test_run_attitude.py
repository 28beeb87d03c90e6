"""A tool that leans as the program says: the same part on five-axis machines and on an arm."""

from __future__ import annotations

from functools import cache
from math import cos, radians, sin
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.regress.surfaces import compare_stocks
from gcodesim.simulation import Job, Options, prepare
from gcodesim.units import MM
from tests.physics.runs import Ran, run_texts

RESOLUTION = 0.8  # mm
LINEAR = """
    X: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}
    Y: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}
    Z: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2, home: 250 mm}"""
STOCK = f"""
stock: {{min: [-22, -22, -20], max: [22, 22, 0], in: G54, material: al6082_t6, resolution: {RESOLUTION}}}
tools:
  1: {{type: ball_end_mill, diameter: 8, flutes: 2, length: 60}}
"""
TRUNNION = f"""gcodesim: 1
dialect: fanuc
machine:
  axes:{LINEAR}
    A: {{travel: [-100, 100 deg], speed: 180 deg/s, acceleration: 900 deg/s^2, at: [0, 0, -120 mm]}}
    C: {{travel: unlimited, speed: 360 deg/s, acceleration: 1800 deg/s^2, at: [0, 0, -120 mm]}}
work_offsets: {{G54: {{xyz: [0, 0, -100 mm]}}}}{STOCK}"""
HEAD_TABLE = f"""gcodesim: 1
dialect: fanuc
machine:
  axes:{LINEAR}
    B: {{travel: [-100, 100 deg], speed: 180 deg/s, acceleration: 900 deg/s^2, side: tool, at: [0, 0, 150 mm]}}
    C: {{travel: unlimited, speed: 360 deg/s, acceleration: 1800 deg/s^2, at: [30, 0, -120 mm]}}
work_offsets: {{G54: {{xyz: [20, 10, -100 mm]}}}}{STOCK}"""
ARM = f"""gcodesim: 1
dialect: fanuc
robots:
  arm: {{model: kuka_kr10_r1100_2, stiffness: rigid}}
work_offsets: {{G54: {{in: world, xyz: [560, 30, 330]}}}}{STOCK}"""


def ring() -> str:
    """A ring with the tool leaning outwards, in vectors 10 deg apart, and a slot to the middle that turns upright."""
    lines = ["%", "O1", "G21 G90 G49 G94 G54", "T1 M6", "S12000 M3", "G43.5 H1", "G0 Z40. I0. J0. K1."]
    lean = radians(35.0)
    for number, angle in enumerate(range(0, 361, 10)):
        c, s = cos(radians(angle)), sin(radians(angle))
        vector = f"I{sin(lean) * c:.6f} J{sin(lean) * s:.6f} K{cos(lean):.6f}"
        x, y = 14.0 * c, 14.0 * s
        if number == 0:
            lines.append(f"G0 X{x:.4f} Y{y:.4f} Z10. {vector}")
        lines.append(f"G1 X{x:.4f} Y{y:.4f} Z-3. {vector}" + (" F3000." if number == 0 else ""))
    lines += ["G1 X0. Y0. Z-2. I0. J0. K1.", "G0 Z40.", "G49", "M5", "M30", "%"]
    return "\n".join(lines) + "\n"


@cache
def ran(cell: str) -> Ran:
    found = run_texts(ring(), cell)
    bad = [f for f in found.bad if f.code != "GS204"]  # an arm may slow down: the part is the same
    assert not bad, [f.message for f in bad]
    return found


def stock_of(cell: str):  # type: ignore[no-untyped-def]
    (placed,) = ran(cell).shop.stocks.values()
    return placed.stock


@pytest.mark.parametrize("other", [HEAD_TABLE, ARM], ids=["head and table", "arm"])
def test_vectors_give_the_same_part_on_every_machine(other: str) -> None:
    """The trunnion's part; between two blocks rotary axes and directions differ by far less than a cell."""
    one, two = stock_of(TRUNNION), stock_of(other)

    assert ran(TRUNNION).stock.removed > 1500.0 * MM**3
    assert compare_stocks("stock", one, two, RESOLUTION) is None
    assert ran(other).stock.removed == pytest.approx(ran(TRUNNION).stock.removed, rel=0.01)


def planned(program: str, cell: str) -> tuple[np.ndarray, Job]:
    """Poses X_PT of the tip in G54 at the ends of all feeds, and the job; every block ends at rest."""
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.nc", program.encode()), loaded, Options(world="kinematic"))
    plan, shop = job.plan, job.shop
    assert plan is not None and shop is not None
    feeds = np.flatnonzero(np.isfinite(plan.path.feed))
    tips = shop.X_WB.matrix @ plan.tip(plan.joints(plan.trajectory.sample(plan.trajectory.row_end[feeds])), feeds)
    return np.linalg.inv(shop.placement.X_W("G54").matrix) @ tips, job


def test_the_tool_of_an_arm_leans_along_the_vector() -> None:
    """At the end of every block tip and direction are as written."""
    X_PT, _ = planned(ring().replace("G94 G54", "G94 G54 G61"), ARM)
    angles = np.radians(np.arange(0, 361, 10))
    lean = radians(35.0)
    axes = np.column_stack([np.sin(lean) * np.cos(angles), np.sin(lean) * np.sin(angles), np.full(37, np.cos(lean))])
    ends = np.column_stack([14.0 * np.cos(angles), 14.0 * np.sin(angles), np.full(37, -3.0)]) * MM

    assert len(X_PT) == 38
    assert np.abs(-X_PT[:37, :3, 2] - axes).max() < 2e-6  # vectors have six decimals
    assert np.abs(X_PT[:37, :3, 3] - ends).max() < 1e-6  # the control counts in thousandths of a millimetre
    assert np.abs(X_PT[37, :3, 2] - [0.0, 0.0, -1.0]).max() < 1e-9


@pytest.mark.parametrize("words", ["Z(A) Y(B) X(C)", "Z(-C) X(-A)", "X(A) Y(B) Z(C)", "Z(A) X(B) Z(C)"])
@pytest.mark.parametrize("rpy", ["[0, 0, 0]", "[25 deg, -10 deg, 0]"], ids=["upright", "leaning"])
def test_a_vector_leans_the_tool_by_the_words_of_the_cell(words: str, rpy: str) -> None:
    """Whatever turns A, B and C are to the cell: those that G43.5 chooses point the tool along I J K of the system."""
    placed = ARM.replace("xyz: [560, 30, 330]", f"xyz: [560, 30, 330], rpy: {rpy}")
    X_PT, _ = planned(ring().replace("G94 G54", "G94 G54 G61"), placed + f"orientation: {{words: {words}}}\n")
    angles = np.radians(np.arange(0, 361, 10))
    lean = radians(35.0)
    axes = np.column_stack([np.sin(lean) * np.cos(angles), np.sin(lean) * np.sin(angles), np.full(37, np.cos(lean))])

    assert len(X_PT) == 38
    assert np.abs(-X_PT[:37, :3, 2] - axes).max() < 2e-6
    assert np.abs(X_PT[37, :3, 2] - [0.0, 0.0, -1.0]).max() < 1e-6


def test_words_that_cannot_lean_the_tool_along_a_vector_are_an_error_at_the_vector() -> None:
    program = ring()
    _, job = planned(program, ARM + "orientation: {words: Z(A) X(B), tool_axis: -X of G54}\n")
    assert next((f.span.line, f.message) for f in job.findings if f.code == "GS106") == (
        7,
        "A and B cannot bring the tool along this vector",
    )


WORDS = """gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2}
work_offsets: {G54: {in: world, xyz: [560, 30, 330], rpy: [0, 0, 40 deg]}}
orientation: {words: %s}
tools:
  1: {type: ball_end_mill, diameter: 8, flutes: 2, length: 60}
"""
TURNED = "G21 G90 G61\nT1 M6\nG0 X0 Y0 Z40\nG1 X20 Z10 A20 B-15 C10 F2000\nG1 X0 A-12 B8 C30\n"


@pytest.mark.parametrize("begin", ["", "M428\n"], ids=["plain", "tip"])
@pytest.mark.parametrize(
    ("words", "order"), [("Z(A) Y(B) X(C)", "ZYX"), ("x(a) y(b) z(c)", "XYZ"), ("Z(A) X(B) Z(C)", "ZXZ")]
)
def test_words_lean_the_tool_by_the_convention_of_the_cell(words: str, order: str, begin: str) -> None:
    """Three turns fix the tool completely: SciPy's intrinsic angles in the same order."""
    X_PT, _ = planned(begin + TURNED + "M2\n", WORDS % words)
    upright = np.diag([1.0, -1.0, -1.0])
    for pose, angles in zip(X_PT, ([20, -15, 10], [-12, 8, 30]), strict=True):
        want = Rotation.from_euler(order, angles, degrees=True).as_matrix() @ upright
        assert np.abs(pose[:3, :3] - want).max() < 1e-9
    assert np.abs(X_PT[:, :3, 3] - [[0.02, 0.0, 0.01], [0.0, 0.0, 0.01]]).max() < 1e-9


def test_words_of_a_machine_lean_the_tool_as_that_machine_would() -> None:
    """`Z(-C) X(-A)` is a trunnion: the tool of the arm points where the trunnion's does, seen from the work."""
    program = "G21 G90 G61\nT1 M6\nM428\nG0 X0 Y0 Z40 A0 C0\nG1 X10 Z5 A30 C50 F2000\nG1 X0 A-20 C-110\nM2\n"
    arm, _ = planned(program, WORDS % "Z(-C) X(-A)")
    _, job = planned(program, TRUNNION.replace("dialect: fanuc\n", ""))
    plan = job.plan
    assert plan is not None and job.shop is not None
    feeds = np.flatnonzero(np.isfinite(plan.path.feed))
    q = plan.joints(plan.trajectory.sample(plan.trajectory.row_end[feeds]))
    seen = np.linalg.inv(job.shop.kinematics.table(q)) @ plan.tip(q, feeds)

    assert np.abs(arm[:, :3, 2] - seen[:, :3, 2]).max() < 1e-9


def test_a_word_that_leans_nothing_is_reported() -> None:
    _, job = planned(TURNED + "M2\n", WORDS % "Z(C) X(A)")

    assert [(f.code, f.span.line) for f in job.findings if f.code == "GS207"] == [("GS207", 4)]


@pytest.mark.parametrize("words", ["Z(A) Y(A)", "Q(A)", "ZYX", "X(A) Y(B) Z(C) X(A)"])
def test_words_that_are_no_turns_are_a_fault_of_the_cell(words: str) -> None:
    loaded = read_cell(SourceText("cell.yaml", (WORDS % words).encode()), Path("cell.yaml"))

    assert loaded.cell is None
    assert [(f.code, f.span.line) for f in loaded.findings] == [("GS711", 5)]

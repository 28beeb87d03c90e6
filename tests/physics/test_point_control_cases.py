"""Drawn programs with vectors (G43.5) and inverse time (G93) on five axes, against closed forms written here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import Job, Options, prepare
from gcodesim.units import MM

LENGTH = 60.0  # mm
LINEAR = "{travel: [-900, 900 mm], speed: 60 m/min, acceleration: 8 m/s^2}"
TURNS = "travel: unlimited, speed: 720 deg/s, acceleration: 7200 deg/s^2"


def cell(a: np.ndarray, c: np.ndarray, zero: np.ndarray) -> str:
    """A trunnion with the axes A and C through two points [mm], and G54 at a third."""
    return f"""gcodesim: 1
dialect: fanuc
machine:
  axes:
    X: {LINEAR}
    Y: {LINEAR}
    Z: {LINEAR}
    A: {{{TURNS}, at: {a.tolist()}}}
    C: {{{TURNS}, at: {c.tolist()}}}
work_offsets: {{G54: {{xyz: {zero.tolist()}}}}}
tools:
  1: {{type: ball_end_mill, diameter: 8, flutes: 2, length: {LENGTH:g} mm}}
"""


def planned(lines: list[str], text: str) -> tuple[Job, np.ndarray, np.ndarray]:
    """The job, and of all feeds the joints (n, 5) at their ends and when they begin and end (n, 2) [s]."""
    program = "\n".join(["%", "O1", "G21 G90 G49 G94 G54 G61", "T1 M6", *lines, "G49", "M30", "%", ""])
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.nc", program.encode()), loaded, Options(world="kinematic"))
    assert job.plan is not None and not [f for f in job.findings if f.level.name == "ERROR"], job.findings
    trajectory, feeds = job.plan.trajectory, np.flatnonzero(np.isfinite(job.plan.path.feed))
    ends = trajectory.row_end[feeds]
    return job, job.plan.joints(trajectory.sample(ends)), np.column_stack([trajectory.row_start[feeds], ends])


def drawn_vectors(random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Points (25, 3) [mm] and directions (25, 3) of the upper half, and blocks that go there."""
    points = random.uniform(-40.0, 40.0, (25, 3)).round(3)
    vectors = random.normal(size=(25, 3))
    vectors[:, 2] = np.abs(vectors[:, 2])
    vectors = (vectors / np.linalg.norm(vectors, axis=1)[:, None]).round(6)
    blocks = [
        "G1 X{:.3f} Y{:.3f} Z{:.3f} I{:.6f} J{:.6f} K{:.6f} F4000.".format(*point, *vector)
        for point, vector in zip(points, vectors, strict=True)
    ]
    return points, vectors, blocks


@pytest.mark.parametrize("seed", range(4))
def test_vectors_on_a_table_whose_axes_lie_anywhere(seed: int) -> None:
    """At joints X Y Z A C the work is turned by Rz(C) about `c`, then by Rx(A) about `a`; the tool hangs from X Y Z."""
    random = np.random.default_rng(seed)
    a, c, zero = random.uniform(-60.0, 60.0, (3, 3)).round(2)
    points, vectors, blocks = drawn_vectors(random)

    _, joints, _ = planned(["G43.5 H1", *blocks], cell(a, c, zero))

    turn_a = Rotation.from_rotvec(np.outer(joints[:, 3], [1, 0, 0]))
    turn_c = Rotation.from_rotvec(np.outer(joints[:, 4], [0, 0, 1]))
    tips = joints[:, :3] / MM - [0.0, 0.0, LENGTH]
    assert np.abs(turn_a.apply(turn_c.apply(vectors)) - [0, 0, 1]).max() < 3e-6
    work = turn_a.apply(turn_c.apply(points + zero - c) + c - a) + a
    assert np.abs(work - tips).max() < 1.5e-3  # the control counts in thousandths


@pytest.mark.parametrize("seed", range(3))
def test_vectors_on_a_head_whose_axis_leans_by_half_a_right_angle(seed: int) -> None:
    """The head turns about (0, 1, 1) through `b`, the table by Rz(C) about `c`; both right-handed."""
    random = np.random.default_rng(seed)
    b, c, zero = random.uniform(-60.0, 60.0, (3, 3)).round(2)
    points, vectors, blocks = drawn_vectors(random)
    text = cell(b, c, zero).replace("    A: {", "    B: {side: tool, direction: [0, 1, 1], ")

    _, joints, _ = planned(["G43.5 H1", *blocks], text)

    turn_b = Rotation.from_rotvec(np.outer(joints[:, 3], [0.0, 0.5**0.5, 0.5**0.5]))
    turn_c = Rotation.from_rotvec(np.outer(joints[:, 4], [0, 0, 1]))
    tips = joints[:, :3] / MM + b + turn_b.apply(np.array([0.0, 0.0, -LENGTH]) - b)
    assert np.abs(turn_c.apply(vectors) - turn_b.apply([0.0, 0.0, 1.0])).max() < 3e-6
    assert np.abs(turn_c.apply(points + zero - c) + c - tips).max() < 1.5e-3


@pytest.mark.parametrize("leans", [False, True], ids=["axes", "tip"])
def test_a_block_of_inverse_time_takes_it_whatever_moves(leans: bool) -> None:
    """60 / F seconds for straight, rotary and mixed blocks; standing at both ends adds what the slowest axis ramps."""
    random = np.random.default_rng(14)
    wanted = random.uniform(2.0, 9.0, 12).round(2)
    words = random.uniform(-40.0, 40.0, (12, 5)).round(3)
    blocks = []
    for number, (x, y, z, tilt, turn) in enumerate(words):
        place, angles = f"X{x:.3f} Y{y:.3f} Z{z:.3f}", f"A{tilt:.3f} C{turn:.3f}"
        said = (place, angles, f"{place} {angles}")[number % 3]
        blocks.append(f"G1 {said} F{60.0 / wanted[number]:.6f}")
    head = ["G43.4 H1"] if leans else ["G43 H1"]

    zero, a, c = np.zeros(3), np.array([0.0, 5.0, -40.0]), np.array([10.0, 0.0, -60.0])
    _, _, times = planned([*head, "G93", *blocks, "G94"], cell(a, c, zero))

    taken = times[:, 1] - times[:, 0]
    assert np.all(taken > wanted - 1e-3)
    assert np.all(taken < wanted + 0.06)


def test_the_shipped_trunnion_turns_both_its_axes() -> None:
    """Its axes of `robots/facts.md`: A through Y20 Z-60, C through zero; vectors, and a plane that G53.1 turns to."""
    random = np.random.default_rng(3)
    _, vectors, blocks = drawn_vectors(random)
    steep = [block for block, vector in zip(blocks, vectors, strict=True) if vector[2] > 0.85]
    text = (
        "gcodesim: 1\ndialect: fanuc\nmachine: mill_xyzac_trunnion\nwork_offsets: {G54: {xyz: [0, 0, 150]}}\n"
        f"tools: {{1: {{type: ball_end_mill, diameter: 8, length: {LENGTH:g}}}}}\n"
    )

    _, joints, _ = planned(["G43.5 H1", *steep], text)
    _, upright, _ = planned(["G68.2 X0 Y0 Z10. I30. J25. K0", "G53.1", "G1 X0 Y0 Z20. F900.", "G69"], text)

    turned = Rotation.from_rotvec(np.outer(joints[:, 3], [1, 0, 0])) * Rotation.from_rotvec(
        np.outer(joints[:, 4], [0, 0, 1])
    )
    assert np.abs(turned.apply(vectors[vectors[:, 2] > 0.85]) - [0, 0, 1]).max() < 3e-6
    normal = Rotation.from_euler("ZX", [30.0, 25.0], degrees=True).apply([0, 0, 1])
    a, c = upright[-1, 3:]
    assert np.abs(Rotation.from_euler("zx", [c, a]).apply(normal) - [0, 0, 1]).max() < 3e-6

"""G68.2 in all its forms with G53.1: tip and tool axis in the work, on three machines, against closed forms."""

from __future__ import annotations

from pathlib import Path
from random import Random

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import Options, prepare

TOOL = "tools: {1: {type: ball_end_mill, diameter: 8, flutes: 2, length: 60}}\n"
LINEAR = "".join(
    f"    {letter}: {{travel: [-900, 900 mm], speed: 30 m/min, acceleration: 4 m/s^2}}\n" for letter in "XYZ"
)
TABLE = "    C: {travel: unlimited, speed: 180 deg/s, at: [10, 20, -100 mm]}\n"
MILL = "gcodesim: 1\ndialect: fanuc\nwork_offsets: {G54: {xyz: [30, -20, -90 mm]}}\n" + TOOL + "machine:\n  axes:\n"
MACHINES = {
    "trunnion": MILL + LINEAR + "    A: {travel: [-120, 120 deg], speed: 90 deg/s, at: [10, 20, -120 mm]}\n" + TABLE,
    "head and table": MILL
    + LINEAR
    + "    B: {travel: [-120, 120 deg], speed: 90 deg/s, side: tool, at: [0, 0, 150 mm]}\n"
    + TABLE,
    "arm": "gcodesim: 1\ndialect: fanuc\nrobots: {arm: {model: kuka_kr10_r1100_2}}\n"
    'work_offsets: {G54: {in: world, xyz: [600, 0, 300]}}\norientation: {words: "Z(-C) X(-A)"}\n' + TOOL,
}
FORMS = ("euler", "roll pitch yaw", "points", "vectors", "projection")


def turn(axis: int, degrees: float) -> np.ndarray:
    """The rotation about X, Y or Z (0, 1, 2)."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    R = np.eye(3)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    R[j, j], R[j, k], R[k, j], R[k, k] = c, -s, s, c
    return R


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v)


def plane(form: str, rng: Random) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Blocks of G68.2, the zero of the plane [mm] and its axes as columns."""
    zero = np.array([round(rng.uniform(-15, 15), 3) for _ in range(3)])
    at = "X{:.3f} Y{:.3f} Z{:.3f}"
    a, b, c = (round(rng.uniform(-most, most), 3) for most in (25, 25, 180))
    if form == "euler":
        R = turn(2, c) @ turn(0, b) @ turn(2, a)
        return [f"G68.2 {at.format(*zero)} I{c} J{b} K{a}"], zero, R
    if form == "roll pitch yaw":
        order = rng.choice(("123", "321", "213", "231", "312", "132"))
        turns = {"1": turn(0, a), "2": turn(1, b), "3": turn(2, c)}
        R = turns[order[2]] @ turns[order[1]] @ turns[order[0]]
        return [f"G68.2 P1 Q{order} {at.format(*zero)} I{a} J{b} K{c}"], zero, R
    if form == "projection":
        first = np.array([np.cos(np.radians(a)), 0.0, -np.sin(np.radians(a))])
        normal = unit(np.cross(first, [0.0, np.cos(np.radians(b)), np.sin(np.radians(b))]))
        R = np.column_stack([first, np.cross(normal, first), normal]) @ turn(2, c)
        return [f"G68.2 P4 {at.format(*zero)} I{a} J{b} K{c}"], zero, R
    R = turn(2, c) @ turn(0, b) @ turn(2, a)
    if form == "vectors":
        words = ["I{:.6f} J{:.6f} K{:.6f}".format(*R[:, k]) for k in (0, 2)]
        return [f"G68.2 P3 Q1 {at.format(*zero)} {words[0]}", f"G68.2 P3 Q2 {words[1]}"], zero, R
    second, third = (np.round(zero + v, 3) for v in (11.0 * R[:, 0], 3.0 * R[:, 0] + 9.0 * R[:, 1]))
    along, normal = unit(second - zero), unit(np.cross(second - zero, third - zero))
    blocks = [f"G68.2 P2 Q{k + 1} {at.format(*point)}" for k, point in enumerate((zero, second, third))]
    return blocks, zero, np.column_stack([along, np.cross(normal, along), normal])


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize("form", FORMS)
def test_the_tip_runs_in_the_plane_and_the_tool_stands_on_it(form: str, machine: str) -> None:
    rng = Random(f"{form} {machine}")
    blocks, zero, R = plane(form, rng)
    points = np.array([[round(rng.uniform(-10, 10), 3) for _ in range(3)] for _ in range(3)])
    head = ["%", "O1", "G21 G17 G90 G94 G61", "T1 M6", "G43 H1", "G0 X0. Y0. Z60.", *blocks, "G53.1"]
    feeds = ["G1 X{:.3f} Y{:.3f} Z{:.3f} F500.".format(*point) for point in points]
    text = "\n".join([*head, *feeds, "G69", "G49", "M30", "%", ""])
    loaded = read_cell(SourceText("cell.yaml", MACHINES[machine].encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.nc", text.encode()), loaded, Options(world="kinematic"))
    plan, shop = job.plan, job.shop
    assert plan is not None and shop is not None and not [f.code for f in job.findings if f.level.word == "error"]
    lines = range(len(head) + 1, len(head) + 4)
    rows = [row for row in range(len(plan.path)) if plan.path.span(row).line in lines]
    samples = plan.trajectory.sample(plan.trajectory.row_end[rows] - 1e-9)
    q = plan.joints(samples)
    X_WB = shop.X_WB.matrix
    X_WG = shop.placement.X_W("G54").matrix
    carried = shop.kinematics.table(q) if shop.mover.joints_are_axes else np.eye(4)[None]
    X = np.linalg.inv(np.linalg.inv(X_WB) @ X_WG) @ np.linalg.inv(carried) @ plan.tip(q, samples.row)

    assert X[:, :3, 3] * 1e3 == pytest.approx(zero + points @ R.T, abs=1e-4 if form == "vectors" else 1e-9)
    assert -X[:, :3, 2] == pytest.approx(np.tile(R[:, 2], (3, 1)), abs=1e-6 if form == "vectors" else 1e-12)

"""Tip and axes of five-axis machines, against the joints that LinuxCNC's formulas give."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gcodesim.canon import AXIS_LETTERS
from gcodesim.frames import Array
from gcodesim.kinematics.cartesian import Axis, Cartesian, chain_of_axes
from gcodesim.kinematics.tool_point import ToolPoint

DATA = Path(__file__).parents[2] / "data" / "five_axis"
PIVOT = (0.0, 0.0, 0.160)


def machine(*rotary: Axis) -> ToolPoint:
    axes = [Axis(letter="X"), Axis(letter="Y"), Axis(letter="Z"), *rotary]
    found = ToolPoint.of(Cartesian(chain=chain_of_axes(axes)))
    assert found is not None
    return found


def axis(letter: str, point: tuple[float, float, float] = (0.0, 0.0, 0.0), **more: Any) -> Axis:
    return Axis(letter=letter, point=point, **more)


TRUNNION = machine(axis("A", (0.0, 0.0, -0.020)), axis("C"))  # xyzac-trt-kins
HEAD_TABLE = machine(axis("C", vector=(0, 0, -1)), axis("B", PIVOT, side="tool", vector=(0, -1, 0)))  # maxkins
HEAD_HEAD = machine(axis("C", PIVOT, side="tool"), axis("B", PIVOT, side="tool", vector=(0, -1, 0)))  # 5axiskins
NUTATING = machine(axis("C", (0.01, 0.02, -0.1)), axis("B", (0.0, 0.0, 0.2), side="tool", vector=(0, 1, 1)))
NUTATING_TABLE = machine(axis("B", (0.0, 0.0, -0.2), vector=(0, 1, 1)), axis("C", (0.1, 0.0, -0.1)))
OFFSET = machine(axis("A", (0.1, -0.05, -0.3)), axis("C", (0.13, 0.01, -0.25)))
MACHINES = {
    "trunnion": TRUNNION,
    "head_table": HEAD_TABLE,
    "head_head": HEAD_HEAD,
    "nutating": NUTATING,
    "nutating_table": NUTATING_TABLE,
    "offset": OFFSET,
}
CORPUS = {"ac": (TRUNNION, "ac", 0.0), "head": (HEAD_TABLE, "bc", 0.060), "headhead": (HEAD_HEAD, "bc", 0.060)}


def columns(name: str, *wanted: str) -> Array | None:
    rows = list(csv.DictReader((DATA / f"{name}.csv").open()))
    if wanted[0] not in rows[0]:
        return None
    return np.array([[float(row[column]) for column in wanted] for row in rows])


@pytest.mark.parametrize("key", CORPUS)
@pytest.mark.parametrize("name", ["dome", "blade", "tilted_pockets"])
def test_joints_are_those_of_linuxcnc(name: str, key: str) -> None:
    """Columns have six decimals of a millimetre; the pivot of a head lies at Z 0 of LinuxCNC's joints."""
    tool, letters, length = CORPUS[key]
    told = columns(name, *(f"{key}_{letter}" for letter in f"xyz{letters}"))
    if told is None:
        return
    tip, direction = columns(name, "tip_x", "tip_y", "tip_z"), columns(name, "axis_i", "axis_j", "axis_k")
    assert tip is not None and direction is not None
    points, offset = np.zeros((len(told), 6)), np.zeros((len(told), 3))
    points[:, :3], offset[:, 2] = tip * 1e-3, length
    points[:, [AXIS_LETTERS.index(letter.upper()) for letter in letters]] = np.radians(told[:, 3:])

    q = tool.joints(points, offset)

    found = q[:, tool.linear] * 1e3
    found[:, 2] -= length * 1e3  # LinuxCNC's Z of these files is that of the tip at zero
    np.testing.assert_allclose(found, told[:, :3], atol=5e-6)
    np.testing.assert_allclose(tool.directions(q), direction, atol=2e-6)
    np.testing.assert_allclose(tool.points(q, offset), points, atol=1e-12)


@pytest.mark.parametrize("name", MACHINES)
def test_both_branches_reach_the_direction(name: str) -> None:
    tool, rng = MACHINES[name], np.random.default_rng(5)
    for _ in range(50):
        q = np.zeros((1, len(tool.kinematics.joints)))
        q[0, tool.rotary] = rng.uniform(-3.0, 3.0, 2)
        direction = tool.directions(q)[0]

        branches = tool.attitudes(direction, np.zeros(q.shape[1]))

        assert len(branches) == 2
        np.testing.assert_allclose(tool.directions(np.array(branches)), [direction, direction], atol=1e-9)
        turned = [np.abs(np.exp(1j * b[tool.rotary]) - np.exp(1j * q[0, tool.rotary])).max() for b in branches]
        assert min(turned) < 1e-6  # one of them is where we came from
        assert np.abs(np.exp(1j * branches[0]) - np.exp(1j * branches[1])).max() > 1e-6


def test_at_the_pole_the_free_axis_stays() -> None:
    seed = np.array([0.0, 0.0, 0.0, 0.3, 1.2])

    branches = TRUNNION.attitudes(np.array([0.0, 0.0, 1.0]), seed)

    assert [b[4] for b in branches] == pytest.approx([1.2] * len(branches))
    assert all(b[3] == pytest.approx(0.0, abs=1e-7) for b in branches)


def test_a_nutating_head_reaches_the_horizon_and_no_further() -> None:
    """About an axis at 45 degrees to the spindle, half a turn lays the spindle flat; nothing lies below."""
    flat = NUTATING.attitudes(np.array([1.0, 0.0, 0.0]), np.zeros(5))

    assert np.degrees(flat[0][NUTATING.kinematics.joints.index("B")]) == pytest.approx(180.0, abs=1e-4)
    assert NUTATING.attitudes(np.array([1.0, 0.0, -0.1]), np.zeros(5)) == []


def test_whole_turns_keep_to_the_travel_and_near_the_seed() -> None:
    free = axis("C", lower=np.radians(-200.0), upper=np.radians(700.0))
    tool = machine(axis("A", (0.0, 0.0, -0.020), lower=np.radians(-30.0), upper=np.radians(120.0)), free)
    q, near = np.zeros(5), np.zeros(5)
    q[4], near[4] = np.radians(170.0), np.radians(600.0)

    wound = tool.within_travel(q, near)

    assert wound is not None and np.degrees(wound[4]) == pytest.approx(530.0)
    near[4] = np.radians(-500.0)
    rewound = tool.within_travel(q, near)
    assert rewound is not None and np.degrees(rewound[4]) == pytest.approx(-190.0)
    q[3] = np.radians(-45.0)
    assert tool.within_travel(q, near) is None


def test_the_seat_of_a_timed_axis_is_unknown() -> None:
    chain = chain_of_axes([Axis(letter="X"), Axis(letter="Y"), Axis(letter="Z"), Axis(letter="A")])

    assert ToolPoint.of(Cartesian(chain=chain)) is None


def drawn_axes(random: np.random.Generator) -> list[Axis]:
    """Three linear axes and two rotary ones, each on either side, at places and, some of them, along slanted lines."""
    rotary = random.permutation(["A", "B", "C"])[:2].tolist()
    sides = {letter: random.choice(["tool", "table"]) for letter in [*"XYZ", *rotary]}
    turned = []
    for letter in rotary:
        vector = np.eye(3)["ABC".index(letter)] * random.choice([-1.0, 1.0])
        if random.random() < 0.4:  # nutating
            vector = vector + random.uniform(-1.0, 1.0, 3)
        vector /= np.linalg.norm(vector)
        point = random.uniform(-0.4, 0.4, 3)
        turned.append(
            Axis(letter=letter, side=sides[letter], point=tuple(point.tolist()), vector=tuple(vector.tolist()))
        )
    straight = [Axis(letter=letter, side=sides[letter]) for letter in random.permutation(list("XYZ")).tolist()]
    # those of a head hang on the linear axes, those of a table on the linear axes of the table
    return [*straight, *turned]


def moved(axes: list[Axis], side: str, values: dict[str, float]) -> Array:
    """The product of exponentials (4, 4) of all axes of one side, from M on."""
    X = np.eye(4)
    for one in axes:
        if one.side != side:
            continue
        step = np.eye(4)
        if one.letter in "ABC":
            v, p = np.array(one.vector), np.array(one.point)
            K = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
            angle = values[one.letter]
            step[:3, :3] += np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
            step[:3, 3] = p - step[:3, :3] @ p
        else:
            sense = 1.0 if side == "tool" else -1.0
            step["XYZ".index(one.letter), 3] = sense * values[one.letter]
        X = X @ step
    return X


@pytest.mark.parametrize("seed", range(60))
def test_tip_and_direction_of_drawn_machines_are_those_of_their_matrices(seed: int) -> None:
    random = np.random.default_rng([seed, 2611])
    axes = drawn_axes(random)
    point = ToolPoint.of(Cartesian(chain=chain_of_axes(axes)))
    assert point is not None
    names = point.kinematics.joints.names
    for _ in range(20):
        q = np.where([name in "XYZ" for name in names], random.uniform(-0.5, 0.5, 5), random.uniform(-3.0, 3.0, 5))
        offset = random.uniform(-0.2, 0.2, 3)
        values = dict(zip(names, q.tolist(), strict=True))
        X_CM = np.linalg.inv(moved(axes, "table", values)) @ moved(axes, "tool", values)
        tip, direction = (X_CM @ np.append(-offset, 1.0))[:3], X_CM[:3, 2]

        assert np.abs(point.tips(q[None], offset[None])[0] - tip).max() < 1e-12
        assert np.abs(point.directions(q[None])[0] - direction).max() < 1e-12
        words = point.points(q[None], offset[None])
        assert np.abs(point.joints(words, offset[None])[0] - q).max() < 1e-10

        found = point.attitudes(direction, q)
        assert 1 <= len(found) <= 2
        for other in found:
            assert np.abs(point.directions(other[None])[0] - direction).max() < 1e-8
        away = [np.abs(np.sin(0.5 * (other - q)[point.rotary])).max() for other in found]
        assert min(away) < 1e-6

"""Drawn paths of directions: five-axis machines follow them without a jump, to 1e-9, and rewind within their travel.

The machines are drawn as well: trunnions, heads, mixed ones, heads and tables whose second axis leans by 45 degrees,
with axes that do not meet.
"""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.cell.tool_point import MachinePoint
from gcodesim.frames import Array
from gcodesim.kinematics.cartesian import Axis, Cartesian, chain_of_axes
from gcodesim.kinematics.tool_point import ToolPoint
from gcodesim.rs274.tool_point import nearest, tilting_axis

HALF = 0.5**0.5
KINDS: dict[str, tuple[tuple[str, str, tuple[float, float, float]], ...]] = {
    "trunnion": (("A", "table", (1, 0, 0)), ("C", "table", (0, 0, 1))),
    "head": (("C", "tool", (0, 0, 1)), ("B", "tool", (0, 1, 0))),
    "mixed": (("B", "tool", (0, 1, 0)), ("C", "table", (0, 0, 1))),
    "nutating head": (("C", "tool", (0, 0, 1)), ("B", "tool", (0, HALF, HALF))),
    "nutating table": (("B", "table", (0, HALF, HALF)), ("C", "table", (0, 0, 1))),
    "nutating head over a table": (("B", "tool", (0, -HALF, HALF)), ("C", "table", (0, 0, 1))),
}


def drawn(kind: str, rng: np.random.Generator, lower: float = -np.inf, upper: float = np.inf) -> MachinePoint:
    axes = [
        Axis(
            letter=letter,
            side=side,  # type: ignore[arg-type]
            vector=vector,
            point=tuple(rng.normal(0.0, 0.1, 3)),
            lower=lower if letter == "C" else -np.inf,
            upper=upper if letter == "C" else np.inf,
        )
        for letter, side, vector in KINDS[kind]
    ]
    tool = ToolPoint.of(Cartesian(chain=chain_of_axes([*(Axis(letter=letter) for letter in "XYZ"), *axes])))
    assert tool is not None
    return MachinePoint(tool)


def followed(law: MachinePoint, directions: Array) -> Array:
    """Axes (n, 6) as a control chooses them from block to block."""
    here, out = (0.0,) * 6, []
    for direction in directions:
        ways = law.attitudes(tuple(direction.tolist()), here)  # type: ignore[arg-type]
        assert ways
        here = nearest(ways, here, tilting_axis(law))  # type: ignore[assignment]
        out.append(here)
    return np.array(out)


def ring(n: int, lean: Array, around: Array) -> Array:
    """Directions (n, 3) that lean by `lean` (n,) against Z, turned about it by `around` (n,)."""
    return np.stack([np.sin(lean) * np.cos(around), np.sin(lean) * np.sin(around), np.cos(lean)], axis=1)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_a_smooth_path_of_directions_is_followed_without_a_jump(kind: str, seed: int) -> None:
    rng, n = np.random.default_rng([seed, 14]), 400
    law = drawn(kind, rng)
    t = np.linspace(0.0, 1.0, n)
    lean = 0.7 + 0.4 * np.sin(2.0 * np.pi * rng.integers(1, 4) * t + rng.uniform(0.0, 6.0))
    around = rng.uniform(-3.0, 3.0) + 4.0 * np.pi * rng.choice([-1, 1]) * t  # twice around: axes wind up
    directions = ring(n, lean, around)

    axes = followed(law, directions)

    q = np.ascontiguousarray(axes[:, law.tool.columns])
    np.testing.assert_allclose(law.tool.directions(q), directions, atol=1e-9)
    steps = np.abs(np.diff(axes[:, 3:], axis=0)).max(axis=1)
    moved = np.linalg.norm(np.diff(directions, axis=0), axis=1)
    assert (steps < 4.0 * moved / np.sin(lean).min() + 1e-6).all()  # nowhere faster than the pole's distance demands
    c = np.abs(axes[-1, 5] - axes[0, 5])
    assert c == pytest.approx(4.0 * np.pi, abs=np.pi)  # both turns are still in it


@pytest.mark.parametrize("kind", KINDS)
def test_whole_poses_come_back_to_a_nanometre(kind: str) -> None:
    rng = np.random.default_rng(7)
    for _ in range(5):
        law, n = drawn(kind, rng), 100
        offset = np.tile([0.0, 0.0, float(rng.uniform(0.0, 0.2))], (n, 1))
        directions = ring(n, rng.uniform(0.05, 1.5, n), rng.uniform(-np.pi, np.pi, n))
        tips = rng.normal(0.0, 0.2, (n, 3))
        for branch in (0, 1):
            points = np.zeros((n, 6))
            for k in range(n):
                ways = law.tool.attitudes(directions[k], np.zeros(5))
                points[k, law.tool.columns] = ways[min(branch, len(ways) - 1)]
            points[:, :3] = tips
            q = law.tool.joints(points, offset)
            np.testing.assert_allclose(law.tool.tips(q, offset), tips, atol=1e-9)
            np.testing.assert_allclose(law.tool.directions(q), directions, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_an_axis_that_is_wound_up_rewinds_within_its_travel(kind: str) -> None:
    """Three turns about the pole, with 400 degrees of travel: C goes on as far as it can, then by whole turns back."""
    law = drawn(kind, np.random.default_rng(3), np.radians(-200.0), np.radians(200.0))
    n = 600
    directions = ring(n, np.full(n, 0.6), np.linspace(0.0, 6.0 * np.pi, n))

    axes = followed(law, directions)

    q = np.ascontiguousarray(axes[:, law.tool.columns])
    np.testing.assert_allclose(law.tool.directions(q), directions, atol=1e-9)
    assert (np.abs(axes[:, 5]) <= np.radians(200.0) + 1e-9).all()
    jumps = np.flatnonzero(np.abs(np.diff(axes[:, 5])) > 0.5)
    assert 1 <= len(jumps) <= 6


@pytest.mark.parametrize("kind", KINDS)
def test_through_the_pole_the_free_axis_stays_and_goes_on(kind: str) -> None:
    """On the pole itself C is free and stays where it was; on both sides of it the tool is where it should be."""
    law = drawn(kind, np.random.default_rng(11))
    lean = np.linspace(-0.3, 0.3, 61)  # through upright
    directions = ring(61, lean, np.full(61, 0.4))

    axes = followed(law, directions)

    q = np.ascontiguousarray(axes[:, law.tool.columns])
    np.testing.assert_allclose(law.tool.directions(q), directions, atol=1e-7)
    assert np.abs(np.diff(axes[:, 3:], axis=0))[1:].max() < np.pi + 1e-6  # never more than to the other branch
    at_pole, before = axes[30], axes[29]
    assert at_pole[5] == pytest.approx(before[5], abs=1e-6)

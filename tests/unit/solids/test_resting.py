"""Where vertical lines meet triangles, against every triangle asked for every line."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.frames import Array
from gcodesim.solids.resting_kernels import extreme_heights


def _found(points: Array, faces: np.ndarray, lines: Array, below: Array, *, highest: bool) -> Array:
    out = np.empty(len(lines))
    extreme_heights(points, faces.astype(np.int64), lines, below, highest, out)
    return out


def _asked_of_all(points: Array, faces: np.ndarray, lines: Array, below: Array, *, highest: bool) -> Array:
    a, b, c = (points[faces[:, k]] for k in range(3))
    e, f = b - a, c - a
    area = e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]
    d = lines[:, None] - a[None, :, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (d[..., 0] * f[:, 1] - d[..., 1] * f[:, 0]) / area
        v = (e[:, 0] * d[..., 1] - e[:, 1] * d[..., 0]) / area
        z = a[:, 2] + u * e[:, 2] + v * f[:, 2]
        total = u + v
    inside = (np.abs(area) > 1e-18) & (u >= -1e-9) & (v >= -1e-9) & (total <= 1.0 + 1e-9)
    if highest:
        kept: Array = np.where(inside & (z <= below[:, None]), z, -np.inf)
        return kept.max(axis=1, initial=-np.inf)
    kept = np.where(inside, z, np.inf)
    return kept.min(axis=1, initial=np.inf)


@pytest.mark.parametrize("highest", [True, False])
@pytest.mark.parametrize("seed", range(40))
def test_drawn_triangles_are_met_where_each_one_says(seed: int, highest: bool) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(3, 200)), 3))
    if seed % 2:
        points = np.round(points * 4.0) / 4.0  # many corners on lines, upright and level triangles
    faces = rng.integers(0, len(points), size=(int(rng.integers(0, 300)), 3))
    lines = np.concatenate([rng.normal(size=(60, 2)), points[:, :2]])
    below = rng.normal(size=len(lines))
    found = _found(points, faces, lines, below, highest=highest)
    assert np.array_equal(found, _asked_of_all(points, faces, lines, below, highest=highest))


def test_slanting_slivers_take_no_more_room_than_other_triangles() -> None:
    """Each is in the squares of its whole diagonal: 20,000 of them in 20,000 squares would fill 3 GB."""
    count = 20_000
    at = np.linspace(0.0, 1.0, count)
    points = np.concatenate(
        [np.column_stack([0.0 * at, at, at]), np.column_stack([1.0 + 0.0 * at, 1.0 - at, at]), [[0.5, 0.5, 2.0]]]
    )
    faces = np.column_stack([np.arange(count), np.arange(count) + count, np.roll(np.arange(count), 1)])
    lines = np.random.default_rng(3).random((count, 2))
    found = _found(points, faces, lines, np.full(count, np.inf), highest=True)
    some = slice(0, 50)
    assert np.array_equal(found[some], _asked_of_all(points, faces, lines[some], np.full(50, np.inf), highest=True))


def test_no_lines_and_no_triangles() -> None:
    points = np.zeros((3, 3))
    none = np.zeros((0, 3), dtype=np.int64)
    assert _found(points, none, np.zeros((2, 2)), np.full(2, np.inf), highest=True).tolist() == [-np.inf, -np.inf]
    assert _found(points, np.array([[0, 1, 2]]), np.zeros((0, 2)), np.zeros(0), highest=False).tolist() == []

"""Paths that are made with the original and with our module, by the same calls."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np


def _numbers(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    points, turns = rng.normal(size=(2, 3)), rng.normal(size=(2, 4))
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    return points[0], points[1], turns[0], turns[1]


def _line(seed: int, pi: Any) -> Any:
    return pi.linear_interpolation(*_numbers(seed)[:2], 7, *_numbers(seed)[2:])


def _arc(axis: int, clockwise: bool, pi: Any) -> Any:
    start, end, first, last = _numbers(10 + axis)
    return pi.circular_interpolation(start, end, 1.3 * np.linalg.norm(end - start), 9, axis, clockwise, first, last)


def _spline(count: int, pi: Any) -> Any:
    return pi.spline_interpolation(np.random.default_rng(count).normal(size=(3, count)), 12)


def _box(radius: float, pi: Any) -> Any:
    return pi.build_box_path([0.4, -0.1, 0.2], [0.5, 0.3], radius, [0, 0, 0, 1], 150)


def _turned_box(pi: Any) -> Any:
    return pi.build_box_path([0.4, -0.1, 0.2], [0.5, 0.3], 0.05, _numbers(30)[2], 60)


def _edited(pi: Any) -> Any:
    path, other = _line(21, pi), _spline(5, pi)
    path.translate([0.5, -0.25, 1.0])
    path.append(other)
    path.prepend(_line(22, pi))
    other.translate([9.0, 9.0, 9.0])  # what was appended is a copy
    return path


def _rotated(pi: Any) -> Any:
    path = _line(23, pi)
    path.rotate(_numbers(24)[2])
    return path


CASES: dict[str, Callable[[Any], Any]] = {
    **{f"line {seed}": partial(_line, seed) for seed in range(3)},
    **{f"arc {axis} {way}": partial(_arc, axis, way) for axis in range(3) for way in (True, False)},
    **{f"spline of {count}": partial(_spline, count) for count in (2, 3, 4, 9)},
    **{f"box {radius}": partial(_box, radius) for radius in (0.02, 0.1)},
    "edited": _edited,
    "rotated box": _turned_box,
    "rotated": _rotated,
}

SINGLE_PRECISION = ("rotated box", "rotated")
"""Cases in which the original turns a path in single precision."""


def as_lists(path: Any) -> dict[str, list[Any]]:
    """The arrays of a path."""
    names = ("positions", "orientations", "tool_activations")
    return {name: np.asarray(getattr(path, name), dtype=float).tolist() for name in names}

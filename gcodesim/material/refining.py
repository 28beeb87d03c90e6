"""Triangles made so small that what lies on each of them is nearly even."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.frames import Array
from gcodesim.solids.mesh_file import Faces, Triangles


class TooFineError(ValueError):
    """More faces than are allowed would be needed; `needed` is about how many."""

    def __init__(self, needed: int) -> None:
        super().__init__(f"{needed} faces")
        self.needed = needed


def refined(mesh: Triangles, size: float, most: int) -> Triangles:
    """The same surface in triangles without area-less ones, no edge longer than `size` [m].

    Each triangle is halved at its longest edge until that is short enough (Rivara 1984). Neighbours need not share
    corners then. TooFineError if more than `most` triangles would come of it.
    """
    points, faces = np.asarray(mesh.points, dtype=float), mesh.faces.astype(np.int64)
    faces = faces[_areas(points, faces) > 0.0]
    done: list[Faces] = []
    finished = 0
    while len(faces):
        edges = np.stack([norms(points[faces[:, (k + 1) % 3]] - points[faces[:, k]]) for k in range(3)], axis=1)
        longest = np.argmax(edges, axis=1)
        at = np.arange(len(faces))
        long = edges[at, longest] > size
        done.append(faces[~long].astype(np.int32))
        finished += len(done[-1])
        faces, longest = faces[long], longest[long]
        if finished + 2 * len(faces) > most:
            raise TooFineError(finished + _needed(points, faces, size))
        at = np.arange(len(faces))
        a, b, c = (faces[at, (longest + k) % 3] for k in range(3))  # the longest edge goes from a to b
        pairs = np.sort(np.stack([a, b], axis=1), axis=1)
        ends, which = np.unique(pairs[:, 0] * len(points) + pairs[:, 1], return_inverse=True)
        middle = which + len(points)
        points = np.concatenate([points, 0.5 * (points[ends // len(points)] + points[ends % len(points)])])
        faces = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return Triangles(points=points, faces=np.concatenate([np.zeros((0, 3), dtype=np.int32), *done]))


def _areas(points: Array, faces: NDArray[Any]) -> Array:
    a, b, c = (points[faces[:, k]] for k in range(3))
    areas: Array = 0.5 * norms(np.cross(b - a, c - a))
    return areas


def _needed(points: Array, faces: NDArray[Any], size: float) -> int:
    """About how many triangles with edges up to `size` these take: halving leaves right ones of size²/4 on average."""
    return int(_areas(points, faces).sum() / (0.25 * size * size)) + len(faces)

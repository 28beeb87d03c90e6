"""A surface with as few triangles as a tolerance allows: still closed, with the volume that it had."""

from __future__ import annotations

from typing import Final

import numpy as np

from gcodesim.arithmetic.matrices import norms
from gcodesim.material.surface import Surface
from gcodesim.material.true_volume import moved_to_volume

STAGES: Final = 6
"""The distance that is allowed grows by four from stage to stage: what is flat goes first."""

CLOSE: Final = 1e-6
"""Share of the volume that may be missing in the end."""

TRIES: Final = 4


def decimated(surface: Surface, tolerance: float) -> Surface:
    """A closed surface with fewer triangles, no point of which is more than `tolerance` [m] from the one it stands for.

    The same holds the other way round. Half of the tolerance is for taking points out, the other half for moving those
    that stay until the volume is that of before; if that half is not enough, less is taken out. What was flat stays
    exactly where it was. Sheets that are less than twice the tolerance apart may pass through each other.
    """
    volume = surface.volume
    coarse = surface
    for attempt in range(TRIES):
        coarse, way, slope = _collapsed(surface, 0.5 * tolerance / 2.0**attempt)
        coarse = moved_to_volume(coarse, way, slope, volume, 0.5 * tolerance, CLOSE)
        if abs(coarse.volume - volume) <= CLOSE * abs(volume):
            break
    return coarse


def _collapsed(surface: Surface, allowed: float) -> tuple[Surface, np.ndarray, float]:
    """What is left when points are taken out, unit ways (v, 3) of its points and what a move along them adds [m²]."""
    from gcodesim.material.decimation_kernels import (
        MOST_NEIGHBOURS,
        CornerLists,
        Neighbours,
        ThinnedSkin,
        collapse_some,
        list_corners,
        ways_out,
    )

    points, faces = surface.vertices.copy(), surface.faces.copy()
    skin = ThinnedSkin(points, faces, np.zeros(len(faces)), np.zeros(len(faces), dtype=np.uint8))
    corners = CornerLists(np.full(len(points), -1, dtype=np.int32), np.empty(3 * len(faces), dtype=np.int32))
    list_corners(skin, corners)
    room = MOST_NEIGHBOURS + 1
    ring = Neighbours(
        np.empty(room, dtype=np.int32),
        np.empty(room, dtype=np.int32),
        np.empty((room, 3)),
        np.empty(room),
        np.empty((2, room)),
        np.empty(len(points), dtype=np.int32),
    )
    for stage in range(STAGES):
        gone = 1
        while gone:
            ring.mark[:] = -1
            rest = np.zeros(len(points), dtype=np.uint8)
            gone = collapse_some(skin, corners, ring, rest, allowed * 2.0 ** (2 * (stage + 1 - STAGES)))
    way = np.zeros_like(points)
    ways_out(skin, way, np.zeros((len(points), 6)))
    left = faces[:, 0] >= 0
    used = np.zeros(len(points), dtype=bool)
    used[faces[left]] = True
    number = (np.cumsum(used) - 1).astype(np.int32)
    area = norms(way)
    way = np.divide(way, area[:, None], out=np.zeros_like(way), where=area[:, None] > 0.0)
    coarse = Surface(vertices=points[used], faces=number[faces[left]], cut=surface.cut[left])
    return coarse, way[used], float(area.sum())

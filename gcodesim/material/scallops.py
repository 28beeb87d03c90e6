"""How high the ridges are that a tool left between its passes in one operation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.frozen import frozen
from gcodesim.material.skin import PaintedSkin, middles

if TYPE_CHECKING:
    from gcodesim.material.passes import Passes

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

FEWEST: Final = 24
"""Faces of a patch: fewer may all lie on one side of a ridge."""

ACROSS: Final = 6.0
"""Size of a patch in mean sizes of a face, at least."""

LEVEL: Final = 0.8
"""Cosine between the normals of a face and of its patch, at least: others lie across an edge of the part."""

LOOKED_AT: Final = 24
"""Patches of a work whose ridge is looked for between the faces: from the lowest to the highest, evenly."""

ROUNDS: Final = 3
"""In which the top of a ridge is looked for, each `CLOSER` than the one before."""

CLOSER: Final = 3.0

STEPS: Final = 5
"""From the target out to the nearest pass, each as long as the gap that is left."""

ARRIVED: Final = 0.01
"""Share of the reach that may be left then: along a wall the gap stays."""

STEEPEST: Final = 0.6
"""Rise of a ridge beside a face, over the way there: what rises more is a wall of the part."""


class Work(NamedTuple):
    """What one tool of this number and radius [m] at its tip did in one operation."""

    tool: int
    operation: str
    radius: float


@frozen
class Scallops:
    """Ridges that a work left on `area` [m²]: on half of it below `typical` [m], nowhere above `most` [m]."""

    work: Work
    area: float
    typical: float
    most: float


class _Patch(NamedTuple):
    """A part of the skin: `area` [m²]; unit normal; at its highest face the place, and how far that face, and the
    lowest one, is from the target [m]; how far faces are apart [m]."""

    area: float
    normal: Array
    place: Array
    highest: float
    lowest: float
    apart: float


def scallops_of(skin: PaintedSkin, made: Ints, works: Sequence[Work], passes: Passes) -> Iterator[Scallops]:
    """The ridges of each of the works that made enough of a skin; `made` (f,) is an index into them, -1 for none.

    The skin of a work is looked at in patches as wide as the radius of its tool. In each, a ridge is as high as its
    highest point is farther from the target than its lowest. So what the program leaves on for a later pass does not
    count, and the direction of a face does not matter. The top of a ridge lies between faces: it is looked for beside
    the highest one, where the way from the target to the nearest of the `passes` is longest.
    """
    middle, normal = middles(skin.vertices, skin.faces)
    a, b, c = (skin.vertices[skin.faces[:, k]] for k in range(3))
    area = 0.5 * norms(np.cross(b - a, c - a))
    for number, work in enumerate(works):
        own = made == number
        if not own.any():
            continue
        apart = float(np.sqrt(2.0 * area[own].mean()))
        size = max(work.radius, ACROSS * apart)
        patches = _patches(middle[own], normal[own], area[own], skin.deviation[own], (size, apart))
        if not patches:
            continue
        chosen = np.unique(np.linspace(0, len(patches) - 1, LOOKED_AT).astype(int))
        heights = [_top(patches[k], passes) - patches[k].lowest for k in chosen.tolist()]
        yield Scallops(
            work=work,
            area=float(sum(patch.area for patch in patches)),
            typical=float(np.median(heights)),
            most=float(max(heights)),
        )


def _patches(middle: Array, normal: Array, area: Array, deviation: Array, sizes: tuple[float, float]) -> list[_Patch]:
    """The patches of some faces, those with low ridges first; `sizes`: of a patch, and between faces [m]."""
    size, apart = sizes
    place = np.floor((middle - middle.min(axis=0)) / size).astype(np.int64)
    most = place.max(axis=0) + 1
    number = (place[:, 0] * most[1] + place[:, 1]) * most[2] + place[:, 2]
    order = np.lexsort((deviation, number))
    found = []
    for own in np.split(order, np.flatnonzero(np.diff(number[order])) + 1):
        mean = (area[own, None] * normal[own]).sum(axis=0)
        mean /= max(float(norms(mean[None])[0]), 1e-300)
        if len(own) >= FEWEST and float(dots(normal[own], mean).min()) >= LEVEL:
            low, high = float(deviation[own[0]]), float(deviation[own[-1]])
            found.append(_Patch(float(area[own].sum()), mean, middle[own[-1]], high, low, apart))
    return sorted(found, key=lambda patch: patch.highest - patch.lowest)


def _top(patch: _Patch, passes: Passes) -> float:
    """How far from the target [m] the top of the ridge is beside the highest face of a patch."""
    normal = patch.normal
    along = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    along /= norms(along[None])[0]
    across = np.cross(normal, along)
    u, v = (places.reshape(-1, 1) for places in np.meshgrid(np.linspace(-1.0, 1.0, 5), np.linspace(-1.0, 1.0, 5)))
    grid = u * along + v * across
    at, reach, highest = patch.place - patch.highest * normal, patch.apart, patch.highest
    near = passes.beside(patch.place, 2.0 * reach + abs(patch.highest))
    for _ in range(ROUNDS):
        feet = at + reach * grid
        height, gap = np.full(len(feet), highest), np.zeros(len(feet))
        for _ in range(STEPS):
            gap = near.makers(feet + height[:, None] * normal, -np.inf).gap
            height += gap
        rises = (np.abs(gap) <= ARRIVED * reach) & (height - highest <= STEEPEST * norms(feet - at))
        height[~rises] = -np.inf
        best = int(np.argmax(height))
        if height[best] > highest:
            at, highest = feet[best], float(height[best])
        reach /= CLOSER
    return highest

"""Which layout of the viewer suits a run, and where its camera looks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norm, norms
from gcodesim.frames import Array
from gcodesim.log import View, ViewerCamera
from gcodesim.processes import PROCESSES
from gcodesim.processes.column import LOG
from gcodesim.recorder.ways import Ways

if TYPE_CHECKING:
    from gcodesim.shop import Shop

AROUND_WORK: Final = 3.0
"""Distance of the camera from a part on a machine, in diagonals of the part: it leaves room for the spindle."""

AROUND_WAYS: Final = 0.8
"""The least distance, as a multiple of how far paths go from the part: so the tool is always in view."""

AROUND_ROBOT: Final = 1.35
"""Distance from a robot together with its part, in their diagonals: they fill a view of 45 degrees."""

CLOSEST: Final = 0.15
"""[m]"""


def layout_kind(shop: Shop) -> str:
    """`process` if a tool does something without force that the log shows, else by what moves: `robot` or `milling`."""
    kinds = (PROCESSES[kind] for kind in shop.sheet.kinds[1:])
    if any(not kind.pushes and any(column.shown_in & LOG for column in kind.writes) for kind in kinds):
        return "process"
    return "robot" if shop.mover.seen_whole else "milling"


def view_of(shop: Shop, ways: Ways, rapid: NDArray[np.bool_]) -> View:
    """The part from close by, and beside it the whole robot; without a part the paths of feeds, or of all rows."""
    work = _corners(shop)
    if not len(work):
        fed = ways.polylines(~rapid).points
        work = fed if len(fed) else ways.points
    if not len(work):
        return View()
    part = _camera(work, diagonals=AROUND_WORK)
    if shop.mover.seen_whole:
        robot = _camera(np.concatenate([work, _links(shop)]), diagonals=AROUND_ROBOT)
        return View(cell=robot, part=part)
    farthest = float(norms(ways.points - part.target).max(initial=0.0))
    distance = max(part.distance, round(AROUND_WAYS * farthest, 3))
    return View(cell=replace(part, distance=distance))


def _camera(points: Array, *, diagonals: float) -> ViewerCamera:
    """A view at the middle of `points` (n, 3) [m], from `diagonals` times the diagonal of their box away."""
    low, high = points.min(axis=0), points.max(axis=0)
    x, y, z = (round(float(v), 3) for v in 0.5 * (low + high))
    distance = max(CLOSEST, diagonals * norm(high - low))
    return ViewerCamera(target=(x, y, z), distance=round(distance, 3))


def _corners(shop: Shop) -> Array:
    """The corners (n, 3) [m] of all stocks in the world."""
    corners: list[Sequence[float]] = []
    for placed in shop.stocks.values():
        xs, ys, zs = zip(*placed.stock.bounds, strict=True)
        box = np.array([(x, y, z) for x in xs for y in ys for z in zs])
        corners += list(placed.X_WS.apply(box))
    return np.array(corners).reshape(-1, 3)


def _links(shop: Shop) -> Array:
    """Where the links and the base are in the world (n, 3) [m] at the start."""
    links = shop.kinematics.links(np.asarray(shop.home, dtype=float)[None])[0]
    return shop.X_WB.apply(np.concatenate([np.zeros((1, 3)), links[:, :3, 3]]))

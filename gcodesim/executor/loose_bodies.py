"""Pieces that came loose as free bodies: how each falls, and where it lies then.

As with parts, nothing but the piece moves while it falls: what it may land on stands as in the step that freed it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied, norms
from gcodesim.executor.targets import parting_of
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.frozen import frozen
from gcodesim.shop import PlacedStock, Shop, skin_of
from gcodesim.solids.mass import mass_of_skin
from gcodesim.solids.resting import SUNK, gap_below
from gcodesim.world import fall_of
from gcodesim.world.falling import Below, Drop
from gcodesim.world.protocol import STANDARD_GRAVITY

if TYPE_CHECKING:
    from gcodesim.executor.freeing import Freed
    from gcodesim.scene import Body

SET_DOWN: Final = 0.5e-3
"""A piece that is freed at most this far [m] above something stays where it is, on that."""

UPRIGHT: Final = 1e-9
"""How far the Z axis of a stock may lean [-] for what it stands on to be level."""

STILL: Final = 20e-6
"""A piece has come to its end when no point of it is farther [m] from there any more: engines let bodies tremble."""

DENSITY: Final = 1000.0
"""[kg/m³] of a piece whose stock has none: how a single body falls does not depend on it."""

Skin = tuple[Array, NDArray[np.int32]]


@frozen(eq=False)
class LooseBody:
    """A piece of `freed`, which a program of `mover` did.

    From tick `begin` on it falls, from X_W (4, 4) to the poses `fall` (n, 4, 4) in W at the ends of ticks, and then
    lies. `name` is its frame, which is S at the moment in which it comes loose; `skin` is seen from there. It lies at
    `X` of `parent`, on `support` (empty: on a floor that nobody has drawn), `way` [m] lower than it was. `grain` [m]
    is how exactly its skin is known.
    """

    name: str
    mover: str
    freed: Freed
    skin: Skin
    begin: int
    X_W: Array
    fall: Array
    parent: str
    X: Pose
    support: str
    way: float
    grain: float

    @property
    def end(self) -> int:
        """The tick from which on it lies."""
        return self.begin + len(self.fall)

    def at(self, tick: int) -> Array | None:
        """X_WP (4, 4) while it falls; None once it lies."""
        if tick <= self.begin and len(self.fall):
            return self.X_W
        return self.fall[tick - self.begin - 1] if tick < self.end else None


class LooseBodies:
    """All pieces that come loose from the stocks of a run whose world is an engine; steps last `dt` [s]."""

    def __init__(self, shop: Shop, world_name: str, dt: float) -> None:
        self._fall, self._dt = fall_of(world_name), dt
        self._stocks = {name: placed for name, placed in shop.stocks.items() if not placed.revolved}
        for placed in self._stocks.values():
            parting_of(placed.stock).bodies = True
        self._fixtures = {
            body.name: _skin(body) for body in shop.scene.bodies if body.role == "fixture" and body.solids
        }
        self._floor = self._lowest(shop)
        self._stands_on_floor = {name: self._floats(shop, placed) for name, placed in self._stocks.items()}
        self.bodies: list[LooseBody] = []

    def _lowest(self, shop: Shop) -> float:
        """The height [m] of the lowest thing there is."""
        heights = [float(mover.X_WB.p[2]) for mover in shop.scene.movers.values()]
        scene, stocks = shop.scene, self._stocks.values()
        heights += [_lowest_point(_moved(skin, scene.at_rest(name))) for name, skin in self._fixtures.items()]
        heights += [float(_corners(placed, scene.at_rest(placed.frame))[:, 2].min()) for placed in stocks]
        return min(heights)

    def _floats(self, shop: Shop, placed: PlacedStock) -> bool:
        """Whether nothing is drawn below a stock, which then stands on something level that nobody has drawn."""
        scene = shop.scene
        corners = _corners(placed, scene.at_rest(placed.frame))
        fixtures = {name: _moved(skin, scene.at_rest(name)) for name, skin in self._fixtures.items()}
        return gap_below((corners, _BOX), fixtures, -1e9)[0] > SUNK

    def fall(
        self, shop: Shop, freed: Iterable[tuple[int, Freed]], begin: NDArray[np.int64], q: Mapping[str, Array]
    ) -> list[LooseBody]:
        """What becomes of pieces that are freed, each in a step of a window that ends with tick `begin` (n,).

        `q[mover]` (n, j) are the joints at the ends of the steps.
        """
        found = []
        for step, each in freed:
            if each.piece.body is not None and each.name in self._stocks:
                now = {name: rows[step : step + 1] for name, rows in q.items()}
                body = self._fall_of(shop, each, int(begin[step]), now)
                self.bodies.append(body)
                found.append(body)
        return found

    def _fall_of(self, shop: Shop, freed: Freed, begin: int, q: Mapping[str, Array]) -> LooseBody:
        placed, shape, scene = self._stocks[freed.name], freed.piece.body, shop.scene
        assert shape is not None
        X_WS = scene.track(placed.frame, q)[0]
        skin = _moved(shape.skin, Pose.from_matrix(X_WS))
        poses = {name: scene.track(name, q)[0] for name in self._fixtures}
        others = {name: _moved(own, Pose.from_matrix(poses[name])) for name, own in self._fixtures.items()}
        poses[placed.frame] = X_WS
        others[placed.frame] = _moved(shape.rest, Pose.from_matrix(X_WS))
        for lying in self.bodies:
            X_WP = multiplied(scene.track(lying.parent, q)[0], lying.X.matrix)
            others[lying.name] = _moved(lying.skin, Pose.from_matrix(X_WP))
        own_floor = self._stands_on_floor[placed.name] and abs(abs(float(X_WS[2, 2])) - 1.0) < UPRIGHT
        bottom = float(_corners(placed, Pose.from_matrix(X_WS))[:, 2].min())
        floor = bottom if own_floor else self._floor
        others = {name: own for name, own in others.items() if len(own[1])}
        height, support = gap_below(skin, others, floor)
        rows, end = np.zeros((0, 4, 4)), X_WS
        if height > SET_DOWN:
            mass = mass_of_skin(*shape.skin, DENSITY * freed.piece.volume)
            drop = Drop(shape.skin, mass, X_WS, np.zeros(3), shape.boxes)
            rows = self._fall(drop, Below(others, floor, height), np.array(STANDARD_GRAVITY), self._dt)
            rows = _until_still(rows, shape.skin[0])
            end = rows[-1]
            _, support = gap_below(_moved(shape.skin, Pose.from_matrix(end)), others, floor)
        parents = {body.name: body.parent for body in self.bodies} | {name: name for name in poses}
        parent = parents.get(support, placed.frame if own_floor else WORLD)
        X_WB = scene.track(parent, q)[0]
        return LooseBody(
            name=f"loose/{len(self.bodies) + 1}",
            mover=shop.name,
            freed=freed,
            skin=shape.skin,
            begin=begin,
            X_W=X_WS,
            fall=rows,
            parent=parent,
            X=Pose.from_matrix(multiplied(inverse_pose(X_WB[None])[0], end)),
            support=support,
            way=_lowest_point(skin) - _lowest_point(_moved(shape.skin, Pose.from_matrix(end))),
            grain=placed.stock.cell,
        )


_BOX: Final = np.array(
    [
        *([0, 1, 2], [1, 3, 2], [4, 6, 5], [5, 6, 7], [0, 4, 1], [1, 4, 5]),
        *([2, 3, 6], [3, 7, 6], [0, 2, 4], [2, 6, 4], [1, 5, 3], [3, 5, 7]),
    ],
    dtype=np.int32,
)
"""Triangles over the corners of a box in the order of `itertools.product`."""


def _until_still(rows: Array, points: Array) -> Array:
    """Poses (n, 4, 4) of a body with corners (v, 3) up to where it has come to its end; the last one stays the last."""
    low, high = points.min(axis=0), points.max(axis=0)
    corners = np.array(list(product(*zip(low, high, strict=True))))
    ways = applied(rows[:, None, :3, :3], corners) + rows[:, None, :3, 3]
    moving = np.flatnonzero(norms(ways - ways[-1]).max(axis=1) > STILL)
    last = int(moving[-1]) + 1 if len(moving) else 0
    kept: Array = np.concatenate([rows[:last], rows[-1:]])
    return kept


def _lowest_point(skin: Skin) -> float:
    return float(skin[0][:, 2].min())


def _corners(placed: PlacedStock, X_WS: Pose) -> Array:
    """The corners (8, 3) [m] in W of the box around a stock at the start."""
    return X_WS.apply(np.array(list(product(*zip(*placed.stock.bounds, strict=True)))))


def _skin(body: Body) -> Skin:
    skin = skin_of(body)
    return skin.points, skin.faces


def _moved(skin: Skin, X: Pose) -> Skin:
    return X.apply(skin[0]), skin[1]

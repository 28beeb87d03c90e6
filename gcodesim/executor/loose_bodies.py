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
from gcodesim.solids import Box, triangles_of
from gcodesim.solids.mass import mass_of_skin
from gcodesim.solids.mesh_file import Triangles
from gcodesim.solids.resting import Ground, gap_below, is_bare_below
from gcodesim.world import fall_of
from gcodesim.world.falling import Drop
from gcodesim.world.protocol import STANDARD_GRAVITY

if TYPE_CHECKING:
    from gcodesim.executor.freeing import Freed
    from gcodesim.material.piece_shape import PieceShape
    from gcodesim.scene import Scene

SET_DOWN: Final = 0.5e-3
"""A piece that is freed at most this far [m] above something stays where it is, on that."""

UPRIGHT: Final = 1e-9
"""How far the Z axis of a stock may lean [-] for what it stands on to be level."""

STILL: Final = 20e-6
"""A piece has come to its end when no point of it is farther [m] from there any more: engines let bodies tremble."""

DENSITY: Final = 1000.0
"""[kg/m³] of a piece whose stock has none: how a single body falls does not depend on it."""


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
    skin: Triangles
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
            body.name: skin_of(body) for body in shop.scene.bodies if body.role == "fixture" and body.solids
        }
        self._floor = self._lowest(shop)
        self._stands_on_floor = {name: self._floats(shop, placed) for name, placed in self._stocks.items()}
        self.bodies: list[LooseBody] = []

    def _lowest(self, shop: Shop) -> float:
        """The height [m] of the lowest thing there is."""
        heights = [float(mover.X_WB.p[2]) for mover in shop.scene.movers.values()]
        scene, stocks = shop.scene, self._stocks.values()
        heights += [skin.moved(scene.at_rest(name)).lowest for name, skin in self._fixtures.items()]
        heights += [_box_around(placed, scene.at_rest(placed.frame)).lowest for placed in stocks]
        return min(heights)

    def _floats(self, shop: Shop, placed: PlacedStock) -> bool:
        """Whether nothing is drawn below a stock, which then stands on something level that nobody has drawn."""
        scene = shop.scene
        fixtures = [skin.moved(scene.at_rest(name)) for name, skin in self._fixtures.items()]
        return is_bare_below(_box_around(placed, scene.at_rest(placed.frame)), fixtures)

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
        own_floor = self._stands_on_floor[placed.name] and abs(abs(float(X_WS[2, 2])) - 1.0) < UPRIGHT
        floor = _box_around(placed, Pose.from_matrix(X_WS)).lowest if own_floor else self._floor
        ground = Ground(others=self._others(scene, placed.frame, shape.rest, q), floor=floor)
        rows, support = self._landing(shape, DENSITY * freed.piece.volume, X_WS, ground)
        end = rows[-1] if len(rows) else X_WS
        parents = {body.name: body.parent for body in self.bodies}
        parent = parents.get(support, support) if support else placed.frame if own_floor else WORLD
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
            way=shape.skin.moved(Pose.from_matrix(X_WS)).lowest - shape.skin.moved(Pose.from_matrix(end)).lowest,
            grain=placed.stock.cell,
        )

    def _others(self, scene: Scene, frame: str, rest: Triangles, q: Mapping[str, Array]) -> dict[str, Triangles]:
        """What a piece may fall onto, in W: fixtures, the `rest` of its stock in its frame, and pieces that lie."""
        standing = self._fixtures | {frame: rest}
        others = {name: skin.moved(Pose.from_matrix(scene.track(name, q)[0])) for name, skin in standing.items()}
        for lying in self.bodies:
            X_WP = multiplied(scene.track(lying.parent, q)[0], lying.X.matrix)
            others[lying.name] = lying.skin.moved(Pose.from_matrix(X_WP))
        return {name: skin for name, skin in others.items() if len(skin.faces)}

    def _landing(self, shape: PieceShape, mass: float, X_W: Array, ground: Ground) -> tuple[Array, str]:
        """The poses (n, 4, 4) of the fall of a piece from X_W (4, 4), none if it stays, and what it lies on then."""
        skin = shape.skin
        height, support = gap_below(skin.moved(Pose.from_matrix(X_W)), ground)
        if height <= SET_DOWN:
            return np.zeros((0, 4, 4)), support
        drop = Drop(skin, mass_of_skin(skin.points, skin.faces, mass), X_W, np.zeros(3), height, shape.boxes)
        rows = _until_still(self._fall(drop, ground, np.array(STANDARD_GRAVITY), self._dt), skin.points)
        return rows, gap_below(skin.moved(Pose.from_matrix(rows[-1])), ground)[1]


def _until_still(rows: Array, points: Array) -> Array:
    """Poses (n, 4, 4) of a body with corners (v, 3) up to where it has come to its end; the last one stays the last."""
    low, high = points.min(axis=0), points.max(axis=0)
    corners = np.array(list(product(*zip(low, high, strict=True))))
    ways = applied(rows[:, None, :3, :3], corners) + rows[:, None, :3, 3]
    moving = np.flatnonzero(norms(ways - ways[-1]).max(axis=1) > STILL)
    last = int(moving[-1]) + 1 if len(moving) else 0
    kept: Array = np.concatenate([rows[:last], rows[-1:]])
    return kept


def _box_around(placed: PlacedStock, X_WS: Pose) -> Triangles:
    """The box, in W, around a stock at the start."""
    lower, upper = placed.stock.bounds
    return triangles_of(Box(lower=tuple(lower), upper=tuple(upper))).moved(X_WS)

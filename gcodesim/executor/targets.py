"""What processes act on: stocks of the shop, surfaces of stocks, bodies, or nothing; each target has a frame S."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.processes import PROCESSES
from gcodesim.scene.coated import Coated
from gcodesim.shop import BODIES, PlacedStock, Shop
from gcodesim.shop.assemblies import assembled
from gcodesim.solids import Solid, triangles_of

if TYPE_CHECKING:
    from gcodesim.material.assembly import StockAssembly
    from gcodesim.material.film import BodyFilm, Shades
    from gcodesim.material.loose import Parting
    from gcodesim.material.revolved import Revolved
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material
    from gcodesim.processes.protocol import ActsOn

Bounds = tuple[Array, Array]
"""Least and greatest corner (3,) [m]."""


class TaskTarget(Protocol):
    """Something that one process acts on.

    `name` is that of the stock, empty where the target is not a stock; `frame` is the name of S in the scene.
    """

    @property
    def name(self) -> str: ...

    @property
    def frame(self) -> str: ...

    @property
    def material(self) -> Material | None:
        """What it is made of, if known."""

    @property
    def given(self) -> Any:
        """What the process is given; see `processes.protocol`."""

    @property
    def holds(self) -> tuple[tuple[str, Pose], ...]:
        """What tools of several channels may change at once, by name, with its frame in S."""

    @property
    def room(self) -> Bounds | None:
        """A box in S that the target never leaves; None: the process is asked wherever its tool is."""

    def filled(self) -> Bounds | None:
        """The box that holds the target as it is now; at most `room`."""

    def memento(self) -> Callable[[], None]:
        """Remember the state; calling the result restores it."""


def targets_of(shop: Shop, acts_on: ActsOn, *, together: bool = False) -> list[TaskTarget]:
    """The targets of a process that acts on things of this sort; `together`: on a stock with all that stands in it."""
    if acts_on == "stock":
        grows = any(PROCESSES[kind].lays for tool in shop.cell.tools.values() for kind in tool.processes)
        wholes = assembled(shop.stocks) if together else {}
        taken = {part.name for parts in wholes.values() for part, _ in parts}
        return [
            AssemblyTarget(placed, grows, tuple(wholes[name])) if name in wholes else StockTarget(placed, grows)
            for name, placed in shop.stocks.items()
            if not placed.revolved and name not in taken
        ]
    if acts_on == "revolved":
        return [StockTarget(placed) for placed in shop.stocks.values() if placed.revolved]
    if acts_on == "milled":
        return [MilledTarget(placed) for placed in shop.stocks.values() if placed.revolved]
    if acts_on == "surface":
        skins = [SkinTarget(placed, coated=shop.coated.get(placed.frame)) for placed in shop.stocks.values()]
        known = {skin.frame for skin in skins}
        return [*skins, *(BodySkinTarget(each) for frame, each in shop.coated.items() if frame not in known)]
    if acts_on == "bodies":
        bodies = standing_bodies(shop)
        return [BodiesTarget(bodies)] if bodies else []
    return [NoTarget()]


@frozen(kw_only=False, eq=False)
class StockTarget:
    """A stock that the process may change; it `grows` where the cell has an extruder, perhaps in the same window."""

    placed: PlacedStock
    grows: bool = False

    @property
    def name(self) -> str:
        return self.placed.name

    @property
    def frame(self) -> str:
        return self.placed.frame

    @property
    def material(self) -> Material | None:
        return self.placed.material

    @property
    def given(self) -> Any:
        return self.placed.stock

    @property
    def room(self) -> Bounds:
        low, high = self.placed.stock.bounds
        return low, np.append(high[:2], np.inf) if self.grows else high

    def filled(self) -> Bounds:
        low, high = self.placed.stock.bounds
        return low, np.append(high[:2], self.placed.stock.top)

    def memento(self) -> Callable[[], None]:
        return self.placed.stock.memento()

    @property
    def holds(self) -> tuple[tuple[str, Pose], ...]:
        return ((self.name, Pose.identity()),)

    @property
    def partings(self) -> tuple[tuple[str, Pose, Parting], ...]:
        """Who watches each of `holds` for pieces that come loose; none where nothing falls: a lathe has its own way."""
        return () if self.placed.revolved else ((self.name, Pose.identity(), parting_of(self.placed.stock)),)


@frozen(kw_only=False, eq=False)
class AssemblyTarget(StockTarget):
    """A stock with the `parts` that stand in it, each with its frame in S, which is that of the whole."""

    parts: tuple[tuple[PlacedStock, Pose], ...] = ()

    @property
    def given(self) -> StockAssembly:
        from gcodesim.material.assembly import StockAssembly

        all_of_it = (self.placed, *(part for part, _ in self.parts))
        return StockAssembly(
            names=tuple(own.name for own in all_of_it),
            stocks=tuple(own.stock for own in all_of_it),
            materials=tuple(own.material for own in all_of_it),
            X=(Pose.identity(), *(X for _, X in self.parts)),
        )

    @property
    def holds(self) -> tuple[tuple[str, Pose], ...]:
        return (self.name, Pose.identity()), *((part.name, X) for part, X in self.parts)

    @property
    def room(self) -> Bounds:
        return self._around([own.room for own in self._alone])

    def filled(self) -> Bounds:
        return self._around([own.filled() for own in self._alone])

    @property
    def _alone(self) -> list[StockTarget]:
        return [StockTarget(own, self.grows) for own in (self.placed, *(part for part, _ in self.parts))]

    def _around(self, boxes: Sequence[Bounds]) -> Bounds:
        around = [X.box(*box) for (_, X), box in zip(self.holds, boxes, strict=True)]
        lows, highs = zip(*around, strict=True)
        return np.min(lows, axis=0), np.max(highs, axis=0)

    def memento(self) -> Callable[[], None]:
        return self.given.memento()

    @property
    def partings(self) -> tuple[tuple[str, Pose, Parting], ...]:
        whole = (self.name, Pose.identity(), parting_of(self.placed.stock))
        return whole, *((part.name, X, parting_of(part.stock)) for part, X in self.parts)


@frozen(kw_only=False, eq=False)
class MilledTarget(StockTarget):
    """The stock of a lathe for a driven tool: its columns, which are made when such a tool first comes near."""

    @property
    def given(self) -> Any:
        return cast("Revolved", self.placed.stock).in_columns()

    @property
    def partings(self) -> tuple[tuple[str, Pose, Parting], ...]:
        return ((self.name, Pose.identity(), parting_of(self.given)),)


@frozen(kw_only=False, eq=False)
class SkinTarget(StockTarget):
    """The surface of a stock, which the process does not cut; itself the `Skin`. A process may coat it."""

    coated: Coated | None = None

    @property
    def coating(self) -> BodyFilm | None:
        return None if self.coated is None else self.coated.begin()

    @property
    def shade_frames(self) -> tuple[str, ...]:
        return () if self.coated is None else self.coated.shading.frames()

    @property
    def shades(self) -> Shades:
        assert self.coated is not None
        return self.coated.shading.before(self.frame)

    @property
    def given(self) -> Any:
        return self

    @property
    def box(self) -> Bounds:
        return self.filled()

    def triangles(self) -> tuple[Array, NDArray[np.int32]]:
        surface = self.placed.stock.surface()
        return surface.vertices, surface.faces.astype(np.int32, copy=False)

    def memento(self) -> Callable[[], None]:
        return _nothing_to_put_back if self.coated is None else self.coated.memento()


@frozen(kw_only=False, eq=False)
class BodySkinTarget:
    """The surface of a rigid body that is to be coated; itself the `Skin`. It counts wherever the tool is."""

    coated: Coated

    material = None
    room = None

    @property
    def name(self) -> str:
        return self.coated.name

    @property
    def holds(self) -> tuple[tuple[str, Pose], ...]:
        return ((self.name, Pose.identity()),)

    @property
    def frame(self) -> str:
        return self.coated.frame

    @property
    def given(self) -> Any:
        return self

    @property
    def box(self) -> Bounds:
        points, _ = self.triangles()
        return points.min(axis=0), points.max(axis=0)

    def triangles(self) -> tuple[Array, NDArray[np.int32]]:
        skin = self.coated.skin()
        return skin.points, skin.faces

    @property
    def coating(self) -> BodyFilm | None:
        return self.coated.begin()

    @property
    def shade_frames(self) -> tuple[str, ...]:
        return self.coated.shading.frames()

    @property
    def shades(self) -> Shades:
        return self.coated.shading.before(self.frame)

    def filled(self) -> None:
        return None

    def memento(self) -> Callable[[], None]:
        return self.coated.memento()


@frozen(kw_only=False, eq=False)
class BodiesTarget:
    """All bodies at once. S is the frame in which they stand still."""

    bodies: tuple[StandingBody, ...]

    name = ""
    holds = ()
    frame = BODIES
    material = None

    @property
    def given(self) -> Any:
        return self.bodies

    @property
    def room(self) -> Bounds:
        lows, highs = zip(*(body.box for body in self.bodies), strict=True)
        return np.min(lows, axis=0), np.max(highs, axis=0)

    def filled(self) -> Bounds:
        return self.room

    def memento(self) -> Callable[[], None]:
        return _nothing_to_put_back


@frozen(kw_only=False, eq=False)
class NoTarget:
    """For a process that acts on nothing: S is the frame of the bodies."""

    name = ""
    holds = ()
    frame = BODIES
    material = None
    given = None
    room = None

    def filled(self) -> None:
        return None

    def memento(self) -> Callable[[], None]:
        return _nothing_to_put_back


def parting_of(stock: Stock) -> Parting:
    """Who watches this stock for pieces that come loose."""
    if stock.parting is None:
        from gcodesim.material.loose import Parting

        stock.parting = Parting(stock)
    return stock.parting


def _nothing_to_put_back() -> None:
    """A process that only looks changes nothing, so there is nothing to restore."""


@frozen(kw_only=False, eq=False)
class StandingBody:
    """A fixture, a part or a stock as seen by a process that acts on bodies; all in one common frame S."""

    name: str
    role: str
    box: Bounds
    _shape: Callable[[], tuple[Array, NDArray[np.int32]]]

    def triangles(self) -> tuple[Array, NDArray[np.int32]]:
        return self._shape()


def standing_bodies(shop: Shop) -> tuple[StandingBody, ...]:
    """The fixtures and parts of the shop that are at rest in `BODIES`, then the stocks that are."""
    bodies = []
    carrier, _ = shop.scene.standing_on(BODIES)

    def stands_there(frame: str) -> bool:
        return shop.scene.standing_on(frame)[0] == carrier

    for body in shop.scene.bodies:
        if body.role not in ("fixture", "part") or not stands_there(body.name):
            continue
        placed_bodies = shop.placement.fixtures if body.role == "fixture" else shop.placement.parts
        X = placed_bodies[body.label]
        for solid in (own.solid for own in body.solids):
            box = X.box(*map(np.asarray, solid.bounds))
            bodies.append(StandingBody(body.label, body.role, box, partial(_moved, X, partial(_skin, solid))))
    for name, placed in shop.stocks.items():
        if not stands_there(placed.frame):
            continue
        skin, X = SkinTarget(placed), placed.X_WS
        bodies.append(StandingBody(name, "stock", X.box(*skin.room), partial(_moved, X, skin.triangles)))
    return tuple(bodies)


def _skin(solid: Solid) -> tuple[Array, NDArray[np.int32]]:
    skin = triangles_of(solid)
    return skin.points, skin.faces


def _moved(X: Pose, shape: Callable[[], tuple[Array, NDArray[np.int32]]]) -> tuple[Array, NDArray[np.int32]]:
    points, faces = shape()
    return X.apply(points), faces

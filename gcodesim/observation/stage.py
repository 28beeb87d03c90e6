"""What stands in a cell, as sensors and pictures see it: links, tool, stock as cut so far, fixtures, parts."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.scene import Body, Mover
from gcodesim.scene.colors import CUT, DEVICE, FIXTURE, PART, RAW, Color
from gcodesim.sensors.scenery import Scenery
from gcodesim.solids import Placed, triangles_of
from gcodesim.tools.gripper import Gripper

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord
    from gcodesim.material.surface import Surface
    from gcodesim.shop import PlacedStock, Shop
    from gcodesim.tools.tool import Tool

Bytes = NDArray[np.uint8]

SEEN_COLUMNS: Final = 160_000
"""Columns of a stock that a sensor sees: finer than most pictures show."""

_AT_REST: Final[Mapping[str, Array]] = {}

_ROLES: Final = {"fixture": FIXTURE, "part": PART, "obstacle": DEVICE}


@frozen(kw_only=False, eq=False)
class _Skin:
    """Triangles (t, 3, 3) [m] in a frame, with one colour (3,) or one for each (t, 3)."""

    triangles: Array
    color: Bytes

    def at(self, X: Array) -> tuple[Array, Bytes]:
        """The same at `X` (4, 4)."""
        return _moved(self.triangles, X), self.color


@frozen
class Hand:
    """What a machine has on its flange: the number of a tool, 0 for none, and how far (0 to 1) a gripper is open."""

    tool: int = 0
    opening: float = 1.0

    @staticmethod
    def in_step(record: StepRecord, row: int, shop: Shop) -> Hand:
        """In a step of a record of the machine."""
        number = int(record.window.tool[row])
        tool = shop.tool(number)
        return Hand(tool=number, opening=record.opening(row, tool.widest) if isinstance(tool, Gripper) else 1.0)


@frozen(eq=False)
class Stage:
    """The bodies of a shop, as triangles in the frames that carry them."""

    shop: Shop
    links: Mapping[str, Sequence[tuple[int, _Skin]]]
    bodies: Sequence[tuple[str, _Skin]]
    tools: Mapping[int, Sequence[_Skin]]

    @staticmethod
    def of(shop: Shop) -> Stage:
        """What does not change: everything but the surface of stocks."""
        return Stage(
            shop=shop,
            links={name: tuple(_links(mover)) for name, mover in shop.scene.movers.items()},
            bodies=[(body.name, skin) for body in shop.scene.bodies for skin in _skins_of(body)],
            tools={number: tuple(_tool_skins(tool)) for number, tool in shop.cell.tools.items()},
        )

    def scenery(
        self,
        q: Mapping[str, Array],
        hands: Mapping[str, Hand],
        surfaces: Mapping[str, Surface],
        *,
        places: Mapping[str, Array] = _AT_REST,
        lines: Iterable[tuple[Array, Bytes]] = (),
    ) -> Scenery:
        """Everything with the joints of movers at `q[mover]` (j,), their tools in `hands`, stocks with `surfaces`.

        `places` are X_WF (4, 4) of bodies that something else moves, such as parts and devices, by their frames.
        `lines` (l, 2, 3) [m] in the world are drawn besides.
        """
        rows = {name: joints[None] for name, joints in q.items()}
        return Scenery.of(self._parts(rows, hands, surfaces, places), lines)

    def hands_at_start(self) -> dict[str, Hand]:
        """What the movers have on their flanges before a program begins."""
        channels = self.shop.cell.channels.values()
        own = {each.robot or next(iter(self.shop.scene.movers)): each.loaded_tool or 0 for each in channels}
        return {name: Hand(tool=own.get(name, 0)) for name in self.shop.scene.movers}

    def triangles_of(self, frame: str) -> Array:
        """Triangles (t, 3, 3) [m] of the body of a frame, in that frame."""
        return np.concatenate([np.zeros((0, 3, 3)), *(skin.triangles for name, skin in self.bodies if name == frame)])

    def standing(
        self, q: Mapping[str, Array], hands: Mapping[str, Hand], moving: Collection[str]
    ) -> Iterator[tuple[str, Array]]:
        """Names and triangles (t, 3, 3) [m] in the world of links, tools and bodies, but stocks and what is `moving`.

        `q[mover]` (1, j) are joints.
        """
        for name, mover in self.shop.scene.movers.items():
            at = mover.kinematics.links(q.get(name, mover.home[None]))[0]
            names = mover.kinematics.link_names
            for index, skin in self.links[name]:
                yield f"{name}/{names[index]}", skin.at(multiplied(mover.X_WB.matrix, at[index]))[0]
        for frame, skin in self.bodies:
            if frame not in moving:
                yield frame, skin.at(self.shop.scene.track(frame, q)[0])[0]
        for name, hand in hands.items():
            held, X_WT = self.shop.tool(hand.tool), self.tip(q, hand.tool, name)
            for skin in self.held(hand):
                yield held.name if held is not None else "", skin.at(X_WT)[0]

    def held(self, hand: Hand) -> Sequence[_Skin]:
        """The tool on a flange, in the axes of its tip."""
        tool = self.shop.tool(hand.tool)
        if not isinstance(tool, Gripper):
            return self.tools.get(hand.tool, ())
        return [*_tool_skins(tool, hand.opening)]

    def _parts(
        self,
        q: Mapping[str, Array],
        hands: Mapping[str, Hand],
        surfaces: Mapping[str, Surface],
        places: Mapping[str, Array],
    ) -> Iterator[tuple[Array, Bytes]]:
        scene = self.shop.scene
        for name, mover in scene.movers.items():
            at = mover.kinematics.links(q.get(name, mover.home[None]))[0]
            for index, skin in self.links[name]:
                yield skin.at(multiplied(mover.X_WB.matrix, at[index]))
        for frame, skin in self.bodies:
            yield skin.at(places[frame] if frame in places else scene.track(frame, q)[0])
        for name, hand in hands.items():
            X_WT = self.tip(q, hand.tool, name)
            for skin in self.held(hand):
                yield skin.at(X_WT)
        for name, surface in surfaces.items():
            yield stock_skin(surface).at(scene.track(self.shop.stocks[name].frame, q)[0])

    def tip(self, q: Mapping[str, Array], tool: int, name: str = "") -> Array:
        """X_WT (4, 4) of a tool on the flange of a mover, the own one if none is named, at `q[mover]` (1, j)."""
        mover = self.shop.scene.movers[name or self.shop.name]
        own = q.get(mover.name, mover.home[None])
        X_FT = Pose.identity() if (held := self.shop.tool(tool)) is None else held.X_FT
        X: Array = multiplied(mover.X_WB.matrix, mover.kinematics.forward(own)[0], X_FT.matrix)
        return X


def surface_of(placed: PlacedStock) -> Surface:
    """The surface of a stock as it is now, as finely as sensors see it."""
    return placed.stock.surface(placed.stock.spacing_for(SEEN_COLUMNS))


def stock_skin(surface: Surface) -> _Skin:
    """What is seen of a stock: cut faces have another colour."""
    colors = np.where(surface.cut[:, None] > 0, _bytes(CUT), _bytes(RAW))
    return _Skin(surface.vertices[surface.faces], colors)


def _links(mover: Mover) -> Iterator[tuple[int, _Skin]]:
    for shape in mover.kinematics.link_shapes:
        for skin in _skins([shape.placed], shape.rgba):
            yield shape.link, skin


def _skins_of(body: Body) -> list[_Skin]:
    return _skins(body.solids, _ROLES[body.role]) if body.role in _ROLES else []


def _tool_skins(tool: Tool, opening: float = 1.0) -> Iterator[_Skin]:
    for part, placed in tool.drawn(opening):
        yield from _skins([placed], tool.color_of(part))


def _skins(solids: Iterable[Placed], color: Color) -> list[_Skin]:
    found = []
    for placed in solids:
        try:
            skin = triangles_of(placed.solid)
        except ValueError:  # a mesh that cannot be read is reported when the shop is opened; hulls have no skin
            continue
        found.append(_Skin(_moved(skin.points[skin.faces], placed.X.matrix), _bytes(color)))
    return found


def _moved(triangles: Array, X: Array) -> Array:
    """Triangles (t, 3, 3) from a frame to that from which it is seen at `X` (4, 4), in a fixed order of sums."""
    x, y, z = (triangles[..., k, None] for k in range(3))
    moved: Array = x * X[:3, 0] + y * X[:3, 1] + z * X[:3, 2] + X[:3, 3]
    return moved


def _bytes(color: Sequence[float]) -> Bytes:
    return np.array([int(255.0 * share + 0.5) for share in color[:3]], dtype=np.uint8)

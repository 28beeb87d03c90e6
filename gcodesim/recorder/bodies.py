"""Bodies of the cell as the log draws them: links, fixtures, tools, tiles of stock."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Final

from gcodesim.frames import WORLD, Pose
from gcodesim.log import DrawnMesh, DrawnShape, DrawnSolid, Entity
from gcodesim.log.shapes import Color
from gcodesim.recorder.frames import Frames
from gcodesim.scene import Role
from gcodesim.scene.colors import CUT, DEVICE, FIXTURE, PART, RAW
from gcodesim.solids import Box, Cone, Cylinder, Hulls, Placed, Sphere, triangles_of

if TYPE_CHECKING:
    from gcodesim.material.surface import Tile
    from gcodesim.shop import Shop
    from gcodesim.tools.tool import Tool


_COLORS: Final[Mapping[Role, Color]] = {"fixture": FIXTURE, "part": PART, "obstacle": DEVICE}


def cell_entities(frames: Frames) -> tuple[Entity, ...]:
    """Links of the robot or machine, each in its frame; fixtures in the frame that carries them; parts in their own."""
    shop = frames.shop
    by_link: dict[int, list[DrawnShape]] = {}
    for own in shop.kinematics.link_shapes:
        shape = drawn(own.placed, own.rgba)
        by_link.setdefault(own.link, []).extend([] if shape is None else [shape])
    entities = [
        Entity(id=f"{shop.name}/{shop.kinematics.link_names[i]}", frame=frames.link_frame(i), shapes=tuple(shapes))
        for i, shapes in sorted(by_link.items())
        if shapes
    ]
    for body in shop.scene.bodies:
        is_part = body.name in frames.parts
        if not is_part and (body.role != "fixture" or not frames.draws(body.name)):
            continue
        frame, X = (body.name, Pose.identity()) if is_part else frames.carrier(body.name)
        shapes = [shape for placed in body.solids if (shape := drawn(placed.at(X), _COLORS[body.role])) is not None]
        if shapes:
            entities.append(Entity(id=body.name, frame=frame, shapes=tuple(shapes)))
    return tuple(entities)


def drawn(placed: Placed, color: Color) -> DrawnShape | None:
    """A solid as the log draws it; None if it cannot be drawn."""
    solid = placed.solid
    if isinstance(solid, Box | Cylinder | Cone | Sphere):
        X = placed.X_middle
        return DrawnSolid(solid=solid, p=X.p, q=X.q, color=color)
    if isinstance(solid, Hulls):
        return None
    try:
        skin = triangles_of(solid)
    except ValueError:  # reported as GS770 when the shop was opened
        return None
    return DrawnMesh(points=skin.points, triangles=skin.faces, p=placed.X.p, q=placed.X.q, color=color)


def tool_shapes(tool: Tool | None, opening: float = 1.0) -> tuple[DrawnShape, ...]:
    """The tool in the spindle, in frame `tool`: the tip at the origin, the body along −Z; a gripper `opening` open."""
    if tool is None:
        return ()
    shapes = (drawn(placed, tool.color_of(part)) for part, placed in tool.drawn(opening))
    return tuple(shape for shape in shapes if shape is not None)


def tools_in_stands(shop: Shop, away: Collection[int]) -> list[Entity]:
    """The tools that wait in their stands while machines have those with the numbers `away`."""
    found = []
    for number in sorted(shop.cell.magazine.stands):
        tool = shop.tool(number)
        if tool is None or number in away:
            continue
        X_WT = shop.stand(number) @ tool.X_FT
        shapes = (drawn(placed.at(X_WT), tool.color_of(part)) for part, placed in tool.drawn())
        shown = tuple(shape for shape in shapes if shape is not None)
        found.append(Entity(id=f"stand/T{number}", frame=WORLD, shapes=shown))
    return found


def tile_meshes(tile: Tile) -> tuple[DrawnMesh, ...]:
    """One tile of stock: surface that is as it was at the start, and surface that was changed."""
    facets = ((tile.original, RAW), (tile.changed, CUT))
    return tuple(DrawnMesh(points=p.points, triangles=p.triangles, tight=True, color=color) for p, color in facets)

"""Bodies of the cell as the log draws them: links, fixtures, tools, tiles of stock."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.cell import placement
from gcodesim.cell.stock import Box as BoxForm
from gcodesim.cell.stock import Cylinder as CylinderForm
from gcodesim.cell.stock import Mesh as MeshForm
from gcodesim.cell.stock import Shape as Form
from gcodesim.frames import Array, Pose
from gcodesim.log import Box, Cone, Cylinder, Entity, Mesh, Shape, Sphere
from gcodesim.recorder.frames import Frames
from gcodesim.tools.parts import body_part

if TYPE_CHECKING:
    from gcodesim.kinematics import LinkShape
    from gcodesim.material.surface import Tile
    from gcodesim.tools.tool import Tool

Color = tuple[float, float, float, float]

FIXTURE: Final[Color] = (0.45, 0.36, 0.28, 1.0)
RAW: Final[Color] = (0.62, 0.64, 0.67, 1.0)
CUT: Final[Color] = (0.86, 0.74, 0.42, 1.0)


def cell_entities(frames: Frames) -> tuple[Entity, ...]:
    """Links of the robot or machine, each in its frame, and fixtures in the frame that carries them."""
    shop = frames.shop
    by_link: dict[int, list[Shape]] = {}
    for shape in shop.kinematics.link_shapes:
        by_link.setdefault(shape.link, []).extend(_link_shape(shape))
    entities = [
        Entity(id=f"{shop.name}/{shop.kinematics.link_names[i]}", frame=frames.link_frame(i), shapes=tuple(shapes))
        for i, shapes in sorted(by_link.items())
        if shapes
    ]
    for name, fixture in shop.cell.fixtures.items():
        frame, X = frames.carrier(f"{placement.FIXTURE}/{name}")
        drawn = _form(fixture.shape, X)
        if drawn is not None:
            entities.append(Entity(id=f"{placement.FIXTURE}/{name}", frame=frame, shapes=(drawn,)))
    return tuple(entities)


def _link_shape(shape: LinkShape) -> list[Shape]:
    X = Pose.from_matrix(shape.X)
    if shape.kind == "box":
        return [Box(size=(shape.size[0], shape.size[1], shape.size[2]), p=X.p, q=X.q, color=shape.rgba)]
    if shape.kind == "cylinder":
        return [Cylinder(radius=shape.size[0], length=shape.size[1], p=X.p, q=X.q, color=shape.rgba)]
    if shape.kind == "sphere":
        return [Sphere(radius=shape.size[0], p=X.p, q=X.q, color=shape.rgba)]
    if shape.mesh is None:
        return []
    try:
        points, triangles = read_triangles(shape.mesh)
    except ValueError:  # said as GS770 when the shop was opened
        return []
    return [Mesh(points=points * np.array(shape.size), triangles=triangles, p=X.p, q=X.q, color=shape.rgba)]


def read_triangles(path: Path, scale: float = 1.0) -> tuple[Array, np.ndarray[tuple[int, int], np.dtype[np.int32]]]:
    """Points (v, 3) and triangles (t, 3) of a mesh file."""
    from gcodesim.material.mesh import read_mesh

    return read_mesh(path, scale)


def _form(form: Form, X: Pose) -> Shape | None:
    if isinstance(form, BoxForm):
        middle = 0.5 * (np.array(form.lower) + np.array(form.upper))
        return Box(size=form.size, p=X.apply(middle), q=X.q, color=FIXTURE)
    if isinstance(form, CylinderForm):
        middle = np.array([0.0, 0.0, 0.5 * (form.bottom + form.top)])
        return Cylinder(radius=form.radius, length=form.top - form.bottom, p=X.apply(middle), q=X.q, color=FIXTURE)
    if isinstance(form, MeshForm):
        points, triangles = read_triangles(form.path, form.scale)
        return Mesh(points=points, triangles=triangles, p=X.p, q=X.q, color=FIXTURE)
    return None


def tool_shapes(tool: Tool | None) -> tuple[Shape, ...]:
    """The tool in the spindle, in frame `tool`: the tip at the origin, the body along −Z."""
    if tool is None:
        return ()
    shapes: list[Shape] = []
    for body in tool.primitives:
        p = np.array([0.0, 0.0, -0.5 * (body.bottom + body.top)])
        color, length = body_part(body.part).color, body.top - body.bottom
        if body.kind == "sphere":
            shapes.append(Sphere(radius=body.radius, p=p, color=color))
        elif body.kind == "cone":
            shapes.append(
                Cone(bottom_radius=body.radius, top_radius=body.radius_bottom, length=length, p=p, color=color)
            )
        else:
            shapes.append(Cylinder(radius=body.radius, length=length, p=p, color=color))
    return tuple(shapes)


def tile_meshes(tile: Tile) -> tuple[Mesh, ...]:
    """One tile of stock: what is as it came, and what was changed."""
    facets = ((tile.original, RAW), (tile.changed, CUT))
    return tuple(Mesh(points=part.points, triangles=part.triangles, tight=True, color=color) for part, color in facets)

"""Bodies of an MJCF as solids of links."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

from gcodesim.arithmetic.matrices import inverse_pose, multiplied
from gcodesim.frames import Array, Pose, rotation_from_quaternion
from gcodesim.kinematics.chain import LinkSolid
from gcodesim.kinematics.xml_lines import Faults, LinedElement
from gcodesim.solids import Box, Cylinder, Mesh, MeshFile, Sphere

_SHOWN: Final = 3
"""Groups of bodies below this one are drawn, unless one says otherwise: MuJoCo's own viewer begins so."""

_PLAIN: Final = np.array([0.5, 0.5, 0.5, 1.0], dtype=np.float32)
"""The colour of a body that names none."""


def pose_of(position: Array, quaternion: Array) -> Array:
    """The matrix (4, 4) of a position (3,) and a quaternion (4,) w x y z, as MuJoCo has them."""
    w, x, y, z = quaternion
    return Pose(np.array(position, dtype=float), rotation_from_quaternion(np.array([x, y, z, w]))).matrix


def shapes_of(
    mujoco: Any, model: Any, body: int, files: dict[int, Path], faults: Faults, at: LinedElement | None
) -> tuple[tuple[LinkSolid, ...], tuple[LinkSolid, ...]]:
    """What is drawn of a body of `model`, and what of it collides; `files` are those of its meshes by their numbers."""
    visuals: list[LinkSolid] = []
    collisions: list[LinkSolid] = []
    kinds = mujoco.mjtGeom
    for g in range(int(model.body_geomadr[body]), int(model.body_geomadr[body] + model.body_geomnum[body])):
        shown = bool(model.geom_group[g] < _SHOWN)
        collides = bool(model.geom_contype[g] or model.geom_conaffinity[g])
        if not (shown or collides):
            continue
        solids = _solids(kinds, model, g, files)
        if not solids:
            kind = kinds(int(model.geom_type[g])).name.removeprefix("mjGEOM_").lower()
            name = model.geom(g).name or kind
            message = f"body `{name}` of link `{model.body(body).name}` is no kind of body that is taken over: `{kind}`"
            hint = "describe it as a box, a cylinder, a capsule, a sphere or a mesh file"
            if kind == "plane":
                hint = "a floor is no part of a robot: `fixtures: {floor: {box: …}}` in the cell"
            faults.find("GS770", message, at, hint)
        visuals += solids if shown else []
        collisions += solids if collides else []
    return tuple(visuals), tuple(collisions)


def _solids(kinds: Any, model: Any, g: int, files: dict[int, Path]) -> list[LinkSolid]:
    """The solids of one body; none for a kind that we do not have."""
    X, size = pose_of(model.geom_pos[g], model.geom_quat[g]), [float(v) for v in model.geom_size[g]]
    rgba = _colour(model, g)
    kind = int(model.geom_type[g])
    if kind == kinds.mjGEOM_BOX:
        x, y, z = (2.0 * half for half in size)
        return [LinkSolid(solid=Box.about_origin((x, y, z)), X=X, rgba=rgba)]
    if kind == kinds.mjGEOM_SPHERE:
        return [LinkSolid(solid=Sphere(radius=size[0]), X=X, rgba=rgba)]
    if kind in (kinds.mjGEOM_CYLINDER, kinds.mjGEOM_CAPSULE):
        radius, half = size[:2]
        found = [LinkSolid(solid=Cylinder(radius=radius, bottom=-half, top=half), X=X, rgba=rgba)]
        for end in (-half, half) if kind == kinds.mjGEOM_CAPSULE else ():
            at_end = multiplied(X, Pose(np.array([0.0, 0.0, end]), np.eye(3)).matrix)
            found.append(LinkSolid(solid=Sphere(radius=radius), X=at_end, rgba=rgba))
        return found
    number = int(model.geom_dataid[g])
    if kind == kinds.mjGEOM_MESH and number in files:
        x, y, z = (float(v) for v in model.mesh_scale[number])
        # MuJoCo puts a mesh on its own principal axes
        moved = inverse_pose(pose_of(model.mesh_pos[number], model.mesh_quat[number])[None])[0]
        return [
            LinkSolid(
                solid=Mesh(source=MeshFile(path=files[number], scale=(x, y, z))), X=multiplied(X, moved), rgba=rgba
            )
        ]
    return []


def _colour(model: Any, g: int) -> tuple[float, float, float, float]:
    """Its own colour, if it is not the one that MuJoCo gives to all; else that of its material."""
    material, own = int(model.geom_matid[g]), model.geom_rgba[g]
    r, green, b, a = (float(v) for v in (own if material < 0 or (own != _PLAIN).any() else model.mat_rgba[material]))
    return r, green, b, a

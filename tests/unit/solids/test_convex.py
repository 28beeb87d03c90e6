"""Convex bodies hold the solids that they stand for, and no more than they must."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.frames import Pose
from gcodesim.solids import (
    Box,
    Cone,
    Cylinder,
    Hull,
    Hulls,
    Mesh,
    Placed,
    Revolution,
    Solid,
    Sphere,
    facets_of,
    hulls_of,
    triangles_of,
)

X = Pose.from_xyz_rpy((0.3, -0.1, 0.2), (0.5, -0.7, 1.1))
BOX = Box(lower=(-0.01, 0.0, 0.005), upper=(0.03, 0.02, 0.015))
SOLIDS: tuple[Solid, ...] = (
    BOX,
    Cylinder(radius=0.01, bottom=-0.02, top=0.04),
    Cone(bottom_radius=0.02, top_radius=0.0, bottom=0.0, top=0.03),
    Sphere(radius=0.01),
    Revolution(outline=((0.0, 0.05), (0.01, 0.03), (0.01, 0.01), (0.004, 0.0))),
)


def inside(hull: Hull, points: np.ndarray, slack: float = 1e-9) -> np.ndarray:
    """Which points (n, 3) lie between the hull's faces."""
    along, own = points @ hull.normals.T, hull.corners @ hull.normals.T
    return np.all((along <= own.max(axis=0) + slack) & (along >= own.min(axis=0) - slack), axis=1)


@pytest.mark.parametrize("solid", SOLIDS)
def test_every_point_of_a_solid_lies_in_a_hull(solid: Solid) -> None:
    points = X.apply(triangles_of(solid).points)
    hulls = hulls_of(Placed(solid, X))

    assert np.any([inside(hull, points) for hull in hulls], axis=0).all()


@pytest.mark.parametrize("solid", SOLIDS)
def test_normals_are_unit_vectors(solid: Solid) -> None:
    for hull in hulls_of(Placed(solid, X)):
        assert np.linalg.norm(hull.normals, axis=1) == pytest.approx(1.0)


def test_the_sides_of_a_cone_are_faces_of_its_hull() -> None:
    """Along a slanted normal the hull ends where the cone does, up to the polygon that holds it."""
    (hull,) = hulls_of(Placed(Cone(bottom_radius=0.02, top_radius=0.0, bottom=0.0, top=0.03)))

    sides = hull.normals[:-1]
    most = (hull.corners @ sides.T).max(axis=0)
    top = np.array([0.0, 0.0, 0.03]) @ sides.T
    assert most == pytest.approx(top, abs=1e-12)


def test_a_mesh_is_a_body_a_triangle() -> None:
    skin = triangles_of(BOX)

    facets = facets_of(Placed(Mesh(source=skin), X))

    assert hulls_of(Placed(Mesh(source=skin))) == ()
    assert facets == pytest.approx(X.apply(skin.points)[skin.faces])


def test_convex_bodies_stay_what_they_are() -> None:
    (box,) = hulls_of(Placed(BOX))

    (again,) = hulls_of(Placed(Hulls(hulls=(box,)), X))

    assert again.corners == pytest.approx(X.apply(box.corners))

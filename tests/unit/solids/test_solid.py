"""Solids: volumes and places in closed form."""

from __future__ import annotations

from math import pi

import pytest

from gcodesim.frames import Pose
from gcodesim.solids import Box, Cone, Cylinder, Mesh, Placed, Revolution, Solid, Sphere

BOX = Box(lower=(-0.01, 0.0, 0.005), upper=(0.03, 0.02, 0.015))
ROD = Cylinder(radius=0.01, bottom=-0.02, top=0.04)
CONE = Cone(bottom_radius=0.02, top_radius=0.005, bottom=0.0, top=0.03)
BALL = Sphere(radius=0.01)
SPINDLE = Revolution(outline=((0.0, 0.05), (0.01, 0.03), (0.01, 0.01), (0.004, 0.0)))


@pytest.mark.parametrize(
    ("solid", "volume"),
    [
        (BOX, 0.04 * 0.02 * 0.01),
        (ROD, pi * 0.01**2 * 0.06),
        (CONE, pi * 0.03 * (0.02**2 + 0.02 * 0.005 + 0.005**2) / 3.0),
        (BALL, 4.0 * pi * 0.01**3 / 3.0),
        (SPINDLE, pi * (0.01**2 * 0.02 / 3.0 + 0.01**2 * 0.02 + (0.01**2 + 4e-5 + 1.6e-5) * 0.01 / 3.0)),
    ],
)
def test_volumes_are_those_of_the_closed_forms(solid: Solid, volume: float) -> None:
    assert not isinstance(solid, Mesh)
    assert solid.volume == pytest.approx(volume, rel=1e-12)  # type: ignore[union-attr]


def test_the_middle_of_a_placed_solid() -> None:
    X = Pose.from_xyz_rpy((1.0, 0.0, 0.0), (0.0, 0.0, pi / 2.0))

    assert Placed(BOX, X).X_middle.p == pytest.approx([0.99, 0.01, 0.01])
    assert Placed(ROD, X).at(X).X_middle.p == pytest.approx([1.0, 1.0, 0.01])


def test_equal_solids_are_equal() -> None:
    assert Box(lower=(0.0, 0.0, 0.0), upper=(1.0, 1.0, 1.0)) == Box(lower=(0.0, 0.0, 0.0), upper=(1.0, 1.0, 1.0))
    assert Cylinder(radius=0.01, bottom=-0.02, top=0.05) != ROD

"""Skins of solids: closed, outside counter-clockwise, of the right size."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.solids import Hulls, Mesh, Solid, triangles_of
from tests.unit.solids.test_solid import BALL, BOX, CONE, ROD, SPINDLE


@pytest.mark.parametrize(("solid", "error"), [(BOX, 1e-12), (ROD, 2e-3), (CONE, 2e-3), (BALL, 4e-3), (SPINDLE, 2e-3)])
def test_the_skin_encloses_the_volume_within_the_bounds(solid: Solid, error: float) -> None:
    """A prism of 64 sides lies inside the round body: 0.16 % less volume."""
    skin = triangles_of(solid)

    mesh = Mesh(source=skin)

    assert mesh.volume == pytest.approx(solid.volume, rel=error)  # type: ignore[union-attr]
    assert np.array(mesh.bounds) == pytest.approx(np.array(solid.bounds), abs=1e-4)


def test_convex_bodies_have_no_one_skin() -> None:
    with pytest.raises(ValueError, match="skin"):
        triangles_of(Hulls(hulls=()))

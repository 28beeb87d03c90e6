"""A piece as a body: its skin encloses its volume, its boxes lie within it, and what is left has none of it."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material.loose import PartedPiece, Parting
from gcodesim.material.loose_kernels import BodyWays
from gcodesim.material.shape import flat
from gcodesim.material.stock import Stock
from gcodesim.solids.mesh_file import Triangles

MM = 1e-3


def ring_cut(stock: Stock, radius: float) -> None:
    """A 3 mm cutter goes round the middle on a circle [mm]."""
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    points = np.column_stack([30 + radius * np.cos(angle), 20 + radius * np.sin(angle), np.full(361, -6.0)]) * MM
    stock.remove(points[:-1], points[1:], flat(3 * MM, 20 * MM))


def pieces_of(stock: Stock, cut: object, *radii: float) -> list[PartedPiece]:
    parting = Parting(stock)
    parting.bodies = True
    middle, beside = np.array([[30.0, 20.0, 0.0]]) * MM, np.full((1, 2), 100 * MM)
    found = []
    for radius in radii:
        kept = parting.keep(BodyWays(middle, middle, -beside, beside))
        cut(stock, radius)  # type: ignore[operator]
        parted = parting.parted(kept)
        assert parted is not None
        found += parting.take_out(parted)
    return found


def plate() -> Stock:
    return Stock.box((0.0, 0.0, -5 * MM), (60 * MM, 40 * MM, 0.0), 0.25 * MM)


def volume(skin: Triangles) -> float:
    a, b, c = (skin.points[skin.faces[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


def test_skin_and_boxes_of_a_disc_and_of_the_ring_around_it() -> None:
    disc, ring = pieces_of(plate(), ring_cut, 10.0, 16.0)

    for piece, exact in ((disc, np.pi * 8.5**2 * 5), (ring, np.pi * (14.5**2 - 11.5**2) * 5)):
        assert piece.body is not None
        assert volume(piece.body.skin) == pytest.approx(exact * MM**3, rel=0.01)
        boxes = piece.body.boxes
        filled = np.prod(boxes[:, 1] - boxes[:, 0], axis=1).sum()
        assert 0.75 * exact * MM**3 < filled < exact * MM**3
    radius = np.hypot(*(np.abs(ring.body.boxes[:, :, :2] - np.array([30, 20]) * MM).transpose(2, 0, 1)))  # type: ignore[union-attr]
    assert radius.max() < 14.9 * MM
    middle = ring.body.boxes.mean(axis=1)[:, :2] - np.array([30, 20]) * MM  # type: ignore[union-attr]
    assert np.hypot(*middle.T).min() > 11.4 * MM  # the ring's hole is free


def test_what_is_left_has_nothing_of_the_piece() -> None:
    stock = plate()
    (disc,) = pieces_of(stock, ring_cut, 10.0)
    assert disc.body is not None

    points = disc.body.rest.points - np.array([30 * MM, 20 * MM, 0.0])
    assert np.hypot(points[:, 0], points[:, 1]).min() > 11.2 * MM


def test_nobody_pays_who_does_not_ask() -> None:
    stock = plate()
    parting = Parting(stock)
    middle, beside = np.array([[30.0, 20.0, 0.0]]) * MM, np.full((1, 2), 100 * MM)
    kept = parting.keep(BodyWays(middle, middle, -beside, beside))
    ring_cut(stock, 10.0)
    parted = parting.parted(kept)
    assert parted is not None

    assert [piece.body for piece in parting.take_out(parted)] == [None]

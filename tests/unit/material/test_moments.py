"""The centre and the inertia of what is left, against solids that are known; also of a stock on its side."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material.moments import mass_of_stock
from gcodesim.material.shape import flat
from gcodesim.material.stock import Stock
from gcodesim.material.turning import turned

MM = 1e-3
SIDE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def test_a_box_with_a_step() -> None:
    """40 x 20 x 10 mm, of which a slot takes x > 30 mm down to 4 mm: two boxes."""
    stock = Stock.box((0.0, 0.0, 0.0), (40 * MM, 20 * MM, 10 * MM), 0.5 * MM)
    way = np.array([[40.0, -20.0, 4.0], [40.0, 40.0, 4.0]]) * MM
    stock.remove(way[:1], way[1:], flat(20 * MM, 30 * MM))
    body = mass_of_stock(stock, 1.0)
    assert body is not None

    boxes = [
        (30.0 * 20 * 10, (15.0, 10.0, 5.0), (30.0, 20.0, 10.0)),
        (10.0 * 20 * 4, (35.0, 10.0, 2.0), (10.0, 20.0, 4.0)),
    ]
    total = sum(v for v, _, _ in boxes)
    center = sum(v * np.array(c) for v, c, _ in boxes) / total
    inertia = np.zeros((3, 3))
    for v, c, size in boxes:
        own = np.array(size) ** 2 / 12.0
        away = np.array(c) - center
        inertia += v / total * (np.diag(own.sum() - own) + away @ away * np.eye(3) - np.outer(away, away))
    assert body.center / MM == pytest.approx(center, abs=1e-6)
    assert body.inertia / MM**2 == pytest.approx(inertia, abs=1e-6)


def test_a_stock_on_its_side_has_its_centre_in_its_own_frame() -> None:
    stock = Stock.box((0.0, 0.0, 0.0), (40 * MM, 20 * MM, 10 * MM), 0.5 * MM)
    way = np.array([[40.0, -20.0, 4.0], [40.0, 40.0, 4.0]]) * MM
    stock.remove(way[:1], way[1:], flat(20 * MM, 30 * MM))
    upright, lying = mass_of_stock(stock, 2.0), mass_of_stock(turned(stock, SIDE), 2.0)
    assert upright is not None
    assert lying is not None

    assert lying.center == pytest.approx(upright.center, abs=0.05 * MM)
    assert lying.inertia == pytest.approx(upright.inertia, rel=0.01, abs=1e-7)


def test_nothing_left() -> None:
    assert mass_of_stock(Stock.empty((0.0, 0.0, 0.0), (MM, MM, MM), 0.5 * MM), 1.0) is None

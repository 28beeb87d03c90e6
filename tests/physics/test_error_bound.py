"""The stated bound of a volume against the true error of closed forms, on several grids that lie anywhere."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gcodesim.material import Stock, shape
from gcodesim.material.stock_file import load_stock, save_stock

MM, MM3 = 1e-3, 1e-9
Cut = Callable[[Stock], float]
"""Cuts a stock; the volume [mm³] that this takes, in closed form."""


def cut(stock: Stock, points: object, tool: object) -> None:
    at = np.asarray(points, dtype=float) * MM
    stock.remove(at[:-1], at[1:], tool)


def slot(angle: float, diameter: float, depth: float, length: float) -> Cut:
    def run(stock: Stock) -> float:
        dx, dy = 0.5 * length * math.cos(math.radians(angle)), 0.5 * length * math.sin(math.radians(angle))
        cut(stock, [[40 - dx, 25 - dy, -depth], [40 + dx, 25 + dy, -depth]], shape.flat(diameter * MM, 30 * MM))
        return depth * (diameter * length + math.pi / 4 * diameter**2)

    return run


def groove(stock: Stock) -> float:
    a = np.linspace(math.pi, 2 * math.pi, 401)
    cut(stock, np.c_[40 + 20 * np.cos(a), 25 + 20 * np.sin(a), np.full(401, -2.0)], shape.flat(6 * MM, 30 * MM))
    return 2 * (6 * 20 * math.pi + 9 * math.pi)


def bore(stock: Stock) -> float:
    a = np.linspace(0, 12 * math.pi, 1201)
    path = np.c_[40 + 5 * np.cos(a), 25 + 5 * np.sin(a), np.maximum(-a / math.pi, -10)]
    cut(stock, path, shape.flat(6 * MM, 30 * MM))
    return 10 * math.pi * (8**2 - 2**2)


def ball_slot(angle: float, depth: float) -> Cut:
    def run(stock: Stock) -> float:
        r, h, x, y = 3.0, min(depth, 3.0), math.cos(math.radians(angle)), math.sin(math.radians(angle))
        cut(stock, [[25, 15, -depth], [25 + 20 * x, 15 + 20 * y, -depth]], shape.ball(6 * MM, 30 * MM))
        section = r * r * math.acos((r - h) / r) - (r - h) * math.sqrt(2 * r * h - h * h) + 6 * (depth - h)
        return 20 * section + math.pi * h * h * (3 * r - h) / 3 + math.pi * 9 * (depth - h)

    return run


def cone(stock: Stock) -> float:
    cut(stock, [[40, 25, 5], [40, 25, -6]], shape.cone(20 * MM, math.pi / 2, 40 * MM))
    return math.pi * 6**3 / 3


def chamfered(angle: float) -> Cut:
    def run(stock: Stock) -> float:
        x, y = 20 * math.cos(math.radians(angle)), 20 * math.sin(math.radians(angle))
        cut(stock, [[25, 15, -3], [25 + x, 15 + y, -3]], shape.cone(20 * MM, math.pi / 2, 40 * MM))
        return 20 * 9 + math.pi * 9

    return run


def ring(radius: float, tool: float) -> Cut:
    """A round groove, whose two walls bend opposite ways."""

    def run(stock: Stock) -> float:
        a = np.linspace(0, 2 * math.pi, 2001)
        path = np.c_[40 + radius * np.cos(a), 25 + radius * np.sin(a), np.full(2001, -2.0)]
        cut(stock, path, shape.flat(tool * MM, 30 * MM))
        return 4 * math.pi * radius * tool

    return run


def dome(stock: Stock) -> float:
    cut(stock, [[40, 25, 5], [40, 25, -2]], shape.ball(10 * MM, 30 * MM))
    return math.pi * 4 * (3 * 5 - 2) / 3


def drilled(stock: Stock) -> float:
    point = 4 / math.tan(math.radians(59))
    cut(stock, [[40, 25, 5], [40, 25, -10]], shape.cone(8 * MM, math.radians(118), 40 * MM))
    return math.pi * 16 * (10 - point) + math.pi * 16 * point / 3


FORMS = {
    "ring": ring(6, 5), "slot": slot(0, 6, 2, 30), "turned slot": slot(30, 6, 2, 30), "slot at 45": slot(45, 6, 2, 30),
    "narrow slot": slot(30, 2, 1, 20), "arc groove": groove, "helix bore": bore, "ball slot": ball_slot(0, 1),
    "deep ball slot": ball_slot(0, 5), "turned ball slot": ball_slot(17, 3), "ball slot at 45": ball_slot(45, 3),
    "cone": cone, "groove": chamfered(0), "turned groove": chamfered(30), "dome": dome, "drilled": drilled,
}  # fmt: skip


UNDONE = ("groove", "turned groove", "ring")
"""Three kinks, or a hollow and a round wall, whose errors nearly undo each other."""


def table(form: Cut, cell: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Errors and bounds [mm³] on twelve grids that lie anywhere, of cells up to a tenth smaller or larger."""
    errors, bounds = [], []
    for k, (x, y) in enumerate((np.random.default_rng(seed).random((12, 2)) - 0.5) * cell):
        own = (0.9 + 0.018 * k) * cell * MM
        stock = Stock.box(((x - 2) * MM, (y - 2) * MM, -15 * MM), ((x + 82) * MM, (y + 52) * MM, 0), own)
        before = stock.volume
        exact = form(stock)
        errors.append(abs((before - stock.volume) / MM3 - exact))
        bounds.append(stock.error_bound() / MM3)
    return np.array(errors), np.array(bounds)


def test_the_bound_of_cuts_across_each_other_is_not_exceeded() -> None:
    """Round ends, slopes and chords of three tools in one block, beside a grid that is ten times as fine."""
    points = np.array([[5, 5, -3], [35, 12, -3], [20, 25, -6], [8, 8, -1]]) * MM
    for cell in (1.0, 0.5, 0.25):
        coarse, fine = (Stock.box((0, 0, -15 * MM), (40 * MM, 30 * MM, 0), own * MM) for own in (cell, 0.05))
        for stock in (coarse, fine):
            for tool in (shape.ball(6 * MM, 20 * MM), shape.flat(5 * MM, 20 * MM), shape.cone(8 * MM, 2.0, 20 * MM)):
                stock.remove(points[:-1], points[1:], tool)
        assert abs(coarse.volume - fine.volume) <= coarse.error_bound()


@pytest.mark.parametrize("cell", [1.0, 0.5, 0.25])
@pytest.mark.parametrize("name", FORMS)
def test_the_bound_is_never_exceeded_and_not_far_above(name: str, cell: float) -> None:
    """The mean bound over the root mean square of the errors: of a single grid the error may be 0 by chance."""
    errors, bounds = table(FORMS[name], cell, seed=int(100 * cell))

    assert (errors <= bounds).all()
    assert bounds.mean() <= (15.0 if name in UNDONE else 10.0) * np.sqrt((errors**2).mean())


@pytest.mark.parametrize("cells", [23.8, 24.0, 24.2, 36.1])
@pytest.mark.parametrize("form", [ball_slot(0, 5), chamfered(0)], ids=["ball", "vee"])
def test_edges_a_round_number_of_cells_apart(form: Cut, cells: float) -> None:
    """Waves of 1, 2, 3, 4 cells and their like undo each other there; the bound was a quarter of the error."""
    for shift in (0.0, 0.3, 0.7):
        own = 6 / cells
        stock = Stock.box(((shift * own - 2) * MM, -2 * MM, -15 * MM), (82 * MM, 52 * MM, 0), own * MM)
        before = stock.volume
        exact = form(stock)
        assert abs((before - stock.volume) / MM3 - exact) <= stock.error_bound() / MM3


@pytest.mark.parametrize("cell", [1.0, 0.5])
def test_slopes_beside_walls_and_at_borders(cell: float) -> None:
    """A flat and a wider ball along one way, which leaves the stock: beside a grid that is ten times as fine."""
    points = np.array([[12, -6, -2], [21, 36, -2], [46, 9, -2], [20, 9, -2]]) * MM
    coarse, fine = (Stock.box((0, 0, -15 * MM), (40 * MM, 30 * MM, 0), own * MM) for own in (cell, 0.05))
    for stock in (coarse, fine):
        for tool in (shape.ball(7 * MM, 20 * MM), shape.flat(3 * MM, 20 * MM)):
            stock.remove(points[:-1], points[1:], tool)
    assert abs(coarse.volume - fine.volume) <= coarse.error_bound()


@pytest.mark.slow
def test_the_bound_of_drawn_forms() -> None:
    """2400 grids: never exceeded, and typically within ten times the error."""
    draw = np.random.default_rng(15)
    shares = []
    for seed in range(200):
        angle, cell = float(draw.uniform(0, 90)), float(draw.choice([1.0, 0.5, 0.25]))
        drawn = (
            slot(angle, draw.uniform(3, 10), draw.uniform(0.5, 5), draw.uniform(10, 35)),
            ball_slot(angle, draw.uniform(0.5, 6)),
            chamfered(angle),
            ring(draw.uniform(4, 12), draw.uniform(2, 7)),
        )
        errors, bounds = table(drawn[seed % 4], cell, seed)
        assert (errors <= bounds).all()
        shares.append(float(bounds.mean() / np.sqrt((errors**2).mean())))
    assert np.median(shares) <= 8.0 and np.quantile(shares, 0.9) <= 20.0


@pytest.mark.parametrize("pitch", [0.3, 0.39, 0.6, 0.75, 0.983, 1.0, 1.3, 1.5, 2.0, 2.5])
@pytest.mark.parametrize("cell", [0.5, 0.25, 0.13])
def test_ball_raster(pitch: float, cell: float) -> None:
    """Rows of cusps, of which a grid with a like pitch sees only some heights, or always the same."""
    rows = np.arange(-5.02, 55, pitch)
    stock = Stock.box((0, 0, -15 * MM), (80 * MM, 50 * MM, 0), cell * MM)
    for y in rows:
        cut(stock, [[-9, y, -1], [89, y, -1]], shape.ball(6 * MM, 30 * MM))
    exact = 80 * (50 - cusps_of(rows, 50.0, 3.0))

    assert abs(60_000 - stock.volume / MM3 - exact) <= stock.error_bound() / MM3


@pytest.mark.parametrize("share", [0.25, 1.0 / 3.0, 0.5, 0.51, 0.75, 0.99, 1.0, 1.003, 1.02, 2.026])
@pytest.mark.parametrize("along", [0, 1])
def test_rows_that_meet_every_column_alike(share: float, along: int) -> None:
    """Ridges that no height shows: the bound was down to 1e-5 of the error."""
    radius, deep, shares = 3.0, 1.0, []
    for cell, off in ((0.31, 0.0), (0.31, 0.4), (0.47, 0.13), (0.2, 0.5)):
        size = [20 * cell, 60 * cell]
        stock = Stock.box((0, 0, -6 * MM), (size[along] * MM, size[1 - along] * MM, 0), cell * MM)
        pitch = share * cell
        rows = np.arange((off - 20) * pitch - 2 * radius, size[1] + 2 * radius, pitch)
        for row in rows:
            ends = np.array([[-9.0, row, -deep], [size[0] + 9.0, row, -deep]])
            cut(stock, ends if along == 0 else ends[:, [1, 0, 2]], shape.ball(2 * radius * MM, 30 * MM))
        exact = size[0] * (size[1] * deep - float(cusps_of(rows, size[1], radius)))
        error = abs(size[0] * size[1] * 6 - stock.volume / MM3 - exact)
        shares.append(error * MM3 / stock.error_bound())
    assert max(shares) <= 1.0


def rows_of_a_cone(stock: Stock, pitch: float, size: tuple[float, float], flat: float) -> float:
    """Cut a block with a pointed tool of 90 degrees in rows, 1 mm deep; the volume [mm³] that this takes."""
    rows = np.arange(0.3 * pitch - 9.0, size[1] + 9.0, pitch)
    for y in rows:
        cut(stock, [[-9, y, -1], [size[0] + 9, y, -1]], shape.cone(6 * MM, math.pi / 2, 30 * MM, 2 * flat * MM))
    ends = np.r_[0.0, [y for y in 0.5 * (rows[1:] + rows[:-1]) if 0 < y < size[1]], size[1]]
    nearest = rows[np.abs(rows[:, None] - 0.5 * (ends[1:] + ends[:-1])).argmin(axis=0)]
    under = lambda u: 0.5 * np.sign(u) * np.maximum(np.abs(u) - flat, 0.0) ** 2  # noqa: E731
    return size[0] * float(size[1] - (under(ends[1:] - nearest) - under(ends[:-1] - nearest)).sum())


@pytest.mark.parametrize("share", [0.34, 0.5, 0.99, 1.0, 1.3, 2.0])
@pytest.mark.parametrize("flat", [0.0, 0.1])
def test_rows_of_a_pointed_tool(share: float, flat: float) -> None:
    """Its ridges were in no bound: the error was a hundred times what was said."""
    for cell in (0.25, 0.31, 0.47):
        size = (20 * cell, 40 * cell)
        stock = Stock.box((0, 0, -6 * MM), (size[0] * MM, size[1] * MM, 0), cell * MM)
        exact = rows_of_a_cone(stock, share * cell, size, flat)
        assert abs(size[0] * size[1] * 6 - stock.volume / MM3 - exact) <= stock.error_bound() / MM3


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_ridges_of_an_earlier_run_that_are_taken_away(tmp_path: Path, share: float) -> None:
    """The file of the stock knows of them."""
    for cell in (0.31, 0.47):
        size = (20 * cell, 40 * cell)
        stock = Stock.box((0, 0, -6 * MM), (size[0] * MM, size[1] * MM, 0), cell * MM)
        left = size[0] * size[1] * 6 - rows_of_a_cone(stock, share * cell, size, 0.0)
        stock = handed_on(stock, tmp_path)
        before = stock.volume / MM3
        for y in np.arange(0, size[1] + 6, 6):
            cut(stock, [[-9, y, -2], [size[0] + 9, y, -2]], shape.flat(8 * MM, 30 * MM))
        exact = left - size[0] * size[1] * 4
        assert abs(before - stock.volume / MM3 - exact) <= stock.error_bound() / MM3


def cusps_of(rows: np.ndarray, width: float, radius: float) -> float:
    """Section [mm²] of what a ball leaves between rows along a face of some width."""
    ends = np.r_[0.0, [y for y in 0.5 * (rows[1:] + rows[:-1]) if 0 < y < width], width]
    nearest = rows[np.abs(rows[:, None] - 0.5 * (ends[1:] + ends[:-1])).argmin(axis=0)]
    under = lambda u: 0.5 * (u * np.sqrt(radius**2 - u * u) + radius**2 * np.arcsin(u / radius))  # noqa: E731
    return float((radius * (ends[1:] - ends[:-1]) - (under(ends[1:] - nearest) - under(ends[:-1] - nearest))).sum())


def test_a_floor_of_another_tool_has_no_ridges() -> None:
    """A flat mill clears what a ball has cut in close rows; the bound is what it is without them."""
    bounds = []
    for first in (True, False):
        stock = Stock.box((0, 0, -15 * MM), (40 * MM, 30 * MM, 0), 0.25 * MM)
        for y in np.arange(-4, 34, 0.2) if first else ():
            cut(stock, [[-9, y, -1], [49, y, -1]], shape.ball(6 * MM, 30 * MM))
        for y in np.arange(0, 31, 5):
            cut(stock, [[-9, y, -2], [49, y, -2]], shape.flat(8 * MM, 30 * MM))
        bounds.append(stock.error_bound())
    assert bounds[0] == bounds[1]


def test_a_straight_wall_is_exact_and_says_so() -> None:
    stock = Stock.box((0, 0, -15 * MM), (80 * MM, 50 * MM, 0), 0.25 * MM)
    cut(stock, [[-15, 25.13, -3], [95, 25.13, -3]], shape.flat(8 * MM, 30 * MM))

    error = abs(60_000 - stock.volume / MM3 - 1920)
    assert error <= stock.error_bound() / MM3 < 1e-3


def handed_on(stock: Stock, folder: Path) -> Stock:
    save_stock(stock, folder / "part.stock")
    return load_stock(folder / "part.stock")


@pytest.mark.parametrize("turned", [0.0, 90.0])
def test_walls_of_an_earlier_run_are_no_error_of_this_one(tmp_path: Path, turned: float) -> None:
    """A slot far from what was cut before has the bound that it has alone, whatever its way on the grid."""
    both, alone = (Stock.box((0, 0, -15 * MM), (80 * MM, 50 * MM, 0), 0.43 * MM) for _ in range(2))
    slot(14.0, 6.0, 3.0, 20.0)(both)
    both = handed_on(both, tmp_path)
    for stock in (both, alone):
        angle = math.radians(turned + 7.0)
        way = np.array([[70.0, 40.0, -4.0], [70.0 + 6 * math.cos(angle), 40.0 + 6 * math.sin(angle), -4.0]])
        cut(stock, way, shape.flat(5 * MM, 30 * MM))

    assert both.error_bound() == pytest.approx(alone.error_bound(), rel=1e-9) and alone.error_bound() > 0.0


@pytest.mark.parametrize("angle", [0.0, 11.0, 38.0, 90.0])
@pytest.mark.parametrize("aside", [0.0, 2.3])
def test_the_bound_holds_where_an_earlier_run_has_cut(tmp_path: Path, angle: float, aside: float) -> None:
    """A slot from side to side is cut 2 mm deeper, or wider: no more than the bound off."""
    u = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    n = np.array([-u[1], u[0]])
    for resolution in (0.31, 0.47):
        stock = Stock.box((-20 * MM, -20 * MM, -15 * MM), (20 * MM, 20 * MM, 0), resolution * MM)
        tool = shape.flat(6 * MM, 30 * MM)
        cut(stock, [[*(-60 * u), -3.0], [*(60 * u), -3.0]], tool)
        stock = handed_on(stock, tmp_path)
        before = stock.volume
        cut(stock, [[*(aside * n - 60 * u), -5.0], [*(aside * n + 60 * u), -5.0]], tool)
        exact = 2.0 * strip(u, aside - 3.0, aside + 3.0) + 3.0 * strip(u, 3.0, aside + 3.0)

        error, bound = abs((before - stock.volume) / MM3 - exact), stock.error_bound() / MM3
        assert error <= bound <= (0.1 if aside else 0.01) * exact  # a wall that is gone is a step of any place


def strip(u: np.ndarray, low: float, high: float) -> float:
    """Area [mm²] of a square of 40 mm about the origin within a strip along `u` from `low` to `high` to its left."""
    s = np.linspace(low, high, 20_001)
    s = 0.5 * (s[:-1] + s[1:])
    ends = np.full((2, len(s)), [[-np.inf], [np.inf]])
    for way, side in zip(u, (-u[1], u[0]), strict=True):  # the point at t along u: s n + t u within the square
        if abs(way) > 1e-12:
            a, b = sorted(((-20 - s * side) / way, (20 - s * side) / way), key=lambda t: float(t[0]))
            ends[0], ends[1] = np.maximum(ends[0], a), np.minimum(ends[1], b)
    return float(np.maximum(ends[1] - ends[0], 0.0).sum() * (high - low) / len(s)) if high > low else 0.0

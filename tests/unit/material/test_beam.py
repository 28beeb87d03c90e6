"""Beams of rays on columns: volume and dose are kept, depths are those of the closed forms, shade is shade."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.material.beam import PROFILES, BeamForm, BeamWay, strike_stock
from gcodesim.material.stock import Stock

CELL = 0.1e-3
RATE = 8e-9  # m³/s
SPEED = 4e-3  # m/s


def plate(thickness: float = 6e-3, cell: float = CELL) -> Stock:
    return Stock.box((0.0, 0.0, -thickness), (10e-3, 8e-3, 0.0), cell)


def form(profile: str = "flat", radius: float = 0.5e-3, **more: float) -> BeamForm:
    keys = {"focus": 0.0, "rayleigh": np.inf, "slope": 0.0, "mouth": -3e-3, "reach": 50e-3} | more
    return BeamForm(profile=PROFILES[profile], radius=radius, **keys)


def way(axis: tuple[float, float, float] = (0.0, 0.0, 1.0), rate: float = RATE, pieces: int = 20) -> BeamWay:
    """Along X from 2 to 8 mm, through the middle of the plate."""
    x = np.linspace(2e-3, 8e-3, pieces + 1)
    points = np.column_stack([x, np.full(pieces + 1, 4.02e-3), np.zeros(pieces + 1)])
    seconds = np.diff(x) / SPEED
    axes = np.tile(np.array(axis) / np.linalg.norm(axis), (pieces, 1))
    return BeamWay(points[:-1], points[1:], axes, rate * seconds, 100.0 * seconds)


def depths(stock: Stock, x: float = 5e-3) -> np.ndarray:
    """Depth (ny,) [m] along the line across the track at x."""
    _, hi, number = stock.field.columns
    i = int(x / stock.cell)
    top = np.array([hi[i, j, n - 1] if n else stock.z_range[0] for j, n in enumerate(number[i])])
    return -top


def middles(stock: Stock) -> np.ndarray:
    return (np.arange(stock.field.columns.number.shape[1]) + 0.5) * stock.spacing[1] - 4.02e-3


LEANS = [(0.0, 0.0, 1.0), (0.0, 0.5, 1.0), (1.0, 0.0, 1.0), (-0.7, 0.4, 0.3), (0.0, 1.0, 0.2)]


@pytest.mark.parametrize("axis", LEANS)
@pytest.mark.parametrize("profile", PROFILES)
def test_volume_and_dose_are_what_was_given(profile: str, axis: tuple[float, float, float]) -> None:
    """All rays meet the wide plate, so all that they could take is gone, and all that they give is in the map."""
    stock = Stock.box((0.0, 0.0, -6e-3), (40e-3, 30e-3, 0.0), 0.4e-3)
    before = stock.volume
    track, shift = way(axis), np.array([15e-3, 11e-3, 0.0])
    track = track._replace(starts=track.starts + shift, ends=track.ends + shift)

    struck = strike_stock(stock, form(profile), track, "test")

    assert struck.taken.sum() == pytest.approx(track.volume.sum(), rel=1e-9)
    assert struck.met.sum() == pytest.approx(track.given.sum(), rel=1e-9)
    assert before - stock.volume == pytest.approx(track.volume.sum(), rel=1e-9)
    area = float(np.prod(stock.spacing))
    assert stock.doses["test"].sum() * area == pytest.approx(track.given.sum(), rel=1e-9)
    assert struck.dose.max() == stock.doses["test"].max()


def test_a_flat_jet_leaves_a_level_floor_of_the_depth_of_the_closed_form() -> None:
    """depth = rate / (width · feed) = 8 mm³/s / (1 mm · 4 mm/s) = 2 mm."""
    stock = plate()
    strike_stock(stock, form(), way(), "test")
    inside = np.abs(middles(stock)) < 0.35e-3

    assert depths(stock)[inside].mean() == pytest.approx(2e-3, rel=5e-3)
    assert np.abs(depths(stock)[inside] - 2e-3).max() < 0.06e-3
    assert depths(stock)[np.abs(middles(stock)) > 0.6e-3].max() == 0.0


def share_left(profile: str, u: np.ndarray) -> np.ndarray:
    """The share of a track to one side of a line at u radii from its middle."""
    if profile == "gaussian":
        return np.array([0.5 * math.erfc(-math.sqrt(2.0) * each) for each in u])
    inside = np.clip(u, -1.0, 1.0)
    if profile == "top_hat":
        return 0.5 + (inside * np.sqrt(1.0 - inside**2) + np.arcsin(inside)) / np.pi
    return 0.5 * (1.0 + inside)


@pytest.mark.parametrize("degrees", [0.0, 20.0])
@pytest.mark.parametrize("cell", [0.05e-3, 0.13e-3, 0.24e-3])
@pytest.mark.parametrize("profile", PROFILES)
def test_each_column_across_a_track_gets_what_belongs_to_it(profile: str, cell: float, degrees: float) -> None:
    """The rim of a sharp beam belongs to it: without it the floor was 2.5 % too deep, and the kerf too narrow."""
    lean, radius = np.radians(degrees), 0.5e-3
    stock = plate(cell=cell)
    strike_stock(stock, form(profile, radius), way((0.0, np.sin(lean), np.cos(lean)), rate=0.0, pieces=60), "test")

    got = stock.doses["test"][len(stock.doses["test"]) // 2]
    edges = np.arange(len(got) + 1) * stock.spacing[1] - 4.02e-3
    exact = np.diff(share_left(profile, edges * np.cos(lean) / radius)) / stock.spacing[1] * 100.0 / SPEED
    off = np.abs(got - exact).max() / exact.max()
    assert off < (0.016 if degrees == 0.0 else 0.06)  # rays stand by columns, which cut a footprint that leans unevenly
    assert got.sum() == pytest.approx(exact.sum(), rel=6e-3)


def test_a_gaussian_spot_leaves_a_gaussian_track() -> None:
    """The track is sqrt(2 / pi) V / (w v) deep in its middle and falls with exp(-2 y² / w²)."""
    stock = plate(cell=0.05e-3)
    radius, rate = 0.5e-3, 2e-9
    strike_stock(stock, form("gaussian", radius), way(rate=rate), "test")

    y = middles(stock)
    exact = np.sqrt(2.0 / np.pi) * rate / (radius * SPEED) * np.exp(-2.0 * (y / radius) ** 2)
    assert np.abs(depths(stock) - exact).max() < 0.02 * exact.max()


@pytest.mark.parametrize("degrees", [30.0, 60.0])
def test_a_jet_that_leans_across_its_way_goes_less_deep(degrees: float) -> None:
    """Its footprint is longer by 1 / cos, so the level floor is cos times as deep; the sum stays."""
    lean = np.radians(degrees)
    stock = plate(cell=0.05e-3)
    strike_stock(stock, form("top_hat"), way((0.0, np.sin(lean), np.cos(lean)), rate=0.1 * RATE), "test")
    lo, hi, number = stock.field.columns
    held = np.where(np.arange(lo.shape[2]) < number[100][:, None], hi[100] - lo[100], 0.0).sum(axis=1)
    track = 6e-3 - held  # what is gone of each column, also below its top

    assert track.sum() * stock.spacing[1] == pytest.approx(0.1 * RATE / SPEED, rel=0.02)
    cut = track > 0.1 * track.max()
    assert cut.sum() * stock.spacing[1] == pytest.approx(1e-3 / np.cos(lean), rel=0.1)


@pytest.mark.parametrize("degrees", [-25.0, -16.0, -5.0, 0.0, 1.0, 10.0, 20.0])
def test_a_jet_from_the_side_goes_into_the_side(degrees: float) -> None:
    """As deep as from above, within its own footprint, however level it is; nothing is lost or passed by."""
    block = Stock.box((-6e-3, -6e-3, -6e-3), (6e-3, 6e-3, 6e-3), 0.25e-3)
    rise, n = np.radians(degrees), 40
    ends = np.linspace([-4.03e-3, 6e-3, 0.07e-3], [4.03e-3, 6e-3, 0.07e-3], n + 1)
    axis = np.array([0.0, np.cos(rise), -np.sin(rise)])
    way = BeamWay(ends[:-1], ends[1:], np.tile(axis, (n, 1)), np.full(n, 24e-9 / n), np.ones(n))
    struck = strike_stock(block, form("top_hat", 1e-3)._replace(mouth=-1e-3, reach=40e-3), way, "test")
    gone = removed_points(block, 0.02e-3)
    deep = (6e-3 - gone[:, 1]) / np.cos(rise)
    beside = (gone[:, 2] - 0.07e-3 - np.tan(rise) * (6e-3 - gone[:, 1])) * np.cos(rise)

    assert struck.taken.sum() == pytest.approx(24e-9, rel=1e-6)
    assert struck.met.sum() == pytest.approx(n, rel=1e-9)
    assert len(gone) * 0.25e-3**2 * 0.02e-3 == pytest.approx(24e-9, rel=0.01)
    assert abs(beside).max() < 1e-3 + 0.3e-3
    assert deep.max() < 1.91e-3 + 0.6e-3  # 24 mm³ over pi/2 · 8 mm of chords, in their middle
    assert np.median(deep) == pytest.approx(0.75e-3, abs=0.15e-3)


def removed_points(stock: Stock, step: float) -> np.ndarray:
    """Points (n, 3) of a box of +-6 mm that hold nothing any more, `step` apart along z and a column across."""
    lo, hi, number = stock.field.columns
    z = np.arange(-6e-3 + 0.5 * step, 6e-3, step)
    held = np.zeros((*number.shape, len(z)), dtype=bool)
    for k in range(lo.shape[2]):
        held |= (k < number)[:, :, None] & (z >= lo[:, :, k, None]) & (z < hi[:, :, k, None])
    i, j, k = np.nonzero(~held)
    grid = stock.field.grid
    return np.stack([grid.x + (i + 0.5) * grid.dx, grid.y + (j + 0.5) * grid.dy, z[k]], axis=1)


def test_what_goes_through_is_not_kept() -> None:
    """A jet that could go 10 mm deep cuts a slit through 6 mm; the rest met nothing."""
    stock = plate()
    track = way(rate=5 * RATE)
    struck = strike_stock(stock, form(), track, "test")

    assert (stock.field.columns.number[50, 36:44] == 0).all()
    share = struck.met.sum() / track.given.sum()
    assert struck.taken.sum() == pytest.approx(share * track.volume.sum(), rel=1e-9)
    assert 0.55 < share < 0.7


def test_a_beam_without_a_specific_energy_gives_a_dose_alone() -> None:
    stock = plate()
    struck = strike_stock(stock, form("gaussian"), way(rate=0.0), "test")

    assert struck.taken.sum() == 0.0 and stock.volume == pytest.approx(480e-9)
    assert stock.doses["test"].max() == pytest.approx(np.sqrt(2 / np.pi) * 100.0 / (0.5e-3 * SPEED), rel=0.02)


def test_below_the_threshold_nothing_goes() -> None:
    """Half the greatest dose as threshold: what is taken is what the doses are above it."""
    most = np.sqrt(2 / np.pi) * 100.0 / (0.5e-3 * SPEED)
    stock = plate()
    track = way()
    struck = strike_stock(stock, form("gaussian"), track, "test", threshold=0.5 * most)
    dose = stock.doses["test"]

    above = np.maximum(dose - 0.5 * most, 0.0).sum() * float(np.prod(stock.spacing))
    assert struck.taken.sum() == pytest.approx(above / 100.0 * RATE, rel=0.01)
    assert 0.2 < struck.taken.sum() / track.volume.sum() < 0.5


def test_a_roof_shades_what_is_below() -> None:
    stock = plate()
    for i in range(40, 60):  # a slit below the surface, open to the side
        for j in range(80):
            stock.grow() if stock.field.columns.lo.shape[2] == 1 else None
            lo, hi, number = stock.field.columns
            hi[i, j, 0], lo[i, j, 1], hi[i, j, 1], number[i, j] = -4e-3, -2e-3, 0.0, 2
    strike_stock(stock, form(), way(rate=0.5 * RATE), "test")

    assert (stock.field.columns.hi[50, :, 0] == -4e-3).all()
    assert (stock.field.columns.hi[50, 38:42, 1] < 0.0).all()


def test_where_the_way_is_divided_changes_nothing() -> None:
    whole, parts = plate(), plate()
    track = way((0.2, 0.3, 1.0))
    strike_stock(whole, form(), track, "test")
    for k in range(0, 20, 4):
        strike_stock(parts, form(), BeamWay(*(column[k : k + 4] for column in track)), "test")

    assert np.array_equal(whole.doses["test"], parts.doses["test"])
    number = whole.field.columns.number
    assert np.array_equal(number, parts.field.columns.number)
    k = min(whole.field.columns.lo.shape[2], parts.field.columns.lo.shape[2])
    used = np.arange(k)[None, None, :] < number[:, :, None]
    assert np.array_equal(whole.field.columns.hi[:, :, :k][used], parts.field.columns.hi[:, :, :k][used])


def test_a_taper_narrows_the_kerf_downwards() -> None:
    stock = plate()
    strike_stock(stock, form(slope=-0.05), way(rate=5 * RATE), "test")
    lo, hi, number = stock.field.columns
    open_above = sum(1 for j in range(80) if not any(hi[50, j, k] > -0.2e-3 for k in range(number[50, j])))
    open_below = sum(1 for j in range(80) if not any(lo[50, j, k] < -5.8e-3 for k in range(number[50, j])))

    assert open_below * CELL == pytest.approx(open_above * CELL - 2 * 0.05 * 6e-3, abs=2 * CELL)

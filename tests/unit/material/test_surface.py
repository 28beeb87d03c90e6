"""Surfaces: closed, turned outwards, of the right volume, in tiles that fit together."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.material import Stock, shape

MM = 1e-3


def block(resolution=0.5):
    return Stock.box((0, 0, -15 * MM), (40 * MM, 30 * MM, 0), resolution * MM)


def edge_counts(faces):
    """How often each directed edge comes, and its reverse."""
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    directed, counts = np.unique(edges, axis=0, return_counts=True)
    return directed, counts


def assert_closed(surface):
    """Each edge is passed exactly once in either direction: closed and consistently turned."""
    directed, counts = edge_counts(surface.faces)
    assert (counts == 1).all()
    forward = {tuple(edge) for edge in directed.tolist()}
    assert all((b, a) in forward for a, b in forward)


def test_an_uncut_box_is_exactly_the_box():
    surface = block().surface()
    assert_closed(surface)
    assert surface.vertices.min(axis=0).tolist() == [0, 0, -15 * MM]
    assert surface.vertices.max(axis=0) == pytest.approx([40 * MM, 30 * MM, 0], abs=1e-15)
    assert surface.volume == pytest.approx(40 * 30 * 15 * MM**3, rel=1e-12)
    assert not surface.cut.any()


def test_trimesh_agrees_that_it_is_watertight():
    import trimesh

    stock = block()
    stock.remove(np.array([[-5, 15, -4]]) * MM, np.array([[20, 22, -6]]) * MM, shape.ball(8 * MM, 30 * MM))
    surface = stock.surface()
    mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    assert mesh.is_watertight and mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(surface.volume, rel=1e-9)


@pytest.mark.parametrize("resolution", [1.0, 0.5, 0.25])
def test_volume_beside_that_of_the_columns(resolution):
    stock = block(resolution)
    points = np.array([[5, 5, -3], [35, 12, -3], [20, 25, -6], [8, 8, -1]]) * MM
    for tool in (shape.ball(6 * MM, 20 * MM), shape.flat(5 * MM, 20 * MM), shape.cone(8 * MM, 2.0, 20 * MM)):
        stock.remove(points[:-1], points[1:], tool)
    surface = stock.surface()
    assert_closed(surface)
    whole = block(resolution).volume
    assert abs(surface.volume - stock.volume) <= max(stock.error_bound(), 1e-3 * (whole - stock.volume))


def test_a_ball_groove_is_smooth():
    """On a round groove points lie on the cylinder to a small part of a cell, and normals turn without steps."""
    stock = Stock.box((0, 0, -15 * MM), (40 * MM, 30 * MM, 0), 0.25 * MM)
    stock.remove(np.array([[-9, 15, -4]]) * MM, np.array([[49, 15, -4]]) * MM, shape.ball(20 * MM, 40 * MM))
    surface = stock.surface()
    middle = surface.vertices[(np.abs(surface.vertices[:, 1] - 15 * MM) < 6 * MM)]
    groove = middle[(middle[:, 2] > -14 * MM) & (middle[:, 0] > 1 * MM) & (middle[:, 0] < 39 * MM)]
    off = np.hypot(groove[:, 1] - 15 * MM, groove[:, 2] - 6 * MM) - 10 * MM
    assert len(groove) > 1000
    assert np.abs(off).max() < 0.01 * MM


def test_slanted_walls_are_not_stairs():
    """On a wall at 45 degrees the corners of the stairs fall into one plane."""
    stock = block(0.5)
    stock.remove(np.array([[-10, -20, -5]]) * MM, np.array([[50, 40, -5]]) * MM, shape.flat(14.3 * MM, 20 * MM))
    surface = stock.surface()
    inner = surface.vertices[(surface.vertices[:, 2] < -1 * MM) & (surface.vertices[:, 2] > -4.9 * MM)]
    assert len(inner) == 0  # walls have no points between floor and top
    top = surface.vertices[
        (np.abs(surface.vertices[:, 2]) < 1e-9)
        & (surface.vertices[:, 0] > 5 * MM) & (surface.vertices[:, 0] < 25 * MM)
        & (surface.vertices[:, 1] > 2 * MM) & (surface.vertices[:, 1] < 25 * MM)
    ]  # fmt: skip
    across = (top[:, 1] - top[:, 0]) / math.sqrt(2) + 10 * MM / math.sqrt(2)
    rim = across[np.abs(np.abs(across) - 7.15 * MM) < 0.45 * MM]
    below = rim[rim < 0]
    assert len(below) > 8
    assert np.ptp(below) < 1e-3 * MM


def test_walls_stand_where_the_tool_left_them():
    """A ring groove beside the grid: its walls on two circles to a hundredth of a cell, its volume to match."""
    stock = Stock.box((0, 0, -15 * MM), (50.3 * MM, 50 * MM, 0), 0.4 * MM)
    angle = np.linspace(0, 2 * math.pi, 400)
    ring = np.c_[25 + 15 * np.cos(angle), 25 + 15 * np.sin(angle), np.full(400, -3.0)] * MM
    stock.remove(ring[:-1], ring[1:], shape.flat(6 * MM, 20 * MM))
    surface = stock.surface()
    assert_closed(surface)
    points = surface.vertices[np.unique(surface.faces[surface.cut == 1])]
    rims = points[points[:, 2] > -1e-9]
    radii = np.hypot(rims[:, 0] - 25 * MM, rims[:, 1] - 25 * MM)
    off = np.minimum(np.abs(radii - 12 * MM), np.abs(radii - 18 * MM))
    assert len(rims) > 300
    assert off.max() < 0.02 * 0.4 * MM
    assert surface.volume == pytest.approx(stock.volume, rel=1e-5)
    assert stock.volume == pytest.approx((50.3 * 50 * 15 - 3 * math.pi * (18**2 - 12**2)) * MM**3, rel=1e-5)


def test_a_slot_beside_the_grid_runs_out_straight():
    stock = block(0.5)
    stock.remove(np.array([[-9, 15.13, -4]]) * MM, np.array([[49, 15.13, -4]]) * MM, shape.flat(7.3 * MM, 30 * MM))
    surface = stock.surface()
    assert_closed(surface)
    assert surface.volume == pytest.approx((40 * 30 * 15 - 40 * 7.3 * 4) * MM**3, rel=1e-6)
    floor = surface.vertices[np.abs(surface.vertices[:, 2] + 4 * MM) < 1e-9]
    assert floor[:, 1].min() == pytest.approx((15.13 - 3.65) * MM, abs=1e-8)
    assert floor[:, 1].max() == pytest.approx((15.13 + 3.65) * MM, abs=1e-8)


def test_flat_parts_take_few_triangles():
    stock = Stock.box((0, 0, -15 * MM), (80 * MM, 50 * MM, 0), 0.2 * MM)
    assert len(stock.surface().faces) < 0.05 * 4 * stock.field.columns.number.size
    stock.remove(np.array([[20, 25, -3]]) * MM, np.array([[60, 25, -3]]) * MM, shape.flat(20 * MM, 20 * MM))
    surface = stock.surface()
    assert_closed(surface)
    assert len(surface.faces) < 0.1 * 4 * stock.field.columns.number.size
    assert abs(surface.volume - stock.volume) < 1e-4 * (80 * 50 * 15 * MM**3 - stock.volume)


def random_columns(rng, cells, most):
    """A stock of random intervals, far rougher than any cut."""
    stock = Stock.box((0, 0, 0), (*(float(c) for c in cells), 5.0), 1.0)
    levels = np.sort(rng.integers(0, 6 + 2 * most, (*cells, 2 * most)), axis=2) + np.arange(2 * most) * 0.7
    while stock.field.columns.lo.shape[2] < most:
        stock.grow()
    lo, hi, number = stock.field.columns
    lo[:, :, :most], hi[:, :, :most] = levels[:, :, 0::2], levels[:, :, 1::2]
    number[:] = rng.integers(0, most + 1, cells)
    return stock


@pytest.mark.parametrize("seed", range(4))
def test_any_cuts_give_a_closed_surface(seed):
    """Cuts across each other, with walls beside the borders everywhere, thin fins and overhangs."""
    rng = np.random.default_rng(seed)
    stock = block(1.0)
    for tool in (
        shape.flat(4.3 * MM, 3 * MM),
        shape.ball(5.1 * MM, 7 * MM),
        shape.bull_nose(3.7 * MM, 0.6 * MM, 20 * MM),
    ):
        points = rng.uniform((-2, -2, -16), (42, 32, 0), (25, 3)) * MM
        stock.remove(points[:-1], points[1:], tool)
    surface = stock.surface()
    assert_closed(surface)
    assert surface.volume == pytest.approx(stock.volume, rel=0.04)  # fins are as thin as the cells


@pytest.mark.parametrize("seed", range(12))
def test_any_columns_columns_give_a_closed_surface(seed):
    rng = np.random.default_rng(seed)
    for _ in range(25):
        surface = random_columns(rng, tuple(rng.integers(1, 7, 2)), 4).surface()
        assert_closed(surface)


def test_chessboard_of_columns_is_closed_everywhere():
    """Opposite columns only, between full layers: every prism has two strands that meet above and below."""
    stock = Stock.box((0, 0, 0), (6.0, 6.0, 9.0), 1.0)
    stock.grow()
    black = (np.add.outer(np.arange(6), np.arange(6)) % 2).astype(bool)
    stock.field.columns.hi[black, 0] = 3.0
    stock.field.columns.lo[black, 1], stock.field.columns.hi[black, 1] = 6.0, 9.0
    stock.field.columns.number[black] = 2
    surface = stock.surface()
    assert_closed(surface)
    assert surface.volume == pytest.approx(stock.volume, rel=0.15)


def test_empty_stock_has_no_surface():
    surface = Stock.empty((0, 0, 0), (10 * MM, 10 * MM, 10 * MM), 1 * MM).surface()
    assert len(surface.faces) == 0 and surface.volume == 0.0


def test_cut_and_original_surface_are_told_apart():
    stock = block(0.5)
    stock.remove(np.array([[-9, 15, -4]]) * MM, np.array([[49, 15, -4]]) * MM, shape.flat(8 * MM, 30 * MM))
    surface = stock.surface()
    corners = surface.vertices[surface.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    # floor and two walls
    assert area[surface.cut == 1].sum() == pytest.approx(40 * (8 + 2 * 4) * MM**2, rel=1e-6)


def tile_mesh(tiles):
    """All tiles as one mesh, points fused by their coordinates."""
    parts = [part for tile in tiles for part in (tile.original, tile.changed)]
    points = np.concatenate([part.points for part in parts])
    faces, first = [], 0
    for part in parts:
        faces.append(part.triangles + first)
        first += len(part.points)
    unique, index = np.unique(points, axis=0, return_inverse=True)
    return unique, index.reshape(-1)[np.concatenate(faces)]


def test_tiles_share_their_edge_points_and_close_together():
    stock = block(0.5)
    stock.remove(np.array([[5, 5, -3]]) * MM, np.array([[33, 21, -7]]) * MM, shape.ball(8 * MM, 30 * MM))
    tiles = stock.tiles(across=4)
    drawn = tiles.all()
    assert len(drawn) == len(tiles) == 16
    _, faces = tile_mesh(drawn)
    _, counts = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0, return_counts=True)
    assert (counts == 2).all()
    assert 0 < sum(len(t.changed.triangles) for t in drawn) < sum(len(t.original.triangles) for t in drawn)
    for part in (part for tile in drawn for part in (tile.original, tile.changed)):
        assert (part.points * 2.0**20 == np.round(part.points * 2.0**20)).all()
        assert set(part.triangles.reshape(-1).tolist()) == set(range(len(part.points)))


def test_tiles_draw_what_the_whole_surface_draws():
    stock = block(0.5)
    stock.remove(np.array([[5, 5, -3]]) * MM, np.array([[33, 21, -7]]) * MM, shape.ball(8 * MM, 30 * MM))
    whole = stock.surface()
    for number, which in enumerate(("original", "changed")):
        faces = whole.faces[whole.cut == number]
        area = np.linalg.norm(normals(whole.vertices, faces), axis=1).sum()
        parts = [getattr(tile, which) for tile in stock.tiles().all()]
        drawn = [np.linalg.norm(normals(part.points, part.triangles), axis=1).sum() for part in parts]
        assert sum(drawn) == pytest.approx(area, rel=1e-4)


def normals(points, faces):
    a, b, c = (points[faces[:, k]] for k in range(3))
    return 0.5 * np.cross(b - a, c - a)


def test_only_tiles_with_changes_are_drawn_again():
    stock = Stock.box((0, 0, -5 * MM), (128 * MM, 128 * MM, 0), 0.5 * MM)
    tiles = stock.tiles()
    tiles.all()
    assert tiles.changed().draw() == []
    tip = np.array([[16.0, 48.0, -1.0]]) * MM
    stock.remove(tip, tip, shape.flat(6 * MM, 20 * MM))
    drawn = tiles.changed().draw()
    assert [tile.number for tile in drawn] == [1]
    assert len(drawn[0].changed.triangles) > 0
    assert tiles.changed().draw() == []


def test_a_tile_that_only_seems_changed_is_not_drawn_again():
    stock = Stock.box((0, 0, -5 * MM), (64 * MM, 64 * MM, 0), 0.5 * MM)
    tiles = stock.tiles()
    tiles.all()
    tip = np.array([[30.3, 31.1, -2.0]]) * MM
    stock.remove(tip, tip, shape.ball(6 * MM, 20 * MM))
    first = tiles.changed()
    stock.field.dirty[:] = 1  # as after a cut that was taken back and made again
    second = tiles.changed()
    assert len(second.tiles) == 16
    # the first look was never drawn: what is drawn counts, not what was seen
    assert sorted(tile.number for tile in second.draw()) == [5, 6, 9, 10]
    assert first.draw() == []


def test_a_wall_that_moves_within_its_cell_is_drawn_again():
    stock = Stock.box((0, 0, -5 * MM), (64 * MM, 64 * MM, 0), 0.5 * MM)
    tiles = stock.tiles(spacing=0.5 * MM)
    a, b = np.array([[-20.0, 20.0, -2.0]]) * MM, np.array([[90.0, 20.0, -2.0]]) * MM
    stock.remove(a, b, shape.flat(6.02 * MM, 20 * MM))
    tiles.all()
    columns = stock.field.columns.hi.copy()
    stock.remove(a, b, shape.flat(6.3 * MM, 20 * MM))
    assert (stock.field.columns.hi == columns).all()
    stock.field.dirty[:] = 1

    moved = tiles.changed().draw()

    assert moved
    fresh = {tile.number: tile for tile in stock.tiles(spacing=0.5 * MM).all()}
    for tile in moved:
        assert np.array_equal(tile.changed.points, fresh[tile.number].changed.points)


@pytest.mark.parametrize("spacing", [0.5 * MM, 1.7 * MM])
def test_what_was_seen_is_drawn_later_as_it_was(spacing):
    stock = Stock.box((0, 0, -5 * MM), (64 * MM, 64 * MM, 0), 0.5 * MM)
    tiles, others = stock.tiles(spacing=spacing), stock.tiles(spacing=spacing)
    tiles.all()
    tip = np.array([[30.3, 31.1, -2.0]]) * MM
    stock.remove(tip, tip + 2 * MM, shape.ball(6 * MM, 20 * MM))
    then = {tile.number: tile for tile in others.all()}
    stock.field.dirty[:] = 1
    seen = tiles.changed()
    stock.remove(tip - 1 * MM, tip, shape.flat(9 * MM, 20 * MM))

    drawn = seen.draw()

    assert {tile.number for tile in drawn} >= {5, 6, 9, 10}
    for tile in drawn:
        assert same_tile(tile, then[tile.number])


def same_tile(one, other):
    pairs = [(a, b) for mine, its in ((one.original, other.original), (one.changed, other.changed))
             for a, b in zip(mine, its, strict=True)]  # fmt: skip
    return all(np.array_equal(a, b) for a, b in pairs)


def test_every_tile_that_a_change_moves_is_drawn_again():
    stock = Stock.box((0, 0, -5 * MM), (64 * MM, 64 * MM, 0), 0.5 * MM)
    tiles = stock.tiles()
    held = {tile.number: tile for tile in tiles.all()}
    rng = np.random.default_rng(2)
    for _ in range(12):
        points = rng.uniform((0, 0, -3), (64, 64, -0.5), (2, 3)) * MM
        points[1] = points[0] + (points[1] - points[0]) * 0.1
        stock.remove(points[:1], points[1:], shape.ball(4 * MM, 20 * MM))
        held |= {tile.number: tile for tile in tiles.changed().draw()}
    for fresh in stock.tiles().all():
        assert same_tile(fresh, held[fresh.number])


def test_coarser_drawing_keeps_the_outline():
    stock = Stock.box((0, 0, -5 * MM), (31 * MM, 17 * MM, 0), 0.1 * MM)
    drawn = stock.tiles(across=2, spacing=1 * MM).all()
    points = np.concatenate([tile.original.points for tile in drawn])
    assert points.min(axis=0) == pytest.approx([0, 0, -5 * MM], abs=1e-6)
    assert points.max(axis=0) == pytest.approx([31 * MM, 17 * MM, 0], abs=1e-6)
    assert len(points) < 2000


def pocket(resolution, depth):
    """A pocket whose walls stand beside the borders of columns, in a block."""
    stock = block(resolution)
    rows = [[10.3, y, -depth] for y in (8.2, 11.2, 14.2, 17.2, 20.2) for _ in range(2)]
    for k, row in enumerate(rows):
        row[0] = 28.4 if k % 4 in (1, 2) else 10.3
    rows += [[10.3, 20.2, -depth], [10.3, 8.2, -depth], [28.4, 8.2, -depth], [28.4, 20.2, -depth]]
    points = np.array(rows) * MM
    stock.remove(points[:-1], points[1:], shape.flat(6 * MM, 30 * MM))
    return stock


@pytest.mark.parametrize("resolution", [3.0, 2.0, 1.0, 0.5])
@pytest.mark.parametrize("depth", [1.0, 2.0, 4.0])
def test_files_have_the_volume_of_the_stock(resolution, depth):
    """Of what is left, and of what was cut: slopes of up to 1.5 cells stand for walls on coarse grids."""
    from gcodesim.material.true_volume import surface_for_files

    stock = pocket(resolution, depth)
    plain, surface = stock.surface(), surface_for_files(stock)

    assert_closed(surface)
    assert surface.volume == pytest.approx(stock.volume, rel=1.01e-4)
    assert np.array_equal(surface.faces, plain.faces) and np.array_equal(surface.vertices[:, 2], plain.vertices[:, 2])
    assert np.abs(surface.vertices - plain.vertices).max() <= 0.5 * stock.cell * 1.001
    low, high = stock.bounds
    assert np.array_equal(surface.vertices.min(axis=0), low) and np.array_equal(surface.vertices.max(axis=0), high)


def printed(gap_mm):
    """A plate with a bar 0.4 mm above it that was laid there, and a slot as high as the gap that was milled."""
    stock = block()
    stock.remove(np.array([[-5, 5, -8]]) * MM, np.array([[45, 5, -8]]) * MM, shape.flat(6 * MM, gap_mm * MM))
    stock.add_bead(np.array([[-5, 20, 1 + gap_mm]]) * MM, np.array([[45, 20, 1 + gap_mm]]) * MM, 6 * MM, 1 * MM)
    return stock


def inner_heights(stock):
    """Heights [mm] of all points of the tiles inside of the outermost rim, above the floor."""
    points = np.vstack([part.points for tile in stock.tiles().all() for part in (tile.original, tile.changed)])
    inside = (abs(points[:, 0] - 20 * MM) < 15 * MM) & (points[:, 2] > -14 * MM)
    return sorted({round(float(z) / MM, 2) for z in points[inside, 2]})


def test_tiles_leave_out_low_voids_between_beads_and_nothing_else():
    """Columns are drawn 0.5 mm apart: a void of 0.4 mm below a bead is not seen, a slot of 0.4 mm in the part is."""
    low, high = inner_heights(printed(0.4)), inner_heights(printed(0.7))

    assert {-8.0, -7.6} <= set(low), "the slot of the part"
    assert 1.4 in low and 0.4 not in low
    assert {-8.0, -7.3, 0.7, 1.7} <= set(high)
    heights = {round(float(z) / MM, 2) for z in printed(0.4).surface(0.0).vertices[:, 2]}
    assert 0.4 in heights, "the surface of files keeps the void"

"""A stock against the part that it should have become."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from gcodesim.material import Stock, shape
from gcodesim.material.deviation import compare
from gcodesim.material.distance_kernels import skin_distances
from gcodesim.material.distance_tree import skin_tree
from gcodesim.material.mesh import OpenMeshError
from gcodesim.material.revolved import Revolved
from gcodesim.material.solid_of_revolution import slabs_of_shape
from tests.axis_ways import straight

MM, CELL, BAND = 1e-3, 0.5, 0.05


def block(top=10.0, right=30.0, resolution=CELL):
    return Stock.box((0, 0, 0), (right * MM, 20 * MM, top * MM), resolution * MM)


def box_mesh(low, high):
    mesh = trimesh.creation.box(bounds=np.array([low, high]))
    return np.asarray(mesh.vertices) * MM, np.asarray(mesh.faces).astype(np.int32)


def joined(*meshes):
    points = np.concatenate([points for points, _ in meshes])
    starts = np.cumsum([0, *(len(points) for points, _ in meshes[:-1])])
    return points, np.concatenate([faces + start for (_, faces), start in zip(meshes, starts, strict=True)])


def deviation(stock, mesh, band=BAND):
    return compare(stock, *mesh, band * MM)


def mill(stock, start, end, diameter, kind=shape.cylinder):
    stock.remove(np.array([start]) * MM, np.array([end]) * MM, kind(diameter * MM, 0.0, 40 * MM))


def test_distances_from_a_skin_are_those_of_all_triangles():
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=1.0)
    rng = np.random.default_rng(3)
    points = rng.uniform(-1.6, 1.6, (200, 3))
    found = np.zeros(len(points))
    skin_distances(skin_tree(mesh.vertices, mesh.faces.astype(np.int32)), points, 1.0e3, found)
    corners = mesh.triangles
    weights = rng.dirichlet(np.ones(3), 400)
    sampled = np.concatenate([weights @ triangle for triangle in corners] + [corners.reshape(-1, 3)])
    nearest = np.array([np.sqrt(np.square(sampled - point).sum(axis=1)).min() for point in points])
    assert (found <= nearest + 1e-12).all()
    assert (nearest - found).max() < 0.02
    capped = np.zeros(len(points))
    skin_distances(skin_tree(mesh.vertices, mesh.faces.astype(np.int32)), points, 0.1, capped)
    assert np.array_equal(capped, np.minimum(found, 0.1))


def test_a_part_that_is_its_target_deviates_nowhere():
    found = deviation(block(), box_mesh((0, 0, 0), (30, 20, 10)))
    assert not found.regions and not found.loose
    assert (found.least, found.most, found.overhang) == (0.0, 0.0, 0.0)
    assert found.area == pytest.approx(2 * (600 + 300 + 200) * MM**2)


def test_what_is_left_on_top_is_one_excess():
    found = deviation(block(), box_mesh((0, 0, 0), (30, 20, 8)))
    (region,) = found.regions
    assert not region.gouge
    assert region.volume == pytest.approx(30 * 20 * 2 * MM**3)
    assert region.depth == found.most == pytest.approx(2 * MM)
    assert region.at[2] == pytest.approx(10 * MM)
    assert region.area == pytest.approx(600 * MM**2, rel=0.01)
    assert deviation(block(), box_mesh((0, 0, 0), (30, 20, 9.96))).regions == []


def test_a_slot_too_deep_is_one_gouge_as_deep_as_it_is():
    stock = block()
    mill(stock, (5, 10, 8), (25, 10, 8), 4)
    found = deviation(stock, box_mesh((0, 0, 0), (30, 20, 10)))
    (region,) = found.regions
    assert region.gouge
    assert region.volume == pytest.approx((20 * 4 + math.pi * 4) * 2 * MM**3, rel=0.02)
    assert region.depth == -found.least == pytest.approx(2 * MM)
    assert region.at[2] == pytest.approx(8 * MM)
    assert np.allclose(region.low[:2], (3 * MM, 8 * MM), atol=CELL * MM)


@pytest.mark.parametrize("deep", [0.2, 0.3, 0.4, 0.55, 0.7])
def test_a_wall_too_far_in_is_known_to_half_a_cell(deep):
    stock = block()
    mill(stock, (-5, -2 + deep, -1), (35, -2 + deep, -1), 4)
    found = deviation(stock, box_mesh((0, 0, 0), (30, 20, 10)))
    depth = max((region.depth for region in found.regions), default=0.0)
    if deep > 0.5 * CELL:  # the first columns stand half a cell behind the border
        assert depth == pytest.approx(deep * MM, abs=0.5 * CELL * MM)
    assert depth <= deep * MM + 1e-9


def test_two_places_are_two_regions_the_greater_first():
    stock = block()
    mill(stock, (6, 10, 9), (6, 10, 9), 4)
    mill(stock, (22, 10, 9), (22, 10, 9), 8)
    one, two = deviation(stock, box_mesh((0, 0, 0), (30, 20, 10))).regions
    assert one.volume > two.volume
    assert one.at[0] > 18 * MM > two.at[0]


def test_a_hole_through_everything_is_as_deep_as_its_middle():
    stock = block()
    mill(stock, (15, 10, -1), (15, 10, -1), 6)
    (region,) = deviation(stock, box_mesh((0, 0, 0), (30, 20, 10))).regions
    assert region.depth == pytest.approx(5 * MM, abs=0.5 * CELL * MM)  # from top and bottom


def test_an_inner_hole_of_the_target_that_is_not_made_is_excess():
    inner = box_mesh((12, 8, 4), (16, 12, 7))
    found = deviation(block(), joined(box_mesh((0, 0, 0), (30, 20, 10)), (inner[0], inner[1][:, ::-1])))
    (region,) = found.regions
    assert region.volume == pytest.approx(48 * MM**3)
    assert region.depth == pytest.approx(1.5 * MM, abs=0.25 * CELL * MM)


def test_what_hangs_together_with_nothing_of_the_target_is_loose():
    stock = block()
    mill(stock, (20, -5, -1), (20, 25, -1), 4)
    found = deviation(stock, box_mesh((0, 0, 0), (18, 20, 10)))
    assert not found.regions
    (loose,) = found.loose
    assert loose.volume == pytest.approx(8 * 20 * 10 * MM**3, rel=1e-6)
    assert loose.at[0] > 22 * MM


def test_a_target_above_the_stock_is_compared_and_one_beside_it_is_told():
    above = deviation(block(), box_mesh((0, 0, 0), (30, 20, 12)))
    assert above.overhang == 0.0
    assert above.regions[0].gouge and above.regions[0].depth == pytest.approx(2 * MM)
    assert deviation(block(), box_mesh((0, 0, 0), (32, 20, 10))).overhang == pytest.approx(2 * MM)


def test_a_leaning_cut_is_compared_too():
    stock = block()
    lean = np.array([0.5, 0.0, np.sqrt(0.75)])
    way = straight(np.array([15, 6, 8]) * MM, np.array([15, 14, 8]) * MM, lean, lean)
    taken = stock.sweep(way, slabs_of_shape(shape.cylinder(4 * MM, 0.0, 40 * MM), CELL * MM)).sum()
    (region,) = deviation(stock, box_mesh((0, 0, 0), (30, 20, 10))).regions
    assert region.gouge
    assert region.volume == pytest.approx(taken, rel=0.05)
    deepest = 2 + 2 * 0.5  # the edge of the flat end that leans down
    assert region.depth == pytest.approx(deepest * MM, abs=0.5 * CELL * MM)


def test_an_open_mesh_is_refused():
    points, faces = box_mesh((0, 0, 0), (30, 20, 10))
    with pytest.raises(OpenMeshError):
        flat = int(np.flatnonzero(np.ptp(points[faces][:, :, 2], axis=1) == 0.0)[0])
        deviation(block(), (points, np.delete(faces, flat, axis=0)))


def test_a_mesh_that_is_inside_out_is_turned_over():
    points, faces = box_mesh((0, 0, 0), (30, 20, 8))
    assert deviation(block(), (points, faces[:, ::-1])).regions[0].volume == pytest.approx(1200 * MM**3)


def shaft(radius, length, sections=256):
    mesh = trimesh.creation.cylinder(radius=radius, height=length, sections=sections)
    mesh.apply_translation((0, 0, 0.5 * length))
    return np.asarray(mesh.vertices) * MM, np.asarray(mesh.faces).astype(np.int32)


def bar(radius=10.0):
    return Revolved.bar(radius * MM, 0.0, 40 * MM, resolution=0.1 * MM)


def test_a_turned_part_is_compared_all_around():
    assert deviation(bar(), shaft(10, 40)).regions == []
    (region,) = deviation(bar(), shaft(9, 40)).regions
    assert not region.gouge
    assert region.depth == pytest.approx(1 * MM, abs=0.01 * MM)
    assert region.volume == pytest.approx(math.pi * 19 * 40 * MM**3, rel=0.01)


def test_a_groove_of_a_turned_part_is_a_gouge_and_the_bar_in_the_chuck_is_not_compared():
    stock = bar()
    profile = stock.profile
    middle = profile.z + profile.dz * (np.arange(len(profile.number)) + 0.5)
    profile.hi[(middle > 20 * MM) & (middle < 23 * MM), 0] = 8 * MM
    points, faces = shaft(10, 30)
    (region,) = deviation(stock, (points + np.array([0, 0, 10 * MM]), faces)).regions
    assert region.gouge
    assert region.volume == pytest.approx(math.pi * 36 * 3 * MM**3, rel=0.02)
    assert region.depth == pytest.approx(2 * MM, abs=0.02 * MM)

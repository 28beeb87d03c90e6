"""Meshes as stock."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from gcodesim.material.mesh import OpenMeshError, stock_of_mesh

MM = 1e-3


def as_stock(mesh, resolution):
    return stock_of_mesh(np.asarray(mesh.vertices) * MM, np.asarray(mesh.faces), resolution * MM)


def test_a_box_mesh_is_the_box():
    stock = as_stock(trimesh.creation.box((30, 20, 10)), 0.5)
    assert stock.field.columns.number.shape == (60, 40)
    assert stock.volume == pytest.approx(6000 * MM**3, rel=1e-9)
    assert np.abs(stock.field.columns.hi - 5 * MM).max() < 1e-12
    assert stock.error_bound() == 0.0


@pytest.mark.parametrize("seed", range(4))
def test_a_turned_body_keeps_its_volume(seed):
    mesh = trimesh.creation.annulus(6, 14, 25)
    mesh.apply_transform(trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3)))
    stock = as_stock(mesh, 0.25)
    assert stock.volume == pytest.approx(mesh.volume * MM**3, rel=5e-3)


def test_a_sphere_column_by_column():
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=10)
    stock = as_stock(mesh, 0.5)
    grid, (nx, ny) = stock.field.grid, stock.field.columns.number.shape
    x = (grid.x + (np.arange(nx) + 0.5) * grid.dx)[:, None]
    y = (grid.y + (np.arange(ny) + 0.5) * grid.dy)[None, :]
    inner = np.hypot(x, y) < 9 * MM
    exact = np.sqrt(np.maximum((10 * MM) ** 2 - x**2 - y**2, 0))
    assert np.abs(stock.field.columns.hi[:, :, 0] - exact)[inner].max() < 0.06 * MM
    assert stock.volume == pytest.approx(4 / 3 * math.pi * 1000 * MM**3, rel=0.01)


def test_overlapping_shells_unite_and_a_hollow_stays_hollow():
    low, high = trimesh.creation.box((10, 10, 10)), trimesh.creation.box((10, 10, 10))
    high.apply_translation((0, 0, 6))
    both = trimesh.util.concatenate([low, high])
    assert as_stock(both, 0.5).volume == pytest.approx(1600 * MM**3, rel=1e-9)
    hole = trimesh.creation.box((4, 4, 4))
    hole.invert()
    hollow = as_stock(trimesh.util.concatenate([low, hole]), 0.5)
    assert hollow.volume == pytest.approx((1000 - 64) * MM**3, rel=1e-9)
    assert int(hollow.field.columns.number.max()) == 2


def test_inside_out_is_turned_and_open_is_refused():
    mesh = trimesh.creation.box((10, 10, 10))
    mesh.invert()
    assert as_stock(mesh, 0.5).volume == pytest.approx(1000 * MM**3, rel=1e-9)
    mesh = trimesh.creation.box((10, 10, 10))
    keep = np.abs(mesh.face_normals[:, 2] - 1) > 1e-6
    with pytest.raises(OpenMeshError, match="not closed: 400 of 400"):
        stock_of_mesh(np.asarray(mesh.vertices) * MM, mesh.faces[keep], 0.5 * MM)

"""Cameras and scanners against what a pinhole sees of simple bodies."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest

from gcodesim.sensors.camera import Camera, DepthCamera
from gcodesim.sensors.line_scanner import LineScanner
from gcodesim.sensors.noise import Noise
from gcodesim.sensors.png import png_of
from gcodesim.sensors.scenery import Scenery
from gcodesim.sensors.sensor import Sight
from gcodesim.solids import Box, Sphere, triangles_of
from gcodesim.units import DEG

ABOVE = np.diag([1.0, -1.0, -1.0, 1.0])  # looks down, right is X of the world
ABOVE[:3, 3] = (0.0, 0.0, 0.5)
GREY, RED = np.array([120, 120, 120], np.uint8), np.array([200, 0, 0], np.uint8)


def skin(solid, at=(0.0, 0.0, 0.0)):
    found = triangles_of(solid)
    return (found.points + np.array(at))[found.faces]


TABLE = skin(Box(lower=(-0.2, -0.1, -0.05), upper=(0.2, 0.1, 0.0)))


def sight(*parts, X=ABOVE, number=1, lines=()):
    return Sight(X_WC=X, scenery=Scenery.of(parts, lines), noise=Noise(7, "eye", number))


def depth_of(camera, *parts, X=ABOVE):
    return camera.read(sight(*parts, X=X))["depth"].depth


def test_a_plate_is_as_large_in_the_picture_as_the_pinhole_law_says():
    camera = DepthCamera(width=201, height=201, focal_length=(200.0, 200.0), range=(0.0, 10.0))

    depth = depth_of(camera, (TABLE, GREY))

    # half sides of 0.2 and 0.1 m at 0.5 m: 80 and 40 pixels to each side of the middle, borders included
    rows, columns = np.nonzero(~np.isnan(depth))
    assert (columns.min(), columns.max()) == (100 - 80, 100 + 80)
    assert (rows.min(), rows.max()) == (100 - 40, 100 + 40)
    assert np.all(depth[60:141, 20:181] == np.float32(0.5))


def test_depth_of_a_tilted_plane_is_exact_in_every_pixel():
    """z = 0.5 + x: the ray (a, b, 1) t meets it at t = 0.5 / (1 - a)."""
    triangle = np.array([[[-0.3, -1.0, 0.2], [-0.3, 1.0, 0.2], [2.0, 0.0, 2.5]]])
    camera = DepthCamera(width=64, height=64, focal_length=(100.0, 100.0), range=(0.0, 10.0))

    depth = depth_of(camera, (triangle, GREY), X=np.eye(4))

    a = (np.arange(64) - 31.5) / 100.0
    expected = np.tile(0.5 / (1.0 - a), (64, 1))
    seen = ~np.isnan(depth)
    assert seen[20:44, 20:44].all()
    np.testing.assert_allclose(depth[seen], expected[seen], rtol=1e-6)


def test_the_nearer_body_hides_the_farther_one_in_whatever_order_they_come():
    ball = skin(Sphere(radius=0.05), (0.0, 0.0, 0.1))
    camera = DepthCamera(width=101, height=101, range=(0.0, 10.0))

    one = camera.read(sight((TABLE, GREY), (ball, RED)))
    other = camera.read(sight((ball, RED), (TABLE, GREY)))

    assert one["image"].pixels.tobytes() == other["image"].pixels.tobytes()
    assert one["depth"].depth[50, 50] == pytest.approx(0.5 - 0.15, abs=1e-4)
    assert one["image"].pixels[50, 50, 0] > 100 and one["image"].pixels[50, 50, 1] == 0


def test_faces_that_share_an_edge_leave_no_gap():
    """A fan of triangles about the middle covers every pixel of a disc."""
    angle = 2.0 * np.pi * np.arange(181) / 180
    rim = np.stack([np.cos(angle), np.sin(angle), np.ones(181)], axis=1)
    rim[-1] = rim[0]
    fan = np.stack([np.tile([0.0, 0.0, 1.0], (180, 1)), rim[:-1], rim[1:]], axis=1)
    camera = DepthCamera(width=99, height=99, focal_length=(60.3, 60.7), range=(0.0, 10.0))

    depth = depth_of(camera, (fan, GREY), X=np.eye(4))

    v, u = np.mgrid[:99, :99]
    inside = ((u - 49.0) / 60.3) ** 2 + ((v - 49.0) / 60.7) ** 2 < 0.99
    assert not np.isnan(depth[inside]).any()


def test_what_reaches_behind_the_lens_is_cut_off_and_not_mirrored():
    floor = np.array([[[-9.0, 1.0, -5.0], [9.0, 1.0, -5.0], [0.0, 1.0, 20.0]]])
    camera = DepthCamera(width=40, height=40, range=(0.0, 100.0))

    depth = depth_of(camera, (floor, GREY), X=np.eye(4))

    assert np.isnan(depth[:20]).all()  # above the horizon
    f = camera.optics.fy
    assert depth[39, 20] == pytest.approx(f / (39 - 19.5), rel=1e-6)


def test_field_of_view_is_from_border_to_border():
    camera = Camera(width=640, field_of_view=90.0 * DEG)

    assert camera.optics.fx == pytest.approx(320.0)
    assert Camera(width=640, focal_length=(320.0, 300.0)).field_of_view == pytest.approx(90.0 * DEG)


def test_light_falls_off_with_the_angle_of_a_face():
    """Lambert: a face turned by 60 degrees shines with 0.35 + 0.65 / 2 of its colour."""
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.5, -np.sqrt(0.75)], [0.0, np.sqrt(0.75), 0.5]])
    flat = np.array([[[-5.0, -5.0, 0.0], [5.0, -5.0, 0.0], [0.0, 5.0, 0.0]]])
    white = np.array([200, 200, 200], np.uint8)
    camera = Camera(width=3, height=3, focal_length=(1000.0, 1000.0))

    straight = camera.read(sight((flat + np.array([0, 0, 10.0]), white), X=np.eye(4)))["image"].pixels
    tilted = camera.read(sight((flat @ turn.T + np.array([0, 0, 10.0]), white), X=np.eye(4)))["image"].pixels

    assert straight[1, 1, 0] == 200
    assert tilted[1, 1, 0] == round(200 * (0.35 + 0.65 * 0.5))


def test_a_line_is_drawn_where_nothing_is_in_front_of_it():
    camera = Camera(width=101, height=101, focal_length=(100.0, 100.0))
    line = np.array([[[-0.3, 0.0, -0.2], [0.3, 0.0, -0.2]]])  # below the table, which ends at 0.2

    pixels = camera.read(sight((TABLE, GREY), lines=[(line, RED)]))["image"].pixels
    row = pixels[50]

    shown = np.flatnonzero((row == RED).all(axis=1))
    assert shown.min() <= 50 - 42 and shown.max() >= 50 + 42
    assert not set(shown.tolist()) & set(range(50 - 39, 50 + 40))


def test_noise_is_off_by_default_and_seeded():
    plain, noisy = Camera(width=60, height=40), Camera(width=60, height=40, noise=0.02)

    quiet = [plain.read(sight((TABLE, GREY), number=n))["image"].pixels.tobytes() for n in (1, 2)]
    loud = [noisy.read(sight((TABLE, GREY), number=n))["image"].pixels for n in (1, 1, 2)]

    assert quiet[0] == quiet[1]
    assert (loud[0] == loud[1]).all() and (loud[0] != loud[2]).any()
    difference = loud[0].astype(float) - plain.read(sight((TABLE, GREY)))["image"].pixels
    assert difference.std() == pytest.approx(0.02 * 255, rel=0.1)


def test_noise_is_normal():
    values = Noise(1, "x", 1).normal(200_001)

    assert len(values) == 200_001
    assert abs(values.mean()) < 0.01 and abs(values.std() - 1.0) < 0.01
    assert np.mean(np.abs(values) < 1.0) == pytest.approx(0.6827, abs=0.005)


def test_depth_noise_does_not_depend_on_that_of_the_picture():
    camera = DepthCamera(width=30, height=30, depth_noise=1e-3)

    depth = depth_of(camera, (TABLE, GREY))

    assert np.nanstd(depth) == pytest.approx(1e-3, rel=0.2)


def test_a_profile_lies_on_what_it_meets():
    step = skin(Box(lower=(0.0, -0.1, 0.0), upper=(0.2, 0.1, 0.03)))
    scanner = LineScanner(points=200, field_of_view=30.0 * DEG)

    points = scanner.read(sight((TABLE, GREY), (step, RED)))["profile"].points

    left, right = points[points[:, 0] < -1e-3], points[points[:, 0] > 1e-3]
    assert np.all(points[:, 1] == 0.0)
    np.testing.assert_allclose(left[:, 2], 0.5, atol=1e-6)
    np.testing.assert_allclose(right[:, 2], 0.47, atol=1e-6)
    np.testing.assert_allclose(points[0, 0] / points[0, 2], -(99.5 / 100.0) * np.tan(15.0 * DEG), rtol=1e-6)


def test_a_scanner_sees_only_within_its_range():
    points = LineScanner(points=10, range=(0.1, 0.4)).read(sight((TABLE, GREY)))["profile"].points

    assert np.isnan(points).all()


@pytest.mark.parametrize(("shape", "kind"), [((5, 7, 3), np.uint8), ((5, 7), np.uint8), ((5, 7), np.uint16)])
def test_a_png_file_has_its_pixels(shape, kind):
    """Undone by hand: chunks, checksums, the filter of rows."""
    pixels = np.random.default_rng(3).integers(0, np.iinfo(kind).max, shape).astype(kind)
    data, at, chunks = png_of(pixels), 8, {}

    while at < len(data):
        (size,) = struct.unpack_from(">I", data, at)
        name, content = data[at + 4 : at + 8], data[at + 8 : at + 8 + size]
        assert struct.unpack_from(">I", data, at + 8 + size)[0] == zlib.crc32(name + content)
        chunks[name], at = content, at + size + 12

    width, height, depth, color = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
    assert (width, height, depth, color) == (7, 5, 8 * pixels.itemsize, 2 if len(shape) == 3 else 0)
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(5, -1)
    assert (rows[:, 0] == 2).all()
    back = np.cumsum(rows[:, 1:], axis=0, dtype=np.uint8)
    assert back.tobytes() == pixels.astype(pixels.dtype.newbyteorder(">")).tobytes()


def test_impossible_cameras_say_why():
    assert "8294400 pixels" in Camera(width=3840, height=2160).problems()[0][1]
    assert Camera(focal_length=(800.0, 800.0), field_of_view=0.1).problems()[0][0] == "focal_length"
    assert DepthCamera(range=(2.0, 1.0)).problems()[0][0] == "range"
    assert LineScanner(range=(2.0, 1.0)).problems()[0][0] == "range"
    assert not Camera().problems()

"""Film on faces: closed forms of spray on planes, shade, and what is kept."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from gcodesim.frames import Pose
from gcodesim.material.film import BodyFilm
from gcodesim.material.film_kernels import Dabs, Shades
from gcodesim.material.refining import TooFineError, refined
from gcodesim.processes.spray_pattern import pattern_of
from gcodesim.solids import Box
from gcodesim.solids.mesh_file import Triangles
from gcodesim.solids.triangle_tree import joined, tree_of
from gcodesim.solids.triangles import triangles_of
from gcodesim.tools.spray_gun import Fading, Footprint, SprayGun
from tests.slow import some_slow

UP = np.array([0.0, 0.0, 1.0])


def gun(**keys: object) -> SprayGun:
    return SprayGun(**({"number": 8, "cone": (0.5,), "efficiency": 1.0, "distance": 0.2} | keys))  # type: ignore[arg-type]


def panel(side: float = 0.6, size: float = 6e-3) -> BodyFilm:
    half = 0.5 * side
    return BodyFilm(triangles_of(Box(lower=(-half, -half, -0.002), upper=(half, half, 0.0))), size)


def dabs(places: np.ndarray, axis: np.ndarray, solids: float = 1e-6, bodies: int = 0) -> Dabs:
    n = len(places)
    side = np.cross([0.0, 1.0, 0.0], axis)
    side /= np.linalg.norm(side)
    return Dabs(
        np.ascontiguousarray(places, dtype=float),
        np.tile(np.asarray(axis, dtype=float), (n, 1)),
        np.tile(side, (n, 1)),
        np.full(n, solids),
        np.full(n, 2.0 * solids),
        np.tile(-UP, (n, 1)),
        np.tile(np.eye(4)[:3], (n, bodies, 1, 1)),
    )


def nothing() -> Shades:
    return shades([])


def shades(bodies: list[Triangles], own: int = -1) -> Shades:
    boxes, corners, first = joined([tree_of(body) for body in bodies])
    balls = [np.append(body.points.mean(axis=0), np.ptp(body.points, axis=0).max()) for body in bodies]
    return Shades(boxes, corners, first, np.array(balls).reshape(-1, 4), own)


@pytest.mark.parametrize("tilt", some_slow([0.0, 0.3, -0.6], 0.0, -0.6))
@pytest.mark.parametrize("profile", ["gaussian", "parabola", "uniform"])
def test_all_that_is_sprayed_is_on_the_plane_at_any_tilt(tilt: float, profile: str) -> None:
    """Shares of the cone are those of the pattern, so their sum is 1; a rim counts for faces that it crosses."""
    axis = np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    film = panel(1.6)
    pattern = pattern_of(gun(profile=profile, cone=(0.35,)))

    told = film.lay(pattern, dabs(-0.2 * axis[None], axis), nothing())

    rim = 0.02 if profile == "uniform" else 2e-3
    assert told[0, 0] == pytest.approx(1.0, abs=rim)
    assert film.volume == pytest.approx(1e-6 * told[0, 1] / 1e-6, rel=1e-12)
    assert told[0, 1] == pytest.approx(1e-6 * told[0, 0], rel=1e-12)


def test_a_still_gun_leaves_its_pattern() -> None:
    """Straight on, film at radius r is solids / (2 pi sigma²) exp(-r² / (2 sigma²)), sigma half the cone at 0.2 m."""
    film = panel()
    film.lay(pattern_of(gun()), dabs(np.array([[0.0, 0.0, 0.2]]), -UP), nothing())

    sigma = 0.5 * 0.2 * np.tan(0.25)
    top = film.coat.normal[:, 2] > 0.5
    r2 = (film.coat.middle[top, :2] ** 2).sum(axis=1)
    expected = 1e-6 / (2.0 * pi * sigma**2) * np.exp(-r2 / (2.0 * sigma**2))
    assert film.coat.dry[top] == pytest.approx(expected, abs=5e-4 * expected.max())
    assert not film.coat.dry[~top].any()


def test_two_cones_make_an_ellipse() -> None:
    film = panel()
    film.lay(pattern_of(gun(cone=(0.8, 0.4))), dabs(np.array([[0.0, 0.0, 0.2]]), -UP), nothing())

    weight = film.coat.dry * film.coat.area
    spread = np.sqrt((weight[:, None] * film.coat.middle**2).sum(axis=0) / weight.sum())
    assert spread[:2] == pytest.approx([0.1 * np.tan(0.4), 0.1 * np.tan(0.2)], rel=0.01)


def test_a_measured_footprint_is_found_again() -> None:
    """Its thickness falls straight from the middle to 50 mm: volume pi h r² / 3, so h = 3 V / (pi r²)."""
    film = panel(0.4, 4e-3)
    measured = Footprint(radius=(0.0, 0.05), thickness=(10.0, 0.0))
    film.lay(pattern_of(gun(cone=None, footprint=measured)), dabs(np.array([[0.0, 0.0, 0.2]]), -UP), nothing())

    r = np.hypot(*film.coat.middle[:, :2].T)
    height = 3e-6 / (pi * 0.05**2)
    top = film.coat.normal[:, 2] > 0.5
    expected = height * np.maximum(1.0 - r[top] / 0.05, 0.0)
    assert film.coat.dry[top] == pytest.approx(expected, abs=0.01 * height)


def test_efficiency_falls_with_distance_and_angle() -> None:
    fading = Fading(distance=(0.1, 0.3), factor=(1.0, 0.5))
    pattern = pattern_of(gun(efficiency=0.8, fading=fading, rebound=2.0, cone=(0.02,)))
    tilt = 1.0
    axis = np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    film = panel(0.2, 1e-3)

    told = film.lay(pattern, dabs(-0.2 * axis[None], axis), nothing())

    assert told[0, 1] / 1e-6 == pytest.approx(0.8 * 0.75 * np.cos(tilt) ** 2, rel=0.01)


def test_a_gun_too_near_lays_no_more_than_it_sprays() -> None:
    film = panel(0.2, 0.02)
    told = film.lay(pattern_of(gun(cone=(0.1,))), dabs(np.array([[0.002, 0.001, 0.003]]), -UP), nothing())

    assert told[0, 0] <= 1.0 + 1e-12
    assert told[0, 2] == told[0, 1]  # all of it from too near


def test_what_stands_between_keeps_its_shadow_free() -> None:
    """A square of 20 mm half-way to the plane shades one of 40 mm below it, and nothing else."""
    square = triangles_of(Box(lower=(-0.01, -0.01, 0.099), upper=(0.01, 0.01, 0.1)))
    film, free = panel(0.3, 5e-3), panel(0.3, 5e-3)
    pattern = pattern_of(gun(cone=(1.0,)))
    film.lay(pattern, dabs(np.array([[0.0, 0.0, 0.2]]), -UP, bodies=1), shades([square]))
    free.lay(pattern, dabs(np.array([[0.0, 0.0, 0.2]]), -UP), nothing())

    inside = np.abs(film.coat.middle[:, :2]).max(axis=1)
    lit = free.coat.dry > 0.0
    assert not film.coat.dry[inside < 0.01 * 0.2 / 0.101 - 1e-4].any()
    out = lit & (inside > 0.0205)
    assert np.array_equal(film.coat.dry[out], free.coat.dry[out])


def test_a_body_shades_itself() -> None:
    """An angle of two boxes, sprayed from behind its wall: the floor stays bare where the wall hides it."""
    floor, wall = (
        Box(lower=(-0.2, -0.2, -0.01), upper=(0.2, 0.2, 0.0)),
        Box(lower=(0.0, -0.2, 0.0), upper=(0.01, 0.2, 0.1)),
    )
    one, other = triangles_of(floor), triangles_of(wall)
    mesh = Triangles(
        points=np.concatenate([one.points, other.points]),
        faces=np.concatenate([one.faces, other.faces + len(one.points)]),
    )
    film = BodyFilm(mesh, 8e-3)
    place, aim = np.array([0.2, 0.0, 0.2]), np.array([-0.05, 0.0, 0.0])
    axis = (aim - place) / np.linalg.norm(aim - place)
    film.lay(pattern_of(gun(cone=(1.4,))), dabs(place[None], axis, bodies=1), shades([mesh], own=0))

    x, y, z = film.coat.middle.T
    ground = (film.coat.normal[:, 2] > 0.5) & (z < 0.01) & (np.abs(y) < 0.02)
    behind = ground & (x < -0.01) & (x > -0.17)  # the ray over the wall's far edge comes down at x = -0.18
    before = ground & (x > 0.02) & (x < 0.15)
    assert behind.any() and not film.coat.dry[behind].any()
    assert before.any() and (film.coat.dry[before] > 0.0).all()


def test_undone_is_as_before() -> None:
    film = panel(0.2, 0.02)
    pattern, one = pattern_of(gun()), dabs(np.array([[0.0, 0.0, 0.2]]), -UP)
    film.lay(pattern, one, nothing())
    before, facing = film.coat.dry.copy(), film.facing()
    back = film.memento()
    tilted = np.array([0.8, 0.0, -0.6])
    film.lay(pattern, dabs(-0.2 * tilted[None], tilted), nothing())
    back()

    assert np.array_equal(film.coat.dry, before) and np.array_equal(film.facing(), facing)


def test_faces_count_that_face_a_gun_anywhere() -> None:
    film = panel(0.2, 0.02)
    film.lay(pattern_of(gun()), dabs(np.array([[0.5, 0.5, 0.2]]), -UP), nothing())  # beside it

    assert np.array_equal(film.facing(), film.coat.normal[:, 2] > 0.5)


def test_paint_runs_on_steep_faces_first() -> None:
    """Wet film on a plane of tilt a runs from sag / sqrt(sin a) on."""
    for turn, steep in ((0.0, 0.0), (0.5, np.sin(0.5)), (0.5 * pi, 1.0)):
        film = panel(0.2, 0.02)
        one = dabs(np.array([[0.0, 0.0, 0.2]]), -UP)
        down = Pose.from_xyz_rpy((0.0, 0.0, 0.0), (turn, 0.0, 0.0)).inverse().rotate(-UP)
        film.lay(pattern_of(gun()), one._replace(down=down[None]), nothing())
        wet = float(film.coat.wet.max())

        assert film.runs(0.999 * wet * steep**0.5).any() == (steep > 0.0)
        assert not film.runs(1.001 * wet * steep**0.5 + 1e-12).any()


def test_refined_triangles_cover_the_same_surface() -> None:
    mesh = triangles_of(Box(lower=(0, 0, 0), upper=(0.3, 0.1, 0.002)))
    fine = refined(mesh, 7e-3, 100_000)

    a, b, c = (fine.points[fine.faces[:, k]] for k in range(3))
    normals = 0.5 * np.cross(b - a, c - a)
    assert np.linalg.norm(normals, axis=1).sum() == pytest.approx(2 * (0.03 + 0.0006 + 0.0002), rel=1e-12)
    assert np.abs(normals.sum(axis=0)).max() < 1e-15
    assert max(np.linalg.norm(e, axis=1).max() for e in (b - a, c - b, a - c)) <= 7e-3
    with pytest.raises(TooFineError) as fault:
        refined(mesh, 1e-4, 1000)
    assert fault.value.needed > 1_000_000


@pytest.mark.parametrize("third", [(0.1, 0.1, 0.0), (0.3, 0.3, 0.0), (0.2, 0.2, 0.0)])
def test_a_face_without_area_gets_nothing_and_spoils_nothing(third: tuple[float, float, float]) -> None:
    """Skins of stocks that were cut have some: their normals were no numbers, and so was the film of the whole."""
    whole = triangles_of(Box(lower=(-0.3, -0.3, -0.002), upper=(0.3, 0.3, 0.0)))
    n = len(whole.points)
    points = np.concatenate([whole.points, [(0.1, 0.1, 0.0), (0.3, 0.3, 0.0), third]])
    faces = np.concatenate([whole.faces, [(n, n + 1, n + 2)]]).astype(np.int32)
    spoilt = Triangles(points=points, faces=faces)
    clean, film = (BodyFilm(mesh, 20e-3) for mesh in (whole, spoilt))

    assert np.isfinite(film.coat.normal).all()
    assert np.array_equal(film.coat.middle, clean.coat.middle) and film.area == clean.area

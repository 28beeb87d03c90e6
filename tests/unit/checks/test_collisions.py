"""Tools swept past fixtures, against closed-form distances and places."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.checks.collision_kernels import separation
from gcodesim.checks.collisions import Obstacle, ToolParts, Touch, collision_finding, fixture_touches
from gcodesim.diagnostics import Span, code_of
from gcodesim.frames import Pose, rotation_from_rpy
from gcodesim.solids import Box, Cylinder, Mesh, Placed, Point
from gcodesim.tools.ball_end_mill import BallEndMill
from gcodesim.tools.flat_end_mill import FlatEndMill
from gcodesim.tools.sections import Holder, StackedSection
from gcodesim.units import MM

UP = np.array([[0.0, 0.0, 1.0]])


def box(name: str, lower: Point, upper: Point, X: Pose | None = None) -> Obstacle:
    return Obstacle.of(name, [Placed(Box(lower=lower, upper=upper), X or Pose.identity())])


CLAMP = box("clamp", (0.020, 0.024, -0.015), (0.030, 0.032, 0.010))


def flat(diameter: float, length: float = 0.06) -> ToolParts:
    return ToolParts.of(FlatEndMill(number=2, diameter=diameter, length=length))


def touch(
    tool: ToolParts, fixture: Obstacle, *points: tuple[float, float, float], axis: np.ndarray = UP
) -> list[Touch]:
    way = np.array(points, dtype=float)
    return fixture_touches(tool, [fixture], way[:-1], way[1:], np.repeat(axis, len(way) - 1, axis=0))


def test_a_diagonal_past_a_clamp_touches_nothing_but_axis_by_axis_it_does() -> None:
    """D10 from X0 Y0 to X100 Y40: the line passes the clamp X20…30 Y24…32 by more than 5 mm; a dog-leg does not."""
    tool = flat(0.010)

    assert touch(tool, CLAMP, (0.0, 0.0, 0.005), (0.1, 0.04, 0.005)) == []

    dog_leg = touch(tool, CLAMP, (0.0, 0.0, 0.005), (0.04, 0.04, 0.005), (0.1, 0.04, 0.005))
    assert [(t.part, t.fixture, t.piece) for t in dog_leg] == [("cutting", "clamp", 0)]
    # along the 45 degree line the corner X20…30 Y24 is met when the axis is 5 mm from (24, 24) across the line y = x:
    # the line runs through the box itself, so first contact is with its corner (20, 24) or its face Y24
    t = dog_leg[0].share
    x = y = 0.04 * t
    gap = math.hypot(max(0.020 - x, 0.0, x - 0.030), max(0.024 - y, 0.0, y - 0.032))
    assert gap == pytest.approx(0.005, abs=1e-6)


@pytest.mark.parametrize("miss", [-2e-5, 2e-5])
def test_the_side_of_a_cutter_is_round_to_a_hundredth_of_a_millimetre(miss: float) -> None:
    """Past a vertical edge at a distance of its radius, a little more or a little less."""
    tool = flat(0.010)
    offset = (0.005 + miss) / math.sqrt(2.0)
    corner = np.array([0.020, 0.024, 0.0]) - [offset, offset, 0.0]
    along = 0.02 * np.array([1.0, -1.0, 0.0])

    touches = touch(tool, CLAMP, tuple(corner - along), tuple(corner + along))

    assert bool(touches) == (miss < 0.0)
    if touches:
        assert touches[0].depth == pytest.approx(-miss, rel=1e-3)


def test_there_and_back_again_are_two_visits_and_a_border_inside_is_none() -> None:
    """Through the clamp, out of it, and back in the next line: both were one event, told at the first line alone."""
    near, inside, far = (0.0, 0.028, 0.005), (0.025, 0.028, 0.005), (0.06, 0.028, 0.005)

    visits = touch(flat(0.010), CLAMP, near, far, near)
    assert [(t.piece, t.pieces, t.share) for t in visits] == [
        (0, 1, pytest.approx(0.25, abs=1e-6)),  # X15 of 60
        (1, 1, pytest.approx(25.0 / 60.0, abs=1e-6)),  # X35
    ]
    assert [(t.piece, t.pieces) for t in touch(flat(0.010), CLAMP, near, inside, far)] == [(0, 2)]


@pytest.mark.parametrize("gap", [-2e-5, 2e-5])
def test_a_flat_bottom_is_flat(gap: float) -> None:
    """A 50 mm face passes above the clamp without a round end that would reach deeper."""
    touches = touch(flat(0.050), CLAMP, (-0.1, 0.028, 0.010 + gap), (0.1, 0.028, 0.010 + gap))

    assert bool(touches) == (gap < 0.0)
    if touches:
        assert touches[0].depth == pytest.approx(-gap, rel=1e-6)
        assert touches[0].tip[0] == pytest.approx(0.020 - 0.025, abs=1e-6)  # the rim meets the face X20


def test_a_ball_passes_an_edge_where_a_flat_does_not() -> None:
    """R5 with its lowest point 2 mm below the top edge: the ball's flank is sqrt(25 - 9) = 4 mm from its axis there."""
    way = ((0.020 - 0.0045, -0.1, 0.008), (0.020 - 0.0045, 0.1, 0.008))

    assert touch(ToolParts.of(BallEndMill(number=1, diameter=0.010)), CLAMP, *way) == []
    assert len(touch(flat(0.010), CLAMP, *way)) == 1
    nearer = ((0.020 - 0.0039, -0.1, 0.008), (0.020 - 0.0039, 0.1, 0.008))
    assert len(touch(ToolParts.of(BallEndMill(number=1, diameter=0.010)), CLAMP, *nearer)) == 1


def test_the_holder_is_named_when_it_is_the_holder() -> None:
    """40 mm holder 12 mm above the tip, over a clamp whose top is 3 mm above the holder's face."""
    tool = ToolParts.of(FlatEndMill(number=2, diameter=0.010, length=0.012, holder=Holder(diameter=0.04, length=0.05)))

    (found,) = touch(tool, CLAMP, (0.0, 0.015, -0.005), (0.05, 0.015, -0.005))

    assert found.part == "holder"
    assert found.depth == pytest.approx(0.003, rel=1e-6)


def test_a_collar_above_a_slim_nose_is_no_hull() -> None:
    """A cone from 10 to 20 mm radius over 30 mm, then a collar of 30 mm: beside a wall that ends 15 mm above the nose
    the cone reaches 15 mm there, the hull of both 20 mm, and at the nose itself the collar reaches nothing."""
    holder = Holder(
        diameter=0.02, upper_diameter=0.04, length=0.03, above=(StackedSection(diameter=0.06, length=0.01),)
    )
    tool = ToolParts.of(FlatEndMill(number=2, diameter=0.006, length=0.02, holder=holder))
    wall = box("wall", (0.0, -0.1, 0.0), (0.01, 0.1, 0.035))

    (found,) = touch(tool, wall, (-0.05, 0.0, 0.0), (-0.014, 0.0, 0.0))

    assert touch(tool, wall, (-0.05, 0.0, 0.0), (-0.0151, 0.0, 0.0)) == []
    assert found.part == "holder" and found.tip[0] == pytest.approx(-0.015, abs=1e-6)
    assert found.depth == pytest.approx(0.001 * 3.0 / math.sqrt(10.0), rel=1e-3)  # out across the flank


def test_a_shank_above_short_flutes_is_named() -> None:
    tool = ToolParts.of(FlatEndMill(number=2, diameter=0.010, length=0.06, flute_length=0.02))
    beam = box("beam", (0.0, 0.0, 0.030), (0.1, 0.1, 0.035))

    (found,) = touch(tool, beam, (-0.02, 0.05, 0.0), (0.02, 0.05, 0.0))

    assert found.part == "shank"
    assert found.tip == pytest.approx((-0.005, 0.05, 0.0), abs=1e-6)


def test_one_event_a_visit() -> None:
    """In, further in, out, away, in again: two events; the first lasts three pieces."""
    way = [(0.0, 0.028, 0.0), (0.018, 0.028, 0.0), (0.025, 0.028, 0.0), (0.0, 0.028, 0.0), (0.0, 0.028, 0.05)]
    way += [(0.025, 0.028, 0.05), (0.025, 0.028, 0.005)]

    found = touch(flat(0.010), CLAMP, *way)

    assert [(t.piece, t.pieces) for t in found] == [(0, 3), (5, 1)]
    # deepest with the axis in the middle of the clamp: out over Y, half its width and the radius
    assert found[0].depth == pytest.approx(0.004 + 0.005, rel=1e-6)


def test_everything_may_be_turned() -> None:
    """Turning tool, way and fixture together changes neither depth nor share, so no axis is special."""
    X = Pose(np.array([0.3, -0.1, 0.2]), rotation_from_rpy(0.5, -0.7, 1.1))
    straight = touch(flat(0.010), CLAMP, (0.0, 0.03, 0.0), (0.05, 0.03, 0.0))
    turned_box = box("clamp", (0.020, 0.024, -0.015), (0.030, 0.032, 0.010), X)
    ends = [tuple(X.apply(np.array(p))) for p in ((0.0, 0.03, 0.0), (0.05, 0.03, 0.0))]

    (a,), (b,) = straight, touch(flat(0.010), turned_box, *ends, axis=X.rotate(UP))

    assert b.depth == pytest.approx(a.depth, rel=1e-9)
    assert b.share == pytest.approx(a.share, abs=1e-7)


def test_touching_without_entering_is_nothing() -> None:
    """A cutter that slides along the clamp's face, exactly its radius away."""
    assert touch(flat(0.010), CLAMP, (0.015, 0.0, 0.0), (0.015, 0.06, 0.0)) == []


def test_a_cylinder_and_a_mesh_stand_for_the_same_body() -> None:
    """A tool that goes straight at a round post meets it at the sum of the radii; a box of triangles like a box."""
    post = Obstacle.of("post", [Placed(Cylinder(radius=0.020, bottom=0.0, top=0.1))])
    (found,) = touch(flat(0.010), post, (-0.1, 0.0, 0.05), (0.0, 0.0, 0.05))
    assert found.tip[0] == pytest.approx(-0.025, abs=3e-5)  # the prism of 64 sides holds the post

    low, high = np.array([0.020, 0.024, -0.015]), np.array([0.030, 0.032, 0.010])
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))])
    way = ((0.0, 0.027, 0.0), (0.022, 0.027, 0.0))
    (solid,) = touch(flat(0.010), CLAMP, *way)
    (shell,) = touch(flat(0.010), Obstacle.of("clamp", [Placed(Mesh.of(corners, faces))]), *way)
    assert shell.share == pytest.approx(solid.share, abs=1e-6)


def test_triangles_in_the_midst_of_a_tool_hide_none_that_is_met_earlier_or_is_deeper() -> None:
    """A heap of triangles along a way of several pieces: all at once as each of them alone says."""
    rng = np.random.default_rng(8)
    corners = rng.uniform(-1.0, 1.0, (60, 1, 3)) * [0.04, 0.01, 0.01] + rng.uniform(-0.004, 0.004, (60, 3, 3))
    corners[7] = corners[7, 0]  # no triangle at all
    way = np.stack([np.linspace(-0.04, 0.04, 9), np.zeros(9), np.full(9, -0.005)], axis=1)

    def found(piece: int, facets: np.ndarray) -> tuple[float, float] | None:
        heap = Obstacle(name="heap", hulls=(), facets=facets)
        events = fixture_touches(flat(0.012), [heap], way[piece : piece + 1], way[piece + 1 : piece + 2], UP)
        return (events[0].share, events[0].depth) if events else None

    for piece in range(8):
        alone = [one for t in range(60) if (one := found(piece, corners[[t]]))]
        assert len(alone) > 2
        expected = (min(share for share, _ in alone), max(depth for _, depth in alone))
        assert expected == found(piece, corners) == found(piece, corners[::-1])


@pytest.mark.parametrize("lean", [0.0, 0.3, -0.7])
def test_first_contact_with_triangles_is_where_the_distance_ends(lean: float) -> None:
    """A cutter comes down on bumps. The depth of one that leans is an upper bound, 0.6 mm before they meet here."""
    x, y = np.meshgrid(np.linspace(-0.02, 0.02, 24), np.linspace(-0.02, 0.02, 24), indexing="ij")
    bumps = np.stack([x, y, 3e-3 * np.sin(210.0 * x) * np.cos(300.0 * y)], axis=-1)
    a, b, c, d = bumps[:-1, :-1], bumps[1:, :-1], bumps[1:, 1:], bumps[:-1, 1:]
    facets = np.concatenate([np.stack(three, axis=-2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))])
    axis, tool = np.array([[math.sin(lean), 0.0, math.cos(lean)]]), flat(0.016, length=0.5)
    start, end = np.array([0.0, 0.0, 0.05]), np.array([0.001, 0.002, -0.01])
    orders = (facets, facets[::-1], facets[::2])
    found, back, half = (
        touch(tool, Obstacle(name="bumps", hulls=(), facets=order), tuple(start), tuple(end), axis=axis)[0]
        for order in orders
    )

    def gap(share: float) -> float:
        outline, until = dict(tool.outlines)["cutting"], start + share * (end - start)
        return min(separation(outline, axis[0], start, until, facet, 1e-9) for facet in facets)

    assert (found.share, found.depth) == (back.share, back.depth)
    assert found.share <= half.share and found.depth >= half.depth
    assert gap(found.share) == 0.0 < gap(found.share - 1e-6)


def test_a_shallow_triangle_behind_a_deep_one_is_met_first() -> None:
    """One across the whole way at X0, one of 0.1 mm at X-10 that only the side of the cutter brushes."""
    deep = np.array([[0.0, -0.02, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.02]])
    shallow = np.array([-0.010, 0.0059, 0.010]) + 1e-4 * np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1]])
    heap = Obstacle(name="heap", hulls=(), facets=np.stack([deep, shallow]))
    (both,) = touch(flat(0.012), heap, (-0.04, 0.0, 0.0), (0.04, 0.0, 0.0))
    assert -0.0115 < both.tip[0] < -0.0110  # 1.09 mm before the middle of the small one, by Pythagoras
    assert both.depth == pytest.approx(0.006, abs=1e-6)


def test_many_pieces_far_away_cost_little_and_find_nothing() -> None:
    rng = np.random.default_rng(3)
    way = rng.uniform(0.1, 0.2, (20001, 3))

    assert fixture_touches(flat(0.010), [CLAMP], way[:-1], way[1:], np.repeat(UP, 20000, axis=0)) == []


def test_distances_between_swept_cutters_and_boxes() -> None:
    """Random sweeps against sampling: the compiled distance is never more than a fine sampling finds, and near it."""
    rng = np.random.default_rng(11)
    box = CLAMP.hulls[0].corners
    low, high = box.min(axis=0), box.max(axis=0)
    outline = np.array([[0.004, 0.0], [0.004, 0.03]])
    t, h, r, a = np.meshgrid(
        np.linspace(0, 1, 41), np.linspace(0, 0.03, 31), [0.0, 0.004], np.linspace(0, 2 * np.pi, 48), indexing="ij"
    )
    for _ in range(30):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        start, end = rng.uniform(-0.06, 0.08, (2, 3))
        side = np.cross(axis, [1.0, 0.0, 0.0])
        side /= np.linalg.norm(side)
        other = np.cross(axis, side)
        points = (
            start
            + t[..., None] * (end - start)
            + h[..., None] * axis
            + (r * np.cos(a))[..., None] * side
            + (r * np.sin(a))[..., None] * other
        )
        sampled = np.linalg.norm(points - np.clip(points, low, high), axis=-1).min()

        exact = separation(outline, axis, start, end, box, 1e-9)

        assert exact <= sampled + 1e-9
        assert exact > sampled - 2e-3


def test_a_finding_says_line_both_bodies_place_and_depth() -> None:
    event = Touch(
        tool="T2", part="holder", fixture="clamp", piece=1, share=0.5, tip=(0.125, 0.2, 0.31), depth=0.003, pieces=4
    )

    finding = collision_finding(event, Span("part.nc", 70, 1), "G55", np.array([0.025, -0.0, 0.01]), 2.5)

    assert finding.code == "GS303"
    assert finding.span.line == 70
    assert finding.message == (
        "the holder of T2 hits clamp, 3.000 mm deep; they touch first when the tip is at X25.000 Y0.000 Z10.000 of G55"
    )
    assert (finding.value, finding.unit, finding.time) == (pytest.approx(3.0), "mm", 2.5)


@pytest.mark.parametrize("code", ["GS301", "GS302", "GS303", "GS304"])
def test_the_catalogue_explains(code: str) -> None:
    entry = code_of(code)
    assert entry.what and entry.why and entry.remedy


LEANING = [
    # radius and length of the tool, size, place and angles of the plate, way of the tip, first contact by coal 3.0.3
    (
        (4.024188, 27.296791), (9.051319, 11.05973, 17.290523), (65.435158, -72.461935, 27.704998),
        (-23.63786, 160.990338, 19.308344),
        (56.6362, -82.9747, 43.1587), (44.9565, -27.6987, 6.1027),
        (54.38388827, -72.31528383, 36.0128261),
    ),
    (
        (0.828147, 26.463258), (53.975369, 39.62164, 0.5), (-76.736231, -78.222727, 17.132215),
        (-47.258675, -174.291968, -101.464441),
        (-17.146, -51.9787, -5.3714), (-74.8418, -103.3105, 36.0736),
        (-65.36226871, -94.87658619, 29.26410652),
    ),
]  # fmt: skip


@pytest.mark.parametrize(("tool", "size", "place", "rpy", "start", "end", "first"), LEANING)
@pytest.mark.parametrize("pieces", [1, 2, 7, 40])
def test_leaning_plates_are_met_where_they_are_however_the_way_is_cut(
    tool: tuple[float, float],
    size: Point,
    place: Point,
    rpy: Point,
    start: Point,
    end: Point,
    first: Point,
    pieces: int,
) -> None:
    """[mm, deg]. The bound of the depth was greatest before they met, and the first contact told up to 1.8 mm early."""
    half = 0.5 * MM * np.array(size)
    plate = Placed(
        Box(lower=tuple((-half).tolist()), upper=tuple(half.tolist())),
        Pose(np.array(place) * MM, rotation_from_rpy(*np.deg2rad(rpy).tolist())),
    )
    radius, length = tool[0] * MM, tool[1] * MM
    outline = np.array([[0.0, 0.0], [radius, 0.0], [radius, length], [0.0, length]])
    parts = ToolParts(name="T2", outlines=(("cutting", outline),))
    way = np.linspace(start, end, pieces + 1) * MM

    hits = touch(parts, Obstacle.of("plate", [plate]), *map(tuple, way.tolist()))

    assert len(hits) == 1
    assert np.array(hits[0].tip) / MM == pytest.approx(np.array(first), abs=2e-4)

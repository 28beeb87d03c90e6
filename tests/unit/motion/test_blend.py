"""How rows are joined, mode by mode."""

from __future__ import annotations

from math import asin, cos, pi, sin, sqrt

import numpy as np
import pytest

from gcodesim.canon import ArcFeed, Axes, Dwell, Event, LinearFeed, PathMode, Rapid
from gcodesim.diagnostics import Span
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import along_limits, blend
from gcodesim.motion.blend_kernels import NORMAL_SHARE, OPEN_END_SHARE, TANGENTIAL_SHARE, in_plane, merge_chords
from gcodesim.motion.curve_kernels import ROUND, STRAIGHT
from gcodesim.motion.curves import Curves
from gcodesim.motion.pieces import OVERLAP, AxisLimits, Pieces
from gcodesim.motion.timing import time_law

MM = 1e-3
LIMITS = AxisLimits(
    speed=np.array([0.5, 0.5, 0.25, 3.0, 3.0, 3.0]), acceleration=np.array([3.0, 3.0, 2.0, 10.0, 10.0, 10.0])
)


def at(number: int = 1) -> Span:
    return Span("t", number, 1, number, 2)


def line(x: float, y: float = 0.0, z: float = 0.0, a: float = 0.0, feed: float = 0.1) -> LinearFeed:
    return LinearFeed(span=at(), end=(x, y, z, a, 0.0, 0.0), feed=feed)


def turn(a: float, b: float, feed: float) -> LinearFeed:
    """A and B [rad] to there, in the feed [rad/s] of both together."""
    return LinearFeed(span=at(), end=(0.0, 0.0, 0.0, a, b, 0.0), feed=feed)


def rapid(x: float, y: float = 0.0, z: float = 0.0) -> Rapid:
    return Rapid(span=at(), end=(x, y, z, 0.0, 0.0, 0.0))


def mode(kind: str, tolerance: float = 0.0, naive: float = 0.0) -> PathMode:
    return PathMode(span=at(), mode=kind, tolerance=tolerance, naive=naive)  # type: ignore[arg-type]


def joined(*events: Event) -> Pieces:
    return blend(build_tool_path(events), LIMITS)


def test_exact_stop_stands_at_each_end() -> None:
    pieces = joined(mode("exact_stop"), line(0.1), line(0.2), line(0.2, 0.1))

    assert pieces.junction.tolist() == [0.0, 0.0, 0.0]
    assert not pieces.joint.any()


def test_exact_path_passes_tangents_and_stands_at_corners() -> None:
    pieces = joined(mode("exact_path"), line(0.1), line(0.2), line(0.2, 0.1))

    assert pieces.junction[0] > 1.0
    assert pieces.junction[1] == 0.0
    # the planner keeps back what a step of direction may take, though it stands there
    assert pieces.acceleration == pytest.approx([3.0, 2.7, 2.7])


def test_exact_path_stands_between_chords_whose_turn_takes_more_than_a_tenth_of_the_acceleration() -> None:
    """A turn by w asks for w (v + a dt) within a dt of 1 ms: 0.3 m/s² are a tenth, so w = 0.3 / 103 at 0.1 m/s."""
    below, above = 0.00290, 0.00293
    small = joined(mode("exact_path"), line(0.1), line(0.2, 0.1 * below))
    large = joined(mode("exact_path"), line(0.1), line(0.2, 0.1 * above))

    assert small.junction[0] > 1.0
    assert large.junction[0] == 0.0


def test_a_turn_is_passed_by_the_slower_block_and_beside_an_arc_counts_double() -> None:
    """`tpSetupTangent` in tp.c: 0.3 / (v + 3 m/s² dt) of v = 0.02 m/s is 0.0130, of 0.1 m/s it is 0.0029."""
    slow = joined(mode("exact_path"), line(0.1), line(0.2, 0.1 * 0.0129, feed=0.02))
    fast = joined(mode("exact_path"), line(0.1), line(0.2, 0.1 * 0.0129, feed=0.1))

    def bent(w: float) -> float:
        """Speed from a line into an arc of 1 m that begins `w` to the left."""
        x, y = 0.1 - sin(w), cos(w)
        behind = arc((x + sin(w + 0.1), y - cos(w + 0.1)), (x, y), ccw=True, sweep=0.1)
        return float(joined(mode("exact_path"), line(0.1), behind).junction[0])

    assert slow.junction[0] > 1.0
    assert fast.junction[0] == 0.0
    assert bent(0.0014) > 1.0
    assert bent(0.0016) == 0.0


def test_arcs_flatter_than_p_go_as_chords() -> None:
    """`ARC_FEED` in emccanon.cc: arcs of the XY plane that leave their chord by less than P (or Q)."""
    waves = []
    for k, up in enumerate((True, False) * 3):  # 2 mm each, 0.02 mm high
        radius, height = 25.01, 24.99
        sweep = 2.0 * asin(1.0 / radius)
        middle = ((2 * k + 1) * MM, (-height if up else height) * MM)
        waves.append(arc(((2 * k + 2) * MM, 0.0), middle, ccw=not up, sweep=-sweep if up else sweep))

    merged = joined(mode("blend", 0.03 * MM), *waves)
    apart = joined(mode("blend", 0.015 * MM), *waves)

    assert len(merged) == 1
    assert merged.curves.kind.tolist() == [STRAIGHT]
    assert merged.length[0] == pytest.approx(12.0 * MM, rel=1e-6)
    assert ROUND in apart.curves.kind
    assert joined(mode("exact_path"), *waves).curves.kind.tolist() == [ROUND] * 6


def test_a_corner_arc_is_tangent_and_within_tolerance() -> None:
    pieces = joined(mode("blend", 0.1 * MM), line(0.05), line(0.05, 0.05))

    assert pieces.joint.tolist() == [False, True, False]
    ends, tangents = pieces.points(np.array([0, 1, 1, 2]), np.array([pieces.length[0], 0.0, pieces.length[1], 0.0]))
    assert np.allclose(ends[0], ends[1], atol=1e-15) and np.allclose(ends[2], ends[3], atol=1e-15)
    assert np.allclose(tangents[0], tangents[1]) and np.allclose(tangents[2], tangents[3])
    middle = pieces.points(np.array([1]), pieces.length[1:2] / 2)[0][0, :2]
    assert np.hypot(*(middle - [0.05, 0.05 * 0])) == pytest.approx(0.1 * MM)
    assert pieces.acceleration[1] == pytest.approx(TANGENTIAL_SHARE * 3.0)


def test_without_tolerance_a_quarter_of_the_shorter_block_is_the_limit() -> None:
    """At a speed that needs more than that, R = P s / (1 - s) with P = a quarter of 2 mm, trim at most half."""
    pieces = joined(mode("blend"), line(0.05, feed=0.5), line(0.05, 2 * MM, feed=0.5))

    s = sqrt(0.5)
    expected = min(0.5 * MM * s / (1 - s), 1 * MM)
    assert np.linalg.norm(pieces.curves.radial[pieces.curve[1]]) == pytest.approx(expected)


def test_a_corner_is_no_wider_than_the_speed_needs() -> None:
    slow = joined(mode("blend", 1 * MM), line(0.05, feed=0.01), line(0.05, 0.05, feed=0.01))

    radius = float(np.linalg.norm(slow.curves.radial[slow.curve[1]]))
    assert slow.speed[1] == pytest.approx(0.01)
    assert radius == pytest.approx(0.01**2 / (0.5 * 3.0 * pi / 2))


def test_rapids_are_not_joined_to_feeds() -> None:
    pieces = joined(mode("blend", 1 * MM), rapid(0.1), line(0.2), rapid(0.3))

    assert pieces.junction.tolist() == [0.0, 0.0, 0.0]
    # the queue runs empty only behind the last one
    assert pieces.acceleration == pytest.approx([3.0, 3.0, 3.0 * OPEN_END_SHARE])


@pytest.mark.parametrize("tolerance", [0.0, 0.05 * MM])
def test_a_way_back_begins_at_rest_in_g64_too(tolerance: float) -> None:
    """Within 2 degrees of a reversal; measured on LinuxCNC: 30 mm and back at 100 mm/s and 3 m/s², P 0.1: 1.037 s."""
    back = joined(mode("blend", tolerance), line(0.03), line(0.0, 0.0005), line(0.03, 0.001))

    assert back.kind.tolist() == [0, 0, 0]
    assert back.junction.tolist() == [0.0, 0.0, 0.0]
    # only the last block before the queue runs empty has less of its acceleration
    assert back.acceleration == pytest.approx([3.0, 3.0, 3.0 * OPEN_END_SHARE], rel=1e-3)


def test_a_sharp_corner_of_five_degrees_is_rounded() -> None:
    assert joined(mode("blend", 0.05 * MM), line(0.03), line(0.0, 0.0026)).joint.tolist() == [False, True, False]


def test_a_corner_is_missed_by_a_quarter_of_the_shorter_block_at_most_though_p_allows_more() -> None:
    """R = P s / (1 - s) with P = a quarter of 0.2 mm, not 0.1 mm; s of 60 degrees between the blocks."""
    pieces = joined(mode("blend", 0.1 * MM), line(0.05), line(0.05 - 0.1 * MM, 0.1 * sqrt(3.0) * MM))

    expected = 0.05 * MM * 0.5 / (1 - 0.5)
    assert np.linalg.norm(pieces.curves.radial[pieces.curve[1]]) == pytest.approx(expected)


def arc(end: tuple[float, float], centre: tuple[float, float], *, ccw: bool, sweep: float) -> ArcFeed:
    full: Axes = (*end, 0.0, 0.0, 0.0, 0.0)
    return ArcFeed(
        span=at(), end=full, center=(*centre, 0.0), normal=(0.0, 0.0, 1.0), ccw=ccw, turns=1, sweep=sweep, feed=0.1
    )


@pytest.mark.parametrize(
    ("radius", "tolerance", "seconds"), [(10.0, 0.02, 0.717), (10.0, 0.2, 0.665), (10.0, 1.0, 0.583)]
)
def test_corners_of_arcs_take_as_long_as_on_linuxcnc(radius: float, tolerance: float, seconds: float) -> None:
    """Three quarter circles that meet under 90 degrees at 100 mm/s and 3 m/s²; 3 ms of its times are waits."""
    chord = radius * sqrt(2.0) * MM
    arcs = [arc((chord * k, 0.0), (chord * (k - 0.5), 0.5 * chord), ccw=True, sweep=pi / 2) for k in (1, 2, 3)]
    found = time_law(joined(mode("blend", tolerance * MM), *arcs))

    assert found.duration == pytest.approx(seconds - 0.003, abs=0.002)


@pytest.mark.parametrize(("between", "overlap"), [(20.0, True), (60.0, False)])
def test_arcs_that_meet_under_a_narrow_angle_overlap(between: float, overlap: bool) -> None:
    """Under less than 30 degrees; both then have half of their acceleration all along."""
    first = arc((0.01, 0.01), (0.0, 0.01), ccw=True, sweep=pi / 2)  # comes up along Y
    w = between * pi / 180.0
    x, y = 0.01 + 0.01 * cos(w), 0.01 + 0.01 * sin(w)  # the second goes down, by that much to the right
    behind = arc((x - 0.01 * cos(w + pi / 3), y - 0.01 * sin(w + pi / 3)), (x, y), ccw=True, sweep=pi / 3)

    pieces = joined(mode("blend", 0.05 * MM), first, behind)

    assert pieces.kind.tolist() == [0, OVERLAP if overlap else 0, 0]
    assert pieces.joint.tolist() == [False, True, False]


def test_p_does_not_slow_what_only_turns() -> None:
    """No corner of the tip's path is cut: A by 30 and C by 90 degrees at 150 deg/s take as long with P as without."""
    events = (line(0.0, a=0.5, feed=2.5), line(0.01, a=0.5, feed=0.1))
    wide, narrow = (time_law(joined(mode("blend", p * MM), *events)).duration for p in (100.0, 0.001))

    assert narrow == pytest.approx(wide, rel=1e-9)


def test_rotary_moves_overlap_in_g64_and_stand_in_g61() -> None:
    events = (line(0.05, a=1.0), line(0.1, a=2.0))

    assert OVERLAP in joined(mode("blend"), *events).kind
    exact = joined(mode("exact_path"), *events)
    assert exact.junction.tolist() == [0.0, 0.0]
    assert exact.kind.tolist() == [0, 0]


def test_the_second_of_two_that_overlap_goes_on_at_its_speed() -> None:
    """A slows from 1 rad/s by 5 rad/s² in 0.2 s; B has 0.25 rad/s after 0.05 s and so goes 0.04375 rad meanwhile."""
    events = (turn(1.0, 0.0, 1.0), turn(1.0, 1.0, 0.25))
    path = build_tool_path((mode("blend"), *events))

    early, even = (blend(path, LIMITS, early=early) for early in (True, False))

    lap = np.flatnonzero(early.kind == OVERLAP)[0]
    assert (early.ratio[lap], early.rise[lap]) == pytest.approx((0.25, 0.25))
    places, slopes = early.points(np.array([lap] * 3), np.array([0.125, 0.25, 1.0]) * early.length[lap])
    assert places[:, 4] == pytest.approx([0.5 * 5.0 * 0.025**2, 0.5 * 5.0 * 0.05**2, 0.25 * 0.175])
    assert slopes[:, 4] == pytest.approx([0.125, 0.25, 0.25])
    assert time_law(early).duration == pytest.approx(1.0 + 0.05 + 1.0 / 0.25)  # A until it slows, then B
    assert time_law(even).duration - time_law(early).duration == pytest.approx(0.5 * (0.2 - 0.05))


def test_an_axis_that_goes_on_has_no_more_than_its_speed_by_both_blocks() -> None:
    """A is at its 3 rad/s and slows by 10/9 rad/s², as B brakes along; then A alone, which would be fast too soon."""
    limits = AxisLimits(speed=np.full(6, 3.0), acceleration=np.array([3.0, 3.0, 2.0, 10.0, 10.0 / 4.5, 10.0]))
    path = build_tool_path((mode("blend"), turn(10.0, 10.0, 9.0), turn(20.0, 10.0, 9.0)))

    trajectory = time_law(blend(path, limits, early=True))
    speed = trajectory.sample(np.linspace(0.0, trajectory.duration, 4000)).velocity[:, 3]

    assert speed.max() == pytest.approx(3.0, rel=1e-9)


def test_chords_within_tolerance_become_one_line() -> None:
    points = [line(0.01 * k, 0.004 * MM * (k % 2)) for k in range(1, 6)]

    merged = joined(mode("blend", 0.01 * MM), *points)
    apart = joined(mode("blend", 0.002 * MM), *points)
    finer = joined(mode("blend", 0.01 * MM, naive=0.001 * MM), *points)

    assert len(merged) == 1
    assert (merged.row_first[0], merged.row_last[0]) == (0, 4)
    assert len(apart) == len(finer) > 1


@pytest.mark.parametrize("between", [line(0.02, feed=0.2), Dwell(span=at(), seconds=1.0), line(0.02, a=1.0)])
def test_chords_are_not_merged_over_what_matters(between: Event) -> None:
    pieces = joined(mode("blend", 0.01 * MM), line(0.01), between, line(0.03), line(0.04))

    assert np.count_nonzero(~pieces.joint) > 1


def test_merging_agrees_with_a_slow_twin() -> None:
    rng = np.random.default_rng(11)
    points = np.cumsum(rng.normal(size=(200, 3)) * [1.0, 0.05, 0.05], axis=0)
    start, end = points[:-1], points[1:]
    joined_rows = rng.random(199) < 0.95
    tolerance = np.full(199, 0.2)

    flat, middle = rng.random(199) < 0.1, 0.5 * (start + end) + rng.normal(size=(199, 3)) * 0.08

    got = merge_chords(start, end, joined_rows, tolerance, flat, middle)

    first = np.arange(199)
    for i in range(1, 199):
        head = first[i - 1]
        if not joined_rows[i] or i - head > 100:
            continue
        a, b = start[head], end[i]
        inner = np.concatenate([end[head:i], middle[head : i + 1][flat[head : i + 1]]])
        t = np.clip((inner - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        if np.linalg.norm(a + t[:, None] * (b - a) - inner, axis=1).max() <= 0.2:
            first[i] = head
    assert np.array_equal(got, first)


def test_limits_along_a_line_and_an_arc() -> None:
    half_circle = ArcFeed(
        span=at(), end=(0.2, 0.0, 0.0, 0.0, 0.0, 0.0), center=(0.1, 0.0, 0.0), normal=(0.0, 0.0, 1.0),
        ccw=True, turns=1, sweep=pi, feed=9.0,
    )  # fmt: skip
    path = build_tool_path([half_circle, line(0.2 + 0.3, 0.4)])

    speed, acceleration, bending = along_limits(Curves.of(path), LIMITS)

    # arc: inscribed circle; sqrt(0.866 a R) = 0.51 is more than 0.5; 0.5² / R = 2.5 of 3.0 bend
    assert speed[0] == pytest.approx(0.5)
    assert bending == pytest.approx([sqrt(sqrt(0.75) * 3.0 * 0.1), np.inf])
    assert acceleration[0] == pytest.approx(3.0 * sqrt(1 - (2.5 / 3.0) ** 2))
    assert speed[1] == pytest.approx(0.5 / 0.8)
    assert acceleration[1] == pytest.approx(3.0 / 0.8)
    assert pytest.approx(sqrt(0.75)) == NORMAL_SHARE


def test_inscribed_circle_of_an_oblique_plane() -> None:
    """In the plane with normal (1, 1, 0)/sqrt 2 a direction may be all Z, or share X and Y."""
    n = 1 / sqrt(2)

    assert in_plane(n, n, 0.0, np.array([3.0, 3.0, 2.0])) == pytest.approx(2.0)
    assert in_plane(n, n, 0.0, np.array([1.0, 3.0, 2.0])) == pytest.approx(sqrt(2))
    assert in_plane(0.0, 0.0, 1.0, np.array([3.0, 2.5, 0.1])) == pytest.approx(2.5)


def test_independent_rapids_take_the_slowest_axis() -> None:
    path = build_tool_path([rapid(0.5, 0.1)])

    pieces = blend(path, LIMITS, independent_rapids=True)

    assert pieces.fixed.tolist() == [True]
    assert pieces.length[0] == pytest.approx(0.5 / 0.5 + 0.5 / 3.0)
    # Y is done when X is still on its way: the path is no straight line
    at_half, _ = pieces.points(np.array([0]), np.array([0.6]))
    assert at_half[0, 1] == pytest.approx(0.1) and at_half[0, 0] < 0.3


def test_rows_with_a_law_of_their_own_stand_at_both_ends() -> None:
    path = build_tool_path([line(0.1), line(0.1), line(0.3)])

    pieces = blend(path, LIMITS, own_time=np.array([np.nan, 2.0, np.nan]))

    assert pieces.fixed.tolist() == [False, True, False]
    assert pieces.junction.tolist() == [0.0, 0.0, 0.0]
    assert pieces.length[1] == 2.0


def test_rows_that_do_not_move_are_left_out() -> None:
    pieces = joined(mode("blend", 1 * MM), line(0.1), line(0.1), line(0.1, 0.1))

    assert pieces.row_first[~pieces.joint].tolist() == [0, 2]


def test_an_empty_path_has_no_pieces() -> None:
    assert len(joined(mode("blend"))) == 0


def test_helices_overlap_with_what_they_are_not_tangent_to() -> None:
    end: Axes = (0.1, 0.0, -0.01, 0.0, 0.0, 0.0)
    helix = ArcFeed(
        span=at(), end=end, center=(0.15, 0.0, -0.01), normal=(0.0, 0.0, 1.0), ccw=True, turns=1, sweep=2 * pi, feed=0.1
    )

    assert joined(mode("blend", 0.1 * MM), line(0.1), helix).kind.tolist() == [0, OVERLAP, 0]

"""The columns of a tool path and its habits: iterate, add, move, draw."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from gcodesim import build_box_path, circular_interpolation, linear_interpolation, spline_interpolation
from gcodesim.canon import ArcFeed, Dwell, LinearFeed
from gcodesim.diagnostics import Span
from gcodesim.motion import ToolPath, build_tool_path
from gcodesim.motion.tool_path import LINE, RAPID

QUARTER_Z = (0.0, 0.0, sqrt(0.5), sqrt(0.5))


def line(x: float, y: float, z: float, number: int = 1) -> LinearFeed:
    return LinearFeed(span=Span("t", number, 1, number, 2), end=(x, y, z, 0.0, 0.0, 0.0), feed=0.1)


def quarter_circle() -> ToolPath:
    """From the origin about (0, 1, 0), counterclockwise, rising by 0.5."""
    arc = ArcFeed(
        span=Span("t"), end=(1.0, 1.0, 0.5, 0.0, 0.0, 0.0), center=(0.0, 1.0, 0.5), normal=(0.0, 0.0, 1.0),
        ccw=True, turns=1, sweep=pi / 2, feed=0.1,
    )  # fmt: skip
    return build_tool_path([arc])


def test_iterating_gives_position_orientation_active() -> None:
    path = ToolPath.from_points(np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0]]), active=[False, True])

    points = [(tuple(p), tuple(q), on) for p, q, on in path]

    upright = (0.0, 0.0, 0.0, 1.0)
    assert points == [((0, 0, 0), upright, False), ((1, 0, 0), upright, False), ((1, 2, 0), upright, True)]


def test_orientations_survive_the_rotary_columns() -> None:
    rng = np.random.default_rng(3)
    q = rng.normal(size=(20, 4))
    q /= np.linalg.norm(q, axis=1)[:, None]

    path = ToolPath.from_points(rng.normal(size=(20, 3)), q)

    got = np.array([orientation for _, orientation, _ in path])
    assert np.abs(np.abs((got * q).sum(axis=1)) - 1.0).max() < 1e-12


def test_paths_add_with_their_states_spans_and_events() -> None:
    first = build_tool_path([line(1, 0, 0)])
    second = build_tool_path([Dwell(span=Span("t", 7), seconds=1.0), line(2, 0, 0, number=8)], first_point(first))

    both = first + second

    assert len(both) == 2
    assert both.span(1).line == 8
    assert [(e.row, e.event.span.line) for e in both.events] == [(1, 7)]
    assert list(both.block) == [0, 1]
    assert np.array_equal(both.start[1], both.end[0])


def first_point(path: ToolPath) -> tuple[float, float, float, float, float, float]:
    x, y, z, a, b, c = path.end[-1]
    return (x, y, z, a, b, c)


def test_paths_that_do_not_meet_end_at_rest() -> None:
    apart = ToolPath.from_points(np.array([[0.0, 0, 0], [1, 0, 0]])) + ToolPath.from_points(
        np.array([[5.0, 0, 0], [6, 0, 0]])
    )

    assert list(apart.stop) == [True, False]


def test_adding_to_an_empty_path_keeps_the_other() -> None:
    path = quarter_circle()

    assert np.array_equal((ToolPath.from_points(np.zeros((1, 3))) + path).end, path.end)


def test_translate_and_rotate_move_arcs_with_their_centres() -> None:
    path = quarter_circle()

    moved = path.rotate(QUARTER_Z).translate((0.0, 0.0, 2.0))

    R = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert np.allclose(moved.polyline(), path.polyline() @ R.T + [0, 0, 2], atol=1e-15)
    assert np.array_equal(path.end, quarter_circle().end)  # the original is as it was


def test_rotating_turns_the_tool_along_when_rotary_axes_are_in_use() -> None:
    path = ToolPath.from_points(np.array([[0.0, 0, 0], [1, 0, 0]]), np.array([QUARTER_Z, QUARTER_Z]))

    turned = path.rotate(QUARTER_Z)

    assert np.allclose(np.abs(turned.end[0, 3:]), [0, 0, pi])


def test_length_counts_arcs_and_their_rise() -> None:
    assert quarter_circle().length == pytest.approx([sqrt((pi / 2) ** 2 + 0.25)])


def test_drawing_gives_a_polyline_within_the_chord() -> None:
    drawn: list[np.ndarray] = []

    class Axes:
        def plot(self, x: np.ndarray, y: np.ndarray, z: np.ndarray, **style: object) -> None:
            drawn.append(np.stack([x, y, z], axis=1))

    points = quarter_circle().draw(Axes(), chord=1e-4)

    middles = 0.5 * (points[1:] + points[:-1])
    assert np.array_equal(drawn[0], points)
    assert (1.0 - np.hypot(middles[:, 0], middles[:, 1] - 1.0)).max() <= 1e-4


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: ToolPath.from_points([[0.0, 0.0], [1.0, 1.0]]), "a path has rows of 3 numbers"),
        (lambda: ToolPath.from_points([[0.0, 0.0, 0.0], [np.nan, 0.0, 0.0]]), "finite numbers"),
        (lambda: ToolPath.from_points("abc"), "a path has rows of 3 numbers; 'abc' is given"),
        (lambda: ToolPath.from_points(np.zeros((2, 3)), feed=np.nan), "the feed of a path is a finite number"),
        (lambda: ToolPath.from_points(np.zeros((2, 3)), feed=0.0), "the feed of a path is more than 0"),
        (lambda: ToolPath.from_points(np.zeros((2, 3)), active=[True, False]), "one flag or 1 of them; 2 are given"),
        (lambda: ToolPath.from_points(np.zeros((2, 3)), np.zeros((2, 4))), "not all 0"),
        (lambda: ToolPath.from_points(np.zeros((2, 3))).translate([1.0, 2.0]), "a translation has 3 numbers"),
        (lambda: ToolPath.from_points(np.zeros((2, 3))).rotate([0.0, 0.0, 0.0, 0.0]), "not all 0"),
        (lambda: linear_interpolation([0.0, 0.0], [1.0, 1.0, 0.0], 5), "the start of the line has 3 numbers"),
        (lambda: linear_interpolation([0.0] * 3, [1.0] * 3, 5.0), "a whole number; 5.0 is given"),
        (lambda: circular_interpolation([0.0] * 3, [1.0, 0.0, 0.0], np.nan, 5), "the radius of the arc"),
        (lambda: circular_interpolation([0.0] * 3, [1.0, 0.0, 0.0], 1.0, 5, axis=3), "0, 1 or 2"),
        (lambda: spline_interpolation([0.0, 0.0], 5), "a spline has rows of numbers"),
        (lambda: spline_interpolation([[0.0, 0.0, 0.0]], 5), "two points or more"),
        (lambda: build_box_path([0.0, 0.0], [1.0, 1.0], [0, 0, 0, 1], 0.0, [0, 0, 0, 1], 9), "the middle of the box"),
    ],
)
def test_what_is_no_path_is_told_in_words(make, says):
    with pytest.raises(ValueError, match=says):
        make()


def test_a_path_goes_on_with_a_path():
    path = ToolPath.from_points(np.zeros((2, 3)))
    for call in (lambda: path.append(3), lambda: path.prepend(None), lambda: path.transform(np.eye(4))):
        with pytest.raises(TypeError):
            call()
    assert len(ToolPath.from_points([])) == 0


def test_all_of_a_path_gets_one_feed() -> None:
    """Rapids become lines, arcs stay what they are, and the path itself is left as it was."""
    rapids = ToolPath.from_points(np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1, 0.1, 0.0]]))
    fed = rapids.at_feed(0.05)

    assert fed.kind.tolist() == [LINE, LINE] and fed.feed.tolist() == [0.05, 0.05]
    assert rapids.kind.tolist() == [RAPID, RAPID] and np.isinf(rapids.feed).all()
    assert fed.positions.tolist() == rapids.positions.tolist()
    with pytest.raises(ValueError, match="the feed of a path"):
        rapids.at_feed(np.inf)


def test_orientations_of_a_path_are_those_it_was_made_of() -> None:
    """Besides the sign, of which a quaternion has two."""
    turns = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.6, 0.0, 0.8], [0.5, 0.5, 0.5, 0.5]])
    path = ToolPath.from_points(np.eye(3), turns)

    assert np.abs((path.orientations * turns).sum(axis=1)) == pytest.approx(np.ones(3), abs=1e-12)

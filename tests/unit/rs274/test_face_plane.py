"""G12.1: a contour of X and C on the face of a lathe's work, as moves of X, Z and C."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from gcodesim import canon
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.run import Run

HEAD = "G10 L12 P1 R3.\nG21 G18 G40 G98\nG0 X60. Z5. C{c}\nG1 Z-2. F300\nG12.1\n"


def read(text: str, sense: float = 1.0) -> Run:
    return interpret(SourceText("face.nc", text.encode()), Settings(dialect="fanuc_lathe", c_goes_round=sense))


def events(text: str, *, c: float = 0.0, sense: float = 1.0) -> list[canon.Event]:
    run = read(HEAD.format(c=c) + text, sense)
    found = list(run)
    assert not [finding for finding in run.findings if finding.level.name == "ERROR"], run.findings
    return found


def feeds(text: str, line: int, *, c: float = 0.0, sense: float = 1.0) -> list[canon.LinearFeed]:
    return [e for e in events(text, c=c, sense=sense) if isinstance(e, canon.LinearFeed) and e.span.line == line]


def place(move: canon.Move, *, c: float = 0.0, sense: float = 1.0) -> tuple[float, float]:
    """Where in the plane a move ends [mm]."""
    angle = sense * (move.end[5] - math.radians(c))
    return 1e3 * move.end[0] * math.cos(angle), 1e3 * move.end[0] * math.sin(angle)


@pytest.mark.parametrize(("c", "sense"), [(0.0, 1.0), (0.0, -1.0), (40.0, -1.0)])
def test_a_line_is_followed_to_a_micron(c: float, sense: float) -> None:
    """From (30, 0) to (10, 20): X is a diameter, C a length that counts from where C stands."""
    moves = feeds("G1 X20. C20. F300\nG13.1\nM30\n", 6, c=c, sense=sense)

    assert len(moves) > 10
    assert place(moves[-1], c=c, sense=sense) == pytest.approx((10.0, 20.0))
    for move in moves:
        x, y = place(move, c=c, sense=sense)
        assert x + y == pytest.approx(30.0, abs=1e-6) and move.end[1] == 0.0
    for one, other in pairwise(moves):
        radius, angle = (
            0.5e3 * (one.end[0] + other.end[0]),
            sense * (0.5 * (one.end[5] + other.end[5]) - math.radians(c)),
        )
        assert abs(radius * (math.cos(angle) + math.sin(angle)) - 30.0) / math.sqrt(2.0) < 1.1e-3


def test_the_feed_is_that_along_the_contour() -> None:
    """The times of the moves of X and C add up to the way divided by F."""
    moves = feeds("G1 X20. C20. F300\nG13.1\nM30\n", 6)
    radii = [0.03, *(move.end[0] for move in moves)]
    spent = sum(abs(b - a) / m.feed for a, b, m in zip(radii, radii[1:], moves, strict=False) if m.feed_unit == "m/s")

    assert spent == pytest.approx(math.hypot(20.0, 20.0) / 5.0, rel=1e-3)


def test_an_arc_about_the_axis_turns_c_alone() -> None:
    moves = feeds("G3 X-60. C0. I-30. J0. F300\nG13.1\nM30\n", 6)

    assert all(move.feed_unit == "rad/s" and move.feed == pytest.approx(5.0 / 30.0) for move in moves)
    assert {round(move.end[0], 9) for move in moves} == {0.03}
    assert moves[-1].end[5] == pytest.approx(math.pi)


def test_a_line_through_the_axis_turns_c_by_half() -> None:
    moves = feeds("G1 X-40. F300\nG13.1\nM30\n", 6)

    assert min(move.end[0] for move in moves) >= 0.0
    assert place(moves[-1]) == pytest.approx((-20.0, 0.0), abs=1e-6)


def test_compensation_and_steps_work_in_the_plane() -> None:
    """3 mm outside a square corner: U, H and W are steps; on the way out it is where the program says."""
    lines = "G42 D1 G1 X24. C0. F300\nH10.\nU-8. W-1.\nG40 X60. C0.\nG13.1\nM30\n"

    assert place(feeds(lines, 7)[-1]) == pytest.approx((15.0, 13.0), abs=1e-6)
    last = feeds(lines, 8)[-1]
    assert place(last) == pytest.approx((8.0, 13.0), abs=1e-6) and last.end[2] == pytest.approx(-0.003)
    assert place(feeds(lines, 9)[-1]) == pytest.approx((30.0, 0.0), abs=1e-6)


def test_afterwards_x_and_c_are_what_they_were() -> None:
    found = events("G1 X0. C30. F300\nG13.1\nG1 X60.\nG0 C0.\nM30\n")
    moves = [event for event in found if isinstance(event, canon.Move)]

    assert moves[-3].end[5] == pytest.approx(math.pi / 2.0) and moves[-3].end[0] == pytest.approx(0.03)
    assert moves[-2].end[0] == pytest.approx(0.03) and moves[-2].end[5] == pytest.approx(math.pi / 2.0)
    assert moves[-1].end[5] == 0.0


@pytest.mark.parametrize(
    ("lines", "code", "said"),
    [
        ("G0 X20.", "GS106", "G0 is refused"),
        ("G28 U0", "GS106", "G28 is refused"),
        ("G17", "GS106", "G17 is refused"),
        ("G54", "GS106", "G54 is refused"),
        ("T0202", "GS106", "a tool change is refused"),
        ("G1 Y3. F100", "GS106", "the word Y is refused"),
        ("G42 D1 G1 X20. F100\nG13.1", "GS150", "G13.1 is refused"),
        ("G13.1 X20.", "GS106", "in a block of its own"),
    ],
)
def test_what_is_refused(lines: str, code: str, said: str) -> None:
    run = read(HEAD.format(c=0.0) + lines + "\nM30\n")
    list(run)

    (first, *_) = [finding for finding in run.findings if finding.level.name == "ERROR"]
    assert first.code == code and said in first.message


def test_x_below_zero_and_y_beside_the_axis_are_no_start() -> None:
    for start in ("G0 X-10.", "G0 Y3."):
        run = read(f"G21 G98\n{start}\nG12.1\nM30\n")
        list(run)
        assert [f.code for f in run.findings if f.level.name == "ERROR"] == ["GS106"]

"""Two motions against each other."""

from __future__ import annotations

import pytest

from gcodesim.regress.moves import compare_motion
from gcodesim.regress.tolerance import DEFAULTS, Tolerance

HEAD = "G21 G90 G17 G94\nT1 M6\nS1000 M3\n"
BODY = "G0 X0 Y0\nG0 Z2\nG1 Z-1 F200\nG1 X30 F600\nG3 X40 Y10 I0 J10\nG1 Y30\nG0 Z20\nM5\nM2\n"


@pytest.fixture
def changes(steps):
    def changes(old: str, new: str, **tolerances: Tolerance):
        return compare_motion(steps(HEAD + old), steps(HEAD + new), {**DEFAULTS, **tolerances}).changes

    return changes


def test_nothing(changes) -> None:
    assert changes(BODY, BODY) == ()


def test_one_coordinate(changes) -> None:
    (change,) = changes(BODY, BODY.replace("G1 X30", "G1 X29.5"))[:1]
    (field,) = change.fields
    assert (change.kind, field.name, field.old, field.new, field.tolerance) == ("changed", "X", 30.0, 29.5, "position")
    assert (change.old.line, change.new.line) == (7, 7)


def test_moves_put_in_move_no_other(changes) -> None:
    (change,) = changes(BODY, BODY.replace("G0 Z20", "G1 X35\nX40\nG0 Z20"))
    assert (change.kind, change.count, change.new.line, change.last_new.line) == ("inserted", 2, 10, 11)
    assert change.way_mm == pytest.approx(10.0)
    assert change.near == change.new


def test_a_removed_state_is_told_beside_what_stood_before_it(changes) -> None:
    left = BODY.replace("G0 Z20\n", "M5\nG0 Z20\n")
    (change,) = changes(left, BODY)[:1]
    assert (change.kind, change.what, change.old.line, change.near.line) == ("removed", "spindle", 10, 9)


def test_a_shift_of_all_is_one_change(changes) -> None:
    """G92 moves the machine; the program's own words stay."""
    found = changes("G92 X0\n" + BODY, "G92 X-1\n" + BODY)
    assert [field.name for change in found for field in change.fields] == ["machine X"]
    assert found[0].count > 4


def test_a_feed_is_told_once_for_all_moves_that_have_it(changes) -> None:
    (change,) = changes(BODY, BODY.replace("F600", "F700"))
    assert [(f.name, f.old, f.new) for f in change.fields] == [("feed", 600.0, 700.0)]
    assert change.count == 3


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("G1 Y30", "G1 Y20\nY30"),
        ("G3 X40 Y10 I0 J10", "G3 X37.07106781 Y2.92893219 I0 J10\nG3 X40 Y10 I-7.07106781 J7.07106781"),
        ("G3 X40 Y10 I0 J10", "G3 X40 Y10 R10"),
        ("G1 X30 F600", "G1 X10 F600\nX20\nX30"),
    ],
)
def test_moves_that_are_only_divided_are_no_difference(changes, old: str, new: str) -> None:
    assert changes(BODY, BODY.replace(old, new)) == ()
    assert changes(BODY.replace(old, new), BODY) == ()


def test_dividing_counts_where_the_machine_stops(changes) -> None:
    assert changes("G61.1\n" + BODY, "G61.1\n" + BODY.replace("G1 Y30", "G1 Y20\nY30")) != ()


def test_a_detour_of_the_same_end_counts(changes) -> None:
    assert changes(BODY, BODY.replace("G1 Y30", "G1 X41 Y20\nX40 Y30")) != ()


@pytest.mark.parametrize(
    ("new", "name"),
    [
        ("G2 X40 Y10 I0 J10", "arc direction"),
        ("G1 X40 Y10", "move"),
        ("G3 X40 Y10 R11", "arc"),
    ],
)
def test_another_way_to_the_same_end(changes, new: str, name: str) -> None:
    found = changes(BODY, BODY.replace("G3 X40 Y10 I0 J10", new))
    assert name in found[0].quantities


def test_tolerance(changes) -> None:
    near = BODY.replace("G1 X30", "G1 X30.02")
    assert changes(BODY, near) != ()
    assert changes(BODY, near, position=Tolerance(0.05)) == ()


def test_lines_are_mapped(steps) -> None:
    new = "(a comment)\n" + HEAD + BODY.replace("G1 Y30", "G1 Y25\nX50\nY30")
    lines = compare_motion(steps(HEAD + BODY), steps(new)).lines
    assert lines["part.nc", 6] == 7 and lines["part.nc", 10] == 13

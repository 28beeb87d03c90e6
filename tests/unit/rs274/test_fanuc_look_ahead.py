"""Fanuc's cutter compensation beyond two moves: change of side, G39, blocks without a move, interference.

The tool has a radius of 3 mm. Expected points are reckoned by hand from the rules of the operator's manuals
(B-63944EN, 6.6): a vector at right angles is op + r n, a corner is where both offset paths meet.
"""

import math

import pytest

ENTRY = ("G90 G00 X0. Y-10.", "G41 D01 G01 Y0. F100.")


@pytest.fixture
def done(program):
    def of(*lines, **options):
        text = "%\nO1\n" + "\n".join(lines) + "\nM30\n%\n"
        return program(text, dialect="fanuc", options=options)

    return of


@pytest.fixture
def ends(done):
    """X Y of every move behind the first rapid."""

    def of(*lines, **options):
        run = done(*lines, **options)
        assert not run.errors, run.errors
        return [end[:2] for end in run.ends][1:]

    return of


def near(*points):
    return [pytest.approx(point, abs=1e-6) for point in points]


def codes(run):
    return [(f.code, f.span.line) for f in run.findings if f.code in ("GS106", "GS107", "GS152", "GS153", "GS156")]


# -- change of side


def test_the_other_side_begins_where_both_paths_cross(ends):
    """Left of +X is y = 3; right of +Y is x = 23: they meet at (23, 3), and behind it x stays 23."""
    assert ends(*ENTRY, "X20.", "G42 Y20.", "G40 X0.")[1:] == near((23, 3), (23, 20), (0, 20))


def test_back_on_the_same_line_the_tool_stays_where_it_is(ends):
    """G41 along +X and G42 along -X are the same side of the part: the vector normal to the next block."""
    assert ends(*ENTRY, "X20.", "G42 X-10.", "G40 Y-20.")[1:] == near((20, 3), (-10, 3), (-10, -20))


def test_straight_on_the_paths_do_not_meet_and_the_move_ends_beside_the_next_one(ends):
    assert ends(*ENTRY, "X20.", "G42 X40.", "G40 Y-20.")[1:] == near((20, -3), (40, -3), (40, -20))


def test_a_crossing_behind_the_beginning_of_the_move_is_none(ends):
    """Turned left by 10 deg the paths cross 2 r / tan(5 deg) = 34 mm before the corner; the move has 20 mm."""
    n = (math.sin(math.radians(10)), -math.cos(math.radians(10)))
    far = (20 + 20 * math.cos(math.radians(10)), 20 * math.sin(math.radians(10)))
    got = ends(*ENTRY, "X20.", f"G42 X{far[0]:.6f} Y{far[1]:.6f}", "G40 Y-20.")
    assert got[1] == pytest.approx((20 + 3 * n[0], 3 * n[1]), abs=1e-5)


def test_from_an_arc_to_the_other_side(ends):
    """Outside about (10, 10) with radius 13; G42 down X = 20 has x = 17, before the arc's end."""
    got = ends(*ENTRY, "Y10.", "G02 X20. Y10. I10. J0.", "G42 G01 Y-20.", "G40 X50.")
    assert got[-3:] == near((17, 10 + math.sqrt(120)), (17, -20), (50, -20))


def test_the_side_does_not_change_right_behind_the_start(done):
    assert codes(done(*ENTRY, "G42 X20.", "G40 Y-20.")) == [("GS153", 5)]


def test_another_offset_needs_g40(done):
    run = done(*ENTRY, "X20.", "G42 D02 Y20.", "G40 X0.")
    assert codes(run) == [("GS153", 6)]
    assert "offset" in run.errors[0].message


def test_a_negative_radius_swaps_the_sides(ends):
    """G10 gives D5 a radius of -3: G42 D5 is G41, and G41 behind it is the other side."""
    got = ends("G10 L12 P5 R-3.", "G90 G00 X0. Y-10.", "G42 D05 G01 Y0. F100.", "X20.", "G41 Y20.", "G40 X0.")
    assert got[:3] == near((0, 3), (23, 3), (23, 20))


def test_the_same_side_once_more_makes_a_right_angle(ends, done):
    """The manual: the vector stands at right angles to the block before, inside and outside alike."""
    lines = (*ENTRY, "X20.", "G41 Y-20.", "X0.", "G40 Y-30.")
    assert ends(*lines)[1:3] == near((20, 3), (23, -23))
    assert codes(done(*lines)) == [("GS156", 6)]


# -- G39


def test_g39_rounds_the_corner_clockwise_on_the_left(done):
    run = done(*ENTRY, "X20.", "G39", "Y-20.", "G40 X0.")
    assert not run.errors
    arc = run.acts("arc")[0]
    assert [end[:2] for end in run.ends][2:] == near((20, 3), (23, 0), (23, -20), (0, -20))
    assert arc["center"][:2] == pytest.approx((20, 0)) and not arc["ccw"]


def test_g39_on_the_right_turns_the_other_way_and_keeps_the_motion(done):
    run = done("G90 G00 X0. Y10.", "G42 D01 G01 Y0. F100.", "X20.", "G39", "Y20.", "G40 X0.")
    assert not run.errors
    assert run.acts("arc")[0]["ccw"]
    assert [end[:2] for end in run.ends][1:] == near((0, -3), (20, -3), (23, 0), (23, 20), (0, 20))


def test_g39_with_a_direction_ends_at_right_angles_to_it(ends):
    """(1, -1): n = (1, 1) / sqrt 2; the next move goes from there to its own end, (23, -20)."""
    part = 3 / math.sqrt(2)
    assert ends(*ENTRY, "X20.", "G39 I1. J-1.", "Y-20.", "G40 X0.")[1:4] == near((20, 3), (20 + part, part), (23, -20))


def test_g39_has_the_line_and_feed_of_its_own_block(done):
    run = done(*ENTRY, "X20.", "G39 F50.", "Y-20. F200.", "G40 X0.")
    arc = run.acts("arc")[0]
    assert (arc["line"], arc["feed"]) == (6, 50)


@pytest.mark.parametrize(
    ("lines", "code", "line"),
    [
        (("G90 G01 X10. F100.", "G39", "Y10."), "GS153", 4),
        ((*ENTRY, "X20.", "G39 X30.", "Y-20."), "GS106", 6),
        ((*ENTRY, "X20.", "G39 I0. J0.", "Y-20."), "GS106", 6),
        ((*ENTRY, "X20.", "G39", "Y20."), "GS152", 7),
    ],
    ids=["off", "moves", "no direction", "inside"],
)
def test_g39_where_it_has_no_sense_is_an_error(done, lines, code, line):
    assert codes(done(*lines, "G40 X-50.")) == [(code, line)]


# -- blocks without a move


def test_one_block_without_a_move_loses_nothing(ends, done):
    lines = (*ENTRY, "X20.", "M08", "Y-20.", "G40 X0.")
    assert ends(*lines)[1] == pytest.approx((23, 3), abs=1e-6)
    assert codes(done(*lines)) == []


def test_two_of_them_lose_the_corner(ends, done):
    """N - 2 = 1: the move ends at (20, 3) and the next one goes from there to (23, -20 - 3)."""
    lines = (*ENTRY, "X20.", "M08", "G04 P200", "Y-20.", "X0.", "G40 Y-30.")
    assert ends(*lines)[1:3] == near((20, 3), (23, -23))
    assert codes(done(*lines)) == [("GS156", 8)]


def test_a_control_that_reads_more_blocks_keeps_it(ends, done):
    lines = (*ENTRY, "X20.", "M08", "G04 P200", "Y-20.", "G40 X0.")
    assert ends(*lines, compensation_blocks="4")[1] == pytest.approx((23, 3), abs=1e-6)
    assert codes(done(*lines, compensation_blocks="4")) == []


def test_two_plunges_behind_the_start_mark_the_part(ends, done):
    """The well-known trap: the start then ends at right angles to itself, (-3, 0), not to the contour."""
    one = ends(*ENTRY, "Z-4.", "X20.", "Y-20.", "G40 X0.")
    two = (*ENTRY, "Z-2.", "Z-4.", "X20.", "Y-20.", "G40 X0.")
    assert one[0] == pytest.approx((0, 3), abs=1e-6)
    assert ends(*two)[0] == pytest.approx((-3, 0), abs=1e-6)
    assert codes(done(*two)) == [("GS156", 7)]


def test_at_the_end_nothing_is_lost(done):
    assert codes(done(*ENTRY, "X20.", "Z5.", "M09", "G04 P100", "G40 X0.")) == []


def test_a_stop_is_not_read_across(ends):
    """M00 is not buffered: the move before it ends at right angles, outside too."""
    assert ends(*ENTRY, "X20.", "M00", "Y-20.", "X0.", "G40 Y-30.")[1:3] == near((20, 3), (23, -23))


# -- interference


def test_a_step_lower_than_the_radius_is_told(done):
    """A groove 4 mm wide between long walls: its ground would run backwards, as is known with the wall behind it."""
    run = done(*ENTRY, "X20.", "Y10.", "X16.", "Y-20.", "G40 X-50.")
    assert codes(run)[0] == ("GS152", 8)


@pytest.mark.parametrize(("blocks", "seen"), [("3", False), ("8", True)])
def test_a_neck_is_seen_as_far_as_the_control_reads(done, blocks, seen):
    """The contour goes up a slot 4 mm wide with a wide ground: each move is long enough by itself."""
    slot = ("X20.", "Y-8.", "X10.", "Y-20.", "X34.", "Y-8.", "X24.", "Y0.", "X60.", "G40 Y30.")
    run = done(*ENTRY, *slot, compensation_blocks=blocks)
    found = codes(run)
    assert bool(found) is seen, found
    if seen:
        assert found == [("GS152", 12)]
        assert run.errors[0].limit == pytest.approx(4.0) and run.errors[0].value == pytest.approx(6.0)


def test_what_the_tool_fits_into_is_not_told(done):
    slot = ("X20.", "Y-8.", "X10.", "Y-20.", "X36.", "Y-8.", "X26.5", "Y0.", "X60.", "G40 Y30.")
    assert codes(done(*ENTRY, *slot, compensation_blocks="8")) == []


def test_round_a_thin_rib_the_tool_goes(done):
    rib = ("Y20.", "X1.", "Y-20.", "G40 X-50.")
    assert codes(done(*ENTRY, *rib, compensation_blocks="8")) == []


def test_g19_is_a_plane_of_compensation(program):
    done = program("O1\nG19 G90 G0 Y0 Z-10.\nG41 D1 G1 Z0. F100\nY20.\nG40 Z20.\nM30\n", dialect="fanuc")
    assert not [f for f in done.errors if f.code == "GS153"]

"""Fanuc's cutter compensation: ends of moves by hand; the tool has a radius of 3 mm."""

import math

import pytest

ENTRY = ("G90 G00 X0. Y-10.", "G41 D01 G01 Y0. F100.")


@pytest.fixture
def ends(program):
    """X Y of every move behind the first rapid."""

    def of(*lines, start="A"):
        text = "%\nO1\n" + "\n".join(lines) + "\nM30\n%\n"
        done = program(text, dialect="fanuc", options={"compensation_start": start})
        assert not done.errors
        return [end[:2] for end in done.ends][1:]

    return of


def near(*points):
    return [pytest.approx(point, abs=1e-6) for point in points]


def test_the_start_of_type_a_ends_at_right_angles_to_the_next_move(ends):
    """Outside: op + r n2 = (0, 3); the corner at (20, 0) is that of a square, (23, 3); the end is op + r n1."""
    got = ends(*ENTRY, "X20.", "Y-20.", "G40 X0.")

    assert got == near((0, 3), (23, 3), (23, -20), (0, -20))


def test_start_and_end_of_type_b_go_round_outside_corners(ends):
    got = ends(*ENTRY, "X20.", "Y-20.", "G40 X0.", start="B")

    assert got == near((-3, 3), (23, 3), (23, -23), (0, -20))


@pytest.mark.parametrize("start", ["A", "B"])
def test_inside_corners_are_the_same_by_both_types(ends, start):
    """To the left the tool turns inside: at right angles to the next move, and at right angles to the last."""
    got = ends(*ENTRY, "X-20.", "Y-20.", "G40 X20.", start=start)

    assert got == near((0, -3), (-17, -3), (-17, -20), (20, -20))


def test_an_acute_outside_corner_extends_both_tangents_by_the_radius(ends):
    length = math.hypot(20, 5)
    dx, dy = -20 / length, -5 / length
    second = (20 - 3 * dy - 3 * dx, 3 * dx - 3 * dy)
    got = ends(*ENTRY, "X20.", "X0. Y-5.", "G40 Y-30.")

    assert got[1:3] == near((23, 3), second)


def test_acute_start_and_end_of_type_b(ends):
    """From +Y into (4, -3)/5: n1 = (-1, 0), n2 = (3, 4)/5; over op + 3 (n1 + d1) and op + 3 (n2 - d2)."""
    got = ends(*ENTRY, "X20. Y-15.", "G40 X0.", start="B")

    assert got[:2] == near((-3, 3), (3 * (0.6 - 0.8), 3 * (0.8 + 0.6)))
    # leaving along -X from (4, -3)/5: n1 = (3, 4)/5, n2 = (0, -1), d2 = (-1, 0)
    assert got[2:] == near((20 + 3 * (0.6 + 0.8), -15 + 3 * (0.8 - 0.6)), (23, -18), (0, -15))


def test_an_obtuse_corner_before_and_behind_an_arc_goes_along_the_tangents(ends):
    """Along +X, then clockwise about (10, 0), which leaves (20, 0) along -Y: outside by 90 deg, over (23, 3)."""
    got = ends(*ENTRY, "X20.", "G02 X10. Y-10. I-10. J0.", "G40 G01 X0.")

    assert got[1:3] == near((23, 3), (23, 0))
    assert got[3] == pytest.approx((10, -13), abs=1e-6)


def test_behind_an_arc_the_corner_begins_with_a_straight_move(ends):
    """A quarter clockwise about (10, 0) ends at (20, 0) along -Y; then -X: outside by 90 deg, over (23, -3)."""
    got = ends(*ENTRY, "X10. Y10.", "G02 X20. Y0. I0. J-10.", "G01 X0.", "G40 Y-30.")

    assert got[-4:] == near((23, 0), (23, -3), (0, -3), (0, -30))


def test_flat_corners_are_corners(ends):
    """LinuxCNC passes over turns below 0.05 rad; here both tangents meet."""
    slope = math.atan2(0.4, 20)
    got = ends(*ENTRY, "X20.", "X40. Y-0.4", "G40 Y-30.")

    assert got[1] == pytest.approx((20 + 3 * math.tan(slope / 2), 3), abs=1e-6)


def test_moves_across_the_plane_go_along_with_the_corner(ends):
    got = ends("G90 G00 X0. Y-10.", "G41 D01 G01 Y0. F100.", "Z-2.", "X20.", "Y-20.", "G40 X40.")

    assert got == near((0, 3), (0, 3), (23, 3), (23, -20), (40, -20))


def test_a_start_may_be_short_but_no_arc(program):
    done = program("O1\nG90 G41 D1 G1 X1. F100.\nY20.\nG40 X-20.\nM30\n", dialect="fanuc")
    assert not done.errors
    done = program("O1\nG90 G41 D1 G2 X10. I5. F100.\nG40 G0 X0.\nM30\n", dialect="fanuc")
    assert [(f.code, f.span.line) for f in done.errors] == [("GS151", 2)]


def test_d_is_modal_and_cannot_change_in_the_compensation(ends, program):
    assert ends("G90 G00 X0. Y-10. D01", "G41 G01 Y0. F100.", "X20.", "G40 Y30.")[0] == near((0, 3))[0]
    done = program("O1\nG41 D1 G1 X10. F100.\nY20. D2\nG40 X-20.\nM30\n", dialect="fanuc")
    assert [(f.code, f.span.line) for f in done.errors] == [("GS153", 3)]

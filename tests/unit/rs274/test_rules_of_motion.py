"""Rules of RS274 that surprise: offsets, tools, compensation, arcs, cycles, feeds, threads."""

import pytest

ENTRY = "T1 M6 F200\nG41 D1 G1 X20 Y0\n"  # the tool is 6 mm across


def test_g92_1_clears_and_g92_2_and_3_suspend_and_resume(program):
    for dialect in ("linuxcnc", "rs274"):
        assert program("G92 X10\nG92.1\nG0 X1\nM2", dialect=dialect).ends == [[1, 0, 0]]
        done = program("G92 X10\nG92.2\nG0 X1\nG92.3\nG0 X1\nM2", dialect=dialect)
        assert done.ends == [[1, 0, 0], [-9, 0, 0]]


def test_g92_applies_in_every_system(program):
    assert program("G10 L2 P2 X100\nG92 X10\nG55\nG0 X0\nM2").ends == [[90, 0, 0]]


def test_g10_l2_sets_also_in_g91_and_p0_is_the_active_system(program):
    assert program("G10 L2 P1 X5\nG91 G10 L2 P1 X7\nG90 G0 X0\nM2").ends == [[7, 0, 0]]
    assert program("G55\nG10 L2 P0 X3\nG0 X0\nM2").ends == [[3, 0, 0]]


@pytest.mark.parametrize("block", ["G53 G2 X5 R9", "G53 X1", "G91 G53 G0 X1"])
def test_g53_is_for_straight_moves_in_g90(program, block):
    assert [f.code for f in program(f"F100\n{block}\nM2").errors][:1] in (["GS109"], ["GS101"])


def test_g53_counts_for_its_block_only(program):
    assert program("G10 L2 P1 X10\nG53 G0 X1\nG0 X1\nM2").ends == [[1, 0, 0], [11, 0, 0]]


def test_g28_without_axis_words_takes_all_home_and_home_is_in_axes(program):
    """Stored with a length offset of 50 in force: the axis stands at 55, so without it home is Z55."""
    done = program("T1 M6\nG43\nG0 X1 Y2 Z5\nG28.1\nG49\nG0 X9 Y9 Z9\nG28\nM2")

    assert done.ends[-1] == [1, 2, 55]


def test_g43_without_h_takes_the_tool_in_the_spindle(program):
    for block in ("G43", "G43 H0"):
        assert program(f"T2 M6\n{block}\nG0 X1\nM2").acts("tool_offset")[0]["offset"][2] == 62.5


def test_g10_l10_and_l11_choose_the_length_by_where_the_point_reads(program):
    """The axis stands at 60: with L10 the point reads 10 under G54 (zero), so 50; L11 counts in the ninth system."""
    text = "T1 M6\nG0 Z60\nG10 L{} P1 Z10\nG43\nG0 X1\nM2"

    assert program(text.format(10)).acts("tool_offset")[0]["offset"][2] == 50
    ninth = "G10 L2 P9 Z20\n" + text.format(11)
    assert program(ninth).acts("tool_offset")[0]["offset"][2] == 30


def test_compensation_begins_at_right_angles_to_the_programmed_direction(program):
    """From (0, -10) to (20, 0): one radius to the left of that direction, (-1, 2)/sqrt 5."""
    done = program("T1 M6 F200\nG0 X0 Y-10\nG41 D1 G1 X20 Y0\nX40 Y10\nG40 X50 Y0\nM2")

    assert done.acts("line")[0]["end"][:2] == pytest.approx([20 - 3 / 5**0.5, 6 / 5**0.5])


def test_an_entry_by_an_arc_ends_radially_beside_its_end(program):
    """To (10, 10) about (0, 10) counterclockwise, left is towards the centre: (7, 10)."""
    done = program("T1 M6 F200\nG41 D1 G3 X10 Y10 I0 J10\nG3 X0 Y20 I-10 J0\nG40 G1 X-20 Y30\nM2")

    assert done.acts("arc")[0]["end"][:2] == pytest.approx([7, 10])


@pytest.mark.parametrize(
    "contour",
    ["X40 Y0\nG3 X40 Y4 I0 J2\n", "X40 Y0\nX40 Y1\nX0 Y1\n"],  # an arc of 2 for a tool of 3; a step of 1
)
def test_what_the_tool_does_not_fit_into_is_refused(program, contour):
    assert "GS152" in [f.code for f in program(ENTRY + contour + "G40 G1 X0 Y30\nM2").errors]


def test_the_move_after_g40_goes_from_the_offset_point_and_is_no_arc(program):
    done = program(ENTRY + "X40\nG40\nG1 X60 Y10\nM2")
    assert [e["end"][:2] for e in done.acts("line")][-2:] == [[40, 3], [60, 10]]

    assert [f.code for f in program(ENTRY + "X40\nG40\nG2 X60 Y0 I10\nM2").errors] == ["GS151"]


def test_moves_along_the_normal_pass_through_compensation(program):
    assert [e["end"][:3] for e in program(ENTRY + "X40\nZ-5\nX60\nG40 Y30\nM2").acts("line")][:4] == [
        [20, 3, 0],
        [40, 3, 0],
        [40, 3, -5],
        [60, 3, -5],
    ]


@pytest.mark.parametrize(
    "block", ["G18", "G55", "G92 X0", "M6", "G81 X1 Z-1 R1", "G38.2 X9", "G28", "G53 G0 X1", "G43"]
)
def test_what_is_refused_in_compensation(program, block):
    errors = program(ENTRY + f"X40\n{block}\nG40 X60 Y20\nM2").errors

    assert errors and errors[0].code in ("GS150", "GS153") and errors[0].span.line == 4


def test_d0_leaves_the_path_as_it_is_and_g41_takes_the_tool_in_the_spindle(program):
    assert [e["end"][:2] for e in program("F9\nG41 D0 G1 X20\nX40\nG40 X50\nM2").acts("line")] == [
        [20, 0],
        [40, 0],
        [50, 0],
    ]
    assert program("T1 M6 F9\nG41 G1 X20\nX40\nG40 X50\nM2").acts("line")[0]["end"][:2] == [20, 3]
    assert program("F9\nG41.1 D8 G1 X20\nX40\nG40 X50\nM2").acts("line")[0]["end"][:2] == [20, 4]


def test_compensation_works_in_g17_and_g18_only(program):
    assert [f.code for f in program("G19 F9\nG41.1 D8 G1 Y20\nM2").errors][:1] == ["GS153"]


def test_centres_are_incremental_unless_g90_1(program):
    assert program("F9\nG91 G3 X10 I5\nM2").acts("arc")[0]["center"] == [5, 0, 0]
    assert program("F9\nG0 X2\nG3 X10 I4\nM2").acts("arc")[0]["center"] == [6, 0, 0]
    assert program("F9\nG90.1\nG0 X2\nG3 X10 I6 J0\nM2").acts("arc")[0]["center"] == [6, 0, 0]


def test_an_arc_by_radius_needs_another_end(program):
    assert [f.code for f in program("F9\nG2 R5\nM2").errors] == ["GS110"]


def test_the_centre_of_an_arc_stays_as_programmed(program):
    assert program("F9\nG2 X10.02 I5\nM2").acts("arc")[0]["center"] == [5, 0, 0]


def test_words_of_a_cycle_stay_while_it_goes_on_and_another_one_needs_its_own(program):
    done = program("F9\nG81 X1 Z-2 R1\nX2\nM2")
    assert [end for end in done.ends if end[2] == -2] == [[1, 0, -2], [2, 0, -2]]

    assert [(f.code, f.span.line) for f in program("F9\nG81 X1 Z-2 R1\nG82 X2 P1\nM2").errors] == [("GS140", 3)]


def test_in_g91_r_counts_from_the_start_and_z_from_r(program):
    done = program("F9\nG0 Z10\nG91 G99 G81 X1 Z-5 R-8 L2\nM2")

    assert [end for end in done.ends if end[2] == -3] == [[1, 0, -3], [2, 0, -3]]
    assert done.ends[-1] == [2, 0, 2]


def test_g99_counts_at_the_start(program):
    assert program("F9\nG0 Z10\nG81 X1 Z-1 R2\nM2").ends[-1] == [1, 0, 2]


def test_a_hole_left_at_r_is_left_slanting_up_under_g98(program):
    done = program("F9\nG0 Z10\nG99 G81 X1 Z-1 R2\nG98 X5\nM2")

    at = done.ends.index([5, 0, 10])
    assert done.ends[at - 1] == [1, 0, 2]


def test_the_peck_stops_a_hundredth_of_an_inch_short_in_inch_too(program):
    done = program("G20 F9\nG0 Z1\nG99 G83 X0 Z-1 R0 Q.6\nM2")

    assert pytest.approx(25.4 * (-0.6 + 0.01)) in [end[2] for end in done.ends]


def test_tapping_feeds_both_ways_and_reverses_the_spindle(program):
    done = program("F9 S100 M3\nG0 Z5\nG98 G84 X1 Z-3 R1\nM2")

    kinds = [
        e["kind"] if e["kind"] != "spindle" else e["dir"]
        for e in done.events
        if e["kind"] in ("line", "spindle", "override")
    ]
    assert kinds[kinds.index("cw") :] == ["cw", "override", "line", "ccw", "line", "override", "cw", "off"]
    assert [line["end"][2] for line in done.acts("line")] == [-3, 5]  # with G98 all the way up
    first = done.acts("override")[0]
    assert (first["feed"], first["speed"]) == (False, False)


def test_boring_cycles_stop_orient_and_wait(program):
    stops = program("F9 S100 M3\nG0 Z5\nG99 G86 X1 Z-3 R1 P1\nM2")
    assert [s["dir"] for s in stops.acts("spindle")][-4:] == ["cw", "off", "cw", "off"]
    assert [k["kind"] for k in stops.events if k["kind"] in ("dwell", "line")] == ["line", "dwell"]

    waits = program("F9 S100 M3\nG0 Z5\nG99 G88 X1 Z-3 R1 P1\nM2")
    assert len(waits.acts("stop")) == 1 and waits.ends[-1] == [1, 0, -3]

    back = program("F9 S100 M3\nG0 Z5\nG99 G87 X1 Z-3 R1 I.5 J0 K-2\nM2")
    assert len(back.acts("orient")) == 2
    assert [end for end in back.ends if end[0] == 1.5] and [line["end"][2] for line in back.acts("line")] == [-2, -3]


def test_inside_a_cycle_the_path_is_exact(program):
    done = program("F9\nG64 P.1\nG81 X1 Z-1 R1\nG0 X5\nM2")

    assert [mode["mode"] for mode in done.acts("path_mode")][-2:] == ["exact_path", "blend"]


def test_what_lies_between_holes_does_not_end_the_cycle_but_motion_does(program):
    done = program("F9\nG99 G81 X1 Z-2 R1\nF5\nM8\nG4 P1\nX2\nG0 X3\nX4\nM2")

    assert [end[0] for end in done.ends if end[2] == -2] == [1, 2]


def test_inverse_time_needs_f_in_every_feed_block(program):
    assert [(f.code, f.span.line) for f in program("G93\nG1 X1 F2\nG1 X2\nM2").errors] == [("GS107", 3)]


def test_the_physical_feed_survives_a_change_of_unit(program):
    assert [line["feed"] for line in program("F100\nG1 X1\nG20\nG1 X2\nM2").acts("line")] == [100, 100]


def test_a_move_of_linear_and_rotary_axes_counts_the_linear_ones_alone(program):
    line = program("G93\nG1 X30 Y40 A90 F2\nM2").acts("line")[0]

    assert (line["feed"], line["feed_unit"]) == (100, "mm/min")


def test_feed_per_revolution_needs_a_speed(program):
    assert [f.code for f in program("G95 F.1\nG1 X1\nM2").errors] == ["GS108"]
    line = program("G95 F.1 S100 M3\nG1 X1\nM2").acts("line")[0]
    assert (line["feed"], line["feed_unit"]) == (0.1, "mm/rev")


def test_surface_speed_is_metres_or_feet_per_minute_with_a_cap(program):
    metric = next(e for e in program("G96 S100 D2000 M3\nM2").acts("spindle") if e["dir"] == "cw")
    assert (metric["speed"], metric["unit"], metric["max_rpm"]) == (100, "m/min", 2000)

    inch = next(e for e in program("G20\nG96 S100 M3\nM2").acts("spindle") if e["dir"] == "cw")
    assert inch["speed"] == pytest.approx(30.48)


def test_a_thread_is_one_move_and_nothing_moves_back(program):
    done = program("S100 M3\nG33 Z-5 K1.5\nM2")

    assert done.ends == [[0, 0, -5]] and done.acts("line")[0]["pitch"] == 1.5


def test_a_rigid_tap_is_one_act_that_ends_where_it_began(program):
    done = program("S100 M3\nG33.1 Z-5 K1.5\nG0 X1\nM2")

    assert (done.acts("tap")[0]["end"][2], done.acts("tap")[0]["pitch"]) == (-5, 1.5)
    assert done.ends[-1] == [1, 0, 0]


def test_g76_cuts_in_many_lines_of_the_same_pitch(program):
    done = program("S100 M3\nG0 X10 Z5\nG76 P1.5 Z-20 I-1 J.2 K1 R1.5 H1\nM2")

    cuts = [line for line in done.acts("line") if "pitch" in line]
    assert len(cuts) >= 5 and {line["pitch"] for line in cuts} == {1.5}


def test_g5_2_collects_weighted_points_until_g5_3(program):
    done = program("F9\nG5.2 P1 L3\nX2 Y4 P1\nX4 Y0 P1\nG5.3\nM2")

    (curve,) = done.acts("spline")
    assert (curve["control_points"], curve["end"][:2]) == (3, [4, 0])
    assert max(point[1] for point in curve["points"]) == pytest.approx(2, abs=1e-3)  # half the control point's height


@pytest.mark.parametrize("block", ["G5 X4 Y0 I1 J1 P-1 Q1", "G5.1 X4 Y0 I1 J1", "G5.2 X1 Y1 P1"])
def test_splines_lie_in_the_xy_plane(program, block):
    assert [f.code for f in program(f"F9 G18\n{block}\nM2").errors] == ["GS170"]

"""The rules of RS274 that surprise, one test each, with values worked out by hand."""

import pytest


def test_f_in_the_block_of_a_unit_change_is_in_the_old_unit(program):
    done = program("G21 F100\nG1 X10\nG20 F10\nG1 X1\nM2")

    assert [line["feed"] for line in done.acts("line")] == [100, 10]


def test_a_setting_takes_effect_after_its_block(program):
    done = program("#1=5\n#1=10 #2=#1 G0 X#1\nG0 X#1 Y#2\nM2")

    assert done.ends == [[5, 0, 0], [10, 5, 0]]


def test_power_is_left_associative_and_a_sign_belongs_to_its_number(program):
    assert program("G0 X[2**3**2] Y[-2**2] Z[-7 MOD -3]\nM2").ends == [[64, 4, 2]]


def test_rounding_functions(program):
    assert program("G0 X[ROUND[-2.5]] Y[FIX[-2.8]] Z[FUP[2.2]]\nM2").ends == [[-3, -3, 3]]


def test_nothing_moves_when_an_offset_changes(program):
    done = program("G0 X1 Y1\nG10 L2 P2 X100\nG55\nG0 Y5\nM2")

    assert done.ends == [[1, 1, 0], [1, 5, 0]]


def test_g92_lies_inside_the_rotation(program):
    done = program("G10 L2 P1 X10 Y10 R90\nG92 X0 Y0\nG0 X5 Y0\nM2")

    assert done.ends == [[pytest.approx(0, abs=1e-9), 5, 0]]


def test_machine_coordinates_count_the_tool_offset(program):
    assert program("T1 M6\nG43\nG53 G0 X5 Z0\nM2").ends == [[5, 0, -50]]


def test_a_full_circle_needs_no_end_words(program):
    arc = program("F100\nG0 X10\nG3 I-10\nM2").acts("arc")[0]

    assert arc["sweep"] == 360
    assert arc["end"][:3] == [10, 0, 0]


def test_turns_add_full_circles(program):
    arc = program("F100\nG2 X10 Y0 I5 P3\nM2").acts("arc")[0]

    assert arc["sweep"] == -900
    assert arc["turns"] == 3


def test_negative_radius_is_the_long_way(program):
    arc = program("F100\nG2 X0 Y10 R-10\nM2").acts("arc")[0]

    assert abs(arc["sweep"]) == pytest.approx(300)


def test_in_g18_the_first_axis_is_z(program):
    arc = program("F100 G18\nG2 X10 Z0 I5 K0\nM2").acts("arc")[0]

    assert arc["normal"] == [0, 1, 0]
    assert arc["ccw"] is False


@pytest.mark.parametrize(
    ("radius", "miss", "fits"), [(5, 0.028, True), (5, 0.029, False), (500, 0.5, True), (500, 0.51, False)]
)
def test_the_two_radii_of_an_arc_may_differ_a_little(program, radius, miss, fits):
    """0.028 mm always, a thousandth of the radius beyond."""
    done = program(f"F100\nG2 X{2 * radius + miss:.4f} I{radius}\nM2")

    assert (not done.errors) is fits


def test_inverse_time_is_resolved_with_the_length_of_the_move(program):
    lines = program("G93\nG1 X30 Y40 F2\nM2").acts("line")

    assert lines[0]["feed"] == 100


def test_rotary_moves_take_the_feed_as_degrees_also_in_inch(program):
    line = program("G20 F10\nG1 A90\nM2").acts("line")[0]

    assert (line["feed"], line["feed_unit"]) == (10, "deg/min")


def test_changing_the_feed_mode_discards_f(program):
    assert program("G94 F100\nG93 G1 X1 F1\nG94\nG1 X3\nM2").errors[0].code == "GS107"


def test_t_only_selects_and_m6_keeps_the_length_offset(program):
    done = program("T1 M6\nG43\nT2\nG0 Z0\nM6\nG0 Z1\nM2")

    assert [e["tool"] for e in done.acts("tool_change")] == [1, 2]
    assert len(done.acts("tool_offset")) == 1


def test_m6_stops_the_spindle_and_keeps_s(program):
    states = program("S1000 M3\nG0 X1\nT1 M6\nM3\nG0 X2\nM2").acts("spindle")

    assert [s["dir"] for s in states][-3:] == ["off", "cw", "off"]
    assert states[-2]["speed"] == 1000


def test_first_hole_from_below_rises_straight(program):
    assert program("F100\nG99 G81 X5 Z-5 R3\nM2").ends == [[0, 0, 3], [5, 0, 3], [5, 0, -5], [5, 0, 3]]


def test_g98_returns_to_where_the_chain_began(program):
    done = program("F100\nG0 Z10\nG99 G81 X1 Z-1 R2\nG98 X2\nM2")

    assert done.ends[-4:] == [[2, 0, 10], [2, 0, 2], [2, 0, -1], [2, 0, 10]]


def test_peck_drilling_stops_short_of_the_last_depth(program):
    done = program("F100\nG0 Z10\nG99 G83 X0 Z-6 R2 Q4\nM2")

    assert [end[2] for end in done.ends] == [10, 10, 2, -2, 2, -1.746, -6, 2]


def test_compensation_rounds_an_outside_corner_and_trims_an_inside_one(program):
    done = program("T1 M6 F200\nG41 D1 G1 X20 Y0\nX40\nY20\nX60\nG40 Y40\nM2")

    assert [e["end"][:2] for e in done.acts("line", "arc")] == [
        [20, 3],
        [37, 3],
        [37, 20],
        [40, 23],
        [60, 23],
        [60, 40],
    ]


def test_compensation_entry_must_be_longer_than_the_radius(program):
    assert program("T2 M6 F200\nG41 D2 G1 X3\nX40\nG40\nM2").errors[0].code == "GS151"


def test_subroutine_arguments_are_restored(program):
    done = program("#1=7\no100 sub\nG0 X#1\no100 endsub [#1*2]\no100 call [2]\nG0 X#1 Y#<_value>\nM2")

    assert done.ends == [[2, 0, 0], [7, 4, 0]]


def test_a_branch_not_taken_is_not_read(program):
    assert program("o1 if [0]\ngarbage !!\no1 endif\nG0 X1\nM2").findings == []


def test_what_follows_the_end_is_not_read(program):
    assert program("G0 X1\nM30\nanything !!").findings == []


def test_polar_coordinates_keep_what_is_not_named(program):
    done = program("G0 @10 ^0\n^90\n@5\nM2")

    assert done.ends == [[10, 0, 0], [pytest.approx(0, abs=1e-9), 10, 0], [pytest.approx(0, abs=1e-9), 5, 0]]


def test_spline_polyline_stays_on_the_parabola(program):
    """G5.1 from (-2, 4) to (2, 4) with control point (0, -4) is y = x**2."""
    spline = program("F100\nG0 X-2 Y4\nG5.1 X2 Y4 I2 J-8\nM2").acts("spline")[0]

    assert spline["end"][:2] == [2, 4]
    assert max(abs(y - x * x) for x, y, _ in spline["points"]) < 1e-6


def test_stops_come_after_the_motion(program):
    kinds = [e["kind"] for e in program("M0 G0 X1\nM2").events if e["kind"] in ("rapid", "stop")]

    assert kinds == ["rapid", "stop"]


def test_blanks_mean_nothing_also_inside_numbers_and_names(program):
    assert program("#<w i d t h> = 4\ng 0 x 1 . 2 5 Y#<WIDTH>\nM2").ends == [[1.25, 4, 0]]


def test_a_word_that_no_code_uses_is_an_error(program):
    assert [(f.code, f.span.line) for f in program("G0 X1\nG0 X2 H3\nM2").errors] == [("GS104", 2)]


def test_debug_formats_what_follows(program):
    done = program("#1=2.5\n(DEBUG, a #1 %d b #1 %.2f c #1)\nM2")

    assert [event["text"].split() for event in done.acts("message")] == [["a", "2.500000", "b", "2", "c", "2.50"]]


def test_an_index_near_a_whole_number_is_that_number(program):
    assert program("#[2.00005]=7\nG0 X#2\nM2").ends == [[7, 0, 0]]


def test_eq_has_a_tolerance_and_lt_has_none(program):
    assert program("G0 X[1 EQ 1.00005] Y[1 LT 1.00005] Z[1 EQ 1.001]\nM2").ends == [[1, 1, 0]]


def test_an_unset_number_is_zero_and_an_unset_name_an_error(program):
    assert program("G0 X[#77+1] Y[EXISTS[#<no>]]\nM2").ends == [[1, 0, 0]]
    assert [f.code for f in program("G0 X#<no>\nM2").errors] == ["GS120"]


def test_global_names_are_seen_everywhere_and_local_ones_in_their_call(program):
    done = program("o1 sub\nG0 X#<_g> Y[EXISTS[#<l>]]\no1 endsub\n#<_g>=3\n#<l>=5\no1 call\nM2")

    assert done.ends == [[3, 0, 0]]


def test_g52_and_g92_share_one_store(program):
    assert program("G92 X10\nG52 X1\nG0 X5\nM2").ends == [[6, 0, 0]]


def test_g10_l20_makes_the_point_read_as_given_and_refuses_r(program):
    assert program("G0 X10\nG10 L20 P1 X4\nG0 X5\nM2").ends == [[10, 0, 0], [11, 0, 0]]
    assert program("G10 L20 P1 X4 R10\nM2").errors


def test_g28_takes_only_the_named_axes_home(program):
    assert program("G0 X1 Y2 Z3\nG28 Z5\nM2").ends == [[1, 2, 3], [1, 2, 5], [1, 2, 0]]


def test_g43_1_keeps_the_axes_it_does_not_name_and_g43_2_adds(program):
    done = program("G43.1 X1 Z5\nG43.1 Z7\nG0 X0\nG43.2 H1\nG0 X1\nM2")

    offsets = [event["offset"][:3] for event in done.acts("tool_offset")]
    assert offsets == [[1, 0, 5], [1, 0, 7], [1, 0, 57]]


def test_g10_l1_is_seen_by_the_next_g43_only(program):
    done = program("T1 M6\nG43\nG0 X1\nG10 L1 P1 Z9\nG0 X2\nG43\nG0 X3\nM2")

    assert [event["offset"][2] for event in done.acts("tool_offset")] == [50, 9]


def test_repeats_of_a_cycle_in_g90_stay_at_the_same_place(program):
    lowest = [end for end in program("F100\nG0 Z5\nG81 X3 Y4 Z-1 R2 L2\nM2").ends if end[2] == -1]

    assert lowest == [[3, 4, -1], [3, 4, -1]]


def test_a_chain_of_g5_goes_on_in_its_direction(program):
    first, second = program("F100\nG5 X4 Y0 I1 J1 P-1 Q1\nG5 X8 Y0 P-1 Q1\nM2").acts("spline")

    assert first["end"][:2] == [4, 0] and second["end"][:2] == [8, 0]
    assert second["control_points"] == 4


def test_break_in_a_repeat_is_refused(program):
    assert [f.code for f in program("o1 repeat [3]\no1 break\no1 endrepeat\nM2").errors] == ["GS130"]


def test_m98_shares_numbers_with_its_caller(program):
    assert program("#1=4\nM98 P7\nG0 X#1\nM2\nO7\n#1=9\nM99").ends == [[9, 0, 0]]


def test_waiting_for_an_input_makes_no_event(program):
    done = program("G0 X1\nM66 P0 L0\nG0 X2\nM2")

    assert done.ends == [[1, 0, 0], [2, 0, 0]] and not done.acts("output")

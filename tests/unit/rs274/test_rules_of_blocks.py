"""Rules of RS274 that surprise: how lines are read, in which order they act, parameters, expressions, flow."""

import pytest


def test_numbers_may_begin_or_end_with_a_point_and_have_no_exponent(program):
    assert program("G0 X.5 Y5. Z+1\nM2").ends == [[0.5, 5, 1]]
    assert [f.code for f in program("G0 X1e3\nM2").errors] == ["GS104"]


def test_a_line_has_252_characters_at_most(program):
    fits = "G0 X1 (" + "c" * 244 + ")"
    assert len(fits) == 252 and program(fits + "\nM2").ends == [[1, 0, 0]]
    assert [(f.code, f.span.line) for f in program(fits + " \nM2").errors] == [("GS002", 1)]


def test_a_semicolon_comments_the_rest_and_comments_do_not_nest(program):
    assert program("G0 X1 ; Y2 (MSG, no)\nM2").ends == [[1, 0, 0]]
    assert not program("G0 X1 ; (MSG, no)\nM2").acts("message")
    assert [f.code for f in program("G0 X1 (a (b))\nM2").errors] == ["GS003"]


def test_n_comes_first_and_is_never_checked_for_order(program):
    assert program("N20 G0 X1\n/N10 G0 X2\nN20 G0 X3\nM2").ends == [[1, 0, 0], [2, 0, 0], [3, 0, 0]]
    assert [f.code for f in program("G0 N10 X1\nM2").errors] == ["GS001"]


@pytest.mark.parametrize("block", ["G0 X1 X2", "G0 G1 X1", "M3 M4"])
def test_a_word_stands_once_and_so_does_a_modal_group(program, block):
    assert [f.code for f in program(f"F100\n{block}\nM2").errors] in (["GS009"], ["GS011"])


def test_a_message_is_printed_in_place_as_it_stands(program):
    done = program("#1=7\nG0 X1\n(MSG, is #1)\nG0 X2\nM2")

    shown = [event["kind"] for event in done.events if event["kind"] in ("rapid", "message")]
    assert shown == ["rapid", "message", "rapid"]
    assert done.acts("message")[0]["text"] == "is #1"


def test_print_puts_values_in_with_six_decimals(program):
    assert program("#1=2.5\n(PRINT,a #1 #<_x> %.1f #1)\nM2").acts("print")[0]["text"].split() == [
        "a",
        "2.500000",
        "0.000000",
        "2.5",
    ]


def test_a_leading_percent_ends_at_the_second_one(program):
    assert not program("%\nG0 X1\n%\nanything !!").errors
    assert [f.code for f in program("G0 X1\n").errors] == ["GS010"]
    assert [f.code for f in program("%\nG0 X1\n").errors] == ["GS010"]


def test_the_order_within_a_block_is_not_that_of_writing(program):
    """Message, feed and speed, tool, spindle, coolant, dwell, motion, stop; the F of a G95 counts per revolution."""
    done = program("M0 G4 P2 M8 M3 T1 M6 S500 (MSG, first)\nM1 G1 X9 M9 M5 F.2 G95\nM2")

    seen = [
        event["kind"]
        for event in done.events
        if event["kind"] not in ("path_mode", "work_system") and event.get("dir") != "off"
    ]
    assert seen == [
        *("message", "tool_select", "tool_change", "spindle", "coolant", "dwell", "stop"),
        *("coolant", "line", "optional_stop", "end"),
    ]
    assert (done.acts("line")[0]["feed"], done.acts("line")[0]["feed_unit"]) == (0.2, "mm/rev")


def test_a_later_setting_of_the_block_wins(program):
    assert program("#1=1 #1=2\nG0 X#1\nM2").ends == [[2, 0, 0]]


def test_stored_offsets_are_in_machine_units(program):
    """G54 at 25.4 mm is 1 inch; #5221 says 25.4 also under G20."""
    assert program("G20 G10 L2 P1 X1\nG0 X#5221\nM2").ends == [[pytest.approx(26.4 * 25.4), 0, 0]]


def test_the_position_is_asked_for_in_program_units_and_the_active_frame(program):
    done = program("G0 X25.4\nG92 X50.8\nG20\nG0 Y#5420 Z#<_x>\nM2")

    assert done.ends[-1] == [25.4, 50.8, 50.8]


@pytest.mark.parametrize("setting", ["#5420=1", "#5400=1", "#<_x>=1", "#<_metric>=0"])
def test_positions_and_predefined_names_are_read_only(program, setting):
    assert [f.code for f in program(setting + "\nM2").errors] == ["GS122"]


def test_operators_bind_in_five_steps(program):
    """1 + 2*3**2 = 19; comparisons before AND; AND and OR from left to right: (1 OR 1) AND 0 = 0."""
    assert program("G0 X[1+2*3**2] Y[1+1 GT 1 AND 3 LT 2*2] Z[1 OR 1 AND 0]\nM2").ends == [[19, 1, 0]]


def test_angles_are_in_degrees(program):
    assert program("G0 X[SIN[30]] Y[ATAN[1]/[-1]] Z[ACOS[0]]\nM2").ends == [pytest.approx([0.5, 135, 90])]


def test_parentheses_never_group(program):
    assert program("G0 X[2 * [1 + 2]]\nM2").ends == [[6, 0, 0]]
    assert [f.code for f in program("G0 X[2*(1+2)]\nM2").errors] == ["GS006"]


def test_a_call_gives_thirty_arguments_of_which_missing_ones_are_zero(program):
    many = " ".join(f"[{n}]" for n in range(1, 31))
    text = "o1 sub\nG0 X#1 Y#2 Z#30\no1 endsub\n#2=9 #30=8\no1 call [5]\no1 call {}\nG0 X#1 Y#2 Z#30\nM2"

    assert program(text.format(many)).ends == [[5, 0, 0], [1, 2, 30], [0, 9, 8]]


def test_whether_a_value_was_returned_can_be_asked(program):
    text = (
        "o1 sub\no1 endsub [7]\no2 sub\no2 endsub\no1 call\nG0 X#<_value> Y#<_value_returned>\n"
        "o2 call\nG0 X#<_value> Y#<_value_returned>\nM2"
    )

    assert program(text).ends == [[7, 1, 0], [0, 0, 0]]


def test_labels_are_local_to_a_subroutine_and_may_be_computed(program):
    text = "o5 sub\no1 if [1]\nG0 X1\no1 endif\no5 endsub\no1 if [1]\n#5=5\no[#5] call\no1 endif\nM2"

    done = program(text)
    assert done.ends == [[1, 0, 0]] and not done.errors


def test_a_subroutine_may_be_defined_past_the_end(program):
    assert program("o7 call [3]\nM2\no7 sub\nG0 X#1\no7 endsub\n").ends == [[3, 0, 0]]


def test_break_leaves_a_while_and_continue_goes_on(program):
    text = (
        "#1=0\no1 while [#1 LT 9]\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 endif\no3 if [#1 EQ 4]\no1 break\n"
        "o3 endif\nG0 X#1\no1 endwhile\nM2"
    )

    assert program(text).ends == [[1, 0, 0], [3, 0, 0]]


def test_m98_repeats_and_the_two_styles_cannot_call_each_other(program):
    assert program("G91\nM98 P100 L3\nM2\nO100\nG0 X1\nM99").ends == [[1, 0, 0], [2, 0, 0], [3, 0, 0]]
    assert [f.code for f in program("o100 call\nM2\nO100\nG0 X1\nM99").errors] == ["GS131"]
    assert [f.code for f in program("M98 P100\nM2\no100 sub\nG0 X1\no100 endsub").errors] == ["GS131"]


def test_m70_saves_modes_with_feed_and_speed_and_m72_restores_them(program):
    done = program("G21 G90 F100 S500 M3\nM70\nG20 G91 F5 S90\nM72\nG1 X10\nM2")

    (line,) = done.acts("line")
    assert (line["end"][0], line["feed"]) == (10, 100)
    assert done.acts("spindle")[-2]["speed"] == 500


def test_m71_throws_the_save_away_and_m73_restores_at_the_end_of_the_subroutine(program):
    assert program("M70\nM71\nM72\nM2").errors
    assert program("o1 sub\nM73\nG91\nG0 X1\no1 endsub\nG0 X5\no1 call\nG0 X2\nM2").ends == [
        [5, 0, 0],
        [6, 0, 0],
        [2, 0, 0],
    ]


def test_polar_words_count_about_the_programs_origin_in_g17_only(program):
    """Radius 10 at 90 degrees about G54's zero; in G91 both are added: 15 at 180."""
    done = program("G10 L2 P1 X100\nG0 @10 ^90\nG91 G0 @5 ^90\nM2")

    assert done.ends == [pytest.approx([100, 10, 0]), pytest.approx([85, 0, 0])]
    assert [f.code for f in program("G18\nG0 @10 ^90\nM2").errors] == ["GS185"]


def test_the_end_of_a_program_stops_what_turns_and_flows_and_keeps_offsets(program):
    done = program("G10 L2 P2 X5\nG55 G91 S100 M3 M8\nG0 X1\nM30")

    assert [event["kind"] for event in done.events if event["kind"] in ("spindle", "coolant", "end")][-3:] == [
        *("spindle", "coolant", "end"),
    ]
    assert done.acts("spindle")[-1]["dir"] == "off" and done.acts("coolant")[-1]["flood"] is False
    assert done.run.parameters[5241] == 5 and done.run.parameters[5220] == 1


def test_g4_and_an_arc_would_both_take_p(program):
    """LinuxCNC 2.9 refuses it (interp_check.cc), also where P counts the turns of the arc."""
    for arc in ("G2", "G3"):
        done = program(f"G4 P1 {arc} X10 I5 F100\nM2")
        assert [(f.code, f.span.line, f.span.column) for f in done.errors] == [("GS011", 1, 7)]
    assert not program("G2 X10 I5 F100\nG4 P1\nM2").errors

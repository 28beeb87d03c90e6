"""What the Fanuc corpus leaves out; ends of moves were worked out by hand from the rules named in each test."""

import pytest


@pytest.fixture
def fanuc(program):
    def done(text, **settings):
        return program(text, dialect="fanuc", **settings)

    return done


def body(*lines):
    return "%\nO0001\n" + "\n".join(lines) + "\n%\n"


def test_argument_list_two_counts_i_j_k_in_triples(fanuc):
    """I2. J3. K4. are #4 #5 #6, the next I #7; K after I #9; a J after that K opens the third triple: #11."""
    done = fanuc(
        body(
            "G65 P9000 A1. I2. J3. K4. I5. K6. J7.",
            "M30",
            "O9000",
            "G00 X[#1+#4*10.] Y[#5+#6*10.] Z[#7+#9*10.+#11*100.]",
            "M99",
        )
    )

    assert done.ends == [[21, 43, 765]]
    assert not done.findings


def test_list_two_gives_33_variables_at_most(fanuc):
    done = fanuc(body("G65 P9000 " + "I1." * 11, "M30", "O9000", "M99"))

    assert [(f.code, f.span.line) for f in done.errors] == [("GS133", 3)]


def test_g66_1_calls_in_every_block_with_the_block_as_arguments(fanuc):
    """Nothing of the block itself is executed; its last G is #10."""
    done = fanuc(
        body("G66.1 P9000", "G01 X3. F50.", "Y4.", "G67", "G00 X0.", "M30", "O9000", "G00 X#24 Y#25 Z#10", "M99")
    )

    assert done.ends == [[3, 0, 1], [3, 4, 1], [0, 4, 1]]
    assert not done.acts("line")


def test_modal_calls_nest_the_inner_ones_moves_call_the_outer(fanuc):
    """The move calls O2; the move in O2 calls O1, whose own moves call nothing."""
    done = fanuc(
        body("G66 P1000", "G66 P2000", "G00 X1.", "G67", "G67", "X5.", "M30")[:-2]
        + "O1000\nG91 Z1.\nG90\nM99\nO2000\nG00 Y7.\nM99\n%\n"
    )

    assert done.ends == [[1, 0, 0], [1, 7, 0], [1, 7, 1], [5, 7, 1]]


def test_skip_function_stores_where_it_ended(fanuc):
    done = fanuc(body("G90 G31 X20. F50.", "G00 Y#5061", "M30"))

    assert done.acts("probe")[0]["end"][:3] == [20, 0, 0]
    assert done.acts("probe")[0]["feed"] == 50
    assert done.ends[-1] == [20, 20, 0]


@pytest.mark.parametrize(
    ("over", "read"),
    [
        (["G43 H1", "G31 Z-7. F50.", "#100=#5063"], 43.0),  # with the length of the tool, 50 mm, as #5043 has it
        (["G92 X10.", "G31 X25. F50.", "#100=#5061"], 25.0),
        (["G52 X5.", "G31 X25. F50.", "#100=#5061"], 25.0),
        (["G31 X25.4 F50.", "G20", "#100=#5061"], 1.0),
        (["G16", "G31 X10. Y90. F50.", "#100=#5062"], 10.0),
    ],
    ids=["length", "G92", "G52", "inches", "polar"],
)
def test_the_skip_position_is_that_of_the_axes_in_the_work_system(fanuc, over, read):
    """B-63944EN, 16.2: #5061 and on are in the work system, with tool compensation, in the unit of the program."""
    done = fanuc(body("G90 G21", *over, "M30"))

    assert done.run.parameters[100] == pytest.approx(read)


def test_second_reference_point_by_way_of_a_point(fanuc):
    done = fanuc(
        body("G90 G00 X10. Y10. Z5.", "G91 G30 P2 X0. Z5.", "M30"), parameters={5181: 100.0, 5182: 50.0, 5183: 20.0}
    )

    assert done.ends == [[10, 10, 5], [10, 10, 10], [100, 10, 20]]


def test_mirror_image_turns_arcs_round(fanuc):
    """About X0 the clockwise half circle 5 → 15 becomes a counterclockwise one −5 → −15."""
    done = fanuc(body("G51.1 X0.", "G90 G00 X5. Y0.", "G02 X15. I5. F100.", "G50.1 X0.", "G00 X5.", "M30"))

    arc = done.acts("arc")[0]
    assert done.ends == [[-5, 0, 0], [-15, 0, 0], [5, 0, 0]]
    assert (arc["center"], arc["ccw"], arc["sweep"]) == ([-10, 0, 0], True, 180)


def test_mirror_in_both_axes_keeps_the_sense(fanuc):
    done = fanuc(body("G51.1 X1. Y2.", "G90 G00 X5. Y0.", "G02 X15. I5. F100.", "M30"))

    assert done.ends == [[-3, 4, 0], [-13, 4, 0]]
    assert done.acts("arc")[0]["ccw"] is False


def test_mirror_of_incremental_moves_changes_the_sign_only(fanuc):
    done = fanuc(body("G51.1 X100.", "G91 G00 X5. Y1.", "M30"))

    assert done.ends == [[-5, 1, 0]]


def test_scaling_about_a_point(fanuc):
    """P2000 is twice the size: (5, 5) about (1, 0) goes to (9, 10); I grows too."""
    done = fanuc(body("G51 X1. Y0. Z0. P2000", "G90 G00 X5. Y5.", "G02 X10. I2.5 F100.", "G50", "G00 X0. Y0.", "M30"))

    assert done.ends == [[9, 10, 0], [19, 10, 0], [0, 0, 0]]
    assert done.acts("arc")[0]["center"] == [14, 10, 0]


def test_scaling_by_axis_and_with_points(fanuc):
    done = fanuc(body("G51 X0. Y0. Z0. I2. J0.5 K1.", "G90 G01 X3. Y4. Z-1. F100.", "G02 X5. R1.", "M30"))

    assert done.ends[0] == [6, 2, -1]
    assert [(f.code, f.span.line) for f in done.errors] == [("GS110", 5)]


def test_scaling_leaves_the_depth_of_holes_alone(fanuc):
    done = fanuc(body("G51 X0. Y0. Z0. P3.", "G90 G00 X1. Y0. Z0.", "G99 G81 X2. Z-3. R0. F100.", "M30"))

    assert done.ends == [[3, 0, 0], [6, 0, 0], [6, 0, 0], [6, 0, -3], [6, 0, 0]]


def test_turn_applies_after_mirror(fanuc):
    """(5, 0) mirrored about X0 is (−5, 0), turned by 90 degrees (0, −5)."""
    done = fanuc(body("G68 X0. Y0. R90.", "G51.1 X0.", "G90 G00 X5. Y0.", "M30"))

    assert done.ends[0] == pytest.approx([0, -5, 0])


def test_cutter_compensation_inside_a_corner(fanuc):
    """D1 is 6 mm across. Entering left of +Y ends at X-3; the left turn into −X is an inside corner: (−3, 17)."""
    done = fanuc(body("G90 G00 X0. Y-10.", "G41 D01 G01 Y0. F100.", "Y20.", "X-20.", "G40 G00 X-30. Y30.", "M30"))

    assert done.ends == [[0, -10, 0], [-3, 0, 0], [-3, 17, 0], [-20, 17, 0], [-30, 30, 0]]


def test_d_takes_radius_and_wear_from_g10(fanuc):
    """L12 sets the radius 4, L13 the wear −0.5."""
    done = fanuc(body("G90 G10 L12 P5 R4.", "G10 L13 P5 R-.5", "G42 D05 G01 Y10. F100.", "Y20.", "G40 X20.", "M30"))

    assert done.ends[:2] == [[3.5, 10, 0], [3.5, 20, 0]]


def test_mirror_swaps_the_side_of_compensation(fanuc):
    done = fanuc(body("G51.1 X0.", "G41 D01 G01 Y10. F100.", "Y20.", "G40 X20.", "M30"))

    assert done.ends[:2] == [[3, 10, 0], [3, 20, 0]]


@pytest.mark.parametrize("name", ["O2000", "O2000.nc", "o2000.ngc", "2000.ngc"])
def test_subprograms_in_a_folder(fanuc, tmp_path, name):
    (tmp_path / name).write_text("%\nO2000(SUB)\nG00 X1.\nM99\n%\n")
    done = fanuc(body("M98 P2000", "G00 Y2.", "M30"), subroutines=(tmp_path,))

    assert done.ends == [[1, 0, 0], [1, 2, 0]]
    assert done.events[-1]["kind"] == "end"


def test_numbers_without_a_point_in_increments(fanuc):
    """IS-B: 0.001 mm, 0.0001 inch; feeds in mm/min as written; dwell X in milliseconds."""
    text = body("G90 G00 X1000 Y1.", "G01 Z-500 F100", "G02 X2000 I500", "G04 X1500", "G20 G00 X10000", "M30")

    done = fanuc(text, options={"decimal_point": "increments"})

    assert done.ends == [[1, 1, 0], [1, 1, -0.5], [2, 1, -0.5], [25.4, 1, -0.5]]
    assert done.acts("line")[0]["feed"] == 100
    assert done.acts("dwell")[0]["seconds"] == 1.5
    assert fanuc(text.replace("X1000", "X5")).ends[0] == [5, 1, 0]


def test_corners_and_polar_angles_in_increments(fanuc):
    """,R2000 is 2 mm; under G16 Y90000 is 90 degrees."""
    done = fanuc(
        body("G90 G01 X20. F100 ,R2000", "Y10.", "G16 X20. Y90000", "M30"), options={"decimal_point": "increments"}
    )

    assert done.ends == [[18, 0, 0], [20, 2, 0], [20, 10, 0], [pytest.approx(0, abs=1e-9), 20, 0]]


def test_locals_of_a_macro_are_its_own_and_m98_shares_them(fanuc):
    done = fanuc(
        body("#1=5.", "G65 P9000 A1.", "M98 P8000", "G00 Z#1", "M30", "O9000", "#1=9.", "M99", "O8000", "#1=#1+1.")[:-2]
        + "M99\n%\n"
    )

    assert done.ends == [[0, 0, 6]]


def test_words_that_nothing_uses_are_a_warning(fanuc):
    done = fanuc(body("G00 X1. Q5.", "M30"))

    assert done.ends == [[1, 0, 0]]
    assert [f.code for f in done.findings] == ["GS104"]
    assert not done.errors


def test_of_two_codes_of_a_group_the_last_counts(fanuc):
    done = fanuc(body("G90 G91 G00 X1.", "X1.", "M30"))

    assert done.ends == [[1, 0, 0], [2, 0, 0]]
    assert not done.errors


def test_motion_code_beside_g28_sets_the_mode_only(fanuc):
    done = fanuc(body("G90 G01 Z-5. F100.", "G00 G91 G28 Z0.", "G90 X5.", "M30"))

    assert done.ends == [[0, 0, -5], [0, 0, -5], [0, 0, 0], [5, 0, 0]]


def test_g28_without_axes_takes_all_home_as_on_a_haas(fanuc):
    done = fanuc(body("G90 G00 X4. Y3. Z-5.", "G28", "M30"))

    assert done.ends == [[4, 3, -5], [0, 0, 0]]
    assert [(f.code, f.span.line, f.level.word) for f in done.findings] == [("GS103", 4, "warning")]


def test_fine_boring_lifts_the_edge(fanuc):
    done = fanuc(body("S100 M03", "G90 G00 Z10.", "G98 G76 X5. Z-3. R1. Q.5 F50.", "M30"))

    assert done.ends[1:] == [[5, 0, 10], [5, 0, 1], [5, 0, -3], [5.5, 0, -3], [5.5, 0, 10], [5, 0, 10]]


def test_a_program_that_runs_into_the_next_one_has_no_end(fanuc):
    done = fanuc("%\nO1\nG00 X1.\nO2\nG00 X2.\nM30\n%\n")

    assert [f.code for f in done.errors] == ["GS010"]


def test_endless_recursion_is_a_finding(fanuc):
    done = fanuc(body("M98 P1", "M30"))

    assert [f.code for f in done.errors] == ["GS132"]


@pytest.mark.parametrize("line", ["E/ND1", "WHILE[#1 LT 3]D/O1"])
def test_a_word_of_a_loop_that_a_slash_divides_is_a_finding(fanuc, line):
    """It ended in a KeyError."""
    done = fanuc(body("#1=0", line, "G0 X1.", "M30"))

    assert [(f.code, f.span.line) for f in done.errors] == [("GS130", 4)]
    assert "`/`" in done.errors[0].message


def test_a_goto_may_not_enter_a_loop(fanuc):
    done = fanuc(body("GOTO 5", "WHILE[#1 LT 3]DO1", "N5 G0 X1.", "END1", "M30"))

    assert [(f.code, f.span.line) for f in done.errors] == [("GS130", 3)]  # the guilty line
    assert done.run.failed_line == 6  # where the control notices


def test_a_loop_whose_head_cannot_be_read_is_gone_through_once(fanuc):
    done = fanuc(body("WHILE[#1 LT 3 DO1", "G0 X", "END1", "G0 Y", "M30"))

    assert [(f.code, f.span.line, f.count) for f in done.errors] == [("GS006", 3, 1), ("GS004", 4, 1), ("GS004", 6, 1)]


def test_statement_beside_words_is_refused(fanuc):
    done = fanuc(body("#1=2. G00 X1.", "M30"))

    assert [(f.code, f.span.line) for f in done.errors] == [("GS008", 3)]


def test_atan_of_two_covers_the_circle(fanuc):
    done = fanuc(body("G00 X[ATAN[-1.]/[-1.]] Y[POW[2.,3.]] Z[7 AND 12]", "M30"))

    assert done.ends == [[225, 8, 4]]


def test_m_codes_of_machine_builders_are_no_error(program) -> None:
    """Nobody but the builder knows what M88 does: it is told, not refused."""
    done = program("O0001\nG21 G90\nM88\nM10\nM30", dialect="fanuc")

    assert not done.errors
    assert [f.message for f in done.findings if f.code == "GS907"] == [
        "M88 is read, but not simulated",
        "M10 is read, but not simulated",
    ]


def test_g9_stops_exactly_in_one_block(program) -> None:
    done = program("O0001\nG21 G90 G64\nG9 G1 X10. F100.\nX20.\nM30", dialect="fanuc")

    kinds = [event.get("mode") or event["kind"] for event in done.events if "end" in event or "mode" in event][-4:]
    assert kinds == ["exact_stop", "line", "blend", "line"]


def test_g27_and_g29_move(program) -> None:
    """Out over the point that G28 went through, and a check of the reference point that is a rapid."""
    done = program("O0001\nG21 G90\nG28 X10. Y20. Z0.\nG29 X1. Y2. Z0.\nG27 X5. Y6.\nM30", dialect="fanuc")

    assert done.ends == [[10, 20, 0], [0, 0, 0], [10, 20, 0], [1, 2, 0], [5, 6, 0]]
    assert [(f.code, f.span.column) for f in done.findings] == [("GS913", 1)]


def test_g29_needs_a_g28(program) -> None:
    (error,) = program("O0001\nG29 X1.\nM30", dialect="fanuc").errors

    assert (error.code, error.span.line, error.span.column) == ("GS105", 2, 1)


@pytest.mark.parametrize(
    ("block", "found"),
    [
        ("G1 X5. P2 M8", [("GS104", 8), ("GS901", 11)]),
        ("G1 X5. M88 P2", [("GS907", 8)]),
        ("G1 X5. U2.", [("GS908", 8)]),
        ("G4 U2.", []),
        ("G31 X5.", [("GS913", 1)]),
        ("G1 G0 X5.", [("GS104", 1)]),
    ],
)
def test_no_word_is_dropped_silently(program, block: str, found: list[tuple[str, int]]) -> None:
    done = program(f"O0001\nG21 G90 F100.\n{block}\nM30", dialect="fanuc")

    assert not done.errors
    assert [(f.code, f.span.column) for f in done.findings] == found


def test_lines_left_out_are_counted(program) -> None:
    done = program("O0001\n/G0 X1.\nG0 X2.\n/2 G0 X3.\nM30", dialect="fanuc", block_delete=True)

    assert [(f.code, f.span.line, f.count) for f in done.findings] == [("GS914", 2, 2)]
    assert done.run.not_simulated["/"][0] == 2


def test_a_turn_in_g18_goes_from_z_to_x(fanuc):
    """By 90 degrees about X1 Z0: 2 along Z from there becomes 2 along X, and 2 along X becomes -2 along Z."""
    done = fanuc(body("G90 G18", "G68 X1. Z0. R90.", "G00 X1. Y4. Z2.", "X3. Z0.", "G69", "X0. Z0.", "M30"))

    want = [[3, 4, 0], [1, 4, -2], [0, 4, 0]]
    assert done.ends == [pytest.approx(end, abs=1e-9) for end in want]


def test_a_turn_in_g19_and_its_arcs(fanuc):
    """In YZ by 90 degrees: Y5 becomes Z5; the arc about Y0 keeps its sense, one in another plane is refused."""
    done = fanuc(body("G90 G19 G68 Y0. Z0. R90.", "G00 Y5. Z0.", "G03 Y-5. J-5. F100.", "M30"))

    arc = done.acts("arc")[0]
    assert done.ends == [pytest.approx(end, abs=1e-9) for end in ([0, 0, 5], [0, 0, -5])]
    assert arc["center"] == pytest.approx([0, 0, 0], abs=1e-9)
    assert (arc["normal"], arc["ccw"], arc["sweep"]) == ([1, 0, 0], True, 180)
    errors = fanuc(body("G90 G19 G68 Y0. Z0. R90.", "G17 G03 X5. R5. F100.", "M30")).errors
    assert [(f.code, f.span.line) for f in errors] == [("GS106", 4)]


def test_turn_keeps_the_axis_across_the_plane(fanuc):
    done = fanuc(body("G17 G90 G68 X1. Y0. R90.", "G00 X3. Y0. Z4.", "G69", "M30"))

    assert done.ends == [[pytest.approx(x, abs=1e-9) for x in (1, 2, 4)]]


def test_tool_centre_point_control_takes_the_length(fanuc):
    done = fanuc(body("T1 M06", "G43.4 H1", "G00 X1.", "G49", "M30"))

    assert [event["offset"][2] for event in done.acts("tool_offset")][:1] == [50]


@pytest.mark.parametrize("line", ["G01 X5. A10. F100.", "G01 X5. C-90. F100."])
def test_tool_centre_point_control_with_an_axis_turned_is_refused_where_no_axis_has_a_place(fanuc, line):
    done = fanuc(body("T1 M06", "G43.4 H1", "G01 X1. A0. F100.", line, "G01 X6.", "M30"), has_cell=True)

    assert [(f.code, f.span.line) for f in done.errors] == [("GS915", 6)] and [end[0] for end in done.ends] == [1]


def test_an_axis_that_stands_turned_counts(fanuc):
    done = fanuc(body("T1 M06", "G00 B30.", "G43.4 H1", "G01 X1. F100.", "M30"), has_cell=True)

    assert [(f.code, f.span.line) for f in done.errors] == [("GS915", 6)]


def test_codes_of_haas(fanuc):
    done = fanuc(
        body("G10 L20 P7 X10. Y20.", "G187 P3 E0.05", "G103 P1", "G154 P7", "G00 X1. Y1.", "G54", "G00 X1.", "M30")
    )

    assert done.ends == [[11, 21, 0], [1, 21, 0]] and not done.errors
    assert {f.code for f in done.findings} == {"GS913"}


def test_m99_p_of_a_subprogram_goes_on_at_that_block_of_the_caller(fanuc):
    done = fanuc(body("M98 P2", "G00 X1.", "N50 G00 Y2.", "M30")[:-2] + "O0002\nG00 Z3.\nM99 P50\n%\n")

    assert done.ends == [[0, 0, 3], [0, 2, 3]]


def test_more_work_systems(fanuc):
    done = fanuc(body("G10 L20 P7 X10. Y20.", "G54.1 P7", "G00 X1. Y1.", "G54", "G00 X1.", "M30"))

    assert done.ends == [[11, 21, 0], [1, 21, 0]]


def test_a_rounding_goes_tangentially_from_move_to_move(fanuc):
    """R2 in a right angle to the left: from (18, 0) about (18, 2) to (20, 2), with the feed of its own block."""
    done = fanuc(body("G90 G94 G00 X0. Y0.", "G01 X20. F100. ,R2.", "M08 Y20. F50.", "M30"))

    arc = done.acts("arc")[0]
    assert done.ends[1:] == [[18, 0, 0], [20, 2, 0], [20, 20, 0]]
    assert (arc["center"], arc["ccw"], arc["sweep"], arc["feed"], arc["line"]) == ([18, 2, 0], True, 90, 100, 4)
    kinds = [event["kind"] for event in done.events]
    assert kinds.index("coolant") > kinds.index("arc")  # M08 belongs to the block behind
    assert [line["feed"] for line in done.acts("line")] == [100, 50]


def test_chamfers_follow_each_other_also_in_incremental_mode(fanuc):
    done = fanuc(body("G91 G01 X20. F100. ,C3.", "Y10. ,C2.", "X-20.", "M30"))

    assert done.ends == [[17, 0, 0], [20, 3, 0], [20, 8, 0], [18, 10, 0], [0, 10, 0]]


def test_a_rounding_between_a_line_and_an_arc(fanuc):
    """Up along x = 0 into the clockwise half circle of radius 10 about (0, 20), which begins at right angles: the
    rounding R1 is 1 from the line, on the right, and outside 11 from the centre: at (1, 20 - sqrt(120)) … but the
    corner is where the circle begins, (0, 10), so the arc goes left or right of it."""
    done = fanuc(body("G90 G00 X0. Y0.", "G01 Y10. F100. ,R1.", "G03 Y30. R10.", "M30"))

    rounding, arc = done.acts("arc")
    y = 20 - 120**0.5
    assert rounding["center"] == pytest.approx([1, y, 0])
    assert done.ends[1] == pytest.approx([0, y, 0])
    assert done.ends[2] == pytest.approx([10 / 11, 20 - 10 / 11 * 120**0.5, 0])
    assert rounding["ccw"] is False and arc["ccw"] is True and arc["center"] == [0, 20, 0]
    assert arc["end"][:3] == [0, 30, 0]


def test_cutter_compensation_follows_the_corner_with_its_rounding(fanuc):
    """D1 is 6 mm across; left of the contour a right turn is outside: the rounding R5 becomes one of R8."""
    done = fanuc(body("G90 G00 X-20. Y-20.", "G41 D01 G01 X0. Y-10. F100.", "Y20. ,R5.", "X20.", "G40 G00 X40.", "M30"))

    assert [line["end"][:2] for line in done.acts("line")][1:] == [[-3, 15], [20, 23]]
    arc = done.acts("arc")[0]
    assert (arc["center"], arc["end"][:2], arc["sweep"]) == ([5, 15, 0], [5, 23], -90)
    order = [event["kind"] for event in done.events if event["kind"] in ("line", "arc")]
    assert order == ["line", "line", "arc", "line"]


def test_a_mirror_image_has_its_corners_too(fanuc):
    done = fanuc(body("G51 X0. Y0. Z0. P2.", "G51.1 X0.", "G90 G01 X10. F100. ,R1.", "Y10.", "M30"))

    assert done.ends == [[-18, 0, 0], [-20, 2, 0], [-20, 20, 0]]
    assert done.acts("arc")[0]["ccw"] is False


@pytest.mark.parametrize(
    ("blocks", "line"),
    [
        (("G01 X20. ,R15.", "Y10."), 5),  # needs 15 mm of 10
        (("G01 X20. ,C2.", "M08", "Y10."), 5),
        (("G01 X20. ,C2.", "G00 Y10."), 5),
        (("G01 X20. ,C2.", "Y10. Z5."), 5),
        (("G01 X20. ,C2. ,R2.", "Y10."), 4),
        (("G01 X20. ,C2. M00", "Y10."), 4),
        (("G00 X20. ,C2.", "G01 Y10."), 4),
        (("G01 X20. ,C2.",), 5),
    ],
)
def test_corners_that_cannot_be_made(fanuc, blocks, line):
    done = fanuc(body("G90 G94 F100.", *blocks, "M30"))

    assert [(f.code, f.span.line) for f in done.errors] == [("GS142", line)]


def test_polar_coordinates(fanuc):
    """Radius and angle about the program's zero; each stays until another is written; G15 ends it."""
    done = fanuc(body("G90 G17 G16", "G00 X10. Y90.", "Y180.", "X5.", "G15 X1. Y2.", "M30"))

    want = [[0, 10, 0], [-10, 0, 0], [-5, 0, 0], [1, 2, 0]]
    assert done.ends == [pytest.approx(end, abs=1e-9) for end in want]


def test_polar_holes_with_an_angle_added(fanuc):
    done = fanuc(
        body("G90 G00 Z5.", "G16 G99 G81 X10. Y0. Z-1. R1. F100.", "G91 Y90. K2", "G90 G15 G80 X0.", "M30"),
    )

    bottoms = [end[:2] for end in done.ends if end[2] == -1]
    assert bottoms == [pytest.approx(place, abs=1e-9) for place in ([10, 0], [0, 10], [-10, 0])]


def test_an_incremental_radius_counts_from_where_the_tool_stands(fanuc):
    done = fanuc(body("G90 G00 X10. Y10.", "G16", "G91 X5. G90 Y0.", "M30"))

    assert not done.errors
    done = fanuc(body("G90 G00 X10. Y10.", "G16 G91 X5. Y-45.", "M30"))
    assert done.ends[-1] == pytest.approx([15, 10, 0])


def test_an_arc_in_polar_coordinates_is_given_by_its_radius(fanuc):
    done = fanuc(body("G90 G16 G00 X10. Y0.", "G03 X10. Y90. R10. F100.", "M30"))

    assert done.acts("arc")[0]["center"] == pytest.approx([0, 0, 0], abs=1e-9)
    (error,) = fanuc(body("G90 G16 G00 X10. Y0.", "G03 Y90. I-10. F100.", "M30")).errors
    assert (error.code, error.span.line) == ("GS110", 4)


@pytest.mark.parametrize("level", ["L50", "L52", "L3"])
def test_blocks_that_write_data_of_the_control_are_passed_over(fanuc, level):
    done = fanuc(body(f"G10 {level}", "N5130 R100", "P1 L10", "T9 H1 D1", "G11", "G00 X1.", "M30"))

    assert done.ends == [[1, 0, 0]]
    assert [(f.code, f.span.line) for f in done.findings] == [("GS913", 3)]
    assert not done.acts("tool_select")


def test_old_tool_data(fanuc):
    """L1 of older controls is the wear: 50 mm of the table and 0.5."""
    done = fanuc(body("G10 L1 P1 R.5", "G43 H1 G00 Z60.", "M30"))

    assert done.acts("tool_offset")[0]["offset"][2] == 50.5


@pytest.mark.parametrize("which", [3, 4])
def test_further_reference_points_are_the_machines_home_and_told(fanuc, which):
    done = fanuc(body("G90 G00 X10. Z-5.", f"G91 G30 P{which} Z0.", "M30"), parameters={5183: 20.0})

    assert done.ends == [[10, 0, -5], [10, 0, -5], [10, 0, 0]]
    assert [f.code for f in done.findings] == ["GS913"]
    assert fanuc(body("G91 G30 P5 Z0.", "M30")).errors


def test_g60_goes_there_at_rapid(fanuc):
    done = fanuc(body("G90 G01 X1. F100.", "G60 X5.", "X6.", "M30"))

    assert [event["kind"] for event in done.acts("line", "rapid")] == ["line", "rapid", "line"]
    assert [f.code for f in done.findings] == ["GS913"]


def test_g92_1_takes_presets_back(fanuc):
    done = fanuc(body("G90 G00 X10. Y10.", "G92 X0. Y0.", "G52 X3.", "G92.1 X0.", "G00 X1. Y1.", "M30"))

    assert done.ends[-1] == [1, 11, 0]


@pytest.mark.parametrize("code", ["G68.3 X0 Y0 Z0 R0", "G12.1", "G07.1 C20.", "G107 C20."])
def test_codes_that_would_change_the_moves_are_not_left_out(fanuc, code):
    (error,) = fanuc(body(code, "G00 X1.", "M30")).errors

    assert (error.code, error.span.line, error.span.column) == ("GS915", 3, 1)


def test_dprnt_prints_numbers_in_its_form(fanuc):
    """[53] is five digits before the point and three behind; a vacant variable prints nothing."""
    lines = ("#1=128.47398", "#2=-91.2", "#3=123.456", "POPEN", "N5 DPRNT[X#1[53]*Y#2[53]*T#3[20]V#9[11]]", "PCLOS")
    done = fanuc(body(*lines, "M30"))

    assert [event["text"] for event in done.acts("print")] == ["X128.474 Y-91.200 T23V"]
    assert [f.code for f in done.findings] == ["GS912", "GS912"]


def test_programs_may_have_names(fanuc, tmp_path):
    """`O<NAME>` or `<NAME>` opens one, M98 and G65 call it by that; letters ignore case, also in a folder."""
    (tmp_path / "FAR.nc").write_text("%\n<FAR>\nG00 Z#1\nM99\n%\n")
    text = (
        "%\nO<PART-1> (x)\nG21 G90 G00 X1.\nM98 <sub-2> L2\nG65 <MAC> A3.\nG65 <FAR> A7.\nM30\n"
        "<SUB-2>\nG91 G00 Y1.\nG90\nM99\nO<MAC>\nG00 Z#1\nM99\n%\n"
    )
    done = fanuc(text, subroutines=(tmp_path,))
    assert done.ends == [[1, 0, 0], [1, 1, 0], [1, 2, 0], [1, 2, 3], [1, 2, 7]]
    assert not done.findings

    (error,) = fanuc("%\n<A>\nM98 <B>\nM30\n%\n").errors
    assert (error.code, error.span.line, error.message) == ("GS131", 3, "there is no program <B>")


def test_a_program_behind_the_percent_sign_is_pointed_at(program) -> None:
    done = program("%\nO1\nM98 P10\nM30\n%\n(more)\nO10\nM99\n", dialect="fanuc")

    assert [(f.code, f.span.line) for f in done.errors] == [("GS131", 3)] and "line 7" in done.errors[0].hint


def test_modal_variables_tell_what_is_in_force(fanuc):
    """Groups 4, 11, 12, 13, 15, 22; the last M, N and O; the P of the additional system."""
    asks = "#{0}=#{1}"
    lines = ["N7 M8", "G61 G54.1 P3", "G51.1 X0.", "G23"]
    lines += [asks.format(100 + at, n) for at, n in enumerate((4113, 4114, 4115, 4015, 4130, 4022, 4004, 4011))]
    lines += [asks.format(110 + at, n) for at, n in enumerate((4012, 4013))]
    done = fanuc(body(*lines, "M30"))

    assert not done.errors
    assert [done.run.parameters.get(100 + at) for at in range(8)] == [8, 7, 1, 61, 3, 51.1, 23, 50]
    assert [done.run.parameters.get(110 + at) for at in range(2)] == [67, 97]


def test_the_number_of_the_block_before_is_that_of_the_last_n(fanuc):
    assert fanuc(body("N5 G0 X1.", "N6 #100=#4114", "M30")).run.parameters[100] == 5


def test_modal_information_that_is_not_simulated_is_refused(fanuc):
    assert [(f.code, f.span.line) for f in fanuc(body("#1=#4108", "M30")).errors] == [("GS121", 3)]


def test_the_present_position_has_the_length_of_the_tool_and_the_end_of_the_block_has_not(fanuc):
    done = fanuc(body("G54 G43 H1", "G0 Z10.", "#100=#5003", "#101=#5043", "#102=#5023", "M30"))

    assert [done.run.parameters[n] for n in (100, 101, 102)] == [10, 60, 60]


def test_g92_takes_back_the_g52_of_the_axes_it_names(fanuc):
    """G52 X10 Y20, then X reads 0 by G92 at machine 15: X1 is 16, whatever G52; Y keeps its shift."""
    done = fanuc(body("G52 X10. Y20.", "G0 X5. Y5.", "G92 X0.", "G0 X1. Y1.", "G52 X0. Y0.", "G0 X1. Y1.", "M30"))

    assert done.ends == [[15, 25, 0], [16, 21, 0], [16, 1, 0]]


def test_values_are_whole_increments(fanuc):
    """IS-B: 0.001 mm, 0.0001 in, 0.001 deg, halves away from zero; factors, feeds and arguments are not rounded."""
    done = fanuc(body("#1=12.3456", "G0 X#1 Y-1.0005 Z.12344 A1.23456", "G20 G0 X1.00005", "M30"))

    assert done.raw[2].end[:3] == pytest.approx((0.012346, -0.001001, 0.000123))
    assert done.events[2]["end"][3] == pytest.approx(1.235)
    assert done.ends[1][0] == pytest.approx(1.0001 * 25.4)
    macro = fanuc(body("G65 P2 A1.23456", "M30", "O2", "#100=#1", "M99"))
    assert macro.run.parameters[100] == 1.23456


def test_a_slash_inside_a_block_ends_it_where_the_switch_is_on(fanuc):
    text = body("G0 X1. /2 Y5.", "G0 X[4./2.] (a / b)", "#1=4./2.", "M30")

    assert fanuc(text, block_delete=True).ends == [[1, 0, 0], [2, 0, 0]]
    done = fanuc(text)
    assert done.ends == [[1, 5, 0], [2, 5, 0]]
    assert [(f.code, f.span.line, f.span.column) for f in done.findings] == [("GS194", 3, 8)]


def test_a_block_may_have_several_slashes(fanuc):
    """The first of them that is switched on ends the block; all switches are one here."""
    text = body("/2 G0 X1. /2 Y2.", "/1/3 N10 Z1.", "G0 X2. /2 Y5. / Z[6./2.]/3 (a / b)", "M30")

    assert fanuc(text, block_delete=True).ends == [[2, 0, 0]]
    done = fanuc(text)
    assert done.ends == [[1, 2, 0], [1, 2, 1], [2, 5, 3]]
    assert [(f.code, f.span.line, f.span.column, f.count) for f in done.findings] == [("GS194", 3, 11, 2)]


def test_a_goto_without_a_target_names_the_program_it_looks_in(fanuc):
    done = fanuc(body("N1 IF[1EQ1]GOTO 9", "M30"))
    assert [(f.code, f.span.line, f.message) for f in done.errors] == [("GS130", 3, "there is no block N9 in O0001")]


def test_all_systems_are_variables_twice(fanuc):
    """#7001 of G54.1 P1 is #14001, too."""
    done = fanuc(body("#14001=5.", "G54.1 P1", "G0 X1.", "#100=#7001", "M30"))

    assert done.ends == [[6, 0, 0]]
    assert done.run.parameters[100] == 5


def test_a_turret_turns_while_the_spindle_goes_on(program):
    """On a lathe the spindle carries the work: T0202 does not stop it, M6 of a mill does."""
    lathe = program(
        body("T0101", "G97 S1000 M3", "G0 X20. Z2.", "G1 Z-5. F0.2", "G0 X40.", "T0202", "G0 X18.", "G1 Z-4.", "M30"),
        dialect="fanuc_lathe",
    )
    mill = program(
        body(
            "T1 M6",
            "G43 H1 Z50. S1000 M3",
            "G1 Z-5. F100.",
            "X9.",
            "G0 Z50.",
            "T2 M6",
            "G43 H2 Z5.",
            "G1 Z-4.",
            "X0.",
            "M30",
        ),
        dialect="fanuc",
    )

    assert {event["line"] for event in lathe.acts("spindle")} == {4, 11}
    assert {event["line"] for event in mill.acts("spindle")} == {4, 8}
    assert [f.code for f in lathe.findings] == []
    assert "GS176" in [f.code for f in mill.findings]


@pytest.mark.parametrize(("word", "unit"), [("", "mm/rev"), ("G99", "mm/rev"), ("G98", "mm/min")])
def test_a_lathe_that_is_switched_on_feeds_for_each_turn(program, word, unit):
    """FPM (3402.4) is 0: F0.3 of a program without G98 and G99 is no crawl of 0.3 mm/min."""
    done = program(
        body("T0101", "G97 S1000 M3", f"{word} G0 X20. Z2.".strip(), "G1 Z-5. F0.2", "G0 X40.", "M30"),
        dialect="fanuc_lathe",
    )

    assert [event["feed_unit"] for event in done.acts("line")] == [unit]
    assert not done.errors


def test_words_before_the_first_program_number_begin_its_program(program):
    done = program("%\nG20 (INCH)\nO0012\nG90 G0 X1.\nM98 P5\nM30\nO0005\nG0 X2.\nM99\n%\n", dialect="fanuc")
    assert not done.errors and [end[0] for end in done.ends] == [25.4, 50.8]

    own = program("G21 G0 X1.\nM30\nO0012\nG0 X2.\nM30\n", dialect="fanuc")
    assert not own.errors and [end[0] for end in own.ends] == [1]


def test_engraving_of_text_is_told_as_such(program):
    (fault,) = program("O1\nG21 G47 P0 X2. Y2. J5. R1. Z-.2 F300. E200. (TEXT)\nM30\n", dialect="fanuc").errors
    assert fault.code == "GS915" and "engraving of a text (Haas)" in fault.message

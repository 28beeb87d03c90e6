"""Programs of printers: E, retraction, limits, comments, macros; two ways to read them."""

import json
from pathlib import Path

import pytest

from gcodesim import canon
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.rs274 import Settings, ToolEntry, ToolTable, interpret

DATA = Path(__file__).parents[2] / "data" / "printing"


@pytest.fixture
def printed(program):
    """The run of a printer's program."""

    def run(text, dialect="marlin", **settings):
        return program(text, dialect=dialect, **{"tool_table": ToolTable(), **settings})

    return run


def filament(done):
    """What E asks for in each move and each step of filament alone [mm]."""
    return [e.get("extrude", e.get("length", 0)) for e in done.acts("line", "arc", "extrude")]


def test_e_counts_from_its_position_or_from_each_step(printed):
    absolute = printed("M82\nG1 X10 E1 F600\nG1 X20 E3\nG92 E0\nG1 X30 E1\nG1 X40\n")
    relative = printed("M83\nG1 X10 E1 F600\nG1 X20 E2\nG92 E0\nG1 X30 E1\nG1 X40\n")

    assert filament(absolute) == [1, 2, 1, 0]
    assert filament(relative) == [1, 2, 1, 0]


@pytest.mark.parametrize(("dialect", "steps"), [("marlin", [2, 2]), ("klipper", [2, 0]), ("reprapfirmware", [2, 0])])
def test_g91_makes_e_relative_in_marlin_only(printed, dialect, steps):
    assert filament(printed("G91\nG1 X10 E2 F600\nG1 X10 E2\n", dialect)) == steps


def test_g90_and_m83_in_either_order(printed):
    assert filament(printed("G90\nM83\nG1 X10 E2 F600\nG1 X20 E2\n")) == [2, 2]
    assert filament(printed("M83\nG90\nG1 X10 E2 F600\nG1 X20 E2\n")) == [2, 0]


def test_filament_alone_is_no_move(printed):
    done = printed("M83\nG1 X10 E1 F600\nG1 E-0.8 F2100\nG1 X20 F6000\nG1 E0.8 F2100\nG1 F900\n")

    assert [e["kind"] for e in done.events if e["kind"] in ("line", "extrude")] == [
        "line",
        "extrude",
        "line",
        "extrude",
    ]
    assert done.acts("extrude")[0] == {"kind": "extrude", "length": -0.8, "feed": 2100, "by_firmware": False, "line": 3}


def test_firmware_retraction_and_its_lift(printed):
    done = printed("M207 S2 F1200 Z0.4\nM208 S0.1 F600\nG1 X1 Z1 F600\nG10\nG10\nG1 X5\nG11\nG1 X6\n")

    assert [(e["length"], e["feed"]) for e in done.acts("extrude")] == [(-2, 1200), (2.1, 600)]
    assert [end[2] for end in done.ends] == [1, 1.4, 1.4, 1, 1]


def test_g10_with_a_temperature_is_no_retraction(printed):
    done = printed("G10 P0 S210\nG1 X1 F600\n", "reprapfirmware")

    assert done.acts("extrude") == []
    assert [f.code for f in done.findings if f.span.line == 1] == ["GS921"]


def test_volumes_inches_flow_and_pace(printed):
    assert filament(printed("M200 D2\nM83\nG1 X10 E3.14159265 F600\n")) == [pytest.approx(1.0)]
    assert filament(printed("M221 S50\nM83\nG1 X10 E3 F600\n")) == [1.5]
    assert filament(printed("G20\nM83\nG1 X10 E1 F600\n")) == [25.4]
    assert printed("M220 S200\nG1 X10 F600\n").acts("line")[0]["feed"] == 1200


def test_arcs_by_centre_and_radius_with_filament(printed):
    done = printed("M83\nG1 X0 Y0 F600\nG2 X10 Y0 I5 J0 E1\nG3 X0 Y0 R5 E1\nG2 X0 Y0 I5 J0 P1\n")
    arcs = done.acts("arc")

    assert [round(a["sweep"]) for a in arcs] == [-180, 180, -720]
    assert [a.get("extrude") for a in arcs] == [1, 1, None]
    assert not done.errors


def test_homing_goes_sideways_first_and_forgets_shifts(printed):
    done = printed("G1 X10 Y10 Z10 F600\nG92 X0\nG28\nG1 X5\nG28 Z\n")

    assert done.ends == [[10, 10, 10], [0, 0, 10], [0, 0, 0], [5, 0, 0]]


def test_g92_names_the_place_anew(printed):
    assert printed("G1 X10 Y5 F600\nG92 X0 Y0\nG1 X1 Y1\n").ends == [[10, 5, 0], [11, 6, 0]]


def test_limits_in_the_units_of_each_firmware(printed):
    marlin = printed("M201 X1500 E5000\nM203 X200\nM204 P1250 T900 R800\nM205 X8 E4.5\nG1 X1 F60\n").raw
    duet = printed("M203 X12000\nM566 X600\nG1 X1 F60\n", "reprapfirmware").raw
    klipper = printed("SET_VELOCITY_LIMIT ACCEL=1500 SQUARE_CORNER_VELOCITY=7 VELOCITY=150\nG1 X1 F60\n", "klipper").raw

    last = [[e for e in raw if isinstance(e, canon.PlannerLimits)][-1].limits for raw in (marlin, duet, klipper)]
    assert last[0].acceleration[::3] == (1.5, 5.0)
    assert (last[0].speed[0], last[0].printing, last[0].travel, last[0].retracting) == (0.2, 1.25, 0.9, 0.8)
    assert last[0].jerk[::3] == pytest.approx((0.008, 0.0045))
    assert (last[1].speed[0], last[1].jerk[0]) == (pytest.approx(0.2), pytest.approx(0.01))
    assert (last[2].printing, last[2].corner, last[2].speed[0]) == (1.5, 0.007, 0.15)


@pytest.mark.parametrize("word", ["feedrate", "speed"])  # of PrusaSlicer; of Bambu Studio and OrcaSlicer
def test_limits_that_a_slicer_writes_as_comments(printed, word):
    said = f"; machine_max_{word}_x = 800,200\n; machine_max_{word}_z = 20\n; machine_max_acceleration_x = 9000,5000\n"
    limits = next(e.limits for e in printed(f"G1 X1 F60\n{said}").raw if isinstance(e, canon.PlannerLimits))

    assert limits.speed == pytest.approx((0.8, 0.3, 0.02, 0.025))
    assert limits.acceleration[0] == 9.0


def test_m400_may_wait_longer_than_the_moves(printed):
    program = "G1 X1 F60\nM400\nM400 S2\nM400 P250\n"

    assert [e["seconds"] for e in printed(program).acts("dwell")] == [2, 0.25]
    assert printed(program, "reprapfirmware").acts("dwell") == []  # there S1 keeps the motion system


@pytest.mark.parametrize(
    ("text", "section"),
    [
        (
            ";LAYER_CHANGE\n;Z:0.2\n;TYPE:External perimeter\n;WIDTH:0.45\n;HEIGHT:0.2\n",
            (1, "External perimeter", 4.5e-4, 2e-4),
        ),
        (";LAYER:0\n;TYPE:WALL-OUTER\n;LAYER:1\n", (2, "WALL-OUTER", 0, 0)),
        (
            "; CHANGE_LAYER\n; FEATURE: Inner wall\n; LINE_WIDTH: 0.42\n; LAYER_HEIGHT: 0.2\n",
            (1, "Inner wall", 4.2e-4, 2e-4),
        ),
        (";LAYER_CHANGE\n;LAYER:7\n", (1, "", 0, 0)),
        ("; layer 1, Z = 0.2\n; feature skirt\n", (1, "skirt", 0, 0)),
        (
            "; BEGIN_LAYER_OBJECT z=0.263 z_thickness=0.263\n; END_LAYER_OBJECT z=0.263\n"
            "; BEGIN_LAYER_OBJECT z=0.541 z_thickness=0.278\n; 'Solid Path', 0.4 [feed mm/s], 9.5 [head mm/s]\n",
            (2, "Solid", 0, 2.78e-4),
        ),
        ("; BEGIN_LAYER_RAFT z=0.3\n; 'Crown Path'\n", (1, "", 0, 0)),
        ("; <layer>\n; </layer>\n; <layer>\n", (2, "", 0, 0)),
        (";; --- layer 0 (0.250 @ 0.255) ---\n;; --- layer 1 (.2mm @ 0.455mm) ---\n", (2, "", 0, 2e-4)),
    ],
)
@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_what_slicers_say(printed, text, section, lane):
    found = [e for e in printed(text + "G1 X1 F60\n", lane=lane).raw if isinstance(e, canon.SectionStart)]

    assert found[-1].section == pytest.approx(section)


def test_numbers_checksums_case_and_spaces(printed):
    text = "n1 g1 x10 y-.5 f600*{}\nN2 G1X20Y 1.E2 ; note\n\tg0 z 3 (up) x21\n"
    total = 0
    for byte in b"n1 g1 x10 y-.5 f600":
        total ^= byte
    done = printed(text.format(total))

    assert done.ends == [[10, -0.5, 0], [20, 1, 0], [21, 1, 3]]
    assert "GS017" not in [f.code for f in done.findings]
    assert "GS017" in [f.code for f in printed(text.format(total ^ 1)).findings]


def test_text_behind_an_m_code_is_passed_over(printed):
    """As start and end scripts of real printers have it: Marlin drops a value without letter, hosts read an address."""
    done = printed("M203 80\nM81 192.168.1.84;(off)\nM42 P8 S255 on!\nM970.3 Q0 A7 Q0\nG1 X1 F60\n")

    assert [(f.code, f.level.word, f.span.line, f.span.column) for f in done.findings if f.code == "GS194"] == [
        ("GS194", "warning", 1, 6)
    ]
    assert not [f for f in done.findings if f.level.word == "error"]
    assert done.ends == [[1, 0, 0]]


def test_g_codes_of_a_maker_are_macros(printed):
    done = printed("G1 X1 F60\nG2814 Z0.32\nG999 T1\nG1 X2\n")

    assert [(f.code, f.level.word, f.span.line) for f in done.findings if f.span.line] == [
        ("GS924", "note", 2),
        ("GS924", "note", 3),
    ]
    assert done.ends == [[1, 0, 0], [2, 0, 0]]


@pytest.mark.parametrize(
    ("line", "code", "column"),
    [
        ("X10 Y5", "GS018", 1),
        ("G1 X", "GS004", 4),
        ("G1 X1 X2", "GS004", 7),
        ("G5 X1 I1 J1", "GS012", 1),
        ("G1 X#1", "GS001", 5),
        ("G2 X5 Y0 I9 J0", "GS111", 1),
        ("RESTORE_GCODE_STATE NAME=a", "GS106", 1),
        ("G2 X5 P-1 R9", "GS106", 7),
    ],
)
def test_faults_have_their_place(printed, line, code, column):
    done = printed(f"G1 X1 Y0 F600\n{line}\n")

    assert [(f.code, f.span.line, f.span.column) for f in done.errors] == [(code, 2, column)]


def test_what_is_not_simulated_is_counted(printed):
    done = printed(
        "M104 S200\nM109 S200\nM106 S255\nM73 P0\nSTART_PRINT BED=60\nM900 K0.1\nM117 hello; there\nG29\nG1 X1 F60\n"
    )

    assert {f.message.split(" is ")[0]: f.code for f in done.findings if "read, but" in f.message} == {
        "M104": "GS921", "M109": "GS921", "M106": "GS922", "M73": "GS923", "macro START_PRINT": "GS924",
        "M900": "GS907", "G29": "GS913",
    }  # fmt: skip
    assert done.acts("message")[0]["text"] == "hello"


def test_saved_states_come_back(printed):
    text = "M83\nG1 X10 F600\nSAVE_GCODE_STATE NAME=a\nG91\nG92 X0\nM82\nRESTORE_GCODE_STATE NAME=a\n"
    text += "G1 X12 E1\nG1 X13 E1\n"
    done = printed(text, "klipper")

    assert done.ends == [[10, 0, 0], [12, 0, 0], [13, 0, 0]]
    assert filament(done) == [0, 1, 1]


def table(*numbers):
    return ToolTable(
        {n: ToolEntry(number=n, pocket=n, offset=(0, 0, 0.04 + n * 0.01, 0, 0, 0, 0, 0, 0)) for n in numbers}
    )


@pytest.mark.parametrize(("numbers", "tools"), [((0, 1), [0, 1, 0]), ((1, 2), [1, 2, 1])])
def test_t_chooses_a_nozzle_counted_from_the_first(printed, numbers, tools):
    done = printed("T0\nG1 X1 F60\nT1\nG1 X2\nT0\nG1 X3\n", tool_table=table(*numbers), has_cell=True)

    assert [e["tool"] for e in done.acts("tool_number")][-2:] == tools[1:]
    assert not done.errors
    assert [e["offset"][2] for e in done.acts("tool_offset")] == [40 + 10 * number for number in tools]


def test_a_nozzle_that_is_nowhere_is_an_error(printed):
    done = printed("T5\n", tool_table=table(0, 1), has_cell=True)

    assert [f.code for f in done.errors] == ["GS160"]


@pytest.mark.parametrize("name", ["puck_arcs", "two_tools"])
def test_sums_and_boxes_of_slicers_and_two_lanes(name):
    truth = json.loads((DATA / f"{name}.json").read_text())["truth"]
    source = SourceText.read(DATA / f"{name}.gcode")
    runs = {lane: interpret(source, Settings(dialect="marlin", lane=lane)) for lane in ("grammar", "compiled")}
    events = {lane: list(run) for lane, run in runs.items()}
    assert events["grammar"] == events["compiled"]
    assert list(runs["grammar"].findings) == list(runs["compiled"].findings)

    net, laid, box, layers = 0.0, 0.0, [], set()
    for event in events["compiled"]:
        if isinstance(event, canon.Extrude):
            net += event.length
        elif isinstance(event, canon.LinearFeed | canon.ArcFeed) and event.extrude:
            net += event.extrude
            laid += max(event.extrude, 0.0)
            box.append(event.end[:3])
            layers.add(round(event.end[2] * 1e3, 3))
    assert net * 1e3 == pytest.approx(sum(truth["filament_net_mm"].values()), abs=1e-4)
    assert laid * 1e3 == pytest.approx(sum(truth["filament_laid_mm"].values()), abs=1e-4)
    highest = [max(p[i] for p in box) * 1e3 for i in range(3)]
    assert highest == pytest.approx(truth["extruding_box_mm"][1], abs=2e-3)
    assert {layer["z_mm"] for layer in truth["layers"]} <= layers


def test_the_words_of_bambu_are_read(printed):
    """Its start code levels, cleans and judges with words of its own; free text stands behind M1002."""
    done = printed(
        "M1002 gcode_claim_action : 2\nG380 S2 Z-25 F300\nG28\nT1000\nM620 S0A\nG29.1 Z-0.04\nG39.4\nG150.3\n"
        "M622.1 S1\nT0\nM83\n; CHANGE_LAYER\n; LAYER_HEIGHT: 0.2\n; FEATURE: Inner wall\n; LINE_WIDTH: 0.5\n"
        "G1 X20 E.75 F3000\nG3 Z.6 I1.2 J0 P1 F60000\n",
        has_cell=True,
        tool_table=ToolTable({0: ToolEntry(number=0)}),
    )

    assert [f for f in done.findings if f.level is Severity.ERROR] == []
    assert filament(done) == [0.75, 0]


def test_a_fault_of_a_print_is_told_and_not_that_it_is_a_print(printed):
    """A file full of words of printers, in a printer's dialect: G5.1 is what is wrong."""
    done = printed("M140 S60\nM104 S200\nM106 S255\nG28\nM82\nG1 X1 E1 F600\nG5.1 X3\nG1 X2 E2\n")

    assert [(f.code, f.span.line) for f in done.findings if f.level is Severity.ERROR] == [("GS012", 7)]


def test_sizes_of_simplify3d_and_layers_of_kiri_moto(printed):
    text = "M83\n; layer 1, Z = 0.2\n; tool H0.200 W0.480\nG1 X9 E1 F600\n"
    text += ";; --- layer 1 (0.25mm @ 0.5mm) ---\nG1 X0 E1\n"
    sections = [event.section for event in printed(text).raw if isinstance(event, canon.SectionStart)]

    assert (sections[-2].height, sections[-2].width) == pytest.approx((0.2e-3, 0.48e-3))
    assert [section.layer for section in sections] == [1, 1, 2]
    assert sections[-1].height == pytest.approx(0.25e-3)


def test_a_message_of_a_wait_is_no_word(printed):
    assert [f.code for f in printed("M0 Click to go on\nG1 X1 F60\n").findings if f.code == "GS194"] == []


def spindle(done):
    return [(e["dir"], e["speed"]) for e in done.acts("spindle")]


def test_the_spindle_turns_where_s_is_a_speed(printed):
    """S up to 255 may be a part of full power: no speed is known then."""
    assert spindle(printed("M3 S10000\nG4 S1\nM4\nM5\n")) == [("cw", 10000), ("ccw", 10000), ("off", 0)]
    unknown = printed("M3 S255\nM5\n")
    assert spindle(unknown) == [] and [f.code for f in unknown.findings if f.code == "GS907"] == ["GS907"] * 2
    assert spindle(printed("M3 S200\nM5\n", "reprapfirmware")) == [("cw", 200), ("off", 0)]

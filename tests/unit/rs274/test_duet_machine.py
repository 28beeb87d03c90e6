"""RepRapFirmware: macros in files, and what a program may ask of its printer."""

from __future__ import annotations

import pytest

from gcodesim.diagnostics import Severity, SourceText
from gcodesim.rs274 import Settings, ToolEntry, ToolTable, interpret


class Done:
    def __init__(self, text, folder=None, **settings):
        source = SourceText("p.gcode", text.encode(), folder)
        self.run = interpret(source, Settings(dialect="reprapfirmware", **{"tool_table": ToolTable(), **settings}))
        self.events = list(self.run)
        self.errors = [f for f in self.run.findings if f.level is Severity.ERROR]

    @property
    def xs(self):
        assert not self.errors, self.errors
        return [round(1e3 * e.end[0], 9) for e in self.events if hasattr(e, "end")]

    @property
    def told(self):
        return [e.text for e in self.events if type(e).__name__ == "Print"]


@pytest.fixture
def card(tmp_path):
    def write(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    write("clean.g", "G1 X1\nG1 X2\n")
    write("macros/park head", "if param.A > 2\n  G1 X{param.A}\nelse\n  G1 X{param.B[1]}\n  M99\nG1 X99\n")
    write("sys/prime.g", "G1 X8\n")
    return tmp_path


@pytest.mark.parametrize(
    ("call", "ends"),
    [
        ('M98 P"clean.g"', [1, 2, 5]),
        ("M98 Pclean.g ; as before version 3", [1, 2, 5]),
        ('N10 m098 P"0:/clean.g"', [1, 2, 5]),
        ('M98 P{"clean" ^ ".g"}', [1, 2, 5]),
        ('M98 P"/macros/park head" A3', [3, 99, 5]),
        ('M98 P"0:/macros/park head" A{1 + 1} B7:6.5', [6.5, 5]),
        ('M98 P"prime.g"', [8, 5]),
        ('M98 P"0:/sys/prime.g"', [8, 5]),
        ('M98 P"/sys/clean.g"', [1, 2, 5]),
        ('M98 P"../macros/park head" A4', [4, 99, 5]),
        ('while iterations < 2\n  M98 P"clean.g"', [1, 2, 1, 2, 5]),
        ('if false\n  M98 P"clean.g"', [5]),
        ("M98 R1", [5]),
    ],
)
def test_a_macro_is_read_from_the_card(card, call, ends):
    assert Done(f"{call}\nG1 X5\n", card).xs == ends


def test_modes_come_back_and_variables_are_the_macros_own(card):
    (card / "m.g").write_text("var a = 2\nglobal b = 3\nG91\nM83\nG20\nG1 X1 E1 F60\n")
    done = Done('var a = 1\nG1 X10 E2 F600\nM98 P"m.g"\nG1 X{var.a} E3\nG1 X{global.b}\n', card)
    assert done.xs == [10, 35.4, 1, 3]
    moves = [e for e in done.events if hasattr(e, "extrude")]
    assert [round(1e3 * e.extrude, 6) for e in moves[:3]] == [2, 25.4, 3 - 27.4]
    assert [round(60e3 * e.feed, 6) for e in moves[:3]] == [600, 60 * 25.4, 600]


def test_a_fault_in_a_macro_has_its_file_its_line_and_who_called(card):
    (card / "macros/bad.g").write_text("G1 X1\nG1 X{param.S}\n")
    (fault,) = Done('G1 X1\n\nM98 P"/macros/bad.g"\n', card).errors
    assert (fault.code, fault.span.file, fault.span.line, fault.span.column) == ("GS120", "macros/bad.g", 2, 5)
    assert [(c.file, c.line) for c in fault.span.callers] == [("p.gcode", 3)]
    assert fault.hint == 'the call gives it: M98 P"file.g" S1'


def test_a_macro_that_is_not_there_is_told_with_its_name(card):
    done = Done('G1 X1\nM98 P"nozzle.g"\nM98 P"nozzle.g"\nG1 X2\n', card)
    assert done.xs == [1, 2]
    (told,) = [f for f in done.run.findings if f.code == "GS907"]
    assert (told.message, told.count, told.span.line) == ('M98 P"nozzle.g" is read, but not simulated', 2, 2)
    assert Done('M98 P"clean.g"\nG1 X2\n').xs == [2]  # a text that is no file has no folder


@pytest.mark.parametrize("name", ["../../secret.g", "/../secret.g/../../x", "C:/secret.g", "/", "a\\..\\..\\..\\b"])
def test_nothing_outside_of_the_card_is_read(card, name):
    (card.parent / "secret.g").write_text("G1 X66\n")
    (fault,) = Done(f'M98 P"{name}"\n', card).errors
    assert (fault.code, fault.span.line, fault.span.column) == ("GS131", 1, 6)


def test_a_link_leads_nowhere_else(card):
    (card.parent / "secret.g").write_text("G1 X66\n")
    (card / "link.g").symlink_to(card.parent / "secret.g")
    assert Done('M98 P"link.g"\nG1 X1\n', card).xs == [1]


@pytest.mark.parametrize(
    ("line", "code", "column"),
    [
        ("M98 P{3}", "GS106", 6),
        ('M98 P"clean.g" A1 A2', "GS006", 18),
        ('M98 P"clean.g" ?', "GS006", 15),
        ('M98 P"clean.g" A{var.a}', "GS120", 17),
        ('M98 P"clean.g', "GS006", 6),
    ],
)
def test_faults_in_calls(card, line, code, column):
    (fault,) = Done(f"{line}\n", card).errors
    assert (fault.code, fault.span.column) == (code, column)


def test_a_macro_that_calls_itself_ends(card):
    (card / "clean.g").write_text('G1 X1\nM98 P"clean.g"\n')
    (fault,) = Done('M98 P"clean.g"\n', card).errors
    assert (fault.code, fault.span.file, fault.span.line) == ("GS132", "clean.g", 2)


def test_after_a_fault_each_macro_is_read_once(card):
    (card / "clean.g").write_text("G1 Y1 ?\n")
    done = Done('G1 X1 ?\nM98 P"clean.g"\nM98 P"clean.g"\nG1 Z1 ?\n', card)
    assert [(f.span.file, f.span.line, f.count) for f in done.errors] == [
        ("clean.g", 1, 1),
        ("p.gcode", 1, 1),
        ("p.gcode", 4, 1),
    ]


TABLE = ToolTable({0: ToolEntry(number=0), 1: ToolEntry(number=1)})
CELL = {"has_cell": True, "tool_table": TABLE, "travel": {"X": (-0.01, 0.3)}}


@pytest.mark.parametrize(
    ("before", "name", "value"),
    [
        ("", "move.axes[0].homed", "false"),
        ("G28 X0", "move.axes[0].homed", "true"),
        ("G28 X0", "move.axes[1].homed", "false"),
        ("G28", "move.axes[2].homed", "true"),
        ("G92 Z5", "move.axes[2].homed", "true"),
        ("G28\nM84 X", "move.axes[0].homed", "false"),
        ("G28\nM84 E", "move.axes[0].homed", "true"),
        ("G28\nM18", "move.axes[1].homed", "false"),
        ("", "#move.axes", "3"),
        ("", "exists(move.axes[3])", "false"),
        ("", "move.axes[0].max", "300"),
        ("", "move.axes[0].min", "-10"),
        ("M208 X-5:205.5 Y0:200", "move.axes[0].max", "205.5"),
        ("M208 X-5:205.5 Y0:200", "move.axes[1].min", "0"),
        ("M208 Z1 S1", "move.axes[2].min", "1"),
        ("M208 S0 Z210", "move.axes[2].max", "210"),
        ("G1 X7\nG92 X2", "move.axes[0].userPosition", "2"),
        ("G1 X7\nG92 X2", "move.axes[0].machinePosition", "7"),
        ("G20\nG1 X1", "move.axes[0].userPosition", "25.4"),
        ("M203 X6000", "move.axes[0].speed", "6000"),
        ("M201 X900", "move.axes[0].acceleration", "900"),
        ("M566 Y480", "move.axes[1].jerk", "480"),
        ("M204 P1200 T1500", "move.printingAcceleration", "1200"),
        ("M204 P1200 T1500", "move.travelAcceleration", "1500"),
        ("M220 S50", "move.speedFactor", "0.5"),
        ("M221 D0 S90", "move.extruders[0].factor", "0.9"),
        ("M290 S0.05\nM290 S0.05", "move.axes[2].babystep", "0.1"),
        ("M290 S0.05\nM290 R0 S0", "move.axes[2].babystep", "0"),
        ("M104 S200", "heat.heaters[1].active", "200"),
        ("M109 S200", "heat.heaters[1].current", "200"),
        ("M104 S200 T1", "heat.heaters[2].active", "200"),
        ("M104 S200\nM116", "heat.heaters[1].current", "200"),
        ("M104 S200\nM116 P0", "heat.heaters[1].current", "200"),
        ("M190 S60", "heat.heaters[0].current", "60"),
        ("M190 S60", "heat.heaters[heat.bedHeaters[0]].active", "60"),
        ("M190 H3 S60", "heat.bedHeaters[0]", "3"),
        ("M563 P0 D0 H4\nM109 S200", "heat.heaters[tools[0].heaters[0]].current", "200"),
        ("M104 S200", "heat.heaters[1].state", "active"),
        ("M568 P1 S200 R150 A1", "heat.heaters[2].state", "standby"),
        ("M568 P1 S200 R150 A1", "tools[1].standby[0]", "150"),
        ("G10 P1 S200 R150", "tools[1].active[0]", "200"),
        ("G10 P1 X3", "tools[1].offsets[0]", "3"),
        ("T1", "state.currentTool", "1"),
        ("T1\nT0", "state.previousTool", "1"),
        ("", "#tools", "2"),
        ("", "exists(tools[1])", "true"),
        ("", "exists(tools[2])", "false"),
        ("", "tools[0] != null", "true"),
        ("T1", "tools[1].state", "active"),
        ("M302 S120", "heat.coldExtrudeTemperature", "120"),
        ("M106 S127.5", "fans[0].requestedValue", "0.5"),
        ("M106 P1 S0.3", "fans[1].actualValue", "0.3"),
        ("M107", "fans[0].requestedValue", "0"),
        (";LAYER_CHANGE\nG1 X1 E1", "job.layer", "1"),
        ("", "state.status", "processing"),
    ],
)
def test_what_the_program_or_the_cell_has_said_is_answered(before, name, value):
    done = Done(f"{before}\necho {name}\n", **CELL)
    assert not done.errors, done.errors
    assert done.told == [value]


@pytest.mark.parametrize(
    ("before", "name", "what"),
    [
        ("", "move.axes[1].max", "M208 or a machine with travel in the cell says it"),
        ("", "heat.heaters[1].active", "the program has not said it by M104"),
        ("M104 S200", "heat.heaters[1].current", "nobody waited for a temperature"),
        ("M109 S200\nM104 S150", "heat.heaters[1].current", "nobody waited for a temperature"),
        ("M104 S0", "heat.heaters[1].state", "the program has not heated"),
        ("", "fans[0].requestedValue", "the program has not said it by M106"),
        ("", "sensors.endstops[0].triggered", "is a value of the printer"),
        ("", "sensors.analog[0].lastReading", "is a value of the printer"),
        ("", "state.upTime", "is a value of the printer"),
        ("", "move.axes", ""),
    ],
)
def test_what_only_the_printer_knows_is_told(before, name, what):
    done = Done(f"{before}\necho {name}\n", **CELL)
    if what:
        assert [f.code for f in done.errors] == ["GS120"]
        assert what in done.errors[0].message
    else:
        assert done.told == ["[X,Y,Z]"]


def test_an_index_that_goes_too_far(card):
    for name in ("move.axes[3].homed", "tools[2].number", "tools[0].active[1]"):
        (fault,) = Done(f"M104 S200\necho {name}\n", **CELL).errors
        assert (fault.code, fault.message) == ("GS123", f"there is no `{name}`")


def test_limits_of_axes_are_no_further_length_of_the_firmwares_retraction():
    done = Done("M207 S1 F1800\nM208 S1 X0 Y0\nM83\nG10\nG11\n")
    assert [round(1e3 * e.length, 6) for e in done.events if type(e).__name__ == "Extrude"] == [-1, 1]
    assert "M208" in done.run.not_simulated


TOOLS = ToolTable(entries={n: ToolEntry(number=n) for n in (0, 1)})


@pytest.fixture
def changer(card):
    for tool in (0, 1):
        (card / f"tfree{tool}.g").write_text(f"G91\nG1 X{10 + tool}\n")
        (card / f"sys/tpre{tool}.g").write_text(f"G1 X{20 + tool}\n")
        (card / f"tpost{tool}.g").write_text(f"G1 X{30 + tool}\nG1 R2 X1\n")
    return card


@pytest.mark.parametrize(
    ("program", "ends"),
    [
        ("T0\nG1 X1", [20, 30, 1]),
        ("G1 X5\nT0\nG1 X7\nT1\nG1 X1", [5, 20, 30, 6, 7, 17, 21, 31, 8, 1]),
        ("T1\nT1\nG1 X4", [21, 31, 1, 4]),
        ("T0 P0\nG1 X7\nT1 P2\nG1 X9\nT-1 P1\nG1 X1", [7, 21, 9, 20, 1]),
        ("T0 P0\nT-1\nG1 X1", [10, 1]),
        ("if true\n  T0\n  G1 X2\nG1 X1", [20, 30, 1, 2, 1]),
    ],
)
def test_a_change_of_tools_calls_its_macros(changer, program, ends):
    assert Done(program + "\n", changer).xs == ends


def test_a_macro_for_all_tools_counts_where_there_is_none_for_one(card):
    (card / "tpre.g").write_text("G1 X{state.nextTool + 20}\nG1 X{state.currentTool}\n")
    (card / "tpre1.g").write_text("G1 X40\n")
    assert Done("T0\nG1 X1\nT1\nG1 X2\n", card).xs == [20, -1, 1, 40, 2]


def test_the_new_tool_is_in_use_between_its_macros(changer):
    done = Done("T0\n\nT1\nG1 X1\n", changer)
    said = [
        (type(e).__name__, e.tool if hasattr(e, "tool") else round(1e3 * e.end[0]))
        for e in done.events
        if hasattr(e, "end") or type(e).__name__ == "ToolNumber"
    ]
    at = said.index(("ToolNumber", 1))
    assert [value for _, value in said[at - 2 : at + 2]] == [11, 21, 1, 31]
    (event,) = [e for e in done.events if getattr(e, "tool", None) == 1]
    assert (event.span.file, event.span.line) == ("p.gcode", 3)


def test_a_tool_that_is_not_there_calls_nothing(changer):
    done = Done("G1 X1\nT5\n", changer, tool_table=TOOLS, has_cell=True)
    assert [(f.code, f.span.line, f.span.column) for f in done.errors] == [("GS160", 2, 1)]
    assert [e.end[0] for e in done.events if hasattr(e, "end")] == [1e-3]


def test_codes_of_ones_own_are_files(card):
    (card / "M1234.g").write_text("G1 X{param.X}\nif exists(param.S)\n  echo param.S\n")
    (card / "sys/G600.1.g").write_text("G1 X3\n")
    (card / "M104.g").write_text("G1 X66\n")
    done = Done('M1234 X7 S"a;b" ; own\nG600.1\nm1234 X{4 + 4}\nM104 S200\nM1235\nG1 X1\n', card)
    assert done.xs == [7, 3, 8, 1]
    assert done.told == ["a;b"]
    told = {f.message for f in done.run.findings}
    assert "M1235 is read, but not simulated" in str(told)


def test_work_systems(card):
    done = Done("G10 L2 P2 X10 Y3\nG55\nG1 X1\nG10 L20 P0 X5\nG1 X6\nG54\nG1 X1\nG59.3\nG1 X2\nG28 X0\n", card)
    assert done.xs == [11, 12, 1, 2, 0]
    assert [e.index for e in done.events if type(e).__name__ == "WorkSystem"][-1] == 9


def test_offsets_of_tools_are_still_set_by_g10(card):
    done = Done("G10 P1 X-20 Y1\nG10 L1 P1 Z2\nG1 X1\nT1\nG1 X2\n", card)
    assert done.xs[-1] == 2 and done.run.findings is not None


@pytest.mark.parametrize(
    ("program", "column"), [("G10 L2 P12 X1", 8), ("G60 S7", 5), ("G1 R9 X1", 4), ("G10 L20 P-1 X1", 9)]
)
def test_faults_of_systems_and_kept_places(card, program, column):
    (fault,) = Done(program + "\n", card).errors
    assert (fault.code, fault.span.column) == ("GS106", column)


def test_a_move_starts_from_a_kept_place(card):
    assert Done("G1 X10\nG60 S1\nG1 X50\nG20\nG1 R1 X1\nG21\nG1 R1 X0 Y0\nG91\nG1 R1 X2\nG1 X1\n", card).xs == [
        10, 50, 35.4, 10, 12, 13,
    ]  # fmt: skip

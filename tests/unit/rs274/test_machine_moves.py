"""Printers: homing, ends of the axes, G53, words of other axes, lists of numbers."""

from __future__ import annotations

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, ToolEntry, ToolTable, interpret
from gcodesim.rs274.marlin.line import line_of
from gcodesim.rs274.marlin.said import remember


class Done:
    def __init__(self, text, dialect="reprapfirmware", **settings):
        source = SourceText("p.gcode", text.encode())
        self.run = interpret(source, Settings(dialect=dialect, **{"tool_table": ToolTable(), **settings}))
        self.events = list(self.run)
        self.moves = [event for event in self.events if hasattr(event, "end")]
        self.ends = [tuple(round(1e3 * value, 9) for value in move.end[:3]) for move in self.moves]
        self.told = [
            (f.code, f.span.line, f.span.column) for f in self.run.findings if f.code not in ("GS210", "GS907")
        ]


def test_moves_to_the_switches_end_where_the_axes_do():
    done = Done(
        "M208 X-5:300 Y0:250\nG91\nG1 H2 Z5 F6000\nG1 H1 X-305 Y305 F1800\nG1 X5 Y-5\nG1 H1 X-10 F360\nG90\nG1 X10\n"
    )
    assert done.ends == [(0, 0, 5), (-5, 250, 5), (0, 245, 5), (-5, 245, 5), (10, 245, 5)]
    assert done.moves[3].feed == pytest.approx(6e-3)
    assert done.told == []


def test_an_end_that_nobody_has_said_is_told_and_a_machine_says_it():
    program = "G91\nG1 H1 X900 F1800\nG1 H1 Y-900\nG1 H3 X900\n"
    unknown = Done(program)
    assert (unknown.ends, unknown.told) == ([], [("GS913", 2, 7), ("GS913", 4, 7)])
    known = Done(program, travel={"X": (0.0, 0.5)}, parameters={5221: 200.0}, tool_table=ToolTable())
    assert known.ends == [(500, 0, 0)] and known.told == []


def test_an_axis_is_homed_by_its_switch_and_z_by_the_probe():
    asks = "if move.axes[0].homed && !move.axes[1].homed && {}move.axes[2].homed\n  G1 X{}\n"
    done = Done("G91\nG1 H1 X-9\nG90\n" + asks.format("!", 7) + "G30\n" + asks.format("", 8))
    assert [x for x, _, _ in done.ends] == [7, 7, 8]


def test_a_probe_goes_down_to_the_bed_and_up_again():
    done = Done("M558 P1 H3:2 F300:120\nG1 Z20 F600\nG92 Z4\nG30\nG1 Z1\nG30 P0 X10 Y10 Z-99999\nG30 S-1\n")
    assert done.ends == [(0, 0, 20), (0, 0, 0), (0, 0, 3), (0, 0, 1)]
    assert [round(60e3 * move.feed) for move in done.moves[:2]] == [600, 300]
    assert done.told == [("GS913", 6, 1)]


@pytest.mark.parametrize(
    ("dialect", "ends"),
    [("marlin", [10, 20, 21, 22]), ("klipper", [10, 21, 22]), ("reprapfirmware", [10, -70, 21, 22])],
)
def test_g53_goes_to_places_of_the_machine(dialect, ends):
    """G92 X100 at 10: Marlin leaves its shift of 90 out, RepRapFirmware's machine stands at 100 from then on."""
    done = Done("G90\nG1 X10 F600\nG92 X100\nG53 G0 X20\nG1 X111\nG91\nG1 X1\n", dialect)
    assert [x for x, _, _ in done.ends] == ends


def test_g53_leaves_work_systems_and_nozzles_out():
    tools = ToolTable({0: ToolEntry(number=0), 1: ToolEntry(number=1)})
    text = "G10 L2 P2 X30 Y3\nG10 P1 X-18\nG55\nG1 X1 F600\nG53 G1 X40\nT1\nG53 G1 X40\nG53 G1 X45\n"
    done = Done(text, tool_table=tools)
    assert [x for x, _, _ in done.ends] == [31, 40, 27]  # the head is at 40 already when it is told the second time
    assert [f.code for f in Done("G53 G2 X3 I1\n").run.findings if f.level.word == "error"] == ["GS109"]
    assert Done("G91\nG1 X3 F600\nG53 G1 X3\n").ends[-1] == (6, 0, 0)


def test_g10_says_where_a_nozzle_is_as_m218_does():
    """A nozzle below the head by 4.85 mm, as of a tool changer: to be at Z0 the head is at 4.85."""
    tools = ToolTable({0: ToolEntry(number=0), 1: ToolEntry(number=1)})
    done = Done("G10 P1 X20 Z-4.85\nT1\nG1 X100 Z0 F600\n", tool_table=tools)
    (offset,) = [event.offset for event in done.events if type(event).__name__ == "ToolOffset"]
    assert [round(1e3 * value, 9) for value in offset[:3]] == [-20, 0, 4.85]


def test_axes_that_are_not_simulated_are_told():
    done = Done("G1 X1 U5 F600\nG28 U\nG1 X2 A1\nG1 X3 U1\n", "reprapfirmware")
    assert [x for x, _, _ in done.ends] == [1, 2, 3]
    assert done.told == [("GS913", 1, 7), ("GS913", 2, 1), ("GS913", 3, 7)]
    assert Done("G1 X1 B5 F600\n", "marlin").told == [("GS913", 1, 7)]
    assert Done("G2 X2 Y0 I1 J0 F600\n", "marlin").told == []


def test_words_with_several_numbers_belong_to_reprapfirmware():
    done = Done("M83\nM201 X500 E250:260 Y400\nG10 P0 S200:210 R0\nG1 X1 E1:2.5 F600\nM566 X900 E120 : 90 Z6\n")
    assert [round(1e3 * move.extrude, 9) for move in done.moves] == [3.5]
    assert [f for f in done.run.findings if f.code in ("GS001", "GS194")] == []
    (limits,) = [event.limits for event in done.events if type(event).__name__ == "PlannerLimits"][-1:]
    assert (limits.acceleration[1], limits.acceleration[3]) == (0.4, 0.25)  # Y stands behind the list
    assert (limits.jerk[2], limits.jerk[3]) == (pytest.approx(1e-4), pytest.approx(2e-3))
    assert [f.code for f in Done("G1 X1:2 F600\n", "marlin").run.findings if f.level.word == "error"] == ["GS001"]
    assert [f.code for f in Done("M201 X500:1 Y4\n", "marlin").run.findings if f.code == "GS194"] == ["GS194"]


def test_a_list_is_said_again_as_it_was():
    said: dict = {}
    remember(said, line_of("M203 X6000 E1200:1300.5", has_lists=True), 0)
    assert list(said.values()) == ["M203 X6000 E1200:1300.5"]

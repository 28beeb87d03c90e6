"""Parameters that have a value before the program begins."""

from __future__ import annotations

import pytest

from gcodesim.canon import Rapid
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Run, Settings, interpret
from gcodesim.rs274.presets import as_written, parameter_of
from gcodesim.units import MM


def run(text: str, presets: dict[int | str, float], **settings: object) -> Run:
    reading = interpret(SourceText("p.nc", text.encode()), Settings(presets=presets, **settings))  # type: ignore[arg-type]
    reading.ends = [event.end for event in reading if isinstance(event, Rapid)]  # type: ignore[attr-defined]
    return reading


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_numbers_names_and_globals_are_there_at_the_first_block(lane):
    text = "G21 G90\nO1 SUB\nG0 Z#<_high>\nO1 ENDSUB\nG0 X#<deep> Y#100\nO1 CALL\nM2\n"

    reading = run(text, {100: 7.0, "deep": 3.0, "_high": 1.5}, lane=lane)

    assert [end[:3] for end in reading.ends] == [(3 * MM, 7 * MM, 0.0), (3 * MM, 7 * MM, 1.5 * MM)]
    assert not list(reading.findings)


def test_a_pin_of_the_machine_has_the_value_that_is_given():
    """As programs for plasma tables ask for the feed of the material."""
    text = "G21 G90\nF#<_hal[plasmac.cut-feed-rate]>\nG1 X#<_HAL[ plasmac.cut-feed-rate ]>\nM2\n"
    name = parameter_of("_hal[plasmac.cut-feed-rate]")
    assert name == parameter_of("#<_hal[plasmac.cut-feed-rate]>") == "_hal[plasmac.cut-feed-rate]"
    assert not list(run(text, {name: 3200.0}).findings)

    (missing,) = run(text, {}).findings
    assert missing.code == "GS120" and "--set '_hal[plasmac.cut-feed-rate]=VALUE'" in missing.hint


def test_a_subroutine_does_not_see_a_local_name():
    reading = run("O1 SUB\nG0 X#<deep>\nO1 ENDSUB\nO1 CALL\nM2\n", {"deep": 3.0})

    assert [finding.code for finding in reading.findings] == ["GS120"]


def test_a_program_can_ask_whether_it_was_given():
    text = "O1 IF [EXISTS[#<_deep>] EQ 0]\n#<_deep> = 9\nO1 ENDIF\nG0 X#<_deep>\nM2\n"

    assert run(text, {"_deep": 2.0}).ends[0][0] == 2 * MM
    assert run(text, {}).ends[0][0] == 9 * MM
    assert not list(run(text, {"_deep": 2.0}).findings)


@pytest.mark.parametrize(
    ("text", "preset", "line"),
    [
        ("#<d> = 2\nG0 X#<d>\nM2\n", "d", 1),
        ("G0 X1\n# < D >= 2 (#<d> is the depth)\nG0 X#<d>\nM2\n", "d", 2),
        ("#100 = 2\nG0 X#100\nM2\n", 100, 1),
        ("G0 X1 (#<d>)\nM2\n", "d", 0),
        ("G0 X#1000\nM2\n", 100, 0),
    ],
)
def test_a_value_that_nothing_reads_is_told(text, preset, line):
    (finding,) = run(text, {preset: 5.0}).findings

    assert (finding.code, finding.span.line) == ("GS144", line)


@pytest.mark.parametrize(
    ("text", "preset"),
    [
        ("#<d> = [#<d> + 1]\nG0 X#<d>\nM2\n", "d"),
        ("(DEBUG, #<d>)\nM2\n", "d"),
        ("#2 = 100\nG0 X##2\nM2\n", 100),
        ("G0 X# 0100\nM2\n", 100),
        ("O1 IF [#<d> == 5]\nG0 X1\nO1 ENDIF\nM2\n".replace("==", "EQ"), "d"),
    ],
)
def test_a_value_that_is_read_is_not_told(text, preset):
    assert not [finding for finding in run(text, {preset: 5.0}).findings if finding.code == "GS144"]


def test_offsets_are_in_force_from_the_start():
    assert run("G0 X1\nM2\n", {5221: 10.0}).ends[0][0] == pytest.approx(11 * MM)


@pytest.mark.parametrize(("preset", "code"), [(5420, "GS122"), ("_x", "GS122"), (99999, "GS121")])
def test_what_cannot_be_set_is_an_error(preset, code):
    reading = run("G0 X1\nM2\n", {preset: 1.0})

    assert reading.failed is not None and reading.failed.code == code


def test_fanuc_has_numbers_of_its_own():
    text = "%\nO1\nG0 X#1 Y#500\nM30\n%\n"

    assert run(text, {1: 2.0, 500: 3.0}, dialect="fanuc").ends[0][:2] == (2 * MM, 3 * MM)
    assert run(text, {"depth": 2.0}, dialect="fanuc").failed.code == "GS121"


@pytest.mark.parametrize("text", ["#<Dep th>", "<depth>", "depth", " #<depth> "])
def test_names_are_compared_as_controls_do(text):
    assert parameter_of(text) == "depth"


def test_parameters_as_people_write_them():
    assert (parameter_of("#100"), parameter_of("100"), parameter_of("#<_a>")) == (100, 100, "_a")
    assert (as_written(100), as_written("a")) == ("#100", "#<a>")
    assert parameter_of("1.5") is parameter_of("") is parameter_of("#[1]") is None

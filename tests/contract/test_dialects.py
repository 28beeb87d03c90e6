"""Every dialect reads the plain core of the language alike, and its tables are consistent."""

import re
from pathlib import Path

import pytest

from gcodesim import rs274
from gcodesim.canon import PlannerLimits
from gcodesim.canon.listing import as_json
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.dialects import DIALECTS, g_name

TURNS = ("fanuc_lathe", "fanuc_lathe_b")
"""X is a diameter, G90 a cycle: see `tests/physics/test_run_turning.py`."""

CORE = b"N1 G21 G17 G90 G94\nG0 X1 Y2 Z3\nG1 Z-1 F100\nG2 X11 Y2 I5 J0\nG91 G1 X-1\nG90\nS500 M3\nM5\nM2\n"


@pytest.mark.parametrize("name", [name for name in DIALECTS if not DIALECTS[name].prints and name not in TURNS])
def test_the_core_means_the_same_everywhere(name):
    run = interpret(SourceText("p.nc", CORE), Settings(dialect=name))
    reference = interpret(SourceText("p.nc", CORE), Settings())

    events = [as_json(e) for e in run if not isinstance(e, PlannerLimits)]  # grbl passes corners by a law of its own
    assert events == [as_json(e) for e in reference]
    assert not run.findings.has_errors()


@pytest.mark.parametrize("name", DIALECTS)
def test_users_of_words_are_codes_of_the_language(name):
    dialect = DIALECTS[name]
    linuxcnc = DIALECTS["linuxcnc"]
    known = {g_name(code) for code in linuxcnc.g_groups} | {f"m{code}" for code in linuxcnc.m_groups} | {"user"}

    assert set().union(*dialect.users.values()) <= known
    assert set(dialect.users) <= linuxcnc.letters


@pytest.mark.parametrize("text", ["G5 X1 I1 J1 P1 Q1", "o1 if [1]", "#<a>=1", "G0 U1", "M70", "G95"])
def test_extensions_are_errors_in_plain_rs274(text):
    run = interpret(SourceText("p.nc", f"F100\n{text}\nM2\n".encode()), Settings(dialect="rs274"))
    list(run)

    assert run.failed is not None
    assert run.failed.span.line == 2


PRINTERS = dict.fromkeys(("klipper", "marlin", "reprapfirmware"), "marlin/")
OF_ONE_CONTROL = {"fanuc": "fanuc/", "fanuc_lathe": "fanuc/", "fanuc_lathe_b": "fanuc/", "grbl": "grbl.py", **PRINTERS}
"""Dialects whose blocks mean something else than in RS274, and where in `rs274` that lives."""


def test_the_common_interpreter_names_no_control():
    """It asks the dialect. A maker's name in it would be a special case that no other dialect can have."""
    top = Path(rs274.__file__).parent
    houses = ("dialects/", *OF_ONE_CONTROL.values())
    common = [path for path in top.rglob("*.py") if not path.relative_to(top).as_posix().startswith(houses)]
    names = re.compile(rf"{'|'.join(OF_ONE_CONTROL)}|haas|{'|'.join(DIALECTS['fanuc'].options)}", re.IGNORECASE)

    assert len(common) > 50
    assert {path.name: found for path in common if (found := names.findall(path.read_text(encoding="utf-8")))} == {}
    assert {name for name in DIALECTS.own() if DIALECTS[name].executor} == set(OF_ONE_CONTROL)


@pytest.mark.parametrize("name", DIALECTS)
def test_an_option_has_a_usual_value_and_refuses_others(name):
    dialect = DIALECTS[name]
    for option, values in dialect.options.items():
        assert dialect.option(option, {"of another control": "x"}) == values[0]
        assert [dialect.option(option, {option: value}) for value in values] == list(values)
        with pytest.raises(ValueError, match=f"{option} of {name} is one of"):
            dialect.option(option, {option: "?"})


def test_no_two_dialects_have_the_same_further_system():
    """So that the number of a system says where its offset is kept, whatever the dialect."""
    numbers = [index for name in DIALECTS for block in DIALECTS[name].further_systems for index in block.systems]
    assert len(numbers) == len(set(numbers)) >= 300
    assert min(numbers) > 9

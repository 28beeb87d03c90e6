"""Every dialect reads the plain core of the language alike, and its tables are consistent."""

import pytest

from gcodesim.canon.listing import as_json
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.dialects import DIALECTS, g_name

CORE = b"N1 G21 G17 G90 G94\nG0 X1 Y2 Z3\nG1 Z-1 F100\nG2 X11 Y2 I5 J0\nG91 G1 X-1\nG90\nS500 M3\nM5\nM2\n"


@pytest.mark.parametrize("name", DIALECTS)
def test_the_core_means_the_same_everywhere(name):
    run = interpret(SourceText("p.nc", CORE), Settings(dialect=name))
    reference = interpret(SourceText("p.nc", CORE), Settings())

    assert [as_json(e) for e in run] == [as_json(e) for e in reference]
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

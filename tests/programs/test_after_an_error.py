"""After an error `lint` still tells every other kind of fault further down, and invents none."""

from __future__ import annotations

import random
import re
import sys
from functools import cache
from pathlib import Path

import pytest

from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.diagnostics.show import as_text
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.assumed import assumed_tools

sys.path.insert(0, str(Path(__file__).parent))

from test_clean import POSTS, PROGRAMS, dialect_of
from test_warnings import CASES, TOOLS

HEAD = "G21 G90 G17 G94\n"
# errors behind which nothing of importance is in doubt
ERRORS = {
    "a number": "G0 X1.2.3\nG0 X0 Y0\n",
    "a letter": "G0 Y1O\nG0 X0 Y0\n",
    "a code": "G999\n",
    "a value": "G2 X5 Y5 R1 F100\nG0 X0 Y0\n",
    "a bracket": "G0 X[1\nG0 X0 Y0\n",
}


def findings_of(text: str, dialect: str) -> list[Diagnostic]:
    source = SourceText("part.nc", text.encode())
    reading = interpret(source, Settings(dialect=dialect, tool_table=TOOLS))
    list(reading)
    return list(reading.findings)


EACH = [
    (name, dialect, error)
    for name, (dialects, _, _) in CASES.items()
    for number, dialect in enumerate(dialects)
    for error in list(ERRORS)[number % 2 :: 2]
]


@pytest.mark.parametrize(("name", "dialect", "error"), EACH, ids=lambda value: value.replace(" ", "-"))
def test_a_warning_behind_an_error_is_told_too(name: str, dialect: str, error: str) -> None:
    _, text, _ = CASES[name]
    begin = "%\n" + HEAD if text.startswith("%") else HEAD
    body = text.removeprefix("%\n")
    clean, faulty = findings_of(begin + body + "\n", dialect), findings_of(begin + ERRORS[error] + body + "\n", dialect)
    (wanted,) = [f for f in clean if f.level > Severity.NOTE]
    added = ERRORS[error].count("\n")
    shown = "\n".join(as_text(f, {}) for f in faulty)
    assert any(f.level is Severity.ERROR for f in faulty), "the error is none in this dialect"
    place = (wanted.code, wanted.span.line + added, wanted.span.column)
    assert place in [(f.code, f.span.line, f.span.column) for f in faulty], shown


SAID = (
    ("M3\nG0 Z5\nG1 Z-1 F100\nG0 Z5\nM5\nM2\n", "GS176", 4),  # M3 without S
    ("S5000 M3\nG0 Z5\nG1 Z-1\nG0 Z5\nM5\nM2\n", "GS107", 6),  # no F
    ("S5000 M3\nG0 Z5\nG1 Z-1 F100 Q3\nM2\n", "GS104", 6),  # a word that nothing uses
    ("G1 X#<unknown> F100\nM2\n", "GS120", 4),
    ("G0 X1\nG2 X5 Y5 I9 J0 F100\nM2\n", "GS111", 5),
    ("G81 X1 Z-1 F100\nM2\n", "GS140", 4),
    ("G92 X5\nM2\n", "GS187", 4),
    ("M2\nG0 X5\n", "GS137", 5),
    ("o100 call\nM2\n", "GS131", 4),
)


@pytest.mark.parametrize(("text", "code", "line"), SAID, ids=[code for _, code, _ in SAID])
@pytest.mark.parametrize("error", ["G0 X1.2.3", "G0 X1O", "G0 Xabc", "GO X5", "M3.5", "#<other> = 1O"])
def test_each_kind_of_fault_is_told_behind_a_typo(text: str, code: str, line: int, error: str) -> None:
    if error.startswith(("GO", "#")) and code == "GS187":
        return  # an unknown code may have changed the frame, an unknown parameter what is set
    found = findings_of(f"{error}\nG21 G90\nG0 X0 Y0 Z9\n{text}", "linuxcnc")
    assert (code, line) in [(f.code, f.span.line) for f in found], [str(f) for f in found]


# -- nothing is invented


@cache
def _clean(path: Path, dialect: str) -> tuple[str, Settings]:
    source = SourceText.read(path)
    return source.text, Settings(dialect=dialect, tool_table=assumed_tools(source))


_NO_BLOCK = re.compile(r"\s*(?:[(;%]|o|if|while|do|end|goto|#)", re.IGNORECASE)  # or one that decides what is read


def typos(line: str, seed: random.Random) -> str:
    """The line with one typo, of the kinds that hands make; the line itself where none fits."""
    numbers = list(re.finditer(r"(?<=[A-Za-z])-?[0-9.]+", line))
    if not numbers or _NO_BLOCK.match(line):
        return line
    number = seed.choice(numbers)
    kind = seed.randrange(5)
    begin, text, end = line[: number.start()], number.group(), line[number.end() :]
    if kind == 0:
        text = text.replace("0", "O", 1) if "0" in text else text + "l"
    elif kind == 1:
        text += ".1.2"
    elif kind == 2:
        text = ""
    elif kind == 3:
        text = "[" + text
    else:
        begin = begin[:-1] + "@" + begin[-1:]
    return begin + text + end


@pytest.mark.parametrize("path", [*PROGRAMS, *POSTS], ids=lambda path: path.stem)
def test_a_typo_in_a_clean_program_is_the_only_thing_told(path: Path) -> None:
    dialect = "linuxcnc" if path in PROGRAMS else dialect_of(path)
    text, settings = _clean(path, dialect)
    if len(text) > 60_000:
        pytest.skip("long programs have the same lines many times")
    lines = text.splitlines()
    before = {(f.code, f.message) for f in _all(text, settings)}
    seed = random.Random(path.stem)
    for _ in range(12):
        at = seed.randrange(len(lines))
        broken = typos(lines[at], seed)
        if broken == lines[at]:
            continue
        found = _all("\n".join([*lines[:at], broken, *lines[at + 1 :]]) + "\n", settings)
        if not any(f.level is Severity.ERROR and f.span.line == at + 1 for f in found):
            continue  # it has another meaning now: a program of its own
        others = [f for f in found if f.span.line != at + 1 and (f.code, f.message) not in before]
        told = [f for f in others if f.level > Severity.NOTE]
        assert not told, f"line {at + 1}: {broken}\n" + "\n".join(as_text(f, {}) for f in told)


def _all(text: str, settings: Settings) -> list[Diagnostic]:
    reading = interpret(SourceText("part.nc", text.encode()), settings)
    for _ in reading.stream():
        pass
    return list(reading.findings)


@pytest.mark.parametrize(
    ("line", "code"),
    [("G3 X1 Y1", "GS110"), ("G83 X1 Y1 Z-1 R2", "GS140"), ("G81 X1 Y1 Z-1", "GS140")],
)
def test_a_word_that_is_missing_is_told_where_nobody_knows_the_position(line: str, code: str) -> None:
    found = findings_of(f"{HEAD}G1 X5 Y F100\n{line}\nM2\n", "linuxcnc")

    assert [(f.code, f.span.line) for f in found if f.level is Severity.ERROR] == [("GS004", 2), (code, 3)]


def test_a_word_that_an_unread_line_may_have_said_is_not_missed() -> None:
    found = findings_of(f"{HEAD}F100\nG83 X1.2.3 Y Z-1 R2 Q1\nG83 X2\nM2\n", "linuxcnc")

    assert [(f.code, f.span.line) for f in found if f.level is Severity.ERROR] == [("GS005", 3)]

"""Whatever a file holds: findings or a wrong usage, within seconds and bounded memory; never a traceback."""

from __future__ import annotations

import pytest

from gcodesim.diagnostics import Severity, SourceText
from gcodesim.diagnostics.show import as_text
from gcodesim.rs274 import Settings, ToolEntry, ToolTable, interpret, lint
from tests.effort import calls_of

MOST_CALLS = 10_000_000
"""What reading one hostile program may cost: some seconds."""

TOOLS = ToolTable({1: ToolEntry(number=1, pocket=1, diameter=6e-3)})
NINES = "9" * 240
LINUXCNC = {
    # loops and calls without end
    "while": ("o1 while [1]\no1 endwhile\nM2", "GS134"),
    "do": ("o1 do\no1 while [1]\nM2", "GS134"),
    "repeat": ("o1 repeat [999999999]\no1 endrepeat\nM2", "GS134"),
    "calls": ("M98 P1 L999999999\nM2\nO1\nM99", "GS134"),
    "recursion": ("o1 sub\no1 call\no1 endsub\no1 call\nM2", "GS132"),
    "recursion_of_programs": ("M98 P1\nM2\nO1\nM98 P1\nM99", "GS132"),
    # one block that asks for too much
    "holes": ("G91 F100\nG81 X1 Z-1 R1 L999999999\nM2", "GS140"),
    "pecks": ("G91 F100\nG83 X1 Z-100 R1 Q0.01 L9999\nM2", "GS140"),
    "finer_pecks": ("F100\nG83 X1 Z-100 R1 Q0.0001\nM2", "GS140"),
    "threads": ("S100 M3\nG0 X10 Z5\nG76 P1 Z-20 I-2 J0.000001 K1 R1 H100000\nM2", "GS175"),
    "turns": ("F100\nG2 I1 P99999999\nM2", "GS106"),
    "control_points": ("F100\nG5.2 P1 L999999\nX1 Y1 P1\nG5.3\nM2", "GS170"),
    # text that is long or deep
    "long_label": ("o1 call\no" + "9" * 5000 + "\nM2", "GS002"),
    "long_blanks": ("o1 call\n" + " " * 100_000 + "xo\nM2", "GS002"),
    "long_bracket_label": ("o1 call\no[" + "] " * 50_000 + "\nM2", "GS002"),
    "long_name": ("o1 call\no<" + "<" * 100_000 + "\nM2", "GS002"),
    "deep": ("G0 X" + "[" * 1000 + "1" + "]" * 1000 + "\nM2", "GS002"),
    "unclosed": ("G0 X" + "[" * 240 + "\nM2", "GS006"),
    "signs": ("G0 X" + "-" * 240 + "\nM2", "GS004"),
    "hashes": ("G0 X" + "#" * 240 + "1\nM2", "GS121"),
    "branches": ("o1 if [1]\n" * 2000 + "M2", "GS130"),
    # numbers
    "huge_x": (f"G0 X{NINES}\nM2", "GS123"),
    "huge_tool": (f"T{NINES}\nM2", "GS123"),
    "huge_code": (f"G{NINES}\nM2", "GS123"),
    "huge_arc": ("F1\nG2 X" + "9" * 100 + " Y1 I" + "4" * 100 + "\nM2", "GS123"),
    "huge_power": ("#1=[9**9**9**9]\nM2", "GS123"),
    "huge_parameter": ("#[99999999999999999999]=1\nM2", "GS121"),
    "nan": ("G0 XNaN\nM2", "GS004"),
    "infinite": ("G0 X[LN[0]]\nM2", "GS123"),
    "many_faults": ("G0 X\n" * 3000 + "M2", "GS015"),
}
FANUC = {
    "goto": ("N1 GOTO 1\nM30", "GS134"),
    "while": ("WHILE [1 EQ 1] DO 1\nEND 1\nM30", "GS134"),
    "calls": ("O1\nM98 P2 L999999999\nM30\nO2\nM99", "GS134"),
    "macros": ("O1\nG65 P2 L999999999\nM30\nO2\nM99", "GS134"),
    "recursion": ("O1\nG65 P1\nM30", "GS132"),
    "holes": ("O1\nG91 G81 X1. Z-1. R1. F100 K999999999\nM30", "GS140"),
    "pecks": ("O1\nG83 Z-1. R1. Q0.0000001 F1\nM30", "GS140"),
    "long_number": ("O" + "9" * 5000 + "\nM30", "GS002"),
    "long_sequence": ("N" + "9" * 3000 + "\nN1 GOTO " + "9" * 3000 + "\nM30", "GS123"),
    "deep": ("G0 X" + "[" * 4000 + "\nM30", "GS006"),
    "overflow": ("#1=999999999.\n" + "#1=#1*#1*#1*#1\n" * 50 + "M30", "GS123"),
}
CASES = [
    *(pytest.param("linuxcnc", *case, id=f"linuxcnc-{name}") for name, case in LINUXCNC.items()),
    *(pytest.param("fanuc", *case, id=f"fanuc-{name}") for name, case in FANUC.items()),
    pytest.param("grbl", "G0 X" + "9" * 70 + "\nM2", "GS123", id="grbl-huge"),
]


@pytest.mark.parametrize(("dialect", "text", "code"), CASES)
def test_a_finding_in_a_moment(dialect: str, text: str, code: str) -> None:
    run = interpret(SourceText("p.nc", text.encode()), Settings(dialect=dialect, tool_table=TOOLS, max_blocks=20_000))
    events: list[object] = []
    calls_of(lambda: events.extend(run), MOST_CALLS)
    count = len(events)
    shown = [as_text(finding, run.sources) for finding in run.findings]

    assert code in {f.code for f in run.findings if f.level is Severity.ERROR}, shown[:3]
    assert count < 100
    assert all(len(line) < 500 for text in shown for line in text.splitlines())


@pytest.mark.parametrize("dialect", ["linuxcnc", "rs274", "grbl", "fanuc"])
@pytest.mark.parametrize(
    "raw",
    [
        b"",
        b"\n",
        b"\x00",
        b"\xff\xfe" + "G0 X1\nM2\n".encode("utf-16-le"),
        bytes(range(256)) * 20,
        b"\x7fELF\x02\x01\x01" + b"\x00" * 4000,
        b"(" * 3000,
        b"<" * 3000,
        b"o" * 3000,
        b"#" * 100 + b"\n" + b"[" * 100,
        b"G1 X1 F1 " * 400,
        "１２３ Ｇ０ 💥\n".encode() * 20,
    ],
    ids=lambda raw: f"{len(raw)}-{raw[:2].hex()}",
)
def test_what_is_no_program(dialect: str, raw: bytes) -> None:
    run = interpret(SourceText("p.nc", raw), Settings(dialect=dialect, max_blocks=20_000, tool_table=TOOLS))
    for _ in run:
        pass
    for finding in run.findings:
        assert "\n" not in finding.message
        as_text(finding, run.sources)
    assert run.failed is not None or dialect == "grbl"  # which needs no end


def test_a_time_limit_ends_what_a_budget_of_blocks_would_not() -> None:
    text = "o1 while [1]\n#1=[#1+1]\no1 endwhile\nM2"
    run = interpret(SourceText("p.nc", text.encode()), Settings(time_limit=0.2, max_blocks=10**12))
    for _ in run:
        pass

    assert run.failed is not None and run.failed.code == "GS135" and run.failed.span.line == 1


def test_the_same_fault_in_every_line_is_told_a_few_times_and_counted() -> None:
    """Twenty places, then one finding with the count of the others, then no more is read."""
    source = SourceText("many.nc", b"G21 G90\n" + b"G1 X5 F-300\n" * 50_000 + b"M2\n")

    found = list(lint(source))

    alike = [f for f in found if f.code == "GS106"]
    assert len(alike) == 21 and sum(f.count for f in alike) == 1000
    assert [f.count for f in alike[:20]] == [1] * 20
    assert {f.code for f in found} == {"GS106", "GS015"}


def test_warnings_of_many_numbers_are_folded() -> None:
    """Warnings are no reason to stop reading, and no reason to fill the screen."""
    lines = "".join(f"G0 X{at} 5\n" for at in range(1, 3001))
    source = SourceText("many.nc", f"G21 G90\n{lines}M2\n".encode())

    found = list(lint(source))

    assert {f.code for f in found} == {"GS197"} and len(found) == 101
    assert sum(f.count for f in found) == 3000

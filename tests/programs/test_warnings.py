"""What a control accepts and a machinist would not: each warning in each dialect whose programs can deserve it."""

from __future__ import annotations

import pytest

from gcodesim.diagnostics import Severity, SourceText
from gcodesim.diagnostics.show import as_text
from gcodesim.rs274 import Settings, ToolEntry, ToolTable, interpret

TOOLS = ToolTable(
    {
        number: ToolEntry(
            number=number, pocket=number, offset=(0, 0, 0.05 + 0.01 * number, 0, 0, 0, 0, 0, 0), diameter=6e-3
        )
        for number in (1, 2)
    }
)
TOOL = "T1 M6\nG43 H1 G0 Z50.\nS5000 M3\n"
CUT = "G0 X0 Y0 Z5.\nG1 Z-2. F200\nX40. F600\nG0 Z50.\n"
ENTRY = "G0 X-20. Y-20. Z5.\nG1 Z-2. F200\nG41 D1 X0. Y-10. F600\n"
ALL = ("fanuc", "grbl", "linuxcnc", "rs274")
WITH_TOOLS = ("fanuc", "linuxcnc", "rs274")
# code: dialects, program, guilty words
CASES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "GS176 after M5": (ALL, "S5000 M3\n" + CUT + "M5\n" + CUT + "M30", "G1 Z-2. F200"),
    "GS176 after M6": (WITH_TOOLS, TOOL + CUT + "T2 M6\nG43 H2\n" + CUT + "M5\nM30", "G1 Z-2. F200"),
    "GS161": (WITH_TOOLS, "T1 M6\nG43 H2 G0 Z50.\nS5000 M3\n" + CUT + "M5\nM30", "H2"),
    "GS162": (WITH_TOOLS, TOOL + CUT + "M5\nT2 M6\nS5000 M3\nG0 X0 Y0\nZ5.\nG1 Z-2. F200\nG0 Z50.\nM5\nM30", "Z5."),
    "GS154": (
        WITH_TOOLS,
        TOOL + ENTRY + "Y30.\nG0 X40.\nG1 Y-10.\nG40 X60. Y-20.\nG0 Z50.\nM5\nM30",
        "G0 X40.",
    ),
    "GS155": (
        WITH_TOOLS,
        TOOL + ENTRY + "Y30.\nX40.\nM5\nM30",
        "M30",
    ),
    "GS187": (ALL, "G92 X0 Y0 Z0\nS5000 M3\nG0 X10.\nG92 X0\n" + CUT + "M5\nM30", "G92"),
    "GS187 G52": (("fanuc", "linuxcnc"), TOOL + "G52 X10.\n" + CUT + "M5\nM30", "G52"),
    "GS187 G68": (("fanuc",), TOOL + "G68 X0 Y0 R30.\n" + CUT + "M5\nM30", "G68"),
    "GS186": (ALL, "S5000 M3\n" + CUT + "G20\nG0 X0 Y1. Z.2\nG1 Z-.1 F8\nX2.\nG0 Z1.\nM5\nM30", "G20"),
    "GS137": (ALL, "S5000 M3\n" + CUT + "M5\nM30\n" + CUT + "M5\nM30", "G0 X0 Y0 Z5."),
    "GS136": (("fanuc",), TOOL + CUT + "M98 P1000\nM5\nM30\nO1000\nG0 Z9.\nM99\nO1001\nG0 Z5.\nM99", "O1001"),
    "GS136 o": (("linuxcnc",), "o100 sub\nG0 Z9\no100 endsub\n" + TOOL + CUT + "M5\nM30", "o100 sub"),
    "GS141": (("fanuc",), TOOL + "G81 X10. Y10. Z-5. R2. F100 K0\nG80\nM5\nM30", "G81 X10. Y10. Z-5. R2. F100 K0"),
    "GS141 Q": (("fanuc",), TOOL + "G81 X10. Y10. Z-5. R2. Q2. F100\nG80\nM5\nM30", "Q2."),
    "GS177": (("linuxcnc", "rs274"), "%\n" + TOOL + CUT + "%", "%"),
    "GS177 end": (("grbl",), "S5000 M3\n" + CUT.rstrip(), "G0 Z50."),
    "GS193": (("linuxcnc", "rs274"), "M6\nS5000 M3\n" + CUT + "M5\nM30", "M6"),
    "GS197": (ALL[:1] + ALL[2:], "S5000 M3\n" + CUT + "G0 X--5\nM5\nM30", "X--5"),
}
EACH = [(name, dialect) for name, (dialects, _, _) in CASES.items() for dialect in dialects]


@pytest.mark.parametrize(("name", "dialect"), EACH, ids=lambda value: value.replace(" ", "-"))
def test_a_warning_at_its_place(name: str, dialect: str) -> None:
    _, text, words = CASES[name]
    head = "G21 G90 G17 G94\n"
    program = text.replace("%\n", "%\n" + head, 1) if text.startswith("%") else head + text
    source = SourceText("part.nc", (program + "\n").encode())
    reading = interpret(source, Settings(dialect=dialect, tool_table=TOOLS))
    assert list(reading)
    shown = "\n".join(as_text(f, reading.sources) for f in reading.findings)

    assert reading.failed is None, shown
    (finding,) = [f for f in reading.findings if f.level > Severity.NOTE]
    assert (finding.code, finding.level) == (name[:5], Severity.WARNING), shown
    span = finding.span
    assert source.line(span.line)[span.column - 1 : span.end_column - 1] == words, shown
    assert finding.hint

"""The control's tool table: numbers, pockets, offsets and diameters, and the file form of LinuxCNC."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import field

from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.frozen import frozen
from gcodesim.units import DEG, INCH, MM

# X Y Z A B C U V W: lengths [m], angles [rad]
Offset = tuple[float, float, float, float, float, float, float, float, float]

NO_OFFSET: Offset = (0.0,) * 9

_ENTRY = re.compile(r"([A-Za-z])([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?=\s|$)")
_AXES = "XYZABCUVW"


@frozen
class ToolEntry:
    """One tool: `offset` for X Y Z A B C U V W [m, rad], `diameter` [m], lathe angles [rad]."""

    number: int
    pocket: int = 0
    offset: Offset = NO_OFFSET
    diameter: float = 0.0
    front_angle: float = 0.0
    back_angle: float = 0.0
    orientation: int = 0
    comment: str = ""


@frozen(kw_only=False)
class ToolTable(Mapping[int, ToolEntry]):
    """Tools by number."""

    entries: Mapping[int, ToolEntry] = field(default_factory=dict)

    def __getitem__(self, number: int) -> ToolEntry:
        return self.entries[number]

    def __iter__(self) -> Iterator[int]:
        return iter(sorted(self.entries))

    def __len__(self) -> int:
        return len(self.entries)

    @staticmethod
    def read(source: SourceText, *, inch: bool = False) -> tuple[ToolTable, list[Diagnostic]]:
        """Read a `tool.tbl`: one tool per line, such as `T1 P1 Z50 D6 ;comment`; lengths in mm, or in inches if asked.

        Lines that cannot be read are left out and listed in the findings.
        """
        entries: dict[int, ToolEntry] = {}
        findings: list[Diagnostic] = []
        for line, text in enumerate(source.lines, 1):
            words, _, comment = text.partition(";")
            if not words.strip():
                continue
            try:
                entry = _read_entry(words, comment.strip(), INCH if inch else MM)
            except ValueError as problem:
                findings.append(
                    Diagnostic(
                        code="GS020",
                        message=str(problem),
                        span=Span.of_line(source.name, line, words),
                        hint="a line reads T1 P1 Z50.0 D6.0 ;6 mm end mill",
                    )
                )
                continue
            if entry.number in entries:
                findings.append(
                    Diagnostic(
                        code="GS020",
                        message=f"tool T{entry.number} stands twice in the table; the first line counts",
                        span=Span.of_line(source.name, line, words),
                    )
                )
                continue
            entries[entry.number] = entry
        return ToolTable(entries), findings


def _read_entry(words: str, comment: str, unit: float) -> ToolEntry:
    values: dict[str, float] = {}
    for word in words.split():
        match = _ENTRY.fullmatch(word)
        if match is None:
            raise ValueError(f"`{word}` is no word of a tool table")
        letter = match[1].upper()
        if letter not in "TPDIJQ" + _AXES:
            raise ValueError(f"a tool table has no {letter} word")
        if letter in values:
            raise ValueError(f"{letter} stands twice")
        values[letter] = float(match[2])
    if "T" not in values:
        raise ValueError("the line has no T word")
    if not values["T"].is_integer() or values["T"] < 0:
        raise ValueError("a tool number is a whole number, 0 or more")
    offset = tuple(values.get(axis, 0.0) * (DEG if axis in "ABC" else unit) for axis in _AXES)
    return ToolEntry(
        number=int(values["T"]),
        pocket=int(values.get("P", 0.0)),
        offset=offset,  # type: ignore[arg-type]
        diameter=values.get("D", 0.0) * unit,
        front_angle=values.get("I", 0.0) * DEG,
        back_angle=values.get("J", 0.0) * DEG,
        orientation=int(values.get("Q", 0.0)),
        comment=comment,
    )

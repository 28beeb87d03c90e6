"""What a program needs of a cell, for somebody who has none yet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from gcodesim.canon.systems import name_of_system
from gcodesim.starter.first_cell import FirstCell, FirstTool
from gcodesim.starter.lathe_cell import LatheCell
from gcodesim.starter.printer_cell import PrinterCell
from gcodesim.units import INCH, MM


def needs_of(cell: FirstCell | PrinterCell | LatheCell) -> list[tuple[str, str]]:
    """Rows of name and text: dialect, tools, stock, travel; what is only a guess says so."""
    if isinstance(cell, PrinterCell | LatheCell):
        return cell.needs
    return [
        ("dialect", f"{cell.seen.dialect} ({cell.seen.why})"),
        *_tools(cell),
        *_stock(cell),
        *_travel(cell),
    ]


def guesses_of(cell: FirstCell | PrinterCell | LatheCell) -> list[str]:
    """What in the cell is guessed, since the program does not tell: `the stock`, `the diameter of T2`."""
    if isinstance(cell, PrinterCell | LatheCell):
        return cell.guesses
    guessed = [] if cell.told_stock or not cell.boxes else ["the stock"]
    guessed += ["the material"] if cell.boxes else []
    guessed += ["the beam"] if cell.beam is not None else []
    return [*guessed, *(f"the diameter of T{tool.scanned.number}" for tool in cell.tools if tool.guessed)]


def _tools(cell: FirstCell) -> Iterator[tuple[str, str]]:
    for place, tool in enumerate(cell.tools):
        yield "" if place else "tools", _tool(cell, tool)
    if cell.beam is not None:
        yield "tools", f"a {cell.beam.kind} ({cell.beam.why})"
    elif not cell.tools:
        yield "tools", "none is called"


def _tool(cell: FirstCell, tool: FirstTool) -> str:
    told, (unit, name) = tool.scanned, _unit(cell)
    size = f"{round(tool.diameter / unit, 4):g} {name}"
    where = f"line {told.line}" if told.line else "it is in the spindle at the start"
    kind = told.type.replace("_", " ")
    return f"T{told.number} {kind}, diameter {f'not told, perhaps {size}' if tool.guessed else size} ({where})"


def _stock(cell: FirstCell) -> Iterator[tuple[str, str]]:
    source = f"from line {cell.told_stock}" if cell.told_stock else "at least, by what is cut"
    for place, (index, box) in enumerate(cell.boxes.items()):
        yield "" if place else "stock", f"{_ranges(cell, *box)} in {name_of_system(index)} ({source})"
    if not cell.boxes:
        yield "stock", "nothing is fed into a depth"


def _travel(cell: FirstCell) -> Iterator[tuple[str, str]]:
    for place, (index, reach) in enumerate(cell.seen.systems.items()):
        yield "" if place else "travel", f"{_ranges(cell, *reach.all)} in {name_of_system(index)}"
    if cell.seen.machine is not None:
        yield "", f"{_ranges(cell, *cell.seen.machine)} of the machine (G53)"
    if cell.seen.rotary:
        yield "", f"rotary axes {', '.join(cell.seen.rotary)}"


def _ranges(cell: FirstCell, low: Sequence[float] | Any, high: Sequence[float] | Any) -> str:
    unit, name = _unit(cell)
    texts = [
        f"{letter} {round(float(a) / unit, 3) + 0.0:g} to {round(float(b) / unit, 3) + 0.0:g}"
        for letter, a, b in zip("XYZ", low, high, strict=False)
    ]
    return f"{', '.join(texts)} {name}"


def _unit(cell: FirstCell) -> tuple[float, str]:
    return (INCH, "in") if cell.found.inch else (MM, "mm")

"""Commands that need a cell and were given none, or `auto`: what the program says about the cell that it needs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from gcodesim.cell import LoadedCell, read_cell
from gcodesim.cli.exits import UsageError
from gcodesim.cli.options import AUTO
from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.diagnostics.plain import one_line
from gcodesim.files.output_folder import CELL_NAME
from gcodesim.starter.first_cell import FirstCell, NoCellError, first_cell
from gcodesim.starter.lathe_cell import LatheCell
from gcodesim.starter.needs import guesses_of, needs_of
from gcodesim.starter.printer_cell import PrinterCell


def needs_text(program: SourceText, command: str) -> str:
    """Several lines: what a cell for the program has to have, and the two ways to one."""
    name = one_line(program.name)
    rows = needs_of(_first_cell(program))
    width = max(len(row[0]) for row in rows)
    return "\n".join(
        [
            f"{name} needs a cell (--cell): machine, tools and stock. It asks for",
            *(f"  {what.ljust(width)}  {one_line(text)}" for what, text in rows),
            f"`gcodesim init DIR --from {name}` writes such a cell, to look at and to change;",
            f"`{command} {name} --cell auto` uses it as it is, with all its guesses",
        ]
    )


def made_cell(program: SourceText, folder: Path | None) -> LoadedCell:
    """The cell that `init --from` would write, with a note that tells what of it is guessed.

    `folder` is where a run will write it; without one it is called `auto`. UsageError for a program that no dialect
    can read.
    """
    first = _first_cell(program)
    name = str(AUTO) if folder is None else CELL_NAME
    loaded = read_cell(SourceText(name, first.text()), (folder or Path()) / name)
    guesses = guesses_of(first)
    told = f"; guessed: {', '.join(guesses)}" if guesses else ""
    loaded.findings.add(
        Diagnostic(
            code="GS752",
            span=Span(program.name),
            message=f"the cell was made from the program{told}",
            hint=f"a run writes it as `{CELL_NAME}` into its folder; check it, and name it with `--cell` from then on",
        )
    )
    return replace(loaded, made=True)


def _first_cell(program: SourceText) -> FirstCell | PrinterCell | LatheCell:
    try:
        return first_cell(program)
    except NoCellError as reason:
        raise UsageError(str(reason)) from None

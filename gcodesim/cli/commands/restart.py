"""`gcodesim restart PROGRAM --from-line N`: the program from a line on, behind the preamble that this needs."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import UsageError, status_of
from gcodesim.cli.options import add_cell, add_from_line, add_language, add_program


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "restart",
        help="the program from a line on, with the preamble that a control needs for it",
        description="Write the program from a line on, as after a broken tool. A preamble brings the control into the "
        "state of that line: units, plane, offsets, variables, tool and length, spindle, coolant, outputs; then up, "
        "across and down to where the tool was. Lines keep their numbers. `gcodesim run --from-line` simulates it.",
    )
    add_program(parser)
    add_from_line(parser, required=True, says="the first line that is to be executed again")
    add_cell(parser, required=False)
    add_language(parser)
    parser.add_argument("-o", "--out", type=Path, metavar="FILE", help="the new program (default: standard output)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim import canon
    from gcodesim.cli.language import reading_of
    from gcodesim.cli.output import note, print_findings
    from gcodesim.files.whole_file import write_whole
    from gcodesim.motion import build_tool_path
    from gcodesim.restart import restart_of
    from gcodesim.restart.program import reading_up_to

    reading = reading_of(arguments, arguments.program)
    if reading.run is None:
        print_findings(reading.findings(), reading.sources, sys.stderr)
        return status_of(reading.findings(), "error")
    program, line = reading.program, arguments.from_line
    if line > len(program.lines):
        raise UsageError(f"--from-line {line}: {arguments.program} has {len(program.lines)} lines")
    before = reading_up_to(program, line, reading.run.settings)
    events = list(before)
    path = build_tool_path(events, reading.run.settings.start, path_control=None, tilts=None)
    others = [event for event in events if not isinstance(event, canon.Move)]
    made = restart_of(program, line, before, path, others)
    failed = [before.failed] if before.failed is not None and before.halted is None else []
    print_findings([*failed, *made.findings], {**reading.sources, program.name: program}, sys.stderr)
    if made.program is not None and arguments.out is None:
        sys.stdout.write(made.program.text)
    elif made.program is not None:
        try:
            write_whole(arguments.out, made.program.raw)
        except OSError as error:
            raise UsageError(f"{arguments.out} cannot be written: {error.strerror}") from None
        moved = len(made.program.lines) - len(program.lines)
        note(f"wrote {arguments.out}" + (f"; line {line} is line {line + moved} there" if moved else ""))
    return status_of([*failed, *made.findings], "error")

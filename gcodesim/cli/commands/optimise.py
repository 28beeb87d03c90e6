"""`gcodesim optimise PROGRAM --cell CELL --limit 'force=400 N'`: the program with feeds that keep to limits."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.options import add_cell, add_format, add_program, read_source

_NAMES = ("force", "peak-force", "torque", "power", "chip", "deflection")


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "optimise",
        help="feeds that keep force, power, chips or the bend of the tool within limits",
        description="Run a program, lower the feed of each line that is above a limit until it is not, and write the "
        "program with these F words. Nothing else in it is changed.",
        epilog=f"limits: {', '.join(_NAMES)}; force, torque and power are means over a revolution",
    )
    add_program(parser)
    add_cell(parser, required=False)
    parser.add_argument(
        "--limit",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="such as force='400 N'; may be given several times",
    )
    parser.add_argument(
        "--raise",
        dest="most",
        type=float,
        default=1.0,
        metavar="FACTOR",
        help="feeds of lines that are below all limits may rise by this factor (default 1: they stay)",
    )
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FILE", help="the new program; without it only what would change is said"
    )
    add_format(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cell import load_cell
    from gcodesim.cli.output import note
    from gcodesim.files.whole_file import write_whole
    from gcodesim.jobs.job import Options
    from gcodesim.optimise import CannotOptimiseError, limit_of, optimise_feeds

    if arguments.cell is None:
        raise UsageError("forces depend on the cell: name it by --cell")
    if not arguments.limit:
        raise UsageError("what is the limit? for example --limit force='400 N'")
    if not 1.0 <= arguments.most <= 100.0:
        raise UsageError("--raise is a factor from 1 to 100")
    program = read_source(arguments.program, "program")
    read_source(arguments.cell, "cell")
    loaded = load_cell(arguments.cell, arguments.allow_path, allow_code=arguments.allow_code)
    for finding in loaded.findings:
        if loaded.cell is None:
            raise UsageError(f"{arguments.cell}: {finding.code}: {finding.message}")
    try:
        limits = [limit_of(text) for text in arguments.limit]
        found = optimise_feeds(program, loaded, limits, Options(), most=arguments.most, said=note)
    except CannotOptimiseError as reason:
        raise UsageError(str(reason)) from None
    if arguments.out is not None:
        write_whole(arguments.out, found.program.raw)
    if arguments.format == "json":
        said = {
            "schema": "gcodesim-optimise/1",
            "loads": {
                limit.name: {
                    "limit": limit.shown(limit.value),
                    "before": limit.shown(found.before[limit.name]),
                    "after": limit.shown(found.after[limit.name]),
                }
                for limit in limits
            },
            "time_s": {"before": found.time_before, "after": found.time_after},
            "changed_lines": list(found.changed),
            "lines_above": list(found.over),
            "lines_out_of_reach": list(found.beyond),
            "lines_kept": list(found.kept),
        }
        print(json.dumps(said, indent=2))
    else:
        for limit in limits:
            before, after = limit.shown(found.before[limit.name]), limit.shown(found.after[limit.name])
            print(f"{limit.name}: {before} before, {after} after, limit {limit.shown(limit.value)}")
        print(f"time: {found.time_before:.1f} s before, {found.time_after:.1f} s after")
        print(f"lines changed: {len(found.changed)}")
        groups = {
            "above a limit": found.over,
            "above it also at a tenth of their feed, which is left as it was": found.beyond,
            "with a feed that cannot be written": found.kept,
        }
        for what, lines in groups.items():
            if lines:
                print(f"lines {what}: {', '.join(map(str, lines[:20]))}{' …' if len(lines) > 20 else ''}")
    return FINDINGS if found.over else OK

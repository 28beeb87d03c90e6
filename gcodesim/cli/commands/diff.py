"""`gcodesim diff OLD NEW`: what changed in meaning between two programs, runs, logs or folders."""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.moments import reads_logs
from gcodesim.cli.options import add_allow_code, add_tolerances, read_tolerances

if TYPE_CHECKING:
    from gcodesim.regress import Comparison
    from gcodesim.regress.tolerance import Tolerances

_DESCRIPTION = """Compare by quantity and tolerance, never as text: moves that came, went or changed, times, forces,
removed volume, the surface and its place, findings new and gone. Numbering, comments, blanks and number formats do not
count. OLD and NEW are programs (with --cell both are run), folders of programs, folders that `run` wrote, results.json,
logs (.mcap) or accepted results (.golden.json). Status 1 when anything differs beyond tolerance."""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "diff", help="what changed in meaning between two programs, runs or logs", description=_DESCRIPTION
    )
    parser.add_argument("old", type=Path, metavar="OLD", help="the earlier program, folder, results or log")
    parser.add_argument("new", type=Path, metavar="NEW", help="the later one")
    parser.add_argument("--cell", type=Path, metavar="CELL", help="run both programs in this cell")
    parser.add_argument("--old-cell", type=Path, metavar="CELL", help="run OLD in this cell, NEW in that of --cell")
    parser.add_argument(
        "--allow-path", type=Path, action="append", default=[], metavar="DIR", help="as for `run`; may be repeated"
    )
    add_allow_code(parser)
    add_tolerances(parser)
    parser.add_argument(
        "--format",
        choices=("text", "json", "markdown"),
        default="text",
        help="text for people (default), JSON for programs, Markdown for a pull request",
    )
    parser.add_argument(
        "--html",
        type=Path,
        metavar="FILE",
        help="besides, write a page that replays both runs side by side and lists what differs",
    )
    parser.set_defaults(run=reads_logs(run))


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.options import read_source
    from gcodesim.regress.sides import SideError, is_output

    tolerances = read_tolerances(arguments)
    for cell in (arguments.cell, arguments.old_cell):
        if cell is not None:
            read_source(cell, "cell")
    old, new = arguments.old, arguments.new
    try:
        if old.is_dir() and new.is_dir() and not is_output(old) and not is_output(new):
            if arguments.html is not None:
                raise UsageError("--html shows one pair of runs: name two programs, logs or folders of one run")
            return _folders(arguments, tolerances)
        with tempfile.TemporaryDirectory() as folder:
            # what the page replays has to be logged
            outs = None if arguments.html is None else (Path(folder) / "old", Path(folder) / "new")
            comparison = _compared(old, new, arguments, tolerances, outs)
            if outs is not None:
                _write_page(comparison, arguments, outs)
    except SideError as error:
        raise UsageError(str(error)) from None
    _print(comparison, f"{old} → {new}", arguments.format)
    return OK if comparison.same else FINDINGS


def _compared(
    old: Path, new: Path, arguments: argparse.Namespace, tolerances: Tolerances, outs: tuple[Path, Path] | None = None
) -> Comparison:
    from gcodesim.regress.sides import compare_sides, facts_at

    old_cell = arguments.old_cell or arguments.cell
    old_out, new_out = outs or (None, None)
    before = facts_at(old, old_cell, arguments.allow_path, out=old_out, allow_code=arguments.allow_code)
    after = facts_at(new, arguments.cell, arguments.allow_path, out=new_out, allow_code=arguments.allow_code)
    return compare_sides(before, after, tolerances)


def _write_page(comparison: Comparison, arguments: argparse.Namespace, outs: tuple[Path, Path]) -> None:
    from gcodesim.cli.moments import open_recording
    from gcodesim.cli.output import note
    from gcodesim.files.whole_file import write_whole
    from gcodesim.regress import show
    from gcodesim.regress.sides import log_of
    from gcodesim.report.libraries import LibraryMissingError
    from gcodesim.report.page import Difference, write_page

    recordings = []
    for side, out in zip((arguments.old, arguments.new), outs, strict=True):
        log = log_of(side, out)
        if log is None:
            raise UsageError(f"--html replays runs, and {side} has no log: name its folder, or a program and --cell")
        recordings.append(open_recording(side if side.is_dir() else log))
    differences = [
        Difference(
            kind=kind,
            lines=entry.lines,
            old=None if entry.old is None else (entry.old.file, entry.old.line),
            new=None if entry.new is None else (entry.new.file, entry.new.line),
        )
        for kind, entries in show.sections(comparison)
        for entry in entries
    ]
    names = [str(path) for path in (arguments.old, arguments.new)]
    try:
        page = write_page(recordings, names, f"{names[0]} → {names[1]}", (show.summary(comparison), differences))
        write_whole(arguments.html, page.encode())
    except LibraryMissingError as reason:
        raise UsageError(str(reason)) from None
    except OSError as error:
        raise UsageError(f"{arguments.html} cannot be written: {error.strerror}") from None
    note(f"wrote {arguments.html}; open it in a browser")


def _print(comparison: Comparison, title: str, form: str) -> None:
    from gcodesim.cli.output import print_json
    from gcodesim.regress import show

    if form == "json":
        print_json(show.as_json(comparison))
    elif form == "markdown":
        print(show.as_markdown(comparison, title), end="")
    else:
        for line in show.comparison_lines(comparison):
            print(line)
        print(show.summary(comparison))


def _folders(arguments: argparse.Namespace, tolerances: Tolerances) -> int:
    """Programs of two folders by their names; runs of programs by the names of their folders."""
    from gcodesim.cli.output import print_json
    from gcodesim.regress import show
    from gcodesim.regress.sides import members_of

    before, after = members_of(arguments.old), members_of(arguments.new)
    if not before and not after:
        raise UsageError(f"there are neither programs nor results in {arguments.old} and {arguments.new}")
    names = sorted({*before, *after})
    lonely = {name: "only in the old folder" if name in before else "only in the new folder" for name in names}
    compared = {}
    for name in names:
        if name in before and name in after:
            compared[name] = _compared(before[name], after[name], arguments, tolerances)
            del lonely[name]
    if arguments.format == "json":
        print_json(
            {
                "same": not lonely and all(one.same for one in compared.values()),
                "programs": {name: show.as_json(one) for name, one in compared.items()},
                "only_old": [name for name in lonely if name in before],
                "only_new": [name for name in lonely if name in after],
            }
        )
    else:
        for name in names:
            if name in lonely:
                print(f"{name}: {lonely[name]}")
            elif not compared[name].same:
                if arguments.format == "text":
                    print(f"{name}:")
                _print(compared[name], name, arguments.format)
                print()
        changed = sum(not one.same for one in compared.values()) + len(lonely)
        equal = len(names) - changed
        if changed:
            print(f"{changed} of {len(names)} differ")
        else:
            print(f"{show.NO_DIFFERENCE}, in {equal} program{'' if equal == 1 else 's'}")
    return OK if not lonely and all(one.same for one in compared.values()) else FINDINGS

"""`gcodesim info LOG`: what a log is, from what it came, whether it is whole."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import OK, UsageError


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "info",
        help="what a log is, from what it came, whether it is whole",
        description="Say what a log holds: program, cell, duration, events, topics, attached files; "
        "and whether it is whole or was cut off.",
    )
    parser.add_argument(
        "log", type=Path, metavar="LOG", help="a run.mcap, or the run.mcap.part of a run that was killed"
    )
    parser.add_argument(
        "--extract",
        type=Path,
        metavar="DIR",
        help="also write the attached files there: program, cell, layout.json for the viewer",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.output import print_table
    from gcodesim.log.logfile import LogReadError
    from gcodesim.log.reader import summary

    try:
        facts = summary(arguments.log)
    except FileNotFoundError:
        raise UsageError(f"log {arguments.log} is not there") from None
    except (LogReadError, OSError) as error:
        raise UsageError(f"log {arguments.log} cannot be read: {error}") from None
    print(f"{arguments.log.name}: {facts.verdict}")
    if facts.problem:
        print(f"  {facts.problem}")
    rows = [[name, facts.run[name]] for name in ("program", "cell", "world", "gcodesim") if name in facts.run]
    rows += [["duration", f"{facts.duration_ns * 1e-9:.3f} s"]]
    rows += [["events", ", ".join(f"{count} {name}" for name, count in facts.events.items())]]
    rows += [["attachments", ", ".join(facts.attachments)]]
    width = max(len(row[0]) for row in rows)
    for name, text in rows:
        print(f"  {name.ljust(width)}  {text}")
    if arguments.extract is not None:
        _extract(arguments.log, arguments.extract)
    print()
    print_table([[topic.name, topic.schema, str(topic.count), f"{topic.rate:.4g}/s"] for topic in facts.topics])
    return OK


def _extract(log: Path, folder: Path) -> None:
    """Write every attachment of `log` into `folder`; a file that is there already stays, and is an error."""
    from gcodesim.log.logfile import LogFile

    opened = LogFile.open(log)
    # a name may come from anywhere: only its last part counts
    files = {Path(name).name: name for name in opened.attachments}
    present = [name for name in files if (folder / name).exists()]
    if present:
        raise UsageError(f"{folder / present[0]} is there already; nothing was written")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for own, name in files.items():
            (folder / own).write_bytes(opened.attachment(name))
    except OSError as error:
        raise UsageError(f"{folder} cannot be written: {error.strerror}") from None
    print(f"wrote {', '.join(files)} into {folder}")

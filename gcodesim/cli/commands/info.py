"""`gcodesim info LOG`: what a log is, from what it came, whether it is whole."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import OK, UsageError


def add_parser(commands: Any) -> None:
    parser = commands.add_parser("info", help="what a log is, from what it came, whether it is whole")
    parser.add_argument("log", type=Path, metavar="LOG", help="a run.mcap, also one without an end")
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
    print()
    print_table([[topic.name, topic.schema, str(topic.count), f"{topic.rate:.4g}/s"] for topic in facts.topics])
    return OK

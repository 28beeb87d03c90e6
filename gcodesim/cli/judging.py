"""Options that decide which findings count: the day for dated suppressions, the baseline of known findings."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

from gcodesim.cli.exits import OK, UsageError, status_of
from gcodesim.cli.options import read_source
from gcodesim.diagnostics import Diagnostic, Severity, SourceText

if TYPE_CHECKING:
    from gcodesim.regress.baseline import Baseline


def add_today(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--today",
        type=_day,
        metavar="DAY",
        help="the day (2027-03-01) with which `until:` of suppressions is compared (default: the system's)",
    )


def _day(text: str) -> date:
    try:
        return date.fromisoformat(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"a day such as 2027-03-01 is expected, not {text}") from None


def add_baseline(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--baseline", type=Path, metavar="FILE", help="findings in this file are known and do not fail; new ones do"
    )
    parser.add_argument(
        "--write-baseline", type=Path, metavar="FILE", help="write all findings that would fail into FILE; status 0"
    )


def read_baseline(arguments: argparse.Namespace) -> Baseline | None:
    """The baseline that the command line names; UsageError when it cannot be read."""
    from gcodesim.regress.baseline import Baseline, BaselineError

    if arguments.baseline is None:
        return None
    try:
        return Baseline.read(read_source(arguments.baseline, "baseline"))
    except BaselineError as error:
        raise UsageError(f"baseline {arguments.baseline} cannot be read: {error}") from None


def write_baseline(path: Path, text: str) -> None:
    """Write a baseline file and say so; UsageError when that fails."""
    from gcodesim.cli.output import note
    from gcodesim.whole_file import write_whole

    try:
        write_whole(path, text.encode())
    except OSError as error:
        raise UsageError(f"baseline {path} cannot be written: {error.strerror}") from None
    note(f"wrote {path}: with --baseline {path} its findings fail nothing")


@dataclass(frozen=True, slots=True, kw_only=True)
class Settled:
    """What findings come to: those to be shown, lines about the baseline, the exit status."""

    shown: list[Diagnostic]
    remarks: list[str]
    status: int


def settle(findings: Iterable[Diagnostic], arguments: argparse.Namespace, sources: Mapping[str, SourceText]) -> Settled:
    """Leave out what the baseline knows; write a new baseline where that is asked for."""
    found = list(findings)
    baseline = read_baseline(arguments)

    def text(file: str, line: int) -> str:
        return sources[file].line(line) if file in sources else ""

    shown, remarks = found, []
    if baseline is not None:
        known = [one for one in found if _is_severe(one, arguments.fail_on) and baseline.knows(one, text)]
        shown = [one for one in found if not any(one is other for other in known)]
        if known:
            remarks.append(f"{len(known)} finding{'' if len(known) == 1 else 's'} in the baseline, not shown")
        remarks += [f"gone from the baseline: {entry}" for entry in baseline.gone]
    status = status_of(shown, arguments.fail_on)
    if arguments.write_baseline is not None:
        from gcodesim.regress.baseline import baseline_text

        severe = (one for one in found if _is_severe(one, arguments.fail_on))
        write_baseline(arguments.write_baseline, baseline_text(severe, text))
        status = OK
    return Settled(shown=shown, remarks=remarks, status=status)


def _is_severe(finding: Diagnostic, fail_on: str) -> bool:
    return fail_on != "never" and finding.level >= Severity[fail_on.upper()]

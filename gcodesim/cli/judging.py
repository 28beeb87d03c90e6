"""Judges findings of programs: which of them count, the day for dated suppressions, the baseline of known findings."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import OK, UsageError, status_of
from gcodesim.cli.formats import wants_formats, write_formats
from gcodesim.cli.options import read_source
from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.diagnostics.text import shown_name
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.regress import CaseVerdict, SuiteVerdict
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
    """The baseline that the command line names; UsageError if it cannot be read."""
    if arguments.baseline is None:
        return None
    from gcodesim.regress.baseline import Baseline, BaselineError

    try:
        return Baseline.read(read_source(arguments.baseline, "baseline"))
    except BaselineError as error:
        raise UsageError(f"baseline {arguments.baseline} cannot be read: {error}") from None


def write_baseline(path: Path, text: str) -> None:
    """Write a baseline file and say so; UsageError if that fails."""
    from gcodesim.cli.output import note
    from gcodesim.files.whole_file import write_whole

    try:
        write_whole(path, text.encode())
    except OSError as error:
        raise UsageError(f"baseline {path} cannot be written: {error.strerror}") from None
    note(f"wrote {path}: with --baseline {path} its findings fail nothing")


@frozen
class Met:
    """What a command found in one program (or in a cell alone): findings in order, with files as the reader names them.

    `files` finds the paths of those names on demand. `suppressed` has the findings that the cell suppresses, with the
    reason. `setup` names one of several set-ups of a job.
    """

    program: Path
    findings: Sequence[Diagnostic]
    sources: Mapping[str, SourceText]
    files: Callable[[], Mapping[str, Path]]
    cell: Path | None = None
    suppressed: Sequence[tuple[Diagnostic, str]] = ()
    results: Mapping[str, Any] | None = None
    setup: str = ""

    @property
    def name(self) -> str:
        """The name of the program when it is the only one."""
        return self.setup or shown_name(self.program)

    def placed(self, root: Path) -> Met:
        """The same with all files named from `root`."""
        from gcodesim.regress.case import shown_path
        from gcodesim.regress.places import relocated

        files = self.files()
        return replace(
            self,
            findings=[relocated(one, files, root) for one in self.findings],
            suppressed=[(relocated(one, files, root), reason) for one, reason in self.suppressed],
            sources={
                shown_path(files[name], root) if name in files else name: source
                for name, source in self.sources.items()
            },
        )


@frozen
class ShownProgram:
    """A program as shown to people; `findings` are those of `met` that they have to look at."""

    name: str
    met: Met
    findings: Sequence[Diagnostic]


@frozen
class Settled:
    """The judgement: `shown` are the findings that the baseline does not know, `remarks` are about the baseline.

    `verdict` is a suite of all programs of the command; None when neither a format nor a baseline asks for one.
    """

    shown: list[ShownProgram]
    status: int
    remarks: list[str] = field(default_factory=list)
    verdict: SuiteVerdict | None = None


def settle(met: Sequence[Met], arguments: argparse.Namespace) -> Settled:
    """Leave out what the baseline knows; write a new baseline if requested.

    A baseline, like every format, names files from the folder of the run, and so do the findings of several programs.
    The status is also kept in `arguments`, in case nobody reads the output to its end.
    """
    settled = _settled(met, arguments)
    arguments.status = settled.status
    return settled


def _settled(met: Sequence[Met], arguments: argparse.Namespace) -> Settled:
    if len(met) == 1 and not wants_formats(arguments) and arguments.baseline is arguments.write_baseline is None:
        only = ShownProgram(name=met[0].name, met=met[0], findings=met[0].findings)
        return Settled(shown=[only], status=status_of(only.findings, arguments.fail_on))
    from gcodesim.regress.sources import Sources
    from gcodesim.regress.suite import baseline_of, with_baseline
    from gcodesim.regress.verdicts import SuiteVerdict

    root = Path.cwd()
    baseline = read_baseline(arguments)
    placed = [one.placed(root) for one in met]
    cases = [_case(one, arguments.fail_on, root) for one in placed]
    if baseline is not None:
        lines = Sources(root)
        cases = [with_baseline(case, baseline, lines) for case in cases]
    verdict = SuiteVerdict(cases=tuple(cases), gone=() if baseline is None else baseline.gone)
    if arguments.write_baseline is not None:
        write_baseline(arguments.write_baseline, baseline_of(verdict, root))
    known = sum(one.state == "baseline" for case in cases for one in case.found)
    return Settled(
        # one program is shown as the reader names its files, several with their folders
        shown=[_shown(met[0], cases[0], met[0].name)]
        if len(met) == 1
        else [_shown(one, case, case.name) for one, case in zip(placed, cases, strict=True)],
        status=int(verdict.failed and arguments.write_baseline is None) or OK,
        remarks=[
            *([f"{known} finding{'' if known == 1 else 's'} in the baseline, not shown"] if known else []),
            *(f"gone from the baseline: {entry}" for entry in verdict.gone),
        ],
        verdict=verdict,
    )


def print_findings_of(settled: Settled, arguments: argparse.Namespace) -> None:
    """Print the findings of commands that print nothing else: as text, JSON or the requested format."""
    from gcodesim.cli.output import findings_as_json, print_json, print_verdict

    if arguments.format == "json":
        # all of them, even those that a baseline knows
        print_json({"findings": [one for shown in settled.shown for one in findings_as_json(shown.met.findings)]})
    elif arguments.format == "text":
        for shown in settled.shown:
            print_verdict(shown.name, shown.findings, shown.met.sources)
        for remark in settled.remarks:
            print(remark)
    write_formats(settled.verdict, arguments)


def _case(met: Met, fail_on: str, root: Path) -> CaseVerdict:
    """The findings first, in their order, then what is suppressed."""
    from gcodesim.regress.case import shown_path
    from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding

    found = [
        JudgedFinding(finding=one, state="counts" if status_of([one], fail_on) != OK else "told")
        for one in met.findings
    ]
    failed = any(one.state == "counts" for one in found)
    found += [JudgedFinding(finding=one, state="suppressed", reason=reason) for one, reason in met.suppressed]
    name = shown_path(met.program, root)
    return CaseVerdict(
        name=met.setup or name,
        file=name,
        program=name,
        cell=None if met.cell is None else shown_path(met.cell, root),
        status="failed" if failed else "passed",
        found=tuple(found),
        results=met.results,
    )


def _shown(met: Met, case: CaseVerdict, name: str) -> ShownProgram:
    """The findings of `met` that are open in `case`, which has them in the same order."""
    pairs = zip(met.findings, case.found, strict=False)
    findings = [finding for finding, one in pairs if one.state in ("counts", "told")]
    return ShownProgram(name=name, met=met, findings=findings)

"""Many cases: in order or in parallel, with or without stopping at the first failure; always the same verdict."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gcodesim.cell.verdict import REFUSALS
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.diagnostics.plain import lines
from gcodesim.family import ExtensionError, package_at_fault
from gcodesim.frozen import frozen
from gcodesim.regress.case import Case, Collected
from gcodesim.regress.sources import Sources
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding, SuiteVerdict
from gcodesim.regress.workers import in_parallel

if TYPE_CHECKING:
    from gcodesim.regress.baseline import Baseline
    from gcodesim.regress.cache import Cache
    from gcodesim.regress.outcome import Judging
    from gcodesim.scale.hands import Hands

INTERNAL: Final = "GS613"
"""A case that could not be judged because of a fault of gcodesim."""

_OURS: Final = "GS6"  # differences and expectations: no baseline excuses them


@frozen
class Judged:
    """A verdict, and what else the cache has to know."""

    verdict: CaseVerdict
    files: dict[str, Path]
    until: tuple[date, ...] = ()


def judged(case: Case, how: Judging) -> Judged:
    """One case, as a worker runs it."""
    from gcodesim.regress.judge import judge

    try:
        verdict, outcome = judge(case, how)
    except Exception as fault:
        # our fault, or that of a plugin; the other cases still get their verdicts
        return Judged(verdict=_broken(case, how, fault), files={})
    return Judged(verdict=verdict, files=outcome.files, until=outcome.until)


def _broken(case: Case, how: Judging, fault: Exception) -> CaseVerdict:
    """The verdict on a case on which gcodesim itself failed; the traceback of a fault of ours goes to stderr."""
    if isinstance(fault, ExtensionError):
        message, hint = str(fault), "repair or uninstall that package"
    else:
        print(lines("".join(traceback.format_exception(fault))), end="", file=sys.stderr)
        message = f"gcodesim failed on this case: {type(fault).__name__}: {fault}"
        whose = package_at_fault(fault) or "gcodesim"
        hint = f"this is a fault of {whose}; please report it with the trace on stderr, the program and the cell"
    finding = Diagnostic(code=INTERNAL, span=Span(case.file), message=message, hint=hint)
    return CaseVerdict(
        name=case.name,
        file=case.file,
        program=_program(case, how),
        cell=None,
        status="failed",
        found=(JudgedFinding(finding=finding, state="counts"),),
    )


def run_suite(
    collected: Collected,
    how: Judging,
    *,
    jobs: int = 1,
    fail_fast: bool = False,
    cache: Cache | None = None,
    reuse: bool = False,
    baseline: Baseline | None = None,
    hands: Hands | None = None,
    progress: Callable[[CaseVerdict], None] | None = None,
) -> SuiteVerdict:
    """The verdicts on all cases, in their order.

    `jobs` processes share the work, or `hands` do it, which does not show in the verdict. With `fail_fast` all cases
    after the first that fails are `not_run`. `cache` remembers passed cases, and with `reuse` returns them. `baseline`
    lists findings that do not count. `progress` is told each verdict, in order.
    """
    today = how.today or date.today()
    cases = collected.cases
    known = {case.name: cache.find(case, today) if cache is not None and reuse else None for case in cases}
    pending = [case for case in cases if known[case.name] is None]
    if hands is None:
        fresh = in_parallel(judged, pending, how, jobs)
    else:
        from gcodesim.regress.travel import judged_by

        fresh = judged_by(hands, pending, how)
    lines = Sources(how.root)
    verdicts: list[CaseVerdict] = []
    has_failed = False
    try:
        for case in cases:
            verdict = known[case.name]
            if has_failed and fail_fast:
                verdict = CaseVerdict(
                    name=case.name, file=case.file, program=_program(case, how), cell=None, status="not_run"
                )
            elif verdict is None:
                one = next(fresh)
                verdict = one.verdict
                if cache is not None:
                    cache.keep(case, verdict, one.files, one.until, today)
            if baseline is not None:
                verdict = with_baseline(verdict, baseline, lines)
            has_failed |= verdict.status == "failed"
            verdicts.append(verdict)
            if progress is not None:
                progress(verdict)
    finally:
        fresh.close()
    return SuiteVerdict(
        cases=tuple(verdicts),
        found=collected.found,
        gone=() if baseline is None or (has_failed and fail_fast) else baseline.gone,
    )


def _program(case: Case, how: Judging) -> str:
    from gcodesim.regress.case import shown_path

    return shown_path(case.program, how.root)


def with_baseline(verdict: CaseVerdict, baseline: Baseline, lines: Sources) -> CaseVerdict:
    """`verdict` in which findings that `baseline` knows do not count; `lines` are those of the files they name."""
    found = tuple(
        replace(one, state="baseline") if _may_wait(one) and baseline.knows(one.finding, lines.line) else one
        for one in verdict.found
    )
    if verdict.status != "failed" or any(one.state == "counts" for one in found):
        return replace(verdict, found=found)
    return replace(verdict, found=found, status="passed")


def _may_wait(found: JudgedFinding) -> bool:
    code = found.finding.code
    return found.state == "counts" and not code.startswith(_OURS) and code not in REFUSALS


def baseline_of(verdict: SuiteVerdict, root: Path) -> str:
    """The baseline file with all findings that count now, and those of an earlier baseline."""
    from gcodesim.regress.baseline import baseline_text

    findings: list[Diagnostic] = [
        one.finding for case in verdict.cases for one in case.found if one.state == "baseline" or _may_wait(one)
    ]
    return baseline_text(findings, Sources(root).line)

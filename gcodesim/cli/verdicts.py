"""A test run on the screen: what failed and why, then a summary to read in ten seconds."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from gcodesim.cli.colour import coloured, paint_for, painted
from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.plain import one_line
from gcodesim.diagnostics.show import as_text
from gcodesim.formats.text import counting, found_text
from gcodesim.regress.mutants import MutantVerdict
from gcodesim.regress.sources import Sources
from gcodesim.regress.verdicts import NOTHING_ACCEPTED, CaseVerdict, SuiteVerdict

_MOST: Final = 8
"""Findings of a case that are shown without -v."""

_MOST_QUANTITIES: Final = 5
"""Names of quantities that are shown of a change."""

_COLOUR: Final = {"passed": "32", "failed": "31;1", "not_run": "33"}
_WORDS: Final = {"passed": "passed", "failed": "FAILED", "not_run": "not run"}


def print_suite(verdict: SuiteVerdict, root: Path, *, verbose: bool) -> None:
    """Failed cases with their findings, then the summary."""
    sources = Sources(root)
    for one in verdict.found:
        _print(as_text(one.finding, sources, paint_for(sys.stdout)))
    for case in verdict.cases:
        if case.status == "failed" or verbose:
            _print_case(case, sources, verbose=verbose)
    _print_summary(verdict)


def print_mutants(verdicts: Sequence[MutantVerdict], seed: int, *, verbose: bool) -> None:
    """Each change that no case sees, all of them with `verbose`; then the counts."""
    words = {"seen": "seen", "not_seen": "NOT SEEN", "no_effect": "no effect"}
    for one in verdicts:
        if one.fate == "not_seen" or verbose:
            names = [*one.quantities[:_MOST_QUANTITIES], *["…"] * (len(one.quantities) > _MOST_QUANTITIES)]
            what = f": {', '.join(names)}" if names else ""
            print(f"{words[one.fate]} {one.mutant.case.name}")
            print(f"  {one.mutant.file}, {one.mutant.mutation.operator}: {one.mutant.mutation.what}{what}")
    counts = [f"{sum(one.fate == fate for one in verdicts)} {word.lower()}" for fate, word in words.items()]
    print(f"{len(verdicts)} changes drawn with seed {seed}: {', '.join(counts)}")


def _print_case(case: CaseVerdict, sources: Mapping[str, SourceText], *, verbose: bool) -> None:
    _print(f"{_coloured(_WORDS[case.status], case.status)} {one_line(case.name)}{' (unchanged)' * case.unchanged}")
    shown = counting(case)
    if verbose:
        shown += [one for one in case.found if one.state != "counts"]
    least = len(shown) if verbose else _MOST
    for one in shown[:least]:
        _print(textwrap.indent(found_text(one, sources, paint_for(sys.stdout)), "  "))
    if len(shown) > least:
        print(f"  … and {len(shown) - least} more (-v shows all)")
    if shown:
        print()


def _print_summary(verdict: SuiteVerdict) -> None:
    states: list[str] = [one.state for case in verdict.cases for one in case.found]
    for text in verdict.gone:
        print(f"gone from the baseline: {one_line(text)}")
    failed, passed, rest = (len(verdict.with_status(status)) for status in ("failed", "passed", "not_run"))
    unchanged = sum(case.unchanged for case in verdict.cases)
    faults = len(verdict.found)
    parts = [_coloured(f"{faults} fault{'' if faults == 1 else 's'} in test files", "failed")] if faults else []
    parts += [_coloured(f"{failed} failed", "failed")] if failed else [] if faults else ["none failed"]
    parts.append(f"{passed} passed")
    if unchanged:
        parts[-1] += f" ({unchanged} unchanged)"
    if rest:
        parts.append(f"{rest} not run")
    for state, text in (("baseline", "in the baseline"), ("suppressed", "suppressed"), ("expected", "expected")):
        if count := states.count(state):
            parts.append(f"{count} finding{'' if count == 1 else 's'} {text}")
    unaccepted = sum(any(one.finding.code == NOTHING_ACCEPTED for one in case.found) for case in verdict.cases)
    if unaccepted:
        parts.append(f"{unaccepted} without accepted results (`gcodesim accept`)")
    _print(", ".join(parts))
    for case in verdict.with_status("failed"):
        what = list(dict.fromkeys(one.code for one in case.counting))
        quantities = f": {', '.join(case.quantities[:6])}{' …' if len(case.quantities) > 6 else ''}"
        print(f"  {one_line(case.name)}  {' '.join(what)}{quantities if case.quantities else ''}")


def _print(text: str) -> None:
    """Text with our colours."""
    print(text, file=painted(sys.stdout))


def _coloured(text: str, status: str) -> str:
    return coloured(text, _COLOUR[status], sys.stdout)

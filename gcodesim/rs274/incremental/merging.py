"""What a run has counted and found, carried over to a run that goes on from the same state."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gcodesim.diagnostics import Findings
from gcodesim.rs274.told import is_of_many

if TYPE_CHECKING:
    from gcodesim.rs274.executor import Executor


class NotMergeableError(Exception):
    """What comes later is said about a place that only the text before had."""


def carry_over(later: Executor, now: Executor, then: Executor, changed: range) -> None:
    """Give `later`, which the text before reached from `then`, what `now` has found instead; the states are the same.

    Findings of one kind are folded into the first; NotMergeableError where that was in the part that changed, the lines
    with the indices `changed`.
    """
    findings = _findings(later.run.findings, now.run.findings, then.run.findings, changed)
    counts = _counts(later.control.not_simulated, now.control.not_simulated, then.control.not_simulated)
    later.run.findings = findings
    later.control.not_simulated = counts
    if now.run.failed is not None:
        later.run.failed, later.run.failed_line = now.run.failed, now.run.failed_line
    later.told.carry_over(now.told, then.told)


def _findings(later: Findings, now: Findings, then: Findings, changed: range) -> Findings:
    out = now.copy()
    known, before = now.by_key(), then.by_key()
    for key, finding in later.by_key().items():
        more = finding.count - (before[key].count if key in before else 0)
        if more <= 0:
            continue
        if (key in before) != (key in known) or is_of_many(key) or finding.span.line - 1 in changed:
            raise NotMergeableError
        out.add(replace(finding, count=more), key=key)
    return out


def _counts(later: dict[str, Any], now: dict[str, Any], then: dict[str, Any]) -> dict[str, Any]:
    out = dict(now)
    for word, (count, first) in later.items():
        more = count - (then[word][0] if word in then else 0)
        if more <= 0:
            continue
        if (word in then) != (word in now):
            raise NotMergeableError
        out[word] = (now[word][0] + more, now[word][1]) if word in now else (more, first)
    return out

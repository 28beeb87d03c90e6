"""Accepting results: what would be accepted is shown before it is written."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.files.whole_file import write_whole
from gcodesim.frozen import frozen
from gcodesim.regress.case import Case, shown_path
from gcodesim.regress.changes import Comparison
from gcodesim.regress.golden import golden_text
from gcodesim.regress.judge import judge
from gcodesim.regress.outcome import Judging

# what cannot be accepted: it is written by hand, or there is no result
_NOT_TO_ACCEPT: Final = ("GS601", "GS602", "GS608", "GS610", "GS611", "GS612")


@frozen
class Proposal:
    """What accepting a case means. `text` is the new file; None if nothing differs or the case cannot be accepted.

    `comparison` is against what was accepted before, None when there was nothing; `faulty` are findings that the new
    results carry; `against` says why the case cannot be accepted.
    """

    name: str
    path: Path
    shown: str
    text: str | None
    comparison: Comparison | None
    faulty: tuple[Diagnostic, ...]
    against: tuple[Diagnostic, ...]
    results: dict[str, Any] | None
    steps: int


def propose(case: Case, how: Judging) -> Proposal:
    """Run a case and say what accepting it would change."""
    verdict, outcome = judge(case, how)
    against = tuple(one.finding for one in verdict.found if one.finding.code in _NOT_TO_ACCEPT)
    differs = verdict.comparison is None or not verdict.comparison.same
    return Proposal(
        name=case.name,
        path=case.golden,
        shown=shown_path(case.golden, how.root),
        text=golden_text(outcome.facts) if differs and not against else None,
        comparison=verdict.comparison,
        faulty=tuple(
            one.finding
            for one in verdict.found
            if not one.finding.code.startswith("GS6")
            and one.state not in ("expected", "suppressed")
            and one.finding.level > Severity.NOTE
        ),
        against=against,
        results=None if verdict.results is None else dict(verdict.results),
        steps=len(outcome.facts.steps or ()),
    )


def take(proposal: Proposal) -> None:
    """Write the proposal; OSError if the disk does not take it."""
    if proposal.text is not None:
        proposal.path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(proposal.path, proposal.text.encode())

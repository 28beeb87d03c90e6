"""One case as lines for people: its status, what makes it fail, and on request all findings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.plain import one_line
from gcodesim.diagnostics.show import Paint, as_text, unpainted
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding

_ORDER: Final = ("", "GS601", "GS602", "GS603", "GS605", "GS606", "GS604")
_OF_THE_WHOLE: Final = ("GS604", "GS605")


def counting(case: CaseVerdict) -> list[JudgedFinding]:
    """What makes a case fail, in the order of interest: faults, expectations, motion, the rest."""
    return sorted((one for one in case.found if one.state == "counts"), key=lambda one: _rank(one.finding.code))


def _rank(code: str) -> int:
    return _ORDER.index(code) if code in _ORDER else 0


def found_text(found: JudgedFinding, sources: Mapping[str, SourceText], paint: Paint = unpainted) -> str:
    """A finding with its excerpt, and its effect on the verdict where that is not obvious."""
    # the place of a result is that of the first difference in motion, which is quoted above it
    quoted = {} if found.finding.code in _OF_THE_WHOLE else sources
    remark = _remark(found)
    return as_text(found.finding, quoted, paint) + (f"\n  {remark}" if remark else "")


def _remark(found: JudgedFinding) -> str:
    if found.state == "suppressed":
        return f"suppressed: {one_line(found.reason)}"
    if found.state == "counts":
        return one_line(found.reason)
    return "" if found.state == "told" else {"baseline": "in the baseline"}.get(found.state, found.state)

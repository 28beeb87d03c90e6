"""What happens again and again in one place of a program, as in a loop or a cycle, told once."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from gcodesim.diagnostics import Diagnostic, Span


def folded(found: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Findings of one kind in one place as one: how many there were, when the first was, and what the worst says."""
    kept: dict[tuple[str, Span], Diagnostic] = {}
    for finding in found:
        key = (finding.code, finding.span)
        known = kept.get(key)
        if known is None:
            kept[key] = finding
            continue
        worst = max(known, finding, key=lambda each: each.value or 0.0)
        kept[key] = replace(worst, time=known.time, count=known.count + finding.count)
    return list(kept.values())

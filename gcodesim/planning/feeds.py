"""Feeds that no machine, or at least not this one, can run."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from gcodesim.diagnostics import Diagnostic, Findings
from gcodesim.frames import Array
from gcodesim.motion.tool_path import ToolPath
from gcodesim.units import DEG, MINUTE, MM_PER_MINUTE

CRAWL: Final = MM_PER_MINUTE  # in place of a feed of zero
_WORTH_A_NOTE: Final = 0.99  # of the programmed feed


def without_zero_feeds(path: ToolPath, findings: Findings) -> ToolPath:
    """`path` with a crawl where the feed is zero, each such kind of block reported once."""
    rows = np.flatnonzero(~(path.feed > 0.0))
    if not len(rows):
        return path
    stands = path.state_of(int(rows[0])).spindle == 0.0
    cause = "F is 0, or per revolution of a spindle that stands" if stands else "F is 0"
    findings.add(
        Diagnostic(
            code="GS208",
            message=f"feed is 0 mm/min ({cause}), so the move would never end; run at {CRAWL / MM_PER_MINUTE:g} mm/min",
            span=path.span(int(rows[0])),
            hint="program F, and start the spindle before feeds per revolution",
            count=len(np.unique(path.block[rows])),
            value=0.0,
            unit="m/s",
        )
    )
    feed = path.feed.copy()
    feed[rows] = CRAWL
    return replace(path, feed=feed)


def report_fast_feeds(path: ToolPath, possible: Array, findings: Findings) -> None:
    """Note once that feeds are above `possible` (n,) [m/s, rad/s], with the worst case."""
    with np.errstate(invalid="ignore"):
        share = np.where(np.isfinite(path.feed), possible / path.feed, 1.0)
    rows = np.flatnonzero(share < _WORTH_A_NOTE)
    if not len(rows):
        return
    first, worst = int(rows[0]), int(rows[np.argmin(share[rows])])
    unit, factor = ("deg/min", DEG / MINUTE) if path.rotary_feed[first] else ("mm/min", MM_PER_MINUTE)
    findings.add(
        Diagnostic(
            code="GS206",
            message=f"feed {path.feed[first] / factor:.0f} {unit} is above the {possible[first] / factor:.0f} {unit}"
            " that the axes allow in this direction",
            span=path.span(first),
            hint=f"worst in line {path.span(worst).line}: {100.0 * share[worst]:.0f} % of the programmed feed",
            count=len(np.unique(path.block[rows])),
            value=float(path.feed[first]),
            limit=float(possible[first]),
            unit="rad/s" if path.rotary_feed[first] else "m/s",
        )
    )

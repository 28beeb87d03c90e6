"""Feeds that no machine, or at least not this one, can run."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.canon import AXIS_LETTERS
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Array
from gcodesim.motion.tool_path import LINE, ToolPath
from gcodesim.planning.moments import OnBlock, PathFindings
from gcodesim.units import DEG, MINUTE, MM, MM_PER_MINUTE, RPM

CRAWL: Final = MM_PER_MINUTE  # in place of a feed of zero
_WORTH_A_NOTE: Final = 0.99  # of the programmed feed
_THREADS: Final = frozenset(("G32", "G33", "G33.1", "G76", "G84"))
"""Motion words of moves that keep step with the spindle."""


def without_zero_feeds(path: ToolPath, findings: PathFindings) -> ToolPath:
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
            count=len(distinct(path.block[rows])),
            value=0.0,
            unit="m/s",
        ),
        at=OnBlock(int(path.block[rows[0]])),
    )
    feed = path.feed.copy()
    feed[rows] = CRAWL
    return replace(path, feed=feed)


def report_fast_feeds(path: ToolPath, possible: Array, speed: Array, findings: PathFindings) -> None:
    """Note once that feeds are above `possible` (n,) [m/s, rad/s], with the worst case; a thread cannot run slower.

    `speed` (6,) [m/s, rad/s] is what each axis can do.
    """
    with np.errstate(invalid="ignore"):
        share = np.where(np.isfinite(path.feed), possible / path.feed, 1.0)
    slow = share < _WORTH_A_NOTE
    if not slow.any():
        return
    threads = np.array([state.word in _THREADS for state in path.states])[path.state]
    _report_threads(path, possible, speed, np.flatnonzero(slow & threads), findings)
    rows = np.flatnonzero(slow & ~threads)
    if not len(rows):
        return
    first, worst = int(rows[0]), int(rows[np.argmin(share[rows])])
    unit, factor = ("deg/min", DEG / MINUTE) if path.rotary_feed[first] else ("mm/min", MM_PER_MINUTE)
    findings.add(
        Diagnostic(
            code="GS206",
            message=f"feed {path.feed[first] / factor:.0f} {unit} is above the {possible[first] / factor:.0f} {unit}"
            f" that the axes allow in this direction{_hurried(path, first, speed)}",
            span=path.span(first),
            hint=f"worst in line {path.span(worst).line}: {100.0 * share[worst]:.0f} % of the programmed feed",
            count=len(distinct(path.block[rows])),
            value=float(path.feed[first]),
            limit=float(possible[first]),
            unit="rad/s" if path.rotary_feed[first] else "m/s",
        ),
        at=OnBlock(int(path.block[first])),
    )


def _hurried(path: ToolPath, row: int, speed: Array) -> str:
    """In words, the axis that holds a straight move up: what it would need, and what it can do. Arcs have none."""
    if path.kind[row] != LINE:
        return ""
    step = np.abs(path.end[row] - path.start[row])
    axis = int(np.argmax(step / speed))
    size = step[:3] if step[:3].any() else step
    needed = float(path.feed[row] * step[axis] / np.sqrt(np.sum(np.square(size))))
    unit, factor = ("mm/min", MM_PER_MINUTE) if axis < 3 else ("deg/min", DEG / MINUTE)
    return f": {AXIS_LETTERS[axis]} would need {needed / factor:.0f} {unit} and can do {speed[axis] / factor:.0f}"


def _report_threads(
    path: ToolPath, possible: Array, speed: Array, rows: NDArray[np.intp], findings: PathFindings
) -> None:
    """GS209 for threads in `rows` whose pitch times speed is more than the axes can do."""
    if not len(rows):
        return
    first = int(rows[0])
    wanted, best = float(path.feed[first]), float(possible[first])
    turns = abs(path.state_of(first).spindle)
    pitch = wanted / turns * 2.0 * np.pi if turns > 0.0 else 0.0
    findings.add(
        Diagnostic(
            code="GS209",
            message=f"a pitch of {pitch / MM:.4g} mm at {turns / RPM:.0f} rpm needs {wanted / MM_PER_MINUTE:.0f} mm/min"
            f"; the axes allow {best / MM_PER_MINUTE:.0f} mm/min here{_hurried(path, first, speed)}",
            span=path.span(first),
            hint=f"at most {best / wanted * turns / RPM:.0f} rpm",
            count=len(distinct(path.block[rows])),
            value=wanted,
            limit=best,
            unit="m/s",
        ),
        at=OnBlock(int(path.block[first])),
    )

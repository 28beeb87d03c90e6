"""The search for feeds: a run tells the greatest load of each line; its feed is changed until the load is the limit.

A load grows with the feed as a power of it, about 1 - m_c for forces and 1 for chips; the power of a line is that of
its last two runs. Only feeds are changed, so the path, and with it the part, stays the same.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim import simulation
from gcodesim.arithmetic.elementary import log, power
from gcodesim.cell import LoadedCell
from gcodesim.declarations.scalars import measured
from gcodesim.declarations.units import DIMENSIONS, find, shown
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.frozen import frozen
from gcodesim.jobs.job import Job, Options
from gcodesim.motion.tool_path import RAPID, ToolPath
from gcodesim.optimise.feed_words import rewritten
from gcodesim.tools.cutter import Cutter

Array = NDArray[np.float64]

LIMITS: Final = {
    "force": ("force", "force"),
    "peak-force": ("peak_force", "force"),
    "torque": ("torque", "torque"),
    "power": ("power", "power"),
    "chip": ("tooth_chip", "length"),
    "deflection": ("tool_bend", "length"),
}
"""Column and dimension of what may be limited; all but the peak force are means over a revolution."""

_RUNS: Final = 6
_AIM: Final = 0.99  # of the limit
_FIRST_POWER: Final = 0.75  # of the load over the feed, until two runs tell
_LEAST: Final = 0.1
"""Of the feed that was programmed. With less an edge rubs rather than cuts, and no force becomes much less by it."""


class CannotOptimiseError(Exception):
    """There is nothing to change, or no way to; the text says why."""


@frozen
class Limit:
    """A load and its greatest value, SI."""

    name: str
    value: float

    @property
    def column(self) -> str:
        return LIMITS[self.name][0]

    def shown(self, value: float) -> str:
        """A value of this load for people."""
        return shown(float(f"{value:.4g}"), LIMITS[self.name][1])


def limit_of(text: str) -> Limit:
    """`force=400 N` → a limit; CannotOptimiseError with what is expected."""
    name, _, value = text.strip().partition("=" if "=" in text else " ")
    name, number = name.strip(), measured(value)
    if name not in LIMITS:
        raise CannotOptimiseError(f"there is no limit {name or text}, only {', '.join(LIMITS)}")
    dimension = LIMITS[name][1]
    expected = f"{name} is limited by {DIMENSIONS[dimension]}, such as {name}={DIMENSIONS[dimension].example!r}"
    if number is None or not number.value > 0.0:
        raise CannotOptimiseError(expected)
    unit = find(number.unit, dimension) if number.unit or not DIMENSIONS[dimension].plain else find("mm", "length")
    if unit is None:
        raise CannotOptimiseError(expected)
    return Limit(name=name, value=number.value * unit.factor)


@frozen(eq=False)
class Optimised:
    """The program with other feeds; greatest loads by limit and times [s] before and after.

    `changed` are its lines by number, `over` those that stay above a limit, `kept` those whose feed cannot be written.
    `beyond` are those of `over` that no feed from a tenth of the programmed one on keeps below: they are as they were.
    """

    program: SourceText
    before: dict[str, float]
    after: dict[str, float]
    time_before: float
    time_after: float
    changed: tuple[int, ...]
    over: tuple[int, ...]
    kept: tuple[int, ...]
    beyond: tuple[int, ...]


@frozen(eq=False)
class _Loads:
    """One run: per feed line its feed [m/s] and its loads over their limits; the greatest loads, the time."""

    line: NDArray[np.int64]
    feed: Array
    share: Array
    greatest: dict[str, float]
    time: float
    path: ToolPath


def optimise_feeds(
    program: SourceText,
    loaded: LoadedCell,
    limits: Sequence[Limit],
    options: Options,
    *,
    most: float = 1.0,
    said: Callable[[str], None] = lambda _: None,
) -> Optimised:
    """Feeds within `limits`, at most `most` times those of the program; CannotOptimiseError.

    Lines that cut nothing keep theirs. `said` gets a line for each run.
    """
    loaded = _watching(loaded, limits)
    first = _run(program, loaded, limits, options)
    said(f"1: {_worst(first, limits)}")
    text = program.text
    lines = text.splitlines()
    branching = any(word in text.upper() for word in ("O<", "GOTO", "M98", "M97", "WHILE", "CALL"))
    wanted = {int(n): float(f) for n, f in zip(first.line, first.feed, strict=True)}
    programmed, exponent = dict(wanted), dict.fromkeys(wanted, _FIRST_POWER)
    last, source, kept, hopeless = first, program, list[int](), set[int]()
    known = first
    for turn in range(2, _RUNS + 3):
        lost = _hopeless(last, wanted, programmed) - hopeless
        hopeless |= lost
        moved = {n: programmed[n] for n in lost}
        if turn <= _RUNS:
            moved |= _next_feeds(last, wanted, programmed, exponent, most, {*kept, *hopeless})
        if not moved:
            break
        wanted |= moved
        changed, refused = rewritten(lines, {**wanted, **{n: programmed[n] for n in kept}}, branching)
        kept = sorted({*kept, *(n for n in refused if wanted[n] != programmed[n])})
        source = replace(program, raw="\n".join([*changed, ""] if text.endswith("\n") else changed).encode())
        known, last = last, _run(source, loaded, limits, options)
        said(f"{turn}: {_worst(last, limits)}")
        _same_path(first.path, last.path)
        _learn(exponent, known, last)
    over = [int(n) for n in last.line[last.share > 1.0 + 1e-6]]
    after = source.text.splitlines()
    return Optimised(
        program=source, before=first.greatest, after=last.greatest, time_before=first.time, time_after=last.time,
        changed=tuple(i + 1 for i, (a, b) in enumerate(zip(lines, after, strict=True)) if a != b), over=tuple(over),
        kept=tuple(kept), beyond=tuple(sorted(hopeless)),
    )  # fmt: skip


def _hopeless(run: _Loads, wanted: Mapping[int, float], programmed: Mapping[int, float]) -> set[int]:
    """The lines that are above a limit at the least feed that is tried."""
    above = [n for n, share in zip(run.line.tolist(), run.share.tolist(), strict=True) if share > 1.0]
    return {n for n in above if wanted[n] <= _LEAST * programmed[n] * (1.0 + 1e-9)}


def _next_feeds(
    run: _Loads,
    wanted: dict[int, float],
    programmed: dict[int, float],
    exponent: dict[int, float],
    most: float,
    kept: Collection[int],
) -> dict[int, float]:
    """Feeds that the next run tries: of lines above a limit, and, where they may rise, of those far below."""
    found: dict[int, float] = {}
    for n, share in zip(run.line.tolist(), run.share.tolist(), strict=True):
        if n in kept or share <= 0.0 or (share <= 1.0 and (most <= 1.0 or share >= 0.97)):
            continue
        factor = float(power(_AIM / share, 1.0 / exponent[n]))
        feed = min(max(wanted[n] * factor, _LEAST * programmed[n]), most * programmed[n])
        if share <= 1.0 and feed < wanted[n] * 1.01:
            continue
        if abs(feed - wanted[n]) > 1e-6 * wanted[n]:
            found[n] = feed
    return found


def _learn(exponent: dict[int, float], before: _Loads, after: _Loads) -> None:
    """The power of the load of each line over its feed, from two runs."""
    old = {n: (f, s) for n, f, s in zip(before.line.tolist(), before.feed.tolist(), before.share.tolist(), strict=True)}
    for n, feed, share in zip(after.line.tolist(), after.feed.tolist(), after.share.tolist(), strict=True):
        feed_before, share_before = old[n]
        if share > 0.0 and share_before > 0.0 and abs(feed / feed_before - 1.0) > 0.01:
            exponent[n] = min(max(log(share / share_before) / log(feed / feed_before), 0.15), 1.0)


def _run(program: SourceText, loaded: LoadedCell, limits: Sequence[Limit], options: Options) -> _Loads:
    job = simulation.prepare(program, loaded, options)
    if job.others:
        raise CannotOptimiseError("several programs at once cannot be optimised; run one channel alone")
    results, execution = simulation.run(job)
    worst = next((f for f in results.findings if f.level >= Severity.ERROR), None)
    if execution is None or job.plan is None or results.stopped_at is not None:
        why = "" if worst is None else f": {worst.code}: {worst.message}"
        raise CannotOptimiseError(f"the program does not run to its end{why}")
    return _loads(job, execution.rows.columns, limits, results.times.total)


def _loads(job: Job, columns: Any, limits: Sequence[Limit], time: float) -> _Loads:
    assert job.plan is not None
    path = job.plan.path
    greatest, share = {}, np.zeros(len(path))
    for limit in limits:
        if limit.column not in columns:
            raise CannotOptimiseError(f"no tool of the cell tells its {limit.name}")
        values = columns[limit.column]
        greatest[limit.name] = float(values.max(initial=0.0))
        share = np.maximum(share, values / limit.value)
    spans = [path.spans[i] for i in path.source]
    own = np.array([span.file == job.program.name for span in spans], dtype=bool)
    feeds = own & (path.kind != RAPID) & np.isfinite(path.feed) & ~path.rotary_feed & (path.feed > 0.0)
    line = np.array([span.line for span in spans], dtype=np.int64)[feeds]
    lines, index = np.unique(line, return_inverse=True)
    worst, feed = np.zeros(len(lines)), np.zeros(len(lines))
    np.maximum.at(worst, index, share[feeds])
    np.maximum.at(feed, index, path.feed[feeds])
    return _Loads(line=lines, feed=feed, share=worst, greatest=greatest, time=time, path=path)


def _worst(run: _Loads, limits: Sequence[Limit]) -> str:
    told = ", ".join(f"{limit.name} {limit.shown(run.greatest[limit.name])}" for limit in limits)
    return f"{told}, {int((run.share > 1.0 + 1e-6).sum())} lines above, {run.time:.1f} s"


def _same_path(old: ToolPath, new: ToolPath) -> None:
    """CannotOptimiseError unless both go the same way."""
    same = len(old) == len(new) and np.array_equal(old.end, new.end) and np.array_equal(old.kind, new.kind)
    if not same:
        raise CannotOptimiseError("other F words lead the program another way, so its feeds cannot be changed")


def _watching(loaded: LoadedCell, limits: Sequence[Limit]) -> LoadedCell:
    """The cell whose cutters tell what is limited."""
    cell = loaded.cell
    if cell is None:
        return loaded
    names = {limit.name for limit in limits}
    cutters = [tool for tool in cell.tools.values() if isinstance(tool, Cutter)]
    if "deflection" in names and not any(tool.substrate for tool in cutters):
        raise CannotOptimiseError("no tool of the cell says its `substrate`, so none bends")
    if "chip" not in names:
        return loaded
    tools = {
        number: replace(tool, runout=tool.runout or 0.0) if isinstance(tool, Cutter) else tool
        for number, tool in cell.tools.items()
    }
    return replace(loaded, cell=replace(cell, tools=tools))

"""What no machinist would do: rapids through material, feeding with the spindle off, shanks and holders in stock.

All columns have one entry a row of the path; volumes [m³], depths [m], times
[s]. An event goes on over rows that are free of it until the tool leaves with
a rapid that touches nothing, or tool or spindle change; it is found once, at
its first row, with the worst number of all its rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks import Spans
from gcodesim.checks.events import Flags, runs
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Array
from gcodesim.units import MM, MM3

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RowUse:
    """What the tool did in stock while each of n rows was run, columns (n,).

    `rapid`: the row is a rapid; `tool`: number of the tool; `setting`: anything
    that changes whenever tool or spindle do; `changed`: a tool came into the
    spindle between the row before and this one; `spindle` [rad/s]; `time` [s]
    at which the row begins.
    `rapid_cut` [m³] went in rapids, which may seem to take `rapid_bound` where
    they only graze, and in any row a cell of the grid; `stopped_cut`, `reversed_cut` [m³] went in feed with the
    spindle off or turning backwards; `shank`, `holder` [m]: deepest these parts
    stood in stock; `inside`, `tilted` [s]: the tool stood in stock that it did not cut.
    """

    rapid: Flags
    tool: Ints
    setting: Ints
    changed: Flags
    spindle: Array
    time: Array
    rapid_cut: Array
    rapid_bound: Array
    stopped_cut: Array
    reversed_cut: Array
    shank: Array
    holder: Array
    inside: Array
    tilted: Array


def stock_findings(
    use: RowUse, spans: Spans, names: Mapping[int, str], changes: Mapping[int, Span] | None = None
) -> list[Diagnostic]:
    """GS401 to GS406, GS501 and GS502 of a run; `names` maps tool numbers to names (default T and the number).

    `changes` tells for rows before which a tool came into the spindle where the program asks for that.
    """
    fault = (use.shank > 0.0) | (use.holder > 0.0) | (use.stopped_cut > 0.0) | (use.reversed_cut > 0.0)
    away = use.rapid & ~fault & (use.rapid_cut <= use.rapid_bound) & (use.inside <= 0.0)
    return _folded(
        [
            *_rapids(use, spans, names),
            *_inside(use, spans, names, changes or {}),
            *_parts(use, away, spans, names),
            *_tilted(use, away, spans, names),
            *_spindle(use, spans, names),
        ]
    )


def _folded(found: list[Diagnostic]) -> list[Diagnostic]:
    """Events of one kind in the same place, as in a loop, are told once and counted, with the numbers of the first."""
    first: dict[tuple[str, Span], Diagnostic] = {}
    for finding in found:
        key = (finding.code, finding.span)
        known = first.get(key)
        first[key] = finding if known is None else replace(known, count=known.count + finding.count)
    return list(first.values())


def blind_findings(moving: Mapping[str, Flags], removed: Array, time: Array, spans: Spans) -> list[Diagnostic]:
    """GS407: cuts while a rotary axis turns whose place nobody knows, one for each stretch of such rows.

    `moving` tells for each such axis, by letter, in which rows (n,) it turns;
    `removed` [m³] in each row, `time` [s] at which it begins.
    """
    found = []
    for letter, turns in moving.items():
        for rows in runs(turns & (removed > 0.0)):
            first, taken = int(rows[0]), float(removed[rows].sum()) / MM3
            found.append(
                Diagnostic(
                    code="GS407",
                    message=f"{taken:.1f} mm³ of stock are cut while axis {letter} turns, whose place is not known; "
                    "the cut is computed as if it stood still",
                    span=spans(first),
                    hint=f"give axis {letter} of the machine its `at: [x, y, z]`, a point on the axis",
                    count=len(rows),
                    time=float(time[first]),
                    value=taken,
                    limit=0.0,
                    unit="mm^3",
                )
            )
    return _folded(found)


def _name(names: Mapping[int, str], number: int) -> str:
    return names.get(number, f"T{number}")


def _rapids(use: RowUse, spans: Spans, names: Mapping[int, str]) -> Iterator[Diagnostic]:
    for rows in runs(use.rapid & (use.rapid_cut > use.rapid_bound), group=use.setting):
        first = int(rows[0])
        volume, bound = use.rapid_cut[rows].sum() / MM3, use.rapid_bound[rows].sum() / MM3
        yield Diagnostic(
            code="GS401",
            message=f"rapid move of {_name(names, int(use.tool[first]))} takes {volume:.1f} mm³ of stock away; "
            f"{bound:.1f} mm³ could be an error of the grid",
            span=spans(first),
            hint="retract before the move, or make it a feed move",
            count=len(rows),
            time=float(use.time[first]),
            value=volume,
            limit=bound,
            unit="mm^3",
        )


def _inside(use: RowUse, spans: Spans, names: Mapping[int, str], changes: Mapping[int, Span]) -> Iterator[Diagnostic]:
    for rows in runs(use.inside > 0.0, group=np.cumsum(use.changed)):
        first = int(rows[0])
        tool = _name(names, int(use.tool[first]))
        # the tool that is in the spindle before anything has moved is there from the start
        late = bool(use.changed[1 : first + 1].any())
        when = "where it is put into the spindle" if late else "when the program starts"
        yield Diagnostic(
            code="GS403" if late else "GS402",
            message=f"{tool} stands in stock {when}; it cuts nothing for {use.inside[rows].sum():.3f} s, "
            "until it has left the stock",
            span=changes.get(first) or spans(first),
            hint="retract before the tool change" if late else "check `stock`, `work_offsets` and `home` of the cell",
            time=float(use.time[first]),
            value=float(use.inside[rows].sum()),
            limit=0.0,
            unit="s",
        )


def _parts(use: RowUse, away: Flags, spans: Spans, names: Mapping[int, str]) -> Iterator[Diagnostic]:
    parts = (
        ("GS404", "shank", use.shank, "the flutes are too short for this depth"),
        ("GS405", "holder", use.holder, "use a longer tool or a slimmer holder, or cut less deep beside the wall"),
    )
    for code, part, depth, hint in parts:
        for rows in runs(depth > 0.0, ends=away, group=use.setting):
            first, worst = int(rows[0]), float(depth[rows].max()) / MM
            yield Diagnostic(
                code=code,
                message=f"{part} of {_name(names, int(use.tool[first]))} runs into stock, {worst:.3f} mm deep",
                span=spans(first),
                hint=hint,
                count=len(rows),
                time=float(use.time[first]),
                value=worst,
                limit=0.0,
                unit="mm",
            )


def _tilted(use: RowUse, away: Flags, spans: Spans, names: Mapping[int, str]) -> Iterator[Diagnostic]:
    for rows in runs(use.tilted > 0.0, ends=away, group=use.setting):
        first, spent = int(rows[0]), float(use.tilted[rows].sum())
        yield Diagnostic(
            code="GS406",
            message=f"{_name(names, int(use.tool[first]))} leans in the stock; it cuts nothing for {spent:.3f} s",
            span=spans(first),
            count=len(rows),
            time=float(use.time[first]),
            value=spent,
            limit=0.0,
            unit="s",
        )


def _spindle(use: RowUse, spans: Spans, names: Mapping[int, str]) -> Iterator[Diagnostic]:
    faults = (
        ("GS501", use.stopped_cut, "the spindle stopped", "start it with `S` and `M3` before this line"),
        ("GS502", use.reversed_cut, "the spindle turning backwards (M4)", "use `M3`"),
    )
    never = np.zeros(len(use.rapid), dtype=np.bool_)  # one cause, until tool or spindle change
    for code, volume, how, hint in faults:
        for rows in runs(volume > 0.0, ends=never, group=use.setting):
            first, taken = int(rows[0]), float(volume[rows].sum()) / MM3
            if volume[rows].sum() <= use.rapid_bound[rows].max():
                continue  # a tap on its way out, in its own thread: nothing that the grid could show
            yield Diagnostic(
                code=code,
                message=f"{_name(names, int(use.tool[first]))} feeds through {taken:.1f} mm³ of stock with {how}",
                span=spans(first),
                hint=hint,
                count=len(rows),
                time=float(use.time[first]),
                value=taken,
                limit=0.0,
                unit="mm^3",
            )

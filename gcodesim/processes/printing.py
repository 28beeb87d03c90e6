"""What is wrong with a print: beads in the air, flow that the bead cannot be, material beside the stock, blobs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Diagnostic
from gcodesim.processes.rows import Rows
from gcodesim.tools.extruder import Extruder
from gcodesim.tools.paste import Paste
from gcodesim.units import MM, MM3

Array = NDArray[np.float64]

AIR: Final = 0.5 * MM
"""Length of bead without support that counts: less is the edge of what is below."""

FREE: Final = 2.0 * MM
"""Length of bead that the strand before it holds by itself, as where it goes round a corner in the air."""

SPILL: Final = 0.25
"""Share of the bead of the row behind it that does not make a row one with a bead."""

SHORT: Final = 0.01
"""[s] Rows that take less may have no step of their own."""

NO_WAY: Final = 0.01 * MM
"""A row that is shorter lays no bead that could have a size."""

OFF: Final = 0.2
"""Share by which flow may miss the bead; slicers stay within some per cent."""

_BESIDE: Final = (
    "GS522",
    "beside",
    "lies beside the stock, where it is not kept",
    "make the stock, which is the bed, as large as the print",
)
_SWOLLEN: Final = (
    "GS523",
    "swollen",
    "found no room below the nozzle and swells up beside it",
    "look for layers that are too thin, a wrong `filament_diameter`, or paths that lie on each other",
)
_CROWDED: Final = (
    "GS523",
    "crowded_out",
    "found no room: material is there already, and beads of the tool's own size are not pushed aside",
    "look for layers that are too thin, or paths on each other; give the tool a `flow` to see where it goes",
)
_WORTH: Final = 0.02  # share of all that was extruded from which on a loss or swelling is worth a finding
_BLOBS: Final = 0.005  # the same of what comes out while the nozzle stands: within it volume counts as conserved


def printing_findings(rows: Rows) -> Iterator[Diagnostic]:
    """GS519 to GS524 from the columns that `Extrusion` writes; of beads without known volumes only where they lie."""
    volume = rows["extruded"]
    fixed = np.where(volume > 0.0, 0.0, rows["meant"])
    yield from _in_the_air(rows)
    if volume.any():
        yield from _off_size(rows, volume - rows["blobs"] - rows["fallen"], rows["meant"] - fixed)
        yield from _blobs(rows, float(volume.sum()))
    yield from _out_of_place(rows, volume + fixed, _BESIDE)
    yield from _out_of_place(rows, volume, _SWOLLEN)
    yield from _out_of_place(rows, fixed, _CROWDED)


def _out_of_place(rows: Rows, volume: Array, kind: tuple[str, str, str, str]) -> Iterator[Diagnostic]:
    """GS522 and GS523: of what is laid, what lies beside the stock or finds no room."""
    total, laying = float(volume.sum()), _laying(volume)
    code, name, what, hint = kind
    lost = rows[name]
    if float(lost.sum()) > _WORTH * total:
        blamed = laying[lost[laying] > _WORTH * volume[laying]]
        yield rows.told(
            blamed if len(blamed) else np.flatnonzero(lost > 0.0),
            code,
            f"{lost.sum() / MM3:.1f} of {total / MM3:.1f} mm³ {what}",
            hint,
            (float(lost.sum()) / MM3, _WORTH * total / MM3, "mm³"),
        )


def _blobs(rows: Rows, total: float) -> Iterator[Diagnostic]:
    """What comes out while the nozzle stands."""
    blobs, fallen = rows["blobs"], rows["fallen"]
    laid, lost = float(blobs.sum()), float(fallen.sum())
    if laid + lost <= _BLOBS * total:
        return
    where = _laying(blobs + fallen)
    parts = [f"{laid / MM3:.1f} mm³ stay there as blobs"] * (laid > 0.0)
    parts += [f"{lost / MM3:.1f} mm³ fall, with nothing below, and are not kept"] * (lost > 0.0)
    found = rows.told(
        where,
        "GS519",
        f"{(laid + lost) / MM3:.1f} of {total / MM3:.1f} mm³ come out while the nozzle stands: {', '.join(parts)}",
        "as meant for priming and purging; else look for filament that comes back longer than it was drawn back",
        ((laid + lost) / MM3, _BLOBS * total / MM3, "mm³"),
    )
    yield replace(found, span=rows.stay_spans.get(int(where[0])) or found.span)


def _laying(way: Array) -> NDArray[np.intp]:
    """Rows on which a strand is laid. A step counts for the row in its middle, so the row before may have a bit."""
    following = np.append(way[1:], 0.0)
    return np.flatnonzero((way > 0.0) & (way > SPILL * following))


def _in_the_air(rows: Rows) -> Iterator[Diagnostic]:
    """Beads with nothing below: a stretch that rests on something at both ends is a bridge."""
    air, way = rows["unsupported"], rows["laid_length"]
    laying = _laying(way)
    if not len(laying):
        return
    hanging = air[laying] > np.minimum(AIR, 0.5 * way[laying])
    edges = np.flatnonzero(np.diff(np.concatenate([[False], hanging, [False]]).astype(np.int8)))
    bridges: list[tuple[int, float]] = []
    floating: list[tuple[int, float]] = []
    for begin, end in edges.reshape(-1, 2).tolist():
        run = laying[begin:end]
        length = float(air[run].sum())
        first, last = int(run[0]), int(run[-1])
        before = begin > 0 and _joined(rows, int(laying[begin - 1]), first)
        behind = end < len(laying) and _joined(rows, last, int(laying[end]))
        held = [before or air[first] < 0.98 * way[first], behind or air[last] < 0.98 * way[last]]
        (bridges if all(held) else floating).append((first, length))
    floating = [each for each in floating if each[1] > FREE]
    if floating:
        total = sum(length for _, length in floating)
        yield rows.told(
            np.array([first for first, _ in floating]),
            "GS520",
            f"the bead lies in the air: {total / MM:.1f} mm without anything below",
            "print a support, or the layer below, first",
            (total / MM, AIR / MM, "mm"),
        )
    if bridges:
        total, longest = sum(length for _, length in bridges), max(length for _, length in bridges)
        message = f"{total / MM:.1f} mm of bead bridge what is empty below; longest stretch: {longest / MM:.1f} mm"
        event = np.array([first for first, _ in bridges])
        yield rows.told(event, "GS521", message, "both ends rest on something", (longest / MM, AIR / MM, "mm"))


def _joined(rows: Rows, one: int, next_one: int) -> bool:
    """Whether two rows lay one strand: between them there may be rows too short for a step, but no way around."""
    return bool(rows.time[next_one] - rows.time[one + 1] < SHORT)


def _off_size(rows: Rows, volume: Array, asked: Array) -> Iterator[Diagnostic]:
    """Flow that is much more or less than the bead's size asks for: each for itself, or one would hide the other."""
    rated = _laying(rows["laid_length"])
    rated = rated[(rows["laid_length"][rated] > NO_WAY) & (asked[rated] > 0.0)]
    for miss, sense in ((asked[rated] - volume[rated], "less"), (volume[rated] - asked[rated], "more")):
        off = rated[miss > OFF * asked[rated]]
        share, way = float(asked[off].sum()), float(rows["laid_length"][off].sum())
        if not len(off) or share < _WORTH * float(asked.sum()):
            continue
        flow, wanted = float(volume[off].sum()) / way / (MM * MM), share / way / (MM * MM)
        message = f"flow and speed give a section of {flow:.3g} mm²; beads of the size named ask for {wanted:.3g} mm²"
        message += f", {abs(flow / wanted - 1.0):.0%} {sense} flows"
        hint = "check E, `filament_diameter`, `bead_width` and `bead_height`"
        yield rows.told(off, "GS524", message, hint, (flow, wanted, "mm²"))


def paste_findings(rows: Rows) -> Iterator[Diagnostic]:
    """GS528: beads of a paste higher than it stands; GS529: more on the lowest of them than they carry by then."""
    built = rows["built"]
    for number, tool in rows.tools.items():
        laid = np.flatnonzero((rows.tool == number) & (built > 0.0))
        if not isinstance(tool, Extruder) or tool.paste is None or not len(laid):
            continue
        paste = tool.paste
        height, fresh = tool.bead_height, paste.standing(0.0)
        if height > fresh:
            message = f"beads of {height / MM:.0f} mm slump: {_name(paste)} stands {fresh / MM:.0f} mm as it is laid"
            yield rows.told(laid, "GS528", message, "lay thinner beads", (height / MM, fresh / MM, "mm"))
            continue
        age = rows.time[laid] - rows.time[laid[0]]
        carried = np.array([paste.standing(float(seconds)) for seconds in age])
        over = np.flatnonzero(built[laid] > carried)
        if len(over):
            first = over[0]
            message = (
                f"{built[laid[first]] / MM:.0f} mm stand on {_name(paste)} that is {age[first]:.0f} s old and carries "
                f"{carried[first] / MM:.0f} mm: the lowest beads yield"
            )
            hint = "build more slowly, wait between layers, or use a paste that sets faster"
            yield rows.told(laid[over], "GS529", message, hint, (built[laid[first]] / MM, carried[first] / MM, "mm"))


def _name(paste: Paste) -> str:
    return paste.like or "the paste"

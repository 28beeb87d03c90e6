"""How hard a cut is for its cutter: bending, chips with run-out, chip load, chatter.

Only for tools that say what they are made of, how they run out, which chips they may take, or how they swing. Bending
and run-out take part in the cut: the tip gives way as a cantilever (`tool_bending`), and each tooth has a chip of its
own (`uneven_kernels`). Chatter is judged by the lobes of `stability`, with the same mode in both directions, as of
teeth that are evenly spread.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import power
from gcodesim.arithmetic.matrices import applied, norms
from gcodesim.diagnostics import Diagnostic
from gcodesim.processes.column import FINDINGS, LINES, LOG, RESULTS, Column
from gcodesim.processes.laws import Law, LinearEdge
from gcodesim.processes.rows import Rows
from gcodesim.processes.signal import SPINDLE
from gcodesim.processes.tool_bending import FLUTED, MODULI, BeamSection, tip_compliance, tip_way_of_moment
from gcodesim.tools.cutter import Cutter
from gcodesim.tools.drill import Drill
from gcodesim.units import DEG, MINUTE, MM

if TYPE_CHECKING:
    from gcodesim.processes.stability import Lobes
    from gcodesim.processes.window import Window

Array = NDArray[np.float64]

LOAD_COLUMNS: Final = (
    Column("tool_bend", "m", "greatest", LOG | LINES | RESULTS, "how far the tool bends under its mean force"),
    Column("tooth_chip", "m", "greatest", LOG | LINES | RESULTS | FINDINGS, "chip of the tooth that takes most"),
    Column("runout_force", "N", "greatest", LOG | LINES | RESULTS, "peak force within a revolution, with run-out"),
    Column(
        "beyond_stable", "m", "greatest", LOG | LINES | RESULTS | FINDINGS, "depth of cut beyond that without chatter"
    ),
    Column("unstable_depth", "m", "greatest", FINDINGS, "depth of cut where it may chatter"),
)

_SLICES: Final = 32
"""Cylinders in place of a cone that bends."""
_ANGLE: Final = 3.0 * DEG
"""Steps of entry and exit for which the limit of chatter is computed."""


def sections_of(cutter: Cutter) -> list[BeamSection]:
    """The cutter as a beam, from its tip to the holder."""
    parts = [BeamSection(FLUTED * cutter.diameter, cutter.flute_length)]
    for lower, upper, bottom, top in cutter.shank_frusta:
        slices = 1 if lower == upper else _SLICES
        for k in range(slices):
            parts.append(BeamSection(2.0 * (lower + (upper - lower) * (k + 0.5) / slices), (top - bottom) / slices))
    return parts


def gives_way(cutter: Cutter) -> bool:
    """Whether a tool says how it bends, and can: the walls of its hole hold a drill by its margins."""
    return cutter.substrate is not None and not isinstance(cutter, Drill)


def tool_compliance(cutter: Cutter, axis: Array) -> Array:
    """Way of the tip (n, 3, 6) under a wrench at the tip, for tool axes (n, 3); the tool says its `substrate`."""
    assert cutter.substrate is not None
    modulus, parts = MODULI[cutter.substrate], sections_of(cutter)
    push, turn = tip_compliance(parts, modulus), tip_way_of_moment(parts, modulus)
    found = np.zeros((len(axis), 3, 6))
    found[:, :, :3] = push * (np.eye(3) - axis[:, :, None] * axis[:, None, :])
    x, y, z = axis.T
    for (i, j), value in {(0, 1): -z, (0, 2): y, (1, 0): z, (1, 2): -x, (2, 0): -y, (2, 1): x}.items():
        found[:, i, 3 + j] = turn * value
    return found


class CutterLoad:
    """The columns of one cutter under one law."""

    def __init__(self, cutter: Cutter, law: Law | None) -> None:
        self._cutter, self._law = cutter, law
        self._limits: dict[tuple[int, int], Lobes] = {}
        self._depths: dict[tuple[int, int, float], float] = {}

    def columns(self, out: Array, window: Window) -> dict[str, Array]:
        """Values (n,) of `LOAD_COLUMNS` from the output (n, OUTPUTS) of the kernel."""
        from gcodesim.processes import milling_kernels as m

        chip, peak = out[:, m.OUT_CHIP], out[:, m.PEAK]
        bend = np.zeros(len(out))
        if gives_way(self._cutter):
            bend = norms(applied(tool_compliance(self._cutter, window.axis), out[:, m.WRENCH : m.WRENCH + 6]))
        depth = out[:, m.OUT_DEPTH]
        stable = self._stable_depths(out[:, m.OUT_ENTRY], out[:, m.OUT_EXIT], depth, chip, window)
        over = np.maximum(depth - stable, 0.0)
        return {
            "tool_bend": bend,
            "tooth_chip": chip,
            "runout_force": peak,
            "beyond_stable": over,
            "unstable_depth": np.where(over > 0.0, depth, 0.0),
        }

    def _stable_depths(self, entry: Array, leave: Array, depth: Array, chip: Array, window: Window) -> Array:
        """The depth (n,) [m] without chatter, infinite where nothing is known of it."""
        found = np.full(len(depth), inf)
        if self._cutter.dynamics is None or self._law is None:
            return found
        spindle = window.signals[SPINDLE.name]
        for i in np.flatnonzero((depth > 0.0) & (leave > entry) & (spindle > 0.0) & (chip > 0.0)):
            place = (round(float(entry[i]) / _ANGLE), round(float(leave[i]) / _ANGLE))
            found[i] = self._depth(place, float(spindle[i])) / self._law_at(float(chip[i]))
        return found

    def _law_at(self, chip: float) -> float:
        """Tangential cutting coefficient [Pa]."""
        law = self._law
        if isinstance(law, LinearEdge):
            return law.ktc
        assert law is not None
        return float(law.packed[0, 0] * power(chip, float(law.packed[0, 1]) - 1.0))

    def _depth(self, place: tuple[int, int], spindle: float) -> float:
        """Stable depth times tangential coefficient [N/m] at an engagement and a speed."""
        known = self._depths.get((*place, spindle))
        if known is None:
            known = self._limit(place).depth_at(spindle)
            self._depths[(*place, spindle)] = known
        return known

    def _limit(self, place: tuple[int, int]) -> Lobes:
        from gcodesim.processes.stability import Mode, lobes

        if place not in self._limits:
            mode, law = self._cutter.dynamics, self._law
            assert mode is not None and law is not None
            swing = Mode(frequency=mode.frequency, stiffness=mode.stiffness, damping=mode.damping)
            ratio = float(law.packed[1, 0] / law.packed[0, 0])
            self._limits[place] = lobes(
                swing, swing, ktc=1.0, ratio=ratio, teeth=self._cutter.flutes, entry=place[0] * _ANGLE,
                exit=max(place[1], place[0] + 1) * _ANGLE,
            )  # fmt: skip
        return self._limits[place]


def load_findings(rows: Rows) -> Iterator[Diagnostic]:
    """GS515 and GS516: chips that are thicker or thinner than the tool's table; GS517: chatter. One for each tool."""
    chip, unstable = rows["tooth_chip"], rows["unstable_depth"]
    never = np.zeros(len(rows), dtype=np.bool_)
    for number, tool in rows.tools.items():
        if not isinstance(tool, Cutter):
            continue
        own = (rows.tool == number) & ~rows.rapid
        if tool.chip_load is not None:
            least, most = tool.chip_load
            for event in rows.events(own & (chip > most * (1.0 + 1e-9)), never):
                yield _chip(rows, event, "GS515", float(chip[event].max()), most, "thick", "lower the feed")
            for event in rows.events(own & (chip > 0.0) & (chip < least * (1.0 - 1e-9)), never):
                yield _chip(rows, event, "GS516", float(chip[event].min()), least, "thin", "raise the feed")
        if tool.dynamics is not None:
            for event in rows.events(own & (unstable > 0.0), never):
                yield _chatter(rows, event, tool)


def _chip(
    rows: Rows, event: NDArray[np.intp], code: str, value: float, limit: float, what: str, hint: str
) -> Diagnostic:
    first = int(event[0])
    words = "at most" if what == "thick" else "at least"
    return rows.told(
        event,
        code,
        f"chips of {rows.tool_name(first)} are {value / MM:.4f} mm thick; its `chip_load` is {words} "
        f"{limit / MM:.4f} mm",
        f"{hint}, or turn {'faster' if what == 'thick' else 'slower'}",
        (value / MM, limit / MM, "mm"),
    )


def _chatter(rows: Rows, event: NDArray[np.intp], tool: Cutter) -> Diagnostic:
    worst = int(event[np.argmax(rows["beyond_stable"][event])])
    depth = float(rows["unstable_depth"][worst])
    stable = depth - float(rows["beyond_stable"][worst])
    mode = tool.dynamics
    assert mode is not None
    pocket = MINUTE * mode.frequency / tool.flutes
    found = rows.told(
        event,
        "GS517",
        f"{rows.tool_name(worst)} may chatter: it cuts {depth / MM:.3f} mm deep where {stable / MM:.3f} mm is "
        f"stable (lobes of a mode of {mode.frequency:g} Hz)",
        f"cut less deep, or turn near {pocket:.0f} rpm or a half, a third … of it",
        (depth / MM, stable / MM, "mm"),
    )
    return replace(found, span=rows.span(worst), time=float(rows.time[worst]))  # where it is worst, not where it begins

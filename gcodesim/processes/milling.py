"""Milling and drilling: cutting forces, deflection and removal of a rotating cutter.

Mean wrench over a revolution by the mechanistic model (Altintas 2012, ch. 2) with the engagement read from the
stock. Simplified: runout, tooth-to-tooth differences, chatter and tool bending are not modelled; chip thickness is
that of a circular tooth path; edges below the tip centre of a plunging flat end mill count as edges of any other
place (kappa = 0, h = feed per tooth); the chisel edge of a drill is left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from gcodesim.processes.column import ENGAGED, FINDINGS, POWER, REMOVED, TORQUE, Column, Shown
from gcodesim.processes.laws import Law
from gcodesim.processes.misuse import cutter_findings
from gcodesim.processes.protocol import Process
from gcodesim.processes.rows import Rows
from gcodesim.processes.signal import ACTIVE, SPINDLE, Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.processes.zone import Zone
from gcodesim.tools.cutter import Cutter

if TYPE_CHECKING:
    from collections.abc import Iterable

    from gcodesim.diagnostics import Diagnostic
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Milling(Process):
    """The cutting process of one cutter; without a law (stock of unknown material) it removes but feels no force."""

    kind: ClassVar[str] = "milling"
    pushes: ClassVar[bool] = True
    takes: ClassVar[bool] = True
    reads: ClassVar[tuple[Signal, ...]] = (SPINDLE, ACTIVE)
    writes: ClassVar[tuple[Column, ...]] = (
        REMOVED,
        ENGAGED,
        TORQUE,
        POWER,
        Column("peak_force", "N", "greatest", Shown.NOWHERE, "greatest force within a revolution"),
        Column("axial_depth", "m", "greatest", Shown.NOWHERE, "of the cut; 0 where nothing is cut, like the next four"),
        Column("radial_width", "m", "greatest", Shown.NOWHERE, "of the cut"),
        Column("entry", "rad", "last", Shown.NOWHERE, "angle at which a tooth enters, clockwise from left of the feed"),
        Column("exit", "rad", "last", Shown.NOWHERE, "angle at which it leaves"),
        Column("chip", "m", "greatest", Shown.NOWHERE, "greatest chip thickness"),
        Column("shank_depth", "m", "greatest", FINDINGS, "how deep the shank is in material"),
        Column("holder_depth", "m", "greatest", FINDINGS, "how deep the holder is in material"),
        Column("stopped_cut", "m^3", "sum", FINDINGS, "taken with the spindle at rest, without force"),
        Column("reversed_cut", "m^3", "sum", FINDINGS, "taken with the spindle turning backwards, without force"),
        Column("rapid_cut", "m^3", "sum", FINDINGS, "taken in rapids"),
        Column("rapid_bound", "m^3", "sum", FINDINGS, "what these rapids may seem to take where they only graze"),
        Column("inside", "", "any", FINDINGS, "in material that it may not cut: it was put there"),
        Column("tilted", "", "any", FINDINGS, "not upright in its stock, so that no cut is computed"),
    )

    cutter: Cutter
    law: Law | None = None

    @classmethod
    def of(cls, tool: Cutter, material: Material | None) -> Milling:
        """The process of a cutter in stock of `material`."""
        return cls(cutter=tool, law=None if material is None else material.law)

    def begin(self) -> ProcessState:
        """State of a tool that was just put in; standing in material, it cuts nothing until it has left it."""
        from gcodesim.processes.milling_kernels import STATE

        return ProcessState(values=np.zeros(STATE))

    @cached_property
    def zone(self) -> Zone:
        """The whole tool above its tip: its shank and its holder are looked after as well."""
        bodies = self.cutter.primitives
        widest = max([0.0, *(max(body.radius, body.radius_bottom) for body in bodies)])
        return Zone(radius=widest, above=self.cutter.true_length)

    @classmethod
    def findings(cls, rows: Rows) -> Iterable[Diagnostic]:
        """GS401 to GS407, GS501 and GS502: see `misuse`."""
        return cutter_findings(rows)

    def run(self, stock: Stock | None, window: Window, state: ProcessState) -> ProcessStep:
        """Cut `stock` (in place) along `window`; without stock nothing happens. `state` is carried on."""
        if stock is None:
            return ProcessStep.free(window.steps)
        n = window.steps
        first = np.searchsorted(window.piece_step, np.arange(n + 1)).astype(np.int64)
        out = self.run_packed(
            stock,
            np.ascontiguousarray(window.piece_start, dtype=float).reshape(-1, 3),
            np.ascontiguousarray(window.piece_end, dtype=float).reshape(-1, 3),
            first,
            packed_motion(window),
            packed_compliance(window),
            state,
        )
        return self._step_of(out, stock, window)

    def run_packed(
        self,
        stock: Stock,
        starts: Array,
        ends: Array,
        first: NDArray[np.int64],
        motion: Array,
        compliance: Array,
        state: ProcessState,
    ) -> Array:
        """The same on arrays as the kernel takes them (see `milling_kernels.mill`), for loops of single steps.

        motion (n, 9): axis, velocity, spindle, rapid, active; compliance (n or 0, 3, 6). Returns out (n, OUTPUTS).
        """
        from gcodesim.processes.milling_kernels import OUTPUTS, mill

        tool, edge, laws, table, circle, shapes, rows, weights, force, sums, turning = self._packed
        out = np.zeros((len(motion), OUTPUTS))
        while True:
            done = mill(
                stock.lo, stock.hi, stock.count, stock.grid, stock.dirty, stock.walls, stock.tops, starts, ends, first,
                motion, compliance, tool, edge, laws, table, circle, shapes, rows, weights, force, sums, turning,
                state.values, out,
            )  # fmt: skip
            if done == len(motion):
                return out
            stock.grow()

    def loop(self, stock: Stock, window: Window, state: ProcessState) -> MillingLoop:
        """The same step by step, for a world that answers every wrench with a motion of its own."""
        return MillingLoop(self, stock, window, state)

    def _step_of(self, out: Array, stock: Stock, window: Window) -> ProcessStep:
        """The kernel's output (n, OUTPUTS) with its columns by name, as views where they are taken as they are."""
        from gcodesim.processes import milling_kernels as m

        removed = out[:, m.REMOVED]
        rapid = window.rapid & (removed > 0.0)
        bound = self._grazed(stock, window) if rapid.any() else 0.0
        return ProcessStep(
            wrench=out[:, m.WRENCH : m.WRENCH + 6],
            deflection=out[:, m.DEFLECTION : m.DEFLECTION + 3],
            columns={
                "removed": removed,
                "engaged": out[:, m.ENGAGED] > 0.0,
                "torque": out[:, m.OUT_TORQUE],
                "power": out[:, m.POWER],
                "peak_force": out[:, m.PEAK],
                "axial_depth": out[:, m.OUT_DEPTH],
                "radial_width": out[:, m.OUT_WIDTH],
                "entry": out[:, m.OUT_ENTRY],
                "exit": out[:, m.OUT_EXIT],
                "chip": out[:, m.OUT_CHIP],
                "shank_depth": out[:, m.SHANK],
                "holder_depth": out[:, m.HOLDER],
                "stopped_cut": np.where(out[:, m.STOPPED] > 0.0, removed, 0.0),
                "reversed_cut": np.where(out[:, m.REVERSED] > 0.0, removed, 0.0),
                "rapid_cut": np.where(rapid, removed, 0.0),
                "rapid_bound": np.where(rapid, bound, 0.0),
                "inside": out[:, m.INSIDE] > 0.0,
                "tilted": out[:, m.TILTED] > 0.0,
            },
        )

    def _grazed(self, stock: Stock, window: Window) -> Array:
        """What a rapid may seem to take (n,) [m³] where it only grazes: half a cell of all wall that it passes."""
        way = window.piece_end - window.piece_start
        low = np.minimum(window.piece_start[:, 2], window.piece_end[:, 2])
        depth = np.clip(stock.z_range[1] - low, 0.0, stock.z_range[1] - stock.z_range[0])
        walls = 2.0 * np.hypot(way[:, 0], way[:, 1]) * depth + 2.0 * np.pi * self.zone.radius * np.abs(way[:, 2])
        bound = np.zeros(window.steps)
        np.add.at(bound, window.piece_step, 0.5 * float(stock.grid[2:].max()) * walls)
        return bound

    @cached_property
    def _packed(self) -> tuple[Array, ...]:
        """Constants and scratch arrays of the kernel, in its order."""
        from gcodesim.processes.engagement_kernels import ANGLES, COLUMNS, ROWS
        from gcodesim.processes.force_kernels import SPARE, SUMS, TABLE, power_table
        from gcodesim.processes.milling_kernels import CLEARANCE

        cutter = self.cutter
        tool = np.array([cutter.radius, float(cutter.flutes), np.tan(cutter.helix), cutter.edge_height])
        laws = np.zeros((3, 3)) if self.law is None else np.ascontiguousarray(self.law.packed, dtype=float)
        if self.law is None:
            laws[:, 1] = 1.0
        table = np.empty((3, TABLE))
        power_table(laws, table)
        phi = (np.arange(ANGLES) + 0.5) * (2.0 * np.pi / ANGLES)
        circle = np.array([np.sin(phi), np.cos(phi)])
        shapes = np.zeros((3, 8))
        shapes[0] = cutter.cutting_shape
        for row, shape in ((1, cutter.shank_shape), (2, cutter.holder_shape)):
            if shape is not None:
                shapes[row] = shape
                shapes[row, 1] -= CLEARANCE
                shapes[row, 3] -= CLEARANCE
        scratch = (
            np.zeros((ROWS, COLUMNS)),
            np.zeros((ROWS, ANGLES)),
            np.zeros((3, ROWS, ANGLES)),
            np.zeros((SUMS + SPARE, ANGLES)),
            np.zeros((3, 3 * ANGLES + 1)),
        )
        return (tool, cutter.edge, laws, table, circle, shapes, *scratch)


class MillingLoop:
    """A window cut step by step; what each step needs is made once."""

    def __init__(self, process: Milling, stock: Stock, window: Window, state: ProcessState) -> None:
        self._process, self._stock, self._window, self._state = process, stock, window, state
        self._starts = np.ascontiguousarray(window.piece_start, dtype=float).reshape(-1, 3)
        self._ends = np.ascontiguousarray(window.piece_end, dtype=float).reshape(-1, 3)
        self._first = np.searchsorted(window.piece_step, np.arange(window.steps + 1)).astype(np.int64)
        self._motion = packed_motion(window)
        self._compliance = packed_compliance(window)
        self._out: list[Array] = []

    def step(self, k: int, moved_before: Array, moved: Array, share: Array) -> Array:
        """Step `k`, in order. The tip is off the window's pieces by `moved_before` … `moved` (3,) [m].

        `share` (c, 2) tells where in its step each piece begins and ends. Wrench (6,) on the tool in S.
        """
        a, b = int(self._first[k]), int(self._first[k + 1])
        bend = moved - moved_before
        out = self._process.run_packed(
            self._stock,
            self._starts[a:b] + moved_before + share[a:b, :1] * bend,
            self._ends[a:b] + moved_before + share[a:b, 1:] * bend,
            np.array([0, b - a], dtype=np.int64),
            self._motion[k : k + 1],
            self._compliance[k : k + 1],
            self._state,
        )
        self._out.append(out)
        wrench: Array = out[0, :6]
        return wrench

    def finish(self) -> ProcessStep:
        """What all steps came to."""
        return self._process._step_of(np.concatenate(self._out), self._stock, self._window)


def packed_motion(window: Window) -> Array:
    """Axis, velocity, spindle, rapid and active of each step (n, 9)."""
    motion = np.empty((window.steps, 9))
    motion[:, 0:3], motion[:, 3:6] = window.axis, window.velocity
    motion[:, 6], motion[:, 7], motion[:, 8] = window.signals[SPINDLE.name], window.rapid, window.signals[ACTIVE.name]
    return motion


def packed_compliance(window: Window) -> Array:
    """Translation rows of the compliance (n, 3, 6); none of them for a rigid machine."""
    return np.zeros((0, 3, 6)) if window.compliance is None else np.array(window.compliance[:, :3, :])

"""Milling and drilling: cutting forces, deflection and removal of a rotating cutter.

Mean wrench over a revolution by the mechanistic model (Altintas 2012, ch. 2) with the engagement read from the
stock. Simplifications: what chatter does to the cut is not modelled (`cutter_load` tells of it); tools bend
only where the cell says what they are made of; chip thickness is that of a circular tooth path; edges below the tip
centre of a plunging flat end mill are treated like any other edges (kappa = 0, h = feed per tooth).
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos_sin, tan
from gcodesim.arithmetic.matrices import dots
from gcodesim.frozen import frozen
from gcodesim.processes.column import ENGAGED, FINDINGS, FORCE, LOG, POWER, REMOVED, RESULTS, TORQUE, Column, Shown
from gcodesim.processes.cutter_load import LOAD_COLUMNS, CutterLoad, gives_way, load_findings, tool_compliance
from gcodesim.processes.drill_point import edge_law, edge_pieces
from gcodesim.processes.laws import Law
from gcodesim.processes.leaning import Leaning, cut_in_three, cut_leaning, felt_in, part_of
from gcodesim.processes.leaning_force import leave
from gcodesim.processes.misuse import cutter_findings
from gcodesim.processes.protocol import Process
from gcodesim.processes.rows import Rows
from gcodesim.processes.signal import SPINDLE, Signal
from gcodesim.processes.turns import Turns
from gcodesim.processes.uneven import packed_teeth
from gcodesim.processes.wear import WEAR, worn
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.processes.zone import Zone
from gcodesim.tools.cutter import Cutter
from gcodesim.tools.sections import Frustum, shapes_of
from gcodesim.tools.teeth import helices_of
from gcodesim.units import MM, UM

if TYPE_CHECKING:
    from collections.abc import Iterable

    from gcodesim.diagnostics import Diagnostic
    from gcodesim.material.stock import Stock
    from gcodesim.processes.engagement_kernels import Room
    from gcodesim.processes.force_kernels import Teeth
    from gcodesim.processes.materials import Material
    from gcodesim.processes.milling_kernels import MillingTool, Motion
    from gcodesim.processes.milling_loop import MillingLoop
    from gcodesim.processes.swing_kernels import Swings

Array = NDArray[np.float64]

FORM_CELL = 0.01
"""Diameters of the cell for which arcs of a form cutter become facets: they then lie within a 10,000th of it."""


SIDEWAYS: Final = Column("sideways_cut", "m^3", "sum", FINDINGS, "taken by a drill or the like that goes sideways")

ALONG: Final = 0.05
"""Share of its way by which a drill may go beside its axis: an arm is not straighter while it bends."""

GRAZED: Final = 0.05
"""Of a cell: as thick a layer a rapid may seem to take of a wall that was cut along other chords of the same way; up to
0.02 were seen."""

SLACK: Final = 10.0 * UM
"""[m] by which a rapid may go beside the way that was cut: blending, a mill that bends, a control that follows."""

COARSE: Final = 0.5
"""Of a cell: such a layer where the machine bends, or the tool leans and walls have no known place."""

TURN_AHEAD: Final = 3.0
"""[cells] of way ahead whose direction tells how much it turns: contact is looked for one to two cells ahead."""

SHARP_TURN: Final = 0.5
"""[rad] along these from which on a turn is sharp: its arc is not much larger than a cell."""

SHARPEST_TURN: Final = 1.5
"""[rad] along these from which on an arc is smaller than what is looked at."""

SAME_TURN: Final = 0.1
"""Share by which a sharp turn may change along twice that way."""

UPRIGHT: Final = 1.0 - 1.0e-9
"""Share of an axis along Z from which on a tool stands upright."""


@frozen(slots=False, eq=False)
class Milling(Process):
    """The cutting process of one cutter; without a law (stock of unknown material) it removes but feels no force."""

    kind: ClassVar[str] = "milling"
    pushes: ClassVar[bool] = True
    takes: ClassVar[bool] = True
    reads: ClassVar[tuple[Signal, ...]] = (SPINDLE,)
    writes: ClassVar[tuple[Column, ...]] = (
        REMOVED,
        ENGAGED,
        TORQUE,
        POWER,
        Column("peak_force", "N", "greatest", LOG | RESULTS, "within a revolution", "sum", steady=FORCE.name),
        Column("peak_torque", "N·m", "greatest", LOG | RESULTS, "within a revolution", "sum", steady=TORQUE.name),
        Column("axial_depth", "m", "greatest", LOG, "of the cut; 0 where nothing is cut, like what follows"),
        Column("radial_width", "m", "greatest", LOG, "of the cut"),
        Column("chip_thickness", "m", "greatest", LOG, "the greatest of a revolution"),
        Column("feed_force", "N", "greatest", LOG, "on the tool, along the feed", "sum"),
        Column("side_force", "N", "greatest", LOG, "on the tool, to the left of the feed seen from the holder", "sum"),
        Column("axial_force", "N", "greatest", LOG, "on the tool, along its axis, towards the holder", "sum"),
        Column("entry", "rad", "last", Shown.NOWHERE, "angle at which a tooth enters, clockwise from left of the feed"),
        Column("exit", "rad", "last", Shown.NOWHERE, "angle at which it leaves"),
        Column("shank_depth", "m", "greatest", FINDINGS, "how deep the shank is in material"),
        Column("holder_depth", "m", "greatest", FINDINGS, "how deep the holder is in material"),
        Column("stopped_cut", "m^3", "sum", FINDINGS, "taken with the spindle at rest, without force"),
        Column("reversed_cut", "m^3", "sum", FINDINGS, "taken with the spindle turning backwards, without force"),
        Column("rapid_cut", "m^3", "sum", FINDINGS, "taken in rapids"),
        Column("rapid_bound", "m^3", "sum", FINDINGS, "what these rapids may seem to take where they only graze"),
        Column("rapid_depth", "m", "greatest", FINDINGS, "how deep below the top of the stock these rapids went"),
        Column("inside", "", "any", FINDINGS, "in material that it may not cut: it was put there"),
    )

    cutter: Cutter
    law: Law | None = None

    @classmethod
    def of(cls, tool: Cutter, material: Material | None) -> Milling:
        """The process of a cutter in stock of `material`."""
        return cls(cutter=tool, law=None if material is None else material.law_for(tool.rake))

    @classmethod
    def columns_of(cls, tool: Cutter) -> tuple[Column, ...]:
        own = (*(LOAD_COLUMNS if tool.watched else ()), *((SIDEWAYS,) if tool.axial else ()))
        return (*cls.writes, *own, *((WEAR,) if tool.life is not None else ()))

    @classmethod
    def of_revolved(cls, tool: Cutter, material: Material | None) -> Process | None:
        """A drill in the tailstock of a lathe; mills do nothing there."""
        from gcodesim.processes.turning import drilling_of
        from gcodesim.tools.drill import Drill

        return drilling_of(tool, material) if isinstance(tool, Drill) else None

    def begin(self) -> ProcessState:
        """State of a tool that was just put in; if it stands in material, it cuts nothing until it has left it."""
        from gcodesim.processes.swing_kernels import KEPT

        return ProcessState(values=np.zeros(KEPT))

    @cached_property
    def zone(self) -> Zone:
        """The whole tool above its tip, since shank and holder are watched as well."""
        bodies = self.cutter.primitives
        widest = max([0.0, *(body.widest for body in bodies)])
        return Zone(radius=widest, above=self.cutter.true_length)

    @property
    def bends(self) -> bool:
        """Whether the tool gives way under its cut."""
        return gives_way(self.cutter)

    @property
    def by_path(self) -> bool:
        """A tool that bends remembers where it was."""
        return not self.bends

    @property
    def shaping(self) -> Process:
        from gcodesim.processes.milling_shape import MillingShape

        return MillingShape(cutter=self.cutter, law=None)

    @cached_property
    def swept(self) -> Array | None:
        from gcodesim.material.solid_of_revolution import outline_of_slabs, slabs_of_shape

        slabs = self.packed_tool.slabs
        return outline_of_slabs(slabs if len(slabs) else slabs_of_shape(self.cutter.cutting_shape, 0.1 * MM))

    @classmethod
    def findings(cls, rows: Rows) -> Iterable[Diagnostic]:
        """GS401 to GS405, GS407, GS501 and GS502: see `misuse`; GS515 to GS517: see `cutter_load`."""
        return [*cutter_findings(rows), *load_findings(rows)]

    def run(self, stock: Stock | None, window: Window, state: ProcessState) -> ProcessStep:
        """Cut `stock` (in place) along `window`; without stock nothing happens. `state` is updated."""
        if stock is None:
            return ProcessStep.free(window.steps)
        turns = Turns.of(window)
        out = self.run_parts(stock, self._motion_of(window, turns, stock.cell), Leaning.of(window, turns), state)
        done = self._step_of(of_steps(out, turns), stock, window)
        if window.steps:
            felt_in(state.values)[:] = done.wrench[-1]
        return done

    def _motion_of(self, window: Window, turns: Turns, cell: float) -> Motion:
        """The motion as the kernel takes it; a tool that bends gives way besides the machine."""
        motion = packed_motion(window, turns, cell)
        if not self.bends:
            return motion
        bends = tool_compliance(self.cutter, motion.axis)
        own = motion.compliance
        return motion._replace(compliance=own + bends if len(own) else bends)

    def run_parts(self, stock: Stock, motion: Motion, leaning: Leaning, state: ProcessState) -> Array:
        """The same on m parts of steps in the form that kernels take, for loops of single steps; out (m, OUTPUTS)."""
        form = len(self.packed_tool.slabs) > 0
        if not form and not leaning.parts.any() and stock.columns_along == 1:
            return self.run_packed(stock, motion, state)
        outs = []
        for a, b, leans in leaning.runs():
            part = part_of(motion, a, b)
            if leans:
                axes = leaning.axes(int(motion.first_piece[a]), int(motion.first_piece[b]))
                outs.append(cut_leaning(self, stock, part, axes, state))
                continue
            leave(state.values)
            if stock.columns_along == 1 and not form:
                outs.append(self.run_packed(stock, part, state))
            else:
                outs.append(cut_in_three(self, stock, part, state))
        return np.concatenate(outs)

    def run_packed(self, stock: Stock, motion: Motion, state: ProcessState) -> Array:
        """The same for an upright tool, along Z only."""
        from gcodesim.processes.milling_kernels import OUTPUTS, REMOVED, mill

        steps = len(motion.spindle)
        out = np.zeros((steps, OUTPUTS))
        while True:
            done = mill(stock.view(motion.axis[0]), self.packed_tool, motion, self._room, state.values, out)
            if done == steps:
                shape = self.packed_tool.cutter
                if shape.corner > 0.0 or shape.rise > 0.0:
                    took = np.repeat(out[:, REMOVED], np.diff(motion.first_piece))
                    own = slice(int(motion.first_piece[0]), int(motion.first_piece[-1]))
                    stock.note_way(motion.starts[own], motion.ends[own], took, shape)
                return out
            stock.grow()

    def loop(self, stock: Stock, window: Window, state: ProcessState) -> MillingLoop:
        """The same step by step, for a world that reacts to every wrench with a motion of its own."""
        from gcodesim.processes.milling_loop import MillingLoop

        return MillingLoop(self, stock, window, state)

    def swung(self, stock: Stock, window: Window) -> NDArray[np.bool_]:
        """In which steps (n,) `swing` can tell."""
        from gcodesim.processes.milling_swing import swung_steps

        return swung_steps(self, stock, window)

    def swing(self, stock: Stock, window: Window, state: ProcessState, swings: Swings) -> ProcessStep | None:
        """The same in one call, for a machine whose gears swing; None where it has to go step by step."""
        from gcodesim.processes.milling_swing import milled_swinging

        return milled_swinging(self, stock, window, state, swings)

    def _step_of(self, out: Array, stock: Stock, window: Window, springs: Array | None = None) -> ProcessStep:
        """The kernel's output (n, OUTPUTS) as columns by name; views where nothing has to be converted.

        `springs` (n, 3) [m]: how much farther than commanded the tip goes in each step, where links have inertia.
        """
        from gcodesim.processes import milling_kernels as m

        removed = out[:, m.REMOVED]
        rapid = window.rapid & (removed > 0.0)
        bound, below = self._grazed(stock, window, springs) if rapid.any() else (0.0, 0.0)
        return ProcessStep(
            wrench=out[:, m.WRENCH : m.WRENCH + 6],
            deflection=out[:, m.DEFLECTION : m.DEFLECTION + 3],
            columns={
                "removed": removed,
                "engaged": out[:, m.ENGAGED] > 0.0,
                "torque": out[:, m.OUT_TORQUE],
                "power": out[:, m.POWER],
                "peak_force": out[:, m.PEAK],
                "peak_torque": out[:, m.PEAK_TORQUE],
                "axial_depth": out[:, m.OUT_DEPTH],
                "radial_width": out[:, m.OUT_WIDTH],
                "entry": out[:, m.OUT_ENTRY],
                "exit": out[:, m.OUT_EXIT],
                "chip_thickness": out[:, m.OUT_CHIP],
                "feed_force": out[:, m.FEED_FORCE],
                "side_force": out[:, m.SIDE_FORCE],
                "axial_force": _along_axis(out[:, m.WRENCH : m.WRENCH + 3], window.axis),
                "shank_depth": out[:, m.SHANK],
                "holder_depth": out[:, m.HOLDER],
                "stopped_cut": np.where(out[:, m.STOPPED] > 0.0, removed, 0.0),
                "reversed_cut": np.where(out[:, m.REVERSED] > 0.0, removed, 0.0),
                "rapid_cut": np.where(rapid, removed, 0.0),
                "rapid_bound": np.where(rapid, bound, 0.0),
                "rapid_depth": np.where(rapid, below, 0.0),
                "inside": out[:, m.INSIDE] > 0.0,
                **({} if not self.cutter.watched else self._load.columns(out, window)),
                **self._sideways(removed, window),
                **self._wear(out[:, m.ENGAGED] > 0.0, window),
            },
        )

    def _wear(self, engaged: NDArray[np.bool_], window: Window) -> dict[str, Array]:
        """Wear, if the cutter says how long its edges last."""
        if self.cutter.life is None:
            return {}
        return {WEAR.name: worn(self.cutter, window.signals[SPINDLE.name], engaged & ~window.rapid, window.dt)}

    def _sideways(self, removed: Array, window: Window) -> dict[str, Array]:
        """What a tool that cuts along its axis only takes while it goes another way."""
        if not self.cutter.axial:
            return {}
        along = _along_axis(window.velocity, window.axis)
        square = dots(window.velocity, window.velocity)
        across = square - along * along > ALONG * ALONG * square
        return {SIDEWAYS.name: np.where(across & ~window.rapid, removed, 0.0)}

    def _grazed(self, stock: Stock, window: Window, springs: Array | None) -> tuple[Array, Array]:
        """What a rapid may seem to remove (n,) [m³] while it only grazes: a layer of all wall that it passes.

        With what a tool takes that springs back when its cut ends: its section across the way by which it springs.
        And how deep (n,) [m] it is in the stock, along the axis of the tool.
        """
        exact = (window.axis[:, 2] > UPRIGHT) & (window.compliance is None) & (springs is None)
        layer = np.where(exact, GRAZED * stock.cell + SLACK, COARSE * stock.cell)
        way, step = window.piece_end - window.piece_start, window.piece_step
        axis = window.axis[step]
        low, high = stock.bounds
        # along the axis, from the tip to the farthest corner of the stock
        far = np.where(axis > 0.0, high, low)
        depth = np.maximum(dots(far - window.piece_start, axis), dots(far - window.piece_end, axis))
        depth = np.clip(depth, 0.0, dots(high - low, np.abs(axis)))
        along = np.abs(dots(way, axis))
        across = np.sqrt(np.maximum(dots(way, way) - along * along, 0.0))
        walls = 2.0 * across * depth + 2.0 * np.pi * self.zone.radius * along
        bound, below = np.zeros((2, window.steps))
        np.add.at(bound, step, layer[step] * walls)
        np.maximum.at(below, step, depth)
        if springs is not None:
            up = np.abs(dots(springs, window.axis))
            flat = np.sqrt(np.maximum(dots(springs, springs) - up * up, 0.0))
            bound += self.zone.radius * (2.0 * below * flat + np.pi * self.zone.radius * up)
        return bound, below

    @cached_property
    def _load(self) -> CutterLoad:
        return CutterLoad(self.cutter, self.law)

    @cached_property
    def packed_tool(self) -> MillingTool:
        """Cutter and law as the kernel takes them."""
        from gcodesim.material.solid_of_revolution import slabs_of_outline
        from gcodesim.processes.milling_kernels import CLEARANCE, MillingTool

        def thinner(frusta: tuple[Frustum, ...]) -> Array:
            rows = [
                shape._replace(radius=shape.radius - CLEARANCE, flat=max(shape.flat - CLEARANCE, 0.0))
                for shape in shapes_of(frusta)
            ]
            return np.array(rows, dtype=float).reshape(-1, 7)

        cutter = self.cutter
        form, shape = cutter.form, cutter.cutting_shape
        shank, holder = thinner(cutter.shank_frusta), thinner(cutter.holder_frusta)
        return MillingTool(
            teeth=self._teeth,
            cutter=shape,
            shank=shank,
            holder=holder,
            slabs=np.zeros((0, 6)) if form is None else slabs_of_outline(form, FORM_CELL * cutter.diameter),
            widest=max([float(shape.radius), *shank[:, 1].tolist(), *holder[:, 1].tolist()]),
        )

    @property
    def _teeth(self) -> Teeth:
        from gcodesim.processes.edge_kernels import ANGLES, Circle
        from gcodesim.processes.force_kernels import Teeth
        from gcodesim.processes.law_kernels import MEANS, TABLE, ForceLaw, fill_tables

        cutter = self.cutter
        law = np.array([[0.0, 1.0, 0.0]] * 3) if self.law is None else edge_law(cutter, self.law).packed
        factor, exponent, rub = (np.array(column, dtype=float) for column in law.T)
        powers, means = np.empty((3, TABLE)), np.empty((MEANS, ANGLES))
        fill_tables(exponent, powers, means)
        phi: Array = np.asarray((np.arange(ANGLES) + 0.5) * (2.0 * np.pi / ANGLES), dtype=np.float64)
        cosine, sine = cos_sin(phi)
        return Teeth(
            radius=float(cutter.radius),
            number=float(cutter.flutes),
            lag=tan(helices_of(cutter)[0]),
            height=float(cutter.edge_height),
            pieces=edge_pieces(cutter, self.law),
            law=ForceLaw(factor, exponent, rub, powers, means),
            circle=Circle(sine, cosine),
            uneven=packed_teeth(cutter, exponent),
        )

    @cached_property
    def _room(self) -> Room:
        from gcodesim.material.kernels import Places
        from gcodesim.processes.arrival_kernels import ARRIVALS, STEP
        from gcodesim.processes.edge_kernels import ANGLES, COLUMNS, LEAST_PIECES, SLICES
        from gcodesim.processes.engagement_kernels import Room
        from gcodesim.processes.force_kernels import SUMS
        from gcodesim.processes.peak_kernels import BORDERS, GAP, GAPS, MOST_OF_ROW, STRETCHES
        from gcodesim.processes.seam_kernels import NUMBERS, PLACES, SEAMS, Seams

        rows = SLICES * max(LEAST_PIECES, len(self.packed_tool.teeth.pieces))
        teeth = self.cutter.flutes if self.cutter.uneven else 1
        return Room(
            rows=np.zeros((rows, COLUMNS)),
            weights=np.zeros((rows, ANGLES)),
            sums=np.zeros((SUMS, ANGLES)),
            unit=np.zeros((5, ANGLES)),
            line=np.zeros(ANGLES),
            share=np.zeros(ANGLES),
            places=Places(np.zeros(ANGLES), np.zeros(ANGLES), np.zeros(ANGLES)),
            leans=np.zeros(ANGLES),
            seams=Seams(np.zeros((PLACES, SEAMS), dtype=np.int64), np.zeros((NUMBERS, SEAMS))),
            stretches=np.zeros((teeth * rows * MOST_OF_ROW, STRETCHES)),
            borders=np.zeros((2, BORDERS)),
            gaps=np.zeros((GAPS, GAP)),
            load=np.zeros(4),
            step=np.full(STEP, np.nan),
            arrivals=np.zeros((ARRIVALS, rows, ANGLES // 2)),
        )


def _along_axis(force: Array, axis: Array) -> Array:
    """Component (n,) of a force (n, 3) along the tool's axis (n, 3); of an upright tool that along Z."""
    leans = np.any(axis[:, :2] != 0.0, axis=1) | (axis[:, 2] < 0.0)
    return np.where(leans, dots(force, axis), force[:, 2]) if leans.any() else force[:, 2]


def of_steps(parts: Array, turns: Turns) -> Array:
    """The kernel's output (m, OUTPUTS) of the parts of n steps as that of the steps (n, OUTPUTS)."""
    from gcodesim.processes import milling_kernels as m

    if not turns.any:
        return parts
    out = parts[turns.first]
    number = np.diff(np.append(turns.first, len(parts)))
    turning = np.flatnonzero(number > 1)
    theirs = np.flatnonzero(number[turns.step] > 1)
    several, ends = parts[theirs], np.cumsum(number[turning])
    first = ends - number[turning]
    one: Array = np.maximum.reduceat(several, first, axis=0)
    means = [*range(m.WRENCH, m.WRENCH + 6), m.OUT_TORQUE, m.POWER, m.FEED_FORCE, m.SIDE_FORCE]
    one[:, means] = np.add.reduceat(several[:, means] * turns.share[theirs, None], first, axis=0)
    one[:, m.REMOVED] = np.add.reduceat(several[:, m.REMOVED], first)
    kept = [*range(m.DEFLECTION, m.DEFLECTION + 3), m.OUT_ENTRY, m.OUT_EXIT]
    one[:, kept] = several[ends - 1][:, kept]
    out[turning] = one
    return out


def turn_ahead(window: Window, cell: float) -> Array:
    """How much the way turns to the left (n,) [1/m] where material is looked for; NaN where that is not known.

    A sharp turn that ends soon is none: what is looked at lies behind it.
    """
    from gcodesim.processes.milling_kernels import LEAST_TURN

    if window.turn is None:
        return np.full(window.steps, np.nan)
    onward = TURN_AHEAD * cell
    turn = window.turn(onward)
    turn = np.where(np.abs(turn) * onward > SHARPEST_TURN, 0.0, turn)
    sharp = np.abs(turn) * onward > SHARP_TURN
    if sharp.any():
        later = window.turn(2.0 * onward)
        turn = np.where(sharp & (np.abs(later - turn) > SAME_TURN * np.abs(turn)), 0.0, turn)
    kept: Array = np.where(np.abs(turn) < LEAST_TURN, 0.0, turn)
    return kept


def packed_motion(window: Window, turns: Turns, cell: float) -> Motion:
    """The motion of a window as the kernel takes it: a copy, so that how its arrays lie does not matter.

    cell [m]: width of the cells in which it cuts.
    """
    from gcodesim.processes.milling_kernels import Motion

    step = turns.step
    return Motion(
        starts=np.array(window.piece_start, dtype=float, order="C").reshape(-1, 3),
        ends=np.array(window.piece_end, dtype=float, order="C").reshape(-1, 3),
        first_piece=turns.first_piece,
        axis=np.array(window.axis[step], dtype=float, order="C"),
        velocity=turns.velocity,
        turn=turn_ahead(window, cell)[step],
        spindle=np.array(window.signals[SPINDLE.name][step], dtype=float),
        rapid=np.array(window.rapid[step], dtype=np.bool_),
        compliance=np.zeros((0, 3, 6))
        if window.compliance is None
        else np.array(window.compliance[step][:, :3, :], dtype=float, order="C"),
    )

"""Cutting in stock with columns in three directions: with a tool that leans, and with one that stands upright."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.frozen import frozen
from gcodesim.material.axis_way import AxisWay, upright
from gcodesim.processes.turns import Turns
from gcodesim.processes.window import Window

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.processes.milling import Milling
    from gcodesim.processes.milling_kernels import MillingTool, Motion, State
    from gcodesim.processes.window import ProcessState

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

SKIN = 0.05
"""Cells of depth up to which shank and holder only touch the wall of a cut that the tool has just made."""

BESIDE: Final = 1.0
"""Cells that a tool is away from a stock at least where nothing of the stock is looked at."""


@frozen(kw_only=False, eq=False)
class Leaning:
    """In which parts (m,) of a window's steps a tool leans, and its axis at both ends of a step (n, 3).

    Parts that are cut at once begin at `fresh` ones (m,): see `Window`.
    """

    parts: Flags
    fresh: Flags
    before: Array
    after: Array
    window: Window
    first_piece: int = 0
    """Of the window; pieces count from it."""

    @staticmethod
    def of(window: Window, turns: Turns) -> Leaning:
        """For all parts of the steps of a window."""
        after = window.axis
        before = after if window.axis_before is None else window.axis_before
        leans = leaning_steps(window)[turns.step]
        fresh = np.zeros(len(leans), dtype=bool)
        if window.fresh is not None:
            fresh[turns.first[window.fresh]] = True
        return Leaning(leans, fresh, before, after, window)

    def axes(self, first: int, end: int) -> tuple[Array, Array]:
        """The axes (end - first, 3) of the tool in pieces first … end - 1, at both ends."""
        here, share = slice(self.first_piece + first, self.first_piece + end), self.window.piece_share
        step = self.window.piece_step[here]
        shares = np.tile([0.0, 1.0], (len(step), 1)) if share is None else share[here]
        ends = [self.before[step] + shares[:, side, None] * (self.after[step] - self.before[step]) for side in range(2)]
        return ends[0] / norms(ends[0])[:, None], ends[1] / norms(ends[1])[:, None]

    def part(self, here: slice, first_piece: int) -> Leaning:
        """That of some parts, of which the first begins with a piece of the window."""
        return Leaning(self.parts[here], self.fresh[here], self.before, self.after, self.window, first_piece)

    def runs(self) -> list[tuple[int, int, bool]]:
        """Stretches of parts (first, end, whether the tool leans) in order, which are cut at once."""
        borders = np.flatnonzero(np.diff(self.parts) | self.fresh[1:]) + 1
        ends = [0, *borders.tolist(), len(self.parts)]
        return [(a, b, bool(self.parts[a])) for a, b in pairwise(ends) if b > a]


def part_of(motion: Motion, a: int, b: int) -> Motion:
    """The motion of parts a … b - 1."""
    first, last = int(motion.first_piece[a]), int(motion.first_piece[b])
    return motion._replace(
        starts=motion.starts[first:last],
        ends=motion.ends[first:last],
        first_piece=motion.first_piece[a : b + 1] - first,
        axis=motion.axis[a:b],
        velocity=motion.velocity[a:b],
        turn=motion.turn[a:b],
        spindle=motion.spindle[a:b],
        rapid=motion.rapid[a:b],
        compliance=motion.compliance[a:b],
    )


def memory_of(values: Array) -> State:
    """Views of the state of the process; the kernel itself would return copies to Python."""
    from gcodesim.compiled import as_python
    from gcodesim.processes.milling_kernels import state_of

    return as_python(state_of)(values)


def felt_in(values: Array) -> Array:
    """A view of the mean wrench (6,) of the last step, in S, among the numbers that a process keeps."""
    from gcodesim.processes.milling_kernels import STATE

    return values[STATE : STATE + 6]


def told_way_in(values: Array) -> Array:
    """A view of what is kept of the commanded way (TOLD,), see `swing_kernels.follow_told`."""
    from gcodesim.processes.milling_kernels import STATE

    return values[STATE + 6 :]


def bend_of(values: Array) -> Array:
    """A copy of the bend (3,) [m] of the tip in the state of the process."""
    return np.array(memory_of(values).delta)


def cut_leaning(
    process: Milling, stock: Stock, motion: Motion, axes: tuple[Array, Array], state: ProcessState
) -> Array:
    """Cut parts in which the tool leans; columns as those of `mill`, wrench and deflection in S.

    `axes`: those of the pieces (c, 3) at both ends. A tool that was put in inside of material cuts nothing until it
    has left it.
    """
    from gcodesim.processes import milling_kernels as m
    from gcodesim.processes.leaning_force import feel_and_cut, pass_by

    tool, kept = process.packed_tool, memory_of(state.values)
    out = np.zeros((len(motion.spindle), m.OUTPUTS))
    way = AxisWay(motion.starts, motion.ends, *axes)
    if not len(way.starts):
        return out
    part = np.repeat(np.arange(len(out)), np.diff(motion.first_piece))
    others = [slabs_of_sections(part, stock.cell) for part in (tool.shank, tool.holder) if len(part)]
    if stock.columns_along == 1 and keeps_away(stock, way, [slabs_of_cutter(tool, stock.cell), *others]):
        pass_by(process, way, state)
        return out
    begin = 0
    if kept.numbers[m.FREEDOM] != m.FREE:
        begins = AxisWay(way.starts, way.starts, way.axes_start, way.axes_start)
        deep = np.max([stock.depths(begins, body) for body in (slabs_of_cutter(tool, stock.cell), *others)], axis=0)
        free = np.flatnonzero(deep <= SKIN * stock.cell)
        begin = int(free[0]) if len(free) else len(part)
        kept.numbers[m.FREEDOM] = m.FREE if len(free) else m.BLOCKED
    if begin < len(part):
        first = int(part[begin])
        rest = part_of(motion, first, len(out))
        skipped = begin - int(motion.first_piece[first])  # pieces of its step before it was free
        rest = rest._replace(
            starts=rest.starts[skipped:],
            ends=rest.ends[skipped:],
            first_piece=np.maximum(rest.first_piece - skipped, 0),
        )
        cut = AxisWay(*(ends[begin:] for ends in way))
        out[first:] = feel_and_cut(process, stock, rest, cut, state)
        for column, part_of_tool in ((m.SHANK, tool.shank), (m.HOLDER, tool.holder)):
            if len(part_of_tool):
                ends = AxisWay(cut.ends, cut.ends, cut.axes_end, cut.axes_end)
                deep = stock.depths(ends, slabs_of_sections(part_of_tool, stock.cell))
                np.maximum.at(out[:, column], part[begin:], np.where(deep > SKIN * stock.cell, deep, 0.0))
    out[part[:begin], m.INSIDE] = 1.0
    kept.tip[:] = way.ends[-1]
    kept.numbers[m.HAS_TIP] = 1.0
    _note_taken(motion, out)
    return out


def keeps_away(stock: Stock, way: AxisWay, bodies: list[Array]) -> bool:
    """Whether these bodies (m, 6) are nowhere on their way in the box of a stock, nor nearly so.

    An arm that changes its posture in a rapid leans its tool beside the stock, which then needs no columns across.
    """
    from gcodesim.material.lattice import sweep_rooms

    least, most = stock.bounds
    low, high = sweep_rooms(way, np.concatenate(bodies))
    room = BESIDE * stock.cell
    return bool(((low >= most + room) | (high <= least - room)).any(axis=1).all())


def slabs_of_cutter(tool: MillingTool, cell: float) -> Array:
    """The cutting part as slabs (m, 6) for stock with cells of the size `cell` [m]."""
    from gcodesim.material.solid_of_revolution import slabs_of_shape

    return tool.slabs if len(tool.slabs) else slabs_of_shape(tool.cutter, cell)


def slabs_of_sections(sections: Array, cell: float) -> Array:
    """Sections (k, 7) of a shank or holder as slabs (m, 6) for stock with cells of the size `cell` [m]."""
    from gcodesim.material.solid_of_revolution import slabs_of_shape
    from gcodesim.material.sweep_kernels import Shape

    return np.concatenate([slabs_of_shape(Shape(*row), cell) for row in sections.tolist()])


def cut_in_three(process: Milling, stock: Stock, motion: Motion, state: ProcessState) -> Array:
    """Cut parts of an upright tool in stock with columns in three directions, which it gets if it has none.

    `mill` cuts those along Z, and those across follow. What was removed is shared out anew, so that its sum is what the
    volume of the stock has fallen by.
    """
    from gcodesim.material.lattice import ensure_lattice, sweep_room, volume_near
    from gcodesim.processes import milling_kernels as m

    if not len(motion.starts):
        return process.run_packed(stock, motion, state)
    ensure_lattice(stock)
    cutter, before = slabs_of_cutter(process.packed_tool, stock.cell), bend_of(state.values)
    low, high = sweep_room(upright(motion.starts, motion.ends), cutter)
    room = None
    if not len(motion.compliance):  # then nothing bends, and only the columns nearby change
        room = (low - stock.cell, high + stock.cell)
    volume = stock.volume if room is None else volume_near(stock, room)
    out = process.run_packed(stock, motion, state)
    _follow(stock, cutter, motion, before, out)
    removed = volume - (stock.volume if room is None else volume_near(stock, room))
    out[:, m.REMOVED] = _shared_out(max(removed, 0.0), out[:, m.REMOVED], motion)
    _note_taken(motion, out)
    return out


def _shared_out(removed: float, along: Array, motion: Motion) -> Array:
    """A volume [m³] shared out to parts (m,) like what they took `along` Z; by their ways where that is nothing.

    Columns along Z are cut when the tool comes to their middles, those across as it goes.
    """
    if not along.any():
        part = np.repeat(np.arange(len(along)), np.diff(motion.first_piece))
        along = np.bincount(part, norms(motion.ends - motion.starts), len(along)).astype(float)
    total = float(along.sum())
    return along * (removed / total) if total > 0.0 else along


def _note_taken(motion: Motion, out: Array) -> None:
    """Parts that have taken material are engaged, and may do so with a spindle that stands or turns the wrong way."""
    from gcodesim.processes import milling_kernels as m

    taken = out[:, m.REMOVED] > m.LEAST_VOLUME
    out[taken, m.ENGAGED] = 1.0
    out[taken & ~motion.rapid & (motion.spindle == 0.0), m.STOPPED] = 1.0
    out[taken & ~motion.rapid & (motion.spindle < 0.0), m.REVERSED] = 1.0


def _follow(stock: Stock, cutter: Array, motion: Motion, before: Array, out: Array) -> None:
    """Cut the columns across like those along Z; `before` (3,) is the bend [m] of the tool at the beginning."""
    from gcodesim.processes import milling_kernels as m

    part = np.repeat(np.arange(len(out)), np.diff(motion.first_piece))
    cuts = out[part, m.INSIDE] == 0.0
    starts, ends = bent_pieces(motion, before, out)
    stock.follow(upright(starts[cuts], ends[cuts]), cutter)


def bent_pieces(motion: Motion, before: Array, out: Array) -> tuple[Array, Array]:
    """Where pieces (c, 3) [m] go when the bend is `before` (3,) at first and then what `out` (m, OUTPUTS) says."""
    from gcodesim.processes import milling_kernels as m

    pieces = np.diff(motion.first_piece)
    part = np.repeat(np.arange(len(pieces)), pieces)
    place = np.arange(len(part)) - motion.first_piece[:-1][part]
    late = out[:, m.DEFLECTION : m.DEFLECTION + 3]
    early = np.concatenate([before[None], late[:-1]])
    share = np.column_stack([place, place + 1]) / np.maximum(pieces[part], 1)[:, None]
    bend = (late - early)[part]
    starts = motion.starts + early[part] + share[:, :1] * bend
    return starts, motion.ends + early[part] + share[:, 1:] * bend


def leaning_steps(window: Window) -> NDArray[np.bool_]:
    """Where (n,) the tool leans at the beginning or at the end of a step."""
    from gcodesim.processes.milling_kernels import LARGEST_TILT

    leans = np.zeros(window.steps, dtype=bool)
    for axis in (window.axis, window.axis if window.axis_before is None else window.axis_before):
        level = axis[:, 0] * axis[:, 0] + axis[:, 1] * axis[:, 1]
        leans |= (level > LARGEST_TILT * LARGEST_TILT) | (axis[:, 2] <= 0.0)
    return leans

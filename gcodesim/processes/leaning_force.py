"""Force and bend of a tool that leans: the laws of the upright one in a frame of its own.

The laws look at slices across the tool's axis. So what is around the tool is read from the columns in three
directions as columns along its axis (`material.tilted`), and the steps are run there as those of an upright tool are;
what the bent tool then sweeps is cut from the stock itself. While the axis keeps its direction, steps share such a
field, and forces are those of an upright cut but for how well an earlier surface was read, a few hundredths of a
cell. Where the axis turns, chips are those of the motion of the tip; how the turn moves the edges above it is left out.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, multiplied, norms
from gcodesim.material.axis_way import AxisWay
from gcodesim.processes.leaning import bend_of, bent_pieces, memory_of, part_of, slabs_of_cutter

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gcodesim.material.kernels import Field
    from gcodesim.material.stock import Stock
    from gcodesim.processes.milling import Milling
    from gcodesim.processes.milling_kernels import Motion
    from gcodesim.processes.window import ProcessState

Array = NDArray[np.float64]

TURN: Final = 0.25
"""Cells by which an edge may be aside, because the axis turns, where steps share a field."""

WIDE: Final = 8.0
"""Radii of a cutter that such a field is wider than its cutter."""

AROUND: Final = 4.0
"""Cells of material that are read around the cutter,"""

BELOW: Final = 8.0
"""and below its tip: how far ahead the laws look."""

SAME_AXIS: Final = 1e-9


def feel_and_cut(process: Milling, stock: Stock, motion: Motion, way: AxisWay, state: ProcessState) -> Array:
    """Force, bend and removal of parts (m,) along pieces whose axes `way` has; out (m, OUTPUTS) in S."""
    from gcodesim.processes import milling_kernels as m

    cutter = slabs_of_cutter(process.packed_tool, stock.cell)
    outs = []
    for a, b in _stretches(process, stock, motion, way):
        some = part_of(motion, a, b)
        first, last = int(motion.first_piece[a]), int(motion.first_piece[b])
        before, credit = bend_of(state.values), float(memory_of(state.values).numbers[m.CREDIT])
        out = np.zeros((b - a, m.OUTPUTS))
        if process.law is not None:
            out = _feel(process, stock, some, way.axes_end[max(last - 1, 0)], state)
        if last > first:
            part = np.repeat(np.arange(b - a), np.diff(some.first_piece))
            cut = AxisWay(*bent_pieces(some, before, out), way.axes_start[first:last], way.axes_end[first:last])
            out[:, m.REMOVED] = 0.0
            np.add.at(out[:, m.REMOVED], part, stock.sweep(cut, cutter))
            _forget_untrue(some, out, stock.cell, credit, state)
        outs.append(out)
    return np.concatenate(outs)


def pass_by(process: Milling, way: AxisWay, state: ProcessState) -> None:
    """What a tool remembers that leans away from its stock: the same as after `feel_and_cut` in empty space."""
    from gcodesim.processes import milling_kernels as m

    kept = memory_of(state.values)
    if process.law is not None:
        _enter(state.values, way.axes_end[-1])
        kept.delta[:] = 0.0
        kept.numbers[m.CUTTING] = 0.0
    kept.numbers[m.CREDIT] -= norms(way.ends - way.starts).sum()
    kept.numbers[m.FREEDOM] = m.FREE
    kept.tip[:] = way.ends[-1]
    kept.numbers[m.HAS_TIP] = 1.0


def _forget_untrue(motion: Motion, out: Array, cell: float, credit: float, state: ProcessState) -> None:
    """No force where nothing is removed nearby, by the same measure as in `mill`.

    A surface that was read from other columns is not quite where the tool left it, and a tool that falls towards a
    floor looks ahead into it. `credit` [m] is how far force counts from the beginning on.
    """
    from gcodesim.processes import milling_kernels as m

    length = norms(motion.ends - motion.starts)
    way = np.add.reduceat(np.append(length, 0.0), motion.first_piece[:-1]) * (np.diff(motion.first_piece) > 0)
    taken = out[:, m.REMOVED] > np.minimum(m.PLAIN_SECTION * way, m.COLUMN_CUT * cell) * cell * cell
    end = np.cumsum(way)
    reach = np.maximum.accumulate(np.where(taken & (way > 0.0), end + m.CREDIT_CELLS * cell, credit))
    counts = taken | (np.append(credit, reach[:-1]) > end - way)
    memory_of(state.values).numbers[m.CREDIT] = reach[-1] - end[-1]
    felt = [c for c in range(m.OUTPUTS) if c != m.REMOVED and not m.DEFLECTION <= c < m.DEFLECTION + 3]
    out[np.ix_(~counts, felt)] = 0.0


def _stretches(process: Milling, stock: Stock, motion: Motion, way: AxisWay) -> Iterator[tuple[int, int]]:
    """Runs of parts (first, end) that may share a field: nearly one axis, not too far apart."""
    parts = len(motion.spindle)
    if process.law is None:
        yield 0, parts
        return
    shape = process.packed_tool.cutter
    low, high = stock.bounds
    reach = min(float(shape.top), float(norms((high - low)[None])[0]))
    turn = TURN * stock.cell / reach
    piece = np.maximum(motion.first_piece[1:] - 1, 0)  # the last of each part
    a = 0
    while a < parts:
        begin = int(motion.first_piece[a])
        axis, tip = way.axes_start[begin] if begin < len(way.starts) else way.axes_end[-1], way.ends[piece[a]]
        # looked at in bundles, because one that goes on for long need not be looked at to its end
        b = a + 1
        while b < parts:
            some = piece[b : b + 64]
            apart = norms(way.ends[some] - tip) > WIDE * shape.radius
            apart |= norms(way.axes_end[some] - axis) > turn
            if apart.any():
                b += int(np.argmax(apart))
                break
            b = min(b + 64, parts)
        yield a, b
        a = b


def _feel(process: Milling, stock: Stock, motion: Motion, axis: Array, state: ProcessState) -> Array:
    """What `mill` says of parts (m,) with this axis (3,), in S; the stock stays as it is, `state` goes on."""
    from gcodesim.material.stock import widened
    from gcodesim.material.tilted import tilted_frame
    from gcodesim.processes import milling_kernels as m

    frame, tool = tilted_frame(axis), process.packed_tool
    back = np.ascontiguousarray(frame.T)
    kept = memory_of(state.values)
    out = np.zeros((len(motion.spindle), m.OUTPUTS))
    _enter(state.values, axis)
    tip = motion.starts[0] if len(motion.starts) else np.array(kept.tip)
    for vector in (kept.delta, kept.before, kept.tip):
        vector[:] = applied(back, vector)
    local = in_frame(motion, frame)
    field = seen_by(process, stock, local, frame, kept.delta, tip=applied(back, tip))
    if field is None:
        kept.delta[:] = 0.0
        kept.numbers[m.CUTTING] = 0.0
    else:
        alone = tool._replace(shank=np.zeros((0, 7)), holder=np.zeros((0, 7)), widest=float(tool.cutter.radius))
        while m.mill(field, alone, local, process._room, state.values, out) < len(out):
            field = widened(field)
    for vector in (kept.delta, kept.before, kept.tip):
        vector[:] = applied(frame, vector)
    for column in (m.WRENCH, m.WRENCH + 3, m.DEFLECTION):
        out[:, column : column + 3] = applied(frame, out[:, column : column + 3])
    return out


def _enter(values: Array, axis: Array) -> None:
    """Forget the directions of the last step when they belong to another axis."""
    from gcodesim.processes import milling_kernels as m

    kept = memory_of(values)
    last = m.axis_of(values)
    kept.patch[:] = 0.0
    if float(norms((last - axis)[None])[0]) > SAME_AXIS:
        kept.numbers[m.CUTTING] = 0.0
        for vector in (kept.feed, kept.travel, kept.chips, kept.edges, kept.turn):
            vector[:] = 0.0
        last[:] = axis


def leave(values: Array) -> None:
    """The tool stands upright again."""
    from gcodesim.processes import milling_kernels as m

    if m.axis_of(values).any():
        _enter(values, np.zeros(3))


def in_frame(motion: Motion, frame: Array) -> Motion:
    """The motion in axes of `frame` (3, 3), in which the tool is upright."""
    back = np.ascontiguousarray(frame.T)
    compliance = motion.compliance
    if len(compliance):
        halves = [multiplied(back, np.ascontiguousarray(compliance[:, :, k : k + 3]), frame) for k in (0, 3)]
        compliance = np.concatenate(halves, axis=2)
    return motion._replace(
        starts=np.ascontiguousarray(applied(back, motion.starts)),
        ends=np.ascontiguousarray(applied(back, motion.ends)),
        axis=np.tile([0.0, 0.0, 1.0], (len(motion.spindle), 1)),
        velocity=np.ascontiguousarray(applied(back, motion.velocity)),
        turn=np.full(len(motion.spindle), np.nan),
        compliance=np.ascontiguousarray(compliance),
    )


def seen_by(
    process: Milling, stock: Stock, local: Motion, frame: Array, bend: Array, *, tip: Array | None = None
) -> Field | None:
    """The material around the way of a tool in its frame, without what is where the tool is; None: there is no stock.

    `bend` (3,) [m]; `tip` (3,) is where it begins, if not where its way does.
    """
    from gcodesim.material.stock import widened
    from gcodesim.processes import milling_kernels as m

    field = _field_around(process, stock, local, frame, bend)
    if field is None:
        return None
    here = (local.starts[0] if tip is None else tip) + bend
    while not m.remove_standing(field, here, process.packed_tool):
        field = widened(field)
    return field


def _field_around(process: Milling, stock: Stock, local: Motion, frame: Array, bend: Array) -> Field | None:
    """The material around the way of a tool with a bend (3,) [m], in its frame; None where there is no stock."""
    from gcodesim.material.tilted import tilted_field

    if not len(local.starts):
        return None
    shape, cell = process.packed_tool.cutter, stock.cell
    tips = np.concatenate([local.starts, local.ends])
    aside = float(shape.radius) + AROUND * cell
    if len(local.compliance):
        aside += float(shape.radius) + 2.0 * float(norms(bend[None])[0])
    low = tips.min(axis=0) - np.array([aside, aside, BELOW * cell])
    high = tips.max(axis=0) + np.array([aside, aside, float(shape.top) + cell])
    least, most = stock.bounds
    corners = np.array(list(product(*zip(least, most, strict=True))))
    seen = applied(np.ascontiguousarray(frame.T), corners)
    low = np.maximum(low, seen.min(axis=0) - 2.0 * cell)
    high = np.minimum(high, seen.max(axis=0) + 2.0 * cell)
    return None if bool((low >= high).any()) else tilted_field(stock, frame, low, high)

"""The way of a tip through a step in which nothing but masses, motors and the cut itself holds it.

`balance_kernels` finds how fast the tip goes and what it feels; here this becomes a motion that `Milling` then cuts as
one that is commanded, with chips of the way and speed that the tip really has.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.frozen import frozen
from gcodesim.material.tilted import tilted_frame
from gcodesim.processes.leaning import felt_in, memory_of, part_of, told_way_in
from gcodesim.processes.leaning_force import in_frame, seen_by

if TYPE_CHECKING:
    from gcodesim.material.kernels import Field
    from gcodesim.material.stock import Stock
    from gcodesim.processes.milling import Milling
    from gcodesim.processes.milling_kernels import Motion
    from gcodesim.processes.window import ProcessState

Array = NDArray[np.float64]


@frozen(kw_only=True, eq=False)
class FreeStep:
    """A step of `dt` [s] in m parts, each with its `share` (m,) of it, as the tip would make it alone: `motion`.

    `told` (m, 3) [m/s] is the velocity of the command, `begin` (c, 3) [m] where its pieces begin, `piece_share` (c, 2)
    where in the step each begins and ends. A wrench moves the tip by `response` (3, 6) of it besides. `leans`: the tool
    does not stand upright.
    """

    motion: Motion
    dt: float
    share: Array
    told: Array
    begin: Array
    piece_share: Array
    response: Array
    leans: bool


class FreeWay(NamedTuple):
    """How the tip really goes through a step, and what it feels (m, 6) in each of its parts, in S."""

    motion: Motion
    wrench: Array


def free_way(process: Milling, stock: Stock, step: FreeStep, state: ProcessState) -> FreeWay:
    """Solve the parts of a step one after another. The stock stays as it is, and so does what `mill` keeps."""
    motion = step.motion
    starts, ends, velocity = motion.starts.copy(), motion.ends.copy(), motion.velocity.copy()
    wrench, felt, off, begin = np.zeros((len(step.share), 6)), np.array(felt_in(state.values)), np.zeros(3), 0.0
    for part, share in enumerate(step.share):
        pieces = slice(int(motion.first_piece[part]), int(motion.first_piece[part + 1]))
        if pieces.stop > pieces.start and _turns_in(process, motion, part):
            alone = part_of(motion, part, part + 1)
            alone = alone._replace(starts=alone.starts + off, ends=alone.ends + off)
            more, wrench[part], velocity[part] = _part_way(process, stock, step, alone, part, felt, state)
            late = step.dt * (step.piece_share[pieces] - begin)
            starts[pieces] += off + late[:, :1] * more
            ends[pieces] += off + late[:, 1:] * more
            off, felt = off + step.dt * share * more, wrench[part]
        else:
            starts[pieces] += off
            ends[pieces] += off
        begin += share
    return FreeWay(motion._replace(starts=starts, ends=ends, velocity=velocity), wrench)


def _turns_in(process: Milling, motion: Motion, part: int) -> bool:
    """Whether there may be chips in a part."""
    return process.law is not None and motion.spindle[part] > 0.0 and not motion.rapid[part]


def _part_way(
    process: Milling, stock: Stock, step: FreeStep, alone: Motion, part: int, felt: Array, state: ProcessState
) -> tuple[Array, Array, Array]:
    """How much faster (3,) [m/s] the tip is than alone, its wrench (6,), and the velocity (3,) of which its chips are.

    `alone` is the part as the tip would make it alone, from where it is; `felt` (6,) the wrench before.
    """
    from gcodesim.processes.balance_kernels import FreeCut, Give, balance
    from gcodesim.processes.force_kernels import RESULT
    from gcodesim.processes.swing_kernels import follow_told

    values, kept = state.values.copy(), memory_of(state.values)
    frame = tilted_frame(alone.axis[0]) if step.leans else np.eye(3)
    back = np.ascontiguousarray(frame.T)
    local = in_frame(alone, frame) if step.leans else alone
    bend = applied(back, kept.delta) if step.leans else np.array(kept.delta)
    if step.leans:
        memory_of(values).turn[:] = 0.0
    else:
        begin = np.ascontiguousarray(step.begin[step.motion.first_piece[part]])
        told, turn = np.ascontiguousarray(step.told[part]), float(step.motion.turn[part])
        follow_told(begin, told, turn, stock.cell, told_way_in(state.values), values)
    field: Field | None = seen_by(process, stock, local, frame, bend) if step.leans else stock.view(alone.axis[0])
    nothing = np.zeros(3), np.zeros(6), alone.velocity[0]
    if field is None:
        return nothing
    told_feed = memory_of(values).feed
    feed = np.array(told_feed) if told_feed.any() else np.array([1.0, 0.0])
    time = step.dt * float(step.share[part])
    rate = float(alone.spindle[0]) * process.packed_tool.teeth.number / (2.0 * np.pi)
    cut = FreeCut(
        ends=np.array([local.starts[0] + bend, local.ends[-1] + bend]),
        teeth_rate=rate,
        told=applied(back, step.told[part]),
        feed=feed,
        hold=stock.cell / time,
        time=time,
    )
    halves = [multiplied(back, np.ascontiguousarray(step.response[:, k : k + 3]), frame) for k in (0, 3)]
    give = Give(np.array(local.velocity[0]), np.ascontiguousarray(np.concatenate(halves, axis=1)) / step.dt)
    before = np.concatenate([applied(back, felt[:3]), applied(back, felt[3:])])
    v, result = give.alone + applied(give.more, before), np.zeros(RESULT)
    chips = np.zeros(3)
    if not balance(field, process.packed_tool, cut, give, process._room, values, v, chips, result):
        return nothing
    wrench = np.concatenate([applied(frame, result[:3]), applied(frame, result[3:6])])
    return applied(frame, v - give.alone), wrench, applied(frame, chips)

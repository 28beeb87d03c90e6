"""A window that is milled by a tip that swings on the gears of its machine, all steps in one compiled call."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.processes.leaning import leaning_steps
from gcodesim.processes.leaning_force import leave
from gcodesim.processes.milling import of_steps, packed_motion
from gcodesim.processes.turns import Turns
from gcodesim.processes.window import Array, ProcessState, ProcessStep, Window

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.processes.milling import Milling
    from gcodesim.processes.milling_kernels import Motion
    from gcodesim.processes.swing_kernels import Swings


def swung_steps(process: Milling, stock: Stock, window: Window) -> NDArray[np.bool_]:
    """The steps (n,) that take one call: not those of tools that lean, bend or have a form.

    Nor those in stock with columns in three directions.
    """
    tool = process.packed_tool
    if process.bends or len(tool.slabs) or stock.columns_along != 1:
        return np.zeros(window.steps, dtype=bool)
    upright: NDArray[np.bool_] = ~leaning_steps(window)
    return upright


def milled_swinging(
    process: Milling, stock: Stock, window: Window, state: ProcessState, swings: Swings
) -> ProcessStep | None:
    """What `MillingLoop` does in the steps of a window, on gears as `swings` (in S) tell; `swings.winds` is filled.

    None where this takes more than one call, see `swung_steps`. Nothing has happened then.
    """
    from gcodesim.processes import milling_kernels as m
    from gcodesim.processes.swing_kernels import STOP, SwingParts, mill_swinging

    turns, tool = Turns.of(window), process.packed_tool
    if not swung_steps(process, stock, window).all():
        return None
    motion = packed_motion(window, turns, stock.cell)
    motion = motion._replace(velocity=motion.velocity.copy())
    share = np.tile([0.0, 1.0], (len(motion.starts), 1)) if window.piece_share is None else window.piece_share
    goes = np.diff(motion.first_piece) > 0
    begin = np.zeros((len(turns.step), 3))
    begin[goes] = motion.starts[motion.first_piece[:-1][goes]]
    parts = SwingParts(
        step=np.array(turns.step, dtype=np.int64),
        share=np.array(turns.share, dtype=float),
        told=motion.velocity.copy(),
        begin=begin,
        piece_share=np.array(share, dtype=float, order="C"),
        feels=goes & (process.law is not None) & (motion.spindle > 0.0) & ~motion.rapid,
    )
    leave(state.values)
    out, stop = np.zeros((len(parts.step), m.OUTPUTS)), np.zeros(STOP)
    while True:
        field = stock.view(motion.axis[0])
        done = mill_swinging(field, tool, motion, parts, swings, stop, process._room, state.values, out)
        if done == len(parts.step):
            springs = _springs(motion, window, turns)
            return process._step_of(of_steps(out, turns), stock, window, springs)
        stock.grow()


def _springs(motion: Motion, window: Window, turns: Turns) -> Array:
    """How much farther (n, 3) [m] than commanded the tip goes in each step, along its pieces."""
    springs = np.zeros((window.steps, 3))
    borders = np.append(turns.first_piece[turns.first], len(window.piece_step))
    goes = np.flatnonzero(np.diff(borders) > 0)
    first, last = borders[goes], borders[goes + 1] - 1
    told = window.piece_end[last] - window.piece_start[first]
    springs[goes] = motion.ends[last] - motion.starts[first] - told
    return springs

"""A window that is milled step by step, for a world that reacts to every wrench with a motion of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, dot, dots, norms
from gcodesim.processes.free_tip import FreeStep, free_way
from gcodesim.processes.leaning import Leaning, felt_in, memory_of, part_of
from gcodesim.processes.milling import of_steps
from gcodesim.processes.turns import Turns
from gcodesim.processes.window import ProcessState, ProcessStep, Window

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.processes.milling import Milling
    from gcodesim.processes.milling_kernels import Motion

Array = NDArray[np.float64]


TREMBLE: Final = 0.3
"""Share of its speed with which a tip may move along its axis and still be said to rest on the floor that it cuts."""


class MillingLoop:
    """A window that is cut step by step; anything that each step needs is made once."""

    yields: ClassVar[bool] = True
    """`step` takes how the machine gives way during the step."""

    def __init__(self, process: Milling, stock: Stock, window: Window, state: ProcessState) -> None:
        self._process, self._stock, self._window, self._state = process, stock, window, state
        self._turns = Turns.of(window)
        self._motion = process._motion_of(window, self._turns, stock.cell)
        self._bend: Array | None = None  # (p, 3, 6) of a tool that bends in a machine that answers for itself
        if window.compliance is None and len(self._motion.compliance):
            self._bend = self._motion.compliance
            self._motion = self._motion._replace(compliance=self._motion.compliance[:0])
        self._leaning = Leaning.of(window, self._turns)
        self._last = np.append(self._turns.first[1:], len(self._turns.step))
        self._springs = np.zeros((window.steps, 3))
        self._out: list[Array] = []

    def step(self, k: int, moved_before: Array, moved: Array, share: Array, response: Array | None = None) -> Array:
        """Step `k`, in order. The tip is off the window's pieces by `moved_before` … `moved` (3,) [m] if alone.

        `share` (c, 2) tells where in its step each piece begins and ends. Wrench (6,) on the tool in S. Under a wrench
        F the machine moves the tip by `response` (3, 6) F more in this step, if it does. Chips are those of the way and
        the speed that the tip really has.
        """
        way = self._free if self._window.compliance is None else self._yielding
        out = way(k, moved_before, moved, share, np.zeros((3, 6)) if response is None else response)
        self._out.append(out)
        share_of_parts = self._turns.share[self._parts(k)]
        wrench: Array = out[0, :6] if len(out) == 1 else applied(out[:, :6].T, share_of_parts)
        felt_in(self._state.values)[:] = wrench
        return wrench

    def _parts(self, k: int) -> slice:
        """The parts of a step."""
        return slice(int(self._turns.first[k]), int(self._last[k]))

    def _free(self, k: int, moved_before: Array, moved: Array, share: Array, response: Array) -> Array:
        """A step in which links, motors and the cut decide where the tip goes; out (m, OUTPUTS)."""
        from gcodesim.processes import milling_kernels as m

        here, dt = self._parts(k), float(np.broadcast_to(self._window.dt, len(self._last))[k])
        if self._bend is not None:  # it stands bent by the wrench before, and is straight in the end if none is left
            moved_before = moved_before + applied(self._bend[here.start], felt_in(self._state.values))
            response = response + self._bend[here.start]
        step, first = self._moved(here, moved_before, moved - moved_before, share)
        alone = FreeStep(
            motion=step._replace(velocity=step.velocity + (moved - moved_before) / dt),
            dt=dt,
            share=self._turns.share[here],
            told=step.velocity,
            begin=self._motion.starts[first : first + len(step.starts)],
            piece_share=share[first : first + len(step.starts)],
            response=response,
            leans=bool(self._leaning.parts[here].any()),
        )
        went = free_way(self._process, self._stock, alone, self._state)
        self._springs[k] = farther(went.motion, self._motion, first)
        out = self._process.run_parts(self._stock, went.motion, self._leaning.part(here, first), self._state)
        felt = out[:, m.ENGAGED] > 0.0
        out[:, m.WRENCH : m.WRENCH + 6] = np.where(felt[:, None], went.wrench, 0.0)
        return out

    def _moved(self, here: slice, moved_before: Array, way: Array, share: Array) -> tuple[Motion, int]:
        """The commanded motion of parts, off the command by `moved_before`, and by `way` more in the end; first piece.

        Its velocity is that of the command.
        """
        motion = self._motion
        a, b = int(motion.first_piece[here.start]), int(motion.first_piece[here.stop])
        step = part_of(motion, here.start, here.stop)
        starts, ends = (motion.starts, motion.ends)
        return step._replace(
            starts=starts[a:b] + moved_before + share[a:b, :1] * way,
            ends=ends[a:b] + moved_before + share[a:b, 1:] * way,
        ), a

    def _yielding(self, k: int, moved_before: Array, moved: Array, share: Array, response: Array) -> Array:
        """A step of a machine whose gears give way without inertia, and whose motors are at their limit.

        What moves under a wrench is solved together with the bend of the gears, of which it is then no part.
        """
        values, here = self._state.values, self._parts(k)
        # the way of the tip as it goes on under the wrench of the last step: what is left to solve is small
        gone = applied(response[None], felt_in(values)[None])[0]
        moved_before = moved_before - gone
        kept = memory_of(values)
        kept.delta[:] += gone
        bend = moved - moved_before
        step, first = self._moved(here, moved_before, bend, share)
        velocity = step.velocity + across(bend, step.axis) / self._window.dt
        # gears have no inertia here: what throws the tip about is a motor at its limit
        velocity = fallen(velocity, bend / self._window.dt, step.axis)
        self._turn_back(velocity[0])
        both = np.ascontiguousarray(np.tile(response, (len(velocity), 1, 1))) + step.compliance
        step = step._replace(velocity=velocity, compliance=both)
        out = self._process.run_parts(self._stock, step, self._leaning.part(here, first), self._state)
        self._leave_to_machine(out, response)
        return out

    def _turn_back(self, velocity: Array) -> None:
        """A tip that is thrown back does not turn on its way: chips are those of this way, wherever it went before."""
        kept = memory_of(self._state.values)
        if not self._leaning.parts.any() and dot(kept.travel, velocity[:2]) < 0.0:
            kept.travel[:] = 0.0

    def _leave_to_machine(self, out: Array, response: Array) -> None:
        """Take what the machine has moved under the wrench off the bend of the tool: the next step begins there."""
        from gcodesim.processes import milling_kernels as m

        moved = applied(response, out[:, m.WRENCH : m.WRENCH + 6])
        out[:, m.DEFLECTION : m.DEFLECTION + 3] -= moved
        kept = memory_of(self._state.values)
        kept.delta[:] = out[-1, m.DEFLECTION : m.DEFLECTION + 3]

    def finish(self) -> ProcessStep:
        """The outcome of all steps."""
        out = of_steps(np.concatenate(self._out), self._turns)
        return self._process._step_of(out, self._stock, self._window, self._springs)


def farther(went: Motion, told: Motion, first: int) -> Array:
    """How much farther (3,) [m] a tip goes than it was told to, whose pieces are those of `told` from `first` on."""
    last = len(went.starts) - 1
    if last < 0:
        return np.zeros(3)
    way: Array = went.ends[last] - went.starts[0] - told.ends[first + last] + told.starts[first]
    return way


def across(way: Array, axis: Array) -> Array:
    """The part (m, 3) of a way (3,) that goes across the axes (m, 3) of a tool.

    A tool that trembles along its axis would plunge in one step and hover in the next, with the edge forces of all of
    its bottom or none; what it really does is to rest on the floor. So at the bottom chips are those of the command.
    """
    along = dots(axis, np.broadcast_to(way, axis.shape))
    return way - along[:, None] * axis


def fallen(velocity: Array, besides: Array, axis: Array) -> Array:
    """Velocities (m, 3) with the part of `besides` (3,) along the axes (m, 3), where that is more than a tremble."""
    along = dots(axis, np.broadcast_to(besides, axis.shape))
    trembles = np.abs(along) < TREMBLE * norms(velocity)
    return velocity + np.where(trembles, 0.0, along)[:, None] * axis

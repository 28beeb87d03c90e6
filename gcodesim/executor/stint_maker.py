"""Makes stints: the motion of some steps as one process at one target sees it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import atan2
from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied
from gcodesim.executor.part_run import PartRun, PartsTarget
from gcodesim.executor.stint import Stint, compliance_seen_from, is_near
from gcodesim.executor.switching import Switching
from gcodesim.executor.tasks import RowColumns, Task
from gcodesim.executor.window import Ints, StepWindow
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics import compliance
from gcodesim.processes.signal import Signal
from gcodesim.processes.window import Window
from gcodesim.shop import Shop

Flags = NDArray[np.bool_]

_BOTH_ENDS: Final = (0.0, 1.0)


@frozen(kw_only=False, eq=False)
class StepSpan:
    """Steps `begin` to `end` of a window, all with one tool.

    `jacobian` gives the Jacobians of its tip (n, 6, j) in base axes; a rigid machine does not ask for them. None: the
    world itself moves the gears, so that they are no matter of the process.
    """

    steps: StepWindow
    begin: int
    end: int
    jacobian: Callable[[], Array] | None

    @property
    def here(self) -> slice:
        return slice(self.begin, self.end)

    @property
    def first(self) -> int:
        """The number of its first step in the run."""
        return self.steps.first + self.begin

    def __len__(self) -> int:
        return self.end - self.begin


@frozen(eq=False)
class Chords:
    """The way of the tip in a span seen from a target: c pieces from `start` to `stop` (c, 3) [m], each in its `step`,
    in `share` (c, 2) of it, of path `row`; `filament` (c,) [m] if there is any.

    `R_SB` (1 or n, 3, 3) turns from base axes into those of the target at the ends of steps, `R_before` does so at
    their beginnings; `moves` (n,) are the steps in which it moves itself, None: it does so in none.
    """

    start: Array
    stop: Array
    step: Ints
    share: Array
    row: Ints
    filament: Array | None
    R_SB: Array
    R_before: Array
    moves: Flags | None = None

    @staticmethod
    def of(span: StepSpan, first_X: Array, X_BS: Array) -> Chords:
        """Seen from a target that is at X_BS (n, 4, 4) at the ends of steps, and comes from `first_X` (1, 4, 4)."""
        steps, held = span.steps, np.concatenate([first_X, X_BS[:-1]])
        moves = (X_BS[:, :3] != held[:, :3]).any(axis=(1, 2))
        if moves.any():
            return Chords._of_moving(span, held, X_BS, moves)
        first, last = np.searchsorted(steps.piece_step, [span.begin, span.end])
        R_SB, p = X_BS[:1, :3, :3].transpose(0, 2, 1), X_BS[0, :3, 3]
        return Chords(
            start=applied(R_SB, steps.piece_start[first:last] - p),
            stop=applied(R_SB, steps.piece_end[first:last] - p),
            step=steps.piece_step[first:last] - span.begin,
            share=steps.piece_share[first:last],
            row=steps.piece_row[first:last],
            filament=None if steps.piece_filament is None else steps.piece_filament[first:last],
            R_SB=R_SB,
            R_before=R_SB,
        )

    @staticmethod
    def _of_moving(span: StepSpan, held: Array, X_BS: Array, moves: Flags) -> Chords:
        """The table turns or travels in some steps, which are chords between their ends; others have their pieces."""
        steps, here, moving = span.steps, span.here, np.flatnonzero(moves)
        first, last = np.searchsorted(steps.piece_step, [span.begin, span.end])
        within = steps.piece_step[first:last] - span.begin
        still = ~moves[within]
        standing, pieces = X_BS[within[still]], slice(first, last)
        step = np.concatenate([within[still], moving])
        order = np.argsort(step, kind="stable")

        def joined(of_pieces: NDArray[Any], of_steps: NDArray[Any]) -> NDArray[Any]:
            return np.concatenate([of_pieces, of_steps])[order]

        filament, whole = steps.piece_filament, _of_steps(span)
        return Chords(
            start=joined(
                _into(standing, steps.piece_start[pieces][still]),
                _into(held[moves], steps.tip_before[here][moves, :3, 3]),
            ),
            stop=joined(
                _into(standing, steps.piece_end[pieces][still]), _into(X_BS[moves], steps.tip[here][moves, :3, 3])
            ),
            step=step[order],
            share=joined(steps.piece_share[pieces][still], np.tile(_BOTH_ENDS, (len(moving), 1))),
            row=joined(steps.piece_row[pieces][still], steps.row[here][moves]),
            filament=None if filament is None or whole is None else joined(filament[pieces][still], whole[moves]),
            R_SB=X_BS[:, :3, :3].transpose(0, 2, 1),
            R_before=held[:, :3, :3].transpose(0, 2, 1),
            moves=moves,
        )

    def velocity(self, dt: Array) -> Array:
        """Mean velocity (n, 3) [m/s] in steps that take `dt` (n,) [s]."""
        velocity = np.zeros((len(dt), 3))
        np.add.at(velocity, self.step, (self.stop - self.start) / dt[self.step, None])
        return velocity

    def turn(self, span: StepSpan) -> Callable[[float], Array] | None:
        """`Window.turn` of a span; NaN in steps in which the target moves, too, and None if it does so in all.

        Each part of a window asks for the turns of all of it; where tools cut together these are hundreds.
        """
        moves = self.moves
        if moves is not None and moves.all():
            return None

        @cache
        def turn(onward: float) -> Array:
            first, second, way = (part[span.here] for part in span.steps.bends(onward))
            first, second = applied(self.R_SB, first), applied(self.R_SB, second)
            across = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
            angle = atan2(across, first[:, 0] * second[:, 0] + first[:, 1] * second[:, 1])
            turns = angle / np.where(way > 0.0, way, 1.0)
            return turns if moves is None else np.where(moves, np.nan, turns)

        return turn

    def rapid(self, rows: RowColumns, count: int) -> Flags:
        """Which of `count` steps are rapid: those of which every piece is."""
        rapid = np.ones(count, dtype=bool)
        rapid[self.step[~rows.rapid[self.row]]] = False
        return rapid


@frozen(kw_only=False, eq=False)
class StintMaker:
    """Makes the stints of a channel: `rows` are those of its path, `switching` says when signals are set, which
    grippers ask, and all where the machine stands. `parts` are those of the run; some targets are among them.
    """

    shop: Shop
    rows: RowColumns
    switching: Switching
    parts: PartRun | None = None

    def stint(self, task: Task, span: StepSpan) -> Stint | None:
        """The stint of a task; None if it stays away from the target."""
        shop, parts, frame = self.shop, self.parts, task.target.frame
        joints = span.steps.joints(shop.name, span.begin, span.end)
        before = span.steps.joints_before(shop.name, span.begin)

        def where(other: str) -> Array:
            """X_BF (n, 4, 4) as far as it is known by now."""
            moved = None if parts is None else parts.seen_from(shop, other, span.first, joints)
            return shop.scene.seen_from(shop.name, other, joints) if moved is None else moved

        def made(held: Array, X_BS: Array) -> Stint | None:
            return self._stint_at(task, span, held, X_BS, where)

        stint = made(*(shop.scene.seen_from(shop.name, frame, q) for q in (before, joints)))
        if stint is None or parts is None or frame not in parts.things:
            return stint

        def anew() -> Stint | None:
            held = parts.seen_from(shop, frame, parts.before(frame, span.first), before)
            assert held is not None
            return made(held, where(frame))

        stint.anew = anew
        return stint

    def _stint_at(
        self, task: Task, span: StepSpan, first_X: Array, X_BS: Array, where: Callable[[str], Array]
    ) -> Stint | None:
        """The target comes from `first_X` (1, 4, 4) and is at X_BS (n, 4, 4), others are at `where`."""
        steps, here = span.steps, span.here
        chords = Chords.of(span, first_X, X_BS)
        axis = -applied(chords.R_SB, steps.tip[here, :3, 2])
        if not is_near(task, chords.start, chords.stop, axis, task.target.room):
            return None
        dt, row = steps.dt[here], steps.row[here]
        middle = steps.samples.time[here] - 0.5 * dt
        pose = pose_before = parts = None
        signals = self.signals(task.process.reads, steps, here)
        if isinstance(task.target, PartsTarget):
            X_WB, joints = self.shop.X_WB.matrix, steps.joints(self.shop.name, span.begin, span.end)
            pose, pose_before = multiplied(X_WB, steps.tip[here]), multiplied(X_WB, steps.tip_before[span.begin])
            signals = {signal.name: self.switching.at(signal, middle) for signal in task.process.reads}
            parts = task.target.during(span.first, joints, row, middle, self.switching)
        window = Window(
            pose=pose,
            pose_before=pose_before,
            piece_start=np.ascontiguousarray(chords.start),
            piece_end=np.ascontiguousarray(chords.stop),
            piece_step=chords.step,
            axis=axis,
            axis_before=-applied(chords.R_before, steps.tip_before[here, :3, 2]),
            velocity=chords.velocity(dt),
            piece_share=chords.share,
            rapid=chords.rapid(self.rows, len(span)),
            signals=signals,
            dt=dt if steps.command is not None else float(dt[0]),
            filament=chords.filament,
            side=applied(chords.R_SB, steps.tip[here, :3, 0]),
            where=_places(where, X_BS),
            compliance=self._compliance(task, span, chords.R_SB),
            turn=chords.turn(span),
            fresh=steps.fresh[here],
        )
        return Stint(
            task=task,
            begin=span.begin,
            end=span.end,
            window=window,
            X_BS=X_BS,
            share=chords.share,
            row=chords.row,
            parts=parts,
        )

    def signals(self, reads: Sequence[Signal], steps: StepWindow, here: slice) -> dict[str, Array]:
        """What a process reads in some steps of a window."""
        row, rests = steps.row[here], steps.rests[here]
        middle = steps.samples.time[here] - 0.5 * steps.dt[here]
        return {signal.name: self._signal(signal, row, middle, rests) for signal in reads}

    def _signal(self, signal: Signal, row: Ints, middle: Array, rests: Flags) -> Array:
        """A signal (n,) in steps of rows `row` (n,) with their `middle` (n,) [s].

        A row knows what holds as it begins. While the machine stands before it (`rests`), the signal may still change.
        """
        values: Array = self.rows.signal(signal, row)
        if rests.any() and self.switching.is_set(signal):
            values = np.where(rests, self.switching.at(signal, middle), values)
        return values

    def _compliance(self, task: Task, span: StepSpan, R_SB: Array) -> Array | None:
        """How the machine gives way (n, 6, 6) to a process that pushes, in axes of the target; None if it does not."""
        if not task.process.pushes or self.shop.stiffness is None or span.jacobian is None:
            return None
        return compliance_seen_from(R_SB, compliance(span.jacobian(), self.shop.stiffness))


def _places(seen_from_base: Callable[[str], Array], X_BS: Array) -> Callable[[str], Array]:
    """Poses X_SF (n, 4, 4) of frames of the scene."""

    def where(frame: str) -> Array:
        X_SF: Array = multiplied(inverse_pose(X_BS), seen_from_base(frame))
        return X_SF

    return where


def _of_steps(span: StepSpan) -> Array | None:
    """Filament (n,) [m] of whole steps."""
    steps = span.steps
    if steps.piece_filament is None:
        return None
    first, last = np.searchsorted(steps.piece_step, [span.begin, span.end])
    total = np.zeros(len(span))
    np.add.at(total, steps.piece_step[first:last] - span.begin, steps.piece_filament[first:last])
    return total


def _into(X: Array, points: Array) -> Array:
    """Points (n, 3) of the outer frame in the inner frames of poses (n, 4, 4)."""
    local: Array = applied(X[:, :3, :3].swapaxes(1, 2), points - X[:, :3, 3])
    return local

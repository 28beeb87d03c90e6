"""One process of a tool at one target during consecutive steps, asked step by step or all at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied
from gcodesim.arithmetic.turn_kernels import into_axes, wrench_from_axes
from gcodesim.executor.freeing import Freed, Freeing
from gcodesim.executor.part_run import PartRun, PartsInWindow, PartsTarget
from gcodesim.executor.switching import Switching
from gcodesim.executor.targets import Bounds
from gcodesim.executor.tasks import RowColumns, Task
from gcodesim.executor.window import StepWindow
from gcodesim.frames import Array
from gcodesim.kinematics import compliance
from gcodesim.processes.window import ProcessStep, Window
from gcodesim.shop import Shop

NEAR = 1e-3
"""Distance [m] from its target within which a process counts as near; more than any arm yields."""


@dataclass(slots=True, kw_only=True, eq=False)
class Stint:
    """Steps `begin` to `end` of a window. `window` is their commanded motion in S, `X_BS` (n, 4, 4) where S is.

    `share` (c, 2) tells where in its step each piece begins and ends, `row` (c,) which path row it is of. `answer`
    is what the process did, None while it is away from its target, `wrench` (n, 6) what the tool felt, in base axes,
    and `freed` what it cut loose. `parts` is what a gripper is given. `anew` makes the stint for a
    target that a gripper or a belt may move: where it is by then is known only when it is the turn of these steps.
    """

    task: Task
    begin: int
    end: int
    window: Window
    X_BS: Array
    share: Array
    row: NDArray[np.int64]
    parts: PartsInWindow | None = None
    anew: Callable[[], Stint | None] | None = None
    answer: ProcessStep | None = None
    wrench: Array | None = None
    freed: list[Freed] = field(default_factory=list)
    _loop: Any = field(default=None)
    _freeing: Freeing | None = field(default=None)

    def run(self) -> None:
        """All steps at once, as commanded."""
        if self.anew is not None:
            now = self.anew()
            if now is None:
                return
            self.window, self.X_BS, self.share, self.row = now.window, now.X_BS, now.share, now.row
        task, window = self.task, self.window
        if self.parts is not None:
            self.parts.begin()
            self._keep(task.process.run(self.parts, window, task.state))
        elif _is_near(task, window.piece_start, window.piece_end, window.axis, task.target.filled()):
            freeing = Freeing(task, window, self.row)
            self._keep(freeing.run())
            self.freed = freeing.freed

    def shift(self, bent: Array) -> None:
        """Act off the command by `bent` (n + 1, 3) [m] in B, at the beginning and at the end of each step."""
        window, step = self.window, self.window.piece_step
        R_SB = self.X_BS[:, :3, :3].transpose(0, 2, 1)
        before, after = applied(R_SB, bent[:-1]), applied(R_SB, bent[1:])
        way = after - before
        ends = [before[step] + share[:, None] * way[step] for share in self.share.T]
        self.window = replace(
            window,
            piece_start=window.piece_start + ends[0],
            piece_end=window.piece_end + ends[1],
            velocity=window.velocity + way / window.dt,
        )

    @property
    def bounds(self) -> Bounds:
        """A box (3,) (3,) [m] in S that contains all on which the process may act in these steps."""
        window = self.window
        return self.task.process.zone.bounds(window.piece_start, window.piece_end, window.axis, NEAR)

    def step(self, k: int, moved_before: Array, moved: Array, response: Array) -> Array:
        """Step `k` of this stint, its tip off the command by `moved_before` … `moved` (3,) [m]; wrench (6,); in B.

        Under a wrench F the machine moves the tip by `response` (6, 6) F besides.
        """
        if self._loop is None:
            self._freeing = Freeing(self.task, self.window, self.row)
            self._freeing.begin()
            self._loop = self.task.process.loop(self.task.target.given, self.window, self.task.state)
        seen, out = np.empty((2, 3)), np.empty(6)
        into_axes(self.X_BS[k], moved_before, moved, seen)
        if getattr(self._loop, "yields", False):
            R_SB = self.X_BS[k : k + 1, :3, :3].transpose(0, 2, 1)
            gives = _seen_from(R_SB, response[None])[0, :3]
            wrench = self._loop.step(k, seen[0], seen[1], self.share, gives)
        else:
            wrench = self._loop.step(k, seen[0], seen[1], self.share)
        wrench_from_axes(self.X_BS[k], wrench, out)
        return out

    def finish(self) -> None:
        """Call after the last step: collects what the process did, all at once if it was not asked step by step."""
        if self._loop is not None:
            self._keep(self._loop.finish())
            self._loop = None
            if self._freeing is not None:
                self._freeing.end()
                self.freed, self._freeing = self._freeing.freed, None
        elif self.answer is None:
            self.run()

    def forget(self) -> None:
        """Nothing has been done."""
        self.answer = self.wrench = None
        self.freed = []

    def _keep(self, answer: ProcessStep) -> None:
        self.answer, self.wrench = answer, in_base(answer.wrench, self.X_BS)


def stint_of(
    shop: Shop,
    rows: RowColumns,
    task: Task,
    steps: StepWindow,
    begin: int,
    end: int,
    jacobian: Callable[[], Array] | None,
    switching: Switching,
    parts: PartRun | None = None,
) -> Stint | None:
    """The stint for steps `begin` to `end`, all with the task's tool; None if it stays away from the target.

    `jacobian` gives those of the tip (n, 6, j) in base axes; a rigid machine does not ask for them. None: the world
    itself moves the gears, so that they are no matter of the process. `switching` says when signals are set; only
    grippers ask for it. `parts` are those of the run: some targets are among them.
    """
    joints, before = steps.joints(shop.name, begin, end), steps.joints_before(shop.name, begin)
    first, frame = steps.first + begin, task.target.frame

    def where(other: str) -> Array:
        """X_BF (n, 4, 4) as far as it is known by now."""
        moved = None if parts is None else parts.seen_from(shop, other, first, joints)
        return shop.scene.seen_from(shop.name, other, joints) if moved is None else moved

    def made(held: Array, X_BS: Array) -> Stint | None:
        return _stint_at(shop, rows, task, steps, begin, end, jacobian, switching, held, X_BS, where)

    stint = made(*(shop.scene.seen_from(shop.name, frame, q) for q in (before, joints)))
    if stint is None or parts is None or frame not in parts.things:
        return stint

    def anew() -> Stint | None:
        held = parts.seen_from(shop, frame, parts.before(frame, first), before)
        assert held is not None
        return made(held, where(frame))

    stint.anew = anew
    return stint


def _stint_at(
    shop: Shop,
    rows: RowColumns,
    task: Task,
    steps: StepWindow,
    begin: int,
    end: int,
    jacobian: Callable[[], Array] | None,
    switching: Switching,
    first_X: Array,
    X_BS: Array,
    where: Callable[[str], Array],
) -> Stint | None:
    """See `stint_of`; the target comes from `first_X` (1, 4, 4) and is at X_BS (n, 4, 4), others are at `where`."""
    count = end - begin
    held = np.concatenate([first_X, X_BS[:-1]])
    moving = bool((X_BS[:, :3] != first_X[:, :3]).any())
    if moving:  # the table turns or travels: chords between the ends of steps, seen from the stock
        start = _into(held, steps.tip_before[begin:end, :3, 3])
        stop = _into(X_BS, steps.tip[begin:end, :3, 3])
        R_SB, R_before = X_BS[:, :3, :3].transpose(0, 2, 1), held[:, :3, :3].transpose(0, 2, 1)
        step, share = np.arange(count), np.tile([0.0, 1.0], (count, 1))
        row = steps.row[begin:end]
        filament = _of_steps(steps, begin, end)
    else:
        first, last = np.searchsorted(steps.piece_step, [begin, end])
        R_SB = R_before = X_BS[:1, :3, :3].transpose(0, 2, 1)
        p = X_BS[0, :3, 3]
        start, stop = applied(R_SB, steps.piece_start[first:last] - p), applied(R_SB, steps.piece_end[first:last] - p)
        step, share, row = (
            steps.piece_step[first:last] - begin,
            steps.piece_share[first:last],
            steps.piece_row[first:last],
        )
        filament = None if steps.piece_filament is None else steps.piece_filament[first:last]
    axis = -applied(R_SB, steps.tip[begin:end, :3, 2])
    if not _is_near(task, start, stop, axis, task.target.room):
        return None
    velocity = np.zeros((count, 3))
    dt = steps.dt[begin:end]
    np.add.at(velocity, step, (stop - start) / dt[step, None])
    step_row = steps.row[begin:end]
    rapid = np.ones(count, dtype=bool)  # a step is rapid when all of it is
    rapid[step[~rows.rapid[row]]] = False
    middle = steps.samples.time[begin:end] - 0.5 * dt
    signals = {signal.name: rows.signal(signal, step_row) for signal in task.process.reads}
    carries = isinstance(task.target, PartsTarget)
    if carries:
        signals = {signal.name: switching.at(signal, middle) for signal in task.process.reads}
    X_WB = shop.X_WB.matrix
    window = Window(
        pose=multiplied(X_WB, steps.tip[begin:end]) if carries else None,
        pose_before=multiplied(X_WB, steps.tip_before[begin]) if carries else None,
        piece_start=np.ascontiguousarray(start),
        piece_end=np.ascontiguousarray(stop),
        piece_step=step,
        axis=axis,
        axis_before=-applied(R_before, steps.tip_before[begin:end, :3, 2]),
        velocity=velocity,
        piece_share=share,
        rapid=rapid,
        signals=signals,
        dt=dt if steps.command is not None else float(dt[0]),
        filament=filament,
        side=applied(R_SB, steps.tip[begin:end, :3, 0]),
        where=_places(where, X_BS),
        compliance=_seen_from(R_SB, compliance(jacobian(), shop.stiffness))
        if task.process.pushes and shop.stiffness is not None and jacobian is not None
        else None,
    )
    parts = None
    if isinstance(task.target, PartsTarget):
        joints = steps.joints(shop.name, begin, end)
        parts = task.target.during(steps.first + begin, joints, step_row, middle, switching)
    return Stint(task=task, begin=begin, end=end, window=window, X_BS=X_BS, share=share, row=row, parts=parts)


def _places(seen_from_base: Callable[[str], Array], X_BS: Array) -> Callable[[str], Array]:
    """Poses X_SF (n, 4, 4) of frames of the scene."""

    def where(frame: str) -> Array:
        X_SF: Array = multiplied(inverse_pose(X_BS), seen_from_base(frame))
        return X_SF

    return where


def _of_steps(steps: StepWindow, begin: int, end: int) -> Array | None:
    """Filament (end - begin,) [m] of whole steps."""
    if steps.piece_filament is None:
        return None
    first, last = np.searchsorted(steps.piece_step, [begin, end])
    total = np.zeros(end - begin)
    np.add.at(total, steps.piece_step[first:last] - begin, steps.piece_filament[first:last])
    return total


def _into(X: Array, points: Array) -> Array:
    """Points (n, 3) of the outer frame in the inner frames of poses (n, 4, 4)."""
    local: Array = applied(X[:, :3, :3].swapaxes(1, 2), points - X[:, :3, 3])
    return local


def _is_near(task: Task, start: Array, stop: Array, axis: Array, box: Bounds | None) -> bool:
    """Whether the process may act on something in `box` while its tip goes along pieces (c, 3); see `Zone`."""
    return box is None or task.process.zone.meets(start, stop, axis, *box, NEAR)


def _seen_from(R: Array, C: Array) -> Array:
    """Compliance (n, 6, 6) in turned axes, R (n, 3, 3)."""
    both = np.zeros_like(C)
    both[:, :3, :3] = both[:, 3:, 3:] = R
    turned: Array = multiplied(both, C, both.transpose(0, 2, 1))
    return turned


def in_base(wrench: Array, X_BS: Array) -> Array:
    """Wrenches (n, 6) given in S, in base axes."""
    R = X_BS[:, :3, :3]
    return np.concatenate([applied(R, wrench[:, :3]), applied(R, wrench[:, 3:])], axis=1)


def deflection_of(stint: Stint) -> Array:
    """How far (n, 6) the tip yields in B: translation [m] as the process solved it, rotation vector [rad]."""
    assert stint.answer is not None
    turn = np.zeros((len(stint.answer.wrench), 3))
    if stint.window.compliance is not None:
        turn = applied(stint.window.compliance[:, 3:], stint.answer.wrench)
    return in_base(np.concatenate([stint.answer.deflection, turn], axis=1), stint.X_BS)

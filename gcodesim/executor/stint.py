"""One process of a tool at one target during consecutive steps, asked step by step or all at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.arithmetic.turn_kernels import into_axes, wrench_from_axes
from gcodesim.executor.freeing import Freed, Freeing
from gcodesim.executor.part_run import PartsInWindow
from gcodesim.executor.targets import Bounds
from gcodesim.executor.tasks import Task
from gcodesim.frames import Array, Pose
from gcodesim.processes.window import ProcessStep, Window

if TYPE_CHECKING:
    from gcodesim.processes.swing_kernels import Swings

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
    _done: list[ProcessStep] = field(default_factory=list)

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
        elif is_near(task, window.piece_start, window.piece_end, window.axis, task.target.filled()):
            freeing = Freeing(task, window, self.row)
            self._keep(freeing.run(0, window.steps))
            self.freed = freeing.freed

    def advance(self, at: int, until: int) -> None:
        """Steps `at` to `until`, as commanded, in order; the same as `run` once the last step is done."""
        task, window = self.task, self.window
        if at == 0:
            near = is_near(task, window.piece_start, window.piece_end, window.axis, task.target.filled())
            self._freeing = Freeing(task, window, self.row) if near else None
            self._done = []
        if self._freeing is None:
            return
        self._done.append(self._freeing.run(at, until))
        if until == window.steps:
            self._keep(ProcessStep.joined(self._done))
            self.freed, self._freeing, self._done = self._freeing.freed, None, []

    @property
    def goes_along(self) -> bool:
        """Whether it acts wherever the machine puts the tip, and nobody feels it: then it may act after the motion."""
        return not self.task.process.pushes and self.parts is None and self.anew is None and self.answer is None

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
    def holds(self) -> dict[str, Pose]:
        """The stocks that it acts on, by name, each with its frame in S."""
        return dict(self.task.target.holds)

    @property
    def bounds(self) -> Bounds:
        """A box (3,) (3,) [m] in S that contains all on which the process may act in these steps."""
        window = self.window
        return self.task.process.zone.bounds(window.piece_start, window.piece_end, window.axis, NEAR)

    @property
    def bounds_by_step(self) -> Bounds:
        """The same of each step: corners (n, 3) (n, 3) [m]."""
        window = self.window
        first = np.searchsorted(window.piece_step, np.arange(window.steps))
        ends = window.piece_start, window.piece_end
        axes = window.axis if window.axis_before is None else window.axis_before, window.axis
        return self.task.process.zone.bounds_by_step(ends, first, axes, NEAR)

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
            gives = compliance_seen_from(R_SB, response[None])[0, :3]
            wrench = self._loop.step(k, seen[0], seen[1], self.share, gives)
        else:
            wrench = self._loop.step(k, seen[0], seen[1], self.share)
        wrench_from_axes(self.X_BS[k], wrench, out)
        return out

    @property
    def swung(self) -> NDArray[np.bool_]:
        """In which steps (n,) `swing` can tell."""
        can = getattr(self.task.process, "swung", None)
        if can is None or self.parts is not None or self.anew is not None:
            return np.zeros(self.window.steps, dtype=bool)
        told: NDArray[np.bool_] = can(self.task.target.given, self.window)
        return told

    def swing(self, swings: Swings) -> bool:
        """All steps at once, on gears that swing as `swings`, in B, tell; whether the process can do so."""
        act = getattr(self.task.process, "swing", None)
        if act is None or self.parts is not None or self.anew is not None:
            return False
        R_SB = self.X_BS[:, :3, :3].transpose(0, 2, 1)
        tip = np.concatenate([multiplied(R_SB, swings.tip[:, rows]) for rows in (slice(0, 3), slice(3, 6))], axis=1)
        freeing = Freeing(self.task, self.window, self.row)
        freeing.begin()
        answer = act(self.task.target.given, self.window, self.task.state, swings._replace(tip=tip))
        if answer is None:
            return False
        self._keep(answer)
        freeing.end()
        self.freed = freeing.freed
        return True

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
        self.answer = self.wrench = self._freeing = None
        self.freed, self._done = [], []

    def _keep(self, answer: ProcessStep) -> None:
        self.answer, self.wrench = answer, in_base(answer.wrench, self.X_BS)


def is_near(task: Task, start: Array, stop: Array, axis: Array, box: Bounds | None) -> bool:
    """Whether the process may act on something in `box` while its tip goes along pieces (c, 3); see `Zone`."""
    return box is None or task.process.zone.meets(start, stop, axis, *box, NEAR)


def compliance_seen_from(R: Array, C: Array) -> Array:
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

"""A window: some consecutive steps, and everything that is known about them before the world moves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import norms
from gcodesim.executor.looks import Looks, looks_of
from gcodesim.executor.pacing import LONGEST_CHORD, MOST_PARTS, Pacing, fresh_steps
from gcodesim.executor.tasks import RowColumns
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.course import Bend

if TYPE_CHECKING:
    from gcodesim.motion.trajectory import Rates, Samples
    from gcodesim.planning import Plan

Ints = NDArray[np.int64]

STILL: Final = 1.0e-6
"""[m] by which the tip may move against the control point while the tool does not turn."""


@dataclass(slots=True, kw_only=True, eq=False)
class Carry:
    """What a window takes over: tool, tip from control point (3,) [m] in B, tip pose (4, 4), joints (j,).

    `shift` (3,) [m] is that of the row in whose coordinates the control point is meant; see `RowColumns`.
    """

    tool: int
    shift: Array
    gap: Array
    tip: Array
    q: Array


@frozen(eq=False)
class AskedTicks:
    """Joints `q` (k, j) commanded at three ticks up to each of m moments, as far as they are in their window.

    The moments are the ends of n steps, and those at which the log looks. `at` (m,) says which rows of `q` they are,
    `ends` (n,) which moments end steps, `looks` those of the log. Three ticks are what speeds and accelerations follow
    from, the same as if every tick were a step.
    """

    q: Array
    at: Ints
    ends: Ints
    looks: Ints

    def moments(self, begin: int, end: int) -> slice:
        """The moments in steps `begin` to `end`."""
        return slice(int(self.ends[begin - 1]) + 1 if begin else 0, int(self.ends[end - 1]) + 1)

    def rows(self, begin: int, end: int) -> slice:
        """The rows of `q` in steps `begin` to `end`."""
        first = int(self.at[self.ends[begin - 1]]) + 1 if begin else 0
        return slice(first, int(self.at[self.ends[end - 1]]) + 1)


def command_of(plan: Plan, ticks: Ints, looked: Ints, dt_ns: int) -> AskedTicks:
    """What a world is asked in steps between `ticks` (n + 1,) at which the log looks at ticks `looked`."""
    moments = distinct(np.concatenate([ticks[1:], looked]))
    asked = distinct(np.concatenate([moments - 2, moments - 1, moments]))
    asked = asked[asked > ticks[0]]
    samples = plan.trajectory.sample((asked * dt_ns).astype(float) * 1e-9)
    return AskedTicks(
        q=plan.joints(samples),
        at=np.searchsorted(asked, moments),
        ends=np.searchsorted(moments, ticks[1:]),
        looks=np.searchsorted(moments, looked),
    )


@frozen(eq=False)
class StepWindow:
    """n steps: step k begins with tick `ticks[k]` of the clock and ends with tick `ticks[k + 1]`; `ticks` (n + 1,).

    `dt` (n,) [s] is how long each of them is. `command` are the ticks at which the world is asked, `looks` those at
    which the log looks; None: at the end of each step.

    `samples` at the ends of the steps; `row` (n,) is the path row in the middle
    of each, where the machine stands the next one; `rests` (n,) says where it
    stands for an event; `tool` (n,) its tool; `q` (n, j) commanded joints, `q_begin` (j,) those
    before the first step; `tip` (n, 4, 4) the commanded tip X_BT and `tip_before`
    (n, 4, 4) that at the step's start.

    The sweep of the tip in B, cut where rows, pieces and steps end: m pieces
    from `piece_start` to `piece_end` (m, 3) [m], in step `piece_step` (m,),
    `piece_share` (m, 2) of the step, in row `piece_row` (m,), with
    `piece_filament` (m,) [m] through the nozzle (None: no E words). `others` are the commanded joints (n, j) of further
    movers by name, where several programs run at once, and `others_begin` (j,) those before the first step.
    `fresh` (n,) are the steps with which a new beat begins, see `Pacing`.
    `bends(onward)` tells how the path goes on for `onward` [m] from where each step begins, in B; its directions are
    NaN in a step in which the tip goes another way than the control point, since the tool turns.
    """

    ticks: Ints
    dt: Array
    samples: Samples
    row: Ints
    rests: NDArray[np.bool_]
    tool: Ints
    q: Array
    q_begin: Array
    tip: Array
    tip_before: Array
    piece_start: Array
    piece_end: Array
    piece_step: Ints
    piece_share: Array
    piece_row: Ints
    piece_filament: Array | None = None
    others: dict[str, Array] = field(default_factory=dict)
    others_begin: dict[str, Array] = field(default_factory=dict)
    fresh: NDArray[np.bool_]
    command: AskedTicks | None = None
    looks: Looks | None = None
    bends: Callable[[float], Bend]

    @property
    def first(self) -> int:
        """The tick with which the window begins."""
        return int(self.ticks[0])

    @property
    def end(self) -> int:
        """The tick with which it ends."""
        return int(self.ticks[-1])

    def joints(self, mover: str, begin: int, end: int) -> dict[str, Array]:
        """Commanded joints of all movers in steps `begin` to `end`; `mover` is the window's own."""
        return {mover: self.q[begin:end], **{name: q[begin:end] for name, q in self.others.items()}}

    def joints_before(self, mover: str, begin: int) -> dict[str, Array]:
        """Commanded joints (1, j) of all movers at the start of step `begin`."""
        if begin:
            return self.joints(mover, begin - 1, begin)
        return {mover: self.q_begin[None], **{name: q[None] for name, q in self.others_begin.items()}}

    def __len__(self) -> int:
        return len(self.row)


def first_carry(plan: Plan, rows: RowColumns, t_ns: int = 0) -> Carry:
    """Before the first step of a leg: the machine stands where the leg begins, with the tool of its first row."""
    samples = plan.trajectory.sample(np.array([t_ns * 1e-9]))
    row = np.zeros(1, dtype=np.int64) if t_ns == 0 else np.minimum(samples.row, len(rows.tool) - 1)
    q = plan.joints(samples)
    tip = plan.tip(q, row)[0]
    shift = rows.shift[_named_by(samples, len(rows.tool) - 1)][0]
    gap = tip[:3, 3] - samples.position[0, :3]
    return Carry(tool=int(rows.tool[row[0]]), shift=shift, gap=gap, tip=tip, q=q[0])


def window_of(
    plan: Plan, rows: RowColumns, ticks: Ints, pacing: Pacing, carry: Carry, *, asked: bool = True, logged: bool = True
) -> StepWindow:
    """Sample the steps between `ticks` (n + 1,); `carry` is brought to the end of the window.

    `asked`: whether a world is asked about speeds, so that it has to be told single ticks. `logged`: whether there is
    a log that looks.

    The plan's path is in base axes, so the control point needs no transform.
    """
    count, dt_ns, period = len(ticks) - 1, pacing.dt_ns, pacing.period if logged else 0
    times: Array = (ticks * dt_ns).astype(float) * 1e-9
    dt: Array = np.diff(ticks) * (dt_ns * 1e-9)
    trajectory = plan.trajectory
    last = len(rows.tool) - 1
    middle = trajectory.rates(0.5 * (times[:-1] + times[1:]))
    row = np.clip(middle.row, 0, last)
    tool = rows.tool[row]

    # each step by its own speed: no number may depend on where windows begin and end
    speed = np.where(rows.rapid[row], 0.0, np.abs(middle.speed))
    parts = np.clip(np.ceil(speed * dt / LONGEST_CHORD), 1, MOST_PARTS).astype(np.int64)
    parts[(np.diff(ticks) > 1) & trajectory.along_lines(times)] = 1  # stretches of path are the same however divided
    knot_time = distinct(np.concatenate([_refined(times, parts), trajectory.boundaries(times[0], times[-1])]))
    at_knots = trajectory.sample(knot_time)
    samples = at_knots.at(np.searchsorted(knot_time, times[1:]))
    q = plan.joints(samples)
    tip = plan.tip(q, row)

    # tip from control point at both ends of every step; a fresh tool has no past
    shift = rows.shift[_named_by(middle, last)]  # of each step
    gap = tip[:, :3, 3] - (samples.position[:, :3] - (rows.shift[_named_by(samples, last)] - shift))
    changed = np.diff(tool, prepend=carry.tool) != 0
    gap_before = np.vstack([carry.gap[None], gap[:-1]]) - (shift - np.vstack([carry.shift[None], shift[:-1]]))
    gap_before[changed] = gap[changed]
    tip_before = np.concatenate([carry.tip[None], tip[:-1]])
    tip_before[changed] = tip[changed]

    knots, knot_shift = at_knots.position[:, :3], rows.shift[_named_by(at_knots, last)]
    centre = 0.5 * (knot_time[:-1] + knot_time[1:])
    step = np.clip(np.searchsorted(times, centre, side="right") - 1, 0, count - 1)
    within = np.column_stack([knot_time[:-1] - times[step], knot_time[1:] - times[step]])
    share = np.clip(within / dt[step, None], 0.0, 1.0)
    bend = gap[step] - gap_before[step]
    long = asked and ticks[-1] - ticks[0] != count
    looks = looks_of(plan, ticks, row, period, dt_ns) if long and period else None
    begin, end = knots[:-1] - (knot_shift[:-1] - shift[step]), knots[1:] - (knot_shift[1:] - shift[step])
    window = StepWindow(
        ticks=ticks,
        dt=dt,
        samples=samples,
        row=row,
        rests=middle.event >= 0,
        tool=tool,
        q=q,
        q_begin=carry.q,
        tip=tip,
        tip_before=tip_before,
        piece_start=begin + gap_before[step] + share[:, :1] * bend,
        piece_end=end + gap_before[step] + share[:, 1:] * bend,
        piece_step=step,
        piece_share=share,
        piece_row=np.clip(trajectory.rows_at(centre), 0, last),
        piece_filament=trajectory.filament_between(at_knots),
        bends=_bends(plan, at_knots.at(np.searchsorted(knot_time, times[:-1])), norms(gap - gap_before) > STILL),
        fresh=fresh_steps(ticks, pacing.beat),
        command=command_of(plan, ticks, ticks[:0] if looks is None else looks.ticks, dt_ns) if long else None,
        looks=looks,
    )
    carry.tool, carry.shift, carry.gap, carry.tip, carry.q = int(tool[-1]), shift[-1], gap[-1], tip[-1], q[-1]
    return window


def _bends(plan: Plan, begins: Samples, turned: NDArray[np.bool_]) -> Callable[[float], Bend]:
    """`StepWindow.bends` of steps that begin with samples (n,); `turned` (n,) tells where the tool turns."""
    unknown = np.where(turned, np.nan, 0.0)[:, None]

    def bends(onward: float) -> Bend:
        first, second, way = plan.trajectory.course.bends(begins.piece, begins.s, onward)
        return Bend(first + unknown, second + unknown, way)

    return bends


def _named_by(samples: Samples | Rates, last: int) -> Ints:
    """The rows (n,) in whose coordinates samples are: while the machine waits for a row, the one before."""
    rows: Ints = np.clip(samples.row - (samples.event >= 0), 0, last)
    return rows


def _refined(times: Array, parts: Ints) -> Array:
    """`times` (n + 1,) with `parts` (n,) equal stretches between consecutive ones."""
    if (parts == 1).all():
        return times
    begin = np.cumsum(parts) - parts
    share = (np.arange(parts.sum()) - np.repeat(begin, parts)) / np.repeat(parts, parts)
    inner = np.repeat(times[:-1], parts) + np.repeat(times[1:] - times[:-1], parts) * share
    return np.append(inner, times[-1])

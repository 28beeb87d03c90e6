"""Joint vectors, one for each step, as a leg of a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import norm
from gcodesim.canon import Event
from gcodesim.diagnostics import Findings, Span
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.blend import blend
from gcodesim.motion.blend_kernels import along_axes
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.standing import Duration
from gcodesim.motion.timing import time_law
from gcodesim.motion.tool_path import EXACT_STOP, LINE, PathEvent, ToolPath, ToolState
from gcodesim.planning import Plan
from gcodesim.planning.plan import JointExtremes

if TYPE_CHECKING:
    from gcodesim.motion.trajectory import Samples
    from gcodesim.planning.posing import Posing
    from gcodesim.shop import Shop

_LEAST_FEED = 1e-9  # [m/s] of a row in which the tip stands
_FREE = AxisLimits(speed=np.full(6, np.inf), acceleration=np.full(6, np.inf))


@frozen(eq=False)
class Stretched:
    """n steps under one line of the script: joints `q` (n + 1, j) from the state before on; `events` come first."""

    q: Array
    state: ToolState
    span: Span
    active: bool
    events: tuple[Event, ...] = ()

    def goes_on(self, other: Stretched) -> bool:
        """Whether `other` can be joined to this one."""
        return not other.events and (self.state, self.span, self.active) == (other.state, other.span, other.active)


@frozen(eq=False)
class TableJoints:
    """Joints from tables (n + 1, j), one for each piece, with a row every `dt` [s]; between rows they run evenly."""

    tables: tuple[Array, ...]
    dt: float

    def joints(self, samples: Samples) -> Array:
        """Joint values (n, j) [m, rad] at samples in order of time."""
        found = np.empty((len(samples), self.tables[0].shape[1]))
        for piece in distinct(samples.piece).tolist():
            here = samples.piece == piece
            table = self.tables[piece]
            at = np.clip(samples.s[here] / self.dt, 0.0, len(table) - 1.0)
            whole = np.minimum(np.floor(at + 1e-9).astype(np.int64), len(table) - 1)
            share = np.maximum(at - whole, 0.0)[:, None]
            share[share < 1e-9] = 0.0  # at the end of a step stands what the table says, to the bit
            found[here] = table[whole] + share * (table[np.minimum(whole + 1, len(table) - 1)] - table[whole])
        return found

    def extremes(self) -> JointExtremes:
        """How far each joint goes, with the number of the table."""
        least, most = np.array([t.min(axis=0) for t in self.tables]), np.array([t.max(axis=0) for t in self.tables])
        return JointExtremes(least.min(axis=0), most.max(axis=0), least.argmin(axis=0), most.argmax(axis=0))


def merged(stretches: Sequence[Stretched]) -> list[Stretched]:
    """Stretches joined where nothing but the joints changes."""
    found: list[list[Stretched]] = []
    for stretch in stretches:
        if found and found[-1][0].goes_on(stretch):
            found[-1].append(stretch)
        else:
            found.append([stretch])
    return [replace(same[0], q=np.concatenate([same[0].q, *(later.q[1:] for later in same[1:])])) for same in found]


@frozen(eq=False)
class LegForm:
    """The plan of a leg of one stretch without events, after which those of further ones are made.

    A script that looks after each step makes thousands of such legs. They differ by ends, time and what is said of
    their row; nothing else is computed anew.
    """

    model: Plan

    @staticmethod
    def of(stretches: Sequence[Stretched], plan: Plan) -> LegForm | None:
        """From a leg that was planned as any other; None where it is not of this form."""
        return LegForm(model=plan) if _is_plain(stretches) else None

    def plan(self, stretch: Stretched, ends: Array, dt: float) -> Plan:
        """What `plan_of` gives for `stretch` alone; `ends` (2, 6) is the controlled point before and behind it."""
        trajectory = self.model.trajectory
        start, end = ends[:1].copy(), ends[1:].copy()
        times = np.array([(len(stretch.q) - 1) * dt])
        path = replace(
            self.model.path,
            start=start,
            end=end,
            feed=_feeds(start, end, times),
            active=np.array([stretch.active], dtype=bool),
            states=(stretch.state,),
            spans=(stretch.span,),
        )
        curves = replace(trajectory.pieces.curves, start=start, end=end, length=times)
        _, acceleration = along_axes(end - start, times, _FREE.arrays)
        pieces = replace(trajectory.pieces, path=path, curves=curves, length=times, acceleration=acceleration)
        phases = replace(trajectory.phases, duration=times)
        return Plan(
            replace(trajectory, pieces=pieces, phases=phases, row_end=times),
            Findings(),
            self.model.kinematics,
            TableJoints(tables=(stretch.q,), dt=dt),
            self.model.tool_frames,
        )


def _is_plain(stretches: Sequence[Stretched]) -> bool:
    return len(stretches) == 1 and not stretches[0].events


def _feeds(start: Array, end: Array, times: Array) -> Array:
    """Mean speeds [m/s] of the tip along rows."""
    ways = np.array([norm(way) for way in (end - start)[:, :3]])
    feeds: Array = np.maximum(ways / times, _LEAST_FEED)
    return feeds


def plan_of(
    stretches: Sequence[Stretched],
    shop: Shop,
    posing: Posing,
    dt: float,
    duration_of: Duration,
    form: LegForm | None = None,
) -> Plan:
    """The plan of a leg, one row for each of the stretches; the path is in base axes, as that of every plan.

    `posing` says where the controlled point of the shop's machine is, and `form` how legs of one stretch are planned.
    """
    if form is not None and _is_plain(stretches):
        (stretch,) = stretches
        return form.plan(stretch, _points(shop, posing, [stretch.q[0], stretch.q[-1]]), dt)
    count = len(stretches)
    start, end = (_points(shop, posing, [stretch.q[row] for stretch in stretches]) for row in (0, -1))
    times = np.array([(len(stretch.q) - 1) * dt for stretch in stretches])
    blank = ToolPath.from_points(np.zeros((count + 1, 3)))
    order = np.arange(count, dtype=np.int32)
    path = replace(
        blank,
        kind=np.full(count, LINE, dtype=np.uint8),
        start=start,
        end=end,
        feed=_feeds(start, end, times),
        mode=np.full(count, EXACT_STOP, dtype=np.uint8),
        state=order,
        source=order,
        active=np.array([stretch.active for stretch in stretches], dtype=bool),
        stop=np.ones(count, dtype=bool),
        states=tuple(stretch.state for stretch in stretches),
        spans=tuple(stretch.span for stretch in stretches),
        events=tuple(PathEvent(row, event) for row, stretch in enumerate(stretches) for event in stretch.events),
    )
    trajectory = time_law(blend(path, _FREE, own_time=times), duration_of=duration_of)
    frames = {number: tool.X_FT for number, tool in shop.cell.tools.items()}
    return Plan(
        trajectory, Findings(), shop.kinematics, TableJoints(tables=tuple(s.q for s in stretches), dt=dt), frames
    )


def _points(shop: Shop, posing: Posing, vectors: Sequence[Array]) -> Array:
    """The controlled point (n, 6) of joint vectors, in base axes."""
    points = np.array([posing.start(shop.kinematics, q) for q in vectors], dtype=float)
    points[:, :3] = shop.X_BM.apply(points[:, :3])
    return points

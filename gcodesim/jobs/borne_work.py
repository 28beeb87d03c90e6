"""Work that the program of one channel moves and that of another works on: where it stands, and where it does not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied, norms
from gcodesim.canon.systems import name_of_system
from gcodesim.diagnostics import Diagnostic
from gcodesim.motion.tool_path import HOME
from gcodesim.planning.borne_work import BorneWork
from gcodesim.planning.shop_posing import bearers_of
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.jobs.job import Job
    from gcodesim.planning.bearers import Bearers
    from gcodesim.planning.plan import Plan

_LOOK: Final = 0.01  # [s] between two looks at the work
_STILL: Final = 1e-6  # [m, rad] by which work may have moved that stands still


def bears_work(jobs: Sequence[Job]) -> bool:
    """Whether any program works on what another one moves."""
    return any(job.shop is not None and bool(job.shop.placement.borne) for job in jobs)


def displaced(jobs: Sequence[Job], plans: Mapping[str, Plan], ends: Mapping[str, Sequence[float]]) -> list[Job]:
    """The jobs whose work is elsewhere than they were planned for; they get to know where.

    `plans` are those of movers by their names, on the common clock, on which the waits of channels end at `ends` [s].
    """
    found = []
    for job in jobs:
        assert job.shop is not None
        bearers = bearers_of(job.shop, plans)
        if bearers is None:
            continue
        work = bearers.after_waits(ends[job.channel], job.shop.X_WB)
        if not _same(work, job.borne or bearers_at_home(job)):
            found.append(job)
        job.borne = work
    return found


def bearers_at_home(job: Job) -> BorneWork:
    """The work as it is where nothing has moved it."""
    assert job.shop is not None
    bearers = bearers_of(job.shop, {})
    assert bearers is not None
    return bearers.after_waits((), job.shop.X_WB)


def _same(one: BorneWork, other: BorneWork) -> bool:
    """Whether the work is at the same places; the last one known holds from then on."""
    for system, X in one.moved.items():
        Y = other.moved[system]
        count = max(len(X), len(Y))
        rows = np.arange(count)
        apart = X[np.minimum(rows, len(X) - 1)] - Y[np.minimum(rows, len(Y) - 1)]
        if np.abs(apart).max() > _STILL:
            return False
    return True


def moving_work(jobs: Sequence[Job]) -> Iterator[Diagnostic]:
    """GS627 for programs that work on what another one moves meanwhile.

    Plans are on the common clock; the jobs get to know by it where their work is at any time.
    """
    plans = {job.shop.name: job.plan for job in jobs if job.shop is not None and job.plan is not None}
    for job in jobs:
        if job.shop is not None and (bearers := bearers_of(job.shop, plans)) is not None:
            job.bearers = bearers
            yield from _moving_under(job, bearers)


def _moving_under(job: Job, bearers: Bearers) -> Iterator[Diagnostic]:
    plan, shop = job.plan, job.shop
    assert plan is not None and shop is not None
    path, trajectory = plan.path, plan.trajectory
    if not len(path):
        return
    looks = [np.arange(0.0, trajectory.duration, _LOOK), trajectory.row_start, trajectory.row_end]
    time = distinct(np.concatenate(looks))
    samples = trajectory.sample(time)
    systems = np.array([state.system for state in path.states])[path.state[samples.row]]
    works = (samples.event < 0) & (path.kind[samples.row] != HOME)
    for system, link in bearers.links.items():
        at = np.flatnonzero(works & (systems == system))
        if not len(at):
            continue
        X_WB = shop.X_WB
        planned = (job.borne or bearers_at_home(job)).on_rows(path)[samples.row[at]]
        there = multiplied(X_WB.matrix[None], planned, X_WB.inverse().matrix)
        moved = bearers.moved(system, time[at])
        moves = np.abs(moved - there).max(axis=(1, 2)) > _STILL
        if not moves.any():
            continue
        first = int(np.argmax(moves))
        begin, row = float(time[at[first]]), int(samples.row[at[first]])
        tip = X_WB.apply(samples.position[at, :3])
        under = inverse_pose(there)  # the point of the work that is under the tool
        now = applied(moved[:, :3, :3], applied(under[:, :3, :3], tip) + under[:, :3, 3]) + moved[:, :3, 3]
        way = float(norms(now - tip).max())
        name, owner = link.partition("/")[2], link.partition("/")[0]
        yield Diagnostic(
            code="GS627",
            span=path.span(row),
            message=f"`{name}` moves while `{job.channel}` works in {name_of_system(system)} on it: the work goes "
            f"up to {way / MM:.3f} mm away under the tool, which does not follow",
            hint=f"let the program of `{owner}` and this one meet at a mark before and after `{name}` moves; to work "
            f"on it while it moves, let this program command it (`robot: {shop.name}` under `{name}`)",
            time=begin,
            value=way / MM,
            unit="mm",
        )

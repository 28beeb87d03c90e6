"""What the steps of a job are, and how densely its log is written."""

from __future__ import annotations

from typing import Final

from gcodesim.cell.settings import DEFAULT_PERIOD_NS, LOG_SAMPLES, NS
from gcodesim.executor.pacing import Pacing, cell_reach, may_follow_path
from gcodesim.jobs.job import KINEMATIC, Job
from gcodesim.observation.schedule import stations_of

LONGEST_PERIOD_NS: Final = 10 * NS

BEAT_PACES: Final = 25
"""Usual records of the log in a beat."""

SHAPE_CELLS: Final = 4
"""Cells of the finest stock in a step where only the shape is asked for: so exactly is told what part of a way cuts."""


def pacing_of(job: Job) -> Pacing:
    """The steps of a job: what its cell says; else stretches of path where that changes nothing else, or ticks."""
    assert job.cell is not None and job.shop is not None
    tick = job.cell.simulation.step_ns
    if not _follows_path(job):
        return Pacing(dt_ns=tick)
    pace, period = max(1, round(_usual_period_ns(job) / tick)), log_period_ns(job) // tick
    beat = BEAT_PACES * pace
    if job.options.only == "shape":
        return Pacing(dt_ns=tick, reach=cell_reach(job.shop, SHAPE_CELLS), at_one_rate=False, beat=beat)
    return Pacing(dt_ns=tick, reach=cell_reach(job.shop), pace=pace, period=period if period % pace else 0, beat=beat)


def log_period_ns(job: Job) -> int:
    """Time between two records of the log [ns]: what the cell says, else what is usual."""
    assert job.cell is not None
    return _usual_period_ns(job) if job.cell.log.period == "auto" else job.cell.log.period_ns


def _usual_period_ns(job: Job) -> int:
    """Time between two records [ns] where nobody has set it.

    Where steps are stretches of path, a long program that is known as a whole gets as many records as one of 10 min.
    These are also the times at which steps end, whoever sets the period, so that no number depends on it.
    """
    if not _follows_path(job) or job.plan is None or job.legs is None or not job.legs.ended:
        return DEFAULT_PERIOD_NS
    whole = DEFAULT_PERIOD_NS * max(1, -(-job.plan.trajectory.duration_ns // (DEFAULT_PERIOD_NS * LOG_SAMPLES)))
    return min(whole, LONGEST_PERIOD_NS)


def _follows_path(job: Job) -> bool:
    """Whether steps are stretches of path: nobody waits for a tick, and nobody has set them.

    The shape alone does not ask for a rate.
    """
    cell = job.cell
    assert cell is not None and job.shop is not None
    is_set = cell.simulation.rate != "auto"
    if job.world != KINEMATIC or (is_set and job.options.only != "shape"):
        return False
    if job.others or job.seen is not None or stations_of(cell):
        return False
    return may_follow_path(job.shop, job.options.only)

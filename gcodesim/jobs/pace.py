"""What the steps of a job are, and how densely its log is written."""

from __future__ import annotations

from typing import Final

from gcodesim.cell.settings import LOG_SAMPLES, NS
from gcodesim.executor.pacing import Pacing, cell_reach, may_follow_path
from gcodesim.jobs.job import KINEMATIC, Job
from gcodesim.observation.schedule import stations_of

LONGEST_PERIOD_NS: Final = 10 * NS

SHAPE_CELLS: Final = 4
"""Cells of the finest stock in a step where only the shape is asked for: so exactly is told what part of a way cuts."""


def pacing_of(job: Job) -> Pacing:
    """The steps of a job: what its cell says; else stretches of path where that changes nothing else, or ticks."""
    assert job.cell is not None and job.shop is not None
    tick = job.cell.simulation.step_ns
    if not _follows_path(job):
        return Pacing(dt_ns=tick)
    if job.options.only == "shape":
        return Pacing(dt_ns=tick, reach=cell_reach(job.shop, SHAPE_CELLS), at_one_rate=False)
    return Pacing(dt_ns=tick, reach=cell_reach(job.shop), period=log_period_ns(job) // tick)


def log_period_ns(job: Job) -> int:
    """Time between two records of the log [ns].

    Where steps are stretches of path, a long program that is known as a whole gets as many records as one of 10 min.
    """
    assert job.cell is not None
    own = job.cell.log.period_ns
    if not _follows_path(job) or job.plan is None or job.legs is None or not job.legs.ended:
        return own
    whole = own * max(1, -(-job.plan.trajectory.duration_ns // (own * LOG_SAMPLES)))
    return min(whole, LONGEST_PERIOD_NS)


def _follows_path(job: Job) -> bool:
    """Whether steps are stretches of path: nobody waits for a tick, and nobody has set them or the period of the log.

    No number may depend on how often the log looks, so that where its period is set, steps are ticks. The shape alone
    does not ask for a rate.
    """
    cell = job.cell
    assert cell is not None and job.shop is not None
    is_set = cell.simulation.rate != "auto" or cell.log.period != "auto"
    if job.world != KINEMATIC or (is_set and job.options.only != "shape"):
        return False
    if job.others or job.seen is not None or stations_of(cell):
        return False
    return may_follow_path(job.shop, job.options.only)

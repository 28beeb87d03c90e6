"""Where grippers and belts carry the parts of a cell, without a run: for `check`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gcodesim.jobs.job import KINEMATIC
from gcodesim.shop import side_by_side

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gcodesim.executor.halt import RunHalt
    from gcodesim.jobs.job import Job
    from gcodesim.planning import Plan
    from gcodesim.scene import Stay


def asks_of_parts(job: Job) -> bool:
    """Whether the program may ask sensors that see parts come and go, so that its legs depend on them."""
    cell, shop = job.cell, job.shop
    if cell is None or shop is None or job.others or not cell.parts or not shop.moves_parts:
        return False
    return any(source.sensor is not None for source in cell.channels[shop.channel].inputs.values())


def rehearse(job: Job, *, onward: bool = False) -> Sequence[Stay] | None:
    """Where parts are in a run in which every machine follows its command; None where nothing moves them.

    What grips then show to be wrong is added to the findings. Nothing is cut. `onward`: with all legs that are still to
    be read and planned.
    """
    cell, shop = job.cell, job.shop
    if cell is None or shop is None or not cell.parts or not shop.moves_parts:
        return None
    if any(each.plan is None or each.shop is None for each in job.all):
        return None
    from gcodesim.executor import TrackPlan, execute_together
    from gcodesim.executor.pacing import Pacing
    from gcodesim.jobs.inspection import Inspector

    shops = side_by_side(shop, [each.shop for each in job.others if each.shop is not None])
    plans = [each.plan for each in job.all if each.plan is not None]
    step = cell.simulation.step_ns
    inspectors = [Inspector(plan, own, step) for plan, own in zip(plans, shops, strict=True)]
    channels = [
        TrackPlan(plan=plan, shop=own, inspect=lambda record, rows, joints, who=who: who.fresh(record, rows, joints))  # type: ignore[misc]
        for plan, own, who in zip(plans, shops, inspectors, strict=True)
    ]

    def further(halt: RunHalt) -> Sequence[Plan] | None:
        plan = None if job.legs is None else job.legs.onward(halt)
        if plan is None:
            return None
        inspectors[0].follow(plan)
        return (plan,)

    pacing = Pacing(dt_ns=step)
    execution = execute_together(channels, world_name=KINEMATIC, pacing=pacing, onward=further if onward else None)
    for each, who, own in zip(job.all, inspectors, (execution, *execution.others), strict=True):
        each.findings.extend(who.of_grips(own))
    return execution.stays

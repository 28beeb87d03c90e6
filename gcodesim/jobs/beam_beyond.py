"""What beams do beyond the stock: a jet that is through the plate strikes the fixture below it."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import applied
from gcodesim.diagnostics import Diagnostic
from gcodesim.processes import PROCESSES

if TYPE_CHECKING:
    from gcodesim.executor import Execution
    from gcodesim.frames import Array
    from gcodesim.jobs.job import Job
    from gcodesim.scene import Body
    from gcodesim.shop import Shop

PASSING: Final = 0.2
"""Share of a beam that goes by the stock in a move, from which on it is looked at: the rim of a beam does not count."""

INTERVAL: Final = 0.1  # [s] between two looks
MOST_LOOKS: Final = 2000


def beyond_findings(job: Job, execution: Execution) -> Iterator[Diagnostic]:
    """GS547 for each fixture that the axis of a beam strikes in moves in which the beam goes by the stock."""
    shop, plan = job.shop, job.plan
    if shop is None or plan is None or not len(plan.path):
        return
    fixtures = [body for body in shop.scene.bodies if body.role == "fixture" and body.solids]
    beams = [kind for kind in shop.sheet.kinds[1:] if getattr(PROCESSES[kind], "landed", "")]
    if not fixtures or not beams:
        return
    passed = np.zeros(len(plan.path), dtype=bool)
    for kind in beams:
        given, landed = execution.rows[PROCESSES[kind].given], execution.rows[PROCESSES[kind].landed]
        passed |= (given > 0.0) & (given - landed > PASSING * given)
    rows = np.flatnonzero(passed)
    if not len(rows):
        return
    row, ends = _looks(job, rows)
    for body in fixtures:
        struck = _struck(shop, body, *ends)
        if struck.any():
            first = int(row[np.argmax(struck)])
            tool = shop.tool(int(plan.path.states[plan.path.state[first]].tool))
            yield Diagnostic(
                code="GS547",
                span=plan.path.span(first),
                message=f"{'the beam' if tool is None else tool.name} goes by the stock, or through it, and strikes "
                f"{body.label}",
                hint="move the fixture, or the cut; or give the table a grid that is meant to wear",
                time=float(plan.trajectory.row_start[first]),
                count=len(distinct(row[struck])),
            )


def _looks(job: Job, rows: Any) -> tuple[Any, tuple[Array, Array, Array]]:
    """The rows (n,) of looks at a beam, with joints (n, j) and both ends (n, 3) [m] of its axis in base axes."""
    shop, plan = job.shop, job.plan
    assert shop is not None and plan is not None
    begin, end = plan.trajectory.row_start[rows], plan.trajectory.row_end[rows]
    interval = max(INTERVAL, float((end - begin).sum()) / MOST_LOOKS)
    counts = np.maximum(np.ceil((end - begin) / interval), 1).astype(np.int64)
    row = np.repeat(rows, counts)
    part = np.concatenate([(np.arange(n) + 0.5) / n for n in counts.tolist()])
    samples = plan.trajectory.sample(np.repeat(begin, counts) + part * np.repeat(end - begin, counts))
    q = plan.joints(samples)
    tip = plan.tip(q, row)
    numbers = np.array([state.tool for state in plan.path.states])[plan.path.state[row]].tolist()
    reach = np.array([float(getattr(shop.tool(number), "reach", 0.0)) for number in numbers])
    return row, (q, tip[:, :3, 3], tip[:, :3, 3] + reach[:, None] * tip[:, :3, 2])


def _struck(shop: Shop, body: Body, q: Array, start: Array, end: Array) -> Any:
    """Whether the straight from `start` to `end` (n, 3) [m] in base axes meets a body, for each of n looks."""
    from gcodesim.solids import triangles_of
    from gcodesim.solids.ray_kernels import blocked
    from gcodesim.solids.triangle_tree import joined, tree_of

    X = shop.scene.seen_from(shop.name, body.name, {shop.name: q})
    inward = X[:, :3, :3].swapaxes(1, 2)
    found = np.zeros(len(q), dtype=bool)
    for own in body.solids:
        boxes, corners, nodes = joined([tree_of(triangles_of(own.solid))])
        ends = np.stack([applied(inward, point - X[:, :3, 3]) for point in (start, end)], axis=1)
        ends = np.ascontiguousarray(applied(own.X.R.T, ends - own.X.p))
        for first, last in pairwise(int(node) for node in nodes):
            found |= np.array([blocked(boxes, corners, first, last, pair, 0.0) for pair in ends])
    return found

"""Pieces that a program cut loose: each with the move that freed it; they fall out of the stock at the end of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.matrices import applied
from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.jobs.results import FallenPiece
from gcodesim.units import MM, MM3

if TYPE_CHECKING:
    from gcodesim.executor import Execution
    from gcodesim.jobs.job import Job
    from gcodesim.material.loose import PartedPiece
    from gcodesim.shop import PlacedStock

BESIDE: Final = 3.0
"""Cells beside a piece within which a cut may have been the one that freed it."""


def drop_loose_pieces(job: Job, execution: Execution) -> None:
    """Find what came loose, let it fall, and note it in `job.fallen` and in the findings (GS440).

    A stock onto which something was laid keeps its parts: prints have several.
    """
    from gcodesim.material.loose import drop_loose

    shop = job.shop
    assert shop is not None
    for name, placed in shop.stocks.items():
        change = execution.changes.get(name)
        if placed.revolved or change is None or change.removed <= 0.0 or change.added > 0.0:
            continue
        for piece in drop_loose(placed.stock):
            row = _freeing_row(job, execution, placed, piece)
            span = _span(job, row)
            fallen = FallenPiece(volume=piece.volume, low=piece.low, high=piece.high, span=span)
            job.fallen.setdefault(name, []).append(fallen)
            job.findings.add(_told(job, execution, name, piece, row, span))


def _span(job: Job, row: int) -> Span:
    assert job.plan is not None
    return job.plan.path.span(row) if row >= 0 else Span(job.program.name)


def _told(job: Job, execution: Execution, name: str, piece: PartedPiece, row: int, span: Span) -> Diagnostic:
    assert job.plan is not None and job.shop is not None
    size = " x ".join(f"{length / MM:.1f}" for length in piece.high - piece.low)
    tool = job.shop.tool(int(job.plan.path.states[job.plan.path.state[row]].tool)) if row >= 0 else None
    meant = tool is not None and getattr(tool, "reach", None) is not None and "milling" not in tool.processes
    return Diagnostic(
        code="GS440",
        severity=Severity.NOTE if meant else None,
        span=span,
        message=f"a piece of {piece.volume / MM3:.1f} mm³, {size} mm, comes loose from stock `{name}`",
        hint="" if meant else "leave tabs, or clamp it before this line, if it is not to be caught by the tool",
        time=float(job.plan.trajectory.row_end[row]) if row >= 0 else None,
        value=piece.volume / MM3,
        unit="mm^3",
    )


def _freeing_row(job: Job, execution: Execution, placed: PlacedStock, piece: PartedPiece) -> int:
    """The last row that took material beside a piece; -1 if none did."""
    plan, shop = job.plan, job.shop
    assert plan is not None and shop is not None
    removed = execution.rows["removed"]
    rows = np.flatnonzero(removed > 0.0)
    if not len(rows) or not len(plan.path):
        return -1
    trajectory = plan.trajectory
    times = np.concatenate([trajectory.row_start[rows], trajectory.row_end[rows]])
    samples = trajectory.sample(times)
    q = plan.joints(samples)
    tip = plan.tip(q, np.concatenate([rows, rows]))
    X = shop.scene.seen_from(shop.name, placed.frame, {shop.name: q})
    points = applied(X[:, :3, :3].swapaxes(1, 2), tip[:, :3, 3] - X[:, :3, 3])
    start, end = points[: len(rows)], points[len(rows) :]
    numbers = np.array([state.tool for state in plan.path.states])[plan.path.state[rows]]
    radius = np.array([0.5 * float(getattr(shop.tool(int(n)), "diameter", 0.0) or 0.0) for n in numbers])
    margin = (radius + BESIDE * placed.stock.cell)[:, None]
    low, high = np.minimum(start, end) - margin, np.maximum(start, end) + margin
    beside = ((low < piece.high) & (high > piece.low))[:, :2].all(axis=1)
    found = rows[beside]
    return int(found[-1]) if len(found) else int(rows[-1])

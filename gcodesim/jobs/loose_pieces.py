"""Pieces that a program cut loose, each with the move that freed it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.jobs.results import FallenPiece, PieceRest
from gcodesim.units import MM, MM3

if TYPE_CHECKING:
    from gcodesim.executor import Execution
    from gcodesim.executor.freeing import Freed
    from gcodesim.executor.loose_bodies import LooseBody
    from gcodesim.jobs.job import Job
    from gcodesim.planning import Plan
    from gcodesim.shop import Shop


def fallen_pieces(job: Job, execution: Execution, loose: Sequence[LooseBody] = ()) -> Iterator[tuple[str, FallenPiece]]:
    """What fell out of the stocks of a run, each with the name of its stock, in order; `loose` says where it lies."""
    assert job.plan is not None
    lying = {id(body.freed): body for body in loose}
    for freed in execution.freed:
        piece, span, body = freed.piece, job.plan.path.span(freed.row), lying.get(id(freed))
        rest = None if body is None else PieceRest(name=body.name, way=body.way, support=_label(body.support, loose))
        yield freed.name, FallenPiece(volume=piece.volume, low=piece.low, high=piece.high, span=span, rest=rest)


def _label(support: str, loose: Sequence[LooseBody]) -> str:
    """What the results call a support: a piece by its whole name, anything else as the cell does."""
    return support if support in {body.name for body in loose} else support.rpartition("/")[2]


def loose_finding(freed: Freed, plan: Plan, shop: Shop) -> Diagnostic:
    """GS440; a note where the tool is meant to cut free."""
    piece, row = freed.piece, freed.row
    size = " x ".join(f"{length / MM:.1f}" for length in piece.high - piece.low)
    tool = shop.tool(int(plan.path.states[plan.path.state[row]].tool))
    meant = tool is not None and getattr(tool, "reach", None) is not None and "milling" not in tool.processes
    return Diagnostic(
        code="GS440",
        severity=Severity.NOTE if meant else None,
        span=plan.path.span(row),
        message=f"a piece of {piece.volume / MM3:.1f} mm³, {size} mm, comes loose from stock `{freed.name}`",
        hint="" if meant else "leave tabs, or clamp it before this line, if it is not to be caught by the tool",
        time=float(plan.trajectory.row_end[row]),
        value=piece.volume / MM3,
        unit="mm^3",
    )

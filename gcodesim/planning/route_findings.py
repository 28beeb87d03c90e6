"""What a search over all configurations has to say: how the tool turns, or where no configuration leads on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.diagnostics import Diagnostic
from gcodesim.frozen import frozen
from gcodesim.kinematics.protocol import Status
from gcodesim.planning.configuration import Hindrance
from gcodesim.planning.moments import OnPiece, PathFindings
from gcodesim.planning.nodes import Nodes
from gcodesim.planning.reach import FlangePoses, why
from gcodesim.planning.route import DeadEnd
from gcodesim.planning.spin_along import SpinAlong
from gcodesim.units import DEG

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics

_TURNED: Final = 1.0 * DEG  # of spin along the path that is worth a word


@frozen(kw_only=False)
class ToldEnd:
    """What has been said of a path without a way: which `part` of it can be run, and whether a finding says so.

    That finding stands for limits and jumps on the pieces from `pieces[0]` to the one before `pieces[1]` too: with
    joints from anywhere else the way through them would end in others.
    """

    part: str = ""
    pieces: tuple[int, int] = (0, 0)


def report_route(
    flange: FlangePoses,
    turning: SpinAlong | None,
    nodes: Nodes,
    hit: tuple[str, str] | None,
    findings: PathFindings,
) -> None:
    """A note that one spin and one configuration near home would not have done; `hit`: what would hit what there."""
    path = flange.pieces.path
    first = path.span(int(flange.pieces.row_last[nodes.piece[0]]))
    begin = OnPiece(int(nodes.piece[0]), 0.0)
    if turning is None or np.ptp(turning.spin) < _TURNED:
        fault = "does not lead through" if hit is None else f"lets {hit[0]} hit {hit[1]}"
        message = f"the configuration comes from a search over the whole path: that nearest to home {fault}"
        findings.add(Diagnostic(code="GS215", message=message, span=first), at=begin)
        return
    fault = "the arm does not get through" if hit is None else f"{hit[0]} hits {hit[1]}"
    low, high = float(turning.spin.min()), float(turning.spin.max())
    findings.add(
        Diagnostic(
            code="GS215",
            message=f"the tool turns about itself along the path, between spins of {low / DEG:.0f} and"
            f" {high / DEG:.0f} deg: with one spin for all of it {fault}",
            span=first,
            value=high - low,
            unit="rad",
        ),
        at=begin,
    )


def report_dead_end(kinematics: Kinematics, flange: FlangePoses, end: DeadEnd, findings: PathFindings) -> ToldEnd:
    """The longest part that can be run, as a share of the way of its chain.

    Where no pose beyond it is to blame, but that no way leads on, this is a finding of its own.
    """
    pieces, nodes = flange.pieces, end.nodes

    def line(node: int) -> int:
        return pieces.path.span(int(pieces.row_last[nodes.piece[node]])).line

    a, b = end.chain
    way = nodes.way(a, b)
    share = float((way[end.last - a] - way[end.first - a]) / max(way[-1], 1e-300))
    whole = f"lines {line(a)} to {line(b - 1)}"
    if end.q is None:
        part = f"nothing of {whole} can be run"
    else:
        part = f"at most {100.0 * share:.0f} % of {whole} can be run, from line {line(end.first)} to {line(end.last)}"
    if end.obstacle in (Hindrance.WAY, Hindrance.COLLISION):
        ends = "then" if end.next_node >= end.last else "before that"
        if end.obstacle is Hindrance.COLLISION:
            hits = "the arm hits something" if end.hits is None else f"{end.hits[0]} hits {end.hits[1]}"
            reason = f"every way on ends in a collision: {hits}"
        else:
            reason = f"no continuous way leads on{_facts(kinematics, flange, end)}"
        findings.add(
            Diagnostic(
                code="GS216",
                message=f"no configuration of the arm leads through: {part}; {ends} {reason}",
                span=pieces.path.span(int(pieces.row_last[nodes.piece[end.next_node]])),
                hint="`gcodesim place` searches a place of the part where all of it can be run",
                value=share,
                limit=1.0,
                unit="",
                bodies=end.hits or (),
            ),
            at=OnPiece(int(nodes.piece[end.next_node]), float(nodes.s[end.next_node])),
        )
        return ToldEnd(part, (int(nodes.piece[a]), int(nodes.piece[b - 1]) + 1))
    return ToldEnd(part)


def _facts(kinematics: Kinematics, flange: FlangePoses, end: DeadEnd) -> str:
    """What the arm would have to do to go on."""
    if end.q is None:
        return ""
    at = slice(end.next_node, end.next_node + 1)
    X = flange.at(end.nodes.piece[at], end.nodes.s[at])
    status = int(kinematics.inverse(X, end.q, on_path=True)[1][0])
    if status in (Status.OK, Status.SINGULAR):
        return ""
    return f" ({why(kinematics, kinematics.reason(X[0], end.q, status))})"

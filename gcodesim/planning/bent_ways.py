"""Moves that go otherwise than they look in the program: bent rapids, and axes that turn on the spot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos
from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.diagnostics import Diagnostic
from gcodesim.motion.curve_kernels import TIMED
from gcodesim.motion.pieces import Pieces
from gcodesim.motion.tool_path import ToolPath
from gcodesim.planning.moments import OnBlock, OnPiece, PathFindings
from gcodesim.planning.spot_kernels import far_turns
from gcodesim.units import DEG, MM

if TYPE_CHECKING:
    from gcodesim.frames import Array
    from gcodesim.kinematics.protocol import Kinematics
    from gcodesim.kinematics.tool_point import ToolPoint
    from gcodesim.planning.nodes import Nodes
    from gcodesim.planning.reach import FlangePoses

_SAMPLES: Final = 64  # of a bent rapid
_BENT: Final = 1e-3  # [m] beside the straight line that is worth a note
_JUMP: Final = 90.0 * DEG  # by which a rotary axis may turn more than the tool does, within one feed move
_SPOT: Final = 20e-3  # [m] of a feed on which a joint of an arm may not turn by so much more


def report_bent_rapids(pieces: Pieces, findings: PathFindings) -> None:
    """GS211: rapids in which each axis goes at its own speed, so that the way between the ends is not straight."""
    bent = np.flatnonzero(pieces.curves.kind[pieces.curve] == TIMED)
    if not len(bent):
        return
    share = np.linspace(0.0, 1.0, _SAMPLES)[:, None]
    points, _ = pieces.points(np.tile(bent, _SAMPLES), (share * pieces.length[bent]).ravel())
    way = points.reshape(_SAMPLES, len(bent), 6)[:, :, :3]
    start, along = way[0], way[-1] - way[0]
    size = np.maximum(norms(along), 1e-12)[:, None]
    beside = way - start
    unit = along / size
    beside = beside - (beside * unit).sum(axis=2)[:, :, None] * unit
    off = norms(beside).max(axis=0)
    found = np.flatnonzero(off > _BENT)
    if not len(found):
        return
    path, first = pieces.path, int(pieces.row_first[bent[found[0]]])
    worst = found[int(np.argmax(off[found]))]
    row = int(pieces.row_first[bent[worst]])
    far = "" if row == first else f", and {off[worst] / MM:.1f} mm in line {path.span(row).line}"
    findings.add(
        Diagnostic(
            code="GS211",
            message=f"each axis goes at its own speed: this rapid passes {off[found[0]] / MM:.1f} mm beside the"
            f" straight line between its ends{far}",
            span=path.span(first),
            hint="go up first, then across; what is cut and checked for collisions is the bent way",
            count=len(found),
            value=float(off[worst]),
            unit="m",
        ),
        at=OnPiece(int(bent[found[0]]), 0.0),
    )


def report_jumps(path: ToolPath, tool: ToolPoint, held: NDArray[np.bool_], q: Array, findings: PathFindings) -> None:
    """GS212: feed moves of the tip in which a rotary axis turns far though the tool hardly leans otherwise.

    `q` (2, n, j) are the joints at the start and at the end of the rows.
    """
    if len(tool.rotary) < 2:
        return
    turned = np.abs(q[1] - q[0])[:, tool.rotary]
    rows = np.flatnonzero(held & np.isfinite(path.feed) & (turned.max(axis=1, initial=0.0) > _JUMP))
    if not len(rows):
        return
    before, after = (tool.directions(np.ascontiguousarray(each[rows])) for each in q)
    lean = acos(np.clip(dots(before, after), -1.0, 1.0))
    jumps = np.flatnonzero(turned[rows].max(axis=1) - lean > _JUMP)
    if not len(jumps):
        return
    first = int(rows[jumps[0]])
    axis = int(np.argmax(turned[first]))
    letter, angle = tool.letters[axis], float(turned[first, axis])
    findings.add(
        Diagnostic(
            code="GS212",
            message=f"{letter} turns by {angle / DEG:.0f} deg in a move in which the tool's direction in"
            f" the work changes by {lean[jumps[0]] / DEG:.1f} deg",
            span=path.span(first),
            hint="lift the tool before an axis rewinds or changes its branch, or keep clear of the pole",
            count=len(jumps),
            value=angle,
            limit=_JUMP,
            unit="rad",
        ),
        at=OnBlock(int(path.block[first])),
    )


def report_turning_joints(
    kinematics: Kinematics,
    flange: FlangePoses,
    nodes: Nodes,
    q: Array,
    exact: NDArray[np.bool_],
    findings: PathFindings,
) -> None:
    """GS212 on arms: a joint turns far on a short way of a feed though the tool hardly turns, as a wrist that flips.

    `q` (k, j) are the joints at the nodes; `exact` (k,) marks nodes that the arm reaches. Where GS204 says already that
    a joint is too slow for such a turn, nothing is said again.
    """
    turning = np.array([kind == "revolute" for kind in kinematics.joints.kinds])
    pieces = flange.pieces
    good = exact & np.isfinite(pieces.path.feed[pieces.row_first])[nodes.piece]
    found = np.empty((len(nodes), 2), dtype=np.int64)
    joints = np.ascontiguousarray(q)
    count = far_turns(nodes.piece, nodes.s, nodes.head, good, joints, turning, _SPOT, _JUMP, found)
    if not count:
        return
    begin, end = found[:count].T
    turned = np.abs(q[end] - q[begin]) * turning
    before, after = (flange.at(nodes.piece[k], nodes.s[k])[:, :3, :3] for k in (begin, end))
    cosine = 0.5 * ((before * after).sum(axis=(1, 2)) - 1.0)  # Rodrigues 1840: the trace of the turn between both
    lean = acos(np.clip(cosine, -1.0, 1.0))
    rows = pieces.row_last[nodes.piece[end]].astype(np.int64)
    told = {finding.span for finding in findings if finding.code == "GS204"}
    jumps = [k for k in np.flatnonzero(turned.max(axis=1) - lean > _JUMP) if pieces.path.span(int(rows[k])) not in told]
    if not jumps:
        return
    first = jumps[0]
    worst = max((k for k in jumps if rows[k] == rows[first]), key=lambda k: float(turned[k].max()))
    joint = int(turned[worst].argmax())
    angle = float(turned[worst, joint])
    findings.add(
        Diagnostic(
            code="GS212",
            message=f"{kinematics.joints.names[joint]} turns by {angle / DEG:.0f} deg within {_SPOT / MM:.0f} mm of a"
            f" feed, in which the tool turns by {lean[worst] / DEG:.1f} deg",
            span=pieces.path.span(int(rows[first])),
            hint="keep clear of the singularity: shift the part, tilt the tool, or let its spin free",
            count=len({int(rows[k]) for k in jumps}),
            value=angle,
            limit=_JUMP,
            unit="rad",
        ),
        at=OnPiece(int(nodes.piece[begin[first]]), float(nodes.s[begin[first]])),
    )

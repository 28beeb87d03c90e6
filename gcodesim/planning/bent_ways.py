"""Moves that go otherwise than they look in the program: bent rapids, and tools that turn on the spot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos
from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.diagnostics import Diagnostic, Findings
from gcodesim.motion.curve_kernels import TIMED
from gcodesim.motion.pieces import Pieces
from gcodesim.motion.tool_path import ToolPath
from gcodesim.units import DEG, MM

if TYPE_CHECKING:
    from gcodesim.frames import Array
    from gcodesim.kinematics.tool_point import ToolPoint

_SAMPLES: Final = 64  # of a bent rapid
_BENT: Final = 1e-3  # [m] beside the straight line that is worth a note
_JUMP: Final = 90.0 * DEG  # by which a rotary axis may turn more than the tool does, within one feed move


def report_bent_rapids(pieces: Pieces, findings: Findings) -> None:
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
        )
    )


def report_jumps(path: ToolPath, tool: ToolPoint, held: NDArray[np.bool_], q: Array, findings: Findings) -> None:
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
        )
    )

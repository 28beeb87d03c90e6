"""Whether a path stays inside the travel of the axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.elementary import atan2, cos, sin
from gcodesim.canon import AXIS_LETTERS
from gcodesim.canon.systems import name_of_system
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.curves import Curves
from gcodesim.motion.tool_path import ARC, HOME, Commanded, ToolPath
from gcodesim.planning.moments import LimitPassing, OnBlock, PathFindings
from gcodesim.units import DEG, MM

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Joints

_SLACK: Final = 1e-9  # [m, rad] from rounding of inches and decimals


def axis_ranges(path: ToolPath) -> tuple[Array, Array]:
    """Least and greatest axis values of every row, two arrays (n, 6): control point plus offset, arcs with their bulge.

    The start of a row counts towards the row before it.
    """
    low, high = path.end.copy(), path.end.copy()
    arc = np.flatnonzero(path.kind == ARC)
    if len(arc):
        curves = Curves.of(path).take(arc)
        # a component is greatest where the angle is that of (radial, sideways) in it; then every half turn
        peak = atan2(curves.sideways, curves.radial)
        sweep = curves.sweep[:, None]
        for half_turns in range(-2 * _most_turns(curves), 2 * _most_turns(curves) + 1):
            angle = peak + half_turns * np.pi
            u = angle / np.where(sweep == 0.0, 1.0, sweep)
            size = 1.0 + curves.growth[:, None] * u
            at = curves.center + u * curves.lift + size * (cos(angle) * curves.radial + sin(angle) * curves.sideways)
            inside = (u > 0.0) & (u < 1.0)
            low[arc, :3] = np.where(inside, np.minimum(low[arc, :3], at), low[arc, :3])
            high[arc, :3] = np.where(inside, np.maximum(high[arc, :3], at), high[arc, :3])
    offset = np.array([s.offset for s in path.states], dtype=float).reshape(-1, 6)[path.state]
    return low + offset, high + offset


def _most_turns(curves: Curves) -> int:
    return int(np.ceil(np.abs(curves.sweep).max() / (2.0 * np.pi))) + 1


@frozen(kw_only=False, eq=False)
class TravelEnds:
    """Joints (j,) between `lower` and `upper` [m, rad], by their `letters`; `number` is which of all joints each is."""

    letters: tuple[str, ...]
    linear: tuple[bool, ...]
    lower: Array
    upper: Array
    number: NDArray[np.intp]

    @staticmethod
    def of(joints: Joints, number: NDArray[np.intp] | None = None) -> TravelEnds:
        """That of all joints, or of those with the numbers (k,)."""
        which = np.arange(len(joints)) if number is None else number
        own = joints.part(which)
        letters = tuple(name.rpartition("/")[2] for name in own.names)
        return TravelEnds(letters, tuple(kind == "prismatic" for kind in own.kinds), own.lower, own.upper, which)


def report_missing_axes(path: ToolPath, axes: NDArray[np.intp], findings: PathFindings) -> None:
    """Report axes that the program moves and the machine does not have."""
    for axis in range(6):
        rows = np.flatnonzero(path.end[:, axis] != path.start[:, axis])
        if axis in axes or not len(rows):
            continue
        findings.add(
            Diagnostic(
                code="GS207",
                message=f"the program moves {AXIS_LETTERS[axis]}, which this machine does not have",
                span=path.span(int(rows[0])),
                hint="its axes are " + ", ".join(AXIS_LETTERS[a] for a in sorted(axes)),
                count=len(distinct(path.block[rows])),
            ),
            at=OnBlock(int(path.block[rows[0]])),
        )


def report_travel(
    path: ToolPath,
    axes: NDArray[np.intp],
    travel: TravelEnds,
    findings: PathFindings,
    ranges: tuple[Array, Array] | None = None,
) -> None:
    """Report each end of travel that is passed, once: the first line, the worst value and a shift that would fit.

    The joints of `travel` are the `axes` (j,); `ranges` are the axis values of rows, if they are not those of
    `axis_ranges`.
    """
    if not len(path):
        return
    low, high = axis_ranges(path) if ranges is None else ranges
    for j, axis in enumerate(axes):
        for limit, values, sign in ((travel.lower[j], low, -1.0), (travel.upper[j], high, 1.0)):
            rows = np.flatnonzero(sign * (values[:, axis] - limit) > _SLACK)
            if len(rows):
                _report_axis(path, rows, (int(axis), j, sign), values[:, axis], (low, high), travel, findings)


def _report_axis(
    path: ToolPath,
    rows: NDArray[np.intp],
    side: tuple[int, int, float],
    values: Array,
    ranges: tuple[Array, Array],
    travel: TravelEnds,
    findings: PathFindings,
) -> None:
    """GS201 for an axis, its joint and the upper (1) or lower end (-1) of it."""
    axis, j, sign = side
    linear, letter, limit = (
        travel.linear[j],
        travel.letters[j],
        float(travel.upper[j] if sign > 0.0 else travel.lower[j]),
    )
    unit, factor = ("mm", MM) if linear else ("deg", DEG)
    first = int(rows[0])
    worst = int(rows[np.argmax(np.abs(values[rows] - limit))])
    value = float(values[first])
    state = path.state_of(first)
    systems = np.array([s.system for s in path.states])[path.state]
    machine = np.array([s.word.startswith(("G53", "G28", "G30")) for s in path.states])[path.state]
    movable = (systems == state.system) & ~machine & (path.kind != HOME)
    if any(s.control == Commanded.POINT for s in path.states):
        movable[:] = False  # where the work turns, a shift of it is none of an axis
    hint = ""
    if movable.any() and not machine[first]:
        least, most = float(ranges[0][movable, axis].min()), float(ranges[1][movable, axis].max())
        room = (float(travel.lower[j]) - least, float(travel.upper[j]) - most)
        if room[0] <= room[1]:
            shift = min(max(0.0, room[0]), room[1])
            hint = f"{name_of_system(state.system)} shifted by {shift / factor:+.3f} {unit} in {letter} would fit"
        else:
            hint = (
                f"no shift fits: the program needs {(most - least) / factor:.3f} {unit} of {letter},"
                f" the machine has {(travel.upper[j] - travel.lower[j]) / factor:.3f} {unit}"
            )
    if path.span(worst) != path.span(first):
        far = f"worst {values[worst] / factor:.3f} {unit} in line {path.span(worst).line}"
        hint = f"{far}; {hint}" if hint else far
    offset = state.offset[axis]
    with_tool = f" (with a tool offset of {offset / factor:.3f} {unit})" if offset else ""
    findings.add(
        Diagnostic(
            code="GS201",
            message=f"{letter} would go to {value / factor:.3f} {unit} of the machine{with_tool};"
            f" its travel ends at {limit / factor:.3f} {unit}",
            span=path.span(first),
            hint=hint,
            count=len(distinct(path.block[rows])),
            value=value,
            limit=limit,
            unit="m" if linear else "rad",
        ),
        at=LimitPassing(int(path.block[first]), int(travel.number[j]), limit, sign),
    )

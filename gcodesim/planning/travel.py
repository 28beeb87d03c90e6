"""Whether a path stays inside the travel of the axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.elementary import atan2, cos, sin
from gcodesim.canon import AXIS_LETTERS
from gcodesim.canon.systems import name_of_system
from gcodesim.diagnostics import Diagnostic, Findings
from gcodesim.frames import Array
from gcodesim.motion.curves import Curves
from gcodesim.motion.tool_path import ARC, HOME, Commanded, ToolPath
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


def report_missing_axes(path: ToolPath, axes: NDArray[np.intp], findings: Findings) -> None:
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
            )
        )


def report_travel(
    path: ToolPath,
    axes: NDArray[np.intp],
    joints: Joints,
    findings: Findings,
    ranges: tuple[Array, Array] | None = None,
    letters: Sequence[str] = AXIS_LETTERS,
) -> None:
    """Report each end of travel that is passed, once: the first line, the worst value and a shift that would fit.

    `ranges` are the axis values of rows, if they are not those of `axis_ranges`; `letters` the names of the joints, if
    they are not those of the `axes`.
    """
    if not len(path):
        return
    low, high = axis_ranges(path) if ranges is None else ranges
    for j, axis in enumerate(axes):
        for limit, values, sign in ((joints.lower[j], low, -1.0), (joints.upper[j], high, 1.0)):
            beyond = sign * (values[:, axis] - limit)
            rows = np.flatnonzero(beyond > _SLACK)
            if len(rows):
                letter = letters[axis] if letters is AXIS_LETTERS else letters[j]
                _report_axis(
                    path, rows, int(axis), j, float(limit), values[:, axis], (low, high), joints, letter, findings
                )


def _report_axis(
    path: ToolPath,
    rows: NDArray[np.intp],
    axis: int,
    j: int,
    limit: float,
    values: Array,
    ranges: tuple[Array, Array],
    joints: Joints,
    letter: str,
    findings: Findings,
) -> None:
    linear = joints.kinds[j] == "prismatic"
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
        room = (float(joints.lower[j]) - least, float(joints.upper[j]) - most)
        if room[0] <= room[1]:
            shift = min(max(0.0, room[0]), room[1])
            hint = f"{name_of_system(state.system)} shifted by {shift / factor:+.3f} {unit} in {letter} would fit"
        else:
            hint = (
                f"no shift fits: the program needs {(most - least) / factor:.3f} {unit} of {letter},"
                f" the machine has {(joints.upper[j] - joints.lower[j]) / factor:.3f} {unit}"
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
        )
    )

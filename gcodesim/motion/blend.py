"""How rows of a path are joined: exact stops, exact paths, corner arcs, overlaps, merged chords.

The rules are those of LinuxCNC's planner: G61.1 stands at every end point; G61
passes joints that are tangent or nearly so and stands at all others; G64 P puts an
arc into corners of lines and arcs, and where none fits (rotary axes, helices, arcs
under a narrow angle) the end of one block overlaps with the start of the next. Where
the path turns back it stands in all modes. With P or Q, chords within that distance
of one line become one line, and arcs of the XY plane that are as flat become chords (`ARC_FEED` in emccanon.cc).

In G64 the last block before the queue runs empty (the end, a dwell, M8) has half of its acceleration in both ramps,
even one that stands alone: LinuxCNC 2.9 halves it for every segment that ends in "blend", also where nothing follows
(`tcGetOverallMaxAccel` in tc.c, 2.9.9; the recorded times say the same). 2.10 halves it only while two segments
overlap (change 4220 of July 2026); `G61` gives a lone block all of its acceleration in both.

From one stop to the next LinuxCNC takes whole cycles, since only a block that goes over into the next hands on what is
left of its last one (`tpCheckEndCondition` in tp.c). That is half a cycle a stop more on the mean than here: 1.3 % in
chords of 1 mm that stop at each end, 2.8 % in blocks of 0.3 mm. Other controls have other cycles, so it is not done.

On a helix of radius R and rise h it takes R + h²/R for the radius of curvature, with all of the rise in place of that
of one radian (`pmCircleEffectiveMinRadius` in blendmath.c, 2.9.9). So small steep ones run faster there, at several
times the acceleration of their axes; here they keep it.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.arithmetic.matrices import norms
from gcodesim.canon import Output
from gcodesim.frames import Array
from gcodesim.motion.blend_kernels import (
    CYCLE,
    NORMAL_SHARE,
    OPEN_END_SHARE,
    OVERLAPPED,
    PASS,
    ROUNDED,
    TANGENTIAL_SHARE,
    JointColumns,
    Tangents,
    along_axes,
    corners,
    merge_chords,
    overlaps,
)
from gcodesim.motion.columns import Column
from gcodesim.motion.curve_kernels import OWN, ROUND, STRAIGHT, TIMED, longest_times
from gcodesim.motion.curves import Curves
from gcodesim.motion.pieces import OVERLAP, PART, AxisLimits, Pieces
from gcodesim.motion.tool_path import BLEND, HOME, LINE, RAPID, ToolPath

# A line that would last less than this [s] at the speed of the corner behind it becomes a part of that corner:
# `blendCheckConsume` in blendmath.c, with `ARC_BLEND_GAP_CYCLES` as it is delivered.
_REMNANT: Final = 4.0 * CYCLE
LEAST_CYCLES: Final = 1.02  # that a piece lasts (`TP_MIN_SEGMENT_CYCLES`)
LEAST: Final = 1e-12  # [m, rad] anything shorter counts as not moving


def blend(
    path: ToolPath,
    limits: AxisLimits,
    *,
    independent_rapids: bool | NDArray[np.bool_] = False,
    own_time: Array | None = None,
    even: bool = False,
    sampled: bool = True,
    early: bool = False,
) -> Pieces:
    """Join the rows of `path` under the `limits` of the axes.

    `independent_rapids`, for all rows or for each (n,): in G0 every axis runs at its own speed from rest to
    rest, so the path is not straight and rapids are joined to nothing. Rows
    with a finite `own_time` (n,) [s] follow a law of their own from rest to
    rest and take that time. Other rows that do not move are left out; their
    events keep their places. `even`: rows that overlap do so at one speed, as a
    law of time with bounded jerk needs it. `sampled`: as by a control that
    runs no piece in less than one of its cycles, and what is too short for that together with the corner behind it.
    `early`: where rows overlap, the second may have its speed before the first stands, as it has in LinuxCNC.
    """
    curves = Curves.of(path)
    if own_time is not None:
        own = np.isfinite(own_time)
        curves.kind[own] = OWN
        curves.length[own] = own_time[own]
    kept = np.flatnonzero((curves.length > 4.0 * LEAST) | (curves.kind == OWN))
    flat = _flat_arcs(path, curves)
    middle = np.zeros((len(path), 3))
    if flat.any():
        middle[flat] = curves.points_at(np.flatnonzero(flat), np.full(np.count_nonzero(flat), 0.5))
        _straighten(curves, np.flatnonzero(flat))
    chains = _chains(path, kept, flat, middle)
    row_first, row_last = kept[chains], kept[np.append(chains[1:], len(kept))[: len(chains)] - 1]
    curves = _merged(curves, path, row_first, row_last)
    stop = _stops(path, row_last)
    independent = np.broadcast_to(independent_rapids, len(path))[row_first]
    if independent.any():
        _make_independent(curves, np.isin(path.kind[row_first], (RAPID, HOME)) & independent, limits)
    # rapids are not joined to feeds, nor lines to what runs by time; the queue does not run empty there
    apart = np.zeros(len(stop), dtype=bool)
    feeding, timed = np.isfinite(path.feed[row_first]), curves.kind >= TIMED
    apart[:-1] = (feeding[1:] != feeding[:-1]) | timed[1:] | timed[:-1]
    return _join(
        path, limits, curves, stop, apart, row_first.astype(np.int32), row_last.astype(np.int32), sampled, even, early
    )


def _flat_arcs(path: ToolPath, curves: Curves) -> NDArray[np.bool_]:
    """Which rows (n,) are arcs of the XY plane that leave their chord by less than what chords are merged by."""
    flat: NDArray[np.bool_] = (
        (curves.kind == ROUND)
        & (path.mode == BLEND)
        & (path.naive > 0.0)
        & (np.abs(path.sweep) <= math.pi)
        & (np.abs(path.normal[:, 2]) > 1.0 - 1e-12)
        & _equal(path.start[:, 3:], path.end[:, 3:])
    )
    rows = np.flatnonzero(flat)
    if len(rows):
        flat[rows] = norms(curves.radial[rows]) * (1.0 - cos(0.5 * path.sweep[rows])) < path.naive[rows]
    return flat


def _straighten(curves: Curves, rows: NDArray[np.intp]) -> None:
    """Turn curves into lines from their starts to their ends."""
    curves.kind[rows] = STRAIGHT
    curves.length[rows] = norms(curves.end[rows, :3] - curves.start[rows, :3])
    for column in (curves.center, curves.radial, curves.sideways, curves.lift, curves.sweep, curves.growth):
        column[rows] = 0.0


def _chains(path: ToolPath, kept: NDArray[np.intp], flat: NDArray[np.bool_], middle: Array) -> NDArray[np.intp]:
    """Positions within `kept` where a new curve begins; rows in between belong to the curve before (merged chords).

    Rows (n,) that are `flat` are arcs that go as chords, past their `middle` (n, 3) [m].
    """
    n = len(kept)
    if n == 0:
        return np.zeros(0, dtype=np.intp)
    rows, before = kept[1:], kept[:-1]
    straight = ((path.kind == LINE) | flat) & _equal(path.start[:, 3:], path.end[:, 3:])
    same = (
        straight[rows]  # rapids, other arcs and moves with a law of their own stay as they are
        & straight[before]
        & (path.mode[rows] == BLEND)
        & (path.mode[before] == BLEND)
        & (path.naive[rows] > 0.0)
        & (path.naive[before] > 0.0)
        & (path.feed[rows] == path.feed[before])
        & (path.state[rows] == path.state[before])
        & (path.active[rows] == path.active[before])
        & ~_stops_between(path, before, rows)
        & ~_outputs_between(path, before, rows)
        & _equal(path.start.take(rows, axis=0), path.end.take(before, axis=0))
    )
    if not same.any():
        return np.arange(n)
    joined = np.concatenate([[False], same])
    first = merge_chords(
        path.start.take(kept, axis=0),
        path.end.take(kept, axis=0),
        joined,
        path.naive[kept],
        flat[kept],
        middle.take(kept, axis=0),
    )
    heads: NDArray[np.intp] = np.flatnonzero(first == np.arange(n))
    return heads


def _equal(one: Array, other: Array) -> NDArray[np.bool_]:
    """Whether rows (n, k) are the same; column by column, as k is small."""
    same: NDArray[np.bool_] = one[:, 0] == other[:, 0]
    for k in range(1, one.shape[1]):
        same &= one[:, k] == other[:, k]
    return same


def _stops_between(path: ToolPath, before: NDArray[np.intp], after: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Whether any row from `before` up to the one ahead of `after` ends at rest."""
    count = np.concatenate([[0], np.cumsum(path.stop)])
    between: NDArray[np.bool_] = count[after] - count[before] > 0
    return between


def _outputs_between(path: ToolPath, before: NDArray[np.intp], after: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Whether an output is switched after row `before` has begun and before `after` does."""
    switched = np.zeros(len(path) + 1, dtype=np.int64)
    for event in path.events:
        if isinstance(event.event, Output) and event.event.with_motion:
            switched[event.row] = 1
    count = np.cumsum(switched)
    between: NDArray[np.bool_] = count[after] - count[before] > 0
    return between


def _stops(path: ToolPath, row_last: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Which curves end at rest; a jump of the controlled point (a new offset) is a stop as well."""
    if not len(row_last):
        return np.zeros(0, dtype=bool)
    following = np.append(row_last[1:], len(path))
    stop = _stops_between(path, row_last, following)
    stop[-1] = True
    return stop


def _merged(curves: Curves, path: ToolPath, first: NDArray[np.intp], last: NDArray[np.intp]) -> Curves:
    """The curves that rows `first` to `last` become; those given where none is left out."""
    if len(first) == len(curves):
        return curves
    out = curves.take(first)
    many = np.flatnonzero(first != last)
    out.end[many] = path.end[last[many]]
    out.length[many] = norms(out.end[many, :3] - out.start[many, :3])
    return out


def _make_independent(curves: Curves, rapid: NDArray[np.bool_], limits: AxisLimits) -> None:
    """Turn rapids into curves run by time: the slowest axis decides, every other one waits at its end."""
    rows = np.flatnonzero(rapid)
    curves.kind[rows] = TIMED
    curves.length[rows] = longest_times(np.abs(curves.end[rows] - curves.start[rows]), limits.arrays)


def along_limits(curves: Curves, limits: AxisLimits) -> tuple[Array, Array, Array]:
    """Speed and acceleration (c,) that the axes allow along each curve, and the speed that its curvature allows.

    A line of direction u: the least of limit_i / |u_i|. An arc: the inscribed
    circle of its plane; its curvature takes `NORMAL_SHARE` of the acceleration, and
    along the arc it has what that leaves at the top speed of its axes, or
    `TANGENTIAL_SHARE`.
    """
    table = limits.arrays
    step = curves.end - curves.start
    arc = np.flatnonzero(curves.kind == ROUND)
    step[arc, :3] = curves.lift[arc]
    speed, acceleration = along_axes(step, curves.length, table)
    bending = np.full(len(curves), np.inf)
    with np.errstate(divide="ignore"):
        radius = norms(curves.radial[arc]) * np.minimum(1.0, 1.0 + curves.growth[arc])
        n = np.cross(curves.radial[arc], curves.sideways[arc])
        n /= np.maximum(norms(n)[:, None], 1e-300)
        top, most = _in_plane(n, table[0]), _in_plane(n, table[1])
        share = np.maximum(np.abs(curves.sweep[arc]) * radius / curves.length[arc], 1e-12)
        a = np.minimum(acceleration[arc], most / share)
        across = np.minimum(a, most)  # what bends the path lies in the plane
        bent = np.maximum(radius / (share * share), 1e-12)  # radius of curvature of the helix
        bending[arc] = np.sqrt(NORMAL_SHARE * across * bent)
        speed[arc] = np.minimum(np.minimum(speed[arc], top / share), bending[arc])
        need = np.minimum(top * top / bent / across, 1.0)
        acceleration[arc] = a * np.where(need > NORMAL_SHARE, TANGENTIAL_SHARE, np.sqrt(1.0 - need * need))
    return speed, acceleration, bending


def _in_plane(normal: Array, limits: Array) -> Array:
    """`blend_kernels.in_plane` for unit normals (n, 3)."""
    share = np.sqrt(np.maximum(1.0 - normal * normal, 0.0))
    least: Array = np.min(np.where(share > 1e-6, limits[:3] / np.maximum(share, 1e-6), np.inf), axis=1)
    return least


def _join(
    path: ToolPath,
    limits: AxisLimits,
    curves: Curves,
    open_end: NDArray[np.bool_],
    apart: NDArray[np.bool_],
    row_first: NDArray[np.int32],
    row_last: NDArray[np.int32],
    sampled: bool,
    even: bool,
    early: bool,
) -> Pieces:
    n = len(curves)
    tangents = Tangents(*curves.end_tangents())
    speed, acceleration, bending = along_limits(curves, limits)
    speed = np.minimum(speed, path.feed[row_first])
    if sampled:
        speed = np.minimum(speed, curves.length / CYCLE)
    step = curves.end - curves.start
    turning = np.any(step[:, 3:] != 0.0, axis=1)
    blended = path.mode[row_last] == BLEND
    joints = JointColumns(
        kind=np.zeros(n, dtype=np.uint8),
        trim_end=np.zeros(n),
        trim_start=np.zeros(n),
        cap=np.zeros(n),
        reduction=np.zeros(n),
        acceleration=np.zeros(n),
        arc=np.zeros((n, 10)),
        ratio=np.ones(n),
        rise=np.ones(n),
        duration=np.zeros(n),
    )
    tolerance = path.tolerance[row_last]
    corners(
        open_end | apart,
        blended,
        turning,
        speed,
        np.minimum(acceleration, 1e30),
        tolerance,
        tangents,
        limits.arrays,
        curves.arrays,
        joints,
    )
    overlapped = joints.kind == OVERLAPPED
    beside = overlapped.copy()
    beside[1:] |= overlapped[:-1]
    speed = np.where(beside, np.minimum(speed, bending * np.sqrt(OPEN_END_SHARE)), speed)
    shared = beside | (open_end & blended)
    acceleration = acceleration * (1.0 - joints.reduction) * np.where(shared, OPEN_END_SHARE, 1.0)
    if overlapped.any():
        left = curves.length - joints.trim_start - joints.trim_end
        overlaps(left, speed, acceleration, tolerance, even, early and not even, tangents, limits.arrays, joints)
    return _assemble(path, limits, curves, joints, speed, acceleration, row_first, row_last, sampled)


def _assemble(
    path: ToolPath,
    limits: AxisLimits,
    curves: Curves,
    joints: JointColumns,
    speed: Array,
    acceleration: Array,
    row_first: NDArray[np.int32],
    row_last: NDArray[np.int32],
    sampled: bool,
) -> Pieces:
    """Put pieces of curves and of joints in one line: curve i is at 2 i, the joint after it at 2 i + 1."""
    n = len(curves)
    rounded, lapped = np.flatnonzero(joints.kind == ROUNDED), np.flatnonzero(joints.kind == OVERLAPPED)
    bends = _corner_arcs(curves.end[rounded, 3:], joints.arc[rounded])
    slots = 2 * n
    columns: dict[str, Column] = {
        name: np.zeros(slots) for name in ("begin", "length", "speed", "acceleration", "junction")
    }
    columns["ratio"], columns["rise"] = np.ones((2, slots))
    names = ("curve", "second", "row_first", "row_last")
    whole: dict[str, Column] = {name: np.full(slots, -1, dtype=np.int32) for name in names}
    piece_kind = np.full(slots, PART, dtype=np.uint8)

    main = slice(0, slots, 2)
    columns["begin"][main] = joints.trim_start
    columns["length"][main] = curves.length - joints.trim_start - joints.trim_end
    columns["speed"][main], columns["acceleration"][main] = speed, acceleration
    columns["junction"][main] = np.where(joints.kind <= PASS, joints.cap, np.inf)
    whole["curve"][main] = np.arange(n)
    whole["row_first"][main], whole["row_last"][main] = row_first, row_last

    for those, lap in ((rounded, False), (lapped, True)):
        at = 2 * those + 1
        whole["row_first"][at] = row_last[those]
        whole["row_last"][at] = row_first[those + 1]
        columns["speed"][at] = joints.cap[those]
        columns["junction"][at] = np.inf
        if lap:
            piece_kind[at] = OVERLAP
            whole["curve"][at], whole["second"][at] = those, those + 1
            columns["begin"][at] = curves.length[those] - joints.trim_end[those]
            columns["length"][at] = joints.cap[those] * joints.duration[those]
            columns["ratio"][at], columns["rise"][at] = joints.ratio[those], joints.rise[those]
        else:
            whole["curve"][at] = n + np.arange(len(those))
            columns["length"][at] = bends.length
            columns["acceleration"][at] = TANGENTIAL_SHARE * joints.acceleration[those]
            if sampled:
                _take_remnants(columns, curves, those)

    joint, ramped = np.zeros((2, slots), dtype=bool)
    joint[1::2] = True
    ramped[main] = np.isfinite(path.feed[row_first]) & ((joints.kind == ROUNDED) | (joints.kind == PASS))
    ramped[2 * rounded + 1] = True
    timed = np.zeros(slots, dtype=bool)
    timed[main] = curves.kind >= TIMED
    columns["speed"][timed] = 1.0
    # what two joints leave of a curve may be only rounding
    least = np.where(np.isinf(columns["junction"]), LEAST, 0.0)
    keep = (columns["length"] > least) | timed
    return Pieces(
        path=path,
        limits=limits,
        curves=curves.followed_by(bends),
        kind=piece_kind[keep],
        fixed=timed[keep],
        joint=joint[keep],
        ramped=ramped[keep] & sampled,
        **{name: column[keep] for name, column in columns.items()},
        **{name: column[keep] for name, column in whole.items()},
    )


def _take_remnants(columns: dict[str, Column], curves: Curves, those: NDArray[np.intp]) -> None:
    """Lines of which the corners behind them, of curves `those`, leave too little become a part of these.

    The corner with what it takes, and the line that it leaves, last a cycle at the least.
    """
    line, corner = 2 * those, 2 * those + 1
    length, speed = columns["length"], columns["speed"]
    taken = (curves.kind[those] == STRAIGHT) & (length[line] < _REMNANT * speed[corner])
    way = length[corner] + np.where(taken, length[line], 0.0)
    speed[corner] = np.minimum(speed[corner], way / (LEAST_CYCLES * CYCLE))
    speed[line] = np.minimum(speed[line], length[line] / (LEAST_CYCLES * CYCLE))
    for name in ("speed", "acceleration"):
        columns[name][line[taken]] = columns[name][corner[taken]]


def remnants(pieces: Pieces, cornered: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which pieces (m,) are lines that became a part of the corner behind them; `cornered` (m,): there is one."""
    left = pieces.length < _REMNANT * np.append(pieces.speed[1:], 0.0)
    line: NDArray[np.bool_] = (pieces.curves.kind[pieces.curve] == STRAIGHT) & (pieces.kind == PART) & ~pieces.joint
    return line & left & cornered


def _corner_arcs(rotary: Array, arc: Array) -> Curves:
    """Corner arcs (k, 10) as the kernel gives them, with rotary axes standing at `rotary` (k, 3)."""
    center, radial, sideways, turn = arc[:, :3], arc[:, 3:6], arc[:, 6:9], arc[:, 9]
    start = np.concatenate([center + radial, rotary], axis=1)
    tip = center + cos(turn)[:, None] * radial + sin(turn)[:, None] * sideways
    return Curves(
        kind=np.full(len(arc), ROUND, dtype=np.uint8),
        start=start,
        end=np.concatenate([tip, rotary], axis=1),
        center=center,
        radial=radial,
        sideways=sideways,
        lift=np.zeros((len(arc), 3)),
        sweep=turn,
        growth=np.zeros(len(arc)),
        length=norms(radial) * turn,
    )

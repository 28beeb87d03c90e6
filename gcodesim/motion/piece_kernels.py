"""Points of pieces, and of a trajectory along them; arrays in and out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.motion.curve_kernels import CurveColumns, curve_point
from gcodesim.motion.timing_kernels import PhaseColumns

OVERLAP = 1


class PieceColumns(NamedTuple):
    """Those columns of `pieces.Pieces` that say where it leads, and the limits (3, 6) of the axes."""

    kind: Column
    curve: Column
    second: Column
    begin: Column
    length: Column
    ratio: Column
    rise: Column
    axis_limits: Column


@kernel
def piece_point(
    i: int,
    s: float,
    pieces: PieceColumns,
    curves: CurveColumns,
    position: Column,
    tangent: Column,
    spare: Column,
) -> None:
    """Write position (6,) and derivative by s (6,) of piece `i` at `s`; `spare` (2, 6) is overwritten."""
    kind, curve, second, begin, length, ratio, rise, axis_limits = pieces
    a = curve[i]
    if kind[i] != OVERLAP:
        curve_point(a, begin[i] + s, curves, axis_limits, position, tangent)
        return
    b = second[i]
    u = s / length[i]
    # tau = u T; first curve: v1 (tau - tau²/2T), second: ratio v1 tau²/(2 rise T) up to rise T; length = v1 T
    s1 = begin[i] + length[i] * u * (1.0 - 0.5 * u)
    if u < rise[i]:
        s2, rate = 0.5 * ratio[i] * length[i] * u * u / rise[i], ratio[i] * u / rise[i]
    else:
        s2, rate = ratio[i] * length[i] * (u - 0.5 * rise[i]), ratio[i]
    curve_point(a, s1, curves, axis_limits, position, tangent)
    curve_point(b, s2, curves, axis_limits, spare[0], spare[1])
    start = curves.start
    for k in range(6):
        position[k] += spare[0, k] - start[b, k]
        tangent[k] = tangent[k] * (1.0 - u) + spare[1, k] * rate


@kernel(lean=True)
def fill_points(
    piece: Column, s: Column, pieces: PieceColumns, curves: CurveColumns, position: Column, tangent: Column,
    spare: Column,
) -> None:  # fmt: skip
    """The loop of `points`, which has made all arrays, so that none is counted at each row."""
    for j in range(len(s)):
        piece_point(piece[j], s[j], pieces, curves, position[j], tangent[j], spare)


@kernel
def points(piece: Column, s: Column, pieces: PieceColumns, curves: CurveColumns) -> tuple[Column, Column]:
    """Positions (k, 6) and derivatives by s (k, 6) at `s` (k,) on pieces `piece` (k,)."""
    position, tangent = np.empty((len(s), 6)), np.empty((len(s), 6))
    fill_points(piece, s, pieces, curves, position, tangent, np.empty((2, 6)))
    return position, tangent


@kernel
def sample(
    t: Column, phase: Column, phases: PhaseColumns, pieces: PieceColumns, curves: CurveColumns
) -> tuple[Column, Column, Column, Column]:
    """Position (n, 6), velocity (n, 6), place in the piece (n,) and ds/dt (n,) at times `t` in phases `phase`."""
    phase_time, phase_duration, phase_piece, phase_s, phase_speed, phase_acceleration, phase_jerk = phases
    length = pieces.length
    n = len(t)
    position = np.empty((n, 6))
    velocity = np.empty((n, 6))
    place = np.empty(n)
    rate = np.empty(n)
    spare = np.empty((2, 6))
    for j in range(n):
        p = phase[j]
        i = phase_piece[p]
        tau = min(max(t[j] - phase_time[p], 0.0), phase_duration[p])
        v, a, change = phase_speed[p], phase_acceleration[p], phase_jerk[p]
        s = phase_s[p] + tau * (v + 0.5 * a * tau)
        if change != 0.0:
            s += change * tau * tau * tau / 6.0
        s = min(max(s, 0.0), length[i])
        v = max(v + a * tau + 0.5 * change * tau * tau, 0.0)
        piece_point(i, s, pieces, curves, position[j], velocity[j], spare)
        for k in range(6):
            velocity[j, k] *= v
        place[j] = s
        rate[j] = v
    return position, velocity, place, rate

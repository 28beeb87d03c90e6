"""Points of pieces; arrays in and out. Column meanings: `pieces.Pieces` and `curves.Curves`."""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.motion.curve_kernels import curve_point

OVERLAP = 1


@kernel
def piece_point(
    i: int,
    s: float,
    kind: Column,
    curve: Column,
    second: Column,
    begin: Column,
    length: Column,
    ratio: Column,
    axis_limits: Column,
    c_kind: Column,
    c_start: Column,
    c_end: Column,
    c_center: Column,
    c_radial: Column,
    c_sideways: Column,
    c_lift: Column,
    c_sweep: Column,
    c_growth: Column,
    c_length: Column,
    position: Column,
    tangent: Column,
    spare: Column,
) -> None:
    """Write position (6,) and derivative by s (6,) of piece `i` at `s`; `spare` (2, 6) is overwritten."""
    a = curve[i]
    if kind[i] != OVERLAP:
        curve_point(
            a, begin[i] + s, c_kind, c_start, c_end, c_center, c_radial, c_sideways, c_lift, c_sweep, c_growth,
            c_length, axis_limits, position, tangent,
        )  # fmt: skip
        return
    b = second[i]
    u = s / length[i]
    # tau = u T; first curve: v1 (tau - tau²/2T), second: ratio v1 tau²/2T; length = v1 T
    s1 = begin[i] + length[i] * u * (1.0 - 0.5 * u)
    s2 = 0.5 * ratio[i] * length[i] * u * u
    curve_point(
        a, s1, c_kind, c_start, c_end, c_center, c_radial, c_sideways, c_lift, c_sweep, c_growth,
        c_length, axis_limits, position, tangent,
    )  # fmt: skip
    curve_point(
        b, s2, c_kind, c_start, c_end, c_center, c_radial, c_sideways, c_lift, c_sweep, c_growth,
        c_length, axis_limits, spare[0], spare[1],
    )  # fmt: skip
    for k in range(6):
        position[k] += spare[0, k] - c_start[b, k]
        tangent[k] = tangent[k] * (1.0 - u) + spare[1, k] * ratio[i] * u


@kernel
def points(
    piece: Column,
    s: Column,
    kind: Column,
    curve: Column,
    second: Column,
    begin: Column,
    length: Column,
    ratio: Column,
    axis_limits: Column,
    c_kind: Column,
    c_start: Column,
    c_end: Column,
    c_center: Column,
    c_radial: Column,
    c_sideways: Column,
    c_lift: Column,
    c_sweep: Column,
    c_growth: Column,
    c_length: Column,
) -> tuple[Column, Column]:
    """Positions (k, 6) and derivatives by s (k, 6) at `s` (k,) on pieces `piece` (k,)."""
    n = len(s)
    position = np.empty((n, 6))
    tangent = np.empty((n, 6))
    spare = np.empty((2, 6))
    for j in range(n):
        piece_point(
            piece[j], s[j], kind, curve, second, begin, length, ratio, axis_limits,
            c_kind, c_start, c_end, c_center, c_radial, c_sideways, c_lift, c_sweep, c_growth, c_length,
            position[j], tangent[j], spare,
        )  # fmt: skip
    return position, tangent

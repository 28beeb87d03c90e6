"""Sampling a trajectory; arrays in and out."""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.motion.piece_kernels import piece_point


@kernel
def sample(
    t: Column,
    phase: Column,
    phase_time: Column,
    phase_duration: Column,
    phase_piece: Column,
    phase_s: Column,
    phase_speed: Column,
    phase_acceleration: Column,
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
) -> tuple[Column, Column, Column, Column]:
    """Position (n, 6), velocity (n, 6), place in the piece (n,) and ds/dt (n,) at times `t` in phases `phase`."""
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
        v, a = phase_speed[p], phase_acceleration[p]
        s = min(max(phase_s[p] + tau * (v + 0.5 * a * tau), 0.0), length[i])
        v = max(v + a * tau, 0.0)
        piece_point(
            i, s, kind, curve, second, begin, length, ratio, axis_limits,
            c_kind, c_start, c_end, c_center, c_radial, c_sideways, c_lift, c_sweep, c_growth, c_length,
            position[j], velocity[j], spare,
        )  # fmt: skip
        for k in range(6):
            velocity[j, k] *= v
        place[j] = s
        rate[j] = v
    return position, velocity, place, rate

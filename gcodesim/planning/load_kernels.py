"""Motions of joints along segments of a path, and whether motors surely have what they need; arrays in and out."""

from __future__ import annotations

from typing import NamedTuple

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.planning.arm_kernels import SegmentRates


class Needs(NamedTuple):
    """What motions ask of motors (j,) at most, and what these may give.

    `weight` [N·m] at rest, `inertia` (j, j) per rad/s² of each joint, `swing` per rad²/s² of the square of all speeds
    together (see `effort_bounds`); `coulomb`, `viscous` and `rotor` of the motors themselves; `limit` [N·m, N].
    """

    weight: Column
    inertia: Column
    swing: Column
    coulomb: Column
    viscous: Column
    rotor: Column
    limit: Column


@kernel(lean=True)
def motions_at(
    rates: SegmentRates,
    length: Column,
    speed: Column,
    acceleration: Column,
    at_end: bool,
    qd: Column,
    along: Column,
    across: Column,
) -> None:
    """Joint speeds `qd` (k, j), accelerations `along` the way and `across` it, where segments of `length` (k,) end.

    Or where they begin, unless `at_end`. `speed` and `acceleration` (k,) are those of the way; q is the cubic of
    `joint_caps`.
    """
    start, end, mean = rates
    for k in range(len(length)):
        v, a, h = speed[k], acceleration[k], length[k]
        for j in range(start.shape[1]):
            r0, r1 = start[k, j], end[k, j]
            step, twice = r1 - r0, 6.0 * mean[k, j] - 3.0 * (r0 + r1)
            rate = r1 if at_end else r0
            bend = (step - twice) / h if at_end else (step + twice) / h
            qd[k, j], along[k, j], across[k, j] = rate * v, rate * a, bend * v * v


@kernel(lean=True)
def ample_motions(qd: Column, qdd: Column, needs: Needs, ample: Column) -> None:
    """Where (n,) motors surely have what motions of no greater qd and qdd (n, j) need: `ample` is 1 there, else 0."""
    count = qd.shape[1]
    for k in range(qd.shape[0]):
        total = 0.0
        for j in range(count):
            total += abs(qd[k, j])
        square = total * total
        enough = True
        for i in range(count):
            needed = needs.weight[i] + square * needs.swing[i]
            for j in range(count):
                needed += needs.inertia[i, j] * abs(qdd[k, j])
            needed += needs.coulomb[i] + needs.viscous[i] * abs(qd[k, i]) + needs.rotor[i] * abs(qdd[k, i])
            enough = enough and needed <= needs.limit[i]
        ample[k] = 1 if enough else 0

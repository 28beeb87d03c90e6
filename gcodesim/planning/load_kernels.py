"""Motions of joints along segments of a path, and whether motors surely have what they need; arrays in and out."""

from __future__ import annotations

from typing import NamedTuple

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.planning.arm_kernels import SegmentRates


class Needs(NamedTuple):
    """What motions ask of motors (j,) at most besides weight, and what these may give.

    `inertia` (j, j) per rad/s² of each joint, `swing` per rad²/s² of the square of all speeds
    together (see `effort_bounds`); `coulomb`, `viscous` and `rotor` of the motors themselves; `limit` [N·m, N].
    """

    inertia: Column
    swing: Column
    coulomb: Column
    viscous: Column
    rotor: Column
    limit: Column


@kernel(inlined=True)
def motion_at(
    r0: float, r1: float, mean: float, h: float, v: float, a: float, at_end: bool
) -> tuple[float, float, float]:
    """Speed of a joint at speed `v` and acceleration `a` of the way, its accelerations along that and across.

    At one end of the cubic of `joint_caps` over a length h with rates r0 and r1.
    """
    step, twice = r1 - r0, 6.0 * mean - 3.0 * (r0 + r1)
    rate = r1 if at_end else r0
    bend = (step - twice) / h if at_end else (step + twice) / h
    return rate * v, rate * a, bend * v * v


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

    Or where they begin, unless `at_end`. `speed` and `acceleration` (k,) are those of the way.
    """
    start, end, mean = rates
    for k in range(len(length)):
        for j in range(start.shape[1]):
            qd[k, j], along[k, j], across[k, j] = motion_at(
                start[k, j], end[k, j], mean[k, j], length[k], speed[k], acceleration[k], at_end
            )


@kernel(lean=True)
def are_ample(weight: Column, qd: Column, qdd: Column, needs: Needs) -> bool:
    """Whether motors surely have what motions of no greater qd and qdd (j,) need, and `weight` (j,) at rest."""
    count = len(qd)
    total = 0.0
    for j in range(count):
        total += abs(qd[j])
    square = total * total
    enough = True
    for i in range(count):
        needed = abs(weight[i]) + square * needs.swing[i]
        for j in range(count):
            needed += needs.inertia[i, j] * abs(qdd[j])
        needed += needs.coulomb[i] + needs.viscous[i] * abs(qd[i]) + needs.rotor[i] * abs(qdd[i])
        enough = enough and needed <= needs.limit[i]
    return enough


@kernel(lean=True)
def ample_motions(weight: Column, qd: Column, qdd: Column, needs: Needs, ample: Column) -> None:
    """Where (n,) motors are ample for motions qd, qdd (n, j) with `weight` (n, j) [N·m]: `ample` is 1 there, else 0."""
    for k in range(qd.shape[0]):
        ample[k] = 1 if are_ample(weight[k], qd[k], qdd[k], needs) else 0


@kernel(lean=True)
def ample_segments(
    rates: SegmentRates,
    length: Column,
    speed: Column,
    acceleration: Column,
    at_end: bool,
    weight: Column,
    needs: Needs,
    room: Column,
    ample: Column,
) -> None:
    """The same of what `motions_at` says of segments (k,), forwards and backwards; `weight` (j,) is theirs at most.

    `room` (2, j) is overwritten.
    """
    start, end, mean = rates
    for k in range(len(length)):
        for j in range(start.shape[1]):
            qd, along, across = motion_at(
                start[k, j], end[k, j], mean[k, j], length[k], speed[k], acceleration[k], at_end
            )
            room[0, j], room[1, j] = qd, abs(along) + abs(across)
        ample[k] = 1 if are_ample(weight, room[0], room[1], needs) else 0

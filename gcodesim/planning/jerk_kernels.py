"""Caps of a path under limits of the jerk of joints; arrays in and out.

With q(s) and the speed v, acceleration a and jerk j of s, the jerk of a joint is q' j + 3 q'' v a + q''' v³. Where the
path has a border, q'' steps, and with it acceleration by v² times the step; q' may step too, and with it speed. Over a
control cycle T that is a jerk of no more than step v² / T and kink v / T²: third differences of joints a cycle apart
are weighted means of jerk over three cycles, and no weight is above 1 / T, no slope of the weights above 1 / T².
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from gcodesim.arithmetic.root_kernels import cube_root
from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.planning.arm_kernels import JointCaps, SegmentRates, greatest_rate

NO_CAP: Final = 1e30
NOTHING: Final = 1e-9  # of a step or a kink
THIRD: Final = 0.25  # of a limit that q''' v³ may take, and 3 q'' v a as well
AT_BORDER: Final = 0.75  # of a limit that steps at borders and q''' v³ there may take; the law has the rest
CALM: Final = 0.75  # of that rest, for the jerk of the law; what is left is for its acceleration
HALVINGS: Final = 40


class Bends(NamedTuple):
    """How q bends along segments (k, j): the greatest |q''| and |q'''| within each, and steps at its end.

    `step` is that of q'' and `kink` that of q', 0 where the path goes on smoothly or ends.
    """

    second: Column
    third: Column
    step: Column
    kink: Column


class SoftColumns(NamedTuple):
    """Columns (k,): `jerk` of segments; `calm` and `push`, jerk and acceleration while their ends are passed."""

    jerk: Column
    calm: Column
    push: Column


@kernel
def bends_of(rates: SegmentRates, length: Column, follows: Column, goes_on: Column) -> Bends:
    """How joints bend along segments of `length` (k,).

    `follows` and `goes_on` (k,): whether the next segment does so at all, and smoothly. Where it does, a difference of
    q'' is a matter of where it was looked at, and counts for q'''.
    """
    start, end, mean = rates
    n, count = len(length), start.shape[1]
    second, third, steps, kinks = np.zeros((n, count)), np.zeros((n, count)), np.zeros((n, count)), np.zeros((n, count))
    for j in range(count):
        before = 0.0
        for k in range(n):
            r0, r1 = start[k, j], end[k, j]
            turn, bow = (r1 - r0) / length[k], (6.0 * mean[k, j] - 3.0 * (r0 + r1)) / length[k]
            second[k, j] = abs(turn) + abs(bow)
            third[k, j] = max(third[k, j], 2.0 * abs(bow) / length[k])
            if k > 0 and follows[k - 1]:
                step = abs(turn + bow - before)
                if goes_on[k - 1]:
                    spread = 2.0 * step / (length[k - 1] + length[k])
                    third[k - 1, j] = max(third[k - 1, j], spread)
                    third[k, j] = max(third[k, j], spread)
                else:
                    steps[k - 1, j] = step
                    kinks[k - 1, j] = abs(r0 - end[k - 1, j])
            before = turn - bow
    return Bends(second, third, steps, kinks)


@kernel
def jerk_caps(rates: SegmentRates, bends: Bends, limit: Column, caps: JointCaps, jerk: Column) -> None:
    """Caps of `jerk` (k,) of each segment under the `limit` (j,) of joints; `caps` are lowered for it."""
    start, end, mean = rates
    second, third = bends.second, bends.third
    for k in range(len(jerk)):
        v = caps.speed[k]
        for j in range(len(limit)):
            if third[k, j] > NOTHING:
                v = min(v, cube_root(THIRD * limit[j] / third[k, j]))
        a = caps.acceleration[k]
        for j in range(len(limit)):
            if second[k, j] * v > 1e-12:
                a = min(a, THIRD * limit[j] / (3.0 * second[k, j] * v))
        most = 1e12
        for j in range(len(limit)):
            rate = greatest_rate(start[k, j], end[k, j], mean[k, j])
            if rate > 1e-12:
                left = limit[j] - 3.0 * second[k, j] * v * a - third[k, j] * v * v * v
                most = min(most, left / rate)
        caps.speed[k], caps.acceleration[k], jerk[k] = v, a, most


@kernel
def jerk_at(k: int, j: int, v: float, bends: Bends, length: Column, follows: Column, cycle: float) -> float:
    """What joint `j` jerks where the end of segment `k` is passed at speed `v`.

    Borders passed in the same cycle count together, and kinks passed within two.
    """
    step, kink = bends.step[k, j], bends.kink[k, j]
    i, way = k, length[k]
    while i > 0 and follows[i - 1] and way < 2.0 * v * cycle:
        i -= 1
        kink += bends.kink[i, j]
        if way < v * cycle:
            step += bends.step[i, j]
        way += length[i]
    i, way = k, 0.0
    while i + 1 < len(length) and follows[i]:
        i += 1
        way += length[i]
        if way >= 2.0 * v * cycle:
            break
        kink += bends.kink[i, j]
        if way < v * cycle:
            step += bends.step[i, j]
    total: float = step * v * v / cycle + kink * v / (cycle * cycle)
    return total


@kernel
def border_caps(
    rates: SegmentRates,
    bends: Bends,
    length: Column,
    follows: Column,
    limit: Column,
    cycle: float,
    speed: Column,
    junction: Column,
    soft: SoftColumns,
) -> None:
    """Lower `junction` (k,) so that the jerk of steps at the ends of segments stays within its share of the `limit`.

    What is left of the limit there comes back as `calm` and `push` of `soft`; `speed` (k,) is what segments allow.
    """
    start, end, second, third = rates.start, rates.end, bends.second, bends.third
    for k in range(len(length)):
        soft.calm[k] = soft.push[k] = NO_CAP
        junction[k] = min(junction[k], speed[k])
        if k + 1 == len(length) or not follows[k]:
            continue
        v = min(junction[k], speed[k + 1])
        sharp = False
        for j in range(len(limit)):
            if max(bends.step[k, j], bends.kink[k, j]) <= NOTHING:
                continue
            sharp = True
            most = AT_BORDER * limit[j] - max(third[k, j], third[k + 1, j]) * v * v * v
            if jerk_at(k, j, v, bends, length, follows, cycle) > most:
                low, high = 0.0, v
                for _ in range(HALVINGS):
                    v = 0.5 * (low + high)
                    if jerk_at(k, j, v, bends, length, follows, cycle) > most:
                        high = v
                    else:
                        low = v
                v = low
        if not sharp:
            continue
        junction[k] = v
        for j in range(len(limit)):
            taken = jerk_at(k, j, v, bends, length, follows, cycle) + max(third[k, j], third[k + 1, j]) * v * v * v
            left = max(limit[j] - taken, 0.0)
            rate = max(abs(end[k, j]), abs(start[k + 1, j]))
            bent = bends.kink[k, j] / cycle + 3.0 * max(second[k, j], second[k + 1, j]) * v
            if rate > 1e-12:
                soft.calm[k] = min(soft.calm[k], CALM * left / rate)
            if bent > 1e-12:
                soft.push[k] = min(soft.push[k], (1.0 - CALM) * left / bent)

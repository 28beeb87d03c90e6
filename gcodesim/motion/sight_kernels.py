"""How fast a control may be where it knows no more than the next pieces; arrays in and out.

LinuxCNC goes back over its queue each time that a block comes in, `ARC_BLEND_OPTIMIZATION_DEPTH` pieces and one more
from the newest one (`tpRunOptimization` in tp.c, 2.9). The newest piece may still be cut short by a corner, so half of
it counts. Corner arcs come in together with the block behind them, and are pieces like it; merged chords are one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.motion.ramp_kernels import peak_speed, ramp_time


class SeenCaps(NamedTuple):
    """Columns (k,) of the caps of segments: where jerk is not bounded, `jerk` is 0."""

    length: Column
    speed: Column
    acceleration: Column
    jerk: Column
    junction: Column


class Queue(NamedTuple):
    """Columns (n,) of the pieces as they come in: `last`, the last segment of each.

    `half` [m] is half of what is there of it while it is the newest. A `joint` comes in together with the piece behind
    it; those that are `counted` fill the queue. At the end of a `rest` the control plans one, so that it need not know
    more.
    """

    last: Column
    half: Column
    joint: Column
    counted: Column
    rest: Column


@kernel
def stops_within(way: float, top: float, push: float, jerk: float) -> float:
    """The greatest speed, up to `top`, that comes to rest over `way` by an S-curve."""
    if 0.5 * top * ramp_time(top, push, jerk) <= way:
        return top
    return peak_speed(2.0 * way, top, push, jerk)


@kernel
def stoppable(caps: SeenCaps, first: int, last: int, half: float, top: float) -> float:
    """The greatest speed, up to `top`, that comes to rest over the segments from `first` up to `last`, and `half`
    within that.

    Where jerk is bounded it comes to rest by an S-curve over some of them, under the least acceleration and the least
    jerk that these have.
    """
    square, way, best = 0.0, 0.0, 0.0
    push, jerk = np.inf, np.inf
    for k in range(first, last + 1):
        length = half if k == last else caps.length[k]
        square += 2.0 * caps.acceleration[k] * length
        if caps.jerk[k] == 0.0:
            best = math.sqrt(square)
        else:
            way += length
            push, jerk = min(push, caps.acceleration[k]), min(jerk, caps.jerk[k])
            best = max(best, stops_within(way, top, push, jerk))
        if best >= top:
            return top
    return best


@kernel(short=True)
def within_sight(caps: SeenCaps, queue: Queue, depth: int) -> Column:
    """The junctions (k,) of `caps`, lowered at the ends of pieces to what comes to rest over the pieces within sight.

    `depth` > 0 pieces are seen as a whole, and half of one more.
    """
    last, half, joint, counted, rest = queue
    junction = caps.junction.copy()
    n = len(last)
    halt = newest = n - 1  # the next piece from j on that ends at rest, and the last one that is seen from there
    known = 0  # counted pieces behind j and ahead of the newest
    for j in range(n - 1, -1, -1):
        if j + 1 < newest and counted[j + 1]:
            known += 1
        while newest > j + 1 and (known > depth or joint[newest]):
            newest -= 1
            if counted[newest]:
                known -= 1
        if rest[j]:
            halt = j
        if newest >= halt:
            continue
        end = last[j]
        top = min(min(junction[end], caps.speed[end]), caps.speed[end + 1])
        most = stoppable(caps, end + 1, last[newest - 1] + 1, half[newest], top)
        if most < top:
            junction[end] = most
    return junction

"""Ways through a ladder of joint vectors, compiled: which rungs lie close, and dynamic programming over them.

A rung holds the joint vectors of one pose (branches and spins), each joint within the first turn above its lower
limit. A `turn` is a vector of whole turns on top of that, numbered; it goes on from rung to rung with the joints.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices

TURN = 2.0 * math.pi
SLACK = 1e-9  # [rad], [m] beyond a limit that still count as on it
LINEAR, LIMITED, ENDLESS = 0, 1, 2  # joints: prismatic, revolute with limits, revolute without
NOBODY = -1


class Ladder(NamedTuple):
    """n rungs with N joint vectors together: those of rung i are rows first[i] to first[i + 1] of q (N, j).

    `kind` (j,) of each joint, its limits `lower` and `upper` (j,), how many `turns` (j,) it may have, and the
    whole turns `whole` (t, j) of each numbered turn, the last joint counting fastest.
    """

    first: Indices
    q: Array
    lower: Array
    upper: Array
    kind: Indices
    turns: Indices
    whole: Indices


class Rails(NamedTuple):
    """Pairs of joint vectors on neighbouring rungs that lie close: those that end at v are first[v] to first[v + 1].

    `source` is where one begins, `way` what it costs: how far all joints go together, or the sum of squares. `shift` is
    0 where turns stay as they are, else 1 plus a number whose digits to base 3 are the changes of whole turns plus one.
    """

    first: Indices
    source: Indices
    shift: Indices
    way: Array


@kernel
def step_of(start: float, end: float, kind: int) -> float:
    """The change of a joint, for a revolute one the shorter way round."""
    step = end - start
    if kind != LINEAR:
        step -= TURN * math.floor(0.5 + step / TURN)
    return step


@kernel
def longer(column: Array | Indices) -> Array | Indices:
    """The same column with room for twice as much."""
    out = np.empty(2 * column.shape[0], dtype=column.dtype)
    for i in range(column.shape[0]):
        out[i] = column[i]
    return out


@kernel
def sort_by_angle(ladder: Ladder, rung: int, parts: int, begin: Indices, order: Indices) -> None:
    """Sort the vectors of a rung into `parts` sectors of the last joint: `begin` (parts + 1,), `order` (m,)."""
    a, b, last = ladder.first[rung], ladder.first[rung + 1], ladder.q.shape[1] - 1
    for p in range(parts + 1):
        begin[p] = 0
    for v in range(a, b):
        begin[sector(ladder.q[v, last], parts) + 1] += 1
    for p in range(parts):
        begin[p + 1] += begin[p]
    for v in range(a, b):
        p = sector(ladder.q[v, last], parts)
        order[begin[p]] = v
        begin[p] += 1
    for p in range(parts, 0, -1):
        begin[p] = begin[p - 1]
    begin[0] = 0


@kernel
def sector(angle: float, parts: int) -> int:
    """Which of `parts` equal sectors an angle lies in."""
    share = angle / TURN
    return min(int((share - math.floor(share)) * parts), parts - 1)


@kernel
def close_by(ladder: Ladder, u: int, v: int, bound: Array, even: bool) -> tuple[float, int]:
    """What the pair from u to v costs and the code of its turns; −1 where one joint goes beyond `bound` (j,)."""
    q, kind = ladder.q, ladder.kind
    count = q.shape[1]
    leading = 0  # where external axes stand tells most pairs apart
    while leading < count and kind[leading] == LINEAR:
        if abs(q[v, leading] - q[u, leading]) > bound[leading]:
            return -1.0, 0
        leading += 1
    for j in range(count - 1, leading - 1, -1):
        if abs(step_of(q[u, j], q[v, j], kind[j])) > bound[j]:
            return -1.0, 0
    way, code, turned = 0.0, 0, False
    for j in range(count):
        step = step_of(q[u, j], q[v, j], kind[j])
        way += step * step if even else abs(step)
        change = 0
        if kind[j] == LIMITED:
            change = math.floor(0.5 + (q[v, j] - q[u, j] - step) / TURN)
        turned = turned or change != 0
        code = 3 * code + change + 1
    return way, code + 1 if turned else 0


@kernel
def link(ladder: Ladder, bound: Array, even: bool) -> Rails:
    """All pairs on neighbouring rungs of which no joint goes farther than `bound` (j,), below half a turn.

    They cost the sum of squares if the joints are to move `even`ly, else how far they go.
    """
    rungs, count = ladder.first.shape[0] - 1, ladder.q.shape[1]
    parts = 1
    if ladder.kind[count - 1] != LINEAR:
        parts = max(int(TURN / bound[count - 1]), 1)
    if parts < 3:
        parts = 1
    most = 0
    for i in range(rungs):
        most = max(most, ladder.first[i + 1] - ladder.first[i])
    begin, order = np.empty(parts + 1, dtype=np.int64), np.empty(most, dtype=np.int64)
    first = np.zeros(ladder.q.shape[0] + 1, dtype=np.int64)
    room = max(8 * ladder.q.shape[0], 16)
    source, shift, way = np.empty(room, dtype=np.int64), np.empty(room, dtype=np.int64), np.empty(room)
    found = 0
    for i in range(rungs):
        if i > 0:
            sort_by_angle(ladder, i - 1, parts, begin, order)
        for v in range(ladder.first[i], ladder.first[i + 1]):
            here = sector(ladder.q[v, count - 1], parts)
            for side in range(3 if i > 0 else 0):
                if parts == 1 and side > 0:
                    break
                p = (here + side - 1 + parts) % parts
                for k in range(begin[p], begin[p + 1]):
                    far, code = close_by(ladder, order[k], v, bound, even)
                    if far < 0.0:
                        continue
                    if found == source.shape[0]:
                        source, shift, way = longer(source), longer(shift), longer(way)
                    source[found], shift[found], way[found] = order[k], code, far
                    found += 1
            first[v + 1] = found
    return Rails(first, source, shift, way)


@kernel
def turn_before(ladder: Ladder, turn: int, shift: int) -> int:
    """The turn at the start of a pair whose end has `turn`; −1 where there is none."""
    if shift == 0:
        return turn
    code, stride, before = shift - 1, 1, 0
    for j in range(ladder.turns.shape[0] - 1, -1, -1):
        whole = ladder.whole[turn, j] + code % 3 - 1
        if whole < 0 or whole >= ladder.turns[j]:
            return NOBODY
        before += whole * stride
        stride *= ladder.turns[j]
        code //= 3
    return before


@kernel
def margin_of(ladder: Ladder, v: int, turn: int) -> float:
    """The least distance of any joint of vector v from its limits, with `turn`; negative outside."""
    least = np.inf
    for j in range(ladder.turns.shape[0]):
        if ladder.kind[j] != ENDLESS:
            value = ladder.q[v, j] + TURN * ladder.whole[turn, j]
            least = min(least, value - ladder.lower[j], ladder.upper[j] - value)
    return least


@kernel
def most_of(ladder: Ladder) -> int:
    """The most vectors of one rung."""
    most = 0
    for i in range(ladder.first.shape[0] - 1):
        most = max(most, ladder.first[i + 1] - ladder.first[i])
    return most


@kernel
def earliest(ladder: Ladder, rails: Rails) -> tuple[int, int, int]:
    """How many rungs can be run from the first one on, and the first and last of the longest run (0, −1: none)."""
    rungs, turns = ladder.first.shape[0] - 1, ladder.whole.shape[0]
    most = most_of(ladder)
    before, now = np.empty((most, turns), dtype=np.int64), np.empty((most, turns), dtype=np.int64)
    prefix, start, end = 0, 0, -1
    for i in range(rungs):
        a = ladder.first[i]
        above = ladder.first[max(i - 1, 0)]
        oldest = rungs
        for v in range(a, ladder.first[i + 1]):
            row = now[v - a]
            for t in range(turns):
                row[t] = i if margin_of(ladder, v, t) >= -SLACK else NOBODY
            for e in range(rails.first[v], rails.first[v + 1]):
                old, shift = before[rails.source[e] - above], rails.shift[e]
                for t in range(turns):
                    s = turn_before(ladder, t, shift)
                    if row[t] >= 0 and s >= 0 and old[s] >= 0 and old[s] < row[t]:
                        row[t] = old[s]
            for t in range(turns):
                if row[t] >= 0:
                    oldest = min(oldest, row[t])
        if oldest == 0:
            prefix = i + 1
        if oldest < rungs and i - oldest > end - start:
            start, end = oldest, i
        before, now = now, before
    return prefix, start, end


@kernel
def widest(ladder: Ladder, rails: Rails) -> float:
    """The most margin that the worst vector of a way through all rungs can have; −1 where there is no way."""
    rungs, turns = ladder.first.shape[0] - 1, ladder.whole.shape[0]
    most = most_of(ladder)
    before, now = np.empty((most, turns)), np.empty((most, turns))
    cap = np.empty(turns)
    best = -1.0
    for i in range(rungs):
        a = ladder.first[i]
        above = ladder.first[max(i - 1, 0)]
        best = -1.0
        for v in range(a, ladder.first[i + 1]):
            row = now[v - a]
            lower = 0  # turns that have less than their own margin allows
            for t in range(turns):
                margin = margin_of(ladder, v, t)
                cap[t] = max(margin, 0.0) if margin >= -SLACK else -1.0
                row[t] = cap[t] if i == 0 else -1.0
                if row[t] < cap[t]:
                    lower += 1
            for e in range(rails.first[v], rails.first[v + 1]):
                if lower == 0:
                    break
                old, shift = before[rails.source[e] - above], rails.shift[e]
                for t in range(turns):
                    if row[t] >= cap[t]:
                        continue
                    s = turn_before(ladder, t, shift)
                    if s >= 0 and old[s] > row[t]:
                        row[t] = min(old[s], cap[t])
                        if row[t] >= cap[t]:
                            lower -= 1
            for t in range(turns):
                best = max(best, row[t])
        before, now = now, before
    return best


@kernel
def shortest(
    ladder: Ladder, rails: Rails, margin: float, start: Array, parent: NDArray[np.int16]
) -> tuple[float, int, int]:
    """The least cost of a way through all rungs with at least `margin`: cost, last vector and its turn.

    `start` (m, t) is what it costs to begin with a vector and turn of the first rung. `parent` (N, t) tells for each
    vector and turn which of its rails the way came by. The cost is infinite where there is no way.
    """
    rungs, turns = ladder.first.shape[0] - 1, ladder.whole.shape[0]
    most = most_of(ladder)
    before, now = np.empty((most, turns)), np.empty((most, turns))
    best, vector, turn = np.inf, NOBODY, NOBODY
    for i in range(rungs):
        a = ladder.first[i]
        above = ladder.first[max(i - 1, 0)]
        best = np.inf
        for v in range(a, ladder.first[i + 1]):
            row, by = now[v - a], parent[v]
            for t in range(turns):
                row[t] = start[v, t] if i == 0 else np.inf
                by[t] = NOBODY
            for e in range(rails.first[v], rails.first[v + 1]):
                old, shift, way = before[rails.source[e] - above], rails.shift[e], rails.way[e]
                for t in range(turns):
                    s = turn_before(ladder, t, shift)
                    if s >= 0 and old[s] + way < row[t]:
                        row[t] = old[s] + way
                        by[t] = e - rails.first[v]
            for t in range(turns):
                if margin_of(ladder, v, t) < margin - SLACK:
                    row[t] = np.inf
                if row[t] < best:
                    best, vector, turn = row[t], v, t
        before, now = now, before
    return best, vector, turn


@kernel
def trace(ladder: Ladder, rails: Rails, parent: NDArray[np.int16], vector: int, turn: int, out: Indices) -> None:
    """The way that ends at `vector` with `turn`: vector and turn of each rung into `out` (n, 2)."""
    for i in range(out.shape[0] - 1, -1, -1):
        out[i, 0], out[i, 1] = vector, turn
        if i > 0:
            e = rails.first[vector] + parent[vector, turn]
            turn = turn_before(ladder, turn, rails.shift[e])
            vector = rails.source[e]

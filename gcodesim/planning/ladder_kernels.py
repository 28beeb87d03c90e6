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
MORE = 1.1  # times as many pairs as the rungs so far let expect


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


@kernel(lean=True)
def step_of(start: float, end: float, kind: int) -> float:
    """The change of a joint, for a revolute one the shorter way round."""
    step = end - start
    if kind != LINEAR:
        step -= TURN * math.floor(0.5 + step / TURN)
    return step


@kernel
def longer(column: Array | Indices, rows: int) -> Array | Indices:
    """The same column with room for so many rows, more than it has."""
    out = np.empty(rows, dtype=column.dtype)
    for i in range(column.shape[0]):
        out[i] = column[i]
    return out  # type: ignore[return-value]


@kernel(lean=True)
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


@kernel(lean=True)
def sector(angle: float, parts: int) -> int:
    """Which of `parts` equal sectors an angle lies in."""
    share = angle / TURN
    return min(int((share - math.floor(share)) * parts), parts - 1)


@kernel(lean=True)
def close_by(ladder: Ladder, u: int, v: int, bound: Array, even: bool) -> tuple[float, int]:
    """What the pair from u to v costs and the code of its turns; −1 where one joint goes beyond `bound` (j,)."""
    q, kind = ladder.q, ladder.kind
    count = q.shape[1]
    for j in range(count - 1, -1, -1):
        far = abs(q[v, j] - q[u, j])
        if kind[j] != LINEAR:
            far = min(far, abs(TURN - far))  # both lie in one turn
        if far > bound[j]:
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
def leading_of(ladder: Ladder) -> int:
    """How many joints go before the first one that turns: where external axes stand tells most pairs apart."""
    leading = 0
    while leading < ladder.kind.shape[0] and ladder.kind[leading] == LINEAR:
        leading += 1
    return leading


@kernel(lean=True)
def mark_blocks(ladder: Ladder, leading: int, begin: Indices, order: Indices, end: Indices) -> None:
    """Where the block of each place of an `order` ends in which the `leading` joints stand alike, in each sector."""
    for p in range(begin.shape[0] - 1):
        for k in range(begin[p + 1] - 1, begin[p] - 1, -1):
            goes_on = k + 1 < begin[p + 1]
            for j in range(leading):
                goes_on = goes_on and ladder.q[order[k], j] == ladder.q[order[k + 1], j]
            end[k] = end[k + 1] if goes_on else k + 1


@kernel(lean=True)
def stand_apart(ladder: Ladder, u: int, v: int, leading: int, bound: Array) -> bool:
    """Whether one of the `leading` joints goes beyond `bound` (j,) from u to v."""
    apart = False
    for j in range(leading):
        apart = apart or abs(ladder.q[v, j] - ladder.q[u, j]) > bound[j]
    return apart


@kernel(lean=True)
def pair_up(
    ladder: Ladder,
    v: int,
    span: tuple[int, int],
    order: Indices,
    end: Indices,
    leading: int,
    bound: Array,
    even: bool,
    rails: Rails,
    found: int,
) -> int:
    """Put the pairs that end at v into `rails`, from row `found` on; how many rows there are then.

    They begin at places of `order` from span[0] to the one before span[1]; `end`: see `mark_blocks`.
    """
    k = span[0]
    while k < span[1]:
        u = order[k]
        if stand_apart(ladder, u, v, leading, bound):
            k = end[k]
            continue
        k += 1
        far, code = close_by(ladder, u, v, bound, even)
        if far >= 0.0:
            rails.source[found], rails.shift[found], rails.way[found] = u, code, far
            found += 1
    return found


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
    leading, end = leading_of(ladder), np.empty(most, dtype=np.int64)
    first = np.zeros(ladder.q.shape[0] + 1, dtype=np.int64)
    room = max(8 * ladder.q.shape[0], 16)
    source, shift, way = np.empty(room, dtype=np.int64), np.empty(room, dtype=np.int64), np.empty(room)
    found = 0
    for i in range(rungs):
        if i > 0:
            sort_by_angle(ladder, i - 1, parts, begin, order)
            mark_blocks(ladder, leading, begin, order, end)
        for v in range(ladder.first[i], ladder.first[i + 1]):
            here = sector(ladder.q[v, count - 1], parts)
            for side in range(3 if i > 0 else 0):
                if parts == 1 and side > 0:
                    break
                p = (here + side - 1 + parts) % parts
                needed = found + begin[p + 1] - begin[p]
                if needed > source.shape[0]:
                    # room for all rungs if they have as many pairs: what is not written to takes no memory
                    rows = max(needed, source.shape[0] + source.shape[0] // 4, int(MORE * found * rungs / i))
                    source, shift, way = longer(source, rows), longer(shift, rows), longer(way, rows)
                rails, span = Rails(first, source, shift, way), (begin[p], begin[p + 1])
                found = pair_up(ladder, v, span, order, end, leading, bound, even, rails, found)
            first[v + 1] = found
    return Rails(first, source, shift, way)


@kernel(lean=True)
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
def shifted_turns(ladder: Ladder, rails: Rails) -> tuple[Indices, Indices]:
    """`turn_before` of each turn for every shift that rails have, (c, t), and the row of each shift, -1 for others."""
    codes, turns = 1, ladder.whole.shape[0]
    for _ in range(ladder.turns.shape[0]):
        codes *= 3
    row, count = np.full(codes + 1, -1, dtype=np.int64), 0
    for e in range(rails.first[rails.first.shape[0] - 1]):
        if row[rails.shift[e]] < 0:
            row[rails.shift[e]] = count
            count += 1
    table = np.empty((count, turns), dtype=np.int64)
    for shift in range(codes + 1):
        if row[shift] >= 0:
            for t in range(turns):
                table[row[shift], t] = turn_before(ladder, t, shift)
    return table, row


@kernel(lean=True)
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
    moved, of_shift = shifted_turns(ladder, rails)
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
                old, come = before[rails.source[e] - above], moved[of_shift[rails.shift[e]]]
                for t in range(turns):
                    if row[t] >= cap[t]:
                        continue
                    s = come[t]
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
    # the least of each row before, and of the vector at hand what each turn costs at most
    least_before, least_now = np.empty(most), np.empty(most)
    moved, of_shift = shifted_turns(ladder, rails)
    keeps = np.empty(turns, dtype=np.int64)
    best, vector, turn = np.inf, NOBODY, NOBODY
    for i in range(rungs):
        a = ladder.first[i]
        above = ladder.first[max(i - 1, 0)]
        best = np.inf
        for v in range(a, ladder.first[i + 1]):
            row, by = now[v - a], parent[v]
            for t in range(turns):
                keeps[t] = 1 if margin_of(ladder, v, t) >= margin - SLACK else 0
                row[t] = start[v, t] if i == 0 and keeps[t] == 1 else np.inf
                by[t] = NOBODY
            begin, end = rails.first[v], rails.first[v + 1]
            nearest = cheapest(rails, begin, end)
            worst = np.inf
            for k in range(begin - 1, end):  # the cheapest rail first: most others then cannot do better
                e = nearest if k < begin else k
                if k == nearest or e >= end or least_before[rails.source[e] - above] + rails.way[e] > worst:
                    continue
                worst = come_by(
                    before[rails.source[e] - above],
                    moved[of_shift[rails.shift[e]]],
                    rails.way[e],
                    e - begin,
                    keeps,
                    row,
                    by,
                )
            least_now[v - a] = np.inf
            for t in range(turns):
                least_now[v - a] = min(least_now[v - a], row[t])
                if row[t] < best:
                    best, vector, turn = row[t], v, t
        before, now = now, before
        least_before, least_now = least_now, least_before
    return best, vector, turn


@kernel(lean=True)
def cheapest(rails: Rails, begin: int, end: int) -> int:
    """Which of the rails from `begin` to the one before `end` costs least; `end`: there are none."""
    found = end
    for e in range(begin, end):
        if found == end or rails.way[e] < rails.way[found]:
            found = e
    return found


@kernel(lean=True)
def come_by(
    old: Array, come: Indices, way: float, rail: int, keeps: Indices, row: Array, by: NDArray[np.int16]
) -> float:
    """Lower what each turn (t,) costs to that of coming by a rail from one that costs `old` (t,); the most of them.

    Of two ways that cost the same, the one by the earlier rail stays.
    """
    worst = -np.inf
    for t in range(row.shape[0]):
        if keeps[t] == 0:
            continue
        s = come[t]
        if s >= 0:
            cost = old[s] + way
            if cost < row[t] or (cost == row[t] and rail < by[t]):
                row[t], by[t] = cost, rail
        worst = max(worst, row[t])
    return worst


@kernel
def trace(ladder: Ladder, rails: Rails, parent: NDArray[np.int16], vector: int, turn: int, out: Indices) -> None:
    """The way that ends at `vector` with `turn`: vector and turn of each rung into `out` (n, 2)."""
    for i in range(out.shape[0] - 1, -1, -1):
        out[i, 0], out[i, 1] = vector, turn
        if i > 0:
            e = rails.first[vector] + parent[vector, turn]
            turn = turn_before(ladder, turn, rails.shift[e])
            vector = rails.source[e]

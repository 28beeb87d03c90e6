"""Which items of two sequences belong together, found again after insertions: patience, then likeness.

Equal starts and ends are cut off, then items whose key occurs once on both sides become anchors (the longest run
of them in the same order on both sides, as in patience sorting), and the stretches between are treated likewise with
coarser keys. Items that still have no partner are paired by likeness. Takes about n log n, however much differs.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Hashable, Sequence
from typing import Final, TypeVar

T = TypeVar("T")
Pair = tuple[int | None, int | None]

GAP: Final = 0.55
"""The cost of an item without a partner; twice this is less than pairing items that have nothing in common."""

# cells of a table for pairing by likeness, and of all such tables; beyond them items are paired in their order
_MOST_CELLS: Final = 40_000
_MOST_CELLS_IN_ALL: Final = 600_000


def align(
    old: Sequence[T],
    new: Sequence[T],
    *,
    same: Callable[[T, T], bool],
    keys: Sequence[Callable[[T], Hashable]],
    unlikeness: Callable[[T, T], float],
) -> list[Pair]:
    """Pairs of indices in the order of both; None where an item has no partner.

    `same` says that two items are equal; `keys` go from exact to coarse; `unlikeness` is 0 for equal items and above
    2 `GAP` for items that should not be paired.
    """
    old_keys = [[key(item) for item in old] for key in keys]
    new_keys = [[key(item) for item in new] for key in keys]
    pairs: list[Pair] = []
    spent = 0
    # stretches still to be treated, last one first: bounds and level of the keys
    todo = [(0, len(old), 0, len(new), 0)]
    while todo:
        a0, a1, b0, b1, level = todo.pop()
        while a0 < a1 and b0 < b1 and same(old[a0], new[b0]):
            pairs.append((a0, b0))
            a0, b0 = a0 + 1, b0 + 1
        while a0 < a1 and b0 < b1 and same(old[a1 - 1], new[b1 - 1]):
            a1, b1 = a1 - 1, b1 - 1
            pairs.append((a1, b1))
        if a0 == a1 or b0 == b1:
            pairs += [(a, None) for a in range(a0, a1)] + [(None, b) for b in range(b0, b1)]
            continue
        anchors: list[tuple[int, int]] = []
        while level < len(keys) and not anchors:
            anchors = _anchors(old_keys[level], new_keys[level], a0, a1, b0, b1)
            level += not anchors
        if not anchors:
            cells = (a1 - a0) * (b1 - b0)
            if cells > _MOST_CELLS or spent + cells > _MOST_CELLS_IN_ALL:
                pairs += _in_their_order(a0, a1, b0, b1)
            else:
                spent += cells
                pairs += _by_likeness(old, new, a0, a1, b0, b1, unlikeness)
            continue
        for a, b in anchors:
            todo.append((a0, a, b0, b, level))
            pairs.append((a, b))
            a0, b0 = a + 1, b + 1
        todo.append((a0, a1, b0, b1, level))
    return _in_order(pairs)


def _in_order(pairs: list[Pair]) -> list[Pair]:
    """Pairs by both indices; an item of one side alone follows its predecessor, old ones before new ones."""
    partner = {a: b for a, b in pairs if a is not None}
    lonely = sorted(b for a, b in pairs if a is None and b is not None)
    ordered: list[Pair] = []
    at = 0
    for a in sorted(partner):
        b = partner[a]
        if b is not None:
            while at < len(lonely) and lonely[at] < b:
                ordered.append((None, lonely[at]))
                at += 1
        ordered.append((a, b))
    return ordered + [(None, b) for b in lonely[at:]]


def _anchors(
    old: Sequence[Hashable], new: Sequence[Hashable], a0: int, a1: int, b0: int, b1: int
) -> list[tuple[int, int]]:
    """Items that occur once on both sides: their longest run that is in order on both."""
    places: dict[Hashable, list[int]] = {}
    for a in range(a0, a1):
        places.setdefault(old[a], []).append(a)
    once: dict[Hashable, list[int]] = {}
    for b in range(b0, b1):
        if len(places.get(new[b], ())) == 1:
            once.setdefault(new[b], []).append(b)
    found = sorted((places[key][0], at[0]) for key, at in once.items() if len(at) == 1)
    return _longest_rising(found)


def _longest_rising(pairs: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """The longest subsequence that rises in the second number, of pairs that rise in the first."""
    tops: list[int] = []
    top_at: list[int] = []
    before: list[int] = []
    for i, (_, b) in enumerate(pairs):
        at = bisect_left(tops, b)
        before.append(top_at[at - 1] if at else -1)
        tops[at : at + 1] = [b]
        top_at[at : at + 1] = [i]
    chain = []
    i = top_at[-1] if top_at else -1
    while i >= 0:
        chain.append(pairs[i])
        i = before[i]
    return chain[::-1]


def _in_their_order(a0: int, a1: int, b0: int, b1: int) -> list[Pair]:
    both = min(a1 - a0, b1 - b0)
    pairs: list[Pair] = [(a0 + i, b0 + i) for i in range(both)]
    return pairs + [(a, None) for a in range(a0 + both, a1)] + [(None, b) for b in range(b0 + both, b1)]


def _by_likeness(
    old: Sequence[T], new: Sequence[T], a0: int, a1: int, b0: int, b1: int, unlikeness: Callable[[T, T], float]
) -> list[Pair]:
    """Pairs of the least total unlikeness (Needleman and Wunsch 1970)."""
    n, m = a1 - a0, b1 - b0
    cost = [[(i + j) * GAP if not i or not j else 0.0 for j in range(m + 1)] for i in range(n + 1)]
    paired = [[0.0] * (m + 1) for _ in range(n + 1)]
    for i in range(1, n + 1):
        for j in range(1, m + 1):
            paired[i][j] = cost[i - 1][j - 1] + unlikeness(old[a0 + i - 1], new[b0 + j - 1])
            cost[i][j] = min(paired[i][j], cost[i - 1][j] + GAP, cost[i][j - 1] + GAP)
    pairs: list[Pair] = []
    i, j = n, m
    while i or j:
        if i and j and cost[i][j] == paired[i][j]:
            i, j = i - 1, j - 1
            pairs.append((a0 + i, b0 + j))
        elif not i or (j and cost[i][j] == cost[i][j - 1] + GAP):
            j -= 1
            pairs.append((None, b0 + j))
        else:
            i -= 1
            pairs.append((a0 + i, None))
    return pairs

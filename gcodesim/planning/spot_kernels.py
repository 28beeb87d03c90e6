"""Which joints turn far on a short way; arrays in and out."""

from __future__ import annotations

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column


@kernel(lean=True)
def way_to(k: int, piece: Column, s: Column) -> float:
    """How far it is to node `k`, at `s` (n,) of `piece` (n,), from the one before."""
    way: float = s[k] - (s[k - 1] if piece[k] == piece[k - 1] else 0.0)
    return way


@kernel(lean=True)
def far_turns(
    piece: Column,
    s: Column,
    head: Column,
    good: Column,
    q: Column,
    turning: Column,
    spot: float,
    jump: float,
    found: Column,
) -> int:
    """Pairs of nodes at both ends of a `spot` [m], or less where a chain begins, between which a joint turns far.

    Nodes are at `s` (n,) of `piece` (n,), with joints q (n, j); each `head` (n,) begins a chain. Only `good` (n,) ones
    lie between, and a joint that is `turning` (j,) goes farther than `jump`. Their numbers are put into `found` (n, 2);
    how many there are is the answer.
    """
    count, begin, last_bad = 0, 0, -1
    way_of_begin, way = 0.0, 0.0
    for k in range(len(piece)):
        if head[k]:
            begin, way_of_begin, way = k, 0.0, 0.0
        else:
            way += way_to(k, piece, s)
        if not good[k]:
            last_bad = k
        while way_of_begin < way - spot:
            begin += 1
            way_of_begin += way_to(begin, piece, s)
        if last_bad >= begin:
            continue
        far = False
        for j in range(len(turning)):
            far = far or (turning[j] and abs(q[k, j] - q[begin, j]) > jump)
        if far:
            found[count, 0], found[count, 1] = begin, k
            count += 1
    return count

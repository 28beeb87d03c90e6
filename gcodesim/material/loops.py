"""Loops in which a surface goes through a cell, for each of the 256 ways in which its corners are in material.

Corner di + 2 dj + 4 dk; edges 0 … 3 along x at dj + 2 dk, 4 … 7 along y at di + 2 dk, 8 … 11 along z at di + 2 dj.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

_MOST_LOOPS: Final = 4
_MOST_POINTS: Final = 12
_SIDES: Final = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
"""The corners of each side of a cell, counter-clockwise from outside."""


def _edge_between(a: int, b: int) -> int:
    low, along = min(a, b), a ^ b
    i, j, k = low & 1, (low >> 1) & 1, low >> 2
    return {1: j + 2 * k, 2: 4 + i + 2 * k, 4: 8 + i + 2 * j}[along]


def _loops_of(corners: int) -> list[tuple[int, list[int]]]:
    """A corner in material and the edges in order, counter-clockwise from outside of the material, of each loop.

    On each side of the cell, a run of corners in material is cut off by one line, so corners that only face each
    other across a side are kept apart.
    """
    following: dict[int, int] = {}
    behind: dict[int, int] = {}  # the corner in material at an edge
    for side in _SIDES:
        full = [bool(corners >> c & 1) for c in side]
        for n in range(4):
            if full[n] and not full[n - 1]:  # a run begins
                last = n
                while full[(last + 1) % 4]:
                    last += 1
                enters = _edge_between(side[n - 1], side[n])
                leaves = _edge_between(side[last % 4], side[(last + 1) % 4])
                following[enters] = leaves
                behind[enters] = side[n]
    loops = []
    while following:
        first = min(following)
        loop, edge = [], first
        while edge in following:
            loop.append(edge)
            edge = following.pop(edge)
        loops.append((behind[first], loop))
    return loops


@cache
def loop_table() -> NDArray[np.int8]:
    """(256, 4, 14): for each loop its number of points, a corner in material, and its edges; 0 points: no more."""
    table = np.zeros((256, _MOST_LOOPS, _MOST_POINTS + 2), dtype=np.int8)
    for corners in range(1, 255):
        for number, (corner, loop) in enumerate(_loops_of(corners)):
            table[corners, number, :2] = len(loop), corner
            table[corners, number, 2 : 2 + len(loop)] = loop
    return table

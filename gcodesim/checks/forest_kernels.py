"""Trees of balls over convex bodies: each node holds half of what its parent holds, split along the longest side."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.checks.gap_kernels import Ints
from gcodesim.compiled import kernel
from gcodesim.frames import Array

DEEPEST = 64
RUN = 8  # what is not longer is sorted by insertion


class Forest(NamedTuple):
    """Bodies as trees of balls: node i has its ball at `centre` (n, 3) with `radius` (n,) in the frame of its carrier.

    All of it is also in a box about the same centre along the axes of that frame, with half sides `half` (n, 3): plates
    and beams fill little of their balls. `left`, `right` are its parts; a leaf has -1 there and its convex body in
    `convex`. `most` (n, 3) [m] are the greatest radius, width and thickness of its convex bodies, see `sizes_of`.
    """

    centre: Array
    radius: Array
    half: Array
    left: Ints
    right: Ints
    convex: Ints
    most: Array


@kernel
def sort_along(key: Array, order: Ints, begin: int, end: int, spare: Ints) -> None:
    """Sort `order` from `begin` to `end` by `key` of what stands there; equal ones keep their order."""
    for low in range(begin, end, RUN):
        for i in range(low + 1, min(low + RUN, end)):
            which = order[i]
            k = i
            while k > low and key[order[k - 1]] > key[which]:
                order[k] = order[k - 1]
                k -= 1
            order[k] = which
    width = RUN
    while width < end - begin:
        for low in range(begin, end, 2 * width):
            middle, high = min(low + width, end), min(low + 2 * width, end)
            if middle == high or key[order[middle - 1]] <= key[order[middle]]:
                continue
            for k in range(low, middle):
                spare[k] = order[k]
            i, j = low, middle
            for k in range(low, high):
                if i < middle and (j >= high or key[spare[i]] <= key[order[j]]):
                    order[k] = spare[i]
                    i += 1
                elif i < middle:
                    order[k] = order[j]
                    j += 1
                else:
                    break
        width *= 2


@kernel
def ball_around(at: Array, size: Array, members: Ints, low: Array, high: Array) -> tuple[float, int]:
    """Radius of a ball about the middle of `low` and `high` (3,) around some balls, and the longest side of these.

    The sides are those of a box around the middles `at` (k, 3); `low` and `high` become those of one around the balls.
    """
    longest, most = 0, -1.0
    for c in range(3):
        least, greatest = math.inf, -math.inf
        low[c], high[c] = math.inf, -math.inf
        for i in members:
            x = at[i, c]
            least, greatest = min(least, x), max(greatest, x)
            low[c], high[c] = min(low[c], x - size[i]), max(high[c], x + size[i])
        if greatest - least > most:
            longest, most = c, greatest - least
    x, y, z = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])
    radius = 0.0
    for i in members:
        u, v, w = at[i, 0] - x, at[i, 1] - y, at[i, 2] - z
        radius = max(radius, math.sqrt(u * u + v * v + w * w) + size[i])
    return radius, longest


@kernel(short=True)
def plant(at: Array, size: Array, sides: Array, columns: Array, many: Ints, forest: Forest, root: Ints) -> None:
    """Fill `forest` with a tree for each of some bodies, the next `many` (b,) balls each, and `root` (b,).

    Balls have their middles `at` (k, 3), once more as `columns` (3, k), and radii `size` (k,); what is in them is also
    in boxes about the same middles with half sides `sides` (k, 3). A tree of k leaves has 2 k - 1 nodes; a node stands
    before its parts, the left one first.
    """
    count = size.shape[0]
    order = np.arange(count)
    spare = np.zeros(count, dtype=np.int64)
    low, high = np.zeros(3), np.zeros(3)
    waiting = np.zeros((DEEPEST, 3), dtype=np.int64)
    first, here = 0, 0
    for body in range(many.shape[0]):
        root[body] = here
        waiting[0, 0], waiting[0, 1], waiting[0, 2] = first, first + many[body], here
        top = 0
        while top >= 0:
            begin, end, node = waiting[top, 0], waiting[top, 1], waiting[top, 2]
            top -= 1
            if end - begin == 1:
                leaf = order[begin]
                for c in range(3):
                    forest.centre[node, c], forest.half[node, c] = at[leaf, c], sides[leaf, c]
                forest.radius[node], forest.convex[node] = size[leaf], leaf
                forest.left[node], forest.right[node] = -1, -1
                continue
            radius, longest = ball_around(at, size, order[begin:end], low, high)
            for c in range(3):
                forest.centre[node, c], forest.half[node, c] = 0.5 * (low[c] + high[c]), 0.5 * (high[c] - low[c])
            sort_along(columns[longest], order, begin, end, spare)
            half = (end - begin) // 2
            left, right = node + 1, node + 2 * half
            forest.radius[node], forest.convex[node] = radius, -1
            forest.left[node], forest.right[node] = left, right
            waiting[top + 1, 0], waiting[top + 1, 1], waiting[top + 1, 2] = begin + half, end, right
            waiting[top + 2, 0], waiting[top + 2, 1], waiting[top + 2, 2] = begin, begin + half, left
            top += 2
        first += many[body]
        here += 2 * many[body] - 1


@kernel(short=True)
def gather(forest: Forest) -> None:
    """Let `most` of each node be that of all its leaves, whose own is there; a node stands before its parts."""
    for i in range(forest.left.shape[0] - 1, -1, -1):
        left, right = forest.left[i], forest.right[i]
        if left >= 0:
            for c in range(3):
                forest.most[i, c] = max(forest.most[left, c], forest.most[right, c])

"""Which of many passes of tools made a face, or came nearest to it: asked of a tree over the passes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.pass_kernels import PassBodies, PassPieces, nearest_pass, outline_distance

Array = NDArray[np.float64]


class Rooms(NamedTuple):
    """Cells around the outline of each of b bodies.

    least (b, i, j) [m]: how far every point of a cell is from the outline at least. room (b, 5) [m]: the corner where
    the cells begin, across and along the axis, their size, and how long their diagonal is.
    """

    least: Array
    room: Array


class PassTree(NamedTuple):
    """A binary tree over stretches of passes: node 1 is the whole, 2k and 2k + 1 are the halves of node k, and the
    last n nodes, n a power of two, are the stretches, those that are near to each other side by side.

    The tips of node k lie in the ball tips[k] (2n, 4), its axes in the ball axes[k] (2n, 4) [m, -]: middle, radius.
    body (2n,) is the one that all of them have, -1 where there are several; first (2n,) the first piece of any.
    """

    tips: Array
    axes: Array
    body: NDArray[np.int32]
    first: NDArray[np.int64]
    rooms: Rooms


@kernel(lean=True)
def fill_rooms(bodies: PassBodies, rooms: Rooms) -> None:
    """Write how far the points of each cell are from the outlines at least."""
    for b in range(rooms.least.shape[0]):
        room = rooms.room[b]
        for i in range(rooms.least.shape[1]):
            for j in range(rooms.least.shape[2]):
                u, v = room[0] + (i + 0.5) * room[2], room[1] + (j + 0.5) * room[3]
                rooms.least[b, i, j] = outline_distance(bodies, b, u, v) - 0.5 * room[4]


@kernel(lean=True)
def is_near(bodies: PassBodies, rooms: Rooms, b: int, u: float, v: float, limit: float) -> bool:
    """Whether (u, v) is within `limit` [m] of an outline; beside all cells: whether it may be."""
    room = rooms.room[b]
    i, j = (u - room[0]) / room[2], (v - room[1]) / room[3]
    across, along = rooms.least.shape[1], rooms.least.shape[2]
    if not (0.0 <= i < across and 0.0 <= j < along):
        du = room[2] * max(-i, i - across, 0.0)
        dv = room[3] * max(-j, j - along, 0.0)
        return bool(limit >= 0.0 and du * du + dv * dv <= limit * limit)
    least = rooms.least[b, int(i), int(j)]
    if least > limit or least + room[4] <= limit:
        return bool(least <= limit)
    return bool(outline_distance(bodies, b, u, v) <= limit)


@kernel(lean=True)
def node_is_near(tree: PassTree, bodies: PassBodies, node: int, point: Array, limit: float) -> bool:
    """Whether any body of a node may be within `limit` [m] of a point (3,).

    None of its points is farther from where it is with the tip and the axis in the middle than these two may be.
    """
    b = int(tree.body[node])
    if b < 0:
        return True
    tip, axis = tree.tips[node], tree.axes[node]
    x, y, z = point[0] - tip[0], point[1] - tip[1], point[2] - tip[2]
    if bodies.lathe:
        r = float(np.sqrt(point[0] * point[0] + point[1] * point[1]))
        return bool(is_near(bodies, tree.rooms, b, r - tip[0], z, limit + tip[3]))
    along = x * axis[0] + y * axis[1] + z * axis[2]
    across = float(np.sqrt(max(x * x + y * y + z * z - along * along, 0.0)))
    return bool(is_near(bodies, tree.rooms, b, across, along, limit + tip[3] + axis[3] * bodies.extent[b, 3]))


@kernel(lean=True)
def makers_of(
    points: Array,
    pieces: PassPieces,
    bodies: PassBodies,
    tree: PassTree,
    chosen: NDArray[np.bool_],
    slack: float,
    within: bool,
    maker: NDArray[np.int64],
    gap: Array,
) -> None:
    """For each point (n, 3) the first of the chosen pieces that came to within `slack` [m], else the nearest one.

    `maker` (n,) is -1 where there is none; gap (n,) [m] is how near the piece came, negative inside. chosen (c,). With
    `within` no piece counts that stayed farther off, and a gap is one that is near enough.
    """
    count, stretches = pieces.body.shape[0], tree.first.shape[0] // 2
    satisfied = slack if within else -np.inf
    guess = -1
    for p in range(points.shape[0]):
        point = points[p]
        found, best, limit, until = -1, np.inf, slack if within else np.inf, count
        if guess >= 0:  # what made the point before tells early what is too far or too late
            distance = nearest_pass(pieces, bodies, guess, point, limit, satisfied)
            if distance <= slack:
                found, best, limit, until = guess, distance, slack, guess
            elif not within:
                found, best, limit = guess, distance, distance
        node = 1
        while node > 0:
            if tree.first[node] < until and node_is_near(tree, bodies, node, point, limit):
                if node < stretches:
                    node = 2 * node
                    continue
                c = int(tree.first[node])
                if chosen[c]:
                    distance = nearest_pass(pieces, bodies, c, point, limit, satisfied)
                    if distance <= slack:
                        found, best, limit, until = c, distance, slack, c
                    elif until == count and not within and (distance < best or (distance == best and c < found)):
                        found, best, limit = c, distance, distance
            while node % 2 == 1:
                node = node // 2
            if node > 0:
                node += 1
        maker[p], gap[p] = found, best
        if found >= 0:
            guess = found

"""How deep bodies are in a stock, step by step, against closed forms over all of its columns."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from gcodesim.checks.gap_kernels import gap_room
from gcodesim.checks.meetings import TOUCH, MovingBodies
from gcodesim.checks.rigid import RigidBody
from gcodesim.checks.stock_gap_kernels import (
    CONVEX,
    DEEPER,
    GAP,
    LAST,
    STATE,
    StockSight,
    approach,
    sight_room,
)
from gcodesim.checks.way_kernels import way_room
from gcodesim.material import Stock, shape
from gcodesim.solids import Box, Placed
from tests.unit.checks.drawn_collisions import TREE, Array

CELL = 1e-3
UP = (0.0, 0.0, 1.0)
SIZE = np.array([0.03, 0.02, 0.015])


def carved(draw: np.random.Generator) -> Stock:
    """A block with slots across each other."""
    stock = Stock.box((0.0, 0.0, 0.0), tuple(SIZE.tolist()), CELL)
    points = draw.uniform((0.0, 0.0, 0.004), SIZE, (6, 3))
    stock.remove(points[:-1], points[1:], shape.ball(6e-3, 0.03))
    return stock


def deepest(stock: Stock, half: Array, at: Array) -> float:
    """The least gap [m] of a box to any column, which is a line: a point is that far from a box as large as both."""
    least = np.inf
    for i, j in np.ndindex(*np.rint(SIZE[:2] / CELL).astype(int)):
        x, y = (i + 0.5) * CELL, (j + 0.5) * CELL
        for low, high in stock.intervals_at(x, y):
            beyond = np.abs(at - (x, y, 0.5 * (low + high))) - half - (0.0, 0.0, 0.5 * (high - low))
            least = min(least, float(np.linalg.norm(np.maximum(beyond, 0.0)) + min(beyond.max(), 0.0)))
    return least


@pytest.mark.parametrize("seed", range(4))
def test_a_box_that_goes_through_a_carved_block_is_as_deep_as_its_deepest_column(seed: int) -> None:
    draw = np.random.default_rng(seed)
    stock, half = carved(draw), draw.uniform(0.002, 0.012, 3)
    corners = draw.uniform(-0.01, SIZE + 0.01, (5, 3))
    way = np.concatenate([np.linspace(a, b, 40, endpoint=False) for a, b in pairwise(corners)])
    q = np.c_[way, np.zeros_like(way)]
    bodies = [
        RigidBody(name="box", solids=(Placed(Box(lower=tuple(-half), upper=tuple(half))),), carrier=5),
        RigidBody(name="stock", solids=(Placed(Box(lower=(0.0, 0.0, 0.0), upper=tuple(SIZE))),), carrier=-1),
    ]
    moving = MovingBodies(TREE, bodies, np.array([[0, 1]]))
    table, ranges = moving.table()
    floor = float(stock.z_range[0])
    sight = StockSight(0, np.eye(4), *ranges[0], ranges[1][0], -TOUCH, floor, False)
    state, found = np.zeros(STATE), np.full((len(q) - 1, 3), np.inf)
    state[LAST], state[CONVEX] = np.inf, -1.0
    room = sight_room(way_room(6), gap_room())

    approach(q, sight, moving.couple(np.full(6, 0.1)), moving.chain, stock.view(UP), table, state, room, found)

    truth = np.array([deepest(stock, half, at) for at in way])
    inside = truth[1:] < -CELL  # steps that end inside are looked at there
    assert inside.sum() > 20
    assert (found[inside, GAP] <= truth[1:][inside] + DEEPER * CELL + 1e-7).all()
    per_step = np.linalg.norm(np.diff(way, axis=0), axis=1)
    assert (found[:, GAP] >= np.minimum(truth[:-1], truth[1:]) - per_step - 1e-7)[inside].all()
    outside = np.minimum(truth[:-1], truth[1:]) - per_step > 0.0
    assert (found[outside, GAP] > -TOUCH).all()

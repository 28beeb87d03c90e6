"""Steps with a corner are cut into parts that each go one way."""

import numpy as np
import pytest

from gcodesim.processes.turns import Turns
from gcodesim.processes.window import Window


def window(pieces, n, *, dt=0.01):
    """n steps with `pieces`: step, begin and end of its part of the time, way [m]."""
    way = np.array([piece[3] for piece in pieces], dtype=float)
    step = np.array([piece[0] for piece in pieces])
    stop = np.cumsum(way, axis=0)
    velocity = np.zeros((n, 3))
    np.add.at(velocity, step, way / dt)
    return Window(
        piece_start=stop - way,
        piece_end=stop,
        piece_step=step,
        piece_share=np.array([piece[1:3] for piece in pieces], dtype=float),
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        velocity=velocity,
        rapid=np.zeros(n, dtype=bool),
        signals={"spindle": np.full(n, 400.0)},
        dt=dt,
    )


DOWN, ALONG = [0.0, 0.0, -1e-4], [3e-4, 0.0, 0.0]


def test_a_corner_has_two_parts_with_their_own_speeds():
    given = window([(0, 0.0, 1.0, DOWN), (2, 0.0, 0.25, DOWN), (2, 0.5, 1.0, ALONG), (3, 0.0, 1.0, ALONG)], 5)
    turns = Turns.of(given)

    assert turns.any and turns.step.tolist() == [0, 1, 2, 2, 3, 4] and turns.first.tolist() == [0, 1, 2, 4, 5]
    assert turns.first_piece.tolist() == [0, 1, 1, 2, 3, 4, 4]
    assert turns.share.tolist() == [1.0, 1.0, 0.25, 0.5, 1.0, 1.0]
    assert turns.velocity[2] == pytest.approx([0.0, 0.0, -0.04])
    assert turns.velocity[3] == pytest.approx([0.06, 0.0, 0.0])
    assert np.array_equal(turns.velocity[[0, 1, 4, 5]], given.velocity[[0, 1, 3, 4]])


@pytest.mark.parametrize(
    "pieces",
    [
        [(0, 0.0, 0.5, ALONG), (0, 0.5, 1.0, [3e-4, 1e-4, 0.0])],  # a gentle bend
        [(0, 0.0, 1.0, DOWN), (1, 0.0, 1.0, ALONG)],  # a corner between two steps
        [(0, 0.0, 1e-4, DOWN), (0, 1e-4, 1.0, ALONG)],  # no time at all
    ],
)
def test_all_else_goes_on_in_one(pieces):
    given = window(pieces, 2)
    turns = Turns.of(given)

    assert not turns.any and turns.step.tolist() == [0, 1]
    assert np.array_equal(turns.velocity, given.velocity) and turns.share.tolist() == [1.0, 1.0]

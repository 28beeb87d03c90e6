"""Steps in which the tool turns a corner, cut into parts that each go one way.

In the mean of two directions a tool that plunges and then cuts a slot would do both at once for a whole step: more
force than either has, and the more the longer the step. Each part has a direction, a speed and a time of its own.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.frozen import frozen
from gcodesim.processes.window import Window

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_WAY: Final = 0.9
"""Cosine of the angle between two directions up to which they are one way."""

LEAST_SHARE: Final = 1e-3
"""A part that takes less of its step is no part of its own."""


@frozen(eq=False)
class Turns:
    """The parts (m,) of n steps, m = n where nothing turns; of part i the pieces first_piece[i]..first_piece[i + 1].

    `step` (m,) is the step of each part, `first` (n,) the first part of each step, `share` (m,) how much of the time of
    its step a part takes, `velocity` (m, 3) [m/s].
    """

    step: Ints
    first: Ints
    first_piece: Ints
    share: Array
    velocity: Array

    @property
    def any(self) -> bool:
        """Whether there is a step with several parts."""
        return len(self.step) > len(self.first)

    @staticmethod
    def of(window: Window) -> Turns:
        """The parts of the steps of a window."""
        n = window.steps
        first_piece = np.searchsorted(window.piece_step, np.arange(n + 1)).astype(np.int64)
        borders = _borders(window, first_piece)
        if not len(borders):
            every = np.arange(n)
            velocity = np.array(window.velocity, dtype=float, order="C")
            return Turns(step=every, first=every, first_piece=first_piece, share=np.ones(n), velocity=velocity)
        assert window.piece_share is not None
        step = np.sort(np.concatenate([np.arange(n), window.piece_step[borders]]))
        first = np.searchsorted(step, np.arange(n))
        begins = np.sort(np.concatenate([first_piece[:-1], borders]))
        begins = np.append(begins, len(window.piece_step))
        share, velocity = np.ones(len(step)), window.velocity[step].astype(float)
        many = np.flatnonzero(np.bincount(step, minlength=n)[step] > 1)
        a, b = begins[many], begins[many + 1] - 1
        share[many] = window.piece_share[b, 1] - window.piece_share[a, 0]
        way = window.piece_end[b] - window.piece_start[a]
        velocity[many] = way / (share[many] * np.broadcast_to(window.dt, n)[step[many]])[:, None]
        return Turns(step=step, first=first, first_piece=begins, share=share, velocity=velocity)


def _borders(window: Window, first_piece: Ints) -> Ints:
    """The pieces with which another part of their step begins."""
    none = np.zeros(0, dtype=np.int64)
    if window.piece_share is None or len(window.piece_step) < 2:
        return none
    inner = np.flatnonzero(np.diff(window.piece_step) == 0) + 1  # pieces that follow another of their step
    way = window.piece_end[inner] - window.piece_start[inner]
    before = window.piece_end[inner - 1] - window.piece_start[inner - 1]
    borders = inner[dots(way, before) < SAME_WAY * norms(way) * norms(before)]
    if not len(borders):
        return none
    # the parts of a step with a border have to take some time
    ends = distinct(np.concatenate([first_piece, borders]))
    begin, end = ends[:-1], ends[1:] - 1
    brief = window.piece_share[end, 1] - window.piece_share[begin, 0] < LEAST_SHARE
    spoilt = window.piece_step[begin[brief]]
    return borders[~np.isin(window.piece_step[borders], spoilt)]

"""How a tool leans by three numbers a, b, c: angles about axes in an order that somebody chose, or a direction."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from gcodesim.arithmetic.matrices import applied, norm, norms
from gcodesim.frames import Array, rotation_about
from gcodesim.frozen import frozen
from gcodesim.kinematics.attitude_kernels import along_directions, by_turns
from gcodesim.kinematics.directions import angle_about, two_turns

_TURN: Final = 2.0 * np.pi


class WordTurn(NamedTuple):
    """A turn about axis 0 to 2 (X, Y, Z) of the frame that the turns before have left, by `sign` times the word 0 to 2.

    WordTurns are A, B, C.
    """

    axis: int
    word: int
    sign: float


@frozen(eq=False)
class WordTurns:
    """Turns one after the other, each about an axis that the ones before have turned (intrinsic)."""

    turns: tuple[WordTurn, ...]

    def rotations(self, values: Array) -> Array:
        """R (k, 3, 3) of words a, b, c (k, 3) [rad]; zero is upright."""
        R = np.empty((len(values), 3, 3))
        axis, word = (np.array([turn[k] for turn in self.turns], dtype=np.int64) for k in range(2))
        sign = np.array([turn.sign for turn in self.turns], dtype=np.float64)
        by_turns(np.require(values, np.float64, ["C", "W"]), axis, word, sign, R)
        return R

    def towards(self, direction: Array, near: Array) -> list[Array]:
        """Words (3,) [rad] that turn Z into `direction` (3,), each so many whole turns on that it is nearest to `near`.

        Two turns do that, so of three each in turn keeps its word. At most six ways; none where they cannot.
        """
        w = np.asarray(direction, dtype=float)
        w = w / norm(w)
        every = range(len(self.turns)) if len(self.turns) == len("ABC") else (None,)
        found = [way for still in every for way in self._while_held(still, w, near)]
        return [near + away - _TURN * np.rint(away / _TURN) for away in (way - near for way in found)]

    def _while_held(self, still: int | None, w: Array, near: Array) -> list[Array]:
        """Words (3,) that turn Z into `w` (3,) while the turn number `still` stays as in `near`.

        With E1 E2 E3 z = w and, say, E2 known, E1 (E2 E3 E2^T) E2 z = w: what stands behind it turns about axes that it
        has turned.
        """
        turns, axes, start = list(self.turns), [np.eye(3)[turn.axis] for turn in self.turns], np.array([0.0, 0.0, 1.0])
        angles = [turn.sign * float(near[turn.word]) for turn in turns]
        if still is not None:
            E = rotation_about(axes.pop(still), angles.pop(still))
            axes[still:] = [applied(E, axis) for axis in axes[still:]]
            start = applied(E, start)
            del turns[still]
        if len(turns) == 1:
            angle = angle_about(axes[0], start, w, angles[0])
            ways: list[tuple[float, ...]] = [] if angle is None else [(angle,)]
        else:
            ways = [*two_turns(axes[0], axes[1], start, w, (angles[0], angles[1]))]
        found = []
        for way in ways:
            words = np.array(near, dtype=float)
            for turn, value in zip(turns, way, strict=True):
                words[turn.word] = turn.sign * value
            found.append(words)
        return found


@frozen(eq=False)
class Direction:
    """From tip to holder along (a, b, 1 + c), so that zero is upright; of any length but zero.

    Straight lines between such vectors are great circles of directions.
    """

    def rotations(self, values: Array) -> Array:
        """R (k, 3, 3) of vectors (k, 3): the shortest turn that brings Z into the direction; straight back about X."""
        R = np.empty((len(values), 3, 3))
        along_directions(np.require(values, np.float64, ["C", "W"]), R)
        return R

    @staticmethod
    def values(direction: Array) -> Array:
        """a, b, c (…, 3) of directions (…, 3) from tip to holder."""
        d = np.asarray(direction, dtype=float)
        out: Array = d / norms(d)[..., None] - np.array([0.0, 0.0, 1.0])
        return out


AttitudeLaw = WordTurns | Direction

"""Which points of a way a control needs, so that it does not stray between them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from gcodesim.arithmetic.elementary import acos, cos_sin
from gcodesim.arithmetic.matrices import dot, multiplied, norm
from gcodesim.frames import Array, rotation_about
from gcodesim.frozen import frozen
from gcodesim.post.angles import rotation_vector
from gcodesim.post.moves import ArmPlace
from gcodesim.units import DEG

TURN: Final = 0.02 * DEG
"""[rad] by which the attitude of the tool may be off."""
_LEVER: Final = 0.1  # [m] of a turn that counts like so much way

Stray = Callable[[ArmPlace, ArmPlace, ArmPlace], float]
"""How far a place is off the way between two others, as a share of what is allowed."""


def needed(places: Sequence[ArmPlace], stray: Stray) -> list[int]:
    """Numbers of the places, in order and without the first, between which a control keeps to all the others.

    Halves a stretch until nothing in it strays by more than 1.
    """
    kept: list[int] = []
    stack = [(0, len(places) - 1)]
    while stack:
        first, last = stack.pop()
        if (
            last - first > 1
            and max(stray(places[first], places[last], places[k]) for k in range(first + 1, last)) > 1.0
        ):
            middle = (first + last) // 2
            stack += [(middle, last), (first, middle)]
        else:
            kept.append(last)
    return kept


@frozen
class StrayOfLine:
    """Of a control that moves the tip along the line and turns the tool evenly about one axis, external axes along
    with it; `tolerance` [m]."""

    tolerance: float

    def __call__(self, start: ArmPlace, end: ArmPlace, place: ArmPlace) -> float:
        p, q = start.X_BT.p, end.X_BT.p
        turn = np.array(rotation_vector(multiplied(start.X_BT.R.T, end.X_BT.R)))
        angle, chord = norm(turn), norm(q - p)
        share = _share(p, q, place.X_BT.p) if chord > _LEVER * angle else _share_of_turn(start, turn, place)
        off = norm(place.X_BT.p - (p + share * (q - p)))
        R = start.X_BT.R if angle == 0.0 else multiplied(start.X_BT.R, rotation_about(turn / angle, share * angle))
        aside = start.externals + share * (end.externals - start.externals)
        outside = float(np.abs(place.externals - aside).max(initial=0.0))
        return max(off / self.tolerance, _between(R, place.X_BT.R) / TURN, outside / self.tolerance)


@frozen
class StrayOfJoints:
    """Of a control that moves all joints evenly; `tip` gives X_BT (4, 4) of a place's joints and external axes."""

    tolerance: float
    tip: Callable[[Array, Array], Array]

    def __call__(self, start: ArmPlace, end: ArmPlace, place: ArmPlace) -> float:
        a, b, c = (np.concatenate([one.q, one.externals]) for one in (start, end, place))
        share = _share(a, b, c)
        joined = a + share * (b - a)
        X = self.tip(joined[: len(place.q)], joined[len(place.q) :])
        return max(norm(X[:3, 3] - place.X_BT.p) / self.tolerance, _between(X[:3, :3], place.X_BT.R) / TURN)


def _share(a: Array, b: Array, c: Array) -> float:
    """The share 0…1 of the way from a to b at which c is nearest."""
    way = b - a
    square = float(np.sum(way * way))
    return 0.0 if square == 0.0 else min(1.0, max(0.0, float(np.sum((c - a) * way)) / square))


def _share_of_turn(start: ArmPlace, turn: Array, place: ArmPlace) -> float:
    here = np.array(rotation_vector(multiplied(start.X_BT.R.T, place.X_BT.R)))
    return _share(np.zeros(3), turn, here)


def _between(R: Array, S: Array) -> float:
    """The angle [rad] between two attitudes."""
    return norm(np.array(rotation_vector(multiplied(R.T, S))))


def turn_between(first: Array, second: Array) -> float:
    """The angle [rad] between two directions (3,); 0 where one has no length."""
    lengths = norm(first) * norm(second)
    return 0.0 if lengths == 0.0 else float(acos(min(1.0, max(-1.0, dot(first, second) / lengths))))


def half_sine(angle: float) -> float:
    """The sine of half an angle."""
    return cos_sin(0.5 * angle)[1]

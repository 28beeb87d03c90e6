"""Names of the branches of arms with a closed form, as people say them: front or back, up or down, flip or noflip."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from gcodesim.kinematics.plane_kernels import PlaneArm

PAIRS: Final = (("front", "back"), ("up", "down"), ("noflip", "flip"))
WORDS: Final = tuple(word for pair in PAIRS for word in pair)
_CENTRED: Final = 1e-9  # [m] of joint 2 from axis 1 that count as none


def names_of(arm: PlaneArm, branch: int) -> tuple[str, str, str]:
    """One word of each of the `PAIRS` for a branch number.

    Front: the centre (of the wrist, or of axes 5 and 6) is on the side of axis 1 on which joint 2 is. Where joint 2 is
    on axis 1, that is the side of joint 2's axis crossed with joint 1's. Up: the elbow is above the line from joint 2
    to the end of the forearm, where base Z points up. Noflip: joint 5 is turned the positive way from where the axes
    of the wrist line up.
    """
    behind, other_elbow, flipped = branch // 4 == 1, branch // 2 % 2 == 1, branch % 2 == 1
    front = behind == (arm.x2 < -_CENTRED)
    up = (behind == other_elbow) == bool(arm.R_PB[2, 2] >= 0.0)
    return PAIRS[0][not front], PAIRS[1][not up], PAIRS[2][flipped]


def branches_named(arm: PlaneArm, words: tuple[str, ...]) -> tuple[int, ...]:
    """The branches to which all of these words apply."""
    return tuple(b for b in range(8) if set(words) <= set(names_of(arm, b)))

"""How an arm stands at a place: what the controls call configuration, status and turn."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, cast

from gcodesim.arithmetic.elementary import cos_sin
from gcodesim.arithmetic.matrices import applied
from gcodesim.frames import Array
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.kinematics.closed_form import ClosedForm
    from gcodesim.kinematics.protocol import Kinematics

_CENTRED: Final = 1e-9  # [m] of joint 2 from axis 1 that count as none


@frozen
class Posture:
    """Of an arm with a spherical wrist.

    `behind`: the wrist centre is behind axis 1, as the arm looks at that moment. `elbow_back`: joint 3 is bent from
    straight so that it raises the forearm behind an upright upper arm. `wrist_negative`: joint 5 is on the negative
    side of where axes 4 and 6 are in line.
    """

    behind: bool
    elbow_back: bool
    wrist_negative: bool


def posture_of(kinematics: Kinematics, q: Array) -> Posture | None:
    """How joints q (6,) stand; None for an arm without a spherical wrist.

    An arm looks to the side of axis 1 on which joint 2 is; where joint 2 is on axis 1, to where a positive joint 2
    lowers an upright upper arm.
    """
    if not getattr(kinematics, "has_wrist_centre", False):
        return None
    wristed = cast("ClosedForm", kinematics)
    arm = wristed.arm
    up = 1.0 if arm.R_PB[2, 2] >= 0.0 else -1.0
    front = up if abs(arm.x2) < _CENTRED else math.copysign(1.0, arm.x2)
    x, y, _ = applied(arm.R_PB, wristed.centre(wristed.forward(q[None]))[0] - arm.p_BP)
    cosine, sine = cos_sin(float(q[0]))
    elbow = up * front * _wrapped(arm.sign3 * float(q[2]) - arm.straight)
    return Posture(
        behind=bool(front * (cosine * x + sine * y) < 0.0),
        elbow_back=elbow < 0.0,
        wrist_negative=_wrapped(float(q[4]) + arm.zero6) < 0.0,
    )


def _wrapped(angle: float) -> float:
    """The same direction within half a turn [rad]."""
    return angle - 2.0 * math.pi * round(angle / (2.0 * math.pi))

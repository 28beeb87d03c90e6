"""Joints for poses of the flange that a script wants: those that go on from where the arm stands, or why not.

A way that an arm cannot go as it stands it may go in another of its postures, with the tip at the same place.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array, Pose
from gcodesim.kinematics.protocol import Status
from gcodesim.planning.reach import why
from gcodesim.session.misuse import MisuseError
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Joints
    from gcodesim.kinematics.protocol import Kinematics

_SAME = 1e-6  # [rad, m] within which two joint vectors are one


def joints_at(name: str, kinematics: Kinematics, X_BF: Array, X_WT: Pose, held: Array) -> Array:
    """Joints (j,) of a flange pose (4, 4), near those `held`; MisuseError, with the tip X_WT, where there are none."""
    q, status = kinematics.inverse(X_BF[None], held)
    if status[0] in (Status.REACH, Status.LIMIT):
        place = ", ".join(f"{value / MM:.1f}" for value in X_WT.p)
        reason = why(kinematics, kinematics.reason(X_BF, held, int(status[0])))
        raise MisuseError(f"`{name}` cannot go there: the tip at ({place}) mm in the world is {reason}")
    found: Array = q[0].copy()
    return found


def joints_along(name: str, kinematics: Kinematics, X_BF: Array, leads_to: NDArray[np.int64], held: Array) -> Array:
    """Joints (n, j) of flange poses (n, 4, 4) that go on from those `held` without a jump.

    MisuseError where there are none, with the number of the pose to which the way leads there, and a posture from which
    the whole way can be gone, if there is one.
    """
    q, status = kinematics.inverse(X_BF, held, on_path=True)
    bad = np.flatnonzero(_cannot(status))
    if not len(bad):
        return q
    first = int(bad[0])
    previous = q[first - 1] if first else held
    reason = why(kinematics, kinematics.reason(X_BF[first], previous, int(status[first])))
    said = f"`{name}` cannot go there: on the way to pose {leads_to[first]}, {reason}"
    other = _other_posture(kinematics, X_BF, held)
    if other is not None:
        said += f"; it can if it begins in another posture, as by move_joints([{_written(other, kinematics.joints)}])"
    raise MisuseError(said)


def _cannot(status: NDArray[np.uint8]) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = np.isin(status, (Status.REACH, Status.LIMIT, Status.FLIP))
    return found


def _written(q: Array, joints: Joints) -> str:
    """Joints (j,) to four digits, which are within their limits as they are."""
    step = 1e-4
    least, most = np.ceil(joints.lower / step) * step, np.floor(joints.upper / step) * step
    return ", ".join(f"{value:.4f}" for value in np.clip(q, least, most))


def _other_posture(kinematics: Kinematics, X_BF: Array, held: Array) -> Array | None:
    """Joints (j,), near those `held` and with the flange at this place, from where the way (n, 4, 4) can be gone."""
    joints = kinematics.joints
    postures = [q for q in kinematics.branches(kinematics.forward(held[None])[0]) if np.abs(q - held).max() > _SAME]
    for q in sorted(postures, key=lambda each: float(np.abs(each - held).max())):
        inside = bool(((q >= joints.lower) & (q <= joints.upper)).all())
        if inside and not _cannot(kinematics.inverse(X_BF, q, on_path=True)[1]).any():
            found: Array = q
            return found
    return None

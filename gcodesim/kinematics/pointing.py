"""Arms that leave the turn of a tool about its own axis to the path: fewer than six joints, and a spin that is free.

Of a pose of the flange only its origin and its Z count. A joint that turns the flange about that Z without end, and
without weight or speed, makes of such an arm one whose poses can be reached by its own kinematics.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import atan2
from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Joint, Link
from gcodesim.kinematics.choice import kinematics_of
from gcodesim.kinematics.machine import Machine, poses

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics, Reason, Statuses

ALL_SIDES: Final = 6
"""Joints with which an arm holds its tool at any angle."""

_TOP: Final = "flange turned about its Z"
_SQUARE: Final = 1e-9  # [m], [-] from the axis of a joint to the flange's Z
_SAME: Final = 1e-6  # [rad], [m] below which two solutions are one


@frozen(slots=False, eq=False)
class PointingArm(Machine):
    """The arm of `chain` with a flange whose turn about its own Z nobody commands; `turned` has a joint for that turn.

    `inverse`, `branches` and `reason` ask for the origin and the Z of the flange alone, and `jacobian` leaves out what
    turns it about that Z.
    """

    turned: Kinematics

    @staticmethod
    def of(kinematics: Kinematics) -> PointingArm | None:
        """The arm with a free flange; None where its joints hold a tool at any angle, or turn the flange so already."""
        chain = kinematics.chain
        if len(chain.driven) >= ALL_SIDES or chain.table is not None or _turns_flange(kinematics):
            return None
        turn = Joint(
            name=_TOP, kind="revolute", parent=chain.flange, child=_TOP, X=np.eye(4), axis=np.array([0.0, 0.0, 1.0])
        )
        turned = replace(
            chain,
            links=(*chain.links, Link(name=_TOP)),
            joints=(*chain.joints, turn),
            driven=(*chain.driven, len(chain.joints)),
            flange=_TOP,
        )
        return PointingArm(chain=chain, turned=kinematics_of(turned))

    def _with_turn(self, q: Array, X_BF: Array) -> Array:
        """Joints (j + 1,) with q (j,) and the turn about Z that brings the flange nearest to a pose (4, 4)."""
        R = multiplied(self.forward(q[None])[:, :3, :3].swapaxes(1, 2), X_BF[None, :3, :3])[0]
        return np.append(q, atan2(R[1, 0] - R[0, 1], R[0, 0] + R[1, 1]))

    def inverse(self, X_BF: Array, seed: Array, *, on_path: bool = False) -> tuple[Array, Statuses]:
        """Joints (n, j) and status (n,) along poses (n, 4, 4), continuous from `seed` (j,) on."""
        X = poses(X_BF)
        start = np.asarray(seed, dtype=float)
        if not len(X):
            return np.empty((0, len(start))), np.empty(0, dtype=np.uint8)
        q, status = self.turned.inverse(X, self._with_turn(start, X[0]), on_path=on_path)
        return np.ascontiguousarray(q[:, :-1]), status

    def branches(self, X_BF: Array) -> Array:
        """The different joint vectors (b, j) of one pose (4, 4), in the order of the arm with a turning flange."""
        kept: list[Array] = []
        for q in self.turned.branches(X_BF)[:, :-1]:
            if all(np.abs(q - other).max() > _SAME for other in kept):
                kept.append(q)
        return np.array(kept).reshape(-1, len(self.joints))

    def branches_along(self, X_BF: Array) -> tuple[Array, NDArray[np.bool_]]:
        """All joint vectors (n, b, j) of poses (n, 4, 4), limits not asked, and which of them exist (n, b)."""
        q, exists = self.turned.branches_along(X_BF)
        return np.ascontiguousarray(q[:, :, :-1]), exists

    def reason(self, X_BF: Array, previous: Array, status: int) -> Reason:
        """What the arm with a turning flange says."""
        X = poses(X_BF)[0]
        return self.turned.reason(X, self._with_turn(np.asarray(previous, dtype=float), X), status)

    def jacobian(self, q: Array) -> Array:
        """Jacobian (n, 6, j) at the flange in base axes; without the turn about the flange's Z."""
        J = super().jacobian(q)
        z = self.forward(q)[:, :3, 2]
        J[:, 3:] -= z[:, :, None] * applied(J[:, 3:].swapaxes(1, 2), z)[:, None, :]
        return J


def _turns_flange(kinematics: Kinematics) -> bool:
    """Whether a joint turns the flange about its own Z: only the one that carries it can do so everywhere."""
    at_zero, last = np.zeros((1, len(kinematics.joints))), kinematics.chain.tree.flange_carrier
    if last < 0:
        return False
    shift, turn = np.split(kinematics.jacobian(at_zero)[0, :, last], 2)
    beside = np.cross(turn, kinematics.forward(at_zero)[0, :3, 2])
    return bool(turn.any() and np.abs(shift).max() < _SQUARE and np.abs(beside).max() < _SQUARE)

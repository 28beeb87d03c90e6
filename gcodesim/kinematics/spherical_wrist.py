"""Six-axis arms with a spherical wrist: closed form, all eight branches."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from gcodesim.arithmetic.matrices import applied, dot, norm
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain
from gcodesim.kinematics.closed_form import SQUARE, ClosedForm, six_in_a_row
from gcodesim.kinematics.closed_form_kernels import SPHERICAL_WRIST
from gcodesim.kinematics.zero_axes import intersection, zero_axes


@frozen(slots=False, eq=False)
class SphericalWrist(ClosedForm):
    """An arm whose axis 2 is square to axis 1, axis 3 parallel to axis 2, and axes 4, 5, 6 square through one point.

    Signs of axes, offsets between them and the zero pose are free: KUKA's
    inverted axes, an offset elbow, a lateral offset as on Staubli's arms. Branch
    number = 4 (wrist centre behind axis 1) + 2 (elbow the other way) + 1 (wrist
    turned over).
    """

    family: ClassVar[int] = SPHERICAL_WRIST
    centre_name: ClassVar[str] = "wrist centre"
    wrist_name: ClassVar[str] = "angle between axes 4 and 6"
    has_wrist_centre: ClassVar[bool] = True

    @staticmethod
    def of(chain: Chain) -> SphericalWrist | None:
        """The closed form of `chain`, or None when its geometry is another one."""
        if not six_in_a_row(chain):
            return None
        o, u, X_BF = zero_axes(chain)
        centre = intersection(o[3:], u[3:], SQUARE)
        square = (dot(u[0], u[1]), dot(u[3], u[4]), dot(u[4], u[5]))
        if centre is None or max(map(abs, square)) > SQUARE or norm(np.cross(u[1], u[2])) > SQUARE:
            return None
        arm = ClosedForm.plane_arm(o, u, X_BF, centre, np.array([o[2], centre]), u[3])
        return None if arm is None else SphericalWrist(chain=chain, arm=arm)

    def _elbow_ends(self, X_BF: Array) -> list[tuple[float, float]]:
        w = applied(self.arm.R_PB, self.centre(X_BF)[0] - self.arm.p_BP)
        forward = math.sqrt(max(0.0, w[0] * w[0] + w[1] * w[1] - self.arm.lateral * self.arm.lateral))
        return [(w[2], reach - self.arm.x2) for reach in (forward, -forward)]

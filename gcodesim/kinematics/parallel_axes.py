"""Six-axis arms whose axes 2, 3 and 4 are parallel (Universal Robots and their kind): closed form, eight branches."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from gcodesim.arithmetic.elementary import atan2, cos_sin
from gcodesim.arithmetic.matrices import applied, dot, multiplied, norm
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain
from gcodesim.kinematics.closed_form import SQUARE, ClosedForm, six_in_a_row
from gcodesim.kinematics.closed_form_kernels import PARALLEL_AXES
from gcodesim.kinematics.zero_axes import intersection, zero_axes


@frozen(slots=False, eq=False)
class ParallelAxes(ClosedForm):
    """An arm whose axes 2, 3, 4 are parallel and square to axes 1 and 5, and whose axes 5 and 6 meet squarely.

    Branch number = 4 (axes 5 and 6 meet behind axis 1) + 2 (elbow the other way)
    + 1 (wrist turned over).
    """

    family: ClassVar[int] = PARALLEL_AXES
    centre_name: ClassVar[str] = "wrist point (axes 5 and 6)"
    wrist_name: ClassVar[str] = "angle between axes 2 and 6"

    @staticmethod
    def of(chain: Chain) -> ParallelAxes | None:
        """The closed form of `chain`, or None when its geometry is another one."""
        if not six_in_a_row(chain):
            return None
        o, u, X_BF = zero_axes(chain)
        centre = intersection(o[4:], u[4:], SQUARE)
        square = (dot(u[0], u[1]), dot(u[3], u[4]), dot(u[4], u[5]))
        skew = max(norm(np.cross(u[1], u[i])) for i in (2, 3))
        if centre is None or max(map(abs, square)) > SQUARE or skew > SQUARE:
            return None
        arm = ClosedForm.plane_arm(o, u, X_BF, centre, np.array([o[2], o[3], centre]), u[1])
        return None if arm is None else ParallelAxes(chain=chain, arm=arm)

    def _elbow_ends(self, X_BF: Array) -> list[tuple[float, float]]:
        arm, X = self.arm, np.reshape(X_BF, (4, 4))
        w = applied(arm.R_PB, self.centre(X)[0] - arm.p_BP)
        forward = math.sqrt(max(0.0, w[0] * w[0] + w[1] * w[1] - arm.lateral * arm.lateral))
        ends = []
        for reach in (forward, -forward):
            q1 = atan2(w[1], w[0]) - atan2(arm.lateral, reach)
            c, s = cos_sin(q1)
            left = multiplied(arm.R_EP, np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]), arm.R_PB, X[:3, :3], arm.R_FE)
            turn = atan2(left[1, 2], left[0, 2])
            for angle in (turn, turn + math.pi):
                rest = complex(w[2], reach - arm.x2) - complex(arm.last_z, arm.last_x) * complex(*cos_sin(angle))
                ends.append((rest.real, rest.imag))
        return ends

"""A position loop at each joint, with gravity fed forward."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.controllers.controller import Law, Servo
from gcodesim.frozen import frozen


@frozen(slots=False, eq=False)
class PD(Servo):
    """Each motor gives torque by its error of position and of speed; gravity and the commanded speed are fed forward.

    Takegaki and Arimoto 1981; with gears that are springs Tomei 1991. Inertia is not fed forward: what accelerates is
    late, by acceleration over the square of the natural frequency.
    """

    kind: ClassVar[str] = "pd"
    law: ClassVar[Law] = "servo"

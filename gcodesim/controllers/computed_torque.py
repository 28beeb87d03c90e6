"""Computed torque: the control knows its robot."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.controllers.controller import Law, Servo
from gcodesim.frozen import frozen


@frozen(slots=False, eq=False)
class ComputedTorque(Servo):
    """A position loop at each joint, with all torques fed forward that the rigid robot with tool and payload needs.

    Computed torque (Luh, Walker, Paul 1980) in the form whose loop does not pass through the mass matrix (PD+, Paden
    and Panja 1988), since that is stable with gears that are springs as well. Without friction, elastic gears, limits
    and process it follows every command.
    """

    kind: ClassVar[str] = "computed_torque"
    law: ClassVar[Law] = "computed"

"""Motors that are where they are commanded to be."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.controllers.controller import Controller, Law
from gcodesim.frozen import frozen


@frozen(slots=False, eq=False)
class Ideal(Controller):
    """Motors end each step on their command, as far as their limit allows; gears yield to the process at once.

    In the kinematic world there is no limit either. Friction and inertia of rotors and gears are left out, so
    that none of the keys means anything.
    """

    kind: ClassVar[str] = "ideal"
    law: ClassVar[Law] = "ideal"

"""Motors that are where they are to be, with gears that are springs and links that have inertia."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.controllers.controller import Controller, Law
from gcodesim.frozen import frozen


@frozen(slots=False, eq=False)
class Flexible(Controller):
    """Motors follow the command as far as their limit allows; links hang on them by gears that are springs and dampers.

    Spong 1987. The control knows how far gravity winds up the gears, and turns its motors further by that.
    The cut knows the speed and the direction that the tip really has. Steps of the default 250 Hz are long beside the
    swings of a heavy cut: `simulation: {rate: 1 kHz}` follows them more closely.
    """

    kind: ClassVar[str] = "flexible"
    law: ClassVar[Law] = "placed"

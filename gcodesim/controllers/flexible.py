"""Motors that are where they are to be, with gears that are springs and links that have inertia."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.controllers.controller import Controller, Law
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen


@frozen(slots=False, eq=False)
class Flexible(Controller):
    """Motors follow the command as far as their limit allows; links hang on them by gears that are springs and dampers.

    Spong 1987. The control knows how far gravity winds up the gears, and turns its motors further by that; with
    `feed_forward` it knows the same of its own motion, so that links swing by the process alone, and limits are those
    of the joints: what rotors need to follow the command comes on top.
    The cut knows the speed and the direction that the tip really has. Steps of the default 250 Hz are long beside the
    swings of a heavy cut: `simulation: {rate: 1 kHz}` follows them more closely.
    """

    kind: ClassVar[str] = "flexible"
    law: ClassVar[Law] = "placed"

    feed_forward: bool = key(
        "switch",
        "whether motors turn further by what their own motion winds up in the gears",
        default=False,
        quiet=True,
    )

    @property
    def ahead(self) -> bool:
        return self.feed_forward

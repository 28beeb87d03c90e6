"""T-slot mill: a disc on a neck."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.disc_cutter import DiscCutter


@frozen
class TSlotMill(DiscCutter):
    """A T-slot mill; bottom, rim and top of the disc cut."""

    kind: ClassVar[str] = "t_slot_mill"

    flutes: int = key("count", "number of teeth", default=4)
    flute_length: float = key("length", "thickness of the disc", example="5 mm")

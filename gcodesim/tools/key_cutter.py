"""Key cutter: a disc on a neck, for the seats of woodruff keys."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.disc_cutter import DiscCutter


@frozen
class KeyCutter(DiscCutter):
    """A woodruff key cutter."""

    kind: ClassVar[str] = "key_cutter"

    flutes: int = key("count", "number of teeth", default=8)
    flute_length: float = key("length", "thickness of the disc", example="5 mm")

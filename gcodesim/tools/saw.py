"""Slitting saw: a thin disc on an arbor."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.disc_cutter import DiscCutter


@frozen
class Saw(DiscCutter):
    """A slitting saw; `neck_diameter` is that of its arbor or flange."""

    kind: ClassVar[str] = "saw"

    flutes: int = key("count", "number of teeth", default=40)
    flute_length: float = key("length", "thickness of the blade", example="1.5 mm")

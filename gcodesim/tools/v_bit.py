"""V-bit: a pointed cone for lettering and grooves."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.frozen import frozen
from gcodesim.tools.conical_cutter import ConicalCutter


@frozen
class VBit(ConicalCutter):
    """A V-bit; a flat at its tip is given by `tip_diameter`."""

    kind: ClassVar[str] = "v_bit"

"""G5, G5.1, G5.2, G5.3 (first cut)."""

from __future__ import annotations

from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.words import Words


def cubic_spline(words: Words, control: Control, code: int) -> None:
    raise Fault("GS170", "not there yet")


quadratic_spline = nurbs_start = nurbs_end = cubic_spline

"""What is wrong with how an arc was used: on in a rapid, on nothing, or with more wire than a bead can be."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from gcodesim.diagnostics import Diagnostic
from gcodesim.processes.rows import Rows
from gcodesim.units import MM, MM3

LEAST: Final = 0.01
"""[s] for which the arc may burn in a row that is not meant: a step at the border of two rows counts as one of them."""

WORTH: Final = 0.02
"""Share of what melts in a row from which on it is told that no work is there."""


def arc_findings(rows: Rows) -> Iterator[Diagnostic]:
    """GS525 to GS527 from the columns of `ArcWelding`."""
    rapid = np.flatnonzero(rows.rapid & (rows["arc_in_rapid"] > LEAST))
    if len(rapid):
        seconds = float(rows["arc_in_rapid"][rapid].sum())
        yield rows.told(rapid, "GS525", f"the arc burns for {seconds:.3f} s of rapid moves",
                        "switch it off before the move", (seconds, 0.0, "s"))  # fmt: skip
    lost = rows["arc_on_nothing"]
    for event in rows.events(lost > WORTH * rows["wire"]):
        volume = float(lost[event].sum())
        yield rows.told(event, "GS526", f"{volume / MM3:.1f} mm³ of wire melt where no work is in reach of the arc",
                        "check the path and its height; `reach` of the torch says how far the arc goes",
                        (volume / MM3, 0.0, "mm³"))  # fmt: skip
    steep = np.flatnonzero(~rows.rapid & (rows["too_steep"] > 0.0))
    if len(steep):
        height, width = float(rows["too_steep"][steep].max()), float(rows["weld_width"][steep].min())
        yield rows.told(steep, "GS527", f"wire and travel speed give a bead {height / MM:.2f} mm high and "
                        f"{width / MM:.2f} mm wide: it would run off to the sides",
                        "go faster, feed less wire, or correct `bead_width`",
                        (height / MM, width / MM, "mm"))  # fmt: skip

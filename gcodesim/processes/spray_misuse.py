"""What is wrong with how a spray gun was used."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Diagnostic
from gcodesim.processes.rows import Rows
from gcodesim.tools.spray_gun import SprayGun
from gcodesim.units import CM3, MM

Array = NDArray[np.float64]

NOTHING: Final = 0.01
"""Share of the spray of some rows that meets a surface, below which they count as spraying on nothing."""

WASTE: Final = 0.1
"""Share of all that a gun sprays, from which on spraying on nothing is told: a turn beside the part is not."""

WORTH: Final = 0.1
"""Share of the film of some rows that was laid from a wrong distance, from which on that is told."""


def spray_findings(rows: Rows) -> Iterator[Diagnostic]:
    """GS533 to GS535 from the columns of `Spraying`."""
    solids = rows["solids"]
    lost = (solids > 0.0) & (rows["met"] < NOTHING * solids)
    for event in rows.events(lost):
        first, volume = int(event[0]), float(rows["sprayed"][event].sum())
        if volume < WASTE * float(rows["sprayed"][rows.tool == rows.tool[first]].sum()):
            continue
        yield rows.told(
            event,
            "GS533",
            f"{rows.tool_name(first)} sprays {volume / CM3:.3g} cm³ on nothing that is to be coated",
            "switch the gun off beside the part; if it should meet it: it points elsewhere, something stands between, "
            "or the faces of the mesh point inwards",
            (volume / CM3, 0.0, "cm³"),
        )
    for name, code_word, hint in (("near", "too near", "keep more distance"), ("far", "too far", "go nearer")):
        film, way = rows[f"{name}_film"], rows[f"{name}_way"]
        for event in rows.events(film > WORTH * rows["film"]):
            first = int(event[0])
            mean = float(way[event].sum() / film[event].sum())
            gun = rows.tools.get(int(rows.tool[first]))
            assert isinstance(gun, SprayGun)
            limit = gun.distances[0 if name == "near" else 1]
            yield rows.told(
                event,
                "GS534",
                f"{rows.tool_name(first)} sprays from {code_word}: {mean / MM:.0f} mm on average; from "
                f"{gun.distances[0] / MM:g} to {gun.distances[1] / MM:g} mm are right for it",
                f"{hint}, or give the gun other `distances`",
                (mean / MM, limit / MM, "mm"),
            )
    for event in rows.events(rows["without_flow"] > 0.0):
        yield rows.told(
            event,
            "GS535",
            f"{rows.tool_name(int(event[0]))} is on for {float(rows['without_flow'][event].sum()):.3g} s and nothing "
            "flows",
            "give the tool a `flow`, or set that of `signals: {flow: …}` before the gun is switched on",
            (0.0, 0.0, "cm³/s"),
        )

"""Indexable inserts by their ISO code (ISO 1832): shape, edge length, nose radius.

`CNMG120408`: shape C (80 degrees), clearance, tolerance and type, edge 12 mm, thickness 04, nose radius 0.8 mm.
"""

from __future__ import annotations

import re
from typing import Final

from gcodesim.frozen import frozen
from gcodesim.units import DEG, MM

_CODE: Final = re.compile(r"([A-Z])([A-Z])([A-Z])([A-Z])[ -]?(\d\d)(\d\d|T\d)(\d\d|M0|00)?\b.*")

TIP_ANGLES: Final = {
    "A": 85.0,
    "B": 82.0,
    "C": 80.0,
    "D": 55.0,
    "E": 75.0,
    "H": 120.0,
    "K": 55.0,
    "L": 90.0,
    "M": 86.0,
    "O": 135.0,
    "P": 108.0,
    "S": 90.0,
    "T": 60.0,
    "V": 35.0,
    "W": 80.0,
}
"""Angle at the tip [deg] by the first letter (ISO 1832, table 1); R is round."""

LEAD_ANGLES: Final = {"C": 95.0, "D": 93.0, "S": 75.0, "T": 91.0, "V": 93.0, "W": 95.0, "K": 93.0}
"""Angle [deg] between cutting edge and feed in the usual holders for longitudinal turning, such as PCLN and SDJC."""

_LENGTHS: Final = {
    ("C", "06"): 6.45, ("C", "09"): 9.67, ("C", "12"): 12.9, ("C", "16"): 16.12, ("C", "19"): 19.34,
    ("D", "07"): 7.75, ("D", "11"): 11.63, ("D", "15"): 15.5,
    ("S", "09"): 9.525, ("S", "12"): 12.7, ("S", "15"): 15.875, ("S", "19"): 19.05,
    ("T", "11"): 11.0, ("T", "16"): 16.5, ("T", "22"): 22.0,
    ("V", "11"): 11.07, ("V", "16"): 16.6, ("W", "06"): 6.52, ("W", "08"): 8.69,
}  # fmt: skip
"""Edge lengths [mm] of the usual sizes, from the inscribed circles of ISO 883 and ISO 3364; others: the digits."""


@frozen
class Insert:
    """What an ISO code says; angles [rad], lengths [m]. A round insert has `tip_angle` 0 and its radius as nose."""

    code: str
    tip_angle: float
    lead_angle: float
    edge: float
    nose_radius: float


def insert_of(code: str) -> Insert | None:
    """The insert of an ISO code such as CNMG120408 or `VBMT 160404`; None if it is none."""
    text = code.strip().upper()
    match = _CODE.fullmatch(text)
    if match is None or match[1] not in (*TIP_ANGLES, "R"):
        return None
    shape, size, corner = match[1], match[5], match[7]
    if shape == "R":
        diameter = int(size) * MM
        return Insert(code=text, tip_angle=0.0, lead_angle=90.0 * DEG, edge=diameter, nose_radius=0.5 * diameter)
    nose = int(corner) * 0.1 * MM if corner and corner.isdigit() else 0.0
    return Insert(
        code=text,
        tip_angle=TIP_ANGLES[shape] * DEG,
        lead_angle=LEAD_ANGLES.get(shape, 93.0) * DEG,
        edge=_LENGTHS.get((shape, size), float(int(size))) * MM,
        nose_radius=nose,
    )

"""Tools that cut no chips, by the words of a comment: what adds, coats, burns, holds, looks or touches."""

from __future__ import annotations

import re
from typing import Final

from gcodesim.frozen import frozen
from gcodesim.units import MM

_LENGTH: Final = 100.0 * MM
_BEAD = re.compile(r"bead\s*[:=]?\s*([0-9.]+)\s*(?:mm)?\s*[x×*]\s*([0-9.]+)", re.IGNORECASE)
_SWITCHES = re.compile(r"\bM0*([0-9]{1,3})\b\D{1,20}\bM0*([0-9]{1,3})\b", re.IGNORECASE)
_CUTTER = re.compile(r"(?:mill|cutter|drill|reamer|insert)s?\b|\btap\b|\b[0-9] ?(?:f|flutes?)\b", re.IGNORECASE)
_GUESSES: Final = (
    (
        r"weld|mig\b|mag\b|gmaw",
        "welding_torch",
        "wire_diameter: 1.2 mm, wire_speed: 7 m/min, voltage: 22 V, current: 180 A",
    ),
    (r"plasma", "plasma", "power: 9 kW, diameter: 1.5 mm"),
    (r"water ?-?jet|abrasive", "jet", "diameter: 1 mm, removal_rate: 8 mm^3/s"),
    (
        r"laser",
        "laser",
        "power: 10 W, diameter: 0.2 mm, wavelength: 0.455 um, absorptivity: 0.8, specific_energy: 2 J/mm^3",
    ),
    (
        r"spray|paint|coat(?:er|ing)|airbrush",
        "spray_gun",
        "cone: 30 deg, efficiency: 0.65, solids: 0.45, distance: 150 mm",
    ),
    (r"sand ?-?blast|shot ?-?blast", "sand_blaster", "diameter: 8 mm, removal_rate: 2 mm^3/s"),
    (
        r"suction|vacuum (?:gripper|cup|pad)",
        "suction_gripper",
        "cups: [{at: [0, 0], diameter: 40 mm}], vacuum: 60 kPa, friction: 0.5",
    ),
    (r"gripper|grasp|\bgreifer", "finger_gripper", "stroke: 60 mm, force: 80 N, friction: 0.3"),
    (r"camera", "camera", "width: 640, height: 480, field_of_view: 45 deg"),
    (r"drag ?-?knife", "drag_knife", "diameter: 1 mm"),
    (r"extru|nozzle|hot-?end|print ?head|concrete (?:pump|head)", "extruder", "flow: 100 mm^3/s"),
    (r"\bprobe\b|\btaster\b|touch ?-?probe|edge ?-?finder", "probe", "diameter: 3 mm"),
)
"""Words, the kind of tool, and usual values of its keys; `nozzle` comes after tools that have one, too."""
_KINDS: Final = tuple((re.compile(words, re.IGNORECASE), kind, keys) for words, kind, keys in _GUESSES)


@frozen
class NamedTool:
    """A tool that is no cutter: its `kind` and its keys as text of a cell, of which most numbers are guesses.

    `switches` are the M-codes that turn it on and off, where the comment names two.
    """

    kind: str
    keys: str
    switches: tuple[int, int] | None

    @property
    def length(self) -> float:
        """From the spindle's nose to the tip [m]."""
        return _LENGTH


def named_tool(text: str) -> NamedTool | None:
    """By words about one tool; None where they name a cutter, or nothing."""
    found = next(((kind, keys) for words, kind, keys in _KINDS if words.search(text)), None)
    if found is None or _CUTTER.search(text):
        return None
    kind, keys = found
    if kind == "extruder":
        bead = _BEAD.search(text)
        width, height = (bead[1], bead[2]) if bead else ("6", "3")
        keys = f"bead_width: {float(width):g} mm, bead_height: {float(height):g} mm, {keys}"
    switches = _SWITCHES.search(text)
    return NamedTool(
        kind=kind,
        keys=", ".join(filter(None, (f"type: {kind}", keys, f"length: {_LENGTH / MM:g} mm"))),
        switches=(int(switches[1]), int(switches[2])) if switches else None,
    )

"""What cuts at a distance in a program: laser, plasma torch or water jet, by its comments and its S words."""

from __future__ import annotations

import re
from typing import Final, Literal

from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.units import MM

BeamKind = Literal["laser", "plasma", "jet"]

_NOTE = re.compile(rb"\(([^)\r\n]*)|;([^\r\n]*)")
_WORDS: Final[dict[BeamKind, re.Pattern[bytes]]] = {
    "plasma": re.compile(rb"plasma|\btorch\b", re.IGNORECASE),
    "jet": re.compile(rb"water[ -]?jet|\babrasive\b|\bwazer\b", re.IGNORECASE),
    "laser": re.compile(rb"laser|lightburn", re.IGNORECASE),
}
_POWER = re.compile(rb"(?<![A-Za-z#<])[Ss][ \t]*([0-9]+\.?[0-9]*|\.[0-9]+)")
_CHANGE = re.compile(rb"(?<![A-Za-z#<])[Mm]0*6(?![0-9])")
_SCALES: Final = (100.0, 255.0, 1000.0, 10_000.0)  # usual numbers of full power
_TOOLS: Final[dict[BeamKind, tuple[str, str]]] = {
    "laser": (
        "type: laser, power: 10 W, diameter: 0.2 mm, wavelength: 0.455 um, absorptivity: 0.8, "
        "specific_energy: 2 J/mm^3, length: 60 mm",
        "plywood",
    ),
    "plasma": ("type: plasma, power: 9 kW, diameter: 1.5 mm, length: 90 mm", "c45"),
    "jet": ("type: jet, diameter: 1 mm, removal_rate: 8 mm^3/s, length: 90 mm", "al6082_t6"),
}
_LENGTHS: Final[dict[BeamKind, float]] = {"laser": 60.0 * MM, "plasma": 90.0 * MM, "jet": 90.0 * MM}
_DIAMETERS: Final[dict[BeamKind, float]] = {"laser": 0.2 * MM, "plasma": 1.5 * MM, "jet": 1.0 * MM}


@frozen
class NamedBeam:
    """The beam of a program: `kind`, the line of the comment that names it, and the greatest S word."""

    kind: BeamKind
    line: int
    greatest: float

    @staticmethod
    def of(program: SourceText) -> NamedBeam | None:
        """By the first comment that names one; None for a program that changes tools, as a mill's does."""
        raw = program.raw
        if _CHANGE.search(_NOTE.sub(b"", raw)):
            return None
        for note in _NOTE.finditer(raw):
            for kind, pattern in _WORDS.items():
                if pattern.search(note[0]):
                    powers = [float(found) for found in _POWER.findall(_NOTE.sub(b"", raw))]
                    line = raw.count(b"\n", 0, note.start()) + 1
                    return NamedBeam(kind=kind, line=line, greatest=max(powers, default=0.0))
        return None

    @property
    def length(self) -> float:
        """From the spindle's nose to the tip [m]."""
        return _LENGTHS[self.kind]

    @property
    def material(self) -> str:
        """What is usually cut with it."""
        return _TOOLS[self.kind][1]

    @property
    def diameter(self) -> float:
        """Of the beam [m]."""
        return _DIAMETERS[self.kind]

    def switch_line(self, dialect: str) -> str:
        """The key of a cell by which the beam is switched: grbl's laser mode, or the words of a spindle."""
        full = next((scale for scale in _SCALES if self.greatest <= scale), self.greatest)
        if self.kind != "laser":
            return "signals: {beam: {word: M3/M5}}"
        if dialect == "grbl":
            return f"laser_mode: {full:g}    # S of full power, a guess: $30 of the control"
        watts = 10.0 / full
        return f"signals: {{power: {{word: S, per: {watts:g} W}}}}    # S{full:g} is full power, a guess"

    def tool_lines(self) -> list[str]:
        return [
            "tools:",
            f"  # line {self.line} names it; ITS NUMBERS ARE A GUESS",
            f"  1: {{{_TOOLS[self.kind][0]}}}",
        ]

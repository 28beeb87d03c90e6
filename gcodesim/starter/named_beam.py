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
    "plasma": re.compile(rb"plasma|\btorch\b|hypertherm|powermax", re.IGNORECASE),
    "jet": re.compile(rb"water[ -]?jet|\babrasive\b|\bwazer\b", re.IGNORECASE),
    "laser": re.compile(rb"laser|lightburn", re.IGNORECASE),
}
_WELDS = re.compile(rb"weld|\b(?:mig|mag|tig|gmaw|waam)\b", re.IGNORECASE)  # its torch adds
_POWER = re.compile(rb"(?<![A-Za-z#<])[Ss][ \t]*([0-9]+\.?[0-9]*|\.[0-9]+)")
_CHANGE = re.compile(rb"(?<![A-Za-z#<])[Mm]0*6(?![0-9])")
_TOOL = re.compile(rb"(?<![A-Za-z#<])[Tt][ \t]*0*([0-9]+)")
_ON = re.compile(rb"(?<![A-Za-z#<])[Mm]0*[34](?![0-9])")
_HEIGHT = re.compile(rb"(?<![A-Za-z#<])[Zz][ \t]*[-+0-9.#\[]")
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
    """The beam of a program: `kind`, why it is one, the greatest S word, and the number of the tool that it is."""

    kind: BeamKind
    why: str
    greatest: float
    number: int

    @staticmethod
    def of(program: SourceText) -> NamedBeam | None:
        """By the first comment that names one, or a spindle that is switched though nothing ever moves Z.

        None for a program that changes tools, as a mill's does, unless it calls one only and gives it no speed, or a
        comment names that tool, as `T1: Plasma`: S words may tell a height control something.
        """
        raw = program.raw
        words = _NOTE.sub(b"", raw)
        greatest = max((float(found) for found in _POWER.findall(words)), default=0.0)
        called = {int(found) for found in _TOOL.findall(words)}
        changes = _CHANGE.search(words) is not None
        if changes and len(called) != 1:
            return None
        number = called.pop() if len(called) == 1 else 1
        of_tool = re.compile(rb"\bT0*%d\b" % number) if changes and greatest > 0.0 else None
        for note in _NOTE.finditer(raw):
            if of_tool is not None and of_tool.search(note[0]) is None:
                continue
            for kind, pattern in _WORDS.items():
                if pattern.search(note[0]) and not _WELDS.search(note[0]):
                    why = f"line {raw.count(10, 0, note.start()) + 1} names it"
                    return NamedBeam(kind=kind, why=why, greatest=greatest, number=max(number, 1))
        on = None if of_tool is not None else _ON.search(words)
        if on is None or greatest == 0.0 or _HEIGHT.search(words):
            return None
        line = words.count(10, 0, on.start()) + 1
        why = f"line {line} switches a spindle on, and nothing moves Z: a laser, most likely"
        return NamedBeam(kind="laser", why=why, greatest=greatest, number=max(number, 1))

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
            f"  # {self.why}; ITS NUMBERS ARE A GUESS",
            f"  {self.number}: {{{_TOOLS[self.kind][0]}}}",
        ]

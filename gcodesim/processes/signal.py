"""Signals: what the program tells a process while the tool moves, with one value for each step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Signal:
    """A value that a word of the program sets and that holds until another word sets it; `unit` is SI.

    `default` holds where nothing in the program or in the cell gives the signal.
    """

    name: str
    unit: str = ""
    default: float = 0.0


SPINDLE: Final = Signal("spindle", "rad/s")
"""Speed of the spindle: S with M3 (positive) or M4 (negative), 0 while it stands."""

ACTIVE: Final = Signal("active")
"""1 while the process of the tool is switched on, otherwise 0."""

"""How bodies are coloured, in the log and in pictures: red, green, blue and opacity from 0 to 1."""

from __future__ import annotations

from typing import Final

Color = tuple[float, float, float, float]

FIXTURE: Final[Color] = (0.45, 0.36, 0.28, 1.0)
RAW: Final[Color] = (0.62, 0.64, 0.67, 1.0)
"""The surface of stock as it was at the start."""
CUT: Final[Color] = (0.86, 0.74, 0.42, 1.0)
PART: Final[Color] = (0.36, 0.5, 0.68, 1.0)
DEVICE: Final[Color] = (0.5, 0.52, 0.4, 1.0)

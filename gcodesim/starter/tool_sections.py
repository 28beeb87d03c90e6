"""Shanks and holders in tool files: stacks of cylinders and cones, as `shank` and `holder` of a tool."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from gcodesim.starter.tool_keys import Json, ToolKeys, number_of

_LEAST = 1e-6
"""In the unit of the file: what is shorter is left out."""


class _Part(NamedTuple):
    """A section in the unit of the file: diameters below and above, length."""

    lower: float
    upper: float
    length: float


def fusion_holder(entry: Json, keys: ToolKeys) -> None:
    """The `holder` from the segments of Fusion, which go from the tool up, in the holder's own unit.

    What is above its gauge length is inside of the spindle.
    """
    holder = entry.get("holder")
    parts = _segments(holder)
    if not parts or not isinstance(holder, dict):
        return
    word, gauge = str(holder.get("unit") or ""), number_of(holder.get("gaugeLength")) or 0.0
    unit = "in" if word.startswith("inch") else "mm" if word.startswith("mill") else keys.unit
    if gauge > _LEAST:
        parts = _cut_off(parts, gauge)
    keys.found["holder"] = _stack(parts, unit)


def fusion_shank(entry: Json, geometry: Json, keys: ToolKeys) -> None:
    """The `shank` from Fusion's shoulder, shaft segments and shaft diameter, where they leave room for one.

    The shoulder goes on from the flutes, then come the segments from the tool up; above them the shaft has SFDM.
    """
    diameter, flutes, length = (number_of(geometry.get(name)) or 0.0 for name in ("DC", "LCF", "LB"))
    if not {"diameter", "flute_length", "length"} <= set(keys.found) or length - flutes <= _LEAST:
        return
    shoulder = number_of(geometry.get("shoulder-length")) or 0.0
    parts = []
    if shoulder - flutes > _LEAST:
        wide = number_of(geometry.get("shoulder-diameter")) or diameter
        parts.append(_Part(wide, wide, shoulder - flutes))
    parts += _segments(entry.get("shaft"))
    shaft = number_of(geometry.get("SFDM")) or (parts[-1].upper if parts else diameter)
    parts = _cut_off([*parts, _Part(shaft, shaft, length)], length - flutes)
    if any(part.lower <= 0.0 or part.upper <= 0.0 for part in parts):
        return
    if any(abs(size - diameter) > _LEAST for part in parts for size in part[:2]):
        keys.found["shank"] = _stack(parts, keys.unit)


def plain_shank(diameter: float | None, keys: ToolKeys) -> None:
    """The `shank` of one diameter, where it leaves room for one and is not as thick as the edges."""
    if not {"diameter", "flute_length", "length"} <= set(keys.found) or not diameter or diameter <= 0.0:
        return
    edges, flutes, length = (number_of(keys.found[name]) or 0.0 for name in ("diameter", "flute_length", "length"))
    if length - flutes > _LEAST and abs(diameter - edges) > _LEAST:
        keys.length("shank", diameter)


def _segments(of: Any) -> list[_Part]:
    segments = of.get("segments") if isinstance(of, dict) else None
    found = []
    for part in segments if isinstance(segments, list) else []:
        sizes = part if isinstance(part, dict) else {}
        lower, upper = (number_of(sizes.get(name)) or 0.0 for name in ("lower-diameter", "upper-diameter"))
        height = number_of(sizes.get("height")) or 0.0
        if height > _LEAST and max(lower, upper) > 0.0:
            found.append(_Part(lower if lower > 0.0 else upper, upper if upper > 0.0 else lower, height))
    return found


def _cut_off(parts: Sequence[_Part], room: float) -> list[_Part]:
    """The parts up to the height `room`."""
    found = []
    for part in parts:
        length = min(part.length, room)
        if length <= _LEAST:
            break
        found.append(_Part(part.lower, part.lower + (part.upper - part.lower) * length / part.length, length))
        room -= length
    return found


def _stack(parts: Sequence[_Part], unit: str) -> str:
    texts = []
    for lower, upper, length in parts:
        wider = f", upper_diameter: {round(upper, 6):g} {unit}" if abs(upper - lower) > _LEAST else ""
        texts.append(f"diameter: {round(lower, 6):g} {unit}{wider}, length: {round(length, 6):g} {unit}")
    above = ", ".join(f"{{{text}}}" for text in texts[1:])
    return f"{{{texts[0]}, above: [{above}]}}" if above else f"{{{texts[0]}}}"

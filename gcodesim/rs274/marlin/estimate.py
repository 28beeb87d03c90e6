"""What a slicer says in comments that a print will take: time and filament.

- Slic3r, PrusaSlicer, OrcaSlicer: `; estimated printing time (normal mode) = 1h 2m 3s`, `; filament used [mm] = 12, 4`
- BambuStudio: `; model printing time: 4m 54s; total estimated time: 10m 22s`, `; total filament length [mm] : 391.4,24`
- Cura: `;TIME:943`, `;Filament used: 1.2m, 0m`, and after each layer `;TIME_ELAPSED:12.3`
- Simplify3D: `;   Build time: 1 hours 43 minutes`, `;   Filament length: 4062.2 mm (4.06 m)`
- ideaMaker: `;Print Time: 1234`, `;Material#1 Used: 1234.5`
- Kiri:Moto: `; --- print time: 4798s ---`, `; --- filament used: 4062.18 mm ---`
- KISSlicer: `; Estimated Build Time: 12.3 minutes`, `; Ext 1 = 1234.5 mm (2.9 cm^3)`
- IceSL: `; estimated_print_time_s : 150`, `; filament_used_mm : 1200`
"""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from gcodesim.diagnostics import SourceText
from gcodesim.units import MINUTE, MM

_ENDS: Final = 60_000  # bytes at either end of a program in which slicers write it
_HOUR: Final = 60.0 * MINUTE
_NUMBER: Final = rb"([0-9]+\.?[0-9]*)"
_NUMBERS: Final = rb"([0-9.,; \t]*[0-9])"
_SPELLED: Final = re.compile(rb"([0-9]+\.?[0-9]*)[ \t]*(d|h|m|s)[a-z]*")
_SECONDS: Final = {b"d": 24.0 * _HOUR, b"h": _HOUR, b"m": MINUTE, b"s": 1.0}


def _comment(text: bytes) -> re.Pattern[bytes]:
    return re.compile(rb"^;[ \t]*" + text, re.MULTILINE)


_SPELLED_TIMES: Final = (
    _comment(rb"(?:model printing time: [^;\n]*; )?total estimated time: ([^;\r\n]*)"),
    _comment(rb"estimated printing time \(normal mode\) = ([^\r\n]*)"),
    _comment(rb"estimated printing time = ([^\r\n]*)"),
    _comment(rb"Build [Tt]ime: ([0-9]+ hours?[^\r\n]*)"),
)
_MODEL_TIME: Final = _comment(rb"model printing time: ([^;\r\n]*)")
_COUNTED_TIMES: Final = (
    (_comment(rb"TIME:" + _NUMBER + rb"[ \t]*\r?$"), 1.0),
    (_comment(rb"Print Time: " + _NUMBER + rb"[ \t]*\r?$"), 1.0),
    (_comment(rb"--- print time: " + _NUMBER + rb"s"), 1.0),
    (_comment(rb"(?:[-A-Za-z]+ )*Build Time:[ \t]*" + _NUMBER + rb" minutes"), MINUTE),
    (_comment(rb"estimated_print_time_s : " + _NUMBER), 1.0),
)
_ELAPSED: Final = _comment(rb"TIME_ELAPSED:" + _NUMBER)
_NOT_YET_KNOWN: Final = 6666.0
"""What CuraEngine writes for the time, and 0 m for the filament, where no front end puts in what it has found."""

_FILAMENTS: Final = (
    (_comment(rb"total filament length \[mm\] : " + _NUMBERS), MM),
    (_comment(rb"filament used \[mm\] = " + _NUMBERS), MM),
    (_comment(rb"Filament used: ([0-9.]+m(?:, ?[0-9.]+m)*)"), 1.0),
    (_comment(rb"Filament length: " + _NUMBER + rb" mm"), MM),
    (_comment(rb"Material#[0-9]+ Used: " + _NUMBER), MM),
    (_comment(rb"--- filament used: " + _NUMBER + rb" mm"), MM),
    (_comment(rb"Ext[ #]*[0-9]+[ \t]*=[ \t]*" + _NUMBER + rb" mm"), MM),
    (_comment(rb"filament_used_mm : " + _NUMBER), MM),
)


class SlicerEstimate(NamedTuple):
    """`time` [s] and `filament` [m] that the slicer says; None where it says nothing.

    `model_time` [s] is without the code at the start and the end and without what is allowed for getting ready.
    """

    time: float | None
    filament: float | None
    model_time: float | None = None


def estimate_in(source: SourceText) -> SlicerEstimate:
    """What the comments at the ends of a program say."""
    ends = source.raw if len(source.raw) <= 2 * _ENDS else source.raw[:_ENDS] + b"\n" + source.raw[-_ENDS:]
    return SlicerEstimate(_time(ends), _filament(ends), _spelled(_MODEL_TIME, ends))


def _time(ends: bytes) -> float | None:
    for pattern in _SPELLED_TIMES:
        if (time := _spelled(pattern, ends)) is not None:
            return time
    for pattern, unit in _COUNTED_TIMES:
        if (found := pattern.search(ends)) is not None and float(found[1]) != _NOT_YET_KNOWN:
            return float(found[1]) * unit
    elapsed = _ELAPSED.findall(ends)
    return float(elapsed[-1]) if elapsed else None


def _spelled(pattern: re.Pattern[bytes], ends: bytes) -> float | None:
    """A time [s] such as `1h 2m 3s`."""
    found = pattern.search(ends)
    parts = [] if found is None else _SPELLED.findall(found[1])
    return sum(float(number) * _SECONDS[unit] for number, unit in parts) if parts else None


def _filament(ends: bytes) -> float | None:
    """The sum over all nozzles, which stand in one line or in several."""
    for pattern, unit in _FILAMENTS:
        lines = pattern.findall(ends)
        length = sum(float(number) for line in lines for number in re.findall(_NUMBER, line)) * unit
        if length > 0.0:
            return length
    return None

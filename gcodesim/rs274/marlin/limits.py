"""What a printer's firmware limits before its program says otherwise."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from gcodesim.canon.printing import Four, MotionLimits
from gcodesim.diagnostics import SourceText
from gcodesim.units import MM

_TAIL: Final = 60_000  # bytes at either end of a program in which slicers write their settings
_SETTING: Final = re.compile(rb"^;[ \t]*(machine_max_[a-z_]+)[ \t]*=[ \t]*([0-9.]+)", re.MULTILINE)
_SPEED: Final = ("feedrate", "speed")
"""How PrusaSlicer and SuperSlicer, then Bambu Studio, OrcaSlicer and Creality Print call the greatest speed."""
_RETRACTION: Final = re.compile(rb"^;[ \t]*retract_(length|speed)[ \t]*=[ \t]*([0-9]+\.?[0-9]*)", re.MULTILINE)


def in_metres(x: float, y: float, z: float, e: float) -> Four:
    return (x * MM, y * MM, z * MM, e * MM)


MARLIN_LIMITS: Final = MotionLimits(
    speed=in_metres(300.0, 300.0, 5.0, 25.0),
    acceleration=in_metres(3000.0, 3000.0, 100.0, 10000.0),
    jerk=in_metres(10.0, 10.0, 0.3, 5.0),
    printing=3000.0 * MM,
    retracting=3000.0 * MM,
    travel=3000.0 * MM,
)
"""Marlin 2.1, Configuration.h as it is delivered, with classic jerk."""

KLIPPER_LIMITS: Final = MotionLimits(
    speed=in_metres(300.0, 300.0, 300.0, 300.0),
    acceleration=in_metres(3000.0, 3000.0, 3000.0, 1e6),
    jerk=in_metres(0.0, 0.0, 0.0, 1e6),
    printing=3000.0 * MM,
    retracting=3000.0 * MM,
    travel=3000.0 * MM,
    corner=5.0 * MM,
    buffer=1000,
)
"""Klipper, config/example-cartesian.cfg; it plans far ahead."""

REPRAP_LIMITS: Final = MARLIN_LIMITS._replace(
    speed=in_metres(300.0, 300.0, 5.0, 60.0),
    acceleration=in_metres(1000.0, 1000.0, 100.0, 1000.0),
    jerk=in_metres(15.0, 15.0, 0.2, 20.0),
    printing=10000.0 * MM,
    retracting=10000.0 * MM,
    travel=10000.0 * MM,
    buffer=40,
)
"""RepRapFirmware 3, its defaults for M201, M203, M204 and M566."""

CURA_LIMITS: Final = MotionLimits(
    speed=in_metres(299792458000.0, 299792458000.0, 299792458000.0, 299792458000.0),
    acceleration=in_metres(9000.0, 9000.0, 100.0, 10000.0),
    jerk=in_metres(20.0, 20.0, 0.4, 5.0),
    printing=4000.0 * MM,
    retracting=4000.0 * MM,
    travel=4000.0 * MM,
)
"""fdmprinter.def.json of Cura 4.13: `machine_max_…`, `machine_acceleration`, with which it estimates times."""

_OF_DIALECT: Final = {"marlin": MARLIN_LIMITS, "klipper": KLIPPER_LIMITS, "reprapfirmware": REPRAP_LIMITS}


def first_limits(dialect: str, source: SourceText, said: Mapping[str, Any]) -> tuple[MotionLimits, str]:
    """The limits in force before the first line, and where they come from.

    What is `said` of the printer itself, by the names of `MotionLimits`, is in place of its firmware's defaults. Else
    the settings that a slicer of the PrusaSlicer family writes as comments say what it takes the printer for. Cura
    writes none; its own defaults are taken where its name stands in the program. Else those of the firmware.
    """
    limits = _OF_DIALECT.get(dialect, MARLIN_LIMITS)
    if said:
        return limits._replace(**said), "those of the printer"
    ends = source.raw if len(source.raw) <= 2 * _TAIL else source.raw[:_TAIL] + b"\n" + source.raw[-_TAIL:]
    found = {name.decode(): float(value) for name, value in _SETTING.findall(ends)}
    if found:
        return _of_slicer(found, limits), "the slicer's settings at the end of the program"
    if b"Cura_SteamEngine" in ends[:_TAIL]:
        return CURA_LIMITS, "the defaults of Cura"
    return limits, f"the defaults of {'Klipper' if dialect == 'klipper' else 'the firmware'}"


def first_retraction(source: SourceText) -> tuple[float, float] | None:
    """Length [mm] and speed [mm/min] of the firmware's retraction as the slicer takes it; None if it does not say."""
    ends = source.raw if len(source.raw) <= 2 * _TAIL else source.raw[-_TAIL:]
    found = {name: float(value) for name, value in _RETRACTION.findall(ends)}
    if found.get(b"length", 0.0) <= 0.0 or found.get(b"speed", 0.0) <= 0.0:
        return None
    return found[b"length"], 60.0 * found[b"speed"]


def _of_slicer(found: dict[str, float], limits: MotionLimits) -> MotionLimits:
    def four(names: tuple[str, ...], known: Four) -> Four:
        keys = [[f"machine_max_{name}_{axis}" for name in names] for axis in "xyze"]
        values = [next((found[key] for key in of_axis if key in found), -1.0) for of_axis in keys]
        return tuple(v * MM if v > 0.0 else k for v, k in zip(values, known, strict=True))  # type: ignore[return-value]

    def one(name: str, known: float) -> float:
        value = found.get(f"machine_max_acceleration_{name}", 0.0)
        return value * MM if value > 0.0 else known

    printing = one("extruding", limits.printing)
    return limits._replace(
        speed=four(_SPEED, limits.speed),
        acceleration=four(("acceleration",), limits.acceleration),
        jerk=four(("jerk",), limits.jerk),
        printing=printing,
        retracting=one("retracting", printing),
        travel=one("travel", printing),
        corner=0.0,
        deviation=found.get("machine_max_junction_deviation", 0.0) * MM,
    )

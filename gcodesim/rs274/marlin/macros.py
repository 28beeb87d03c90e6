"""Klipper's extended commands: bare words with settings. Those that move or limit are done, others are told."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from gcodesim.rs274.fault import Fault
from gcodesim.rs274.marlin.line import MarlinLine
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.rs274.marlin.executor import PrinterExecutor


def _number(line: MarlinLine, name: str) -> float | None:
    """The number of a setting; None where it is not there."""
    text = line.settings.get(name)
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not text.isascii() or "_" in text or value != value or abs(value) == float("inf"):
        raise Fault("GS106", f"{name} of {line.name} is no number: {text[:40]}", at=line.place)
    return value


def _velocity_limit(do: PrinterExecutor, line: MarlinLine) -> None:
    """SET_VELOCITY_LIMIT: VELOCITY [mm/s], ACCEL [mm/s²], SQUARE_CORNER_VELOCITY [mm/s]."""
    limits = do.printer.limits
    if (speed := _number(line, "VELOCITY")) is not None and speed > 0.0:
        _, _, z, e = limits.speed
        limits = limits._replace(speed=(speed * MM, speed * MM, z, e))
    if (most := _number(line, "ACCEL")) is not None and most > 0.0:
        x, y, z, e = limits.acceleration
        limits = limits._replace(
            printing=most * MM, travel=most * MM, acceleration=(max(x, most * MM), max(y, most * MM), z, e)
        )
    if (corner := _number(line, "SQUARE_CORNER_VELOCITY")) is not None and corner > 0.0:
        limits = limits._replace(corner=corner * MM)
    do.limit(limits)


def _save(do: PrinterExecutor, line: MarlinLine) -> None:
    """SAVE_GCODE_STATE."""
    state, printer = do.control.state, do.printer
    saved = (state.g92, state.incremental, printer.e_relative, printer.e, printer.feed)
    printer.saved[line.settings.get("NAME", "default")] = saved


def _restore(do: PrinterExecutor, line: MarlinLine) -> None:
    """RESTORE_GCODE_STATE: names of places and modes as they were; the head stays (MOVE=1 is told)."""
    state, printer = do.control.state, do.printer
    saved = printer.saved.get(line.settings.get("NAME", "default"))
    if saved is None:
        raise Fault("GS106", "RESTORE_GCODE_STATE restores what was never saved", at=line.place)
    axes = do.control.axes()
    state.g92, state.incremental, printer.e_relative, printer.e, printer.feed = saved
    do.control.stay_at(axes)
    do.control.say_system()
    if line.settings.get("MOVE", "0") != "0":
        do.skip("macro RESTORE_GCODE_STATE MOVE", line)


def _retraction(do: PrinterExecutor, line: MarlinLine) -> None:
    """SET_RETRACTION: lengths [mm] and speeds [mm/s] of G10 and G11."""
    length, feed, lift = do.printer.retraction
    more, back = do.printer.recovery
    values = [
        _number(line, name) for name in ("RETRACT_LENGTH", "RETRACT_SPEED", "UNRETRACT_EXTRA_LENGTH", "UNRETRACT_SPEED")
    ]
    do.printer.retraction = (
        length if values[0] is None else values[0],
        feed if values[1] is None else 60.0 * values[1],
        lift,
    )
    do.printer.recovery = (more if values[2] is None else values[2], back if values[3] is None else 60.0 * values[3])


def _activate(do: PrinterExecutor, line: MarlinLine) -> None:
    """ACTIVATE_EXTRUDER EXTRUDER=extruder1: the second one."""
    name = line.settings.get("EXTRUDER", "extruder").lower()
    number = name.removeprefix("extruder")
    if name == number or not (number.isascii() and (number.isdigit() or not number)):
        do.skip("macro ACTIVATE_EXTRUDER", line)
        return
    do.choose_tool(int(number or "0"), line)


MACROS: Final[dict[str, Callable[[PrinterExecutor, MarlinLine], None]]] = {
    "SET_VELOCITY_LIMIT": _velocity_limit,
    "SAVE_GCODE_STATE": _save,
    "RESTORE_GCODE_STATE": _restore,
    "SET_RETRACTION": _retraction,
    "ACTIVATE_EXTRUDER": _activate,
}

"""M codes of a printer that change what is simulated: the meaning of E, limits, pace, tools, retraction."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from gcodesim import canon
from gcodesim.canon.printing import Four
from gcodesim.rs274.marlin.line import MarlinLine
from gcodesim.rs274.marlin.moves import dwell, number, set_offset
from gcodesim.rs274.marlin.printer import area_of
from gcodesim.units import MINUTE, MM

if TYPE_CHECKING:
    from gcodesim.rs274.marlin.executor import PrinterExecutor

Act = Callable[["PrinterExecutor", MarlinLine], None]
_XYZE: Final = "xyze"
_FULL_POWER: Final = 255.0


def _e_mode(relative: bool) -> Act:
    """M82, M83."""

    def act(do: PrinterExecutor, line: MarlinLine) -> None:
        do.printer.e_relative = relative

    return act


def _four(line: MarlinLine, known: Four, unit: float) -> Four:
    """The values of X Y Z E in a line, in `unit`; others stay."""
    values = [number(line, a) * unit if a in line.values else k for a, k in zip(_XYZE, known, strict=True)]
    return tuple(values)  # type: ignore[return-value]


def _accelerations(do: PrinterExecutor, line: MarlinLine) -> None:
    """M201: greatest accelerations of the axes [mm/s²]."""
    limits = do.printer.limits
    do.limit(limits._replace(acceleration=_four(line, limits.acceleration, do.control.state.unit)))


def _speeds(do: PrinterExecutor, line: MarlinLine) -> None:
    """M203: greatest speeds of the axes [mm/s], in RepRapFirmware [mm/min]."""
    limits = do.printer.limits
    unit = do.control.state.unit / (MINUTE if do.counts_minutes else 1.0)
    do.limit(limits._replace(speed=_four(line, limits.speed, unit)))


def _acceleration(do: PrinterExecutor, line: MarlinLine) -> None:
    """M204: P printing, R retracting, T travel; S is printing and travel."""
    limits, unit = do.printer.limits, do.control.state.unit

    def said(letter: str, known: float) -> float:
        value = line.get(letter)
        return known if value is None or value <= 0.0 else value * unit

    limits = limits._replace(
        printing=said("p", said("s", limits.printing)),
        travel=said("t", said("s", limits.travel)),
        retracting=said("r", limits.retracting),
    )
    do.limit(limits)


def _jerk(do: PrinterExecutor, line: MarlinLine) -> None:
    """M205: X Y Z E jerk [mm/s], J junction deviation [mm], which rules as soon as it is said."""
    limits, unit = do.printer.limits, do.control.state.unit
    if line.has(_XYZE):
        limits = limits._replace(jerk=_four(line, limits.jerk, unit), deviation=0.0, corner=0.0)
    if line.get("j") is not None:
        limits = limits._replace(deviation=number(line, "j") * unit, corner=0.0)
    do.limit(limits)


def _jerk_a_minute(do: PrinterExecutor, line: MarlinLine) -> None:
    """M566 of RepRapFirmware: greatest steps of speed [mm/min]."""
    limits = do.printer.limits
    do.limit(limits._replace(jerk=_four(line, limits.jerk, do.control.state.unit / MINUTE), deviation=0.0, corner=0.0))


def _retraction(do: PrinterExecutor, line: MarlinLine) -> None:
    """M207: S length, F feed, Z lift of G10; R and T are length and feed of G11 (RepRapFirmware)."""
    length, feed, lift = do.printer.retraction
    more, back = do.printer.recovery
    mm = do.control.state.unit / MM
    do.printer.retraction = (
        number(line, "s") * mm if "s" in line.values else length,
        number(line, "f") * mm if "f" in line.values else feed,
        number(line, "z") * mm if "z" in line.values else lift,
    )
    do.printer.recovery = (
        number(line, "r") * mm if "r" in line.values else more,
        number(line, "t") * mm if "t" in line.values else back,
    )


def _recovery(do: PrinterExecutor, line: MarlinLine) -> None:
    """M208: S further length, F feed of G11. In RepRapFirmware, how far the axes go."""
    if do.dialect.name == "reprapfirmware":
        do.skip(line.name, line)
        return
    more, back = do.printer.recovery
    mm = do.control.state.unit / MM
    do.printer.recovery = (
        number(line, "s") * mm if "s" in line.values else more,
        number(line, "f") * mm if "f" in line.values else back,
    )


def _pace(do: PrinterExecutor, line: MarlinLine) -> None:
    """M220: feeds in per cent; B keeps the value for R."""
    if line.get("s") is not None and number(line, "s") > 0.0:
        do.printer.pace = 0.01 * number(line, "s")


def _flow(do: PrinterExecutor, line: MarlinLine) -> None:
    """M221: flow in per cent, of tool T."""
    tool = line.get("t")
    if line.get("s") is not None:
        do.printer.flow[do.printer.tool if tool is None else int(tool)] = 0.01 * number(line, "s")


def _volumetric(do: PrinterExecutor, line: MarlinLine) -> None:
    """M200: with a diameter D, E words are mm³; D0 or S0 ends that."""
    tool = line.get("t")
    index = do.printer.tool if tool is None else int(tool)
    on = line.values.get("s", 1.0) != 0.0
    if line.get("d") is not None or not on:
        diameter = number(line, "d") if on else 0.0
        do.printer.areas[index] = area_of(diameter * do.control.state.unit / MM)
        do.diameters[index] = diameter * do.control.state.unit


def _offset(do: PrinterExecutor, line: MarlinLine) -> None:
    """M218: where nozzle T is, seen from the first."""
    tool = line.get("t")
    set_offset(do, line, do.printer.tool if tool is None else int(tool))


def _stop(do: PrinterExecutor, line: MarlinLine) -> None:
    """M0, M1: wait for somebody."""
    do.control.out.append(canon.Stop(span=do.control.span))


def _await_moves(do: PrinterExecutor, line: MarlinLine) -> None:
    """M400; on Bambu's printers, whose files are of Marlin's kind, with a time to wait besides, given as in G4."""
    if line.has("sp") and do.dialect.name == "marlin":
        dwell(do, line)
    else:
        do.skip(line.name, line)


def _message(do: PrinterExecutor, line: MarlinLine) -> None:
    """M117, M118."""
    do.control.out.append(canon.Message(span=do.control.span, text=line.text))


def _spindle(direction: int) -> Act:
    """M3, M4: S turns a minute. Firmware of Marlin's kind may count S to 255, or in per cent: then it says no speed."""

    def act(do: PrinterExecutor, line: MarlinLine) -> None:
        state, speed = do.control.state, line.get("s")
        if speed is not None and (speed > _FULL_POWER or do.dialect.name == "reprapfirmware"):
            state.speed = speed
        elif speed is not None or not state.speed:
            do.skip(line.name, line)
            return
        state.spindle = direction
        do.control.say_spindle()

    return act


def _spindle_off(do: PrinterExecutor, line: MarlinLine) -> None:
    """M5."""
    if not do.control.state.spindle:
        do.skip(line.name, line)
        return
    do.control.state.spindle = 0
    do.control.say_spindle()


def _end(do: PrinterExecutor, line: MarlinLine) -> None:
    """M2, M112: nothing more is done."""
    do.control.out.append(canon.End(span=do.control.span))
    do.control.finished = True


def _return(do: PrinterExecutor, line: MarlinLine) -> None:
    """M99: a macro ends."""
    if not do.leaves_macro():
        do.skip(line.name, line)


CODES: Final[dict[str, Act]] = {
    "M0": _stop,
    "M1": _stop,
    "M2": _end,
    "M99": _return,
    "M112": _end,
    "M3": _spindle(1),
    "M4": _spindle(-1),
    "M5": _spindle_off,
    "M82": _e_mode(False),
    "M83": _e_mode(True),
    "M117": _message,
    "M118": _message,
    "M200": _volumetric,
    "M201": _accelerations,
    "M203": _speeds,
    "M204": _acceleration,
    "M205": _jerk,
    "M207": _retraction,
    "M208": _recovery,
    "M218": _offset,
    "M220": _pace,
    "M221": _flow,
    "M400": _await_moves,
    "M566": _jerk_a_minute,
}

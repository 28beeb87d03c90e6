"""Moves of a printer: G0 to G3 with E, retraction, G92."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from gcodesim import canon
from gcodesim.rs274.arcs import arc_of
from gcodesim.rs274.block import Block
from gcodesim.rs274.circles import sweep_of
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.marlin.line import MarlinLine
from gcodesim.rs274.offsets import set_system
from gcodesim.rs274.state import ZERO, Vector
from gcodesim.rs274.words import Words
from gcodesim.units import INCH, MINUTE, MM

if TYPE_CHECKING:
    from gcodesim.rs274.marlin.executor import PrinterExecutor

_AXES: Final = "xyz"
_POINTS: Final = 6
"""Places that RepRapFirmware keeps for moves with R; 1 is that of a pause, 2 that of a change of tools."""
_OTHER_AXES: Final = frozenset("abcduvw")
"""Letters of axes beside X, Y and Z (Marlin AXIS4_NAME, RepRapFirmware M584); I, J and K belong to arcs."""
_NO_BLOCK: Final = Block(line=0, text="", words=[])


def move(do: PrinterExecutor, line: MarlinLine) -> None:
    """G0, G1: both go straight at F."""
    end, filament = ends_of(do, line)
    state = do.control.state
    if end[:3] != state.current[:3]:
        do.control.out.append(
            canon.LinearFeed(
                span=do.control.span,
                end=do.control.si_axes(do.control.tip(end)),
                block=do.control.block_number,
                word=line.name,
                feed=do.printer.speed * state.unit / MINUTE,
                extrude=filament,
            )
        )
        state.current = end
    elif filament:
        extrude(do, filament, do.printer.speed * state.unit / MINUTE)


def arc(do: PrinterExecutor, line: MarlinLine) -> None:
    """G2, G3: by I and J from the start, or by R; P counts full turns besides, as in Marlin."""
    end, filament = ends_of(do, line)
    control = do.control
    values = {letter: value for letter, value in line.values.items() if letter in "xyzijkrp" and value is not None}
    turns = values.pop("p", 0.0)
    if turns < 0.0 or not turns.is_integer():
        raise Fault("GS106", f"P{turns:g} counts no full turns", at=line.places["p"], value=turns, limit=0)
    if turns:
        values["p"] = turns + 1.0
    words = Words(_NO_BLOCK)
    words.values.update(values)
    code = 20 if line.name == "G2" else 30
    try:
        shape = arc_of(words, control, control.state.current, end, code)
    except Fault as fault:
        if isinstance(fault.at, str):
            fault.at = line.places.get(fault.at, line.place)
        raise
    state = control.state
    start = state.current
    control.out.append(
        canon.ArcFeed(
            span=control.span,
            end=control.si_axes(control.tip(end)),
            block=control.block_number,
            word=line.name,
            center=control.si_point((*shape.centre, end[2], *ZERO[3:])),
            normal=control.normal(2),
            ccw=shape.turns > 0,
            turns=abs(shape.turns),
            sweep=sweep_of((start[0], start[1]), (end[0], end[1]), shape),
            feed=do.printer.speed * state.unit / MINUTE,
            extrude=filament,
        )
    )
    state.current = end


def here(do: PrinterExecutor) -> tuple[float, float, float]:
    """Where the program stands [m]."""
    state = do.control.state
    x, y, z = (value * state.unit for value in state.current[:3])
    return x, y, z


def _kept_point(do: PrinterExecutor, line: MarlinLine, letter: str) -> int:
    """The number of a place that is kept for moves with R."""
    index = number(line, letter)
    if not index.is_integer() or not 0 <= index < _POINTS:
        message = f"{letter.upper()}{index:g} is no kept place; they count from 0 to {_POINTS - 1}"
        raise Fault("GS106", message, at=line.places[letter], value=index, limit=_POINTS - 1)
    return int(index)


def keep_point(do: PrinterExecutor, line: MarlinLine) -> None:
    """G60 of RepRapFirmware: keep where the program stands, as place S."""
    if do.dialect.name != "reprapfirmware":
        do.skip(line.name, line)
        return
    do.printer.points[_kept_point(do, line, "s") if "s" in line.values else 0] = here(do)


def ends_of(do: PrinterExecutor, line: MarlinLine) -> tuple[Vector, float]:
    """Where a move goes, and the filament [m] for it; words of other axes are told."""
    state, printer = do.control.state, do.printer
    for letter in of_other_axes(line):
        do.control.skip(f"{line.name} {letter.upper()}", line.places[letter])
    ends = list(state.current)
    begin: tuple[float, ...] | None = state.current if state.incremental else None
    if "r" in line.values and line.name in ("G0", "G1") and do.dialect.name == "reprapfirmware":
        kept = printer.points.get(_kept_point(do, line, "r"), ZERO[:3])
        begin = tuple(at / state.unit for at in kept)
    for axis, letter in enumerate(_AXES):
        if letter in line.values:
            value = number(line, letter)
            ends[axis] = value if begin is None else begin[axis] + value
    if "f" in line.values:
        feed = number(line, "f")
        if feed > 0.0:
            printer.feed = feed
    filament = 0.0
    if "e" in line.values:
        value = sum(line.lists.get("e", (number(line, "e"),)))  # of a tool that mixes
        step = value if printer.e_relative else value - printer.e
        printer.e = printer.e + value if printer.e_relative else value
        filament = printer.filament(step, state.unit)
    return tuple(ends), filament  # type: ignore[return-value]


def of_other_axes(line: MarlinLine) -> list[str]:
    """The letters of a line that belong to axes beside X, Y and Z."""
    return [letter for letter in line.values if letter in _OTHER_AXES]


def number(line: MarlinLine, letter: str) -> float:
    """The number of a letter that must have one."""
    value = line.values[letter]
    if value is None:
        raise Fault("GS004", f"{letter.upper()} has no number", at=line.places[letter])
    return value


def extrude(do: PrinterExecutor, length: float, feed: float, by_firmware: bool = False) -> None:
    """Filament alone: `length` [m] at `feed` [m/s]."""
    if length:
        event = canon.Extrude(
            span=do.control.span, length=length, feed=feed, limits=do.printer.limits, by_firmware=by_firmware
        )
        do.control.out.append(event)


def retract(do: PrinterExecutor, line: MarlinLine) -> None:
    """G10: retraction by the firmware; with L2 or L20 a work system, with other words a tool (RepRapFirmware)."""
    if line.get("l") in (2.0, 20.0):
        _set_system(do, line)
        return
    if line.has("psrxyzl"):
        _set_tool(do, line)
        return
    printer = do.printer
    if printer.is_retracted:
        return
    printer.is_retracted = True
    length, feed, lift = printer.retraction
    extrude(do, -length * MM, feed * MM / MINUTE, by_firmware=True)
    _lift(do, lift)


def recover(do: PrinterExecutor, line: MarlinLine) -> None:
    """G11."""
    printer = do.printer
    if not printer.is_retracted:
        return
    printer.is_retracted = False
    length, _, lift = printer.retraction
    more, feed = printer.recovery
    _lift(do, -lift)
    extrude(do, (length + more) * MM, feed * MM / MINUTE, by_firmware=True)


def _lift(do: PrinterExecutor, lift: float) -> None:
    """Raise the head by `lift` [mm]; the program does not know of it, but nothing else moves in between."""
    if not lift:
        return
    state, control = do.control.state, do.control
    shift = list(state.g92)
    shift[2] += lift * MM / state.unit
    state.g92 = tuple(shift)  # type: ignore[assignment]
    end = control.si_axes(control.tip(state.current))
    feed = do.printer.limits.speed[2]
    control.out.append(canon.LinearFeed(span=control.span, end=end, block=control.block_number, word="G10", feed=feed))


def _set_tool(do: PrinterExecutor, line: MarlinLine) -> None:
    """G10 P… of RepRapFirmware: offsets of a nozzle move it, temperatures do not matter here."""
    if line.has("sr"):
        do.skip("G10 S", line)
    if line.has("xyz"):
        tool = line.get("p")
        set_offset(do, line, do.printer.tool if tool is None else int(tool))


def _set_system(do: PrinterExecutor, line: MarlinLine) -> None:
    """G10 L2: where the zero of work system P is, from machine zero; L20: what the place at hand is called in it."""
    words = Words(_NO_BLOCK)
    said = {name: number(line, name) for name in "lpxyz" if name in line.values}
    words.values.update({"p": 0.0, **said})
    try:
        set_system(words, do.control, round(words.values["l"]))
    except Fault as fault:
        if isinstance(fault.at, str):
            fault.at = line.places.get(fault.at, line.place)
        raise


def choose_system(do: PrinterExecutor, line: MarlinLine) -> None:
    """G54 to G59.3: another work system; nothing moves."""
    whole, _, further = line.name[1:].partition(".")
    do.control.use_system(int(whole) - 53 + int(further or 0))


def set_offset(do: PrinterExecutor, line: MarlinLine, tool: int) -> None:
    """Where a nozzle is, seen from the first one [program units].

    M218 of Marlin and G10 of RepRapFirmware count alike: there, the place that a program names is that of the head
    plus the offset (GCodes.cpp, ToolOffsetInverseTransform).
    """
    offset = list(do.printer.offset_of(tool))
    for axis, letter in enumerate(_AXES):
        if letter in line.values:
            offset[axis] = number(line, letter)
    do.printer.offsets[tool] = tuple(offset)  # type: ignore[assignment]


def set_position(do: PrinterExecutor, line: MarlinLine) -> None:
    """G92: what the present place is called; nothing moves."""
    state, printer = do.control.state, do.printer
    every = not line.has("xyze")
    if "e" in line.values or every:
        printer.e = 0.0 if every else number(line, "e")
    shift, here = list(state.g92), list(state.current)
    for axis, letter in enumerate(_AXES):
        if letter in line.values or every:
            value = 0.0 if every else number(line, letter)
            shift[axis] += here[axis] - value
            here[axis] = value
    if tuple(here) != state.current:
        state.g92, state.current = tuple(shift), tuple(here)  # type: ignore[assignment]
        do.control.say_system()


def dwell(do: PrinterExecutor, line: MarlinLine) -> None:
    """G4: S in seconds, P in milliseconds; S counts where both stand."""
    seconds = line.get("s")
    if seconds is None:
        seconds = (line.get("p") or 0.0) * 1e-3
    do.control.dwell(seconds)


def nothing(do: PrinterExecutor, line: MarlinLine) -> None:
    """A command that changes nothing that is simulated, or that is in force anyway."""


def change_unit(do: PrinterExecutor, unit: float) -> None:
    """Count in `unit` [m] from here on; nothing moves."""
    old = do.control.state.unit
    do.control.change_unit(unit)
    do.printer.e *= old / unit
    do.printer.feed *= old / unit


def _unit(unit: float) -> Callable[[PrinterExecutor, MarlinLine], None]:
    return lambda do, line: change_unit(do, unit)


def _distance(incremental: bool) -> Callable[[PrinterExecutor, MarlinLine], None]:
    def act(do: PrinterExecutor, line: MarlinLine) -> None:
        do.control.state.incremental = incremental
        if do.e_follows_distance:
            do.printer.e_relative = incremental

    return act


def _plane(plane: int) -> Callable[[PrinterExecutor, MarlinLine], None]:
    def act(do: PrinterExecutor, line: MarlinLine) -> None:
        if plane != 170:
            raise Fault("GS105", f"{line.name} chooses a plane in which a printer draws no arcs", at=line.place)

    return act


SYSTEMS: Final = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")
"""Work systems of RepRapFirmware."""

MOVES: Final[dict[str, Callable[[PrinterExecutor, MarlinLine], None]]] = {
    "G2": arc,
    "G3": arc,
    "G4": dwell,
    "G10": retract,
    "G11": recover,
    "G17": _plane(170),
    "G18": _plane(180),
    "G19": _plane(190),
    "G20": _unit(INCH),
    "G21": _unit(MM),
    "G90": _distance(False),
    "G91": _distance(True),
    "G60": keep_point,
    "G92": set_position,
    "G94": nothing,
}

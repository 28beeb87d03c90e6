"""Moves of a printer to places of the machine itself: homing, ends of the axes, G53."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from gcodesim import canon
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.marlin.line import MarlinLine
from gcodesim.rs274.marlin.moves import ends_of, move, number, of_other_axes
from gcodesim.rs274.tool_table import ToolEntry
from gcodesim.units import MINUTE, MM

if TYPE_CHECKING:
    from gcodesim.rs274.marlin.executor import PrinterExecutor

_AXES: Final = "xyz"
_TO_ENDS: Final = (1.0, 3.0, 4.0)
"""H of moves that end at a switch: to home, to measure the axis, to find the switch (RepRapFirmware, G1)."""
_STRAIGHT: Final = (0.0, 1.0)


def straight(do: PrinterExecutor, line: MarlinLine) -> None:
    """G0, G1, in RepRapFirmware also to the switches at the ends of the axes."""
    if do.dialect.name == "reprapfirmware" and line.get("h") in _TO_ENDS:
        _to_axis_ends(do, line)
    else:
        move(do, line)


def _to_axis_ends(do: PrinterExecutor, line: MarlinLine) -> None:
    """G1 H1, H3, H4: each axis that is named goes to its end on that side, however far the program says.

    Such programs name more than the axis has, so that the switch is met from everywhere.
    """
    state = do.control.state
    wanted, _ = ends_of(do, line)
    end = list(state.current)
    for axis, letter in enumerate(_AXES):
        way = wanted[axis] - state.current[axis]
        if letter not in line.values or way == 0.0:
            continue
        place = _axis_end(do, axis, upper=way > 0.0)
        if place is None:
            do.control.skip(f"{line.name} H{line.get('h'):g}", line.places[letter])
        else:
            end[axis] = place / state.unit + do.first_origin[axis] / state.unit - state.origin[axis] - state.g92[axis]
    _go(do, tuple(end), line.name, do.printer.speed * state.unit / MINUTE)


def _axis_end(do: PrinterExecutor, axis: int, *, upper: bool) -> float | None:
    """Where X, Y or Z ends [m], seen from where G28 goes; None where nobody has said it.

    That is what M208 said; else the lower end is 0, where G28 goes, and the upper one that of the cell's machine.
    """
    said = {} if do.meta is None else do.meta.machine.said.limits[upper]
    if axis in said:
        return said[axis] * MM
    if not upper:
        return 0.0
    travel = do.settings.travel.get(_AXES[axis].upper())
    return None if travel is None else travel[1] - do.first_origin[axis]


def _nozzle_from_first(do: PrinterExecutor) -> list[float]:
    """Where the nozzle in use is [m] along X, Y and Z, seen from the first one."""
    first = do.control.tools.get(do.first_number, ToolEntry(number=0)).offset
    unit = do.control.state.unit
    return [at - by * unit for at, by in zip(first[:3], do.control.state.tool_offset[:3], strict=True)]


def _go(do: PrinterExecutor, end: tuple[float, ...], word: str, feed: float) -> None:
    """Go straight to `end` [program units] at `feed` [m/s], without filament."""
    control = do.control
    if end == control.state.current:
        return
    axes = control.si_axes(control.tip(end))  # type: ignore[arg-type]
    control.out.append(canon.LinearFeed(span=control.span, end=axes, block=control.block_number, word=word, feed=feed))
    control.state.current = end  # type: ignore[assignment]


def _forget_shift(do: PrinterExecutor, axes: Iterable[int]) -> None:
    """Let nothing be left of G92 in these axes; the nozzle stays where it is."""
    state = do.control.state
    shift, there = list(state.g92), list(state.current)
    for axis in axes:
        there[axis] += shift[axis]
        shift[axis] = 0.0
    state.g92, state.current = tuple(shift), tuple(there)  # type: ignore[assignment]
    do.control.say_system()


def home(do: PrinterExecutor, line: MarlinLine) -> None:
    """G28: X and Y go to 0 first, then Z, so that the nozzle meets nothing on its way; shifts of G92 are forgotten.

    0 is that of the work system that was active at the start, wherever the program has put others.
    """
    control = do.control
    state = control.state
    named = [letter in line.values for letter in _AXES]
    if not any(named):
        if do.dialect.name == "reprapfirmware" and of_other_axes(line):
            do.skip("G28 of another axis", line)
            return
        named = [True, True, True]
    _forget_shift(do, [axis for axis in range(3) if named[axis]])
    for axes in ((0, 1), (2,)):
        end = list(state.current)
        for axis in axes:
            if named[axis]:
                end[axis] = do.first_origin[axis] / state.unit - state.origin[axis]
        if tuple(end) != state.current:
            control.rapid(tuple(end), "G28")  # type: ignore[arg-type]


def probe(do: PrinterExecutor, line: MarlinLine) -> None:
    """G30 of RepRapFirmware: down to the bed, which is Z0 of the machine, and up by the dive height (M558 H).

    With P it measures one point of many, and with S an offset of the probe; that is not simulated.
    """
    if do.dialect.name != "reprapfirmware" or do.meta is None or line.has("pskxyz"):
        do.skip(line.name, line)
        return
    control, said = do.control, do.meta.machine.said
    state = control.state
    _forget_shift(do, [2])
    bed = do.first_origin[2] / state.unit - state.origin[2]
    _go(do, (*state.current[:2], bed, *state.current[3:]), "G30", said.probe_speed * MM / MINUTE)
    up = bed + said.dive_height * MM / state.unit
    _go(do, (*state.current[:2], up, *state.current[3:]), "G30", do.printer.limits.speed[2])


def machine_place(do: PrinterExecutor, line: MarlinLine) -> None:
    """G53 G0 or G53 G1: absolute words are places of the machine, without work system.

    Marlin leaves the shift of G92 out as well. In RepRapFirmware a G92 says where the machine itself stands, and the
    offset of the nozzle is left out (GCodes.cpp, DoStraightMove). A G53 alone, and one of Klipper, move nothing.
    """
    code = line.get("g")
    if do.dialect.name == "klipper" or code is None:
        do.skip(line.name, line)
        return
    if code not in _STRAIGHT:
        raise Fault("GS109", "G53 works with G0 and G1 only", at=line.places["g"], hint="name G0 or G1 in the block")
    control = do.control
    state = control.state
    values = {letter: value for letter, value in line.values.items() if letter != "g"}
    if not state.incremental:
        is_duet = do.dialect.name == "reprapfirmware"
        nozzle = _nozzle_from_first(do) if is_duet else [0.0, 0.0, 0.0]
        for axis, letter in enumerate(_AXES):
            if letter in values:
                shift = 0.0 if is_duet else state.g92[axis]
                zero = do.first_origin[axis] / state.unit - state.origin[axis]
                values[letter] = number(line, letter) + zero - shift + nozzle[axis] / state.unit
    straight(do, replace(line, name=f"G{int(code)}", values=values))


MACHINE_MOVES: Final[dict[str, Callable[[PrinterExecutor, MarlinLine], None]]] = {
    "G0": straight,
    "G1": straight,
    "G28": home,
    "G30": probe,
    "G53": machine_place,
}

"""The lines that bring a printer to the state which a print has reached: what is heated and blown, limits, place, E.

As one takes up a print by hand: heat first, so that the nozzle comes off what it stands in; lift; home X and Y only,
because the part is in the way of Z; then across above the part and down. Settings are said again in the program's own
words, in their order, so that nothing has to be known of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from gcodesim.frozen import frozen
from gcodesim.rs274.marlin.said import HEATERS
from gcodesim.rs274.state import AXES, Vector, add
from gcodesim.units import INCH, MINUTE, MM

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.marlin.printer import Printer


_DECIMALS: Final = {MM: 6, INCH: 8}

_WAIT: Final = "M116"
"""Waits for all heaters (RepRapFirmware)."""


@frozen
class PrintApproach:
    """How the head comes to the place: across at `high` [m, Z of M] and `travel` [m/s], with `drawn` [m] of filament
    drawn back by E words. `moves`: the program has moved before."""

    moves: bool
    high: float = 0.0
    travel: float = 0.0
    drawn: float = 0.0


def print_preamble(control: Control, printer: Printer, approach: PrintApproach) -> list[str]:
    """Lines after which a printer that is switched on, and has executed nothing, is in the state of both."""
    state = control.state
    lines = ["G21", "G90", *_settings(printer), *_heat(printer)]
    if approach.moves:
        lines += _way(control, printer, approach)
    elif printer.tool:
        lines.append(f"T{printer.tool}")
    lines.append(f"G92 E{_written(control, printer.e)}")
    lines += [*(["G91"] if state.incremental else []), "M83" if printer.e_relative else "M82"]
    return [*lines, f"G1 F{_written(control, printer.feed)}"]


def _settings(printer: Printer) -> Iterator[str]:
    for (group, *_), line in printer.said.items():
        if group not in HEATERS and line not in ("G21", _WAIT):
            yield line


def _heat(printer: Printer) -> Iterator[str]:
    """All heaters at once, then wait for each."""
    wanted = [(key[0], words) for key, words in printer.said.items() if key[0] in HEATERS]
    for group, words in wanted:
        yield f"{group} {words}"
    for group, words in wanted:
        yield f"{HEATERS[group]} {words}"
    if any(line == _WAIT or group == "G10" for (group, *_), line in printer.said.items()):
        yield _WAIT


def _way(control: Control, printer: Printer, approach: PrintApproach) -> Iterator[str]:
    """Up, home, across, down; then the names of the place as the program has them."""
    state, lifted = control.state, printer.retraction[2] * MM / control.state.unit if printer.is_retracted else 0.0
    there = add(state.current, state.g92)
    x, y, z = there[0], there[1], there[2] - lifted
    slow = _feed(control, printer.limits.speed[2])
    high = max(approach.high / state.unit - state.origin[2], z)
    yield f"G1 Z{_written(control, high)} F{slow}"
    yield "G28 X Y"
    if printer.tool:
        yield f"T{printer.tool}"
    yield from _drawn(control, printer, approach.drawn)
    yield f"G1 X{_written(control, x)} Y{_written(control, y)} F{_feed(control, approach.travel)}"
    if z < high:
        yield f"G1 Z{_written(control, z)} F{slow}"
    if printer.is_retracted:
        yield "G10"
    if state.g92 != _lift_alone(lifted):
        yield "G92 " + " ".join(f"{letter.upper()}{_written(control, state.current[i])}" for i, letter in _XYZ)


_XYZ: Final = tuple(enumerate(AXES[:3]))


def _lift_alone(lifted: float) -> Vector:
    return (0.0, 0.0, lifted, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def _drawn(control: Control, printer: Printer, drawn: float) -> Iterator[str]:
    """Filament as far back in the nozzle as the program has it, so that it oozes nowhere."""
    if drawn > 0.0:
        step = drawn / printer.filament(1.0, control.state.unit)
        yield "M82"
        yield f"G92 E{_written(control, step)}"
        yield f"G1 E0 F{_written(control, printer.feed)}"


def _feed(control: Control, speed: float) -> str:
    return _written(control, speed * MINUTE / control.state.unit)


def _written(control: Control, value: float) -> str:
    text = f"{value:.{_DECIMALS[control.state.unit]}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text

"""The blocks that bring a control to the state which a program has reached: modes, offsets, tool, spindle, approach.

What a machinist writes by hand before a program is taken up again, in the order in which it is safe: modes without
any motion, then the tool, then up, across with the spindle turning, and down to the place. Words only where the
control has them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Final

from gcodesim.frozen import frozen
from gcodesim.rs274 import parameters as numbers
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.state import AXES, ZERO
from gcodesim.units import INCH, MINUTE, MM

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control

_DECIMALS: Final = {MM: 6, INCH: 8}
"""By unit: nobody sees a nanometre."""
_BLEND: Final = 640
_INVERSE_TIME, _PER_MINUTE = 930, 940
_SYSTEMS: Final = range(numbers.FIRST_SYSTEM, numbers.FIRST_SYSTEM + 180)
_LAST_OF_PROGRAM: Final = 5000


@frozen
class Approach:
    """Heights of the controlled point [m, Z of M]: `high` for ways across, `near` from which it goes down at a feed.

    `moves`: the program has moved before. `turned` are the letters of the rotary and further axes that it moves; `feed`
    [m/s] is that of its last feed move, 0 before any; `changed` says whether it has changed tools; `outputs` are those
    that it has set, digital such as `P1`, analog such as `E0`.
    """

    moves: bool
    high: float
    near: float
    turned: str = ""
    feed: float = 0.0
    changed: bool = True
    outputs: Mapping[str, float] = field(default_factory=dict)


def preamble(control: Control, approach: Approach) -> list[str]:
    """Blocks after which another control, which has executed nothing, is in the state of `control`."""
    words, first = _Words(control), control.fresh()
    blocks = [
        *_modes(control, words),
        *_memory(control, first, words),
        *_tool(control, approach, words),
        *_way(control, approach, words),
    ]
    blocks += _rest(control, approach, words, {word for block in blocks for word in block})
    return [" ".join(block) for block in blocks if block]


class _Words:
    """How words are written for a control: those that it has, with numbers as it reads them."""

    def __init__(self, control: Control) -> None:
        self._dialect = control.dialect
        self._decimals = _DECIMALS[control.state.unit]
        self._pointed = control.dialect.statements  # X10 may be ten increments there, X10. never is

    def g(self, *codes: int) -> list[str]:
        return [g_name(code).upper() for code in codes if code in self._dialect.g_groups]

    def m(self, *codes: int) -> list[str]:
        return [f"M{code}" for code in codes if code in self._dialect.m_groups]

    def number(self, value: float) -> str:
        text = f"{value:.{self._decimals}f}".rstrip("0").rstrip(".")
        return "0" if text == "-0" else text

    def length(self, value: float) -> str:
        text = self.number(value)
        return f"{text}." if self._pointed and "." not in text else text

    def axes(self, letters: str, point: Sequence[float]) -> list[str]:
        return [f"{letter.upper()}{self.length(point[AXES.index(letter)])}" for letter in letters]


def _modes(control: Control, words: _Words) -> Iterator[list[str]]:
    """Units, plane and distance as the approach needs them, and nothing left over of whatever was run before."""
    state = control.state
    unit = 210 if state.unit == MM else 200
    yield words.g(unit, state.plane, 400, 800, 900, _PER_MINUTE)
    changed = [state.retract] if state.retract != control.fresh().state.retract else []
    yield words.g(901 if state.centre_absolute else 911, *changed)
    path = words.g(state.path)
    if path and state.path == _BLEND and state.path_tolerance:
        path += [f"P{words.number(state.path_tolerance / state.unit)}"]
        if state.path_naive != state.path_tolerance:
            path += [f"Q{words.number(state.path_naive / state.unit)}"]
    yield path


def _memory(control: Control, first: Control, words: _Words) -> Iterator[list[str]]:
    """Parameters and offsets as the program has set them, the work system, and the shift of G52 or G92."""
    now, before = control.parameters, first.parameters
    for number, value in sorted(now.numbers.items()):
        if number < _LAST_OF_PROGRAM and value != before.numbers.get(number, 0.0):
            yield [f"#{number}={words.number(value)}"]
    for stores, known in ((now.globals, before.globals), (now.locals, before.locals)):
        for name, value in sorted(stores.items()):
            if value != known.get(name):
                yield [f"#<{name}>={words.number(value)}"]
    changed = {
        (number - _SYSTEMS.start) // 20 + 1
        for number in _SYSTEMS
        if now.numbers.get(number, 0.0) != before.numbers.get(number, 0.0)
    }
    for system in sorted(changed):
        offset, turn = control.system_offset(system)
        letters = "".join(letter for letter, value in zip(AXES, offset, strict=True) if value or letter in "xyz")
        turned = [f"R{words.number(turn)}"] if control.dialect.turned_systems else []
        yield [*words.g(100), "L2", f"P{system}", *words.axes(letters, offset), *turned]
    system = control.state.system
    codes = (540, 550, 560, 570, 580, 590, 591, 592, 593)
    yield words.g(codes[system - 1]) if system <= len(codes) else ["G54.1", f"P{system - 100}"]
    shift = control.shift()
    if shift != ZERO:
        letters = "".join(letter for letter, value in zip(AXES, shift, strict=True) if value)
        yield [*words.g(520), *words.axes(letters, shift)]


def _tool(control: Control, approach: Approach, words: _Words) -> Iterator[list[str]]:
    state = control.state
    if approach.changed and words.m(6):
        yield [f"T{state.tool}", *words.m(6)]
    if state.selected >= 0 and state.selected != state.tool:
        yield [f"T{state.selected}"]


def _length(control: Control, words: _Words) -> list[str]:
    """The word for the length in force: none where the program never says one."""
    state = control.state
    if control.auto_length:
        return []
    if state.tool_offset == ZERO:
        return words.g(490)
    number = control.length_number()
    if number is not None:
        return [*words.g(430), f"H{number}"]
    letters = "".join(letter for letter, value in zip(AXES, state.tool_offset, strict=True) if value)
    return [*words.g(431), *words.axes(letters, state.tool_offset)]


def _spindle(control: Control, words: _Words) -> Iterator[list[str]]:
    state = control.state
    if state.speed and state.surface_speed:
        cap = [] if state.surface_speed_cap is None else [f"D{words.number(state.surface_speed_cap)}"]
        yield [*words.g(960), *cap, f"S{words.number(state.speed)}"]
    elif state.speed:
        yield [f"S{words.number(state.speed)}"]
    if state.spindle:
        yield words.m(3 if state.spindle > 0 else 4)
    yield words.m(*([7] if state.mist else []), *([8] if state.flood else []))


def _way(control: Control, approach: Approach, words: _Words) -> Iterator[list[str]]:
    """Up, across, down to where the program has been, with spindle and coolant on before anything is near.

    The last block is one of the motion with which the program goes on.
    """
    state = control.state
    if not approach.moves:
        yield _length(control, words)
        yield from _spindle(control, words)
        return
    x, y, z, *others = control.tip(state.current)
    high, near = (
        control.point_of((x, y, max(height / state.unit, z), *others))[2]  # type: ignore[arg-type]
        for height in (approach.high, approach.near)
    )
    length = _length(control, words)
    if length[:1] == words.g(431):  # has axis words of its own
        yield length
        length = []
    yield [*words.g(0), *length, *_height(high, words)]
    yield from _spindle(control, words)
    yield [*words.g(0), *words.axes(f"xy{approach.turned}", state.current)]
    if near < high:
        yield [*words.g(0), *_height(near, words)]
    feed = _feed(control, approach, words)
    here, fed = _height(state.current[2], words), state.motion != 0 and bool(feed)
    if near > state.current[2]:
        yield [*words.g(10), *here, *feed] if fed else [*words.g(0), *here]
    if state.motion == 10 and not (near > state.current[2] and fed):
        yield [*words.g(10), *here, *feed]


def _height(value: float, words: _Words) -> list[str]:
    return words.axes("z", (0.0, 0.0, value))


def _feed(control: Control, approach: Approach, words: _Words) -> list[str]:
    """F per minute: as the program has it, else that of its last feed move."""
    state = control.state
    own = state.feed * state.feed_unit if state.feed_mode == _PER_MINUTE and state.feed else approach.feed * MINUTE
    return [f"F{words.length(own / state.unit)}"] if own > 0.0 else []


def _rest(control: Control, approach: Approach, words: _Words, said: Collection[str]) -> Iterator[list[str]]:
    """Modes that would have been in the way of the approach, and the feed unless it is among the words `said`."""
    state = control.state
    if state.feed_mode != _PER_MINUTE:
        yield words.g(state.feed_mode)
    feed = f"F{words.length(state.feed * state.feed_unit / state.unit)}"
    if state.feed and state.feed_mode != _INVERSE_TIME and (feed not in said or state.feed_mode != _PER_MINUTE):
        yield [feed]
    for name, value in sorted(approach.outputs.items()):
        if name.startswith("P"):
            yield [*words.m(64 if value else 65), name]
        else:
            yield [*words.m(68), name, f"Q{words.number(value)}"]
    if state.incremental:
        yield words.g(910)

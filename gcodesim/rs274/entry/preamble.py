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
_INVERSE_TIME, _PER_MINUTE, _PER_TURN = 930, 940, 950
_DIAMETER, _RADIUS = 70, 80
_ON_TURRETS: Final = {_PER_MINUTE: 980, _PER_TURN: 990}
_NOT_ON_TURRETS: Final = frozenset((430, 490, 800, 900, 910))
_SAME: Final = 6e-8
"""[m] A control is told micrometres."""
_SYSTEMS: Final = range(numbers.FIRST_SYSTEM, numbers.FIRST_SYSTEM + 180)
_LAST_OF_PROGRAM: Final = 5000


@frozen
class RapidEnd:
    """Where a rapid of the approach ends: one axis `at` a place of the controlled point [m, in M], or all of `axes`
    where they are when the line is reached."""

    axes: str
    at: float | None = None


@frozen
class Approach:
    """The rapids to the place; the axis `last` goes the rest of the way, at a feed. Without `stops` nothing has moved.

    `turns`: the work turns, as on a lathe. `feed` [m/s] is that of the last feed move per minute, 0 before any;
    `changed` says whether the program has changed tools; `outputs` are those that it has set, digital such as `P1`,
    analog such as `E0`.
    """

    stops: Sequence[RapidEnd] = ()
    last: str = "z"
    turns: bool = False
    feed: float = 0.0
    changed: bool = True
    outputs: Mapping[str, float] = field(default_factory=dict)


def preamble(control: Control, approach: Approach) -> list[str]:
    """Blocks after which another control, which has executed nothing, is in the state of `control`."""
    words, first = _Words(control), control.fresh()
    blocks = [
        *_modes(control, approach, words),
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
        self._on_x = 2.0 if control.state.diameter or control.dialect.turret else 1.0

    def g(self, *codes: int) -> list[str]:
        """Words for codes of the milling control, as far as this one has them; turrets have others for feeds."""
        if self._dialect.turret:
            codes = tuple(_ON_TURRETS.get(code, code) for code in codes if code not in _NOT_ON_TURRETS)
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
        scales = {"x": self._on_x}
        return [
            f"{letter.upper()}{self.length(scales.get(letter, 1.0) * point[AXES.index(letter)])}" for letter in letters
        ]


def _modes(control: Control, approach: Approach, words: _Words) -> Iterator[list[str]]:
    """Units, plane and distance as the approach needs them, and nothing left over of whatever was run before."""
    state = control.state
    unit = 210 if state.unit == MM else 200
    turning = words.g(_DIAMETER if state.diameter else _RADIUS) if approach.turns and words.g(_DIAMETER) else []
    yield [*words.g(unit, state.plane), *turning, *words.g(400, 800, 900, _while_coming(control, approach))]
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
    if control.dialect.turret:
        if state.tool:
            yield [f"T{state.tool:02d}{0 if state.tool_offset == ZERO else control.length_number() or 0:02d}"]
        return
    if approach.changed and words.m(6):
        yield [f"T{state.tool}", *words.m(6)]
    if state.selected >= 0 and state.selected != state.tool:
        yield [f"T{state.selected}"]


def _length(control: Control, words: _Words) -> list[str]:
    """The word for the length in force: none where the program never says one."""
    state = control.state
    if control.auto_length or control.dialect.turret:  # whose T word says it
        return []
    if state.tool_offset == ZERO:
        return words.g(490)
    number = control.length_number()
    if number is not None:
        return [*words.g(430), f"H{number}"]
    letters = "".join(letter for letter, value in zip(AXES, state.tool_offset, strict=True) if value)
    return [*words.g(431), *words.axes(letters, state.tool_offset)]


def _spindle(control: Control, approach: Approach, words: _Words) -> Iterator[list[str]]:
    state = control.state
    cap = [] if state.surface_speed_cap is None else [words.number(state.surface_speed_cap)]
    if cap and control.dialect.turret:
        yield [*words.g(500), f"S{cap.pop()}"]
    if state.speed and state.surface_speed:
        yield [*words.g(960), *(f"D{speed}" for speed in cap), f"S{words.number(state.speed)}"]
    elif state.speed:
        yield [*(words.g(970) if approach.turns else []), f"S{words.number(state.speed)}"]
    if state.spindle:
        yield words.m(3 if state.spindle > 0 else 4)
    yield words.m(*([7] if state.mist else []), *([8] if state.flood else []))


def _way(control: Control, approach: Approach, words: _Words) -> Iterator[list[str]]:
    """Clear of the part, across, near to where the program has been; spindle and coolant are on before that.

    The last block is one of the motion with which the program goes on.
    """
    state = control.state
    length = _length(control, words)
    if not approach.stops or length[:1] == words.g(431):  # which has axis words of its own
        yield length
        length = []
    if not approach.stops:
        yield from _spindle(control, approach, words)
        return
    for number, stop in enumerate(approach.stops):
        yield [*words.g(0), *([] if number else length), *words.axes(stop.axes, _point_of(stop, control))]
        if not number:
            yield from _spindle(control, approach, words)
    feed = _feed(control, approach, words)
    there, fed = _is_there(approach, control), state.motion != 0 and bool(feed)
    here = words.axes(approach.last, state.current)
    if not there:
        yield [*words.g(10), *here, *feed] if fed else [*words.g(0), *here]
    if state.motion == 10 and not (fed and not there):
        yield [*words.g(10), *here, *feed]


def _point_of(stop: RapidEnd, control: Control) -> Sequence[float]:
    """The place of a stop in the active work system."""
    if stop.at is None:
        return control.state.current
    tip = list(control.tip(control.state.current))
    tip[AXES.index(stop.axes)] = stop.at / control.state.unit
    return control.point_of(tuple(tip))  # type: ignore[arg-type]


def _is_there(approach: Approach, control: Control) -> bool:
    """Whether the rapids end at the place itself."""
    stop = next(stop for stop in reversed(approach.stops) if approach.last in stop.axes)
    here = control.tip(control.state.current)[AXES.index(approach.last)] * control.state.unit
    return stop.at is None or abs(stop.at - here) < _SAME


def _feed(control: Control, approach: Approach, words: _Words) -> list[str]:
    """F per minute: as the program has it, else that of its last feed move."""
    state = control.state
    as_said = state.feed_mode == _while_coming(control, approach)
    own = state.feed * state.feed_unit if as_said and state.feed else approach.feed * MINUTE
    return [f"F{words.length(own / state.unit)}"] if own > 0.0 else []


def _while_coming(control: Control, approach: Approach) -> int:
    """The feed mode of the approach: per minute; on a lathe, whose spindle turns by then, the program's own."""
    own = control.state.feed_mode
    return own if approach.turns and own == _PER_TURN else _PER_MINUTE


def _rest(control: Control, approach: Approach, words: _Words, said: Collection[str]) -> Iterator[list[str]]:
    """Modes that would have been in the way of the approach, and the feed unless it is among the words `said`."""
    state = control.state
    if state.feed_mode != _while_coming(control, approach):
        yield words.g(state.feed_mode)
    feed = f"F{words.length(state.feed * state.feed_unit / state.unit)}"
    if (
        state.feed
        and state.feed_mode != _INVERSE_TIME
        and (feed not in said or state.feed_mode != _while_coming(control, approach))
    ):
        yield [feed]
    for name, value in sorted(approach.outputs.items()):
        if name.startswith("P"):
            yield [*words.m(64 if value else 65), name]
        else:
            yield [*words.m(68), name, f"Q{words.number(value)}"]
    if state.incremental:
        yield words.g(910)

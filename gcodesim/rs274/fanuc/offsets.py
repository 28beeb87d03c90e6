"""Fanuc's offsets: tool length, work systems, G10, G28, G30, G52, G92."""

from __future__ import annotations

from dataclasses import replace

from gcodesim import canon
from gcodesim.canon.systems import ADDITIONAL, MOST_ADDITIONAL
from gcodesim.rs274 import parameters as homes
from gcodesim.rs274 import tool_point
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.dialects.fanuc import FIXTURES
from gcodesim.rs274.dialects.linuxcnc import LENGTH, NON_MODAL, SYSTEM
from gcodesim.rs274.dialects.systems import first_of_system
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fanuc import fixture, polar
from gcodesim.rs274.fanuc import variables as numbers
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fanuc.vectors import BY_VECTOR
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import AXES, ZERO, Vector, add, subtract
from gcodesim.rs274.words import Words, place_of

_SYSTEM_INDEX = {540: 1, 550: 2, 560: 3, 570: 4, 580: 5, 590: 6}
_UNTIL_G11 = (3, 50, 52)  # tool life, parameters of the control: the blocks up to G11 are data
_TOOL_DATA = {  # by the L of G10
    1: numbers.LENGTH_WEAR,
    10: numbers.LENGTH_GEOMETRY,
    11: numbers.LENGTH_WEAR,
    12: numbers.RADIUS_GEOMETRY,
    13: numbers.RADIUS_WEAR,
}


def tool_length(words: Words, control: FanucControl) -> None:
    """G43 H, G44 H, G49; an H alone changes the offset in force."""
    code = words.g.get(LENGTH)
    state = control.state
    if code is None and ("h" not in words.values or state.length_mode == 490):
        return
    mode = state.length_mode if code is None else code
    if mode in tool_point.CENTRE_POINT:
        fixture.refuse(control, g_name(mode))
    number = round(words.values.get("h", state.length_number))
    if "h" in words.values and number and mode != 490:
        _check_number(number, "h", control)
    length = control.tool_data(numbers.LENGTH_GEOMETRY, number) + control.tool_data(numbers.LENGTH_WEAR, number)
    z = control.program_units(length, 2) if number else 0.0
    tool_point.switch(control, on=False)
    axes = control.axes()
    state.length_mode, state.length_number = mode, number
    if control.auto_length and (mode == 490 or number == 0):
        tool_point.switch(control, on=state.upright)
        return  # touched off with the tool, not measured
    state.tool_offset = ZERO if mode == 490 else (0.0, 0.0, -z if mode == 440 else z, *ZERO[3:])
    control.stay_at(axes)
    control.say_tool_offset()
    if state.upright:
        tool_point.switch(control, on=True)
    elif mode in tool_point.CENTRE_POINT:
        if tool_point.is_possible(control, by_vector=mode == BY_VECTOR):
            tool_point.switch(control, on=True)
        elif code is not None:
            name = g_name(code)
            control.skip(name.upper(), place_of(words.block, name))


def _check_number(number: int, letter: str, control: FanucControl) -> None:
    """An offset number is known when the tool table or a G10 has it."""
    kinds = _TOOL_DATA.values()
    if number in control.tools or any(kind + number in control.parameters.numbers for kind in kinds):
        return
    hint = "set it with G10, or name a tool table or a cell"
    raise Fault("GS160", f"nothing is stored under the offset {letter.upper()}{number}", at=letter, hint=hint)


def check_radius_number(words: Words, control: FanucControl) -> float:
    """Tool radius of the D in force; program units."""
    state = control.state
    number = round(words.values.get("d", state.radius_number))
    if number:
        _check_number(number, "d", control)
    state.radius_number = number
    if not number:
        return 0.0
    radius = control.tool_data(numbers.RADIUS_GEOMETRY, number) + control.tool_data(numbers.RADIUS_WEAR, number)
    return control.program_units(radius, 2)


def work_system(words: Words, control: FanucControl) -> None:
    """G54 to G59, G54.1 Pn or G54 Pn, on Haas controls G154 Pn."""
    code = words.g.get(SYSTEM)
    if code is None:
        return
    if control.state.side:
        raise Fault("GS150", "the work system cannot change in cutter compensation", at=g_name(code), hint="G40 first")
    index = _SYSTEM_INDEX.get(code, 0)
    if code in (541, 1540) or (code == 540 and "p" in words.values):
        who = "G154" if code == 1540 else "G54.1"
        words.need("p", "GS105", who, "P is the number of the additional system")
        number = words.whole("p", who)
        assert number is not None
        _check_additional(number, who)
        del words.values["p"]
        index = ADDITIONAL + number
    control.use_system(index)


def _check_additional(number: int, who: str) -> None:
    last = MOST_ADDITIONAL
    if not 1 <= number <= last:
        raise Fault("GS106", f"{who} P{number}: P runs from 1 to {last}", at="p", value=number, limit=last)


def non_modal(words: Words, control: FanucControl) -> None:
    """G10, G27 to G30, G52, G92."""
    code = words.g.get(NON_MODAL)
    act = _ACTS.get(code) if code is not None else None
    if act is not None:
        act(words, control)


# -- G10


def _set_data(words: Words, control: FanucControl) -> None:
    level = words.whole("l", "G10")
    if level in _UNTIL_G11:
        control.skip(f"G10 L{level}", place_of(words.block, "g10"))
        control.writing = True
        return
    words.need("p", "GS105", "G10", "P is the number of what is set")
    number = words.whole("p", "G10")
    assert number is not None
    if level in (2, 20, 21):
        _set_system(words, control, level, number)
    elif level in _TOOL_DATA:
        _set_tool(words, control, _TOOL_DATA[level], number)
    else:
        message = "G10 needs the word L" if level is None else f"G10 L{level} is not simulated"
        hint = "L2, L20, L21, L10 to L13 and L1 are, and L3, L50, L52 are passed over"
        raise Fault("GS105", message, at="g10" if level is None else "l", hint=hint)


def _set_system(words: Words, control: FanucControl, level: int, number: int) -> None:
    if level == 20:
        _check_additional(number, "G10 L20")
        first = first_of_system(ADDITIONAL + number)
    elif level == 21:
        if not 1 <= number <= len(FIXTURES):
            last = len(FIXTURES)
            raise Fault("GS106", f"G10 L21 P{number}: P runs from 1 to {last}", at="p", value=number, limit=last)
        first = FIXTURES[number - 1]
    elif 0 <= number <= 6:
        first = first_of_system(number) if number else numbers.EXTERNAL
    else:
        raise Fault("GS106", f"G10 L2 P{number}: P runs from 0 to 6", at="p", value=number, limit=6)
    for axis, letter in enumerate(AXES[:6]):
        if letter in words.values:
            value = control.machine_units(words.values[letter], axis)
            if control.state.incremental:
                value += control.parameters.numbers.get(first + axis, 0.0)
            control.parameters.set(first + axis, value)
    control.reframe()


def _set_tool(words: Words, control: FanucControl, kind: int, number: int) -> None:
    if not 1 <= number <= numbers.MOST_OFFSETS:
        raise Fault("GS106", f"G10 P{number}: offsets are numbered from 1 to {numbers.MOST_OFFSETS}", at="p")
    value = control.machine_units(words.need("r", "GS105", "G10", "R is the value"), 2)
    if control.state.incremental:
        value += control.tool_data(kind, number)
    control.parameters.set(kind + number, value)


# -- G28 and G30


def _go_home(words: Words, control: FanucControl) -> None:
    code = words.g[NON_MODAL]
    who = g_name(code).upper()
    if control.state.side:
        raise Fault("GS150", f"{who} is refused in cutter compensation", at=who.lower(), hint="say G40 first")
    named = set(words.values) if words.has_axes() else set(AXES)
    if not words.has_axes():
        message = f"{who} names no axis: all go home at once, as on a Haas; a Fanuc wants them named"
        hint = f"G91 {who} Z0 takes Z home from where it stands"
        control.warn("GS103", message, hint, place_of(words.block, who.lower()))
    first: int | None = homes.G28_HOME
    polar.refuse(words, control, who)
    if code == 300:
        which = words.whole("p", "G30") or 2
        if which not in (2, 3, 4):
            raise Fault("GS106", f"G30 P{which}: P is 2, 3 or 4", at="p", value=which)
        if which > 2:
            control.skip(f"G30 P{which}", place_of(words.block, "g30"))
        first = homes.G30_HOME if which == 2 else None
    if words.has_axes():
        control.rapid(end_point(words, control), who)
    control.via = control.axes()
    known = control.parameters.numbers
    home = ZERO if first is None else control.stored(first)
    axes = control.axes()
    end: Vector = tuple(  # type: ignore[assignment]
        home[axis] if letter in named else axes[axis] for axis, letter in enumerate(AXES)
    )
    unknown = first is None or not any(first + axis in known for axis in range(6))
    by_joints = unknown and control.settings.joint_home  # all of them, whichever axes are named
    control.rapid(control.at_home() if by_joints else control.point_of(subtract(end, control.length)), who)
    if unknown:
        last = control.out[-1]
        assert isinstance(last, canon.Rapid)
        control.out[-1] = replace(last, home=who)


def _check_home(words: Words, control: FanucControl) -> None:
    """G27: a rapid to a point, which a control compares with the reference point."""
    if not words.has_axes():
        raise Fault("GS103", "G27 needs the axes that go home", at="g27", hint="G27 X0 Y0 is a rapid to that point")
    polar.refuse(words, control, "G27")
    control.skip("G27", place_of(words.block, "g27"))
    control.rapid(end_point(words, control), "G27")


def _come_back(words: Words, control: FanucControl) -> None:
    """G29: from the reference point over the point that the last G28 or G30 went through."""
    if control.via is None:
        hint = "it comes back over the point that G28 went through"
        raise Fault("GS105", "G29 without a G28 or G30 before it", at="g29", hint=hint)
    polar.refuse(words, control, "G29")
    now, via = control.axes(), control.via
    over: Vector = tuple(  # type: ignore[assignment]
        via[axis] if letter in words.values else now[axis] for axis, letter in enumerate(AXES)
    )
    end = end_point(words, control)
    control.rapid(control.point_of(subtract(over, control.length)), "G29")
    control.rapid(end, "G29")


# -- G52 and G92


def _set_local(words: Words, control: FanucControl) -> None:
    _refuse(words, control, "G52")
    local = control.state.local
    control.reframe(local=tuple(words.values.get(letter, local[axis]) for axis, letter in enumerate(AXES)))


def _preset(words: Words, control: FanucControl) -> None:
    """The point where the tool stands reads as given; of the axes named, a G52 is taken back."""
    _refuse(words, control, "G92")
    state = control.state
    if state.turn is not None:
        raise Fault("GS106", "G92 is refused while G68 turns the system", at="g92", hint="say G69 first")
    local = _left_out(state.local, words)
    reads = add(state.current, subtract(state.local, local))
    wanted = [words.values.get(letter, reads[axis]) for axis, letter in enumerate(AXES)]
    control.reframe(preset=add(state.preset, subtract(reads, tuple(wanted))), local=local)  # type: ignore[arg-type]


def _clear_preset(words: Words, control: FanucControl) -> None:
    """G92.1: for the axes named, G92 and G52 are taken back."""
    _refuse(words, control, "G92.1")
    state = control.state
    control.reframe(preset=_left_out(state.preset, words), local=_left_out(state.local, words))


def _left_out(shift: Vector, words: Words) -> Vector:
    """`shift` without the axes that the block names."""
    return tuple(0.0 if letter in words.values else shift[axis] for axis, letter in enumerate(AXES))  # type: ignore[return-value]


def _refuse(words: Words, control: FanucControl, who: str) -> None:
    if control.state.side:
        raise Fault("GS150", f"{who} is refused in cutter compensation", at=who.lower(), hint="say G40 first")
    if not words.has_axes():
        raise Fault("GS103", f"{who} needs at least one axis word", at=who.lower())


_ACTS = {
    100: _set_data,
    270: _check_home,
    280: _go_home,
    290: _come_back,
    300: _go_home,
    520: _set_local,
    920: _preset,
    921: _clear_preset,
}

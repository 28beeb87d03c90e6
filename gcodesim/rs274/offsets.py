"""Offsets: tool length, work systems, G10, G28, G30, G52, G92. Except for G28 and G30, nothing moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from gcodesim.arithmetic.scalars import cos_sin
from gcodesim.rs274 import parameters as numbers
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.dialects.linuxcnc import LENGTH, NON_MODAL, SHIFT, SYSTEM
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.splines import nurbs_end
from gcodesim.rs274.state import AXES, LINEAR, ZERO, Vector, add, subtract
from gcodesim.rs274.tilt import Tilt
from gcodesim.rs274.tool_table import ToolEntry
from gcodesim.rs274.words import Words
from gcodesim.units import DEG, MM

_SYSTEM_INDEX = {540: 1, 550: 2, 560: 3, 570: 4, 580: 5, 590: 6, 591: 7, 592: 8, 593: 9}


def tool_length(words: Words, control: Control) -> None:
    """G43, G43.1, G43.2, G49."""
    code = words.g.get(LENGTH)
    if code is None:
        return
    state = control.state
    if state.side:
        at = g_name(code)
        raise Fault(
            "GS150", "the tool length cannot change while cutter compensation is on", at=at, hint="say G40 first"
        )
    axes = control.axes()
    if code == 490:
        offset = state.tool_offset if control.auto_length else ZERO  # touched off with the tool, not measured
    elif code == 430:
        offset = control.from_si(_entry_of_h(words, control).offset)
    elif code == 431:
        offset = _replaced(state.tool_offset, words)
    else:
        offset = _added(words, control)
    state.tool_offset = offset
    control.stay_at(axes)
    control.say_tool_offset()


def _entry_of_h(words: Words, control: Control) -> ToolEntry:
    number = round(words.get("h") or 0.0)
    return control.tool_entry(number, "h") if number else control.spindle_tool


def _replaced(offset: Vector, words: Words) -> Vector:
    return tuple(words.values.get(letter, offset[axis]) for axis, letter in enumerate(AXES))  # type: ignore[return-value]


def _added(words: Words, control: Control) -> Vector:
    has_axes = words.has_axes()
    if has_axes or "h" not in words.values:
        raise Fault("GS105", "G43.2 needs the word H and takes no axis words", at="g43.2")
    return add(control.state.tool_offset, control.from_si(_entry_of_h(words, control).offset))


def work_system(words: Words, control: Control) -> None:
    """G54 to G59.3."""
    code = words.g.get(SYSTEM)
    if code is None:
        return
    if control.state.side:
        raise Fault(
            "GS150",
            "the work system cannot change while cutter compensation is on",
            at=g_name(code),
            hint="say G40 first",
        )
    index = _SYSTEM_INDEX.get(code, control.state.system)
    if index != control.state.system:  # a program that sets #5221 itself has to change the system for it to take effect
        control.use_system(index)


def non_modal(words: Words, control: Control) -> None:
    """G10, G28, G30, G28.1, G30.1, G52, G92, G92.1 to G92.3."""
    code = words.g.get(NON_MODAL)
    act = _NON_MODAL.get(code) if code is not None else None
    if act is not None:
        act(words, control)


# -- G10


def _set_data(words: Words, control: Control) -> None:
    level = words.whole("l", "G10")
    if level in (2, 20):
        set_system(words, control, level)
    elif level in (1, 10, 11):
        _set_tool(words, control, level)
    elif level == 0:  # reload the tool table: it is the one we have
        if control.state.tool:
            hint = "empty the spindle first: T0 M6"
            raise Fault("GS109", f"G10 L0 while T{control.state.tool} is in the spindle", at="g10", hint=hint)
    else:
        message = "G10 needs the word L" if level is None else f"G10 L{level} does not exist"
        raise Fault("GS105", message, at="l" if level is not None else "g10", hint="L1 L2 L10 L11 L20 are known")


def set_system(words: Words, control: Control, level: int) -> None:
    """G10 L2 or L20 (`level`): the offsets of work system P, 0 the active one; raises `Fault`."""
    words.need("p", "GS105", "G10", "P1 is G54, P9 is G59.3, P0 the active system")
    index = words.whole("p", "G10")
    assert index is not None
    if not 0 <= index <= 9:
        raise Fault("GS106", f"G10 L{level} P{index}: P runs from 0 to 9", at="p", value=index, limit=9)
    state = control.state
    index = index or state.system
    turn = words.get("r")
    for letter in "ij":
        if letter in words.values:
            raise Fault("GS106", f"G10 L{level} takes no {letter.upper()}", at=letter)
    if level == 20 and turn is not None:
        raise Fault("GS106", "G10 L20 takes no R", at="r", hint="set the rotation with G10 L2")
    if state.side and index == state.system:
        raise Fault("GS150", "the active work system cannot change while cutter compensation is on", at="g10")
    first = numbers.FIRST_SYSTEM + 20 * (index - 1)
    wanted = [(axis, words.values[letter]) for axis, letter in enumerate(AXES) if letter in words.values]
    if level == 20:
        wanted = _offsets_for_reading(wanted, index, control)
    for axis, value in wanted:
        control.parameters.set(first + axis, control.machine_units(value, axis))
    if turn is not None:
        control.parameters.set(first + 9, turn)
    if index == state.system:
        before, old, turned = state.current, state.origin, state.rotation
        control.use_system(index)
        if turned != state.rotation and (state.g92[0] or state.g92[1]):
            _forget_g92_in_turning(control, before, old, turned)


def _forget_g92_in_turning(control: Control, before: Vector, old: Vector, turned: float) -> None:
    """As on the control, which leaves G92 out when the active system is turned: X and Y read as if there were none."""
    state = control.state
    cos, sin = cos_sin(turned * DEG)
    x = before[0] * cos - before[1] * sin + old[0] - state.origin[0]
    y = before[0] * sin + before[1] * cos + old[1] - state.origin[1]
    cos, sin = cos_sin(state.rotation * DEG)
    true = state.current
    state.current = (x * cos + y * sin, y * cos - x * sin, *true[2:])
    miss = math.dist(true[:2], state.current[:2]) * state.unit / MM
    hint = "say G92.1 before, and give both X and Y in the next move"
    control.warn(
        "GS106",
        f"G10 L2 R turns a system in which G92 is in force: the control then believes to stand {miss:.3f} mm away",
        hint,
    )


def _offsets_for_reading(wanted: list[tuple[int, float]], index: int, control: Control) -> list[tuple[int, float]]:
    """Offsets of system `index` with which the current point reads as `wanted`."""
    old, turn = control.system_offset(index)
    tip = control.tip(control.state.current)
    if (lean := control.settings.leans.get(index)) is not None:
        return _leaning_offsets(wanted, index, lean, control)
    x, y = tip[0] - old[0], tip[1] - old[1]
    cos, sin = cos_sin(math.radians(turn))
    g92 = control.state.g92
    reads = [x * cos + y * sin - g92[0], y * cos - x * sin - g92[1]]
    for axis, value in wanted:
        if axis < 2:
            reads[axis] = value
    x, y = reads[0] + g92[0], reads[1] + g92[1]
    new = [tip[0] - (x * cos - y * sin), tip[1] - (x * sin + y * cos)]
    new += [tip[axis] - g92[axis] - dict(wanted).get(axis, 0.0) for axis in range(2, 9)]
    axes = {axis for axis, _ in wanted}
    if turn and axes & {0, 1}:
        axes |= {0, 1}
    return [(axis, new[axis]) for axis in sorted(axes)]


def _leaning_offsets(
    wanted: list[tuple[int, float]], index: int, lean: Tilt, control: Control
) -> list[tuple[int, float]]:
    """The same of a system that leans; axes of it that have no word read as before, so all three offsets change."""
    old, turn = control.system_offset(index)
    (cos, sin), g92 = cos_sin(math.radians(turn)), control.state.g92
    tip = control.tip(control.state.current)
    x, y, z = lean.back(subtract(tip, old)[:3])
    reads = [*subtract((x * cos + y * sin, y * cos - x * sin, z, *subtract(tip, old)[3:]), g92)]
    for axis, value in wanted:
        reads[axis] = value
    x, y, z, *rest = add(tuple(reads), g92)  # type: ignore[arg-type]
    way = (*lean.direction((x * cos - y * sin, x * sin + y * cos, z)), *rest)
    new = subtract(tip, way)  # type: ignore[arg-type]
    named = {axis for axis, _ in wanted}
    return [(axis, new[axis]) for axis in range(9) if axis in named or (axis < 3 and named & {0, 1, 2})]


def _set_tool(words: Words, control: Control, level: int) -> None:
    words.need("p", "GS105", "G10", "P is the number of the tool")
    number = words.whole("p", "G10")
    assert number is not None
    entry = control.tool_entry(number, "p")
    if not words.has_axes() and {"r", "i", "j", "q"}.isdisjoint(words.values):
        raise Fault("GS105", f"G10 L{level} without any offset does nothing", at="g10", hint="name axes, R, I, J or Q")
    if level != 1 and (control.lean if level == 10 else control.settings.leans.get(9)) is not None:
        message = f"G10 L{level} measures along the axes, and this work system leans against them"
        raise Fault("GS106", message, at="l", hint="set the length itself with G10 L1")
    offset = list(entry.offset)
    reads = _current_for_tool(words, control, level)
    for axis, letter in enumerate(AXES):
        if letter in words.values:
            value = words.values[letter] if level == 1 else reads[axis] - words.values[letter]
            offset[axis] = value * (control.state.unit if LINEAR[axis] else DEG)
    if level != 1:
        offset = _turned_back(offset, words, control, entry, level, reads)
    changed = replace(entry, offset=tuple(offset))  # type: ignore[arg-type]
    if (radius := words.get("r")) is not None:
        changed = replace(changed, diameter=2.0 * radius * control.state.unit)
    if (front := words.get("i")) is not None:
        changed = replace(changed, front_angle=front * DEG)
    if (back := words.get("j")) is not None:
        changed = replace(changed, back_angle=back * DEG)
    if (orientation := words.whole("q", "G10")) is not None:
        if not 0 <= orientation <= 9:
            raise Fault("GS106", f"the orientation Q{orientation} must be between 0 and 9", at="q")
        changed = replace(changed, orientation=orientation)
    control.tools[number] = changed
    if control.spindle_tool.number == number:
        control.spindle_tool = changed


def _current_for_tool(words: Words, control: Control, level: int) -> Vector:
    """Axes minus everything but the tool offset: what the length must make up for."""
    state = control.state
    axes = control.axes()
    if level == 11:  # the frame of system 9, without G92
        origin, turn = control.system_offset(9)
        point = subtract(axes, origin)
        g92 = ZERO
    else:
        origin, turn, g92 = state.origin, state.rotation, state.g92
        point = subtract(axes, origin)
    if turn:
        cos, sin = cos_sin(math.radians(turn))
        point = (point[0] * cos + point[1] * sin, point[1] * cos - point[0] * sin, *point[2:])
    return subtract(point, g92)


def _turned_back(
    offset: list[float], words: Words, control: Control, entry: ToolEntry, level: int, reads: Vector
) -> list[float]:
    """Tool offsets are along the axes, so an X or Y difference found in a turned system is turned back."""
    turn = control.system_offset(9)[1] if level == 11 else control.state.rotation
    if not turn or {"x", "y"}.isdisjoint(words.values):
        return offset
    unit = control.state.unit
    cos, sin = cos_sin(math.radians(turn))
    x0, y0 = entry.offset[0], entry.offset[1]
    x = offset[0] if "x" in words.values else x0 * cos + y0 * sin
    y = offset[1] if "y" in words.values else y0 * cos - x0 * sin
    del unit, reads
    return [x * cos - y * sin, x * sin + y * cos, *offset[2:]]


# -- G28 and G30


def _go_home(first: int, code: int) -> Callable[[Words, Control], None]:
    def act(words: Words, control: Control) -> None:
        state = control.state
        if state.side:
            raise Fault(
                "GS150", f"G{code} is refused while cutter compensation is on", at=f"g{code}", hint="say G40 first"
            )
        word = f"G{code}"
        get = control.parameters.get
        home: Vector = tuple(control.program_units(get(first + axis), axis) for axis in range(9))  # type: ignore[assignment]
        # as on the control, the tool's offset in A, B and C is left out of it
        offset = (*control.length[:3], 0.0, 0.0, 0.0, *state.tool_offset[6:])
        end = control.point_of(subtract(home, offset))
        leaving, state.comp_leaving = state.comp_leaving, False
        if (leaving or state.strayed is not None) and not words.has_axes():
            control.rapid(state.current, word)  # first from beside the path, or out of a hole, to the programmed point
        if words.has_axes():
            control.rapid(end_point(words, control), word)
            named = [letter in words.values for letter in AXES]
            # as on the control, the named axes are those of the work system, also where it is turned
            end = tuple(end[axis] if named[axis] else state.current[axis] for axis in range(9))  # type: ignore[assignment]
        if control.settings.joint_home and not _is_stored(control, first):
            end = control.at_home()  # all joints go there, whichever axes are named
        control.rapid(end, word)
        _name_home(control, first, word)

    return act


def _name_home(control: Control, first: int, word: str) -> None:
    """A home that nobody has stored is marked by name, so that an arm may go to its joint home instead."""
    if _is_stored(control, first):
        return
    from gcodesim import canon

    last = control.out[-1]
    assert isinstance(last, canon.Rapid)
    control.out[-1] = replace(last, home=word)


def _is_stored(control: Control, first: int) -> bool:
    return any(first + axis in control.parameters.numbers for axis in range(9))


def _store_home(first: int) -> Callable[[Words, Control], None]:
    def act(_: Words, control: Control) -> None:
        if control.state.side:
            raise Fault("GS150", "a home cannot be stored while cutter compensation is on", hint="say G40 first")
        for axis, value in enumerate(control.axes()):
            control.parameters.set(first + axis, control.machine_units(value, axis))

    return act


# -- G52 and G92


def _refuse_in_compensation(control: Control, code: str) -> None:
    if control.state.side:
        raise Fault(
            "GS150", f"{code.upper()} is refused while cutter compensation is on", at=code, hint="say G40 first"
        )


def _shift_origin(words: Words, control: Control) -> None:
    """G92: the current point reads as given."""
    _refuse_in_compensation(control, "g92")
    state = control.state
    wanted = tuple(words.values.get(letter, state.current[axis]) for axis, letter in enumerate(AXES))
    state.g92 = add(state.g92, subtract(state.current, wanted))  # type: ignore[arg-type]
    state.current = wanted  # type: ignore[assignment]
    _store_g92(control)


def _set_local_system(words: Words, control: Control) -> None:
    """G52: the offset itself is given."""
    _refuse_in_compensation(control, "g52")
    state = control.state
    axes = control.axes()
    state.g92 = tuple(words.values.get(letter, state.g92[axis]) for axis, letter in enumerate(AXES))  # type: ignore[assignment]
    control.stay_at(axes)
    _store_g92(control)


def _store_g92(control: Control) -> None:
    for axis, value in enumerate(control.state.g92):
        control.parameters.set(numbers.G92_OFFSET + axis, control.machine_units(value, axis))
    control.parameters.set(numbers.G92_ON, 1.0)
    control.say_system()


def _use_g92(control: Control, offset: Vector, *, on: bool) -> None:
    axes = control.axes()
    control.state.g92 = offset
    control.stay_at(axes)
    control.parameters.set(numbers.G92_ON, float(on))
    control.say_system()


def apply_shift(words: Words, control: Control) -> None:
    """G92.1, G92.2, G92.3; with cutter compensation they do nothing, as on the control."""
    code = words.g.get(SHIFT, words.g.get(NON_MODAL))  # a group of its own in LinuxCNC only
    if code not in _SHIFTS:
        return
    if control.state.side:
        control.warn("GS150", f"{g_name(code).upper()} does nothing while cutter compensation is on", "say G40 before")
        return
    _SHIFTS[code](words, control)


def _clear_g92(_: Words, control: Control) -> None:
    for axis in range(9):
        control.parameters.set(numbers.G92_OFFSET + axis, 0.0)
    _use_g92(control, ZERO, on=False)


def _suspend_g92(_: Words, control: Control) -> None:
    _use_g92(control, ZERO, on=False)


def _resume_g92(_: Words, control: Control) -> None:
    _use_g92(control, control.stored_g92(), on=True)


_NON_MODAL: dict[int, Callable[[Words, Control], None]] = {
    100: _set_data,
    280: _go_home(numbers.G28_HOME, 28),
    281: _store_home(numbers.G28_HOME),
    300: _go_home(numbers.G30_HOME, 30),
    301: _store_home(numbers.G30_HOME),
    520: _set_local_system,
    920: _shift_origin,
    53: nurbs_end,
}

_SHIFTS: dict[int, Callable[[Words, Control], None]] = {921: _clear_g92, 922: _suspend_g92, 923: _resume_g92}

__all__ = ["apply_shift", "non_modal", "tool_length", "work_system"]

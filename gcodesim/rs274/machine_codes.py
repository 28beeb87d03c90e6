"""S, T and the M codes."""

from __future__ import annotations

from typing import Literal

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic
from gcodesim.rs274 import tool_point
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects.linuxcnc import CHANGING, COOLANT, OUTPUT, OVERRIDE, SPINDLE, STOPPING, USER
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.parameters import ACTIVE_SYSTEM, INPUT_RESULT
from gcodesim.rs274.settings import MappedAction
from gcodesim.rs274.state import Modes
from gcodesim.rs274.tool_table import NO_OFFSET, ToolEntry
from gcodesim.rs274.words import Words, place_of
from gcodesim.units import DEG, MM

_MODE_NAMES = tuple(Modes.__dataclass_fields__)
_WAITS: tuple[Literal["immediate", "rise", "fall", "high", "low"], ...] = ("immediate", "rise", "fall", "high", "low")


def spindle_speed(words: Words, control: Control) -> None:
    value = words.get("s")
    if value is None:
        return
    control.state.speed = value
    control.state.speed_unit = control.state.unit
    control.say_spindle()


def select_tool(words: Words, control: Control) -> None:
    value = words.get("t")
    if value is None:
        return
    number = round(value)
    if number:
        control.tool_entry(number, "t")
    control.state.selected = number
    control.out.append(canon.ToolSelect(span=control.span, tool=number))


def _mapped(control: Control, m: int, words: Words) -> MappedAction | None:
    """The cell's action for this M code, with its P where the map names one."""
    p = words.get("p")
    if p is not None and p.is_integer():
        action = control.settings.m_codes.get(f"M{m} P{int(p)}")
        if action is not None:
            return action
    return control.settings.m_codes.get(f"M{m}")


def _act(control: Control, m: int, words: Words) -> bool:
    """Emit the action mapped to this M code; False when none is."""
    action = _mapped(control, m, words)
    if action is None:
        return False
    control.out.append(
        canon.Action(span=control.span, m=m, p=words.get("p"), q=words.get("q"), target=action.target, verb=action.verb)
    )
    return True


def outputs(words: Words, control: Control) -> None:
    """M62 to M68."""
    m = words.m.get(OUTPUT)
    if m is None:
        return
    if control.state.side:
        raise Fault("GS150", f"M{m} is refused while cutter compensation is on", at=f"m{m}", hint="say G40 first")
    if m <= 65:
        index = _index(words, "p", m)
        if not _act(control, m, words):
            control.out.append(
                canon.Output(
                    span=control.span,
                    type="digital",
                    index=index,
                    value=float(m in (62, 64)),
                    with_motion=m in (62, 63),
                )
            )
            if f"P{index}" not in control.settings.wired:
                control.skip(f"M{m} P{index}", place_of(words.block, f"m{m}"))
    elif m in (67, 68):
        index = _index(words, "e", m)
        value = words.get("q")
        if value is None:
            value = -1.0  # as on the control
            control.warn("GS105", f"M{m} without Q sets the output to -1, as on the control", "say Q")
        if not _act(control, m, words):
            control.out.append(
                canon.Output(span=control.span, type="analog", index=index, value=value, with_motion=m == 67)
            )
            if f"E{index}" not in control.settings.wired:
                control.skip(f"M{m} E{index}", place_of(words.block, f"m{m}"))
    else:
        _wait_for_input(words, control)


def _index(words: Words, letter: str, m: int) -> int:
    words.need(letter, "GS105", f"M{m}", "it is the number of the output")
    index = round(words.values[letter])
    if index < 0:
        raise Fault("GS106", f"the number of the output is negative: {index}", at=letter)
    return index


def _wait_for_input(words: Words, control: Control) -> None:
    """M66. Where nobody answers, inputs read 0 at once."""
    p, e = words.whole("p", "M66"), words.whole("e", "M66")
    if (p is None) == (e is None):
        raise Fault("GS105", "M66 needs either P (digital input) or E (analog input)", at="m66")
    for letter, number in (("p", p), ("e", e)):
        if number is not None and number < 0:
            raise Fault("GS106", f"the number of the input is negative: {number}", at=letter, value=number)
    mode = words.whole("l", "M66") or 0
    if not 0 <= mode <= 4:
        raise Fault("GS106", f"L{mode} is no way to wait; L0 to L4 are", at="l")
    timeout = words.get("q") or 0.0
    if timeout < 0.0:
        raise Fault("GS106", "the time limit Q is negative", at="q")
    if mode and timeout <= 0.0:
        raise Fault("GS105", f"M66 L{mode} needs the time limit Q", at="m66")
    if e is not None and mode:
        raise Fault("GS106", "an analog input can only be read at once: L0", at="l")
    control.parameters.set(INPUT_RESULT, 0.0)
    if not control.settings.answered:
        control.skip("M66", place_of(words.block, "m66"))
        return
    index = p if p is not None else e
    assert index is not None
    control.out.append(
        canon.Input(
            span=control.span,
            type="digital" if p is not None else "analog",
            index=index,
            wait=_WAITS[mode],
            timeout=timeout if mode else 0.0,
        )
    )


def heard(control: Control, reply: canon.Heard | None) -> None:
    """Store what an input read; -1 if the time for waiting ran out."""
    value = 0.0 if reply is None else -1.0 if reply.value is None else reply.value
    control.parameters.changes += 1
    control.parameters.numbers[INPUT_RESULT] = value


def change_tool(words: Words, control: Control) -> None:
    """M6 and M61."""
    m = words.m.get(CHANGING)
    if m is None:
        return
    state = control.state
    if state.side and m == 6:
        raise Fault("GS150", "the tool cannot change while cutter compensation is on", at=f"m{m}", hint="say G40 first")
    if m == 6:
        if state.selected < 0:
            control.warn("GS193", "M6 without any T word before it empties the spindle", "write T1 M6")
        number = max(state.selected, 0)
        if state.spindle and not control.dialect.turret:
            state.spindle = 0
            control.say_spindle()
    else:
        words.need("q", "GS105", "M61", "it is the number of the tool in the spindle")
        asked = words.whole("q", "M61")
        assert asked is not None
        if asked < 0:
            raise Fault("GS106", f"a tool number is 0 or more, not {asked}", at="q")
        number = asked
    control.spindle_tool = control.tool_entry(number, "t" if m == 6 else "q") if number else ToolEntry(number=0)
    state.tool = number
    event = (
        canon.ToolChange(span=control.span, tool=number) if m == 6 else canon.ToolNumber(span=control.span, tool=number)
    )
    control.out.append(event)
    if m == 6 and control.settings.auto_length is not None:
        if control.auto_length:
            _assume_length(number, control)
        elif control.length_cancelled:
            _tell_missing_length(number, control)


def load_first_tool(control: Control) -> None:
    """Put a tool into the spindle before the first block; as with M61, nothing moves."""
    number = control.settings.loaded_tool
    if not number:
        return
    control.spindle_tool = control.tools.get(number, ToolEntry(number=number))
    control.state.tool = number
    control.out.append(canon.ToolNumber(span=control.span, tool=number))
    if control.auto_length:
        length = _take_length(number, control)
        control.notes.append(
            Diagnostic(
                code="GS195",
                message=f"the program never says {_length_word(control)}: Z counts as touched off with T{number}, the "
                f"loaded tool ({length / MM:g} mm long)",
                span=control.span,
                hint="write G43, or set `tool_length: strict`",
            )
        )


def _assume_length(number: int, control: Control) -> None:
    """M6 acts like M6 G43 with the cell's true length."""
    length = _take_length(number, control)
    control.notes.append(
        Diagnostic(
            code="GS195",
            message=f"the program never says {_length_word(control)}: M6 takes the tool's length along "
            f"({length / MM:g} mm for T{number})",
            span=control.span,
            hint="write G43 after M6, or set `tool_length: strict`",
        )
    )


def _length_word(control: Control) -> str:
    return "G43 with a length" if control.dialect.h0_cancels else "G43"


def _take_length(number: int, control: Control) -> float:
    """The cell's true length [m] of a tool, in force from here on."""
    length = (control.settings.auto_length or {}).get(number, 0.0)
    axes = control.axes()
    offset = list(NO_OFFSET)
    offset[:3] = *control.settings.auto_aside.get(number, (0.0, 0.0)), length
    control.state.tool_offset = control.from_si(tuple(offset))  # type: ignore[arg-type]
    control.stay_at(axes)
    control.say_tool_offset()
    return length


def _tell_missing_length(number: int, control: Control) -> None:
    """A program that only takes lengths away works with the nose of the spindle, which is rarely meant."""
    length = (control.settings.auto_length or {}).get(number, 0.0)
    if length > 0.0:
        control.notes.append(
            Diagnostic(
                code="GS198",
                message=f"T{number} works without its length: the program only takes lengths away (G49 or G43 H0), so "
                f"the tip is {length / MM:g} mm below the places that are programmed",
                span=control.span,
                hint=f"say G43 H{number} after the tool change; if Z was touched off with the tool in the spindle, add "
                "its length to Z of the work offset",
                value=length / MM,
                limit=0.0,
                unit="mm",
            )
        )


def turn_spindle(words: Words, control: Control) -> None:
    """M3, M4, M5, M19."""
    m = words.m.get(SPINDLE)
    if m is None or m >= 70:
        return
    state = control.state
    if m == 19:
        _orient(words, control)
        return
    state.spindle = {3: 1, 4: -1, 5: 0}[m]
    state.oriented = False
    control.say_spindle()
    _act(control, m, words)


def _orient(words: Words, control: Control) -> None:
    control.skip("M19", place_of(words.block, "m19"))
    control.state.oriented = True
    angle = words.values.get("r", 0.0)
    if not 0.0 <= angle <= 360.0:
        raise Fault("GS106", f"M19 R{angle:g}: the angle must be between 0 and 360", at="r", value=angle, limit=360.0)
    direction = words.whole("p", "M19") or 0
    if not 0 <= direction <= 2:
        raise Fault("GS106", f"M19 P{direction}: the direction is 0, 1 or 2", at="p")
    if words.values.get("q", 1.0) <= 0.0:
        raise Fault("GS106", "the time limit Q of M19 must be positive", at="q")
    if "r" not in words.values and "p" not in words.values:
        return
    control.out.append(canon.Orient(span=control.span, angle=angle * DEG, direction=direction))


def save_modes(words: Words, control: Control) -> bool:
    """M70 to M73; whether the rest of the block is forgotten."""
    m = words.m.get(SPINDLE)
    if m is None or m < 70:
        return False
    from gcodesim.rs274 import saved

    return bool(saved.CODES[m](control))


def coolant(words: Words, control: Control) -> None:
    """M7, M8, M9."""
    m = words.m.get(COOLANT)
    if m is None:
        return
    state = control.state
    state.mist, state.flood = (m == 7 or (state.mist and m != 9)), (m == 8 or (state.flood and m != 9))
    control.say_coolant()
    if not _act(control, m, words):
        control.skip(f"M{m}", place_of(words.block, f"m{m}"))


def overrides(words: Words, control: Control) -> None:
    """M48 to M53."""
    m = words.m.get(OVERRIDE)
    if m is None:
        return
    state = control.state
    if state.side:
        raise Fault("GS150", f"M{m} is refused while cutter compensation is on", at=f"m{m}", hint="say G40 first")
    p = words.get("p")
    on = p is None or p != 0.0
    if m in (48, 49):
        state.feed_override = state.speed_override = m == 48
        control.say_overrides(feed=m == 48, speed=m == 48)
    elif m == 50:
        state.feed_override = on
        control.say_overrides(feed=on)
    elif m == 51:
        state.speed_override = on
        control.say_overrides(speed=on)
    elif m == 52:
        state.adaptive_feed = on
        control.say_overrides(adaptive=on)
    else:
        state.feed_hold = on
        control.say_overrides(hold=on)
    control.skip(f"M{m}", place_of(words.block, f"m{m}"))


def user_codes(words: Words, control: Control) -> None:
    """M codes that the cell maps, and those for which a control would run a program."""
    m = words.m.get(USER)
    if m is None or _act(control, m, words):
        return
    dialect = control.dialect
    if m in dialect.tip_m_codes and tool_point.is_possible(control):
        tool_point.switch(control, on=dialect.tip_m_codes[m])
        return
    known = m in dialect.user_m_codes or m in dialect.tip_m_codes
    if not (known and (control.settings.has_cell or dialect.open_m_codes)):
        raise Fault("GS013", f"M{m} is mapped with another P only", at=f"m{m}", hint=f"map M{m} itself in the cell")
    control.skip(f"M{m}", place_of(words.block, f"m{m}"))


def stop(words: Words, control: Control) -> None:
    """M0, M1, M60, M2, M30, and M99 of the main program, where a control would start again from the top."""
    m = words.m.get(STOPPING)
    if m is None:
        return
    from gcodesim.rs274 import compensation

    compensation.pause(control)
    out, span = control.out, control.span
    if m == 0:
        out.append(canon.Stop(span=span))
    elif m == 1:
        out.append(canon.OptionalStop(span=span))
    elif m == 60:
        out.append(canon.PalletShuttle(span=span))
        out.append(canon.Stop(span=span))
        control.skip("M60", place_of(words.block, "m60"))
    else:
        end_program(control, shuttle=m == 30)


def end_program(control: Control, *, shuttle: bool) -> None:
    """M2 and M30: spindle and coolant off, back to the modes of the start; offsets stay stored."""
    from gcodesim.rs274 import compensation

    compensation.leave(control)
    state = control.state
    if state.spindle:
        state.spindle = 0
        control.say_spindle()
    if state.flood or state.mist:
        state.flood = state.mist = False
        control.say_coolant()
    if not state.feed_override:
        state.feed_override = True  # the spindle's override stays as it is
        control.say_overrides(feed=True)
    if shuttle:
        control.out.append(canon.PalletShuttle(span=control.span))
    state.plane, state.incremental, state.feed_mode, state.side = 170, False, 940, 0
    state.motion = -1
    control.parameters.set(ACTIVE_SYSTEM, 1.0)
    control.use_system(1)
    control.out.append(canon.End(span=control.span))
    control.finished = True

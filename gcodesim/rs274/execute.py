"""One block from first to last: checks on the whole, then the order of execution of RS274 (Kramer 2000, table 8)."""

from __future__ import annotations

from gcodesim import canon
from gcodesim.rs274 import compensation, machine_codes, modes, offsets
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.dialects.linuxcnc import CANCEL, CONTOUR_CYCLES, LENGTH, MOTION, NON_MODAL
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.motions import MOTIONS
from gcodesim.rs274.words import Words, check_use, is_used

NOT_MODELLED = "uvw"
_NO_Q = -1.0  # LinuxCNC's mark for a block without Q
_CLAIMS_AXES = frozenset((100, 280, 300, 520, 920))
_LENGTH_NEEDS_NO_MOTION = frozenset((431, 432))  # of these only G43.1 keeps the axis words to itself
_ARCS = frozenset((20, 30))  # a modal one continues if only its centre is given
# motions that make sense without any axis word
_NEEDS_NO_AXES = frozenset((0, 10, 20, 30, 52, *CONTOUR_CYCLES))


def motion_of(words: Words, control: Control) -> int:
    """The motion code that this block executes: its own, the modal one, or -1 for none.

    Raises `Fault` when axis words have no code, or two.
    """
    own = words.g.get(MOTION, words.g.get(CANCEL, -1))
    claimed = words.g.get(NON_MODAL, -1)
    claims = claimed in _CLAIMS_AXES
    has_axes = words.has_axes()
    length = words.g.get(LENGTH, -1)
    if words.has_polar():
        _check_polar(words, control)
        if claims and own in (-1, 800):
            raise Fault("GS185", "polar words belong to a motion, not to " + g_name(claimed).upper(), at="@")
    if own == 800:
        if has_axes and not claims:
            raise Fault(
                "GS102", "G80 ends the cycle and takes no axis words", at="g80", hint="use G0 or G1 for the move"
            )
        _need_axes(words, claimed, has_axes)
        return own
    if own >= 0:
        if claims:
            other = g_name(claimed)
            raise Fault(
                "GS102",
                f"{other.upper()} and {g_name(own).upper()} both claim the axis words",
                at=other,
                hint="put them into two blocks",
            )
        if not has_axes and (own not in _NEEDS_NO_AXES or (own in _ARCS and control.dialect.arcs_name_axes)):
            raise Fault("GS103", f"{g_name(own).upper()} needs at least one axis word", at=g_name(own))
        return own
    if claims:
        _need_axes(words, claimed, has_axes)
        return -1
    modal = control.state.motion
    carries_on = modal in _ARCS and not control.dialect.arcs_name_axes and not {"i", "j", "k"}.isdisjoint(words.values)
    if (has_axes and length != 431) or carries_on:
        if modal in (-1, 800):
            if length in _LENGTH_NEEDS_NO_MOTION and not words.has_polar():
                return -1
            letter = next(letter for letter, _ in words.block.words if letter in "xyzabcuvw@^")
            raise Fault(
                "GS101",
                "axis words, but no motion is active" + (" after G80" if modal == 800 else ""),
                at=letter,
                hint="say G0 or G1",
            )
        return modal
    return -1


def _check_polar(words: Words, control: Control) -> None:
    """The plane is the one in force before the block, as on the control."""
    at = "@" if "@" in words.values else "^"
    if control.state.plane != 170:
        raise Fault("GS185", "polar coordinates work in the XY plane only", at=at, hint="say G17 in a block before")
    for letter in "xy":
        if letter in words.values:
            raise Fault("GS185", f"{letter.upper()} and polar words exclude each other", at=letter)


def _need_axes(words: Words, claimed: int, has_axes: bool) -> None:
    if claimed in (520, 920) and not has_axes:
        raise Fault("GS103", f"{g_name(claimed).upper()} needs at least one axis word", at=g_name(claimed))


def execute(words: Words, control: Control) -> None:
    """Execute one block; its events are in `control.out`. Raises `Fault`; the caller puts the state back."""
    motion = motion_of(words, control)
    g = words.g
    if g.get(NON_MODAL) == 530:
        _check_machine_coordinates(words, control, motion)
    motion_name = g_name(motion) if motion >= 0 else ""
    if words.values.get("q") == _NO_Q and not is_used(words, "q", control.dialect, motion_name):
        control.warn("GS106", "Q-1 counts as no Q at all, as on the control", place=words.block.place_of("q"))
        del words.values["q"]
    check_use(words, control.dialect, motion_name)

    if "$" in words.values:
        _check_spindle_number(words)
    if g.get(NON_MODAL) == 53 and g.get(MOTION, 52) != 52:
        raise Fault("GS170", f"G5.3 and {g_name(g[MOTION]).upper()} exclude each other", at=g_name(g[MOTION]))

    control.check_letters(words)
    for letter in NOT_MODELLED:
        if letter in words.values and letter not in control.settings.columns and motion not in CONTOUR_CYCLES:
            control.skip(letter.upper(), words.block.place_of(letter))

    modes.spindle_mode(words, control)
    modes.feed_mode(words, control)
    modes.feed_rate(words, control)
    machine_codes.spindle_speed(words, control)
    machine_codes.select_tool(words, control)
    machine_codes.outputs(words, control)
    machine_codes.change_tool(words, control)
    machine_codes.turn_spindle(words, control)
    if machine_codes.save_modes(words, control):
        if motion >= 0 or len(words.block.words) > 1:
            hint = "put M72 into a block of its own"
            control.warn("GS194", "the rest of a block with M72 is not executed when modes come back", hint)
        return
    machine_codes.coolant(words, control)
    machine_codes.overrides(words, control)
    machine_codes.user_codes(words, control)
    if g.get(NON_MODAL) == 40:
        seconds = words.need("p", "GS105", "G4", "P is the time in seconds")
        if g.get(MOTION) in _ARCS and motion_name in control.dialect.users.get("p", ()):
            hint = "put them into two blocks"
            raise Fault("GS011", f"G4 and {motion_name.upper()} both take the word P", at=motion_name, hint=hint)
        if seconds == -1.0:
            raise Fault("GS106", "the dwell is negative: -1 s", at="p", hint="the control takes P-1 for a missing P")
        control.dwell(seconds)
    modes.plane(words, control)
    modes.units(words, control)
    modes.diameter(words, control)
    compensation.switch(words, control)
    offsets.tool_length(words, control)
    offsets.work_system(words, control)
    modes.path_control(words, control)
    modes.distance(words, control)
    modes.retract(words, control)
    offsets.non_modal(words, control)
    offsets.apply_shift(words, control)
    if motion >= 0:
        MOTIONS[motion](words, control, motion)
        if motion not in _NOT_MODAL:
            control.state.motion = motion
    machine_codes.stop(words, control)
    if control.state.side:
        compensation.settle(control)
    _notice_moves(control)


def _notice_moves(control: Control) -> None:
    """Once a move has been made, the program is where it believes it is."""
    strayed = control.state.strayed
    if strayed is None or strayed[0] == control.block_number:
        return
    if any(isinstance(event, canon.Move) for event in control.out):
        control.state.strayed = None


def _check_spindle_number(words: Words) -> None:
    """$0 is the only spindle; $-1 means all of them where a code says so."""
    number = words.values["$"]
    for_all = number == -1.0 and words.names.isdisjoint(_ONE_SPINDLE)
    if (number and not for_all) or "m51" in words.names:
        raise Fault("GS106", f"there is no spindle ${number:g}: one spindle is simulated", at="$")


_ONE_SPINDLE = frozenset(("g33", "g33.1", "g74", "g76", "g84", "g95", "g96", "g97", "m19", "m51"))
_NOT_MODAL = frozenset((50, 51, *CONTOUR_CYCLES))  # splines are called by name each time and leave the motion in force
_PLAIN = frozenset("xyzabcfijkrp")
_PLAIN_MOTIONS = frozenset((0, 10, 20, 30))


def is_plain_move(words: Words, control: Control) -> bool:
    """Whether the block is nothing but a straight move or an arc, as nearly all blocks of a CAM program."""
    g = words.g
    if words.m or (g and (len(g) > 1 or g.get(MOTION) not in _PLAIN_MOTIONS)):
        return False
    state = control.state
    if state.side or not words.values.keys() <= _PLAIN:
        return False
    return bool(g) or state.motion in _PLAIN_MOTIONS


def execute_move(words: Words, control: Control) -> None:
    """What `execute` does, for a plain move: only the feed can change before a fault."""
    state = control.state
    if control.settings.columns:
        control.check_letters(words)
    motion = motion_of(words, control)
    check_use(words, control.dialect, g_name(motion) if motion >= 0 else "")
    feed = (state.feed, state.feed_unit)
    modes.feed_rate(words, control)
    if motion < 0:
        return
    try:
        MOTIONS[motion](words, control, motion)
    except Fault:
        state.feed, state.feed_unit = feed
        raise
    state.motion = motion
    _notice_moves(control)


def _check_machine_coordinates(words: Words, control: Control, motion: int) -> None:
    if motion not in (0, 10):
        hint = "name G0 or G1 in the block; alone, as posts for Mach3 write it, it would do nothing: leave it out"
        raise Fault("GS109", "G53 works with G0 and G1 only", at="g53", hint=hint)
    incremental = words.g.get(3, 910 if control.state.incremental else 900) == 910
    if incremental and not control.dialect.g53_under_g91:
        raise Fault("GS109", "G53 cannot be incremental", at="g53", hint="say G90 before")
    side = control.state.side if 7 not in words.g else words.g[7] != 400
    if side and control.state.comp_radius > 0.0:
        raise Fault("GS150", "G53 is refused while cutter compensation is on", at="g53", hint="switch it off with G40")

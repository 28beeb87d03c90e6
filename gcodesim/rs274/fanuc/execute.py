"""One Fanuc block from first to last."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from gcodesim import canon
from gcodesim.rs274 import compensation, machine_codes, modes, tool_point
from gcodesim.rs274.arcs import PLANE_AXES
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.dialects.fanuc import CYCLES, MIRROR, SCALING, STROKE, TURN
from gcodesim.rs274.dialects.linuxcnc import CANCEL, COMPENSATION, DISTANCE, MOTION, NON_MODAL, PATH, SPINDLE, STOPPING
from gcodesim.rs274.ends import end_point, start_point
from gcodesim.rs274.execute import NOT_MODELLED
from gcodesim.rs274.fanuc import corner_circle, corners, figure, fixture, offsets, polar, tilted, vectors
from gcodesim.rs274.fanuc.compensation import change_side, leave, look_ahead
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fanuc.cycles import cycle
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.feeds import check_feed
from gcodesim.rs274.motions import MOTIONS
from gcodesim.rs274.words import AXIS_LETTERS, Words, exponent, place_of

# one-shot codes to which the axis words of their block belong
_CLAIMS_AXES = frozenset((40, 50, 51, 80, 100, 110, 270, 280, 290, 300, 520, 531, 920, 921))
_NOT_SIMULATED = {50: "G5", 51: "G5.1", 80: "G8", 1030: "G103", 1870: "G187"}
_ONE_WAY = 600  # G60
_CORNER_CIRCLE = 390  # G39
_UPRIGHT = 1e-9  # deg
_EXACT_STOP = 90  # G9, for one block
_STOPPING_PATH = 611
_OF_THE_CONTROL = frozenset((0, 1, 2, 6, 7, 8, 9, 30, 48, 49))  # M codes that take no words
_ARC_WORDS = frozenset("ijkr")
_USED = frozenset("nofst") | AXIS_LETTERS


def execute(words: Words, control: FanucControl, has_point: dict[str, bool]) -> None:
    """Execute one block; its events are in `control.out`. Raises `Fault`; the caller puts the state back.

    `has_point` says of each letter whether its number was written with a point.
    """
    g, state = words.g, control.state
    control.check_letters(words)
    for letter in NOT_MODELLED:
        moves = letter in control.settings.columns or g.get(NON_MODAL) == 40  # U of G4 is a time
        if letter in words.values and not moves:
            control.skip(letter.upper(), words.block.place_of(letter))
    modes.units(words, control)  # before F, unlike RS274
    modes.plane(words, control)
    modes.distance(words, control)
    modes.spindle_mode(words, control)
    modes.feed_mode(words, control)
    modes.feed_rate(words, control)
    machine_codes.spindle_speed(words, control)
    machine_codes.select_tool(words, control)
    machine_codes.change_tool(words, control)
    _turn_spindle(words, control)
    machine_codes.coolant(words, control)
    machine_codes.overrides(words, control)
    machine_codes.user_codes(words, control)
    claimed = g.get(NON_MODAL, -1)
    if claimed == 40:
        _dwell(words, control)
    leaving = _compensation(words, control)
    _path(words, control)
    modes.retract(words, control)
    offsets.tool_length(words, control)
    fixture.switch(words, control)
    offsets.work_system(words, control)
    if claimed == _EXACT_STOP and state.path != _STOPPING_PATH:
        control.say_path(_STOPPING_PATH)
    used = _USED | _letters_of(words)
    claims = claimed in _CLAIMS_AXES or not {SCALING, MIRROR, TURN, STROKE}.isdisjoint(g)
    figure.switch(words, control, has_point)
    polar.switch(words, control)
    if claimed in _NOT_SIMULATED or STROKE in g:
        name = _NOT_SIMULATED.get(claimed) or g_name(g[STROKE]).upper()
        control.skip(name, place_of(words.block, name.lower()))
        state.stroke = g.get(STROKE, state.stroke)
    elif claimed in (100, 270, 280, 290, 300, 520, 920, 921):
        if claimed in (270, 280, 290, 300):
            with _by_axes(control):
                offsets.non_modal(words, control)
        else:
            offsets.non_modal(words, control)
    elif claimed == 531:
        tilted.turn_tool(words, control)
    _cancel_cycle(words, control)
    own = g.get(MOTION, -1)
    motion = own if own >= 0 else state.motion
    if claimed == 530:
        _machine_coordinates(words, control)
        motion = own
    elif claimed == 310:
        if not control.settings.answered:
            control.skip("G31", place_of(words.block, "g31"))
        _skip_function(words, control)
        motion = own
    elif claimed == _CORNER_CIRCLE:
        corner_circle.begin(words, control)
        motion = own
    elif claimed == _ONE_WAY:
        control.skip("G60", place_of(words.block, "g60"))
        _moved_by(words, control, 0, -1)
        motion = own
    elif claims:
        motion = own
    else:
        used |= _moved_by(words, control, motion, own, leaving=leaving)
    if own >= 0 and own not in CYCLES:
        state.cycle = -1
        state.motion = own
    if claimed == _EXACT_STOP and state.path != _STOPPING_PATH:
        control.say_path()
    _name_unused(words, control, used)
    if words.m.get(STOPPING) in (2, 30):
        machine_codes.end_program(control, shuttle=False)
    else:
        machine_codes.stop(words, control)
    look_ahead(control)
    if state.side and state.corner is None:
        compensation.settle(control)


def _moved_by(words: Words, control: FanucControl, motion: int, own: int, *, leaving: bool = False) -> frozenset[str]:
    """Execute the motion when the block has words for it; the letters that it uses.

    `leaving` says that it takes the tool out of the cutter compensation.
    """
    arc = motion in (20, 30)
    state = control.state
    if motion in CYCLES:
        for each in polar.repeats(words, control, motion):
            polar.resolve(each, control, state.current)
            figure.apply(each, control, motion)
            cycle(each, control, motion)
        state.motion = motion
        return frozenset("rpqkl")
    polar.resolve(words, control, start_point(control) if state.corner is None else state.corner.move.end)
    if not words.has_axes() and not (
        (arc or state.length_mode == vectors.BY_VECTOR) and {"i", "j", "k"} & words.values.keys()
    ):
        return frozenset()
    if arc:
        words.values.pop("p", None)
        if (
            state.turn is not None
            and state.rotation == 0.0 != state.turn
            and PLANE_AXES[state.plane][:2] != state.turn_axes
        ):
            raise Fault(
                "GS106", "an arc outside the plane of G68 is not simulated", hint="say G69 before, or stay in it"
            )
    if state.length_mode in tool_point.CENTRE_POINT and not state.point_control:
        _check_upright(words, control)
    if state.length_mode == vectors.BY_VECTOR and not arc:
        vectors.resolve(words, control)
    kept = state.motion
    motion = figure.apply(words, control, motion)
    if corners.is_near(words, control):
        corners.move(words, control, motion)
    else:
        if leaving:
            leave(control, end_point(words, control), rapid=motion == 0)
        MOTIONS[motion](words, control, motion)
    state.motion = own if own >= 0 else kept
    return corners.LETTERS | (_ARC_WORDS if arc else frozenset("k" if motion == 330 else ""))


def _check_upright(words: Words, control: FanucControl) -> None:
    """Tool centre point control is the same as a length along Z as long as no rotary axis is turned."""
    for axis, letter in enumerate("abc", start=3):
        if words.values.get(letter) or (letter not in words.values and abs(control.state.current[axis]) > _UPRIGHT):
            raise Fault(
                "GS915",
                f"{g_name(control.state.length_mode).upper()} is not simulated with axis {letter.upper()} turned:"
                " no rotary axis of the machine has a place",
                at=letter if letter in words.values else None,
                hint="give its rotary axes a point (`at:`); without it the moves would be others than on the control",
            )


def _cancel_cycle(words: Words, control: FanucControl) -> None:
    """G80: the motion before the cycle goes on."""
    if words.g.get(CANCEL) == 800:
        state = control.state
        if state.motion in CYCLES:
            state.motion = state.before_cycle
        state.cycle = -1


def _turn_spindle(words: Words, control: FanucControl) -> None:
    if words.m.get(SPINDLE) in (19, 29):
        name = f"M{words.m[SPINDLE]}"
        control.skip(name, place_of(words.block, name.lower()))
    else:
        machine_codes.turn_spindle(words, control)


def _dwell(words: Words, control: FanucControl) -> None:
    """G04 X or U in seconds, P in milliseconds."""
    values = words.values
    if "p" in values:
        seconds = values["p"] * 1e-3
    elif "x" in values or "u" in values:
        seconds = values.get("x", values.get("u", 0.0))
    else:
        raise Fault("GS105", "G4 needs P or X", at="g4", hint="P is the time in milliseconds, X in seconds")
    if seconds < 0.0:
        raise Fault("GS106", f"the dwell is negative: {seconds:g} s", value=seconds)
    control.dwell(seconds)


def _path(words: Words, control: FanucControl) -> None:
    """G61 stops exactly at each end; G62, G63 and G64 go through."""
    code = words.g.get(PATH)
    if code is not None:
        control.state.path = 611 if code == 610 else 640
        control.state.path_code = code
        control.say_path()


def _compensation(words: Words, control: FanucControl) -> bool:
    """G40, G41, G42 and D; whether the move of this block is to leave the compensation by itself."""
    code = words.g.get(COMPENSATION)
    if code is None:
        _number_alone(words, control)
        return False
    if code == 400:
        motion = words.g.get(MOTION, control.state.motion)
        if motion in (0, 10) and words.has_axes() and words.g.keys() <= {COMPENSATION, MOTION, DISTANCE}:
            return True
        leave(control, None, rapid=False)
        return False
    figure.side(words, control)
    radius = offsets.check_radius_number(words, control)
    if change_side(control, code, radius):
        return False
    given = words.values.pop("d", None)
    compensation.switch(words, control)
    state = control.state
    state.comp_radius = abs(radius)
    if radius < 0.0:
        state.side = -state.side
    if given is not None:
        words.values["d"] = given
    return False


def _number_alone(words: Words, control: FanucControl) -> None:
    """D without G41 or G42 chooses the offset for the next of them."""
    number = round(words.values.get("d", control.state.radius_number))
    if control.state.side and number != control.state.radius_number:
        hint = "say G40 before, or give D with G41 or G42"
        raise Fault("GS153", "D cannot change while cutter compensation is on", at="d", hint=hint)
    control.state.radius_number = number


def _machine_coordinates(words: Words, control: FanucControl) -> None:
    """G53: a rapid for one block; in G91 a control passes over it."""
    if control.state.side:
        raise Fault("GS150", "G53 is refused while cutter compensation is on", at="g53", hint="switch it off with G40")
    if control.state.incremental:
        control.warn("GS109", "G53 does nothing in G91", "say G90 before", place_of(words.block, "g53"))
        return
    if words.has_axes():
        with _by_axes(control):
            control.rapid(end_point(words, control), "G53")


@contextmanager
def _by_axes(control: FanucControl) -> Iterator[None]:
    """Moves to places of the machine are moves of the axes, also while the control holds the tip."""
    on = control.state.point_control
    tool_point.switch(control, on=False)
    yield
    tool_point.switch(control, on=on)


def _skip_function(words: Words, control: FanucControl) -> None:
    """G31: a straight feed that ends where the skip signal comes."""
    state = control.state
    if state.side:
        raise Fault("GS150", "G31 is refused while cutter compensation is on", at="g31", hint="say G40 first")
    check_feed(words, control, "G31")
    polar.resolve(words, control, start_point(control))
    figure.apply(words, control, 10)
    end = end_point(words, control)
    feed, unit = control.feed(control.moves_linear(end))
    control.out.append(
        canon.ProbeMove(
            span=control.span,
            end=control.si_axes(control.tip(end)),
            block=control.block_number,
            word="G31",
            feed=feed,
            feed_unit=unit,
            towards=True,
            must_trip=False,
        )
    )
    state.current = end


def _letters_of(words: Words) -> frozenset[str]:
    """Letters that codes other than motions use."""
    used = set()
    claimed = words.g.get(NON_MODAL)
    if claimed in (40, 300, 310):
        used |= {"p", "q"}
    if claimed == _CORNER_CIRCLE:
        used |= {"i", "j", "k"}
    if claimed in _NOT_SIMULATED:
        used |= {"e", "p", "q", "r"}
    if claimed == 100:
        used |= {"p", "r", "l", "q"}
    if COMPENSATION in words.g:
        used |= {"d", "h"}
    if STROKE in words.g:
        used |= {"i", "j", "k", "p", "q"}
    if any(code not in _OF_THE_CONTROL for code in words.m_codes):
        used |= {"p", "q", "r"}  # arguments of what the machine builder made
    return frozenset(used | {"h", "d"})


def _name_unused(words: Words, control: FanucControl, used: frozenset[str]) -> None:
    """Words that a control passes over without a message."""
    for letter in words.values:
        if letter not in used:
            name = letter.upper()
            control.warn(
                "GS104",
                f"nothing in this block uses the word {name}: the control passes over it",
                exponent(words.block) if letter == "e" else "drop it, or add the code that it belongs to",
                place_of(words.block, letter),
            )

"""Fanuc's drilling cycles: heights, Q, P and F pass on from one cycle to the next, K repeats, X and Y come first."""

from __future__ import annotations

from collections.abc import Callable

from gcodesim import canon
from gcodesim.frozen import frozen
from gcodesim.rs274.arcs import PLANE_AXES
from gcodesim.rs274.cycles import Head, check_repeats
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector
from gcodesim.rs274.words import Words
from gcodesim.units import INCH

_CLEARANCE_MM, _CLEARANCE_INCH = 0.254, 0.01  # a machine parameter in reality
_MOST_PECKS = 100_000
_MILLISECONDS = 1e-3
_NEVER_PECKS = frozenset((810, 820, 850, 860, 880, 890))
_NEEDS_Q = frozenset((730, 760, 830, 870))


@frozen(kw_only=False)
class FanucHole:
    """Heights along the drilling axis, in the work system and program units; dwell [s]."""

    bottom: float
    clear: float
    level: float  # where the hole is left: R or the initial level
    dwell: float
    step: float


def cycle(words: Words, control: FanucControl, code: int) -> None:
    """Take the data of the block, and drill where it names a place or a height."""
    state = control.state
    who = f"G{code // 10}"
    at = who.lower() if who.lower() in words.names else None
    if state.side:
        raise Fault("GS150", f"{who} is refused while cutter compensation is on", at=at, hint="say G40 first")
    first, second, normal = PLANE_AXES[state.plane]
    letter = "xyz"[normal]
    values = words.values
    if state.cycle == -1:
        state.cycle_start = state.current[normal]
        state.before_cycle = state.motion if 0 <= state.motion <= 330 else 0
        state.cycle_words, state.clear, state.bottom = (), None, None
    _take_heights(words, control, letter)
    data = dict(state.cycle_words)
    data.update({name: values[name] for name in "pq" if name in values})
    state.cycle, state.cycle_words = code, tuple(data.items())
    repeats = words.whole("k", who)
    if repeats is None:
        repeats = words.whole("l", who)
    if repeats is not None and repeats < 0:
        raise Fault("GS140", f"{who} with K{repeats}: K is 0 or more", at="k")
    end = end_point(words, control)
    if repeats == 0:
        _name_unused_place(end, control, (first, second), who)
        return
    if {"x", "y", "z", "r", "a", "b", "c"}.isdisjoint(values):
        return
    if "q" in values and code in _NEVER_PECKS:
        hint = "G83 or G73 drills in steps; leave Q away if none are meant"
        message = f"{who} drills in one go: Q{values['q']:g} is without effect"
        control.warn("GS141", message, hint, words.block.place_of("q"))
    hole = _hole(words, control, code, who, at, letter, data)
    check_repeats(repeats or 1, hole.clear - hole.bottom, hole.step, who, "k" if "k" in values else "l")
    _turn(end, control, who)
    head = Head(control, (first, second, normal), who)
    step = (end[first] - state.current[first], end[second] - state.current[second])
    place = (state.current[first], state.current[second])
    for _ in range(repeats or 1):
        place = (place[0] + step[0], place[1] + step[1]) if state.incremental else (end[first], end[second])
        head.rapid_over(place, state.current[normal])
        if code != 870:  # goes through the hole aside first
            head.rapid_to(hole.clear)
        _SHAPES[code](head, hole)


def _name_unused_place(end: Vector, control: FanucControl, plane: tuple[int, int], who: str) -> None:
    """K0 stores the data of the cycle and goes nowhere."""
    lost = [f"{'XYZ'[axis]}{end[axis]:g}" for axis in sorted(plane) if end[axis] != control.state.current[axis]]
    if lost:
        control.warn(
            "GS141",
            f"{who} with K0 drills no hole and goes nowhere: {' '.join(lost)} is without effect",
            "leave K0 away, or the place",
        )


def _turn(end: Vector, control: FanucControl, who: str) -> None:
    """Rotary axes are positioned before the first hole."""
    now = control.state.current
    if end[3:6] != now[3:6]:
        control.rapid((*now[:3], *end[3:6], *now[6:]), who)


def _take_heights(words: Words, control: FanucControl, letter: str) -> None:
    """R and the depth, as heights: in G91 R counts from the initial level and the depth from R."""
    state, values = control.state, words.values
    if "r" in values:
        state.clear = values["r"] + (state.cycle_start if state.incremental else 0.0)
    if letter in values:
        from_height = (state.cycle_start if state.clear is None else state.clear) if state.incremental else 0.0
        state.bottom = values[letter] + from_height


def _hole(
    words: Words, control: FanucControl, code: int, who: str, at: str | None, letter: str, data: dict[str, float]
) -> FanucHole:
    state = control.state
    if state.feed == 0.0:
        raise Fault("GS107", f"{who} without a feed: F is 0", at=at, hint="write F before or in this block")
    if state.bottom is None:
        raise Fault("GS140", f"{who} needs the word {letter.upper()}, the depth", at=at)
    clear = state.cycle_start if state.clear is None else state.clear
    if clear < state.bottom and code != 870:
        raise Fault(
            "GS140",
            f"R{clear:g} lies below {letter.upper()}{state.bottom:g}",
            at="r" if "r" in words.values else letter if letter in words.values else None,
            hint="R is the height above the hole from which it is fed",
        )
    step = data.get("q", 0.0)
    if code in _NEEDS_Q and step <= 0.0:
        raise Fault("GS140", f"{who} needs Q, and more than 0", at="q" if "q" in words.values else at)
    if code in (730, 830) and (clear - state.bottom) / step > _MOST_PECKS:
        raise Fault("GS140", f"{who} would need more than {_MOST_PECKS} pecks", at="q" if "q" in words.values else at)
    dwell = data.get("p", 0.0) * _MILLISECONDS
    if dwell < 0.0:
        raise Fault("GS106", f"the dwell of {who} is negative", at="p")
    return FanucHole(
        state.bottom, clear, clear if state.retract == 990 and code != 870 else state.cycle_start, dwell, step
    )


def _drill(head: Head, hole: FanucHole) -> None:
    """G81, G82."""
    head.feed_to(hole.bottom)
    if head.who == "G82":
        _dwell(head, hole)
    head.rapid_to(hole.level)


def _dwell(head: Head, hole: FanucHole) -> None:
    if hole.dwell:
        head.control.dwell(hole.dwell)


def _pecks(head: Head, hole: FanucHole, *, full: bool) -> None:
    """G83 comes out to R after each peck, G73 only a little."""
    gap = _CLEARANCE_INCH if head.control.state.unit == INCH else _CLEARANCE_MM
    depth = hole.clear - hole.step
    while depth > hole.bottom:
        head.feed_to(depth)
        if full:
            head.rapid_to(hole.clear)
        head.rapid_to(depth + gap)
        depth -= hole.step
    head.feed_to(hole.bottom)
    _dwell(head, hole)
    head.rapid_to(hole.level)


def _tap(head: Head, hole: FanucHole) -> None:
    """G84, G74: feed down, turn round, feed to R, turn round again; then out at rapid."""
    direction = -1 if head.who == "G74" else 1
    if head.control.state.spindle != direction:
        head.turn(direction)
    head.feed_to(hole.bottom)
    _dwell(head, hole)
    head.turn(-direction)
    head.feed_to(hole.clear)
    head.turn(direction)
    head.rapid_to(hole.level)


def _bore(head: Head, hole: FanucHole) -> None:
    """G85, G89: feed down, and feed up to R."""
    head.feed_to(hole.bottom)
    if head.who == "G89":
        _dwell(head, hole)
    head.feed_to(hole.clear)
    head.rapid_to(hole.level)


def _bore_stop(head: Head, hole: FanucHole) -> None:
    """G86: the spindle stands while the tool comes out."""
    direction = head.control.state.spindle
    head.feed_to(hole.bottom)
    if direction:
        head.turn(0)
    head.rapid_to(hole.level)
    if direction:
        head.turn(direction)


def _bore_by_hand(head: Head, hole: FanucHole) -> None:
    """G88: dwell, stop; the operator brings the tool out to R."""
    direction = head.control.state.spindle
    head.feed_to(hole.bottom)
    _dwell(head, hole)
    if direction:
        head.turn(0)
    head.control.out.append(canon.Stop(span=head.control.span))
    head.rapid_to(hole.clear)
    head.rapid_to(hole.level)
    if direction:
        head.turn(direction)


def _fine_bore(head: Head, hole: FanucHole) -> None:
    """G76: at the bottom the spindle is oriented and the edge lifted by Q along the first axis of the plane."""
    control = head.control
    direction = control.state.spindle
    now = control.state.current
    centre = (now[head.first], now[head.second])
    aside = (centre[0] + hole.step, centre[1])
    head.feed_to(hole.bottom)
    _dwell(head, hole)
    head.orient(direction)
    head.rapid_over(aside, hole.bottom)
    head.rapid_to(hole.level)
    head.rapid_over(centre, hole.level)
    head.turn(direction)


def _back_bore(head: Head, hole: FanucHole) -> None:
    """G87: through the hole aside, down to R, then bored upwards to Z; leaves at the initial level."""
    control = head.control
    direction = control.state.spindle
    now = control.state.current
    centre = (now[head.first], now[head.second])
    aside = (centre[0] + hole.step, centre[1])
    head.orient(direction)
    head.rapid_over(aside, now[head.normal])
    head.rapid_to(hole.clear)
    head.rapid_over(centre, hole.clear)
    head.turn(direction)
    head.feed_to(hole.bottom)
    _dwell(head, hole)
    head.orient(direction)
    head.rapid_over(aside, hole.bottom)
    head.rapid_to(hole.level)
    head.rapid_over(centre, hole.level)
    head.turn(direction)


_SHAPES: dict[int, Callable[[Head, FanucHole], None]] = {
    730: lambda head, hole: _pecks(head, hole, full=False),
    740: _tap,
    760: _fine_bore,
    810: _drill,
    820: _drill,
    830: lambda head, hole: _pecks(head, hole, full=True),
    840: _tap,
    850: _bore,
    860: _bore_stop,
    870: _back_bore,
    880: _bore_by_hand,
    890: _bore,
}

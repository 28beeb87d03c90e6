"""Canned cycles G73, G74, G81 to G89: holes at each X, Y of a chain of blocks."""

from __future__ import annotations

import math
from collections.abc import Callable

from gcodesim import canon
from gcodesim.arithmetic.scalars import atan2, cos, sin
from gcodesim.frozen import frozen
from gcodesim.rs274.arcs import PLANE_AXES
from gcodesim.rs274.control import Control
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector
from gcodesim.rs274.words import Words
from gcodesim.units import INCH

_CLEARANCE_MM, _CLEARANCE_INCH = 0.254, 0.01  # G73 and G83 stop this far before the last depth
_MOST_PECKS = 100_000
_MOST_MOVES = 1_000_000  # of one block
_STICKY = "rpqijk"
_NEEDS_P = frozenset((820, 860, 880, 890))
_NEEDS_Q = frozenset((730, 830))
_TAPS = frozenset((740, 840))
_NEEDS_SPINDLE = {740: (-1,), 840: (1,), 860: (1, -1), 870: (1, -1), 880: (1, -1)}


@frozen(kw_only=False)
class CycleWords:
    """One cycle's words, resolved: heights along the normal in program units."""

    bottom: float
    clear: float
    dwell: float
    step: float
    aside: tuple[float, float]  # G87: the shift in the plane
    middle: float  # G87: the height to bore back to


def cycle(words: Words, control: Control, code: int) -> None:
    """Execute the cycle `code` at the block's place, L times."""
    state = control.state
    who = f"G{code // 10}"
    at = who.lower() if who.lower() in words.names else None
    _check(words, control, code, who, at)
    first, second, normal = PLANE_AXES[state.plane]
    fresh = state.cycle != code
    sticky = {} if fresh else dict(state.cycle_words)
    for letter in ("xyz"[normal], *_STICKY):
        if letter in words.values:
            sticky[letter] = words.values[letter]
    repeats = words.whole("l", who)
    if repeats is not None and repeats < 1:
        raise Fault("GS140", f"{who} with L{repeats}: a cycle runs at least once", at="l")
    _need(sticky, code, who, at, "xyz"[normal])
    if state.cycle == -1:
        state.cycle_start = state.current[normal]
    base = state.cycle_start
    hole = _hole(sticky, code, base, words, control, who, normal)
    check_repeats(repeats or 1, hole.clear - hole.bottom, hole.step, who, "l")
    state.cycle, state.cycle_words = code, tuple(sticky.items())
    if code in _NEEDS_P or code in _TAPS:
        state.cycle_dwell = hole.dwell
    _run(words, control, hole, code, repeats or 1, (first, second, normal), who, base)


def check_repeats(repeats: int, depth: float, step: float, who: str, letter: str) -> None:
    """A fault when one block asks for so many holes and pecks that no shift would see their end."""
    moves = repeats * (4.0 + (3.0 * depth / step if step > 0.0 else 0.0))
    if moves > _MOST_MOVES:
        raise Fault(
            "GS140",
            f"{who} with {letter.upper()}{repeats} would be about {moves:.3g} moves; a block may be {_MOST_MOVES}",
            at=letter,
            hint="use a loop, or fewer repeats",
            value=moves,
            limit=_MOST_MOVES,
        )


def _check(words: Words, control: Control, code: int, who: str, at: str | None) -> None:
    state = control.state
    if state.side:
        raise Fault("GS150", f"{who} is refused while cutter compensation is on", at=at, hint="say G40 first")
    if state.feed_mode == 930:
        raise Fault("GS140", f"{who} cannot be used under G93", at=at, hint="say G94 and F before")
    if state.feed == 0.0:
        raise Fault("GS107", f"{who} without a feed: F is 0", at=at, hint="write F before or in this block")
    for letter in "abcuvw":
        if letter in words.values:
            raise Fault(
                "GS140", f"{who} takes no {letter.upper()} word", at=letter, hint="turn the axis in a block before"
            )
    turning = _NEEDS_SPINDLE.get(code)
    if turning is not None and state.turning not in turning:
        wanted = "clockwise (M3)" if turning == (1,) else "counterclockwise (M4)" if turning == (-1,) else "turning"
        raise Fault("GS108", f"{who} needs the spindle {wanted}", at=at, hint="say S and M3 before")


def _need(sticky: dict[str, float], code: int, who: str, at: str | None, depth_letter: str) -> None:
    wanted = [("r", "the clearance plane"), (depth_letter, "the depth")]
    if code in _NEEDS_P:
        wanted.append(("p", "the dwell in seconds"))
    if code in _NEEDS_Q:
        wanted.append(("q", "the depth of one peck"))
    if code == 870:
        wanted += [("i", "the shift in X"), ("j", "the shift in Y"), ("k", "the height to bore back to")]
    for letter, what in wanted:
        if letter not in sticky:
            raise Fault("GS140", f"{who} needs the word {letter.upper()}, {what}", at=at, lacks=letter)


def _hole(
    sticky: dict[str, float], code: int, base: float, words: Words, control: Control, who: str, normal: int
) -> CycleWords:
    """The words as heights; in G91 R counts from `base` and the depth from R."""
    letter = "xyz"[normal]
    incremental = control.state.incremental
    clear = sticky["r"] + (base if incremental else 0.0)
    bottom = sticky[letter] + (clear if incremental else 0.0)
    if clear < bottom:
        raise Fault(
            "GS140",
            f"R{clear:g} lies below {letter.upper()}{bottom:g}",
            at="r" if "r" in words.values else letter if letter in words.values else None,
            hint="R is the height above the hole from which it is fed",
        )
    step = sticky.get("q", 0.0)
    if code in _NEEDS_Q and step <= 0.0:
        raise Fault("GS140", f"the peck Q{step:g} of {who} must be positive", at="q")
    if code in _NEEDS_Q and (clear - bottom) / step > _MOST_PECKS:
        raise Fault("GS140", f"{who} would need more than {_MOST_PECKS} pecks", at="q" if "q" in words.values else None)
    dwell = sticky.get("p", control.state.cycle_dwell if code in _TAPS else 0.0)
    first, second, _ = PLANE_AXES[control.state.plane]
    aside = (sticky.get("ijk"[first], 0.0), sticky.get("ijk"[second], 0.0))
    middle = sticky.get("ijk"[normal], 0.0) + (bottom if incremental else 0.0)
    return CycleWords(bottom, clear, dwell, step, aside, middle)


def _run(
    words: Words,
    control: Control,
    hole: CycleWords,
    code: int,
    repeats: int,
    axes: tuple[int, int, int],
    who: str,
    base: float,
) -> None:
    """All holes of the block. `base` is the height at which the chain of cycles began."""
    first, second, normal = axes
    state = control.state
    place = (state.current[first], state.current[second])
    head = Head(control, axes, who)
    if base < hole.clear:
        head.rapid_to(hole.clear)
        base = hole.clear
    level = hole.clear if state.retract == 990 else base
    now = state.current[normal]
    height = now if now > hole.clear else level
    if state.path != 610:
        control.say_path(610)
    for _ in range(repeats):
        place = _next_place(words, control, place, (first, second))
        head.rapid_over(place, height)
        if height != hole.clear:
            head.rapid_to(hole.clear)
        _SHAPES[code](head, hole, level)
        height = level
    believed = list(state.current)
    believed[normal] = level  # also after G88, where the operator is to bring the tool there
    here = control.si_axes(control.tip(state.current))
    state.current = tuple(believed)  # type: ignore[assignment]
    if here != control.si_axes(control.tip(state.current)):
        state.strayed = (control.block_number, here)
    if state.path != 610:
        control.say_path()


def _next_place(
    words: Words, control: Control, place: tuple[float, float], axes: tuple[int, int]
) -> tuple[float, float]:
    """Where the next hole is after one at `place`; in G91 each of L holes goes on from the one before."""
    state = control.state
    values = words.values
    start = list(state.current)
    start[axes[0]], start[axes[1]] = place
    if words.has_polar() and not state.incremental:  # unlike in a move, no angle means that of the current point
        radius = values.get("@", math.hypot(start[0], start[1]))
        angle = math.radians(values["^"]) if "^" in values else atan2(start[1], start[0])
        return radius * cos(angle), radius * sin(angle)
    end = end_point(words, control, start=tuple(start))  # type: ignore[arg-type]
    return end[axes[0]], end[axes[1]]


class Head:
    """The tool over the holes: moves along the normal and in the plane."""

    def __init__(self, control: Control, axes: tuple[int, int, int], who: str) -> None:
        self.control = control
        self.first, self.second, self.normal = axes
        self.who = who

    def _at(self, first: float, second: float, height: float) -> Vector:
        point = list(self.control.state.current)
        point[self.first], point[self.second], point[self.normal] = first, second, height
        return tuple(point)  # type: ignore[return-value]

    def rapid_over(self, place: tuple[float, float], height: float) -> None:
        self.control.rapid(self._at(place[0], place[1], height), self.who)

    def rapid_to(self, height: float) -> None:
        now = self.control.state.current
        self.control.rapid(self._at(now[self.first], now[self.second], height), self.who)

    def feed_to(self, height: float) -> None:
        now = self.control.state.current
        self.control.line(self._at(now[self.first], now[self.second], height), self.who)

    def orient(self, direction: int) -> None:
        """Stop the spindle at 0 degrees, approached in the direction in which it turned."""
        self.turn(0)
        self.control.out.append(canon.Orient(span=self.control.span, angle=0.0, direction=2 if direction > 0 else 3))

    def turn(self, direction: int) -> None:
        self.control.state.spindle = direction
        self.control.say_spindle()


def _drill(head: Head, hole: CycleWords, level: float) -> None:
    """G81, G82: feed down, dwell, out."""
    head.feed_to(hole.bottom)
    if hole.dwell and head.who == "G82":
        head.control.dwell(hole.dwell)
    head.rapid_to(level)


def _clearance(head: Head) -> float:
    return _CLEARANCE_INCH if head.control.state.unit == INCH else _CLEARANCE_MM


def _peck(head: Head, hole: CycleWords, level: float) -> None:
    """G83: full retract after each peck."""
    gap = _clearance(head)
    depth = hole.clear - hole.step
    while depth > hole.bottom:
        head.feed_to(depth)
        head.rapid_to(hole.clear)
        head.rapid_to(depth + gap)
        depth -= hole.step
    head.feed_to(hole.bottom)
    head.rapid_to(level)


def _chip_break(head: Head, hole: CycleWords, level: float) -> None:
    """G73: a short step back after each peck."""
    gap = _clearance(head)
    depth = hole.clear - hole.step
    while depth > hole.bottom:
        head.feed_to(depth)
        head.rapid_to(depth + gap)
        depth -= hole.step
    head.feed_to(hole.bottom)
    head.rapid_to(level)


def _tap(head: Head, hole: CycleWords, level: float) -> None:
    """G84, G74: feed both ways, the spindle reverses at the bottom; overrides are off meanwhile."""
    control = head.control
    direction = control.state.spindle
    before = control.state.switches
    control.say_overrides(feed=False, speed=False)
    if head.normal != 2 and control.dialect.name == "linuxcnc":
        _tap_astray(head, hole, level, direction)
        control.say_overrides(**before)
        head.turn(direction)
        return
    head.feed_to(hole.bottom)
    head.turn(-direction)
    if hole.dwell:
        control.dwell(hole.dwell)
    head.feed_to(level)
    control.say_overrides(**before)
    head.turn(direction)


def _tap_astray(head: Head, hole: CycleWords, level: float, direction: int) -> None:
    """Outside G17 LinuxCNC 2.9 feeds to swapped axes, also by the expected results of its own tests."""
    control = head.control
    now = control.state.current
    control.warn(
        "GS140",
        f"{head.who} outside G17: LinuxCNC 2.9 feeds to the wrong axes, and so does this run",
        "tap in G17 only",
    )

    def feed(height: float) -> None:
        at = (now[head.first], now[head.second])
        x, y, z = (height, at[0], at[1]) if head.normal == 1 else (at[1], height, at[0])
        control.line((x, y, z, *now[3:]), head.who)

    feed(hole.bottom)
    head.turn(-direction)
    if hole.dwell:
        control.dwell(hole.dwell)
    feed(level)
    control.state.strayed = (control.block_number, control.si_axes(control.tip(control.state.current)))
    back = list(now)
    back[head.normal] = level
    control.state.current = tuple(back)  # type: ignore[assignment]


def _bore(head: Head, hole: CycleWords, level: float) -> None:
    """G85: feed down, feed up to R, out."""
    head.feed_to(hole.bottom)
    head.feed_to(hole.clear)
    head.rapid_to(level)


def _bore_dwell(head: Head, hole: CycleWords, level: float) -> None:
    """G89: feed down, dwell, feed all the way up."""
    head.feed_to(hole.bottom)
    head.control.dwell(hole.dwell)
    head.feed_to(level)


def _bore_stop(head: Head, hole: CycleWords, level: float) -> None:
    """G86: dwell and stop the spindle at the bottom, out at rapid."""
    direction = head.control.state.spindle
    head.feed_to(hole.bottom)
    head.control.dwell(hole.dwell)
    head.turn(0)
    head.rapid_to(level)
    head.turn(direction)


def _back_bore(head: Head, hole: CycleWords, level: float) -> None:
    """G87: through the hole with the spindle oriented, then bore back up to K and return the same way."""
    control = head.control
    direction = control.state.spindle
    now = control.state.current
    centre = (now[head.first], now[head.second])
    aside = (centre[0] + hole.aside[0], centre[1] + hole.aside[1])
    head.rapid_over(aside, hole.clear)
    head.orient(direction)
    head.rapid_over(aside, hole.bottom)
    head.rapid_over(centre, hole.bottom)
    head.turn(direction)
    head.feed_to(hole.middle)
    head.feed_to(hole.bottom)
    head.orient(direction)
    head.rapid_over(aside, hole.bottom)
    head.rapid_over(aside, level)
    head.rapid_over(centre, level)
    head.turn(direction)


def _bore_manual(head: Head, hole: CycleWords, level: float) -> None:
    """G88: dwell, stop spindle and program at the bottom; the operator brings the tool out."""
    del level
    direction = head.control.state.spindle
    head.feed_to(hole.bottom)
    head.control.dwell(hole.dwell)
    head.turn(0)
    head.control.out.append(canon.Stop(span=head.control.span))
    head.turn(direction)


_SHAPES: dict[int, Callable[[Head, CycleWords, float], None]] = {
    730: _chip_break,
    740: _tap,
    810: _drill,
    820: _drill,
    830: _peck,
    840: _tap,
    850: _bore,
    860: _bore_stop,
    870: _back_bore,
    880: _bore_manual,
    890: _bore_dwell,
}

"""`,C` and `,R`: a chamfer or a rounding put in where a move meets the next one.

Where a corner begins depends on the move behind it, so a move with such a word
waits, as programmed, for that one. Both are then shortened, before cutter
compensation sees them. In the active plane: `P` the corner as programmed, `T`
the points where the inserted piece begins and ends.
"""

from __future__ import annotations

from dataclasses import replace

from gcodesim.arithmetic.scalars import atan2
from gcodesim.canon import Event
from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen
from gcodesim.rs274 import compensation
from gcodesim.rs274.arcs import PLANE_AXES, arc_of
from gcodesim.rs274.circles import Arc, Line, PlaneCircle, Point, apart, meet, sweep_of
from gcodesim.rs274.dialects.linuxcnc import DISTANCE, MOTION, NON_MODAL, STOPPING
from gcodesim.rs274.ends import end_point, start_point
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.feeds import check_feed
from gcodesim.rs274.motions import MOTIONS
from gcodesim.rs274.state import AXES, Vector
from gcodesim.rs274.words import Words
from gcodesim.units import MM

LETTERS = frozenset((",c", ",r"))
_FEEDS = (10, 20, 30)
_LINE, _CLOCKWISE, _COUNTERCLOCKWISE = _FEEDS
_STRAIGHT_ON = 1e-6  # [rad] flatter corners are none
_SLACK = 1e-9  # of a length: what fits exactly, fits


@frozen
class CornerMove:
    """A feed as programmed, in program units: G code (times ten), ends, the arc of G2 and G3, and where it stands."""

    code: int
    start: Vector
    end: Vector
    arc: Arc | None
    feed: tuple[float, float]
    span: Span
    block: int


@frozen
class Corner:
    """A move that waits for the next one, and the size of what comes between: `,C` or `,R` [program units]."""

    move: CornerMove
    rounded: bool
    size: float

    @property
    def word(self) -> str:
        return f",{'R' if self.rounded else 'C'}{self.size:g}"


def is_near(words: Words, control: FanucControl) -> bool:
    """Whether the block has a corner at its end, or comes behind one."""
    return control.state.corner is not None or not LETTERS.isdisjoint(words.values)


def check_follows(words: Words, control: FanucControl) -> None:
    """A move with a corner at its end can only be followed by a feed in the same plane."""
    waiting = control.state.corner
    if waiting is None:
        return
    code = words.g.get(MOTION, control.state.motion)
    moves = words.has_axes() or (code != _LINE and not {"i", "j", "k"}.isdisjoint(words.values))
    if code not in _FEEDS or not moves or not words.g.keys() <= {MOTION, DISTANCE} or STOPPING in words.m:
        control.state.corner = None
        control.finished = words.m.get(STOPPING) in (2, 30)
        hint = f"write a G1, G2 or G3 in the plane behind it, or drop the {waiting.word[:2]}"
        where = f"the corner {waiting.word} of line {waiting.move.span.line}"
        raise Fault("GS142", f"{where} needs a move to go on with in the next block", hint=hint)


def move(words: Words, control: FanucControl, code: int) -> None:
    """A feed with a corner at its start, at its end, or at both; it settles compensation where it waits."""
    state, waiting = control.state, control.state.corner
    if code not in _FEEDS or words.g.get(NON_MODAL) is not None:
        raise Fault("GS142", "a corner stands between feeds: G1, G2 or G3", at=_letter(words))
    if state.feed_mode == 930:
        raise Fault("GS142", "corners are not simulated under G93", at=_letter(words), hint="say G94 before")
    check_feed(words, control, f"G{code // 10}")
    start = start_point(control) if waiting is None else waiting.move.end
    end = end_point(words, control, start=start)
    arc = None if code == _LINE else arc_of(words, control, start, end, code)
    feed = (state.feed, state.feed_unit)
    here = CornerMove(
        code=code, start=start, end=end, arc=arc, feed=feed, span=control.span, block=control.block_number
    )
    following = _corner_of(words, control, here)
    done: list[Event] = []
    if waiting is not None:
        state.corner = None
        own, control.out[:] = list(control.out), []
        first, between, here = _joined(control, waiting, here)
        for piece in (first, between):
            if piece is not None:
                _make(words, control, piece)
                if state.side:
                    compensation.settle(control)
                done += control.out
                control.out.clear()
        control.out += own
    if following is None:
        _make(words, control, here)
    else:
        state.corner = replace(following, move=here)
        if state.side:
            compensation.settle(control)
    control.out[:0] = done


def _letter(words: Words) -> str | None:
    return next((letter for letter in LETTERS if letter in words.values), None)


def _corner_of(words: Words, control: FanucControl, here: CornerMove) -> Corner | None:
    """The corner at the end of a move."""
    sizes = {letter: words.values[letter] for letter in sorted(LETTERS) if letter in words.values}
    if not sizes:
        return None
    if len(sizes) > 1:
        raise Fault("GS142", "one corner has a chamfer ,C or a rounding ,R, not both", at=",r", hint="drop one")
    ((letter, size),) = sizes.items()
    if size < 0.0:
        raise Fault("GS106", f"{letter.upper()} is negative: {size:g}", at=letter, value=size)
    if STOPPING in words.m:
        raise Fault("GS142", "a corner needs a move behind it, not a stop", at=letter)
    factor = abs(control.state.scale[PLANE_AXES[control.state.plane][0]])
    return Corner(move=here, rounded=letter == ",r", size=size * factor) if size else None


def _make(words: Words, control: FanucControl, piece: CornerMove) -> None:
    """Let the control make the move, as if a block of its own said so."""
    state = control.state
    own = Words(words.block)
    own.values = dict(zip(AXES, piece.end, strict=True))
    if piece.arc is not None:
        now = start_point(control)
        first, second, _ = PLANE_AXES[state.plane]
        own.values |= {"ijk"[axis]: at - now[axis] for axis, at in zip((first, second), piece.arc.centre, strict=True)}
        if abs(piece.arc.turns) > 1:
            own.values["p"] = abs(piece.arc.turns)
    kept = control.span, control.block_number, state.incremental, state.feed, state.feed_unit
    control.span, control.block_number, state.incremental = piece.span, piece.block, False
    state.feed, state.feed_unit = piece.feed
    try:
        MOTIONS[piece.code](own, control, piece.code)
    finally:
        control.span, control.block_number, state.incremental, state.feed, state.feed_unit = kept


# -- geometry in the plane


def _joined(
    control: FanucControl, corner: Corner, following: CornerMove
) -> tuple[CornerMove, CornerMove | None, CornerMove]:
    """The move before, what comes between, and the move behind, each as far as it is left."""
    before = corner.move
    plane = PLANE_AXES[control.state.plane]
    for one in (before, following):
        if any(one.start[axis] != one.end[axis] for axis in range(9) if axis not in plane[:2]):
            where = f"the corner {corner.word} of line {before.span.line}"
            raise Fault("GS142", f"{where} stands between moves that leave the plane", hint="move in the plane only")
    u, v = _direction(before, plane, at_end=True), _direction(following, plane, at_end=False)
    turn = atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])
    if abs(turn) < _STRAIGHT_ON:
        return before, None, following
    arc: Arc | None = None
    code = _LINE
    if corner.rounded:
        code = _COUNTERCLOCKWISE if turn > 0.0 else _CLOCKWISE
        centre = _centre(corner, before, following, plane, left=turn > 0.0)
        arc = Arc(centre, 1 if turn > 0.0 else -1)
        first, second = _foot(before, plane, centre, u), _foot(following, plane, centre, v)
    else:
        first = _at_distance(corner, before, plane, (-u[0], -u[1]))
        second = _at_distance(corner, following, plane, v)
    _check_fits(control, corner, before, plane, first, at_end=True)
    _check_fits(control, corner, following, plane, second, at_end=False)
    shortened = replace(before, end=_with(before.end, plane, first))
    begun = replace(following, start=_with(following.start, plane, second))
    between = replace(before, code=code, start=shortened.end, end=begun.start, arc=arc)
    return shortened, between, begun


def _flat(point: Vector, plane: tuple[int, int, int]) -> Point:
    return point[plane[0]], point[plane[1]]


def _with(point: Vector, plane: tuple[int, int, int], place: Point) -> Vector:
    out = list(point)
    out[plane[0]], out[plane[1]] = place
    return tuple(out)  # type: ignore[return-value]


def _direction(one: CornerMove, plane: tuple[int, int, int], *, at_end: bool) -> Point:
    """Unit vector along the move at its end or start."""
    start, end = _flat(one.start, plane), _flat(one.end, plane)
    if one.arc is None:
        length = apart(start, end)
        if length == 0.0:
            raise Fault("GS142", "a corner needs a move, and this one leads nowhere")
        return (end[0] - start[0]) / length, (end[1] - start[1]) / length
    at, centre = end if at_end else start, one.arc.centre
    radius = apart(centre, at)
    out = (at[0] - centre[0]) / radius, (at[1] - centre[1]) / radius
    return (-out[1], out[0]) if one.arc.turns > 0 else (out[1], -out[0])


def _centre(
    corner: Corner, before: CornerMove, following: CornerMove, plane: tuple[int, int, int], *, left: bool
) -> Point:
    """The centre of a rounding: as far from both moves as its radius, on the inside of the corner."""

    def beside(one: CornerMove, *, at_end: bool) -> Line | PlaneCircle:
        at = _flat(one.end if at_end else one.start, plane)
        if one.arc is not None:
            inwards = (one.arc.turns > 0) == left
            radius = apart(one.arc.centre, at)
            return PlaneCircle(one.arc.centre, abs(radius - corner.size if inwards else radius + corner.size))
        x, y = _direction(one, plane, at_end=at_end)
        side = corner.size if left else -corner.size
        return Line((at[0] - side * y, at[1] + side * x), (x, y))

    found = meet(beside(before, at_end=True), beside(following, at_end=False))
    if not found:
        raise _too_large(corner, hint="the circle finds no place between the moves")
    return min(found, key=lambda centre: apart(centre, _flat(before.end, plane)))


def _foot(one: CornerMove, plane: tuple[int, int, int], centre: Point, direction: Point) -> Point:
    """Where a circle about `centre` touches the move."""
    if one.arc is None:
        at = _flat(one.end, plane)
        along = (centre[0] - at[0]) * direction[0] + (centre[1] - at[1]) * direction[1]
        return at[0] + along * direction[0], at[1] + along * direction[1]
    middle = one.arc.centre
    factor = apart(middle, _flat(one.end, plane)) / apart(middle, centre)
    return middle[0] + (centre[0] - middle[0]) * factor, middle[1] + (centre[1] - middle[1]) * factor


def _at_distance(corner: Corner, one: CornerMove, plane: tuple[int, int, int], away: Point) -> Point:
    """The point of the move that is `corner.size` from the corner, which it leaves in direction `away`."""
    at = _flat(corner.move.end, plane)
    if one.arc is None:
        return at[0] + corner.size * away[0], at[1] + corner.size * away[1]
    radius = apart(one.arc.centre, at)
    found = meet(PlaneCircle(one.arc.centre, radius), PlaneCircle(at, corner.size))
    if not found:
        raise _too_large(corner, hint="the arc ends before")
    return max(found, key=lambda point: (point[0] - at[0]) * away[0] + (point[1] - at[1]) * away[1])


def _check_fits(
    control: FanucControl, corner: Corner, one: CornerMove, plane: tuple[int, int, int], place: Point, *, at_end: bool
) -> None:
    """Raise a fault where the corner needs more of the move than there is."""
    start, end = _flat(one.start, plane), _flat(one.end, plane)
    if one.arc is None:
        needed, there = apart(place, end if at_end else start), apart(start, end)
    else:
        part = (place, end) if at_end else (start, place)
        radius = apart(one.arc.centre, end)
        single = Arc(one.arc.centre, 1 if one.arc.turns > 0 else -1)
        needed, there = abs(sweep_of(*part, single)) * radius, abs(sweep_of(start, end, one.arc)) * radius
    if needed > there * (1.0 + _SLACK):
        factor = control.state.unit / MM
        which = "before" if at_end else "behind"
        hint = f"it takes {needed * factor:.3f} mm of the move {which} it, which has {there * factor:.3f} mm"
        raise _too_large(corner, hint=hint, needed=needed * factor, there=there * factor)


def _too_large(corner: Corner, *, hint: str, needed: float | None = None, there: float | None = None) -> Fault:
    message = f"the corner {corner.word} of line {corner.move.span.line} does not fit between its moves"
    return Fault("GS142", message, hint=hint, value=needed, limit=there, unit=None if needed is None else "mm")

"""G39: an outside corner of the offset path is rounded by an arc about it.

    G39          the arc ends at right angles to the move behind it
    G39 I_ J_    at right angles to this direction; the next move goes from there straight to its own end

The block moves nothing itself. The tool turns clockwise by G41, counterclockwise by G42.
"""

from __future__ import annotations

import math

from gcodesim.canon import FeedUnit
from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen
from gcodesim.rs274.circles import Point, apart
from gcodesim.rs274.compensation import (
    PLANE,
    Held,
    NextMove,
    beside,
    emit,
    flush,
    left,
    pause,
    right,
    turn_outward,
    with_plane,
)
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.feeds import check_feed
from gcodesim.rs274.words import Words

_FLAT = 1e-6  # [rad] flatter corners are none


@frozen
class CornerCircle:
    """A G39 that waits for the move behind it: where it stands, and its feed."""

    span: Span
    block: int
    feed: float
    feed_unit: FeedUnit


def begin(words: Words, control: FanucControl) -> None:
    """Execute the block of G39; without I, J and K the arc follows when the next move is known."""
    state = control.state
    if not state.side or state.comp_first:
        hint = "say G41 or G42 before, and move to the contour"
        raise Fault("GS153", "G39 rounds a corner of the compensated path, and there is none", at="g39", hint=hint)
    if words.has_axes():
        at = next(letter for letter in "xyzabc" if letter in words.values)
        hint = "write the move into the next block; I and J give a direction"
        raise Fault("GS106", "a block with G39 moves nothing itself", at=at, hint=hint)
    check_feed(words, control, "G39")
    feed, unit = control.feed(linear=True)
    pause(control)
    circle = CornerCircle(span=control.span, block=control.block_number, feed=feed, feed_unit=unit)
    first, second, _ = PLANE[state.plane]
    letters = "ijk"[first], "ijk"[second]
    if not any(letter in words.values for letter in letters):
        state.comp_circle = circle
        return
    along = words.values.get(letters[0], 0.0), words.values.get(letters[1], 0.0)
    length = apart((0.0, 0.0), along)
    if length == 0.0:
        raise Fault("GS106", f"{letters[0].upper()} {letters[1].upper()} of zero is no direction", at="g39")
    direction = along[0] / length, along[1] / length
    normal = left(direction) if state.side > 0 else right(direction)
    op = state.comp_programmed[first], state.comp_programmed[second]
    _go_round(control, circle, op, normal, turn_outward(state.comp_normal, normal, state.side))


def finish(control: FanucControl, to: NextMove, turn: float) -> None:
    """The arc of a G39 that has waited, before the move behind it."""
    circle, control.state.comp_circle = control.state.comp_circle, None
    assert circle is not None
    flush(control)
    _go_round(control, circle, to.op, to.normal, turn)


def _go_round(control: FanucControl, circle: CornerCircle, op: Point, normal: Point, turn: float) -> None:
    """The arc from where the tool stands to `normal` beside the corner, which turns by `turn` [rad]."""
    state = control.state
    if abs(turn) <= _FLAT or state.comp_radius == 0.0:
        return
    if turn < 0.0 or turn > math.pi + _FLAT:
        hint = "G39 is for outside corners: leave it away here"
        raise Fault("GS152", "G39 stands at an inside corner: the tool would cut into the part", hint=hint)
    end = with_plane(state.comp_emitted, control, beside(op, normal, state.comp_radius))
    turns, word = (-1, "G2") if state.side > 0 else (1, "G3")
    piece = Held(
        span=circle.span,
        kind="arc",
        end=end,
        centre=op,
        turns=turns,
        feed=circle.feed,
        feed_unit=circle.feed_unit,
        block=circle.block,
        word=word,
    )
    emit(control, piece)
    state.current = end


__all__ = ["CornerCircle", "begin", "finish"]

"""Whether a feed move may start, and how fast it is."""

from __future__ import annotations

import math

from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector
from gcodesim.rs274.words import Words


def check_feed(words: Words, control: Control, who: str) -> None:
    """A feed move needs F: in every block under G93, a turning spindle under G95."""
    state = control.state
    at = who.lower() if who.lower() in words.names else None
    if state.feed_mode == 930:
        if "f" not in words.values:
            raise Fault(
                "GS107", f"{who} under G93 needs F in its own block", at=at, hint="F is 1 over the minutes of the move"
            )
    elif state.feed == 0.0:
        raise Fault("GS107", f"{who} without a feed: F is 0", at=at, hint="write F before or in this block")
    elif state.feed_mode == 950 and state.speed == 0.0:
        raise Fault(
            "GS108", f"{who} under G95 needs a spindle speed: S is 0", at=at, hint="write S before or in this block"
        )


def straight_length(start: Vector, end: Vector) -> float:
    """Length of a straight move as G93 counts it: X Y Z, else U V W, else the rotary axes [program units or deg]."""
    delta = [b - a for a, b in zip(start, end, strict=True)]
    for group in ((0, 1, 2), (6, 7, 8), (3, 4, 5)):
        x, y, z = (delta[axis] for axis in group)
        length = math.sqrt(x * x + y * y + z * z)  # not `hypot`: the compiled lane has to have the same last bit
        if length:
            return length
    return 0.0


def resolve_inverse_time(words: Words, control: Control, length: float) -> None:
    """Under G93: the rate of this move from its length; never below 0.1 per minute, as on the control."""
    state = control.state
    if state.feed_mode == 930:
        state.feed = max(0.1, length * words.values["f"])
        state.feed_unit = state.unit

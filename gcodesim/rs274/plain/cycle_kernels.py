"""Holes of canned cycles: `rs274/cycles.py` for G73, G81 to G83, G85 and G89, step by step the same."""

from __future__ import annotations

from typing import NamedTuple

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.arc_kernels import plane_axes
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.control_kernels import act, append
from gcodesim.rs274.plain.layout_kernels import (
    ACTS,
    BACK,
    CENTRE_ABSOLUTE,
    COMPENSATES,
    CURRENT,
    CYCLE,
    CYCLE_DEPTH,
    CYCLE_DWELL,
    CYCLE_P,
    CYCLE_Q,
    CYCLE_R,
    CYCLE_START,
    DWELL,
    EXACT,
    EXACT_PATH,
    FEED,
    FEED_MODE,
    FEED_UNIT,
    INCH,
    INCREMENTAL,
    IS_EXTENDED,
    MOTION,
    PLANE,
    RETRACT_TO_R,
    ROWS,
    RUNNING,
    STARTED,
    TARGET,
    UNIT,
    VALUES,
    WANTED,
    WANTS_R,
)

_F, _P, _Q, _R, _X = 5, 15, 16, 17, 23
_PLACES = (1 << 23) | (1 << 24) | (1 << 25)
_UNDERSTOOD = _PLACES | (1 << 5) | (1 << 6) | (1 << 17)  # F, G and R
_CLEARANCE_MM, _CLEARANCE_INCH = 0.254, 0.01  # as in cycles.py
_MOST_PECKS = 100_000


class Hole(NamedTuple):
    """A hole of the cycle `code`, in the active work system.

    Where it is in the plane, the level from which the cycle began, the one above the hole and the bottom, and how it
    is pecked: by `step`, so many times; and whether the tool dwells at the bottom.
    """

    code: int
    to_a: float
    to_b: float
    base: float
    clear: float
    bottom: float
    step: float
    pecks: float
    dwells: bool


@kernel
def hole(code: int, seen: int, numbers: Column, modes: Column, moves: Column, facts: Column, acts: Column) -> bool:
    """The moves of one line that starts the cycle `code` or runs it again; False, and nothing done, when it is left."""
    pecking, dwelling = code == 730 or code == 830, code == 820 or code == 890
    understood = _UNDERSTOOD | (1 << _Q if pecking else 0) | (1 << _P if dwelling else 0)
    if seen & _PLACES == 0 or seen & ~understood != 0 or modes[FEED_MODE] == 930 or modes[COMPENSATES]:
        return False
    first, second, normal = plane_axes(modes[PLANE])
    if modes[RUNNING] != code:
        needs = (1 << _R) | (1 << (_X + normal)) | (understood & ~_UNDERSTOOD)
        if seen & needs != needs:
            return False
    elif modes[CYCLE] != code:
        return False
    if (modes[WANTED + 1] != modes[PLANE]) or (code == 730 and not modes[IS_EXTENDED]):
        return False
    dwell = numbers[VALUES + _P] if (seen >> _P) & 1 else numbers[CYCLE_P]
    if dwell != numbers[CYCLE_P] and modes[ACTS] > 0:
        return False  # the acts of a batch have one dwell
    step = numbers[VALUES + _Q] if (seen >> _Q) & 1 else numbers[CYCLE_Q]
    has_feed = (seen >> _F) & 1 != 0
    rate = numbers[VALUES + _F] if has_feed else numbers[FEED]
    if rate <= 0.0:
        return False
    incremental = modes[WANTED + 2] != 0
    base = numbers[CYCLE_START] if modes[RUNNING] >= 0 else numbers[CURRENT + normal]
    retract = numbers[VALUES + _R] if (seen >> _R) & 1 else numbers[CYCLE_R]
    depth = numbers[VALUES + _X + normal] if (seen >> (_X + normal)) & 1 else numbers[CYCLE_DEPTH]
    clear = retract + (base if incremental else 0.0)
    bottom = depth + (clear if incremental else 0.0)
    dwells = code == 890 or (code == 820 and dwell != 0.0)
    if not clear >= bottom or (dwells and dwell < 0.0):
        return False
    pecks = 0.0
    if pecking:
        if not step > 0.0:
            return False
        pecks = (clear - bottom) / step
    if pecks > _MOST_PECKS or modes[ROWS] + 3.0 * pecks + 8.0 > len(moves):
        return False
    numbers[CYCLE_R], numbers[CYCLE_DEPTH] = retract, depth
    numbers[CYCLE_P], numbers[CYCLE_Q], numbers[CYCLE_START] = dwell, step, base
    if dwelling:
        numbers[CYCLE_DWELL] = dwell
    if modes[RUNNING] != code:
        modes[STARTED] = 1
    modes[MOTION], modes[CYCLE], modes[RUNNING] = code, code, code
    modes[INCREMENTAL], modes[CENTRE_ABSOLUTE] = modes[WANTED + 2], modes[WANTED + 3]
    modes[RETRACT_TO_R] = modes[WANTS_R]
    if has_feed:
        numbers[FEED], numbers[FEED_UNIT] = rate, numbers[UNIT]
    to_a = _end(seen, numbers, first, incremental)
    to_b = _end(seen, numbers, second, incremental)
    found = Hole(code, to_a, to_b, base, clear, bottom, step, pecks, dwells)
    _drill(found, incremental, numbers, modes, moves, facts, acts)
    return True


@kernel
def _drill(
    hole: Hole, incremental: bool, numbers: Column, modes: Column, moves: Column, facts: Column, acts: Column
) -> None:
    """The moves of a hole, as rows."""
    code, to_a, to_b, base, clear, bottom, step, pecks, dwells = hole
    first, second, normal = plane_axes(modes[PLANE])
    word = code // 10
    a, b = numbers[CURRENT + first], numbers[CURRENT + second]
    if incremental:
        to_a, to_b = a + (to_a - a), b + (to_b - b)
    if base < clear:
        _along(numbers, modes, moves, facts, normal, clear, 0, word)
        base = clear
    level = clear if modes[RETRACT_TO_R] else base
    now = numbers[CURRENT + normal]
    height = now if now > clear else level
    if not modes[EXACT_PATH]:
        act(modes, acts, EXACT)
    _aim(numbers)
    numbers[TARGET + first], numbers[TARGET + second], numbers[TARGET + normal] = to_a, to_b, height
    append(numbers, modes, moves, facts, 0, word, True)
    if height != clear:
        _along(numbers, modes, moves, facts, normal, clear, 0, word)
    if pecks > 0.0:
        gap = _CLEARANCE_INCH if modes[INCH] else _CLEARANCE_MM
        down = clear - step
        while down > bottom:
            _along(numbers, modes, moves, facts, normal, down, 1, word)
            if code == 830:
                _along(numbers, modes, moves, facts, normal, clear, 0, word)
            _along(numbers, modes, moves, facts, normal, down + gap, 0, word)
            down -= step
    _along(numbers, modes, moves, facts, normal, bottom, 1, word)
    if dwells:
        act(modes, acts, DWELL)
    if code == 850:
        _along(numbers, modes, moves, facts, normal, clear, 1, word)
    _along(numbers, modes, moves, facts, normal, level, 1 if code == 890 else 0, word)
    if not modes[EXACT_PATH]:
        act(modes, acts, BACK)


@kernel
def _end(seen: int, numbers: Column, axis: int, incremental: bool) -> float:
    """Where the line's word of `axis` leads, in the active work system."""
    now: float = numbers[CURRENT + axis]
    if (seen >> (_X + axis)) & 1:
        value: float = numbers[VALUES + _X + axis]
        return now + value if incremental else value
    return now


@kernel
def _aim(numbers: Column) -> None:
    for axis in range(6):
        numbers[TARGET + axis] = numbers[CURRENT + axis]


@kernel
def _along(
    numbers: Column, modes: Column, moves: Column, facts: Column, normal: int, height: float, kind: int, word: int
) -> None:
    """Move along the normal to `height`."""
    _aim(numbers)
    numbers[TARGET + normal] = height
    append(numbers, modes, moves, facts, kind, word, True)

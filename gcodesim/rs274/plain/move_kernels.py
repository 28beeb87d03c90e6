"""Plain lines executed on arrays: `rs274/execute.py`, `motions.py` and `arcs.py` for what CAM systems write.

A line is executed here only when it is certain what it does and that it is
right; every other line, and so every finding, belongs to the grammar's lane.
A line that is left has changed nothing.
"""

from __future__ import annotations

import math

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.arc_kernels import apart, centre_by_radius, radii_agree, sweep_of
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.scan_kernels import NOT_PLAIN, scan_line

# places in the array of numbers: points X Y Z A B C, then single values
CURRENT, G92, ORIGIN = 0, 6, 12
COS, SIN, UNIT, FEED, FEED_UNIT, DEG, MINUTE, NUMBERS = 18, 19, 20, 21, 22, 23, 24, 25
# places in the array of modes; the last three say what happened
MOTION, PLANE, INCREMENTAL, CENTRE_ABSOLUTE, FEED_MODE, ROTATED, INCH, HAS_SPEED = 0, 1, 2, 3, 4, 5, 6, 7
MOVED, ROWS, ARCS, MODES = 8, 9, 10, 11

_F, _I, _P, _R = 5, 8, 15, 17
_AXIS_LETTERS = np.array([23, 24, 25, 0, 1, 2])  # X Y Z A B C
_AXES = (1 << 23) | (1 << 24) | (1 << 25) | 7
_CENTRE = (1 << 8) | (1 << 9) | (1 << 10)
_OF_ARCS = _CENTRE | (1 << 15) | (1 << 17)
_NONE, _BAD = -1, -2


@kernel
def run_lines(
    text: Column,
    starts: Column,
    numbers: Column,
    modes: Column,
    kind: Column,
    end: Column,
    feed: Column,
    rotary: Column,
    place: Column,
    center: Column,
    normal: Column,
    sweep: Column,
    turns: Column,
    values: Column,
    codes: Column,
    wanted: Column,
    target: Column,
    middle: Column,
    first: int,
    last: int,
    longest: int,
) -> int:
    """Execute lines from index `first` to before `last` as far as they are plain; returns where it stopped.

    `text` with `starts` (see `LineTable`); `longest` is the most characters a line may have. `numbers` and `modes`
    are the state before and after. Moves are appended to `kind`, `end`, `feed`, `rotary` and `place`, arcs to
    `center`, `normal`, `sweep` and `turns` as well, all as in `canon.MoveBatch`; a full array ends the run too.
    The rest is room to work in: `values` (26,), `codes` (MOST_CODES + 1,) and `wanted` (4,) integers, two points (6,).
    """
    rows, arcs = 0, 0
    index = first
    while index < last and rows < len(kind):
        begin, stop = starts[index], starts[index + 1]
        if stop > begin and text[stop - 1] == 10:
            stop -= 1
        if stop > begin and text[stop - 1] == 13:
            stop -= 1
        if stop - begin > longest:
            break
        seen = scan_line(text, begin, stop, values, codes)
        if seen == NOT_PLAIN:
            break
        if seen != 0:
            shape = _execute(seen, values, codes, numbers, modes, wanted, target, middle, kind, end, feed, rotary, rows,
                             center, normal, sweep, turns, arcs)  # fmt: skip
            if shape == _BAD:
                break
            if shape != _NONE:
                place[rows, 0] = index + 1
                _mark(text, begin, stop, place, rows)
                rows += 1
                if shape >= 2:
                    arcs += 1
        index += 1
    modes[ROWS], modes[ARCS] = rows, arcs
    return index


@kernel
def _mark(text: Column, begin: int, stop: int, place: Column, row: int) -> None:
    """Columns of the written part of a line."""
    at = begin
    while at < stop and (text[at] == 32 or text[at] == 9):
        at += 1
    until = stop
    while until > at and (text[until - 1] == 32 or text[until - 1] == 9):
        until -= 1
    place[row, 1] = at - begin + 1
    place[row, 2] = until - begin + 1


@kernel
def _read_codes(codes: Column, modes: Column, wanted: Column) -> bool:
    """Motion, plane, distance and centre mode after the G words of a line, in `wanted`; whether all are plain."""
    wanted[0] = -1
    wanted[1], wanted[2], wanted[3] = modes[PLANE], modes[INCREMENTAL], modes[CENTRE_ABSOLUTE]
    groups = 0
    for each in range(1, codes[0] + 1):
        code = codes[each]
        if code == 0 or code == 10 or code == 20 or code == 30:
            group = 1
            wanted[0] = code
        elif code == 170 or code == 180 or code == 190:
            group = 2
            wanted[1] = code
        elif code == 900 or code == 910:
            group = 4
            wanted[2] = 1 if code == 910 else 0
        elif code == 901 or code == 911:
            group = 8
            wanted[3] = 1 if code == 901 else 0
        elif code == 930 and modes[FEED_MODE] == 930:  # G94 and G95 discard the feed
            group = 16
        elif code == (200 if modes[INCH] else 210):
            group = 32
        elif code == 400:  # compensation is off already
            group = 64
        else:
            return False
        if groups & group:
            return False
        groups |= group
    return True


@kernel
def _execute(
    seen: int,
    values: Column,
    codes: Column,
    numbers: Column,
    modes: Column,
    wanted: Column,
    target: Column,
    middle: Column,
    kind: Column,
    end: Column,
    feed: Column,
    rotary: Column,
    row: int,
    center: Column,
    normal: Column,
    sweep: Column,
    turns: Column,
    arc: int,
) -> int:
    """Execute one line: the kind of move that went into `row`, _NONE without a move, _BAD when it is left."""
    if not _read_codes(codes, modes, wanted):
        return _BAD
    motion = wanted[0]
    has_axes = seen & _AXES != 0
    modal = modes[MOTION]
    if motion < 0 and (has_axes or ((modal == 20 or modal == 30) and seen & _CENTRE != 0)):
        if modal != 0 and modal != 10 and modal != 20 and modal != 30:
            return _BAD
        motion = modal
    if motion < 20 and seen & _OF_ARCS != 0:
        return _BAD
    inverse = modes[FEED_MODE] == 930
    has_feed = (seen >> _F) & 1 != 0
    rate, rate_unit = numbers[FEED], numbers[FEED_UNIT]
    if has_feed:
        if values[_F] < 0.0:
            return _BAD
        if not inverse:
            rate, rate_unit = values[_F], numbers[UNIT]
    if motion > 0:
        if inverse:
            if not has_feed:
                return _BAD
        elif rate == 0.0 or (modes[FEED_MODE] == 950 and not modes[HAS_SPEED]):
            return _BAD
    moves = motion >= 20 or (motion >= 0 and has_axes)
    if moves:
        for axis in range(6):
            target[axis] = numbers[CURRENT + axis]
            letter = _AXIS_LETTERS[axis]
            if (seen >> letter) & 1:
                target[axis] = target[axis] + values[letter] if wanted[2] else values[letter]
        if motion >= 20:
            length = _arc(
                seen, values, numbers, modes, wanted, target, middle, motion, center, normal, sweep, turns, arc
            )
            if length < 0.0:
                return _BAD
        else:
            length = _straight_length(numbers, target) if inverse and motion > 0 else 0.0
        if inverse and motion > 0:
            rate, rate_unit = max(0.1, length * values[_F]), numbers[UNIT]
    numbers[FEED], numbers[FEED_UNIT] = rate, rate_unit
    modes[PLANE], modes[INCREMENTAL], modes[CENTRE_ABSOLUTE] = wanted[1], wanted[2], wanted[3]
    if motion < 0:
        return _NONE
    modes[MOTION], modes[MOVED] = motion, 1
    if not moves:
        return _NONE
    linear = motion >= 20 or _moves_linear(numbers, target)
    for axis in range(6):
        numbers[CURRENT + axis] = target[axis]
    _to_machine(numbers, modes, target)
    for axis in range(3):
        end[row, axis] = target[axis] * numbers[UNIT]
        end[row, axis + 3] = target[axis + 3] * numbers[DEG]
    rotary[row] = motion > 0 and not linear
    feed[row] = 0.0
    if motion > 0:
        size = rate * (rate_unit if linear else numbers[DEG])
        feed[row] = size if modes[FEED_MODE] == 950 else size / numbers[MINUTE]
    shape: int = motion // 10
    kind[row] = shape
    return shape


@kernel
def _moves_linear(numbers: Column, target: Column) -> bool:
    straight, turned = False, False
    for axis in range(3):
        straight = straight or target[axis] != numbers[CURRENT + axis]
        turned = turned or target[axis + 3] != numbers[CURRENT + axis + 3]
    return straight or not turned


@kernel
def _straight_length(numbers: Column, target: Column) -> float:
    """As `feeds.straight_length`, without U V W."""
    for first in (0, 3):
        dx = target[first] - numbers[CURRENT + first]
        dy = target[first + 1] - numbers[CURRENT + first + 1]
        dz = target[first + 2] - numbers[CURRENT + first + 2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        if length != 0.0:
            return length
    return 0.0


@kernel
def _to_machine(numbers: Column, modes: Column, point: Column) -> None:
    """`Control.tip` of the first six axes, in place."""
    for axis in range(6):
        point[axis] = point[axis] + numbers[G92 + axis]
    if modes[ROTATED]:
        x, y = point[0], point[1]
        point[0] = x * numbers[COS] - y * numbers[SIN]
        point[1] = x * numbers[SIN] + y * numbers[COS]
    for axis in range(6):
        point[axis] = point[axis] + numbers[ORIGIN + axis]


@kernel
def _arc(
    seen: int,
    values: Column,
    numbers: Column,
    modes: Column,
    wanted: Column,
    target: Column,
    middle: Column,
    motion: int,
    center: Column,
    normal: Column,
    sweep: Column,
    turns: Column,
    arc: int,
) -> float:
    """The arc from the current point to `target` into row `arc`; its length, negative when the line is left."""
    if wanted[1] == 170:
        first, second, across = 0, 1, 2
    elif wanted[1] == 180:
        first, second, across = 2, 0, 1
    else:
        first, second, across = 1, 2, 0
    ax, ay = numbers[CURRENT + first], numbers[CURRENT + second]
    bx, by = target[first], target[second]
    count = 1
    if (seen >> _P) & 1:
        count = int(min(values[_P], 1e9))
        if count < 1 or count != values[_P]:
            return -1.0
    if motion == 20:
        count = -count
    if (seen >> _R) & 1:
        named = (seen >> (23 + first)) & 1 or (seen >> (23 + second)) & 1
        if seen & _CENTRE != 0 or not named:
            return -1.0
        exists, cx, cy = centre_by_radius(values[_R], ax, ay, bx, by, count, numbers[UNIT])
        if not exists:
            return -1.0
    else:
        if seen & _CENTRE == 0 or (seen >> (_I + across)) & 1:
            return -1.0
        has_first, has_second = (seen >> (_I + first)) & 1 != 0, (seen >> (_I + second)) & 1 != 0
        if wanted[3]:
            if not (has_first and has_second):
                return -1.0
            cx, cy = values[_I + first], values[_I + second]
        else:
            cx = ax + (values[_I + first] if has_first else 0.0)
            cy = ay + (values[_I + second] if has_second else 0.0)
        if not radii_agree(ax, ay, bx, by, cx, cy, numbers[UNIT], modes[INCH]):
            return -1.0
    angle = sweep_of(ax, ay, bx, by, cx, cy, count)
    for axis in range(6):
        middle[axis] = 0.0
    middle[first], middle[second], middle[across] = cx, cy, target[across]
    _to_machine(numbers, modes, middle)
    for axis in range(3):
        center[arc, axis] = middle[axis] * numbers[UNIT]
        normal[arc, axis] = 0.0
    normal[arc, across] = 1.0
    if modes[ROTATED] and across != 2:
        x, y = normal[arc, 0], normal[arc, 1]
        normal[arc, 0] = x * numbers[COS] - y * numbers[SIN]
        normal[arc, 1] = x * numbers[SIN] + y * numbers[COS]
    sweep[arc] = angle
    turns[arc] = abs(count)
    flat = abs(angle) * apart(ax, ay, cx, cy)
    lift = target[across] - numbers[CURRENT + across]
    return math.sqrt(flat * flat + lift * lift)

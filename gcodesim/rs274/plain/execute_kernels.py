"""Executes lines on arrays: `rs274/execute.py`, the loop of `run.py` and `motions.py` for the bulk of programs.

A line is executed here only if it is certain what it does and that it is
right; every other line, and so every finding, belongs to the grammar's lane.
A line that is left has changed nothing.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.arc_kernels import apart, centre_by_radius, plane_axes, radii_agree, sweep_of
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.compensation_kernels import go_beside, meets
from gcodesim.rs274.plain.control_kernels import act, append, put_arc
from gcodesim.rs274.plain.cycle_kernels import hole
from gcodesim.rs274.plain.flow_kernels import o_word
from gcodesim.rs274.plain.layout_kernels import (
    ACTS,
    ARC_CENTRE,
    ARC_TURNS,
    ARCS,
    ARCS_NAME_AXES,
    CALLED,
    CENTRE_ABSOLUTE,
    CHAIN,
    CHANGED,
    CODES,
    COMPENSATES,
    CURRENT,
    CYCLE,
    END,
    FEED,
    FEED_MODE,
    FEED_UNIT,
    FLOWED,
    FLOWS,
    FLOWS_WANTED,
    FRAME,
    FRAMES,
    HAS_CYCLES,
    HAS_SPEED,
    INCH,
    INCREMENTAL,
    IS_EXTENDED,
    LAST,
    LEVEL,
    LOWEST,
    MOST_ACTS_OF_LINE,
    MOST_ROWS_OF_LINE,
    MOTION,
    MOVE_SPEED,
    NAMED,
    NEXT,
    PLACE,
    PLANE,
    RETRACT_TO_R,
    ROWS,
    RUNNING,
    S_SAID,
    S_WORD,
    SET,
    SIDE,
    SPEED,
    STARTED,
    TAKES_S,
    TARGET,
    UNIT,
    VALUES,
    WANTED,
    WANTS_R,
)
from gcodesim.rs274.plain.parameter_kernels import settle
from gcodesim.rs274.plain.reader_kernels import NOT_PLAIN, O_WORD, scan_line

_F, _I, _P, _Q, _R, _S, _X = 5, 8, 15, 16, 17, 18, 23
_CYCLES = (810, 820, 830, 850, 890)  # and G73
_NO_CYCLE = 800
_AXES = (1 << 23) | (1 << 24) | (1 << 25) | 7
_CENTRE = (1 << 8) | (1 << 9) | (1 << 10)
_OF_ARCS = _CENTRE | (1 << 15) | (1 << 17)


class LaneText(NamedTuple):
    """The lines of the program: all its bytes, and where each line starts (`LineTable`, `ProgramText`)."""

    data: Column
    starts: Column


class LaneState(NamedTuple):
    """The state of the control and of the program; the layout says what is where."""

    numbers: Column
    modes: Column
    memory: Column
    tables: Column


class LaneRows(NamedTuple):
    """Rows of what is executed, as in the layout: of moves `moves` and `facts`, of arcs `shapes`, of `acts` between."""

    moves: Column
    facts: Column
    shapes: Column
    acts: Column


@kernel
def run_lines(lines: LaneText, state: LaneState, rows: LaneRows, first: int, most: int, longest: int) -> int:
    """Execute up to `most` lines from index `first` on as far as they are understood; returns how many.

    `longest` is the most characters a line may have. `state` is the one before and after. What happens is appended
    to `rows`; a full array ends the run too.
    """
    text, starts = lines
    numbers, modes, memory, tables = state
    moves, facts, shapes, acts = rows
    modes[ROWS] = modes[ARCS] = modes[ACTS] = modes[STARTED] = modes[FLOWED] = modes[NAMED] = modes[CALLED] = 0
    modes[CHANGED] = modes[S_SAID] = 0
    modes[LOWEST] = modes[LEVEL]
    modes[NEXT] = modes[LAST] = index = first
    done = 0
    while (
        done < most
        and index < modes[END]
        and modes[ROWS] + MOST_ROWS_OF_LINE <= len(moves)
        and modes[ACTS] + MOST_ACTS_OF_LINE <= len(acts)
    ):
        begin, stop = starts[index], starts[index + 1]
        if stop > begin and text[stop - 1] == 10:
            stop -= 1
        if stop > begin and text[stop - 1] == 13:
            stop -= 1
        if stop - begin > longest:
            break
        seen = scan_line(text, begin, stop, numbers, modes, memory, tables)
        if seen == NOT_PLAIN:
            break
        if seen == O_WORD:
            if modes[FLOWS] < 0:
                modes[FLOWS] = FLOWS_WANTED
                break
            if not o_word(text, index, stop, numbers, modes, memory, tables):
                break
        else:
            if seen != 0:
                _find_place(text, begin, stop, modes, tables, index)
                if not _execute(seen, numbers, modes, moves, facts, shapes, acts):
                    break
            if modes[SET] > 0:
                settle(numbers, modes, memory, tables)
            modes[NEXT] = index + 1
        modes[LAST] = index
        index = modes[NEXT]
        modes[PLACE + 3] += 1
        done += 1
    return done


@kernel
def _find_place(text: Column, begin: int, stop: int, modes: Column, tables: Column, index: int) -> None:
    """The place of the written part of a line; its block number is already set."""
    at = begin
    while at < stop and (text[at] == 32 or text[at] == 9):
        at += 1
    until = stop
    while until > at and (text[until - 1] == 32 or text[until - 1] == 9):
        until -= 1
    modes[PLACE], modes[PLACE + 1], modes[PLACE + 2] = index, at - begin + 1, until - begin + 1
    modes[PLACE + 4] = tables[FRAMES + FRAME * modes[LEVEL] + CHAIN]


@kernel
def _read_codes(modes: Column) -> bool:
    """Motion, plane, distance, centre and retract mode after the G words of a line; whether all words are plain."""
    modes[WANTED] = -1
    modes[WANTS_R] = modes[RETRACT_TO_R]
    modes[WANTED + 1], modes[WANTED + 2] = modes[PLANE], modes[INCREMENTAL]
    modes[WANTED + 3] = modes[CENTRE_ABSOLUTE]
    groups = 0
    for each in range(1, modes[CODES] + 1):
        code = modes[CODES + each]
        if code == 0 or code == 10 or code == 20 or code == 30:
            group = 1
            modes[WANTED] = code
        elif code == 170 or code == 180 or code == 190:
            group = 2
            modes[WANTED + 1] = code
        elif code == 900 or code == 910:
            group = 4
            modes[WANTED + 2] = 1 if code == 910 else 0
        elif modes[HAS_CYCLES] and (code in _CYCLES or (code == 730 and modes[IS_EXTENDED])):
            group = 1
            modes[WANTED] = code
        elif modes[HAS_CYCLES] and (code == 980 or code == 990) and not modes[COMPENSATES]:
            group = 128
            modes[WANTS_R] = 1 if code == 990 else 0
        elif code == _NO_CYCLE:
            group = 256
        elif (code == 901 or code == 911) and modes[IS_EXTENDED]:
            group = 8
            modes[WANTED + 3] = 1 if code == 901 else 0
        elif code == 930 and modes[FEED_MODE] == 930:  # G94 and G95 discard the feed
            group = 16
        elif code == (200 if modes[INCH] else 210):
            group = 32
        elif code == 400 and not modes[COMPENSATES]:  # compensation is off already
            group = 64
        else:
            return False
        if groups & group:
            return False
        groups |= group
    if groups & 256 and modes[WANTED] < 0:
        modes[WANTED] = _NO_CYCLE
    # a chain of holes in another plane needs another word for their depth
    running: int = modes[RUNNING]
    return running < 0 or modes[WANTED + 1] == modes[PLANE]


@kernel
def _execute(
    seen: int, numbers: Column, modes: Column, moves: Column, facts: Column, shapes: Column, acts: Column
) -> bool:
    """Execute one line, with at most one move or hole; False when it is left."""
    if not _read_codes(modes):
        return False
    motion = modes[WANTED]
    has_axes = seen & _AXES != 0
    modal = modes[MOTION]
    carries_on = (modal == 20 or modal == 30) and seen & _CENTRE != 0 and not modes[ARCS_NAME_AXES]
    if motion < 0 and (has_axes or carries_on):
        if modal < 0 or modal == _NO_CYCLE:
            return False
        motion = modal
    has_speed = (seen >> _S) & 1 != 0
    if has_speed and (not modes[TAKES_S] or modes[SIDE] or modes[FEED_MODE] == 950 or numbers[VALUES + _S] < 0.0):
        return False
    if motion > 30 and motion != _NO_CYCLE:
        return not has_speed and hole(motion, seen, numbers, modes, moves, facts, acts)
    if (seen >> _Q) & 1:
        return False
    if (motion < 20 or motion == _NO_CYCLE) and seen & _OF_ARCS != 0:
        return False
    if motion == _NO_CYCLE and (has_axes or modes[COMPENSATES]):
        return False
    inverse = modes[FEED_MODE] == 930
    has_feed = (seen >> _F) & 1 != 0
    rate, rate_unit = numbers[FEED], numbers[FEED_UNIT]
    if has_feed:
        if numbers[VALUES + _F] < 0.0:
            return False
        if not inverse:
            rate, rate_unit = numbers[VALUES + _F], numbers[UNIT]
    if 0 < motion <= 30:
        if inverse:
            if not has_feed:
                return False
        elif rate == 0.0 or (modes[FEED_MODE] == 950 and not modes[HAS_SPEED]):
            return False
    goes = 20 <= motion <= 30 or (motion >= 0 and has_axes)
    if has_speed and not goes:
        return False
    beside = modes[SIDE] != 0
    if beside and (inverse or (motion >= 0 and not goes)):
        return False
    if modes[COMPENSATES] and modes[WANTED + 1] != modes[PLANE]:
        return False
    if goes:
        _aim(seen, numbers, modes)
        if motion >= 20 and not _centre(seen, numbers, modes, motion):
            return False
        if beside and not meets(numbers, modes, motion):
            return False
        if inverse and motion > 0:
            length = _arc_length(numbers, modes) if motion >= 20 else _straight_length(numbers)
            rate, rate_unit = max(0.1, length * numbers[VALUES + _F]), numbers[UNIT]
    numbers[FEED], numbers[FEED_UNIT] = rate, rate_unit
    modes[PLANE], modes[INCREMENTAL] = modes[WANTED + 1], modes[WANTED + 2]
    modes[CENTRE_ABSOLUTE], modes[RETRACT_TO_R] = modes[WANTED + 3], modes[WANTS_R]
    if motion < 0:
        return True
    modes[MOTION], modes[CYCLE], modes[RUNNING] = motion, -1, -1
    if goes:
        kind, linear = motion // 10, motion >= 20 or _moves_linear(numbers)
        if beside:
            go_beside(numbers, modes, moves, facts, shapes, kind, linear)
            return True
        if has_speed:
            act(modes, acts, S_WORD)
            numbers[SPEED] = moves[modes[ROWS], MOVE_SPEED] = numbers[VALUES + _S]
            modes[HAS_SPEED] = numbers[SPEED] != 0.0
            modes[S_SAID] = 1
        if motion >= 20:
            across_at = numbers[TARGET + plane_axes(modes[PLANE])[2]]
            put_arc(numbers, modes, shapes, ARC_CENTRE, across_at, _sweep(numbers, modes), modes[ARC_TURNS])
        append(numbers, modes, moves, facts, kind, kind, linear)
    return True


@kernel
def _aim(seen: int, numbers: Column, modes: Column) -> None:
    """The programmed end in the active work system."""
    for axis in range(6):
        letter = _X + axis if axis < 3 else axis - 3
        now = numbers[CURRENT + axis]
        if (seen >> letter) & 1:
            value = numbers[VALUES + letter]
            numbers[TARGET + axis] = now + value if modes[WANTED + 2] else value
        else:
            numbers[TARGET + axis] = now


@kernel
def _moves_linear(numbers: Column) -> bool:
    straight, turned = False, False
    for axis in range(3):
        straight = straight or numbers[TARGET + axis] != numbers[CURRENT + axis]
        turned = turned or numbers[TARGET + axis + 3] != numbers[CURRENT + axis + 3]
    return straight or not turned


@kernel
def _straight_length(numbers: Column) -> float:
    """As `feeds.straight_length`, without U V W."""
    for first in (0, 3):
        dx = numbers[TARGET + first] - numbers[CURRENT + first]
        dy = numbers[TARGET + first + 1] - numbers[CURRENT + first + 1]
        dz = numbers[TARGET + first + 2] - numbers[CURRENT + first + 2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        if length != 0.0:
            return length
    return 0.0


@kernel
def _centre(seen: int, numbers: Column, modes: Column, motion: int) -> bool:
    """Find centre and turns of the arc from the current point to the target; False when the line is left."""
    first, second, across = plane_axes(modes[WANTED + 1])
    ax, ay = numbers[CURRENT + first], numbers[CURRENT + second]
    bx, by = numbers[TARGET + first], numbers[TARGET + second]
    count = 1
    if (seen >> _P) & 1:
        count = int(min(numbers[VALUES + _P], 1e9))
        if count < 1 or count != numbers[VALUES + _P]:
            return False
    if motion == 20:
        count = -count
    named = (seen >> (_X + first)) & 1 != 0 or (seen >> (_X + second)) & 1 != 0
    if modes[ARCS_NAME_AXES] and not named:
        return False
    if (seen >> _R) & 1:
        if seen & _CENTRE != 0 or not named:
            return False
        exists, cx, cy = centre_by_radius(numbers[VALUES + _R], ax, ay, bx, by, count, numbers[UNIT])
        if not exists:
            return False
    else:
        if seen & _CENTRE == 0 or (seen >> (_I + across)) & 1:
            return False
        has_first, has_second = (seen >> (_I + first)) & 1 != 0, (seen >> (_I + second)) & 1 != 0
        cx = numbers[VALUES + _I + first] if has_first else 0.0
        cy = numbers[VALUES + _I + second] if has_second else 0.0
        if modes[WANTED + 3]:
            if not (has_first and has_second):
                return False
        else:
            cx, cy = ax + cx, ay + cy
        if not radii_agree(ax, ay, bx, by, cx, cy, numbers, modes):
            return False
    numbers[ARC_CENTRE], numbers[ARC_CENTRE + 1], modes[ARC_TURNS] = cx, cy, count
    return True


@kernel
def _sweep(numbers: Column, modes: Column) -> float:
    """Of the arc at hand, on the programmed path."""
    first, second, _ = plane_axes(modes[WANTED + 1])
    return sweep_of(
        numbers[CURRENT + first],
        numbers[CURRENT + second],
        numbers[TARGET + first],
        numbers[TARGET + second],
        numbers[ARC_CENTRE],
        numbers[ARC_CENTRE + 1],
        modes[ARC_TURNS],
    )


@kernel
def _arc_length(numbers: Column, modes: Column) -> float:
    """As `arcs.helix_length`."""
    first, second, across = plane_axes(modes[WANTED + 1])
    ax, ay = numbers[CURRENT + first], numbers[CURRENT + second]
    flat = abs(_sweep(numbers, modes)) * apart(ax, ay, numbers[ARC_CENTRE], numbers[ARC_CENTRE + 1])
    lift = numbers[TARGET + across] - numbers[CURRENT + across]
    return math.sqrt(flat * flat + lift * lift)

"""Straight moves of a Fanuc program on arrays: lines of G0, G1, axis words, directions of the tool and F.

A line is carried out here only if it is certain what it does and that it is right; every other line, and so every
finding, belongs to the executor. A line that is left has changed nothing.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.expression_kernels import number_at
from gcodesim.rs274.plain.layout_kernels import RESULT
from gcodesim.rs274.plain.text_kernels import behind_blanks, byte_at

# `StraightState.numbers`: the current point X Y Z A B C, the feed and the length that it counts, the unit of length in
# force, and how many increments that and a degree have
FEED, FEED_UNIT, UNIT, PER_LENGTH, PER_ANGLE = 6, 7, 8, 9, 10
# `StraightState.modes`
MOTION, BY_VECTOR, SEQUENCE = 0, 1, 2
MODES = 3
# columns of `StraightRows.values`: the end X Y Z A B C, feed and its length, the direction I J K
DIRECTION = 8
VALUES = 11
# columns of `StraightRows.facts`
KIND, LINE, COLUMN, END_COLUMN, DIRECTED = 0, 1, 2, 3, 4
FACTS = 5
# words of a line: A B C, F, G, I J K and X Y Z by their place in the alphabet
LETTERS = 26
NUMBERS = RESULT + 1

_A, _C, _F, _G, _I, _K, _X, _Z = 0, 2, 5, 6, 8, 10, 23, 25
_FINEST = 3  # places behind the point that every control takes in as they are
_SMALL = 1e-9  # as in vectors.py


class StraightState(NamedTuple):
    """`numbers` and `modes` of the control, and the words of the line at hand: their `values` and which there are."""

    numbers: Column
    modes: Column
    values: Column
    has: Column


class StraightRows(NamedTuple):
    """The moves, a row each: `values` (n, VALUES) in program units, `facts` (n, FACTS)."""

    values: Column
    facts: Column


@kernel
def is_finer(text: Column, begin: int, stop: int) -> bool:
    """Whether a digit that says something stands behind the third place of a number."""
    places = -1
    for at in range(begin, stop):
        if text[at] == 46:
            places = 0
        elif places >= 0:
            places += 1
            if places > _FINEST and text[at] != 48:
                return True
    return False


@kernel
def read_words(text: Column, at: int, stop: int, state: StraightState) -> int:
    """Read the words of a line: 1, or 2 if a number is finer than increments; 0 where it has anything else."""
    values, has = state.values, state.has
    has[:] = 0
    found = 1
    while at < stop:
        letter = byte_at(text, at) - 65
        if letter >= 32:
            letter -= 32
        known = letter <= _C or letter in (_F, _G) or _I <= letter <= _K or _X <= letter <= _Z
        if letter < 0 or letter >= LETTERS or not known or has[letter]:
            return 0
        begin, sign = at + 1, 1.0
        if begin < stop and (text[begin] == 43 or text[begin] == 45):
            sign = -1.0 if text[begin] == 45 else 1.0
            begin += 1
        at = number_at(text, begin, stop, state.numbers)
        if at < 0:
            return 0
        if is_finer(text, begin, at):
            found = 2
        values[letter], has[letter] = sign * state.numbers[RESULT], 1
        at = behind_blanks(text, at, stop)
    return found


@kernel
def to_increment(value: float, per: float) -> float:
    """As `increments.rounded`: to the nearest increment, halves away from zero."""
    scaled = value * per
    if scaled == 0.0:
        return 0.0
    whole = float(math.floor(abs(scaled) + 0.5))
    return (whole if scaled > 0.0 else -whole) / per


@kernel
def sequence_at(text: Column, at: int, stop: int, modes: Column) -> int:
    """Where the line goes on behind its N word, whose number goes to `modes`; −1 where it has another form."""
    if text[at] != 78 and text[at] != 110:
        return at
    number, begin = 0, at + 1
    at = begin
    while at < stop and 48 <= text[at] <= 57:
        number = 10 * number + byte_at(text, at) - 48
        at += 1
    if at == begin or at - begin > 15:
        return -1
    modes[SEQUENCE] = number
    return behind_blanks(text, at, stop)


@kernel
def go(state: StraightState, finer: bool, values: Column) -> int:
    """Carry out the words of a line, with the row of its move in `values`: the motion, or −1 where it is left."""
    numbers, modes, words, has = state
    motion: int = modes[MOTION]
    if has[_G]:
        if words[_G] != 0.0 and words[_G] != 1.0:
            return -1
        motion = 10 if words[_G] == 1.0 else 0
    by_vector = modes[BY_VECTOR] == 1
    moves, turns, directed = False, False, False
    for k in range(3):
        moves = moves or has[_X + k] == 1
        turns = turns or has[_A + k] == 1
        directed = directed or has[_I + k] == 1
    if (directed and not by_vector) or (turns and by_vector) or not (moves or turns or directed):
        return -1
    feed, unit = numbers[FEED], numbers[FEED_UNIT]
    if has[_F]:
        feed, unit = words[_F], numbers[UNIT]
    if feed <= 0.0 and (has[_F] or motion == 10):
        return -1
    size = 0.0
    for k in range(3):
        values[DIRECTION + k] = words[_I + k] if has[_I + k] else 0.0
        size += values[DIRECTION + k] * values[DIRECTION + k]
    if directed and size < _SMALL:
        return -1
    for k in range(3):
        for letter, axis, per in ((_X + k, k, numbers[PER_LENGTH]), (_A + k, 3 + k, numbers[PER_ANGLE])):
            if has[letter]:
                numbers[axis] = to_increment(words[letter], per) if finer else words[letter]
            values[axis] = numbers[axis]
    numbers[FEED] = values[FEED] = feed
    numbers[FEED_UNIT] = values[FEED_UNIT] = unit
    modes[MOTION] = motion
    return motion


@kernel
def read_lines(text: Column, starts: Column, state: StraightState, rows: StraightRows, place: Column) -> int:
    """Carry out lines as far as they are known here; how many, each of which makes a row.

    `place` (3,): the first one, the most of them, and the most characters of one.
    """
    first, most, longest = place[0], place[1], place[2]
    modes = state.modes
    done = 0
    while done < most and done < rows.values.shape[0]:
        line = first + done
        begin, stop = starts[line], starts[line + 1]
        if stop > begin and text[stop - 1] == 10:
            stop -= 1
        if stop > begin and text[stop - 1] == 13:
            stop -= 1
        if stop - begin > longest:
            break
        while stop > begin and (text[stop - 1] == 32 or text[stop - 1] == 9):
            stop -= 1
        at = behind_blanks(text, begin, stop)
        if at >= stop:
            break
        before, written = modes[SEQUENCE], at
        at = sequence_at(text, at, stop, modes)
        read = read_words(text, at, stop, state) if 0 <= at < stop else 0
        motion = go(state, read == 2, rows.values[done]) if read else -1
        if motion < 0:
            modes[SEQUENCE] = before
            break
        facts = rows.facts[done]
        facts[KIND], facts[LINE] = motion // 10, line
        facts[COLUMN], facts[END_COLUMN] = written - begin + 1, stop - begin + 1
        facts[DIRECTED] = state.has[_I] or state.has[_I + 1] or state.has[_K]
        done += 1
    return done


@kernel
def turn_along(directed: Column, ways: Column, frame: Column, points: Column) -> None:
    """Put words A B C into columns 3 to 5 of `points` (n, 6) that stand where `ways` (n, 3) [rad] say.

    As `vectors.resolve` one after the other: `frame` (5, 3) has the words before, what G92 and the origin add,
    the length offset [rad], and a degree in radians.
    """
    for n in range(points.shape[0]):
        for k in range(3):
            now = frame[0, k]
            if directed[n]:
                degree = frame[4, k]
                here = ((now + frame[1, k] + frame[2, k]) * degree + frame[3, k]) / degree * degree
                now = now + (ways[n, k] - here) / degree
            frame[0, k] = now
            points[n, 3 + k] = now

"""Lines of a printer's program that say where to go: G0, G1 and G92 E with plain numbers, and comments."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.text_kernels import behind_blanks, byte_at

# `PrintState.numbers`
X, Y, Z, E, F = 0, 1, 2, 3, 4
NUMBERS = 5
# `PrintState.modes`
INCREMENTAL, E_RELATIVE, ROWS, AT = 0, 1, 2, 3
MODES = 4
# columns of `PrintRows.facts`
KIND, LINE, COLUMN, END_COLUMN = 0, 1, 2, 3
FACTS = 4
# kinds of rows; 0 and 1 are the numbers of the motion words
FILAMENT, COMMENT = 2, 3
# columns of `PrintRows.values`: X Y Z of the end, F, and the step of E
VALUES = 5

_MOST_DIGITS = 15  # so many are exact in a float, and so is the power of ten behind them
_WORDS = 5
_TEN = 10.0


class PrintRows(NamedTuple):
    """What the lines say, a row each: `values` (n, VALUES), `facts` (n, FACTS)."""

    values: Column
    facts: Column


class PrintState(NamedTuple):
    """`numbers`: X Y Z E F in program units; `modes`: how they count, how many rows there are, where a line is read."""

    numbers: Column
    modes: Column


@kernel
def number_at(text: Column, at: int, stop: int, out: Column, which: int) -> int:
    """Read a number into `out[which]`; the place behind it, -1 if there is none that a float holds exactly enough."""
    sign = 1.0
    if at < stop and (text[at] == 45 or text[at] == 43):
        if text[at] == 45:
            sign = -1.0
        at += 1
    digits, behind, mantissa, power, point = 0, 0, 0.0, 1.0, False
    while at < stop:
        byte = byte_at(text, at)
        if 48 <= byte <= 57:
            mantissa = mantissa * 10.0 + (byte - 48)
            digits += 1
            if point:
                behind += 1
                power *= 10.0
        elif byte == 46 and not point:
            point = True
        else:
            break
        at += 1
    if digits == 0 or digits > 15:
        return -1
    out[which] = sign * (mantissa / power)
    return at


@kernel
def line_ends(text: Column, at: int, stop: int) -> bool:
    """Whether nothing but blanks or a comment follows."""
    at = behind_blanks(text, at, stop)
    return at >= stop or text[at] == 59


@kernel
def is_plain_text(text: Column, begin: int, stop: int) -> bool:
    """Whether all bytes are printable ASCII or tabs, so that a byte is a column."""
    for at in range(begin, stop):
        byte = text[at]
        if byte > 126 or (byte < 32 and byte != 9):
            return False
    return True


@kernel
def command_number(text: Column, at: int, stop: int, modes: Column) -> int:
    """The number of the G word at `at`, which may be 0, 1 or 92; -1 for others. `modes[AT]` is the place behind it."""
    if at >= stop or (text[at] != 71 and text[at] != 103):
        return -1
    at = behind_blanks(text, at + 1, stop)
    number, digits = 0, 0
    while at < stop and 48 <= text[at] <= 57 and digits < 4:
        number = number * 10 + byte_at(text, at) - 48
        at, digits = at + 1, digits + 1
    modes[3] = at
    if digits == 0 or (at < stop and text[at] == 46) or (number > 1 and number != 92):
        return -1
    return number


@kernel
def read_move(text: Column, at: int, stop: int, found: Column, has: Column) -> bool:
    """Read X Y Z E F words into `found`; `has` says which. False where the line has something else."""
    has[:] = 0
    while not line_ends(text, at, stop):
        at = behind_blanks(text, at, stop)
        byte = byte_at(text, at)
        if byte >= 97:
            byte -= 32
        if 88 <= byte <= 90:
            which = byte - 88
        elif byte == 69 or byte == 70:
            which = byte - 66
        else:
            return False
        if has[which]:
            return False
        at = number_at(text, behind_blanks(text, at + 1, stop), stop, found, which)
        if at < 0:
            return False
        has[which] = 1
    return True


@kernel
def move_to(state: PrintState, found: Column, has: Column, values: Column) -> int:
    """Change the state by the words of a move, with its end, feed and step of E in `values`; what kind of row it is.

    -1: it is none, because nothing moves; -2: a motion.
    """
    numbers, modes = state
    moved = False
    for axis in range(3):
        end = numbers[axis]
        if has[axis]:
            end = numbers[axis] + found[axis] if modes[0] else found[axis]
            moved = moved or end != numbers[axis]
        values[axis] = end
    if has[4] and found[4] > 0.0:
        numbers[4] = found[4]
    step = 0.0
    if has[3]:
        if modes[1]:
            step = found[3]
            numbers[3] = numbers[3] + found[3]
        else:
            step = found[3] - numbers[3]
            numbers[3] = found[3]
    values[3], values[4] = numbers[4], step
    if moved:
        numbers[0], numbers[1], numbers[2] = values[0], values[1], values[2]
        return -2
    return 2 if step != 0.0 else -1


@kernel
def read_lines(text: Column, starts: Column, state: PrintState, rows: PrintRows, first: int, most: int) -> int:
    """Carry out at most `most` lines from line `first` on, as far as they are known here; how many.

    `modes[ROWS]` becomes the number of rows that they made.
    """
    numbers, modes = state
    found, has = np.zeros(5), np.zeros(5, dtype=np.int64)
    values, facts = rows
    row, done, lines = 0, 0, len(starts) - 1
    while done < most and first + done < lines and row < len(values):
        line = first + done
        begin, stop = starts[line], starts[line + 1]
        while stop > begin and (
            text[stop - 1] == 10 or text[stop - 1] == 13 or text[stop - 1] == 32 or text[stop - 1] == 9
        ):
            stop -= 1
        at = behind_blanks(text, begin, stop)
        if at >= stop:
            done += 1
            continue
        if not is_plain_text(text, begin, stop):
            break
        kind = -1
        if text[at] == 59:
            kind = 3
        else:
            code = command_number(text, at, stop, modes)
            if code < 0 or not read_move(text, modes[3], stop, found, has):
                break
            if code == 92:
                if not has[3] or has[0] or has[1] or has[2] or has[4]:
                    break
                numbers[3] = found[3]
            else:
                kind = move_to(state, found, has, values[row])
                if kind == -2:
                    kind = code
        done += 1
        if kind >= 0:
            facts[row, 0], facts[row, 1], facts[row, 2], facts[row, 3] = kind, line, at - begin + 1, stop - begin + 1
            row += 1
    modes[2] = row
    return done

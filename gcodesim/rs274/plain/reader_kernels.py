"""One line of bytes to letters and values, and to what it sets: `rs274/reader.py` in compiled form.

A line is understood when it consists of an N word, words, settings of
parameters and comments that do nothing; words and settings have literal numbers
of at most fifteen digits, or expressions as `value_at` understands them.
"""

from __future__ import annotations

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.expression_kernels import (
    name_at,
    number_at,
    shows_state,
    value_at,
    whole_number,
)
from gcodesim.rs274.plain.layout_kernels import (
    CODES,
    COMPUTES,
    FRESH,
    MISSING,
    MOST_CODES,
    MOST_SET,
    NAME,
    PLAIN_LETTERS,
    RESULT,
    SET,
    SETTINGS,
    TEXT,
    VALUES,
)
from gcodesim.rs274.plain.parameter_kernels import may_be_set
from gcodesim.rs274.plain.text_kernels import behind_blanks, byte_at

NOT_PLAIN = -1
"""What `scan_line` returns for a line that belongs to the grammar."""

O_WORD = -2
"""What it returns for a line that begins with an O-word; TEXT says where."""

_G = 6
_LARGEST = 1e30  # as in expressions.py


@kernel
def scan_line(text: Column, at: int, stop: int, numbers: Column, modes: Column, memory: Column, tables: Column) -> int:
    """Read the line ``text[at:stop]``, which has no line end.

    `numbers` takes the value of each letter, `modes` the G words; both what is to be set. Returns the
    letters seen as bits, bit 0 for A; NOT_PLAIN when the grammar has to read
    the line.
    """
    seen = 0
    modes[CODES] = modes[SET] = modes[MISSING] = modes[FRESH] = 0
    at = behind_blanks(text, at, stop)
    if at < stop and (text[at] == 78 or text[at] == 110):  # N and digits
        at += 1
        first = at
        while at < stop and 48 <= text[at] <= 57:
            at += 1
        if at == first:
            return NOT_PLAIN
        at = behind_blanks(text, at, stop)
    if at < stop and (text[at] == 79 or text[at] == 111):
        modes[TEXT] = at
        return O_WORD if modes[COMPUTES] else NOT_PLAIN
    while True:
        while at < stop and (text[at] == 32 or text[at] == 9):
            at += 1
        if at >= stop:
            return NOT_PLAIN if modes[FRESH] and modes[MISSING] else seen
        char = byte_at(text, at)
        if char == 40 or char == 59:
            at = behind_comment(text, at, stop)
            if at < 0:
                return NOT_PLAIN
            continue
        at += 1
        if char == 35:
            if not modes[COMPUTES]:
                return NOT_PLAIN
            at = _setting_at(text, at, stop, numbers, modes, memory, tables)
            if at < 0:
                return NOT_PLAIN
            continue
        letter = (char | 32) - 97
        if char < 65 or letter < 0 or letter > 25 or not (modes[PLAIN_LETTERS] >> letter) & 1:
            return NOT_PLAIN
        digit = at + 1 if at < stop and (text[at] == 45 or text[at] == 43) else at
        if digit < stop and (48 <= text[digit] <= 57 or text[digit] == 46):
            negative = text[at] == 45
            at = number_at(text, digit, stop, numbers)
            if at < 0:
                return NOT_PLAIN
            value = -numbers[RESULT] if negative else numbers[RESULT]
        else:
            if not modes[COMPUTES]:
                return NOT_PLAIN
            at = value_at(text, at, stop, numbers, modes, memory, tables)
            if at < 0:
                return NOT_PLAIN
            value = numbers[RESULT]
            if not abs(value) <= _LARGEST:
                return NOT_PLAIN
        if letter == _G:
            tenths = value * 10.0
            if not 0.0 <= tenths < 1e4 or modes[CODES] == MOST_CODES:
                return NOT_PLAIN
            code = int(tenths)
            if code != tenths:
                return NOT_PLAIN
            modes[CODES] += 1
            modes[CODES + modes[CODES]] = code
        else:
            if (seen >> letter) & 1:
                return NOT_PLAIN
            numbers[VALUES + letter] = value
        seen |= 1 << letter


@kernel
def behind_comment(text: Column, at: int, stop: int) -> int:
    """Where a comment that does nothing ends; -1 for any other."""
    char = byte_at(text, at)
    at += 1
    if char == 59:  # ; to the end, never active
        while at < stop:
            char = byte_at(text, at)
            at += 1
            if char > 126 or (char < 32 and char != 9):
                return -1
        return at
    # ( … ); with a comma it may be active, and so may be LOGOPEN, PROBEOPEN, PYRUN … without one
    first = behind_blanks(text, at, stop)
    if first + 1 < stop:
        a, b = byte_at(text, first) | 32, byte_at(text, first + 1) | 32
        if (a == 112 and (b == 114 or b == 121)) or (a == 108 and b == 111):
            return -1
    while at < stop:
        char = byte_at(text, at)
        at += 1
        if char == 41:
            return at
        if char == 40 or char == 44 or char > 126 or (char < 32 and char != 9):
            return -1
    return -1


@kernel
def _setting_at(
    text: Column, at: int, stop: int, numbers: Column, modes: Column, memory: Column, tables: Column
) -> int:
    """After the `#` of `#index=value`: note what is to be set; returns where it ends, -1 if the line is left."""
    count = modes[SET]
    if count == MOST_SET:
        return -1
    at = behind_blanks(text, at, stop)
    if at < stop and text[at] == 60:
        at = name_at(text, at + 1, stop, modes, tables)
        if at < 0 or not may_be_set(numbers, modes, memory, tables):
            return -1
        target = -1 - modes[NAME]
    else:
        at = value_at(text, at, stop, numbers, modes, memory, tables)
        if at < 0:
            return -1
        target = whole_number(numbers[RESULT])
        if target == 0 or shows_state(target):
            return -1
    at = behind_blanks(text, at, stop)
    if at >= stop or text[at] != 61:
        return -1
    at = value_at(text, at + 1, stop, numbers, modes, memory, tables)
    if at < 0 or not abs(numbers[RESULT]) <= _LARGEST:
        return -1
    numbers[SETTINGS + count] = numbers[RESULT]
    modes[SET + 1 + count] = target
    modes[SET] = count + 1
    return at

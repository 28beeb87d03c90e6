"""One line of bytes to letters and values.

A line is understood when it consists of an N word, words with literal numbers
of at most fifteen digits, and comments that do nothing; then every value is
what `float` makes of the text: an integer below 2**53 divided once by a power
of ten is rounded correctly.
"""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.layout_kernels import CODES, MOST_CODES, VALUES

NOT_PLAIN = -1
"""What `scan_line` returns for a line that belongs to the grammar."""

_MOST_DIGITS = 15
_MOST_PLACES = 22
_POWERS = np.array([10.0**n for n in range(_MOST_PLACES + 1)])
_G = 6
# A B C F G I J K P R X Y Z
_KNOWN = sum(1 << (ord(letter) - ord("a")) for letter in "abcfgijkprxyz")


@kernel
def byte_at(text: Column, at: int) -> int:
    """One byte as a signed integer, so that sums with it stay integers."""
    byte: int = text[at] + np.int64(0)
    return byte


@kernel
def scan_line(text: Column, at: int, stop: int, numbers: Column, modes: Column) -> int:
    """Read the line ``text[at:stop]``, which has no line end.

    `numbers` takes the value of each letter, `modes` the G words. Returns the
    letters seen as bits, bit 0 for A; NOT_PLAIN when the grammar has to read
    the line.
    """
    seen = 0
    modes[CODES] = 0
    while at < stop and (text[at] == 32 or text[at] == 9):
        at += 1
    if at < stop and (text[at] == 78 or text[at] == 110):  # N and digits
        at += 1
        first = at
        while at < stop and 48 <= text[at] <= 57:
            at += 1
        if at == first:
            return NOT_PLAIN
    while True:
        while at < stop and (text[at] == 32 or text[at] == 9):
            at += 1
        if at >= stop:
            return seen
        char = byte_at(text, at)
        at += 1
        if char == 40:  # ( … ); with a comma it may be active
            while True:
                if at >= stop:
                    return NOT_PLAIN
                char = byte_at(text, at)
                at += 1
                if char == 41:
                    break
                if char == 40 or char == 44 or char > 126 or (char < 32 and char != 9):
                    return NOT_PLAIN
            continue
        if char == 59:  # ; to the end, never active
            while at < stop:
                char = byte_at(text, at)
                at += 1
                if char > 126 or (char < 32 and char != 9):
                    return NOT_PLAIN
            return seen
        letter = (char | 32) - 97
        if char < 65 or letter < 0 or letter > 25 or not (_KNOWN >> letter) & 1:
            return NOT_PLAIN
        negative = False
        if at < stop and (text[at] == 45 or text[at] == 43):
            negative = text[at] == 45
            at += 1
        mantissa = 0
        digits = 0
        read = 0
        places = 0
        while at < stop and 48 <= text[at] <= 57:
            mantissa = mantissa * 10 + (byte_at(text, at) - 48)
            if mantissa > 0:
                digits += 1
            read += 1
            at += 1
            if digits > _MOST_DIGITS:
                return NOT_PLAIN
        if at < stop and text[at] == 46:
            at += 1
            while at < stop and 48 <= text[at] <= 57:
                mantissa = mantissa * 10 + (byte_at(text, at) - 48)
                if mantissa > 0:
                    digits += 1
                places += 1
                at += 1
                if digits > _MOST_DIGITS or places > _MOST_PLACES:
                    return NOT_PLAIN
        if read + places == 0:
            return NOT_PLAIN
        value = float(mantissa)
        if places > 0:
            value /= _POWERS[places]
        if negative:
            value = -value
        if letter == _G:
            tenths = value * 10.0
            code = int(tenths)
            if code != tenths or modes[CODES] == MOST_CODES or negative:
                return NOT_PLAIN
            modes[CODES] += 1
            modes[CODES + modes[CODES]] = code
        else:
            if (seen >> letter) & 1:
                return NOT_PLAIN
            numbers[VALUES + letter] = value
        seen |= 1 << letter

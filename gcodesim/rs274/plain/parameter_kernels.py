"""Named parameters, and what a line sets: `rs274/parameters.py` on arrays."""

from __future__ import annotations

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.layout_kernels import (
    A_NAME,
    CALL_LEVEL_NAME,
    CHANGED,
    CHANGES,
    COMPENSATES,
    CURRENT,
    EPOCH,
    FEED,
    FEED_NAME,
    FRAME,
    FRAME_EPOCH,
    FRAMES,
    FRESH,
    GLOBAL,
    HAS_RETURNED,
    IS_CHANGED,
    LETTERS,
    LETTERS_USED,
    LEVEL,
    LOCAL,
    MOST_LETTERS,
    MOST_LEVELS,
    MOST_NAMES,
    NAME,
    NAMED,
    NAMED_VALUES,
    NAMES,
    NAMES_USED,
    POSITION_NAME,
    RESULT,
    RETURNED,
    SET,
    SETTINGS,
    STAMPS,
    UNKNOWN,
    VALUE_NAME,
    VALUE_RETURNED_NAME,
)
from gcodesim.rs274.plain.text_kernels import byte_at

MISSES, FOUND, IS_ASKED = 0, 1, 2
"""A name has no value, has the value in RESULT, or has one that only the grammar's lane knows."""

_HASH_BITS = 0xFFFFFF
_MOST_USED = MOST_NAMES - MOST_NAMES // 4


@kernel
def find_name(text: Column, at: int, stop: int, modes: Column, tables: Column) -> int:
    """Read a name as far as its `>` into NAME, as a number; returns where it ends, -1 when the line is left.

    Blanks mean nothing and capitals are small. A new name gets a number of its own.
    """
    used = modes[LETTERS_USED]
    length, hashed = 0, 0
    while True:
        if at >= stop or used + length >= MOST_LETTERS:
            return -1
        char = byte_at(text, at)
        at += 1
        if char == 62:
            break
        if char == 32 or char == 9:
            continue
        if 65 <= char <= 90:
            char += 32
        if not (97 <= char <= 122 or 48 <= char <= 57 or char == 95 or char == 45 or char == 46):
            return -1
        tables[LETTERS + used + length] = char
        length += 1
        hashed = (hashed * 31 + char) & _HASH_BITS
    if length == 0:
        return -1
    name = hashed % MOST_NAMES
    while tables[NAMES + A_NAME * name + 1] != 0:
        begin = tables[NAMES + A_NAME * name]
        same = tables[NAMES + A_NAME * name + 1] == length
        each = 0
        while same and each < length:
            same = tables[LETTERS + begin + each] == tables[LETTERS + used + each]
            each += 1
        if same:
            modes[NAME] = name
            return at
        name = (name + 1) % MOST_NAMES
    if modes[NAMES_USED] >= _MOST_USED:
        return -1
    tables[NAMES + A_NAME * name] = used
    tables[NAMES + A_NAME * name + 1] = length
    tables[NAMES + A_NAME * name + 2] = GLOBAL if tables[LETTERS + used] == 95 else LOCAL
    modes[LETTERS_USED] = used + length
    modes[NAMES_USED] += 1
    modes[NAME] = name
    return at


@kernel
def named_value(numbers: Column, modes: Column, memory: Column, tables: Column) -> int:
    """The value of NAME into RESULT; MISSES, FOUND or IS_ASKED."""
    name = modes[NAME]
    kind = tables[NAMES + A_NAME * name + 2]
    if kind <= GLOBAL:
        row = MOST_LEVELS if kind == GLOBAL else modes[LEVEL]
        epoch = 1 if kind == GLOBAL else tables[FRAMES + FRAME * row + FRAME_EPOCH]
        if tables[STAMPS + MOST_NAMES * row + name] != epoch:
            return MISSES
        numbers[RESULT] = memory[NAMED_VALUES + MOST_NAMES * row + name]
        return FOUND
    if kind == UNKNOWN:
        return IS_ASKED
    if kind == FEED_NAME:
        numbers[RESULT] = numbers[FEED]
    elif kind == VALUE_NAME:
        numbers[RESULT] = numbers[RETURNED]
    elif kind == VALUE_RETURNED_NAME:
        numbers[RESULT] = 1.0 if modes[HAS_RETURNED] else 0.0
    elif kind == CALL_LEVEL_NAME:
        numbers[RESULT] = float(modes[LEVEL])
    elif modes[COMPENSATES]:
        return IS_ASKED
    else:
        numbers[RESULT] = numbers[CURRENT + kind - POSITION_NAME]
    return FOUND


@kernel
def may_be_set(numbers: Column, modes: Column, memory: Column, tables: Column) -> bool:
    """Whether a program may set NAME; notes when it has no value yet."""
    if tables[NAMES + A_NAME * modes[NAME] + 2] >= UNKNOWN:
        return False
    if named_value(numbers, modes, memory, tables) == MISSES:
        modes[FRESH] = 1
    return True


@kernel
def settle(numbers: Column, modes: Column, memory: Column, tables: Column) -> None:
    """Put what the line sets into effect."""
    for each in range(modes[SET]):
        target, value = modes[SET + 1 + each], numbers[SETTINGS + each]
        if target > 0:
            memory[target] = value
            if not tables[IS_CHANGED + target]:
                tables[IS_CHANGED + target] = 1
                tables[CHANGES + modes[CHANGED]] = target
                modes[CHANGED] += 1
        else:
            name = -1 - target
            is_global = tables[NAMES + A_NAME * name + 2] == GLOBAL
            row = MOST_LEVELS if is_global else modes[LEVEL]
            epoch = 1 if is_global else tables[FRAMES + FRAME * row + FRAME_EPOCH]
            memory[NAMED_VALUES + MOST_NAMES * row + name] = value
            tables[STAMPS + MOST_NAMES * row + name] = epoch
            modes[NAMED] = 1


@kernel
def forget_names(modes: Column, tables: Column) -> None:
    """The frame of the level at hand has no named parameters of its own."""
    modes[EPOCH] += 1
    tables[FRAMES + FRAME * modes[LEVEL] + FRAME_EPOCH] = modes[EPOCH]

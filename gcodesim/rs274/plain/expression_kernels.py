"""Values of words and expressions out of the text: `rs274/expressions.py` in compiled form, to the last bit.

Where a value is a fault, not a number, or not certainly what the grammar makes of the
text, the line is left. Nothing is changed here.
"""

from __future__ import annotations

import numpy as np

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.function_kernels import (
    ATAN,
    ATAN_OF,
    BRACKET,
    EXISTS,
    FUNCTION,
    HASH,
    NEGATIVE,
    OF_TWO,
    TO_DEGREES,
    apply_function,
    apply_operator,
    function_at,
    operator_at,
)
from gcodesim.rs274.plain.layout_kernels import (
    COMPENSATES,
    CURRENT,
    IS_EXTENDED,
    LAST_NUMBER,
    MISSING,
    MOST_OPERATORS,
    MOST_VALUES,
    OPERATORS,
    RESULT,
    STACK,
)
from gcodesim.rs274.plain.parameter_kernels import FOUND, MISSES, find_name, named_value
from gcodesim.rs274.plain.text_kernels import behind_blanks, byte_at

LEFT_OUT = -1
"""What `value_at` returns for a line that is left."""

_MOST_DIGITS = 15
_MOST_PLACES = 22
_POWERS = np.array([10.0**n for n in range(_MOST_PLACES + 1)])
_NEAR = 1e-4  # how far a parameter's number may be from a whole one


@kernel
def number_at(text: Column, at: int, stop: int, numbers: Column) -> int:
    """Read digits with at most one point into RESULT; returns where they end.

    An integer below 2**53 divided once by a power of ten is rounded as `float` does it.
    """
    mantissa, digits, read, places = 0, 0, 0, 0
    pointed = False
    while at < stop and (48 <= text[at] <= 57 or (text[at] == 46 and not pointed)):
        if text[at] == 46:
            pointed = True
        else:
            mantissa = mantissa * 10 + (byte_at(text, at) - 48)
            digits += 1 if mantissa > 0 else 0
            read += 1
            places += 1 if pointed else 0
            if digits > _MOST_DIGITS or places > _MOST_PLACES:
                return LEFT_OUT
        at += 1
    if read == 0:
        return LEFT_OUT
    value = float(mantissa)
    if places > 0:
        value /= _POWERS[places]
    numbers[RESULT] = value
    return at


@kernel
def value_at(text: Column, at: int, stop: int, numbers: Column, modes: Column, memory: Column, tables: Column) -> int:
    """Compute the value that begins at `at` into RESULT; returns where it ends, or LEFT_OUT.

    Two stacks, of values and of operators; an operator is applied as soon as one that binds less tightly follows.
    """
    operators, values = 0, 0
    wants = True  # a value comes next
    signed = False
    while True:
        at = behind_blanks(text, at, stop)
        if wants:
            if at >= stop or operators >= MOST_OPERATORS - 2 or values >= MOST_VALUES - 1:
                return LEFT_OUT
            char = byte_at(text, at)
            if char == 45 or char == 43:
                if signed:
                    return LEFT_OUT
                signed = True
                at += 1
                if char == 45:
                    modes[OPERATORS + operators] = NEGATIVE
                    operators += 1
                continue
            before = operators
            at, operators = _operand(text, at, stop, operators, numbers, modes, memory, tables)
            if at < 0:
                return LEFT_OUT
            if operators == before:  # no bracket, function or `#` that waits for what follows, but a value
                numbers[STACK + values] = numbers[RESULT]
                values += 1
                wants = False
            signed = False
            continue
        # after a value: first the operators in front of it that bind it alone
        operators = _bound(operators, values, numbers, modes, memory)
        if operators < 0:
            return LEFT_OUT
        if operators == 0:
            numbers[RESULT] = numbers[STACK]
            return at
        if at >= stop:
            return LEFT_OUT
        if text[at] == 93:
            at, operators, values, wants = _closed(text, at + 1, stop, operators, values, numbers, modes)
            if at < 0:
                return LEFT_OUT
            continue
        at, what = operator_at(text, at, stop)
        if at < 0:
            return LEFT_OUT
        operators, values = _reduced(what // 10, operators, values, numbers, modes)
        if operators < 0:
            return LEFT_OUT
        modes[OPERATORS + operators] = what
        operators += 1
        wants = True


@kernel(inlined=True)
def _operand(
    text: Column, at: int, stop: int, operators: int, numbers: Column, modes: Column, memory: Column, tables: Column
) -> tuple[int, int]:
    """Read what begins a value: a number or named parameter into RESULT, or a bracket, `#` or function as operators.

    Returns where it ends, LEFT_OUT if the line is left, and the size of the stack of operators.
    """
    char = byte_at(text, at)
    if 48 <= char <= 57 or char == 46:
        at = number_at(text, at, stop, numbers)
        if at < 0:
            return LEFT_OUT, operators
        behind = behind_blanks(text, at, stop)
        if behind < stop and (48 <= text[behind] <= 57 or text[behind] == 46):
            return LEFT_OUT, operators  # blanks mean nothing: 1 2 is 12
        return at, operators
    if char == 91:
        modes[OPERATORS + operators] = BRACKET
        return at + 1, operators + 1
    if char == 35:
        at = behind_blanks(text, at + 1, stop)
        if at < stop and text[at] == 60:
            at = name_at(text, at + 1, stop, modes, tables)
            if at < 0 or named_value(numbers, modes, memory, tables) != FOUND:
                return LEFT_OUT, operators
            return at, operators
        modes[OPERATORS + operators] = HASH
        return at, operators + 1
    at, what = function_at(text, at, stop)
    if at < 0:
        return LEFT_OUT, operators
    if what == EXISTS:
        return _exists_at(text, at, stop, numbers, modes, memory, tables), operators
    modes[OPERATORS + operators] = what
    modes[OPERATORS + operators + 1] = BRACKET
    return at, operators + 2


@kernel(inlined=True)
def _bound(operators: int, values: int, numbers: Column, modes: Column, memory: Column) -> int:
    """Apply the operators that stand directly in front of the last value; how many operators are left, or LEFT_OUT."""
    while operators > 0:
        top = modes[OPERATORS + operators - 1]
        if top == NEGATIVE:
            numbers[STACK + values - 1] = -1.0 * numbers[STACK + values - 1]
        elif top == HASH:
            if not _parameter(numbers[STACK + values - 1], numbers, modes, memory):
                return LEFT_OUT
            numbers[STACK + values - 1] = numbers[RESULT]
        else:
            break
        operators -= 1
    return operators


@kernel(inlined=True)
def _closed(
    text: Column, at: int, stop: int, operators: int, values: int, numbers: Column, modes: Column
) -> tuple[int, int, int, bool]:
    """Compute what a bracket contains, which ends in front of `at`, and the function of it.

    Returns where to read on, LEFT_OUT if the line is left, the sizes of both stacks, and whether a value comes next.
    """
    operators, values = _reduced(0, operators, values, numbers, modes)
    if operators <= 0 or modes[OPERATORS + operators - 1] != BRACKET:
        return LEFT_OUT, operators, values, False
    operators -= 1
    if operators == 0:
        return at, operators, values, False
    top = modes[OPERATORS + operators - 1]
    if FUNCTION <= top < OF_TWO:
        if not apply_function(top, numbers[STACK + values - 1], numbers):
            return LEFT_OUT, operators, values, False
        numbers[STACK + values - 1] = numbers[RESULT]
        operators -= 1
    elif top == ATAN:
        at = behind_blanks(text, at, stop)
        if at >= stop or text[at] != 47:
            return LEFT_OUT, operators, values, False
        at = behind_blanks(text, at + 1, stop)
        if at >= stop or text[at] != 91 or values >= MOST_VALUES - 1:
            return LEFT_OUT, operators, values, False
        modes[OPERATORS + operators - 1] = ATAN_OF
        modes[OPERATORS + operators] = BRACKET
        return at + 1, operators + 1, values, True
    elif top == ATAN_OF:
        values -= 1
        a, b = numbers[STACK + values - 1], numbers[STACK + values]
        numbers[STACK + values - 1] = atan2(a, b) * TO_DEGREES
        operators -= 1
    return at, operators, values, False


@kernel
def _reduced(binding: int, operators: int, values: int, numbers: Column, modes: Column) -> tuple[int, int]:
    """Apply operators of two values that bind at least this tightly; sizes of both stacks, -1 if the line is left."""
    while operators > 0:
        top = modes[OPERATORS + operators - 1]
        if top < OF_TWO or top // 10 < binding:
            break
        values -= 1
        if not apply_operator(top, numbers[STACK + values - 1], numbers[STACK + values], numbers):
            return LEFT_OUT, values
        numbers[STACK + values - 1] = numbers[RESULT]
        operators -= 1
    return operators, values


@kernel
def whole_number(value: float) -> int:
    """The number of a parameter meant by a value; 0 if it is not a parameter's number."""
    if not 0.0 <= value <= LAST_NUMBER + 1.0:
        return 0
    number = int(value + 0.5)
    if abs(value - number) > _NEAR or number > LAST_NUMBER:
        return 0
    return number


@kernel
def shows_state(number: int) -> bool:
    """Whether #number cannot be set."""
    return 5400 <= number <= 5413 or 5420 <= number <= 5428


@kernel
def _parameter(value: float, numbers: Column, modes: Column, memory: Column) -> bool:
    """The value of the numbered parameter into RESULT."""
    number = whole_number(value)
    if number == 0:
        return False
    if shows_state(number):
        if not 5420 <= number <= 5425 or modes[COMPENSATES]:
            return False
        numbers[RESULT] = numbers[CURRENT + number - 5420]
        return True
    numbers[RESULT] = memory[number]
    return True


@kernel
def name_at(text: Column, at: int, stop: int, modes: Column, tables: Column) -> int:
    """Read a name after its `<` into NAME; returns where it ends, after its `>`."""
    if not modes[IS_EXTENDED]:
        return LEFT_OUT
    return find_name(text, at, stop, modes, tables)


@kernel
def _exists_at(text: Column, at: int, stop: int, numbers: Column, modes: Column, memory: Column, tables: Column) -> int:
    """After `exists [`: put the answer about a named parameter into RESULT."""
    at = behind_blanks(text, at, stop)
    if at >= stop or text[at] != 35:
        return LEFT_OUT
    at = behind_blanks(text, at + 1, stop)
    if at >= stop or text[at] != 60:
        return LEFT_OUT
    at = name_at(text, at + 1, stop, modes, tables)
    if at < 0:
        return LEFT_OUT
    at = behind_blanks(text, at, stop)
    if at >= stop or text[at] != 93:
        return LEFT_OUT
    there = named_value(numbers, modes, memory, tables)
    if there == MISSES:
        modes[MISSING] = 1
    numbers[RESULT] = 0.0 if there == MISSES else 1.0
    return at + 1

"""Operators and functions of expressions: how they are spelt, and what `rs274/functions.py` makes of numbers.

The arithmetic is that of `functions.py` and `expressions.py`, step by step: no result depends on which lane
computes it.
"""

from __future__ import annotations

import math

import numpy as np

from gcodesim.arithmetic.atan_kernels import acos, asin
from gcodesim.arithmetic.power_kernels import exp, log, power
from gcodesim.arithmetic.sin_kernels import cos, sin, tan
from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.layout_kernels import RESULT
from gcodesim.rs274.plain.text_kernels import behind_blanks, byte_at

NOTHING = -1
"""Where nothing ends: the text is no operator or function that these kernels know."""

# on the stack of operators: operators in front of one value, then operators of two values, whose tens say how
# tightly they bind
BRACKET, NEGATIVE, HASH, ATAN, ATAN_OF = 1, 2, 3, 4, 5
EXISTS = 6
FUNCTION = 10
OF_TWO = 100
_AND, _OR, _XOR = 110, 111, 112
_EQ, _NE, _GT, _GE, _LT, _LE = 120, 121, 122, 123, 124, 125
_PLUS, _MINUS = 130, 131
_TIMES, _OVER, _MOD = 140, 141, 142
_POWER = 150
_ABS, _ACOS, _ASIN, _COS, _EXP, _FIX, _FUP, _LN, _ROUND, _SIN, _SQRT, _TAN = range(FUNCTION, FUNCTION + 12)

TO_DEGREES = 180.0 / math.pi
_TO_RADIANS = math.pi / 180.0
_NEAR = 1e-4  # EQ and NE


@kernel
def _letter(text: Column, at: int, stop: int) -> int:
    """A letter as a number, 0 for A; -1 if it is not a letter."""
    if at >= stop:
        return -1
    char = byte_at(text, at) | 32
    return char - 97 if 97 <= char <= 122 else -1


@kernel
def _word_at(text: Column, at: int, stop: int) -> tuple[int, int]:
    """Letters in a row: where they end, and the word as a number to the base 32."""
    word = 0
    count = 0
    letter = _letter(text, at, stop)
    while letter >= 0:
        count += 1
        if count > 6:
            return NOTHING, 0
        word = word * 32 + letter + 1
        at += 1
        letter = _letter(text, at, stop)
    return at, word


def _spelt(word: str) -> int:
    number = 0
    for char in word:
        number = number * 32 + ord(char) - 96
    return number


_W_ABS, _W_ACOS, _W_ASIN, _W_ATAN = _spelt("abs"), _spelt("acos"), _spelt("asin"), _spelt("atan")
_W_COS, _W_EXP, _W_FIX, _W_FUP = _spelt("cos"), _spelt("exp"), _spelt("fix"), _spelt("fup")
_W_LN, _W_ROUND, _W_SIN, _W_SQRT, _W_TAN = _spelt("ln"), _spelt("round"), _spelt("sin"), _spelt("sqrt"), _spelt("tan")
_W_EXISTS = _spelt("exists")
_W_AND, _W_OR, _W_XOR, _W_MOD = _spelt("and"), _spelt("or"), _spelt("xor"), _spelt("mod")
_W_EQ, _W_NE, _W_GT, _W_GE, _W_LT, _W_LE = (
    _spelt("eq"), _spelt("ne"), _spelt("gt"), _spelt("ge"), _spelt("lt"), _spelt("le"),
)  # fmt: skip


@kernel
def function_at(text: Column, at: int, stop: int) -> tuple[int, int]:
    """A function and its opening bracket: where they end, and which."""
    at, word = _word_at(text, at, stop)
    if at < 0 or word == 0:
        return NOTHING, 0
    at = behind_blanks(text, at, stop)
    if at >= stop or text[at] != 91:
        return NOTHING, 0
    if word == _W_SIN:
        which = _SIN
    elif word == _W_COS:
        which = _COS
    elif word == _W_TAN:
        which = _TAN
    elif word == _W_ABS:
        which = _ABS
    elif word == _W_SQRT:
        which = _SQRT
    elif word == _W_ATAN:
        which = ATAN
    elif word == _W_ASIN:
        which = _ASIN
    elif word == _W_ACOS:
        which = _ACOS
    elif word == _W_EXP:
        which = _EXP
    elif word == _W_LN:
        which = _LN
    elif word == _W_FIX:
        which = _FIX
    elif word == _W_FUP:
        which = _FUP
    elif word == _W_ROUND:
        which = _ROUND
    elif word == _W_EXISTS:
        which = EXISTS
    else:
        return NOTHING, 0
    return at + 1, which


@kernel
def operator_at(text: Column, at: int, stop: int) -> tuple[int, int]:
    """An operator of two values: where it ends, and which."""
    char = byte_at(text, at)
    if char == 43:
        return at + 1, _PLUS
    if char == 45:
        return at + 1, _MINUS
    if char == 47:
        return at + 1, _OVER
    if char == 42:
        behind = behind_blanks(text, at + 1, stop)
        if behind < stop and text[behind] == 42:
            return behind + 1, _POWER
        return at + 1, _TIMES
    at, word = _word_at(text, at, stop)
    which = 0
    if word == _W_MOD:
        which = _MOD
    elif word == _W_EQ:
        which = _EQ
    elif word == _W_NE:
        which = _NE
    elif word == _W_GT:
        which = _GT
    elif word == _W_GE:
        which = _GE
    elif word == _W_LT:
        which = _LT
    elif word == _W_LE:
        which = _LE
    elif word == _W_AND:
        which = _AND
    elif word == _W_OR:
        which = _OR
    elif word == _W_XOR:
        which = _XOR
    else:
        return NOTHING, 0
    return at, which


@kernel
def apply_operator(operator: int, a: float, b: float, numbers: Column) -> bool:
    """One operation into RESULT; False where it has no finite value."""
    value = 0.0
    if operator == _PLUS:
        value = a + b
    elif operator == _MINUS:
        value = a - b
    elif operator == _TIMES:
        value = a * b
    elif operator == _OVER:
        if b == 0.0:
            return False
        value = a / b
    elif operator == _MOD:
        if b == 0.0:
            return False
        value = np.fmod(a, b)
        if value < 0.0:
            value += abs(b)
    elif operator == _POWER:
        if a < 0.0 and np.floor(b) != b:
            return False
        value = power(a, b)
    elif operator == _EQ:
        value = 1.0 if abs(a - b) < _NEAR else 0.0
    elif operator == _NE:
        value = 1.0 if abs(a - b) >= _NEAR else 0.0
    elif operator == _GT:
        value = 1.0 if a > b else 0.0
    elif operator == _GE:
        value = 1.0 if a >= b else 0.0
    elif operator == _LT:
        value = 1.0 if a < b else 0.0
    elif operator == _LE:
        value = 1.0 if a <= b else 0.0
    elif operator == _AND:
        value = 1.0 if a != 0.0 and b != 0.0 else 0.0
    elif operator == _OR:
        value = 1.0 if a != 0.0 or b != 0.0 else 0.0
    else:
        value = 1.0 if (a != 0.0) != (b != 0.0) else 0.0
    numbers[RESULT] = value
    return value - value == 0.0


@kernel
def apply_function(function: int, a: float, numbers: Column) -> bool:
    """A function of one value into RESULT; False where it has no finite value."""
    value = 0.0
    if function == _SIN:
        value = sin(a * _TO_RADIANS)
    elif function == _COS:
        value = cos(a * _TO_RADIANS)
    elif function == _TAN:
        value = tan(a * _TO_RADIANS)
    elif function == _ABS:
        value = abs(a)
    elif function == _SQRT:
        if a < 0.0:
            return False
        value = math.sqrt(a)
    elif function in (_ASIN, _ACOS):
        if not -1.0 <= a <= 1.0:
            return False
        value = (asin(a) if function == _ASIN else acos(a)) * TO_DEGREES
    elif function == _EXP:
        value = exp(a)
    elif function == _LN:
        if a <= 0.0:
            return False
        value = log(a)
    elif function == _FIX:
        value = np.floor(a) + 0.0  # + 0.0, because an integer has no -0
    elif function == _FUP:
        value = np.ceil(a) + 0.0
    elif a != 0.0:
        value = math.copysign(np.floor(abs(a) + 0.5), a)
    numbers[RESULT] = value
    return value - value == 0.0

"""Values of custom macro expressions. A vacant variable is None, which counts as 0 in arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from gcodesim.arithmetic.scalars import acos, asin, atan, atan2, cos, power, sin, tan
from gcodesim.rs274.block import Binary, Expression, Function, Parameter, Signed
from gcodesim.rs274.expressions import LARGEST
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.functions import arc, exponential, logarithm, nearest, root

if TYPE_CHECKING:
    from gcodesim.rs274.fanuc.variables import Variables

_SAME = 1e-10  # values nearer than this, for their size, are rounding


def value_of(node: Expression, variables: Variables) -> float | None:
    """The value of `node`, None where it is a vacant variable; raises `Fault` where there is none."""
    try:
        value = _value(node, variables)
    except OverflowError:
        raise Fault("GS123", "the value is too large to be a number") from None
    if value is not None and not abs(value) <= LARGEST:  # false for NaN as well
        raise Fault("GS123", f"the value {value:g} is out of any machine's range", limit=LARGEST)
    return value


def number_of(node: Expression, variables: Variables) -> float:
    """Like `value_of`, except that a vacant variable is 0."""
    return value_of(node, variables) or 0.0


def _value(node: Expression, variables: Variables) -> float | None:
    if type(node) is float:
        return node
    if isinstance(node, Parameter):
        return variables.read(variables.index(_value(node.index, variables) or 0.0))
    if isinstance(node, Signed):
        value = _value(node.operand, variables)
        return None if value is None else node.sign * value
    if isinstance(node, Binary):
        left, right = _value(node.left, variables), _value(node.right, variables)
        if node.operator in ("eq", "ne"):
            return float(_equal(left, right) == (node.operator == "eq"))
        return _OPERATORS[node.operator](left or 0.0, right or 0.0)
    if isinstance(node, Function):
        argument = _value(node.argument, variables) or 0.0
        if node.name == "pow":
            return _power(argument, _value(node.divisor, variables) or 0.0)
        if node.name == "atan" and node.divisor != 0.0:
            angle = math.degrees(atan2(argument, _value(node.divisor, variables) or 0.0))
            return angle % 360.0
        return _FUNCTIONS[node.name](argument)
    raise Fault("GS006", "this cannot stand in a macro expression")


def _equal(left: float | None, right: float | None) -> bool:
    """Vacant equals vacant and nothing else, not even 0."""
    if left is None or right is None:
        return left is right
    return abs(left - right) <= _SAME * max(1.0, abs(left), abs(right))


def _divide(a: float, b: float) -> float:
    if b == 0.0:
        raise Fault("GS123", "division by zero", hint="test the divisor before: IF[#1EQ0]GOTO…")
    return a / b


def _modulo(a: float, b: float) -> float:
    """The remainder of whole numbers, with the sign of the dividend."""
    divisor = nearest(b)
    if divisor == 0.0:
        raise Fault("GS123", "MOD by zero")
    return math.fmod(nearest(a), divisor)


def _power(a: float, b: float) -> float:
    if (a < 0.0 and not b.is_integer()) or (a == 0.0 and b < 0.0):
        raise Fault("GS123", f"POW[{a:g},{b:g}] has no value")
    value = power(a, b)
    if math.isinf(value):
        raise OverflowError
    return value


def _bits(act: Callable[[int, int], int]) -> Callable[[float, float], float]:
    return lambda a, b: float(act(round(a), round(b)))


def _from_decimal_digits(a: float) -> float:
    """BIN: every four bits are a decimal digit."""
    digits = f"{abs(round(a)):x}"
    if not digits.isdigit():
        raise Fault("GS123", f"BIN of {a:g}: it is no number in decimal digits")
    return math.copysign(float(int(digits)), a)


def _to_decimal_digits(a: float) -> float:
    """BCD: the other way round."""
    return math.copysign(float(int(str(abs(round(a))), 16)), a)


_OPERATORS: dict[str, Callable[[float, float], float]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": _divide,
    "mod": _modulo,
    "and": _bits(int.__and__),
    "or": _bits(int.__or__),
    "xor": _bits(int.__xor__),
    "gt": lambda a, b: float(a > b),
    "ge": lambda a, b: float(a >= b),
    "lt": lambda a, b: float(a < b),
    "le": lambda a, b: float(a <= b),
}

_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "abs": abs,
    "acos": arc("ACOS", acos),
    "adp": lambda a: a,
    "asin": arc("ASIN", asin),
    "atan": lambda a: math.degrees(atan(a)),
    "bcd": _to_decimal_digits,
    "bin": _from_decimal_digits,
    "cos": lambda a: cos(math.radians(a)),
    "exp": exponential,
    "fix": lambda a: float(math.trunc(a)),
    "fup": lambda a: math.copysign(math.ceil(abs(a)), a),
    "ln": logarithm,
    "rnd": nearest,
    "round": nearest,
    "sin": lambda a: sin(math.radians(a)),
    "sqr": root,
    "sqrt": root,
    "tan": lambda a: tan(math.radians(a)),
}

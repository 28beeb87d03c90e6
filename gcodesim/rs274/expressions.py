"""Values of expressions, with the arithmetic of RS274: degrees, a tolerant EQ, a MOD that is never negative."""

from __future__ import annotations

import math
from collections.abc import Callable

from gcodesim.rs274.block import Binary, Exists, Function, Name, Node, Parameter, Signed
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.parameters import Parameters

_NEAR = 1e-4  # EQ and NE treat numbers nearer than this as equal
LARGEST = 1e30  # beyond this a number means nothing on any machine, and its square may be no number


def evaluate(node: Node, parameters: Parameters) -> float:
    """The value of `node`; raises `Fault` where a function or operator has none."""
    if type(node) is float:
        return node
    if isinstance(node, Parameter):
        return _parameter(node.index, parameters)
    if isinstance(node, Binary):
        return _OPERATORS[node.operator](evaluate(node.left, parameters), evaluate(node.right, parameters))
    if isinstance(node, Signed):
        return node.sign * evaluate(node.operand, parameters)
    if isinstance(node, Function):
        if node.name == "atan":
            return math.degrees(math.atan2(evaluate(node.argument, parameters), evaluate(node.divisor, parameters)))
        return _FUNCTIONS[node.name](evaluate(node.argument, parameters))
    if isinstance(node, Exists):
        return _exists(node, parameters)
    if isinstance(node, Name):
        raise Fault("GS006", f"<{node.name}> is a name without `#`")
    return float(node)


def checked(node: Node, parameters: Parameters) -> float:
    """Like `evaluate`, and the value is one that a machine can be given."""
    try:
        value = evaluate(node, parameters)
    except OverflowError:
        raise Fault("GS123", "the value is too large to be a number") from None
    if not abs(value) <= LARGEST:  # false for NaN as well
        raise Fault("GS123", f"the value {value:g} is out of any machine's range", limit=LARGEST)
    return value


def _parameter(index: Node, parameters: Parameters) -> float:
    if isinstance(index, Name):
        return parameters.get_named(index.name)
    return parameters.get(parameters.index(evaluate(index, parameters)))


def _exists(node: Exists, parameters: Parameters) -> float:
    if isinstance(node.index, Name):
        return float(parameters.exists(node.index.name))
    return float(1 <= round(evaluate(node.index, parameters)) <= 5601)


def _divide(a: float, b: float) -> float:
    if b == 0.0:
        raise Fault("GS123", "division by zero", hint="test the divisor before, or guard the line with an O-word if")
    return a / b


def _modulo(a: float, b: float) -> float:
    if b == 0.0:
        raise Fault("GS123", "MOD by zero")
    rest = math.fmod(a, b)
    return rest + abs(b) if rest < 0.0 else rest


def _power(a: float, b: float) -> float:
    if a < 0.0 and not b.is_integer():
        raise Fault("GS123", f"{a:g} ** {b:g}: a negative number has no such power")
    if a == 0.0 and b < 0.0:
        raise Fault("GS123", f"0 ** {b:g} is infinite")
    return float(a**b)


def _root(a: float) -> float:
    if a < 0.0:
        raise Fault("GS123", f"SQRT of {a:g}: a negative number has no root")
    return math.sqrt(a)


def _logarithm(a: float) -> float:
    if a <= 0.0:
        raise Fault("GS123", f"LN of {a:g}: only positive numbers have a logarithm")
    return math.log(a)


def _arc(name: str, function: Callable[[float], float]) -> Callable[[float], float]:
    def inverse(a: float) -> float:
        if not -1.0 <= a <= 1.0:
            raise Fault("GS123", f"{name} of {a:g}: the argument must be between -1 and 1")
        return math.degrees(function(a))

    return inverse


def _round(a: float) -> float:
    """To the nearest integer, halves away from zero."""
    return math.copysign(math.floor(abs(a) + 0.5), a) if a else 0.0


_OPERATORS: dict[str, Callable[[float, float], float]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": _divide,
    "mod": _modulo,
    "**": _power,
    "eq": lambda a, b: float(abs(a - b) < _NEAR),
    "ne": lambda a, b: float(abs(a - b) >= _NEAR),
    "gt": lambda a, b: float(a > b),
    "ge": lambda a, b: float(a >= b),
    "lt": lambda a, b: float(a < b),
    "le": lambda a, b: float(a <= b),
    "and": lambda a, b: float(a != 0.0 and b != 0.0),
    "or": lambda a, b: float(a != 0.0 or b != 0.0),
    "xor": lambda a, b: float((a != 0.0) != (b != 0.0)),
}

_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "abs": abs,
    "acos": _arc("ACOS", math.acos),
    "asin": _arc("ASIN", math.asin),
    "cos": lambda a: math.cos(math.radians(a)),
    "exp": math.exp,
    "fix": lambda a: float(math.floor(a)),
    "fup": lambda a: float(math.ceil(a)),
    "ln": _logarithm,
    "round": _round,
    "sin": lambda a: math.sin(math.radians(a)),
    "sqrt": _root,
    "tan": lambda a: math.tan(math.radians(a)),
}

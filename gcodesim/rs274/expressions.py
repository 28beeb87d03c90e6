"""Values of expressions, with the arithmetic of RS274: degrees, a tolerant EQ, a MOD that is never negative."""

from __future__ import annotations

import math
from collections.abc import Callable

from gcodesim.arithmetic.scalars import acos, asin, atan2, cos, power, sin, tan
from gcodesim.rs274.block import Binary, Exists, Expression, Function, Name, Parameter, Signed
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.functions import arc, exponential, logarithm, nearest, root
from gcodesim.rs274.parameters import Parameters

_NEAR = 1e-4  # EQ and NE treat numbers nearer than this as equal
LARGEST = 1e30  # beyond this a number is meaningless on any machine, and its square may not be a number


def evaluate(node: Expression, parameters: Parameters) -> float:
    """The value of `node`, a finite number; raises `Fault` where a function or operator has none."""
    value = _operation(node, parameters) if type(node) is Binary else _single(node, parameters)
    if not math.isfinite(value):
        raise Fault("GS123", _why(node, parameters) or f"the value is no number: {value:g}")
    return value


def _operation(node: Binary, parameters: Parameters) -> float:
    """As on the control, what lies between two operators of one bracket may be infinite or no number:
    a comparison makes a number of it again."""
    left, right = node.left, node.right
    return _OPERATORS[node.operator](
        _operation(left, parameters) if type(left) is Binary and not left.closed else evaluate(left, parameters),
        _operation(right, parameters) if type(right) is Binary and not right.closed else evaluate(right, parameters),
    )


def loose(node: Expression, parameters: Parameters) -> float:
    """Like `evaluate` for an expression alone in brackets, as after an O-word or a function: it may not be a number."""
    return _operation(node, parameters) if type(node) is Binary else evaluate(node, parameters)


def _why(node: Expression, parameters: Parameters) -> str:
    """What made the value of `node` infinite or not a number; empty if its operators do not show it."""
    if type(node) is not Binary:
        return ""
    for side in (node.left, node.right):
        if type(side) is Binary and not side.closed and (reason := _why(side, parameters)):
            return reason
    values = [
        _operation(side, parameters) if type(side) is Binary else evaluate(side, parameters)
        for side in (node.left, node.right)
    ]
    if node.operator == "mod" and values[1] == 0.0:
        return "MOD by zero"
    if node.operator == "**" and math.isinf(_power(*values)):
        return f"{values[0]:g} ** {values[1]:g} is infinite"
    return ""


def _single(node: Expression, parameters: Parameters) -> float:
    if type(node) is float:
        return node
    if isinstance(node, Parameter):
        return _parameter(node.index, parameters)
    if isinstance(node, Signed):
        return node.sign * evaluate(node.operand, parameters)
    if isinstance(node, Function):
        argument = loose(node.argument, parameters)
        if node.name == "atan":
            return math.degrees(atan2(argument, loose(node.divisor, parameters)))
        try:
            return _FUNCTIONS[node.name](argument)
        except (ValueError, OverflowError):
            return math.nan
    if isinstance(node, Exists):
        return _exists(node, parameters)
    if isinstance(node, Name):
        raise Fault("GS006", f"<{node.name}> is a name without `#`")
    return float(node)  # type: ignore[arg-type]


def checked(node: Expression, parameters: Parameters) -> float:
    """Like `evaluate`, and the value is one that a machine can be given."""
    try:
        value = evaluate(node, parameters)
    except OverflowError:
        raise Fault("GS123", "the value is too large to be a number") from None
    if not abs(value) <= LARGEST:  # false for NaN as well
        raise Fault("GS123", f"the value {value:g} is out of any machine's range", limit=LARGEST)
    return value


def names_in(node: Expression, name: str) -> bool:
    """Whether the value of `node` needs the named parameter `name`; a question with EXISTS does not."""
    if isinstance(node, Parameter):
        return node.index.name == name if isinstance(node.index, Name) else names_in(node.index, name)
    if isinstance(node, Binary):
        return names_in(node.left, name) or names_in(node.right, name)
    if isinstance(node, Function):
        return names_in(node.argument, name) or names_in(node.divisor, name)
    return names_in(node.operand, name) if isinstance(node, Signed) else False


def _parameter(index: Expression, parameters: Parameters) -> float:
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
    if b == 0.0 or not math.isfinite(a) or math.isnan(b):
        return math.nan
    rest = math.fmod(a, b)
    return rest + abs(b) if rest < 0.0 else rest


def _power(a: float, b: float) -> float:
    if a < 0.0 and math.isfinite(b) and not b.is_integer():
        raise Fault("GS123", f"{a:g} ** {b:g}: a negative number has no such power")
    return power(a, b) if a != 0.0 or b >= 0.0 else math.inf


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
    "acos": arc("ACOS", acos),
    "asin": arc("ASIN", asin),
    "cos": lambda a: cos(math.radians(a)),
    "exp": exponential,
    "fix": lambda a: float(math.floor(a)),
    "fup": lambda a: float(math.ceil(a)),
    "ln": logarithm,
    "round": nearest,
    "sin": lambda a: sin(math.radians(a)),
    "sqrt": root,
    "tan": lambda a: tan(math.radians(a)),
}

"""Values of expressions; angles are in radians, and numbers have more digits than those of the firmware."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, Protocol

from gcodesim.arithmetic.scalars import acos, asin, atan, atan2, cos, exp, log, power, sin, tan
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.marlin.duet.syntax import Call, Constant, Items, Node, Operation, Path, Ternary, Unary, Value

_LARGEST: Final = 2.0**31  # of whole numbers; the firmware goes on with a negative one


class Names(Protocol):
    """Who knows the values of names such as `var.x` and `move.axes[0].max`."""

    def value(self, path: tuple[str | int, ...]) -> Value:
        """Raises `Fault` where nobody knows it."""

    def exists(self, path: tuple[str | int, ...]) -> bool:
        """Raises `Fault` where nobody knows that."""


def evaluate(node: Node, names: Names) -> Value:
    """The value of an expression; raises `Fault`."""
    return _KINDS[type(node)](node, names)


def truth(node: Node, names: Names) -> bool:
    """The value of a condition."""
    value = evaluate(node, names)
    if type(value) is not bool:
        raise Fault("GS123", f"true or false is expected, not {shown(value)}")
    return value


def number(value: Value) -> int | float:
    """A value that has to be a number."""
    if type(value) is int or type(value) is float:
        if abs(value) > _LARGEST if type(value) is int else not math.isfinite(value):
            raise Fault("GS123", "a value is too large to be computed with")
        return value
    raise Fault("GS123", f"a number is expected, not {shown(value)}")


def shown(value: Value) -> str:
    """A value as `echo` and `^` write it."""
    if value is None:
        return "null"
    if type(value) is bool:
        return "true" if value else "false"
    if type(value) is float:
        return f"{value:.7g}"
    if type(value) is tuple:
        return "[" + ",".join(map(shown, value)) + "]"
    return str(value)


def path_of(node: Path, names: Names) -> tuple[str | int, ...]:
    """A path with its indices computed."""
    return tuple(part if type(part) is str else _whole(evaluate(part, names)) for part in node.parts)  # type: ignore[arg-type]


def _whole(value: Value) -> int:
    if type(value) is not int or value < 0:
        raise Fault("GS123", f"an index is a whole number from 0 on, not {shown(value)}")
    return value


def _unary(node: Unary, names: Names) -> Value:
    if node.operator == "!":
        return not truth(node.operand, names)
    value = evaluate(node.operand, names)
    if node.operator == "#":
        if type(value) is str or type(value) is tuple:
            return len(value)
        raise Fault("GS123", f"`#` counts a text or an array, not {shown(value)}")
    return -number(value) if node.operator == "-" else number(value)


def _operation(node: Operation, names: Names) -> Value:
    sign = node.operator
    if sign in "&|":
        left = truth(node.left, names)
        return left if left is (sign == "|") else truth(node.right, names)
    one, other = evaluate(node.left, names), evaluate(node.right, names)
    if sign == "^":
        return shown(one) + shown(other)
    if sign in ("=", "!="):
        return _equal(one, other) is (sign == "=")
    if sign in _COMPARISONS:
        if type(one) is bool and type(other) is bool:
            return _COMPARISONS[sign](int(one), int(other))
        return _COMPARISONS[sign](number(one), number(other))
    a, b = number(one), number(other)
    if sign == "/" and b == 0:
        raise Fault("GS123", "a division by zero")
    return number(_ARITHMETIC[sign](a, b))


def _equal(one: Value, other: Value) -> bool:
    if one is None or other is None:
        return one is other
    kinds = {"number" if type(each) in (int, float) else type(each).__name__ for each in (one, other)}
    if len(kinds) > 1:
        raise Fault("GS123", f"{shown(one)} and {shown(other)} cannot be compared")
    return one == other


_COMPARISONS: Final[dict[str, Callable[[float, float], bool]]] = {
    "<": lambda a, b: a < b,
    ">": lambda a, b: a > b,
    "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b,
}
_ARITHMETIC: Final[dict[str, Callable[[float, float], float]]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
}


def _call(node: Call, names: Names) -> Value:
    if node.name == "exists":
        (operand,) = node.operands
        if type(operand) is not Path:
            raise Fault("GS006", "`exists` asks for a name")
        return names.exists(path_of(operand, names))
    if node.name in _OF_PRINTER:
        raise Fault("GS120", f"`{node.name}` is known to the printer only", hint=_WRITE)
    known = _FUNCTIONS.get(node.name)
    if known is None:
        raise Fault("GS006", f"there is no function `{node.name}`")
    counts, function = known
    values = [evaluate(operand, names) for operand in node.operands]
    if len(values) not in counts:
        raise Fault("GS006", f"`{node.name}` takes {counts[0]} value{'' if counts[0] == 1 else 's'}, not {len(values)}")
    if node.name in _OF_NUMBERS:
        values = [number(value) for value in values]
    try:
        value = function(*values)
        return number(value) if type(value) is float else value
    except (ValueError, ZeroDivisionError, OverflowError):
        raise Fault("GS123", f"`{node.name}` has no value for {', '.join(map(shown, values))}") from None


def _mod(a: float, b: float) -> float:
    if type(a) is int and type(b) is int:
        return 0 if b == 0 else int(math.fmod(a, b))
    return math.fmod(a, b)


def _extreme(choose: Callable[..., float]) -> Callable[..., Value]:
    def of(*values: Value) -> Value:
        one = values[0]
        items = one if len(values) == 1 and type(one) is tuple else values
        return choose(map(number, items))

    return of


def _vector(count: Value, value: Value) -> Value:
    if _whole(count) > _MOST_ITEMS:
        raise Fault("GS123", f"an array of {shown(count)} values is too large")
    return (value,) * _whole(count)


def _in_domain(function: Callable[[float], float], least: float, most: float) -> Callable[[float], float]:
    def of(a: float) -> float:
        if not least <= a <= most:
            raise ValueError
        return function(a)

    return of


_MOST_ITEMS: Final = 10_000
_ONE, _TWO, _ANY = (1,), (2,), range(1, 100)
_FUNCTIONS: Final[dict[str, tuple[tuple[int, ...] | range, Callable[..., Value]]]] = {
    "abs": (_ONE, abs),
    "acos": (_ONE, _in_domain(acos, -1.0, 1.0)),
    "asin": (_ONE, _in_domain(asin, -1.0, 1.0)),
    "atan": (_ONE, atan),
    "atan2": (_TWO, atan2),
    "ceil": (_ONE, math.ceil),
    "cos": (_ONE, cos),
    "degrees": (_ONE, math.degrees),
    "exp": (_ONE, exp),
    "floor": (_ONE, math.floor),
    "isnan": (_ONE, lambda a: False),  # what is no number here is a fault before
    "log": (_ONE, _in_domain(log, math.ulp(0.0), math.inf)),
    "max": (_ANY, _extreme(max)),
    "min": (_ANY, _extreme(min)),
    "mod": (_TWO, _mod),
    "pow": (_TWO, power),
    "radians": (_ONE, math.radians),
    "round": (_ONE, lambda a: math.floor(abs(a) + 0.5) * (1 if a >= 0 else -1)),
    "sin": (_ONE, sin),
    "sqrt": (_ONE, math.sqrt),
    "square": (_ONE, lambda a: a * a),
    "tan": (_ONE, tan),
    "vector": (_TWO, _vector),
}
_OF_NUMBERS: Final = frozenset(_FUNCTIONS) - {"max", "min", "vector"}
_OF_PRINTER: Final = frozenset(("random", "datetime", "fileexists", "fileread"))
_WRITE: Final = "write a value in its place"

_KINDS: Final[dict[type, Callable[..., Value]]] = {
    Constant: lambda node, names: node.value,
    Path: lambda node, names: names.value(path_of(node, names)),
    Call: _call,
    Unary: _unary,
    Operation: _operation,
    Ternary: lambda node, names: evaluate(node.chosen if truth(node.condition, names) else node.other, names),
    Items: lambda node, names: tuple(evaluate(item, names) for item in node.items),
}

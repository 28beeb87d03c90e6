"""The text of an expression as a tree."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final, NamedTuple

from gcodesim.rs274.fault import Fault

Value = bool | int | float | str | tuple["Value", ...] | None
"""What an expression may be; a tuple is an array."""


class Constant(NamedTuple):
    value: Value


class Path(NamedTuple):
    """`move.axes[0].max`: names, and expressions for indices."""

    parts: tuple[str | Node, ...]


class Call(NamedTuple):
    name: str
    operands: tuple[Node, ...]


class Unary(NamedTuple):
    operator: str
    operand: Node


class Operation(NamedTuple):
    operator: str
    left: Node
    right: Node


class Ternary(NamedTuple):
    condition: Node
    chosen: Node
    other: Node


class Items(NamedTuple):
    """`{1, 2, 3}`."""

    items: tuple[Node, ...]


Node = Constant | Path | Call | Unary | Operation | Ternary | Items

_PRIORITIES: Final = {
    "?": 1, "^": 2, "&": 3, "|": 3, "=": 4, "!=": 4, "<": 4, ">": 4, "<=": 4, ">=": 4, "+": 5, "-": 5, "*": 6, "/": 6
}  # fmt: skip
_UNARY: Final = 10
_SAME: Final = {"==": "=", "&&": "&", "||": "|"}
_TOKEN = re.compile(
    r"[ \t]*(?:(?P<number>0[xX][0-9A-Fa-f]+|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]*)"
    r"|(?P<text>\"(?:[^\"]|\"\")*\")"
    r"|(?P<sign>==|!=|<=|>=|&&|\|\||[-+*/^&|=<>?:!#(){}\[\],.]))"
)
_CONSTANTS: Final[dict[str, Value]] = {"true": True, "false": False, "null": None}


class _Token(NamedTuple):
    kind: str
    text: str
    end: int


@lru_cache(10_000)
def parsed(text: str, begin: int = 0) -> tuple[Node, int]:
    """The expression at offset `begin` of `text`, and the offset behind it; raises `Fault`."""
    reader = _Reader(text, begin)
    node = reader.expression(0)
    return node, reader.at


class _Reader:
    def __init__(self, text: str, at: int) -> None:
        self.text = text
        self.at = at

    def expression(self, priority: int) -> Node:
        """The expression up to an operator of `priority` or less."""
        left = self._operand()
        while True:
            token = self._peek()
            sign = "" if token is None or token.kind != "sign" else _SAME.get(token.text, token.text)
            own = _PRIORITIES.get(sign, 0)
            if token is None or own <= priority:
                return left
            self.at = token.end
            if sign != "?":
                left = Operation(sign, left, self.expression(own))
                continue
            chosen = self.expression(own)
            self._expect(":")
            return Ternary(left, chosen, self.expression(own - 1))

    def _operand(self) -> Node:
        token = self._peek()
        if token is None:
            raise Fault("GS006", f"an expression is expected, not `{self.text[self.at :].strip()[:20]}`")
        self.at = token.end
        if token.kind == "number":
            return Constant(_number(token.text))
        if token.kind == "text":
            return Constant(token.text[1:-1].replace('""', '"'))
        if token.kind == "name":
            return self._named(token.text)
        if token.text in "-+!#":
            return Unary(token.text, self.expression(_UNARY))
        if token.text == "(":
            inside = self.expression(0)
            self._expect(")")
            return inside
        if token.text == "{":
            items = self._list("}")
            return items[0] if len(items) == 1 else Items(items)
        raise Fault("GS006", f"an expression is expected, not `{token.text}`")

    def _named(self, name: str) -> Node:
        if name in _CONSTANTS:
            return Constant(_CONSTANTS[name])
        if self._takes("("):
            return Call(name, self._list(")"))
        parts: list[str | Node] = [name]
        while True:
            if self._takes("["):
                parts.append(self.expression(0))
                self._expect("]")
            elif self._takes("."):
                token = self._peek()
                if token is None or token.kind != "name":
                    raise Fault("GS006", "a name is expected behind the point")
                self.at = token.end
                parts.append(token.text)
            else:
                return Path(tuple(parts))

    def _list(self, closing: str) -> tuple[Node, ...]:
        items = [self.expression(0)]
        while self._takes(","):
            items.append(self.expression(0))
        self._expect(closing)
        return tuple(items)

    def _peek(self) -> _Token | None:
        found = _TOKEN.match(self.text, self.at)
        return None if found is None else _Token(found.lastgroup or "", found[found.lastgroup or 0], found.end())

    def _takes(self, sign: str) -> bool:
        token = self._peek()
        if token is None or token.kind != "sign" or token.text != sign:
            return False
        self.at = token.end
        return True

    def _expect(self, sign: str) -> None:
        if not self._takes(sign):
            found = self.text[self.at :].strip()[:20]
            raise Fault("GS006", f"`{sign}` is expected" + (f", not `{found}`" if found else ""))


def _number(text: str) -> int | float:
    if text[:2] in ("0x", "0X"):
        return int(text, 16)
    return float(text) if any(sign in text for sign in ".eE") else int(text)

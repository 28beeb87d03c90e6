"""The one place that knows Lark: a prepared line in, its parts out, by `grammars/*.lark`."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import Any, Final, NamedTuple

import lark
from lark import Lark, Token, Transformer, UnexpectedCharacters, UnexpectedInput, UnexpectedToken, v_args
from lark.grammar import Rule
from lark.lexer import TerminalDef

from gcodesim.files.user_cache import user_cache
from gcodesim.rs274.block import Binary, Exists, Function, Name, Node, Parameter, Signed, Word


class Parsed(NamedTuple):
    """The parts of a prepared line; `start` are the columns at which words, settings and notes begin."""

    words: list[tuple[int, Word]]
    settings: list[tuple[int, Node, Node]]
    notes: list[tuple[int, str]]
    flow: tuple[int, Node, str, tuple[Node, ...]] | None
    deleted: bool


class Unreadable(Exception):  # noqa: N818
    """The line breaks the grammar at `column` (from 0) where one of the terminals `expected` could stand."""

    def __init__(self, column: int, found: str, expected: frozenset[str]) -> None:
        super().__init__(found)
        self.column = column
        self.found = found
        self.expected = expected


@v_args(inline=True)
class _Build(Transformer[Token, Any]):
    """Turns rules into the values of `block.py` while the parser runs, without ever building a tree."""

    def start(self, *parts: Any) -> Parsed:
        words: list[tuple[int, Word]] = []
        settings: list[tuple[int, Node, Node]] = []
        notes: list[tuple[int, str]] = []
        flow = None
        deleted = False
        for part in parts:
            if isinstance(part, Token):
                deleted = deleted or part.type in ("SLASH", "SKIP")
                continue
            kind, value = part
            if kind == "word":
                words.append(value)
            elif kind == "setting":
                settings.append(value)
            elif kind == "note":
                notes.append(value)
            elif kind == "then":
                flow, then = value
                settings.append(then)
            else:
                flow, tail = value
                notes += tail
        return Parsed(words, settings, notes, flow, deleted)

    def word(self, letter: Token, value: Node) -> tuple[str, Any]:
        return "word", (letter.start_pos, Word(letter.value, value))

    def corner_word(self, comma: Token, letter: Token, value: Node) -> tuple[str, Any]:
        return "word", (comma.start_pos, Word(f",{letter.value}", value))

    def setting(self, hash_sign: Token, index: Node, value: Node) -> tuple[str, Any]:
        return "setting", (hash_sign.start_pos, index, value)

    def note(self, text: Token) -> tuple[str, Any]:
        body = text.value[1:-1] if text.value.startswith("(") else ""  # after a semicolon nothing is active
        return "note", (text.start_pos, body)

    def flow(self, letter: Token, label: Node, *rest: Any) -> tuple[str, Any]:
        keyword = rest[0].value if rest and isinstance(rest[0], Token) else ""
        notes = [part[1] for part in rest if isinstance(part, tuple) and part[0] == "note"]
        operands = tuple(
            part for part in rest if not isinstance(part, Token) and not (isinstance(part, tuple) and part[0] == "note")
        )
        return "flow", ((letter.start_pos, label, keyword, operands), notes)

    def label_number(self, number: Token) -> Node:
        return float(number)

    def label_name(self, name: Token) -> Node:
        return Name(name.value[1:-1])

    def label_computed(self, value: Node) -> Node:
        return value

    # statements of custom macros (fanuc.lark)

    def program(self, letter: Token, number: Token) -> tuple[str, Any]:
        return "flow", ((letter.start_pos, float(number), "program", ()), [])

    def goto(self, word: Token, target: Node) -> tuple[str, Any]:
        return "flow", ((word.start_pos, target, "goto", ()), [])

    def if_goto(self, word: Token, condition: Node, _: Token, target: Node) -> tuple[str, Any]:
        return "flow", ((word.start_pos, target, "goto", (condition,)), [])

    def if_then(self, word: Token, condition: Node, _: Token, then: tuple[str, Any]) -> tuple[str, Any]:
        return "then", ((word.start_pos, 0.0, "then", (condition,)), then[1])

    def while_loop(self, word: Token, condition: Node, _: Token, number: Token) -> tuple[str, Any]:
        return "flow", ((word.start_pos, float(number), "do", (condition,)), [])

    def loop(self, word: Token, number: Token) -> tuple[str, Any]:
        return "flow", ((word.start_pos, float(number), "do", ()), [])

    def loop_end(self, word: Token, number: Token) -> tuple[str, Any]:
        return "flow", ((word.start_pos, float(number), "end", ()), [])

    def bracket(self, value: Node) -> Node:
        if not isinstance(value, Binary):
            return value
        return Signed(1.0, value) if value.closed else replace(value, closed=True)  # brackets in brackets are a value

    def binary(self, left: Node, operator: Token, right: Node) -> Node:
        return Binary(operator.value, left, right)

    def number(self, text: Token) -> Node:
        return float(text)

    def signed(self, sign: Token, value: Node) -> Node:
        factor = -1.0 if sign.value == "-" else 1.0
        return factor * value if isinstance(value, float) else Signed(factor, value)

    def parameter(self, _: Token, index: Node) -> Node:
        return Parameter(index)

    def function(self, name: Token, argument: Node) -> Node:
        return Function(name.value, argument)

    def arctangent(self, *parts: Any) -> Node:
        first, second = (part for part in parts if not isinstance(part, Token))
        return Function("atan", first, second)

    def function_of_two(self, name: Token, *parts: Any) -> Node:
        first, second = (part for part in parts if not isinstance(part, Token))
        return Function(name.value, first, second)

    def exists(self, _: Token, index: Node) -> Node:
        return Exists(index)

    def name(self, text: Token) -> Node:
        return Name(text.value[1:-1])


_OPTIONS: Final = {"parser": "lalr", "lexer": "contextual", "maybe_placeholders": False}


def _lark_of(name: str) -> Lark:
    """Lark's parser; its tables take 40 ms to make and 4 ms to read, so they are kept, as text that can do nothing."""
    text = files("gcodesim.rs274").joinpath("grammars", f"{name}.lark").read_text(encoding="utf-8")
    made_of = json.dumps([text, _OPTIONS, lark.__version__, sys.version, _TABLES_FORM])
    file = f"{name}-{hashlib.sha256(made_of.encode()).hexdigest()[:16]}.json"
    folder = user_cache("grammars")
    known = None if folder is None else folder.read(file)
    if known is not None:
        with suppress(Exception):  # of any kind: the contents of a damaged file are unknown
            return _from_tables(known)
    parser = Lark(text, transformer=_Build(), **_OPTIONS)
    if folder is not None:
        tables = _tables(parser)
        if tables is not None:
            folder.write(file, tables)
    return parser


_TABLES_FORM: Final = 1


def _tables(parser: Lark) -> bytes | None:
    """The tables as JSON; None when this Lark's cannot be written so."""
    data, memo = parser.memo_serialize([TerminalDef, Rule])
    del data["options"]["transformer"]
    try:
        return json.dumps([data, memo]).encode()
    except (TypeError, ValueError):
        return None


def _from_tables(known: bytes) -> Lark:
    """The parser of kept tables; JSON knows no numbers as keys and no tuples."""
    data, memo = json.loads(known)
    table = data["parser"]["parser"]
    table["tokens"] = _numbered(table["tokens"])
    table["states"] = {state: _numbered(row) for state, row in _numbered(table["states"]).items()}
    parser: Lark = Lark._load_from_dict(data, _numbered(memo), transformer=_Build())  # type: ignore[no-untyped-call]
    return parser


def _numbered(table: dict[str, Any]) -> dict[int, Any]:
    return {int(key): value for key, value in table.items()}


@cache
def parser_of(name: str) -> Callable[[str], Parsed]:
    """The parser of `grammars/<name>.lark`; its call raises `Unreadable`."""
    known = _lark_of(name)

    def expected(before: str) -> frozenset[str]:
        """The terminals that may follow `before`; the parser's table alone names some that may not."""
        try:
            parser = known.parse_interactive(before)
            parser.exhaust_lexer()
            return frozenset(parser.accepts())  # type: ignore[no-untyped-call]
        except UnexpectedInput:  # a token that ends differently before what follows
            return frozenset()

    def parse(line: str) -> Parsed:
        try:
            return known.parse(line)  # type: ignore[return-value]
        except UnexpectedCharacters as problem:
            column = problem.pos_in_stream or 0
            raise Unreadable(column, line[column : column + 1], expected(line[:column])) from None
        except UnexpectedToken as problem:
            token = problem.token
            column = len(line) if token.type == "$END" else (token.start_pos or 0)
            raise Unreadable(column, str(token), expected(line[:column])) from None
        except UnexpectedInput as problem:  # pragma: no cover  (no third kind is known)
            raise Unreadable(problem.pos_in_stream or 0, "", frozenset()) from None

    return parse

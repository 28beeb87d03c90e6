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

from gcodesim.family import object_at
from gcodesim.files.user_cache import user_cache
from gcodesim.rs274.block import Binary, Exists, Expression, Function, Name, Parameter, Signed, Word


class Parsed(NamedTuple):
    """The parts of a prepared line; `start` are the columns at which words, settings and notes begin."""

    words: list[tuple[int, Word]]
    settings: list[tuple[int, Expression, Expression]]
    notes: list[tuple[int, str]]
    flow: tuple[int, Expression, str, tuple[Expression, ...]] | None
    deleted: bool


class Unreadable(Exception):  # noqa: N818
    """The line breaks the grammar at `column` (from 0) where one of the terminals `expected` could stand."""

    def __init__(self, column: int, found: str, expected: frozenset[str]) -> None:
        super().__init__(found)
        self.column = column
        self.found = found
        self.expected = expected


@v_args(inline=True)
class LineParts(Transformer[Token, Any]):
    """Turns rules into the values of `block.py` while the parser runs, without ever building a tree."""

    def start(self, *parts: Any) -> Parsed:
        words: list[tuple[int, Word]] = []
        settings: list[tuple[int, Expression, Expression]] = []
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
            else:
                flow, its_notes, its_settings = value
                notes += its_notes
                settings += its_settings
        return Parsed(words, settings, notes, flow, deleted)

    def word(self, letter: Token, value: Expression) -> tuple[str, Any]:
        return "word", (letter.start_pos, Word(letter.value, value))

    def corner_word(self, comma: Token, letter: Token, value: Expression) -> tuple[str, Any]:
        return "word", (comma.start_pos, Word(f",{letter.value}", value))

    def setting(self, hash_sign: Token, index: Expression, value: Expression) -> tuple[str, Any]:
        return "setting", (hash_sign.start_pos, index, value)

    def note(self, text: Token) -> tuple[str, Any]:
        body = text.value[1:-1] if text.value.startswith("(") else ""  # after a semicolon nothing is active
        return "note", (text.start_pos, body)

    def flow(self, letter: Token, label: Expression, *rest: Any) -> tuple[str, Any]:
        keyword = rest[0].value if rest and isinstance(rest[0], Token) else ""
        notes = [part[1] for part in rest if isinstance(part, tuple) and part[0] == "note"]
        operands = tuple(
            part for part in rest if not isinstance(part, Token) and not (isinstance(part, tuple) and part[0] == "note")
        )
        return "flow", ((letter.start_pos, label, keyword, operands), notes, [])

    def label_number(self, number: Token) -> Expression:
        return float(number)

    def label_name(self, name: Token) -> Expression:
        return Name(name.value[1:-1])

    def label_computed(self, value: Expression) -> Expression:
        return value

    def bracket(self, value: Expression) -> Expression:
        if not isinstance(value, Binary):
            return value
        return Signed(1.0, value) if value.closed else replace(value, closed=True)  # brackets in brackets are a value

    def binary(self, left: Expression, operator: Token, right: Expression) -> Expression:
        return Binary(operator.value, left, right)

    def number(self, text: Token) -> Expression:
        return float(text)

    def signed(self, sign: Token, value: Expression) -> Expression:
        factor = -1.0 if sign.value == "-" else 1.0
        return factor * value if isinstance(value, float) else Signed(factor, value)

    def parameter(self, _: Token, index: Expression) -> Expression:
        return Parameter(index)

    def function(self, name: Token, argument: Expression) -> Expression:
        return Function(name.value, argument)

    def arctangent(self, *parts: Any) -> Expression:
        first, second = (part for part in parts if not isinstance(part, Token))
        return Function("atan", first, second)

    def function_of_two(self, name: Token, *parts: Any) -> Expression:
        first, second = (part for part in parts if not isinstance(part, Token))
        return Function(name.value, first, second)

    def exists(self, _: Token, index: Expression) -> Expression:
        return Exists(index)

    def name(self, text: Token) -> Expression:
        return Name(text.value[1:-1])


_OPTIONS: Final = {"parser": "lalr", "lexer": "contextual", "maybe_placeholders": False}


def _lark_of(name: str, parts: str) -> Lark:
    """Lark's parser; its tables take 40 ms to make and 4 ms to read, so they are kept, as text that can do nothing."""
    text = files("gcodesim.rs274").joinpath("grammars", f"{name}.lark").read_text(encoding="utf-8")
    made_of = json.dumps([text, _OPTIONS, lark.__version__, sys.version, _TABLES_FORM])
    file = f"{name}-{hashlib.sha256(made_of.encode()).hexdigest()[:16]}.json"
    folder = user_cache("grammars")
    known = None if folder is None else folder.read(file)
    if known is not None:
        with suppress(Exception):  # of any kind: the contents of a damaged file are unknown
            return _from_tables(known, _maker_of(parts))
    parser = Lark(text, transformer=_maker_of(parts), **_OPTIONS)
    if folder is not None:
        tables = _tables(parser)
        if tables is not None:
            folder.write(file, tables)
    return parser


def _maker_of(parts: str) -> LineParts:
    made: type[LineParts] = object_at(parts) if parts else LineParts
    return made()


_TABLES_FORM: Final = 1


def _tables(parser: Lark) -> bytes | None:
    """The tables as JSON; None when this Lark's cannot be written so."""
    data, memo = parser.memo_serialize([TerminalDef, Rule])
    del data["options"]["transformer"]
    try:
        return json.dumps([data, memo]).encode()
    except (TypeError, ValueError):
        return None


def _from_tables(known: bytes, maker: LineParts) -> Lark:
    """The parser of kept tables; JSON knows no numbers as keys and no tuples."""
    data, memo = json.loads(known)
    table = data["parser"]["parser"]
    table["tokens"] = _numbered(table["tokens"])
    table["states"] = {state: _numbered(row) for state, row in _numbered(table["states"]).items()}
    parser: Lark = Lark._load_from_dict(data, _numbered(memo), transformer=maker)  # type: ignore[no-untyped-call]
    return parser


def _numbered(table: dict[str, Any]) -> dict[int, Any]:
    return {int(key): value for key, value in table.items()}


_known_grammar = cache(_lark_of)


@cache
def lexer_of(name: str, parts: str = "") -> Callable[[str], list[tuple[str, str, int]]]:
    """What cuts a prepared line into the terminals of `grammars/<name>.lark`: kind, text and column of each.

    Its call raises `Unreadable`.
    """
    known = _known_grammar(name, parts)

    def cut(line: str) -> list[tuple[str, str, int]]:
        try:
            parser = known.parse_interactive(line)
            return [(token.type, str(token), token.start_pos or 0) for token in parser.iter_parse()]
        except UnexpectedInput as problem:
            raise Unreadable(problem.pos_in_stream or 0, "", frozenset()) from None

    return cut


@cache
def parser_of(name: str, parts: str = "") -> Callable[[str], Parsed]:
    """The parser of `grammars/<name>.lark`; its call raises `Unreadable`.

    `parts` names the class (`module:Class`) that makes the parts of a line, where the grammar has rules of its own.
    """
    known = _known_grammar(name, parts)

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

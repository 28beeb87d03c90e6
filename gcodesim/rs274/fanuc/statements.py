"""Macro statements of `grammars/fanuc.lark`: program heads, GOTO, IF, WHILE, DO and END, each one part of its line."""

from __future__ import annotations

from typing import Any

from lark import Token, v_args

from gcodesim.rs274.block import Expression
from gcodesim.rs274.grammar import LineParts


@v_args(inline=True)
class MacroParts(LineParts):
    """The parts of every grammar, and those statements. The label of a statement is its target or its number."""

    def program(self, letter: Token, number: Token) -> tuple[str, Any]:
        return _statement(letter, float(number), "program")

    def goto(self, word: Token, target: Expression) -> tuple[str, Any]:
        return _statement(word, target, "goto")

    def if_goto(self, word: Token, condition: Expression, _: Token, target: Expression) -> tuple[str, Any]:
        return _statement(word, target, "goto", condition)

    def if_then(self, word: Token, condition: Expression, _: Token, then: tuple[str, Any]) -> tuple[str, Any]:
        return "flow", ((word.start_pos, 0.0, "then", (condition,)), [], [then[1]])

    def while_loop(self, word: Token, condition: Expression, _: Token, number: Token) -> tuple[str, Any]:
        return _statement(word, float(number), "do", condition)

    def loop(self, word: Token, number: Token) -> tuple[str, Any]:
        return _statement(word, float(number), "do")

    def loop_end(self, word: Token, number: Token) -> tuple[str, Any]:
        return _statement(word, float(number), "end")


def _statement(word: Token, label: Expression, keyword: str, *operands: Expression) -> tuple[str, Any]:
    return "flow", ((word.start_pos, label, keyword, operands), [], [])

"""Reading a program: whole interpreter against a bare LALR parser on the same lines.

    python -m benchmarks.reading [BLOCKS]

The yardstick is Lark's LALR parser with a transformer inside that makes (letter, number) pairs and nothing else; it
has no modal groups, no checks, no events.
"""

from __future__ import annotations

import sys
from typing import Any

from lark import Lark, Transformer, v_args

from benchmarks import job
from benchmarks.compare import seconds, show
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import interpret

GRAMMAR = r"""
start: line*
line: word* comment? NEWLINE
word: LETTER NUMBER
comment: COMMENT
LETTER: /[A-Z]/
NUMBER: /[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)/
COMMENT: /\([^)]*\)/
NEWLINE: /\r?\n/
%ignore " "
%ignore "%"
"""


@v_args(inline=True)
class Words(Transformer[Any, Any]):
    """Words as pairs, lines as lists of them."""

    def word(self, letter: str, number: str) -> tuple[str, float]:
        return str(letter), float(number)

    def line(self, *parts: Any) -> list[Any]:
        return list(parts)


def main(blocks: int = 20_000) -> None:
    text = "\n".join(job.moves(blocks)) + "\n"
    count = text.count("\n")
    source = SourceText("reference.nc", text.encode())
    parser = Lark(GRAMMAR, parser="lalr", transformer=Words())

    def ours() -> None:
        run = interpret(source)
        for _ in run:
            pass
        if run.failed is not None:
            raise AssertionError(run.failed.message)

    show("read and interpret", count / seconds(ours, 3), "Lark LALR, words only", count / seconds(
        lambda: parser.parse(text), 3), "lines/s", 40)  # fmt: skip


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))

"""Reading a program to a `ToolPath`, against a bare LALR parser on the same text.

    python -m benchmarks.reading [LINES]

The yardstick is Lark's LALR parser with a transformer inside that makes (letter, number) pairs, computes expressions,
and nothing else; it has no modal groups, no checks, no events, no path. It reads a tenth of the program.
"""

from __future__ import annotations

import sys
from typing import Any

from lark import Lark, Transformer, v_args

from benchmarks import cam
from benchmarks.compare import seconds, show
from gcodesim.diagnostics import SourceText
from gcodesim.motion import ToolPath, build_tool_path
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.assumed import assumed_tools

GRAMMAR = r"""
start: line*
line: (word | setting | COMMENT)* NEWLINE
word: LETTER value
setting: "#" value "=" value
?value: NUMBER -> number
      | "#" NUMBER -> parameter
      | "[" sum "]"
?sum: product
    | sum "+" product -> add
?product: value
        | product "*" value -> multiply
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

    def __init__(self) -> None:
        super().__init__()
        self.numbers: dict[float, float] = {}

    def number(self, text: str) -> float:
        return float(text)

    def parameter(self, index: str) -> float:
        return self.numbers.get(float(index), 0.0)

    def add(self, a: float, b: float) -> float:
        return a + b

    def multiply(self, a: float, b: float) -> float:
        return a * b

    def setting(self, index: float, value: float) -> None:
        self.numbers[index] = value

    def word(self, letter: str, value: float) -> tuple[str, float]:
        return str(letter), value

    def line(self, *parts: Any) -> list[Any]:
        return list(parts)


def path_of(source: SourceText) -> ToolPath:
    """What `gcodesim.read` does with the text of a file."""
    run = interpret(source, Settings(tool_table=assumed_tools(source)))
    path = build_tool_path(run.stream())
    if run.failed is not None:
        raise AssertionError(run.failed.message)
    return path


def main(lines: int = 200_000) -> None:
    parser = Lark(GRAMMAR, parser="lalr", transformer=Words())
    for what, program in (("an expression in 500 lines", cam.raster_with_expressions), ("plain", cam.raster)):
        text = cam.text(program(lines))
        some = cam.text(program(lines // 10))
        theirs = some.count(b"\n") / seconds(lambda some=some: parser.parse(some.decode()), 3)  # type: ignore[misc]
        # a new text each time, so that nothing is known of it
        ours = text.count(b"\n") / seconds(lambda text=text: path_of(SourceText("p.nc", bytes(text))), 5)  # type: ignore[misc]
        show(f"tool path, {what}", ours, "Lark LALR, words only", theirs, "lines/s", 40)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))

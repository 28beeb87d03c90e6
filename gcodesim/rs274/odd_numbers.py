"""Numbers that controls read, but probably not as they were meant: with a blank inside, or with two signs."""

from __future__ import annotations

import re
from collections.abc import Iterator

from gcodesim.rs274.block import Block, ColumnRange

_TWO_SIGNS = re.compile(r"[+-][ \t]*[+-]")
_DIVIDED = re.compile(r"[0-9.][ \t]+[0-9.]")


def odd_numbers(block: Block) -> Iterator[tuple[str, str, ColumnRange]]:
    """Message, hint and place for each odd number of a block that is more than plain words."""
    for (letter, value), (first, last) in zip(block.words, block.places, strict=True):
        text = block.text[first:last].rstrip()
        if not isinstance(value, float) or text[1:].strip("+-. \t0123456789"):
            continue
        read = f"{letter.upper()}{value:.12g}"
        if _DIVIDED.search(text) is not None:
            hint = "blanks mean nothing to a control: write the letter that is missing, or close the gap"
            yield f"`{text}` is read as {read}", hint, (first, first + len(text))
        elif _TWO_SIGNS.search(text) is not None:
            yield f"`{text}` has two signs and is read as {read}", "write one sign", (first, first + len(text))

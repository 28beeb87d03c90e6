"""What each code means: one table a hundred, in the file named after it; other packages add tables of their own."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib import import_module
from typing import Final

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.catalogue.others import OTHERS, code_of_others, codes_of_others, is_of_others

PATTERN: Final = f"GS[0-9]{{3}}|{OTHERS}"
"""The pattern of all codes."""

_SHAPE: Final = re.compile(PATTERN)

# first digit after GS -> module of the table; a module is imported when one of its codes is asked for
_TABLES = {
    "0": "reading",
    "1": "meaning",
    "2": "limits",
    "3": "collision",
    "4": "material",
    "5": "process",
    "6": "regression",
    "7": "cell",
    "8": "posting",
    "9": "not_simulated",
}


def _table(digit: str) -> dict[str, Code]:
    module = import_module(f"gcodesim.diagnostics.catalogue.{_TABLES[digit]}")
    return {code.code: code for code in module.CODES}


def subject_of(code: str) -> str:
    """What the hundred of `code` is about, in words: the table that it stands in; of other packages their name."""
    return code.partition("-")[0].lower() if is_of_others(code) else _TABLES[code[2]].replace("_", " ")


def code_of(code: str) -> Code:
    """The entry of `code` (GSnnn, or NAME-nnn of another package); KeyError when there is none."""
    if is_of_others(code):
        return code_of_others(code)
    if len(code) != 5 or not code.startswith("GS") or code[2] not in _TABLES:
        raise KeyError(code)
    return _table(code[2])[code]


def own_codes() -> Iterator[Code]:
    """The codes of gcodesim in order."""
    for digit in sorted(_TABLES):
        yield from sorted(_table(digit).values(), key=lambda c: c.code)


def codes() -> Iterator[Code]:
    """All codes: ours in order, then those that other packages add."""
    yield from own_codes()
    yield from codes_of_others()


def is_code(text: str) -> bool:
    """Whether a text has the shape of a code, ours or that of another package."""
    return _SHAPE.fullmatch(text) is not None


__all__ = ["PATTERN", "Code", "code_of", "codes", "is_code", "own_codes", "subject_of"]

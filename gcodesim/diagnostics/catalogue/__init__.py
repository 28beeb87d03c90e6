"""What each code means: one table a hundred, in the file named after it."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module

from gcodesim.diagnostics.catalogue.code import Code

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
    "9": "not_simulated",
}


def _table(digit: str) -> dict[str, Code]:
    module = import_module(f"gcodesim.diagnostics.catalogue.{_TABLES[digit]}")
    return {code.code: code for code in module.CODES}


def subject_of(code: str) -> str:
    """What the hundred of `code` is about, in words: the table that it stands in."""
    return _TABLES[code[2]].replace("_", " ")


def code_of(code: str) -> Code:
    """The entry of `code` (GSnnn); KeyError when there is none."""
    if len(code) != 5 or not code.startswith("GS") or code[2] not in _TABLES:
        raise KeyError(code)
    return _table(code[2])[code]


def codes() -> Iterator[Code]:
    """All codes in order."""
    for digit in sorted(_TABLES):
        yield from sorted(_table(digit).values(), key=lambda c: c.code)


__all__ = ["Code", "code_of", "codes"]

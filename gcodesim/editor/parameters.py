"""Where a program uses a parameter, and another name for it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from gcodesim.editor.place import TextRange

if TYPE_CHECKING:
    from gcodesim.editor.program_document import ProgramDocument
    from gcodesim.rs274.tokens import Token

_NAME = re.compile(r"<[^<>#]+>|[1-9][0-9]*")


class Use(NamedTuple):
    """A place where a parameter stands, without its `#`; `sets` where it gets a value."""

    range: TextRange
    sets: bool


class CannotRenameError(Exception):
    """A parameter cannot have this name; the text says why."""


def parameter_at(tokens: list[Token], column: int) -> str | None:
    """The parameter at a place: `<depth>` or `100`."""
    for sign, name in pairwise(tokens):
        if sign.kind == "HASH" and name.kind in ("NAME", "NUMBER") and sign.place[0] <= column <= name.place[1]:
            return _canonical(name.text)
    return None


def uses_of(document: ProgramDocument, name: str, line: int) -> list[Use]:
    """All places of a parameter; of one of a subroutine, those in the same subroutine."""
    file = document.file
    if file is None:
        return []
    found = []
    for index in _scope(document, name, line):
        if "#" in file.lines[index]:
            tokens = document.tokens(index)
            for at, (sign, token) in enumerate(pairwise(tokens)):
                if sign.kind == "HASH" and _canonical(token.text) == name and token.kind in ("NAME", "NUMBER"):
                    sets = at + 2 < len(tokens) and tokens[at + 2].kind == "EQUAL"
                    found.append(Use(TextRange(index, token.place[0], index, token.place[1]), sets))
    return found


def renamed(document: ProgramDocument, line: int, column: int, new: str) -> list[tuple[TextRange, str]]:
    """What to write where, so that the parameter at a place is called `new`; CannotRenameError if it cannot be."""
    old = parameter_at(document.tokens(line), column)
    if old is None:
        raise CannotRenameError("there is no parameter here")
    name = new.strip().removeprefix("#")
    if old.startswith("<") and not name.startswith("<"):
        name = f"<{name}>"
    if _NAME.fullmatch(name) is None or name.startswith("<") != old.startswith("<"):
        raise CannotRenameError(f"`{new}` is no name of such a parameter")
    if old.startswith("<_") != name.startswith("<_"):
        raise CannotRenameError("a name that begins with _ is that of a parameter for all subroutines, others are not")
    if _canonical(name) != old and uses_of(document, _canonical(name), line):
        raise CannotRenameError(f"#{name} is another parameter of this program")
    return [(use.range, name) for use in uses_of(document, old, line)]


def names_in(document: ProgramDocument) -> list[str]:
    """All parameters of the program as they are first written, named ones without regard to case."""
    file = document.file
    found: dict[str, str] = {}
    for index, text in enumerate(() if file is None else file.lines):
        if "#" not in text:
            continue
        tokens = document.tokens(index)
        for sign, token in pairwise(tokens):
            if sign.kind == "HASH" and token.kind in ("NAME", "NUMBER"):
                found.setdefault(_canonical(token.text), token.text)
    return list(found.values())


def _canonical(text: str) -> str:
    squeezed = "".join(text.split()).lower()
    return squeezed if squeezed.startswith("<") else squeezed.lstrip("0").rstrip(".") or "0"


def _scope(document: ProgramDocument, name: str, line: int) -> Iterable[int]:
    """The lines in which a name means the same parameter: those of a subroutine, or those outside of all."""
    file = document.file
    assert file is not None
    if not name.startswith("<") or name.startswith("<_"):
        return range(len(file.lines))
    inside: list[range] = []
    begin = None
    for flow in file.flows:
        if flow.keyword == "sub":
            begin = flow.at
        elif flow.keyword == "endsub" and begin is not None:
            inside.append(range(begin, flow.at + 1))
            begin = None
    own = next((part for part in inside if line in part), None)
    return own or [index for index in range(len(file.lines)) if not any(index in part for part in inside)]

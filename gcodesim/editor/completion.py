"""What may be written at a place of a program."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

from gcodesim.diagnostics.plain import one_line
from gcodesim.editor.parameters import names_in
from gcodesim.rs274.block import KEYWORDS
from gcodesim.rs274.dialects.meanings import LETTERS, meanings_of
from gcodesim.rs274.predefined import PREDEFINED

if TYPE_CHECKING:
    from gcodesim.editor.program_document import ProgramDocument

Sort = Literal["code", "letter", "parameter", "keyword", "subroutine", "tool", "key", "value", "unit"]

_PARAMETER: Final = re.compile(r"#(<?[A-Za-z0-9_]*)\Z")
_O_WORD: Final = re.compile(r"\A\s*[oO](<[^<>]*>?|[0-9]*)\Z")
_KEYWORD: Final = re.compile(r"\A\s*[oO](?:<[^<>]*>|[0-9]+)\s+([A-Za-z]*)\Z")
_CODE: Final = re.compile(r"(?:\A|[^A-Za-z#<])([GgMmTtHh][0-9.]*)\Z")
_COMMENT: Final = re.compile(r"\([^)]*\Z|;")


class Offer(NamedTuple):
    """Text that may replace what stands from `begin` to the place, with what it means."""

    text: str
    begin: int
    sort: Sort
    about: str = ""


def offers(document: ProgramDocument, line: int, column: int) -> list[Offer]:
    """What fits at a place of a program, in an order that does not depend on anything else."""
    file = document.file
    if file is None or not 0 <= line < max(len(file.lines), 1):
        return []
    before = document.source.line(line + 1)[:column]
    if _COMMENT.search(re.sub(r"\([^)]*\)", "", before)):
        return []
    if (found := _PARAMETER.search(before)) is not None:
        return list(_parameters(document, found.start(1)))
    if (found := _KEYWORD.search(before)) is not None and document.dialect.flow_words:
        return [Offer(word, found.start(1), "keyword") for word in KEYWORDS]
    if (found := _O_WORD.search(before)) is not None and not document.dialect.prints:
        return list(_labels(document, found.start(1)))
    if (found := _CODE.search(before)) is not None:
        return list(_codes(document, found[1][0].upper(), found.start(1)))
    begin = column - (len(before) - len(before.rstrip("".join(LETTERS))) > 0)
    return [Offer(letter, begin, "letter", about) for letter, about in LETTERS.items()]


def _codes(document: ProgramDocument, letter: str, begin: int) -> Iterator[Offer]:
    if letter in "TH":
        for number, about in document.tool_names.items():
            yield Offer(f"{letter}{number}", begin, "tool", about)
        return
    codes = {code: text for code, text in meanings_of(document.dialect).items() if code[0] == letter}
    for code in sorted(codes, key=lambda one: float(one[1:])):
        yield Offer(code, begin, "code", codes[code])


def _parameters(document: ProgramDocument, begin: int) -> Iterator[Offer]:
    names = dict.fromkeys(names_in(document), "in this program")
    if document.dialect.named_parameters:
        names = {f"<{name}>": "predefined" for name in PREDEFINED} | names
    for name in sorted(names, key=lambda one: (one.startswith("<"), not one.isdigit() or int(one), one)):
        yield Offer(name, begin, "parameter", names[name])


def _labels(document: ProgramDocument, begin: int) -> Iterator[Offer]:
    seen: dict[str, str] = {}
    for file in document.files:
        for label, at, _ in file.outline.subroutines():
            name = label if label.isdigit() else f"<{label}>"
            seen.setdefault(name, f"line {at + 1} of {one_line(file.name)}")
    for name, about in seen.items():
        yield Offer(name, begin, "subroutine", about)

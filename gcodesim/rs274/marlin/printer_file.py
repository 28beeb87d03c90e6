"""The lines of a printer's program and their pieces."""

from __future__ import annotations

from collections.abc import Iterator

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.block import ColumnRange
from gcodesim.rs274.marlin.duet.commands import has_commands
from gcodesim.rs274.marlin.line import MarlinLine, line_of
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.reader import Reader
from gcodesim.rs274.tokens import VERBATIM, Token


class PrinterFile(ProgramFile):
    """Each line stands for itself, unless the program `decides`.

    `counts_rounds`: it asks how often a loop was gone through.
    """

    def __init__(self, source: SourceText, reader: Reader) -> None:
        super().__init__(source, reader)
        self.has_expressions = reader.dialect.name == "reprapfirmware"
        self.decides = self.has_expressions and has_commands(source.raw)
        self.counts_rounds = b"iterations" in source.raw

    def heads_before(self, end: int) -> set[int]:
        """Comments of slicers, too: they count layers and have settings of the printer."""
        notes = {index for index in range(end) if self.lines[index].lstrip().startswith(";")}
        return super().heads_before(end) | notes

    def meaning(self, index: int) -> object:
        text = self.lines[index]
        if self._is_as_written(text):
            return text
        line = line_of(text, has_lists=self.has_expressions)
        said = (line.name, line.values, line.lists, line.text, line.settings, line.is_macro)
        return said, line.note.strip(), line.number, line.checksum

    def tokens(self, index: int) -> list[Token]:
        text = self.lines[index]
        if self._is_as_written(text):
            return [Token(VERBATIM, text, (0, len(text)))]
        line = line_of(text, has_lists=self.has_expressions)
        if line.checksum is not None or line.lists:  # a checksum counts every character
            return [Token(VERBATIM, text, (0, len(text)))]
        code = text.partition(";")[0]
        found = list(_words(text, line))
        end = max((token.place[1] for token in found), default=0)
        if line.is_macro or line.text:
            begin = line.place[0] if line.is_macro else line.place[1]
            found = [token for token in found if token.place[0] < begin]
            found += _written(VERBATIM, text, (begin, len(code)))
        else:
            found += _gaps(text, found, (end, len(code)))
        if len(code) < len(text):
            found.append(Token("NOTE", text[len(code) :], (len(code), len(text))))
        return sorted(found, key=lambda token: token.place)

    def _is_as_written(self, text: str) -> bool:
        """Whether blanks or small letters mean something in a line."""
        return self.decides or (self.has_expressions and "{" in text)


def _words(text: str, line: MarlinLine) -> Iterator[Token]:
    """Line number, command and words."""
    places = sorted(line.places.values())
    begin = line.place[0] if line.name else places[0][0] if places else len(text.partition(";")[0])
    if line.number:
        number = text[:begin].strip()
        first = text.index(number)
        yield Token("LINE_NUMBER", "".join(number.split()).lower(), (first, first + len(number)))
    if line.name and not line.is_macro:
        places = [line.place, *places]
    for first, last in places:
        yield Token("LETTER", text[first].lower(), (first, first + 1))
        at = first + 1
        while at < last and text[at] in " \t":
            at += 1
        if at < last and text[at] in "+-":
            yield Token("ADDING", text[at], (at, at + 1))
            at += 1
        if at < last:
            yield Token("NUMBER", text[at:last], (at, last))


def _gaps(text: str, words: list[Token], behind: ColumnRange) -> Iterator[Token]:
    """Comments in brackets, which stand wherever no word does."""
    at = 0
    for token in words:
        yield from _written("NOTE", text, (at, token.place[0]))
        at = token.place[1]
    yield from _written("NOTE", text, behind)


def _written(kind: str, text: str, place: ColumnRange) -> Iterator[Token]:
    shown = text[slice(*place)].strip()
    if shown:
        first = text.index(shown, place[0])
        yield Token(kind, shown, (first, first + len(shown)))

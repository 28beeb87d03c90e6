"""One file of a program: its lines, the blocks read so far, and where its O-words stand."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import NamedTuple, Self

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.block import KEYWORDS, Block
from gcodesim.rs274.outline import Outline
from gcodesim.rs274.reader import Reader
from gcodesim.rs274.skipped import MOST_LINES_KNOWN, Skipped
from gcodesim.rs274.tokens import VERBATIM, Token, tokens_of

# possessive quantifiers: a line of a million blanks is scanned only once
_FLOW = re.compile(
    r"\s*+(?:/\s*+)?(?:[Nn][\d\s.]*+)?[Oo]\s*+([0-9][0-9\s]*+(?:\.[0\s]*+)?|<[^>]*+>|\[.*?\](?=\s*+[A-Za-z])"
    r"|#(?:<[^>]*+>|[0-9\s]++|\[.*?\](?=\s*+[A-Za-z])))\s*+([A-Za-z\s]*+)(.?)",
    re.ASCII,
)
_NOTE = re.compile(r"\([^)]*\)?|;.*")
_BY_LENGTH = sorted(KEYWORDS, key=len, reverse=True)
_MOST_CACHED = 200_000  # blocks are kept for loops; a program longer than this is read without keeping


class FlowLine(NamedTuple):
    """A line that holds an O-word; `label` is empty when it has to be computed."""

    at: int
    label: str
    keyword: str


class Jump(NamedTuple):
    """A number in a line that names a block by its N: the index of its token, and the lines to which it may lead.

    `at` is None where the number is computed, so that nobody knows it.
    """

    at: int | None
    lines: tuple[int, ...] = ()


def is_percent(text: str) -> bool:
    """Whether a line is the sign that begins or ends a program."""
    return text.strip() == "%"


class ProgramFile:
    """Lines are addressed by index from 0; line numbers in findings are one more.

    `decides`: by how far lines are indented, commands of the program decide which of them are executed.
    """

    decides = False

    def __init__(self, source: SourceText, reader: Reader) -> None:
        self.source = source
        self.name = source.name
        self.lines = source.lines
        self._reader = reader
        self._blocks: dict[int, Block] = {}
        self._keeps = len(self.lines) <= _MOST_CACHED
        self.first, self.has_percent = _opening(self.lines)

    def block(self, index: int) -> Block:
        """The block of line `index`; raises `Fault`."""
        known = self._blocks.get(index)
        if known is None:
            known = self._reader.read(index + 1, self.lines[index])
            if self._keeps:
                self._blocks[index] = known
        return known

    def tokens(self, index: int) -> list[Token]:
        """The pieces of line `index`, in their order; raises `Fault` where the reader does not understand it."""
        text = self.lines[index]
        if is_percent(text):
            return [Token(VERBATIM, "%", (text.index("%"), text.index("%") + 1))]
        self.block(index)
        return tokens_of(text, self._reader.dialect)

    def meaning(self, index: int) -> object:
        """What line `index` says, to be compared with that of another line: how it is written is no part of it.

        Raises `Fault` for a line that the reader does not understand.
        """
        if is_percent(self.lines[index]):
            return "%"
        block = self.block(index)
        settings = [(setting.parameter, setting.value) for setting in block.settings]
        notes = [note.text if note in block.comments else block.text[note.place[0] :].rstrip() for note in block.notes]
        flow = None if block.flow is None else block.flow._replace(place=(0, 0))
        return [tuple(word) for word in block.words], settings, notes, flow, block.deleted, block.slash is None

    def jumps(self, index: int) -> list[Jump]:
        """The numbers in line `index` that name a block by its N, which RS274 has none of; raises `Fault`."""
        return []

    @property
    def numbered(self) -> list[range]:
        """Lines that have N numbers of their own: those of each program of the file."""
        return [range(len(self.lines))]

    def of(self, source: SourceText) -> Self:
        """A file of the same control with another text."""
        return type(self)(source, self._reader)

    @property
    def outline(self) -> Outline:
        """Its subroutines, and what no block leads to."""
        return Outline(self)

    @cached_property
    def is_subroutine(self) -> bool:
        """Whether the file holds nothing but the subroutine that it is named after, for other programs to call."""
        own, flows = self.name.rpartition(".")[0].lower(), self.flows
        if not own or not flows or (flows[0].label, flows[0].keyword) != (own, "sub"):
            return False
        if flows[-1].label != own or flows[-1].keyword not in ("endsub", "return"):
            return False
        around = [*self.lines[: flows[0].at], *self.lines[flows[-1].at + 1 :]]
        return not any(_NOTE.sub("", line).strip() for line in around)

    @cached_property
    def flows(self) -> list[FlowLine]:
        """All lines with an O-word, found by their form, because skipped lines are never parsed."""
        found = []
        for index in self.lines_with("oO"):
            if (flow := _o_word(self.lines[index])) is not None:
                found.append(FlowLine(index, *flow))
        return found

    @cached_property
    def skipped(self) -> Skipped:
        """The faults that a control finds while it skips lines."""
        return Skipped(self.lines, self._reader.dialect.longest_line, self.first if self.has_percent else None)

    def lines_with(self, letters: str) -> list[int]:
        """Indices of the lines that hold one of the ASCII characters `letters`, ascending."""
        if not isinstance(self.lines, list):
            return self.source.table.with_any(letters.encode("ascii"))
        return [index for index, line in enumerate(self.lines) if any(letter in line for letter in letters)]

    def find_flow(self, after: int, label: str, keywords: frozenset[str]) -> FlowLine | None:
        """The next line after index `after` with an O-word of `label` and one of `keywords`."""
        known = self._flows_by_label.get(label, [])
        for flow in known[bisect_right(known, after, key=_line) :]:
            if flow.keyword in keywords:
                return flow
        return None

    def heads_before(self, end: int) -> set[int]:
        """Indices of lines before line `end` that execute nothing: up to the first `%`, and subroutines."""
        found = set(range(self.first))
        begun: FlowLine | None = None
        for flow in self.flows:
            if flow.keyword == "sub" and begun is None:
                begun = flow
            elif flow.keyword == "endsub" and begun is not None and flow.label == begun.label:
                found |= set(range(begun.at, flow.at + 1))
                begun = None
        return {index for index in found if index < end}

    @cached_property
    def _flows_by_label(self) -> dict[str, list[FlowLine]]:
        known: dict[str, list[FlowLine]] = {}
        for flow in self.flows:
            known.setdefault(flow.label, []).append(flow)
        return known


def _line(flow: FlowLine) -> int:
    return flow.at


@lru_cache(MOST_LINES_KNOWN)
def _o_word(text: str) -> tuple[str, str] | None:
    """Label and keyword of a line with an O-word."""
    match = _FLOW.match(text)
    return None if match is None else (plain_label(match[1]), _keyword(match[2], match[3]))


def _keyword(text: str, behind: str) -> str:
    """The keyword with which `text` begins, as seen by a control that skips the line; else the text."""
    squeezed = re.sub(r"\s", "", text, flags=re.ASCII).lower()
    if not squeezed:
        return "" if behind in ("", "(", ";") else "?"
    return next((keyword for keyword in _BY_LENGTH if squeezed.startswith(keyword)), squeezed)


def plain_label(text: str) -> str:
    """`100`, `<name>` in the form in which labels are compared; empty for a computed one."""
    squeezed = re.sub(r"\s", "", text, flags=re.ASCII).lower()
    if squeezed.startswith("<"):
        return squeezed[1:-1]
    if squeezed.startswith(("[", "#")):
        return ""
    return squeezed.partition(".")[0].lstrip("0") or "0"


def _opening(lines: Sequence[str]) -> tuple[int, bool]:
    """Index of the first line to execute, and whether a `%` opened the program."""
    for index, line in enumerate(lines):
        text = line.strip()
        if text:
            return (index + 1, True) if text == "%" else (0, False)
    return 0, False

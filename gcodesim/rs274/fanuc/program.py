"""A Fanuc file: programs by their O numbers, blocks by their N numbers, loops by their DO and END."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, NamedTuple

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.block import Block, Expression, Word
from gcodesim.rs274.fanuc.external import statement
from gcodesim.rs274.fanuc.names import called_name, head_name, number_of_name
from gcodesim.rs274.fanuc.outline import FanucOutline
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.program_file import Jump, ProgramFile
from gcodesim.rs274.reader import Reader
from gcodesim.rs274.tokens import VERBATIM, Token, tokens_of

_BLANK_OR_NOTE = r"(?:\s|\([^)]*\))*"
_PROGRAM = re.compile(rf"{_BLANK_OR_NOTE}(?:[Oo]|:)\s*0*([0-9]{{1,15}})(?![0-9])")
_SEQUENCE = re.compile(rf"{_BLANK_OR_NOTE}(?:/[1-9]?\s*)?[Nn]\s*0*([0-9]{{1,15}})(?![0-9])")
_HEAD = re.compile(rf"{_BLANK_OR_NOTE}(?:/[1-9]?{_BLANK_OR_NOTE}|[Nn]\s*[0-9]{{1,15}}{_BLANK_OR_NOTE})*")
_EXTERNAL = re.compile(r"PRNT|POPEN|PCLOS|SETVN", re.IGNORECASE)
_LOOP = re.compile(r"(DO|END)\s*([0-9]{1,15})(?![0-9])")
_END = re.compile(r"[Mm]\s*0*(?:2|30|99)(?![0-9])")
_NOTE = re.compile(r"\([^)]*\)|;.*")
_MACRO_CALLS = frozenset((("g", 65.0), ("g", 66.0), ("g", 66.1)))
MOST_LOOPS = 3


def sequence_of(text: str) -> int | None:
    """The number of a line that begins with N."""
    if text[:1] not in "Nn/( \t":
        return None
    match = _SEQUENCE.match(text)
    return None if match is None else int(match[1])


def slashes_inside(text: str) -> list[tuple[int, int]]:
    """Where slashes with their digits stand in a block of words behind its head, outside brackets and comments."""
    head = _HEAD.match(text)
    depth = 0
    found: list[tuple[int, int]] = []
    at = head.end() if head else 0
    while at < len(text):
        char = text[at]
        if char in "=;":
            return [] if char == "=" else found  # in a setting it divides
        if char == "(":
            at = text.find(")", at)
            if at < 0:
                return found
        elif char in "[]":
            depth += 1 if char == "[" else -1
        elif char == "/" and depth == 0:
            found.append((at, at + 1 + text[at + 1 : at + 2].isdigit()))
        at += 1
    return found


def _without(text: str, places: list[tuple[int, int]]) -> str:
    """The line with blanks at these places."""
    for begin, end in places:
        text = text[:begin] + " " * (end - begin) + text[end:]
    return text


class FanucProgram(NamedTuple):
    """One program of a file: `first` is its first line to execute, `end` the one after its last."""

    number: int | None
    first: int
    end: int


class Loops(NamedTuple):
    """Lines of DO and of END that belong together, and what is wrong with others."""

    ends: dict[int, int]
    starts: dict[int, int]
    wrong: dict[int, str]


class FanucFile(ProgramFile):
    """Lines outside the percent signs belong to no program. P and Q of `contour_cycles` name blocks by their N."""

    contour_cycles: ClassVar[frozenset[float]] = frozenset()

    def __init__(self, source: SourceText, reader: Reader) -> None:
        super().__init__(source, reader)
        self.names: dict[int, str] = {}
        self.begin, self.end = _between_percents(self.lines, self.lines_with("%"))
        self.has_percent = False  # a program that runs into the second % has no end, so it is no end by itself
        self.first = self.parts[0].first

    @property
    def outline(self) -> FanucOutline:
        return FanucOutline(self)

    def behind(self, number: int) -> int | None:
        """Index of the line that begins program `number` behind the second percent sign, where nothing is read."""
        for index in range(self.end, len(self.lines)):
            match = _PROGRAM.match(self.lines[index])
            if match is not None and int(match[1]) == number:
                return index
        return None

    def block(self, index: int) -> Block:
        text = self.lines[index]
        if "<" in text and (named := self._named(index, text)) is not None:
            return named
        if _EXTERNAL.search(text) is not None and (found := statement(index + 1, text)) is not None:
            return found
        if "/" in text and (slashes := slashes_inside(text)):
            return replace(self._reader.read(index + 1, _without(text, slashes)), slash=slashes[0][0])
        return super().block(index)

    def tokens(self, index: int) -> list[Token]:
        text = self.lines[index]
        if self._is_as_written(index):
            return [Token(VERBATIM, text, (0, len(text)))]
        if "/" not in text or not (slashes := slashes_inside(text)):
            return super().tokens(index)
        around = tokens_of(_without(text, slashes), self._reader.dialect)
        skips = [Token("SKIP", text[slice(*place)], place) for place in slashes]
        return sorted([*around, *skips], key=lambda token: token.place)

    def meaning(self, index: int) -> object:
        if self._is_as_written(index):
            return self.lines[index]
        block = self.block(index)
        points = ["." in block.text[slice(*place)] for place in block.places]  # X10. may be more than X10
        return super().meaning(index), points

    def _is_as_written(self, index: int) -> bool:
        """Whether a line is text for somebody else: around the program, for a device, or with a name in it."""
        text = self.lines[index]
        if not self.begin <= index < self.end:
            return text.strip() != "%"
        return (
            head_name(text) is not None
            or called_name(text) is not None
            or (_EXTERNAL.search(text) is not None and statement(index + 1, text) is not None)
        )

    @property
    def numbered(self) -> list[range]:
        return [range(part.first, part.end) for part in self.parts]

    def jumps(self, index: int) -> list[Jump]:
        """Targets of GOTO, of M99 P, and of the cycles of a lathe that name their contour."""
        tokens, words = self.tokens(index), set(self.block(index).words)
        found = []
        for at, token in enumerate(tokens):
            is_return = (token.kind, token.text) == ("LETTER", "p") and ("m", 99.0) in words
            names_contour = token.kind == "LETTER" and token.text in "pq" and self._names_contour(words)
            if token.kind != "GOTO" and not is_return and not names_contour:
                continue
            if tokens[at + 1].kind != "NUMBER":
                found.append(Jump(None))
                continue
            number = int(float(tokens[at + 1].text))
            lines = [self.sequence(number, start) for start in (self._callers(index) if is_return else [index])]
            found.append(Jump(at + 1, tuple(-1 if line is None else line for line in lines)))
        return found

    def _callers(self, index: int) -> list[int]:
        """The lines that call the program of line `index`; of the main program, that line itself."""
        part = self.part_at(index)
        if part.number is None or part == self.parts[0]:
            return [index]
        found = []
        for line in range(self.begin, self.end):
            try:
                words = self.block(line).words
            except Fault:
                continue
            if ("m", 98.0) in words or not _MACRO_CALLS.isdisjoint(words):
                numbers = [value for letter, value in words if letter == "p" and isinstance(value, float)]
                if any(part.number in (value, value % 10_000) for value in numbers):
                    found.append(line)
        return found

    def _names_contour(self, words: set[tuple[str, Expression]]) -> bool:
        letters = {letter for letter, _ in words}
        return {"p", "q"} <= letters and any(("g", code) in words for code in self.contour_cycles)

    def _named(self, index: int, text: str) -> Block | None:
        """The block of a line that opens a program by a name, or calls one."""
        if head_name(text) is not None:
            return Block(index + 1, text, [])
        called = called_name(text)
        if called is None:
            return None
        name, (first, last) = called
        number = self._number_of(name)
        read = self._reader.read(index + 1, text[:first] + " " * (last - first) + text[last:])
        at = sum(place < (first, last) for place in read.places)
        words = [*read.words[:at], Word("p", float(number)), *read.words[at:]]
        places = [*read.places[:at], (first, last), *read.places[at:]]
        return Block(index + 1, text, words, notes=read.notes, deleted=read.deleted, _places=places)

    def _number_of(self, name: str) -> int:
        number = number_of_name(name)
        self.names[number] = name
        return number

    def shown(self, number: int) -> str:
        """A program as messages call it."""
        name = self.names.get(number)
        return f"O{number:04d}" if name is None else f"<{name}>"

    def heads_before(self, end: int) -> set[int]:
        part = self.part_at(end)
        return {*range(part.first), *((part.first,) if part.number is not None else ())}

    def _head(self, index: int) -> int | None:
        """The number of the program that a line opens."""
        match = _PROGRAM.match(self.lines[index])
        if match is not None:
            return int(match[1])
        name = head_name(self.lines[index]) if "<" in self.lines[index] else None
        return None if name is None else self._number_of(name)

    @cached_property
    def parts(self) -> list[FanucProgram]:
        """The programs in their order.

        Blocks before the first O are a program without number if they have an end, else they begin the first one, as
        on a control that executes the file block by block.
        """
        opening = [index for index in self.lines_with("oO:<") if self.begin <= index < self.end]
        heads = [(index, number) for index in opening if (number := self._head(index)) is not None]
        if not heads:
            return [FanucProgram(None, self.begin, self.end)]
        parts = []
        before = [_NOTE.sub("", line) for line in self.lines[self.begin : heads[0][0]]]
        if any(_END.search(line) for line in before):
            parts.append(FanucProgram(None, self.begin, heads[0][0]))
        elif any(line.strip() for line in before):
            heads[0] = (self.begin, heads[0][1])
        for (index, number), following in zip(heads, [*heads[1:], (self.end, 0)], strict=True):
            parts.append(FanucProgram(number, index, following[0]))
        return parts

    def program(self, number: int) -> FanucProgram | None:
        """The first program with `number`."""
        return next((part for part in self.parts if part.number == number), None)

    def part_at(self, index: int) -> FanucProgram:
        """The program that line `index` belongs to."""
        return next((part for part in self.parts if part.first <= index < part.end), self.parts[-1])

    @cached_property
    def _sequences(self) -> dict[int, list[int]]:
        found: dict[int, list[int]] = {}
        for index, text in enumerate(self.lines[self.begin : self.end], self.begin):
            match = _SEQUENCE.match(text)
            if match is not None:
                found.setdefault(int(match[1]), []).append(index)
        return found

    def sequence(self, number: int, index: int) -> int | None:
        """The line of block N`number` in the program of line `index`: the next, or the first from the top."""
        part = self.part_at(index)
        lines = [at for at in self._sequences.get(number, ()) if part.first <= at < part.end]
        return next((at for at in lines if at > index), lines[0] if lines else None)

    def loops(self, part: FanucProgram) -> Loops:
        """The loops of a program; found once."""
        known = self._loops.get(part.first)
        if known is None:
            known = self._loops[part.first] = _find_loops(self.lines, part)
        return known

    @cached_property
    def _loops(self) -> dict[int, Loops]:
        return {}


def _between_percents(lines: Sequence[str], candidates: Iterable[int]) -> tuple[int, int]:
    """Index of the first line of the programs and of the one after the last; marks are among the `candidates`."""
    marks = [index for index in candidates if lines[index].lstrip().startswith("%")]
    if not marks:
        return 0, len(lines)
    if len(marks) == 1 and not any(line.strip() for line in lines[marks[0] + 1 :]):
        return 0, marks[0]
    return marks[0] + 1, marks[1] if len(marks) > 1 else len(lines)


def _find_loops(lines: Sequence[str], part: FanucProgram) -> Loops:
    loops = Loops({}, {}, {})
    stack: list[tuple[int, int]] = []
    for index, line in enumerate(lines[part.first : part.end], part.first):
        text = _NOTE.sub("", line).upper()
        if "D" not in text:
            continue
        match = _LOOP.search(text)
        if match is None:
            continue
        number = int(match[2])
        if match[1] == "DO":
            if any(number == other for other, _ in stack):
                loops.wrong[index] = f"DO{number} inside DO{number}: nested loops need numbers of their own"
            stack.append((number, index))
            continue
        if not stack:
            loops.wrong[index] = f"END{number} has no DO{number} before it"
        elif stack[-1][0] == number:
            start = stack.pop()[1]
            loops.ends[start], loops.starts[index] = index, start
        elif any(number == other for other, _ in stack):
            message = f"the loops cross: END{number} stands inside DO{stack[-1][0]}"
            loops.wrong[index] = message
            while stack[-1][0] != number:
                loops.wrong.setdefault(stack.pop()[1], message)
            loops.wrong.setdefault(stack.pop()[1], message)
        else:
            loops.wrong[index] = f"END{number} has no DO{number} before it"
    for number, index in stack:
        loops.wrong.setdefault(index, f"DO{number} has no END{number}")
    return loops

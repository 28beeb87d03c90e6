"""What stands where in a Fanuc file: its programs are subroutines, GOTO and M99 P lead to blocks by their N."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from gcodesim.rs274.fanuc.names import called_name, number_of_name
from gcodesim.rs274.outline import RETURNS, Outline, bare
from gcodesim.rs274.program_file import FlowLine

if TYPE_CHECKING:
    from gcodesim.rs274.fanuc.program import FanucFile

_CALLS = re.compile(r"(?:M\s*0*98|G\s*0*6[56](?:\s*\.\s*1)?)(?![0-9.])", re.IGNORECASE)
_NUMBER = re.compile(r"P\s*(?:([0-9]{1,15})|[#\[<])", re.IGNORECASE)
_TARGET = re.compile(r"(?:GOTO|M\s*0*99\s*P)\s*(?:([0-9]{1,15})|[#\[])", re.IGNORECASE)
_SEQUENCE = re.compile(r"\s*+(?:/\s*+)?N\s*0*([0-9]{1,15})(?![0-9])", re.IGNORECASE)
_LOOP = re.compile(r"(DO|END)\s*[0-9]", re.IGNORECASE)
_LEAD, _LOOPS = "oOmM", "dD"  # letters of GOTO and M99, of DO and END: few lines of a long program have one


class FanucOutline(Outline):
    """The structure that O and N numbers give a file."""

    file: FanucFile

    def subroutines(self) -> Iterator[tuple[str, int, str]]:
        for part in self.file.parts[1:]:
            lines = self.file.lines[part.first : part.end]
            if part.number is not None and any(RETURNS.search(bare(line)) for line in lines):
                name = self.file.names.get(part.number)
                yield str(part.number), part.first, f"O{part.number}" if name is None else f"<{name}>"

    def called(self) -> set[str] | None:
        numbers: set[str] = set()
        for line in self.file.lines:
            text = bare(line)
            if not _CALLS.search(text):
                continue
            if (named := called_name(text)) is not None:
                numbers.add(str(number_of_name(named[0])))
                continue
            for match in _NUMBER.finditer(text):
                if match[1] is None:
                    return None
                # in the old form P holds the repeats before the last four digits
                numbers |= {str(int(match[1])), str(int(match[1][-4:]))}
        return numbers

    def unclosed(self) -> Iterator[tuple[FlowLine, str]]:
        yield from ()  # a DO without END is a fault where it stands

    def open_at(self, end: int) -> list[FlowLine]:
        part = self.file.part_at(end)
        found: list[FlowLine] = []
        for index, text in self._with(_LOOPS, part.first, end):
            for word in _LOOP.findall(text):
                if word.upper() == "DO":
                    found.append(FlowLine(index, "", "DO"))
                elif found:
                    found.pop()
        return found

    def behind(self, end: int) -> Iterator[int]:
        part = self.file.part_at(end)
        targets: set[int] = set()
        loops = 0
        for _, text in self._with(_LEAD, part.first, part.end):
            for match in _TARGET.finditer(text):
                if match[1] is None:
                    return
                targets.add(int(match[1]))
        for _, text in self._with(_LOOPS, part.first, end + 1):
            loops += sum(1 if word.upper() == "DO" else -1 for word in _LOOP.findall(text))
        if loops > 0:
            return
        for index in range(end + 1, part.end):
            sequence = _SEQUENCE.match(self.file.lines[index])
            if sequence is not None and int(sequence[1]) in targets:
                return
            yield index

    def _with(self, letters: str, first: int, end: int) -> Iterator[tuple[int, str]]:
        """Indices and bare texts of the lines from `first` to before `end` that hold one of `letters`."""
        for index in self.file.lines_with(letters):
            if first <= index < end:
                yield index, bare(self.file.lines[index])

"""The files of a running program as one text, and where their O-words stand."""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from gcodesim.rs274.flow import LOCAL_WORDS, FlowControl, show
from gcodesim.rs274.plain import layout_kernels as at
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.program_file import FlowLine, ProgramFile, plain_label

# what the kernels may read behind: nothing but a label and a keyword, without blanks inside
_O_WORD: Final = re.compile(
    r"[ \t]*(?:[Nn][0-9]+[ \t]*)?[Oo][ \t]*([0-9]{1,15}|<[A-Za-z0-9_.-]+>)[ \t]*([A-Za-z]+)[ \t]*(?=[\[(;]|\Z)"
)
_KEYWORDS: Final = {
    "if": at.IF, "elseif": at.ELSEIF, "else": at.ELSE, "endif": at.ENDIF, "while": at.WHILE, "endwhile": at.ENDWHILE,
    "do": at.DO, "repeat": at.REPEAT, "endrepeat": at.ENDREPEAT, "break": at.BREAK, "continue": at.CONTINUE,
    "sub": at.SUB_WORD, "endsub": at.ENDSUB, "return": at.RETURN, "call": at.CALL,
}  # fmt: skip
KINDS: Final = {number: word for word, number in _KEYWORDS.items()}
TextKey = tuple[str, str, str]


class ProgramText:
    """Files one after the other; a line has one index among all of them.

    `data` and `starts` are as of a `LineTable`; behind the lines of each file `starts` has one more entry.
    """

    def __init__(self, main: ProgramFile) -> None:
        self.files: list[ProgramFile] = [main]
        self.bases: dict[str, int] = {main.name: 0}
        self.data, self.starts = main.source.table.data, main.source.table.starts

    def add(self, file: ProgramFile) -> bool:
        """Make room for a file; whether it is new."""
        if file.name in self.bases:
            return False
        self.bases[file.name] = len(self.starts)
        self.files.append(file)
        table = file.source.table
        self.starts = np.concatenate([self.starts, table.starts + len(self.data)])
        self.data = np.concatenate([self.data, table.data])
        return True

    def base_of(self, file: ProgramFile) -> int:
        """Index of the first line of a file."""
        return self.bases[file.name]

    def end_of(self, file: ProgramFile) -> int:
        """Index behind its last line."""
        return self.bases[file.name] + len(file.lines)

    def file_of(self, index: int) -> tuple[ProgramFile, int]:
        """The file of a line, and its index there."""
        for file in reversed(self.files):
            base = self.bases[file.name]
            if index >= base:
                return file, index - base
        raise IndexError(index)


class FlowTable:
    """One row for each line with an O-word, as the kernels have them; `rows` (n, FLOW) lie in the tables."""

    def __init__(self) -> None:
        self.labels: list[str] = []
        self.groups: dict[TextKey, int] = {}  # row that keeps the state of a label
        self.scopes: dict[tuple[str, str], int] = {}
        self._scope_names: list[tuple[str, str]] = []
        self._files = 0
        self._lines: list[tuple[ProgramFile, FlowLine]] = []

    def scope(self, file: str, name: str) -> int:
        """The number of a subroutine's name; that of a main program is empty."""
        number = self.scopes.setdefault((file, name), len(self.scopes))
        if number == len(self._scope_names):
            self._scope_names.append((file, name))
        return number

    def key_of(self, group: int, scope: int) -> TextKey:
        """File, subroutine and label of a group."""
        file, name = self._scope_names[scope]
        return file, name, self.labels[group]

    def extended(self, text: ProgramText, flow: FlowControl) -> Column:
        """The rows of all files, in the order of lines; those known keep their numbers."""
        new: list[list[int]] = []
        for file in text.files[self._files :]:
            new += self._rows_of(file, text, flow)
        self._files = len(text.files)
        return np.array(new, dtype=np.int64).reshape(len(new), at.FLOW)

    def _rows_of(self, file: ProgramFile, text: ProgramText, flow: FlowControl) -> list[list[int]]:
        first, base = len(self.labels), text.base_of(file)
        rows: list[list[int]] = []
        scope = ""
        for line in file.flows:
            if line.keyword == "sub" and not scope:
                scope = line.label
            row = [0] * at.FLOW
            row[at.FLOW_AT], row[at.KEYWORD], behind = base + line.at, *_keyword(file.lines[line.at], line)
            if line.keyword == "sub" and line.label != scope:
                row[at.KEYWORD] = 0  # one inside another, which the grammar's lane tells
            row[at.BEHIND] = int(text.starts[base + line.at]) + behind
            row[at.GROUP] = self.groups.setdefault((file.name, scope, line.label), len(self.labels))
            row[at.FLOW_SCOPE] = self.scope(file.name, scope)
            row[at.FOLLOWING] = row[at.SUB] = row[at.LEFT] = -1
            rows.append(row)
            self.labels.append(line.label)
            self._lines.append((file, line))
            if line.keyword == "endsub" and line.label == scope:
                scope = ""
        following: dict[str, tuple[int, int]] = {}  # of each label: row and line of the O-word behind
        for number in range(len(rows) - 1, -1, -1):
            line = self._lines[first + number][1]
            if line.label in following:
                row_behind, at_behind = following[line.label]
                if file.skipped.is_clear(line.at, at_behind):
                    rows[number][at.FOLLOWING] = row_behind
            if line.keyword in LOCAL_WORDS:
                following[line.label] = (first + number, line.at)
        return rows

    def name_subroutines(self, rows: Column, text: ProgramText, flow: FlowControl) -> None:
        """Tell the rows of calls where the subroutines known by now begin."""
        for row, (_, line) in enumerate(self._lines):
            if line.keyword != "call" or line.label not in flow.subs:
                continue
            file, index = flow.subs[line.label]
            if file.name in text.bases:
                rows[row, at.SUB], rows[row, at.SUB_END] = text.base_of(file) + index, text.end_of(file)
                rows[row, at.SUB_SCOPE] = self.scope(file.name, line.label)

    def callee(self, row: int, flow: FlowControl) -> tuple[ProgramFile, int]:
        """File and line of the subroutine that a row calls."""
        return flow.subs[self.labels[row]]

    def line_of(self, row: int) -> tuple[ProgramFile, int]:
        """File and index of the line of a row."""
        file, line = self._lines[row]
        return file, line.at

    def shown(self, row: int) -> str:
        """The label as written."""
        return show(self.labels[row])


def _keyword(line: str, flow: FlowLine) -> tuple[int, int]:
    """Number of the keyword, 0 where the kernels leave the line, and how long the text is as far as behind it."""
    found = _O_WORD.match(line)
    if found is None or found[2].lower() != flow.keyword or plain_label(found[1]) != flow.label:
        return 0, 0
    return _KEYWORDS.get(flow.keyword, 0), found.end()

"""Runs that are done, in a file that is only added to: each stands on the disk before the next is asked for.

A line of JSON a run, with its key. Whatever ends the process, all whole lines are good; what was cut off is left out.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO, Final

from gcodesim.files.whole_file import new_file
from gcodesim.numbers import read_json

NAME: Final = "runs.jsonl"
HEAD: Final = b'{"schema": "gcodesim-sweep-runs/1"}\n'
_MARK: Final = b'{"key": "'
_KEY: Final = 64


class ForeignJournalError(Exception):
    """The file is there, and is none of ours."""


class Journal:
    """Rows by key. Only their places are in memory."""

    def __init__(self, folder: Path) -> None:
        """Open the journal in `folder`, or begin one. ForeignJournalError, OSError."""
        self.path = folder / NAME
        self._places: dict[str, tuple[int, int]] = {}
        self._file = self._opened()

    def _opened(self) -> BinaryIO:
        if not os.path.lexists(self.path):
            with new_file(self.path) as file:
                file.write(HEAD)
        if self.path.is_symlink() or not self.path.is_file():
            raise ForeignJournalError(self.path)
        file = self.path.open("r+b")
        if not HEAD.startswith(file.read(len(HEAD))):
            file.close()
            raise ForeignJournalError(self.path)
        end = self._scan(file)
        file.truncate(end)  # behind the last whole line
        if end < len(HEAD):
            file.seek(0)
            file.write(HEAD)
        return file

    def _scan(self, file: BinaryIO) -> int:
        """Note the places of all whole lines; where they end."""
        file.seek(0)
        end = 0
        for line in file:
            if not line.endswith(b"\n"):
                break
            if end:
                self._note(line, end)
            end += len(line)
        return end

    def _note(self, line: bytes, at: int) -> None:
        key = line[len(_MARK) : len(_MARK) + _KEY]
        if line.startswith(_MARK) and line[len(_MARK) + _KEY : len(_MARK) + _KEY + 1] == b'"':
            self._places[key.decode("ascii", "replace")] = (at, len(line))

    def __contains__(self, key: str) -> bool:
        return key in self._places

    def __len__(self) -> int:
        return len(self._places)

    def row(self, key: str) -> Mapping[str, Any] | None:
        """What is known of a run; None if nothing is, or the line is damaged."""
        place = self._places.get(key)
        if place is None:
            return None
        self._file.seek(place[0])
        try:
            value = read_json(self._file.read(place[1]))
            return value["row"] if value["key"] == key and isinstance(value["row"], dict) else None
        except (ValueError, KeyError, TypeError):
            return None

    def add(self, key: str, row: Mapping[str, Any]) -> None:
        """Keep a run; it is on the disk when this returns. A key that is known stays as it is."""
        if self.row(key) is not None:
            return
        line = json.dumps({"key": key, "row": row}, ensure_ascii=False, allow_nan=False).encode() + b"\n"
        at = self._file.seek(0, os.SEEK_END)
        self._places[key] = (at, len(line))  # first, so that an interrupt on the way leaves no row that is not known
        self._file.write(line)
        self._file.flush()
        os.fsync(self._file.fileno())

    def forget(self, key: str) -> None:
        """From now on the run counts as not done, until it is added again."""
        self._places.pop(key, None)

    def forget_all(self) -> None:
        """From now on nothing counts as done."""
        self._places.clear()

    def close(self) -> None:
        self._file.close()

"""Plane, units and way of counting that hold at a line, as far as the text of a program says so for certain.

The log has what changes a motion. These words only change how a program is read, so they come from its text. Where
it jumps, or calls other files, and says different things in different places, the text alone does not tell what holds:
then nothing is said.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Final

GROUPS: Final = (("G17", "G18", "G19"), ("G20", "G21"), ("G90", "G91"))
"""Words of which one holds, until another one of its group comes."""

_COMMENT: Final = re.compile(r"\([^)]*\)?|;.*")
_WORD: Final = re.compile(r"G0*(\d+)(?![\d.])", re.IGNORECASE)
_JUMP: Final = re.compile(r"^\s*(?:N\d+\s*)?O(?:<|\d)|GOTO|WHILE|\bIF\b|M9[78]|G65", re.IGNORECASE)


def modes_of(files: Mapping[str, Sequence[str]]) -> dict[str, list[tuple[int, list[str]]]]:
    """By file the lines from which on words hold, and which; from the lines of all files of a program."""
    said: dict[str, list[list[tuple[int, str]]]] = {name: [[] for _ in GROUPS] for name in files}
    jumps = len(files) > 1
    for name, lines in files.items():
        for number, line in enumerate(lines, start=1):
            code = _COMMENT.sub("", line).replace(" ", "")
            jumps = jumps or _JUMP.search(code) is not None
            words = {f"G{found}" for found in _WORD.findall(code)}
            for group, heard in zip(GROUPS, said[name], strict=True):
                heard += [(number, word) for word in group if word in words]
    everywhere = [{word for heard in said.values() for _, word in heard[i]} for i in range(len(GROUPS))]
    changes: dict[str, list[tuple[int, list[str]]]] = {}
    for name, groups in said.items():
        now = [next(iter(words)) if len(words) == 1 and (jumps or len(files) > 1) else "" for words in everywhere]
        changes[name] = [(1, [word for word in now if word])]
        told = sorted((line, i, word) for i, heard in enumerate(groups) for line, word in heard)
        for number, i, word in told:
            if not jumps:
                now[i] = word
                changes[name].append((number, [one for one in now if one]))
    return changes

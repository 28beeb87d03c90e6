"""Seeded changes of programs and cells, for asking whether a test suite would see them.

They are drawn by a `random.Random`, so a seed repeats them. They work on plain blocks: lines with expressions, O-words
or parameters stay as they are.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from random import Random
from typing import Final

from gcodesim.declarations.nodes import Listing, Node, Scalar, compose
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.scalars import measured
from gcodesim.diagnostics import Findings, SourceText
from gcodesim.frozen import frozen

_WORD = re.compile(r"([A-Za-z])\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))")
_COMPUTED = re.compile(r"[#\[\]=*/%]|^\s*[oO]")
_CALLS: Final = {"O", "P", "L", "Q"}
_PLACES: Final = 4  # of a coordinate that a mutation writes
_ARC_PLACES: Final = 6


@frozen
class Mutation:
    """A changed text; a comparison has to show at least one of `quantities` if the change matters."""

    operator: str
    text: str
    what: str
    quantities: tuple[str, ...] = ()


Operator = Callable[[Random, list[str]], "tuple[str, tuple[str, ...]] | None"]
"""Changes lines in place; returns what it did and which quantities show it, None if there is nothing to change."""


@frozen(kw_only=False)
class _Found:
    """A word of a program: index of the line, place in it, letter and number."""

    line: int
    start: int
    end: int
    letter: str
    text: str

    @property
    def value(self) -> float:
        return float(self.text)


def _code(line: str) -> str:
    """The part of a line before any comment; empty when it computes."""
    code = re.split(r"[(;]", line, maxsplit=1)[0]
    return "" if _COMPUTED.search(code) else code


def _words(lines: list[str], letters: str) -> list[_Found]:
    found = []
    for index, line in enumerate(lines):
        for match in _WORD.finditer(_code(line)):
            if match[1].upper() in letters:
                found.append(_Found(index, match.start(), match.end(), match[1].upper(), match[2]))
    return found


def _is(word: _Found, *numbers: float) -> bool:
    return word.value in numbers


def _put(lines: list[str], word: _Found, text: str) -> str:
    """Replace a word; returns a description of the changed line."""
    old = lines[word.line]
    lines[word.line] = old[: word.start] + text + old[word.end :]
    return f"line {word.line + 1}: {old.strip()} → {lines[word.line].strip()}"


def _number(value: float, places: int = _PLACES) -> str:
    text = f"{value:.{places}f}".rstrip("0").rstrip(".")
    return "0" if text in ("", "-0") else text


def _factor(random: Random) -> float:
    """A factor far enough from 1 that nobody would call the result the same."""
    return random.choice((random.uniform(0.4, 0.8), random.uniform(1.25, 2.0)))


# ---- programs


def _feed(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = _words(lines, "F")
    if not words:
        return None
    word = random.choice(words)
    return _put(lines, word, f"F{_number(word.value * _factor(random))}"), ("feed",)


def _coordinate(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = [word for word in _words(lines, "XYZ") if word.line > 0]
    if not words:
        return None
    word = random.choice(words)
    moved = word.value + random.choice((-1.0, 1.0)) * random.uniform(0.2, 2.0)
    return _put(lines, word, f"{word.letter}{_number(moved)}"), (word.letter, "move", "arc", "moves", "findings")


def _arc_direction(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = [word for word in _words(lines, "G") if _is(word, 2.0, 3.0)]
    if not words:
        return None
    word = random.choice(words)
    return _put(lines, word, "G3" if _is(word, 2.0) else "G2"), ("arc direction",)


def _deleted_line(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    places = sorted({word.line for word in _words(lines, "XYZ")})
    if not places:
        return None
    place = random.choice(places)
    line = lines.pop(place)
    return f"line {place + 1} deleted: {line.strip()}", ("moves", "move", "feed", "arc", "X", "Y", "Z", "findings")


def _spindle_off(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = [word for word in _words(lines, "M") if _is(word, 3.0, 4.0)]
    if not words:
        return None
    return _put(lines, random.choice(words), ""), ("spindle", "spindle speed", "moves")


def _spindle_speed(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = _words(lines, "S")
    if not words:
        return None
    word = random.choice(words)
    return _put(lines, word, f"S{_number(word.value * _factor(random))}"), ("spindle speed",)


def _rapid_for_feed(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = [word for word in _words(lines, "G") if _is(word, 1.0)]
    if not words:
        return None
    return _put(lines, random.choice(words), "G0"), ("move", "moves")


def _dwell(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    places = sorted({word.line for word in _words(lines, "XYZ")})
    if not places:
        return None
    place = random.choice(places)
    lines.insert(place, f"G4 P{_number(random.uniform(0.2, 3.0))}")
    return f"line {place + 1} put in: {lines[place]}", ("moves", "dwell")


def _swapped(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """Two moves in reverse order."""
    moving = {word.line for word in _words(lines, "XYZ")}
    places = sorted(line for line in moving if line + 1 in moving)
    if not places:
        return None
    place = random.choice(places)
    lines[place], lines[place + 1] = lines[place + 1], lines[place]
    return f"lines {place + 1} and {place + 2} swapped", ("moves", "move", "arc", "feed", "X", "Y", "Z", "findings")


def _arc_center(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """Another centre or radius; if the arc no longer fits, that is an error."""
    words = _words(lines, "IJR")
    if not words:
        return None
    word = random.choice(words)
    value = word.value + random.choice((-1.0, 1.0)) * random.uniform(0.2, 2.0)
    named = ("arc", "X", "Y", "Z", "moves", "findings")
    return _put(lines, word, f"{word.letter}{_number(value)}"), named


def _tool_number(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = _words(lines, "T")
    if not words:
        return None
    word = random.choice(words)
    other = random.choice([n for n in (1, 2, 3) if n != word.value])
    return _put(lines, word, f"T{other}"), ("tool", "selected tool", "moves", "findings")


def _length_offset(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = _words(lines, "H")
    if not words:
        return None
    word = random.choice(words)
    other = random.choice([n for n in (1, 2, 3) if n != word.value])
    return _put(lines, word, f"H{other}"), ("tool offset", "machine", "Z", "moves", "findings")


def _work_system(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = [word for word in _words(lines, "G") if _is(word, 54.0, 55.0)]
    if not words:
        return None
    word = random.choice(words)
    named = ("machine", "X", "Y", "Z", "moves", "findings")
    return _put(lines, word, "G55" if _is(word, 54.0) else "G54"), named


def _incremental(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    words = [word for word in _words(lines, "G") if _is(word, 90.0)]
    if not words:
        return None
    return _put(lines, random.choice(words), "G91"), ("X", "Y", "Z", "machine", "moves", "findings")


def _path_mode(random: Random, lines: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """Exact stop from some line on, until the program says something else."""
    places = sorted({word.line for word in _words(lines, "XYZ")})
    if not places:
        return None
    place = random.choice(places)
    lines.insert(place, "G61.1")
    return f"line {place + 1} put in: {lines[place]}", ("path mode", "moves")


PROGRAM_OPERATORS: Final[Mapping[str, Operator]] = {
    "feed": _feed,
    "coordinate": _coordinate,
    "arc direction": _arc_direction,
    "deleted line": _deleted_line,
    "spindle off": _spindle_off,
    "spindle speed": _spindle_speed,
    "rapid for feed": _rapid_for_feed,
    "dwell": _dwell,
    "swapped lines": _swapped,
    "arc centre": _arc_center,
    "tool number": _tool_number,
    "length offset": _length_offset,
    "work system": _work_system,
    "incremental": _incremental,
    "exact stop": _path_mode,
}


def mutate_program(random: Random, text: str, operator: str | None = None) -> Mutation | None:
    """One change of meaning of a program; None when there is nothing for that operator to change."""
    name = operator or random.choice(list(PROGRAM_OPERATORS))
    return _applied(name, PROGRAM_OPERATORS[name], random, text)


def _applied(name: str, operator: Operator, random: Random, text: str) -> Mutation | None:
    lines = text.splitlines()
    done = operator(random, lines)
    if done is None:
        return None
    what, quantities = done
    return Mutation(operator=name, text="\n".join(lines) + "\n", what=what, quantities=quantities)


# ---- cells: which numbers may change, by the pattern of their path, and what shows it

CELL_OPERATORS: Final[Mapping[str, tuple[str, tuple[str, ...]]]] = {
    "tool diameter": (r"tools\.[0-9]+\.diameter", ("stocks", "tools", "surface")),
    "flutes": (r"tools\.[0-9]+\.flutes", ("tools",)),
    "offset": (r"work_offsets\.G5[0-9.]+(?: P[0-9]+)?\.xyz\.[0-2]", ("machine", "X", "Y", "Z", "joints")),
    "stiffness": (r"robots\.[^.]+\.stiffness\.[0-9]", ("stocks", "tools", "surface", "joints")),
    "stock height": (r"stock\.box\.2", ("stocks", "surface")),
    "cutting force": (r"materials\.[^.]+\.kc11", ("tools",)),
    "acceleration": (r"machine\.axes\.[XYZ]\.acceleration", ("time", "joints")),
    "speed": (r"machine\.axes\.[XYZ]\.speed", ("time", "joints")),
}


def mutate_cell(random: Random, text: str, operator: str | None = None) -> Mutation | None:
    """One number of a cell changed; None when the cell has none that the operator may change."""
    name = operator or random.choice(list(CELL_OPERATORS))
    pattern, quantities = CELL_OPERATORS[name]
    source = SourceText("cell.yaml", text.encode())
    root = compose(source, Findings())
    places = [] if root is None else [s for path, s in _scalars(root, "") if re.fullmatch(pattern, path)]
    numbers = [(scalar, number) for scalar in places if (number := measured(scalar.text)) is not None]
    if not numbers:
        return None
    scalar, number = random.choice(numbers)
    if name == "offset":
        value = number.value + random.choice((-1.0, 1.0)) * random.uniform(0.2, 3.0)
    elif name == "flutes":
        value = number.value + random.choice((1, 2))
    elif name == "stiffness":
        value = number.value * random.choice((0.1, 0.2))
    else:
        value = number.value * _factor(random)
    new = f"{_number(value)}{f' {number.unit}' if number.unit else ''}"
    lines = list(source.lines)
    span = scalar.span
    line = lines[span.line - 1]
    lines[span.line - 1] = line[: span.column - 1] + new + line[span.end_column - 1 :]
    what = f"line {span.line}: {scalar.text} → {new}"
    return Mutation(operator=name, text="\n".join(lines) + "\n", what=what, quantities=quantities)


def _scalars(node: Node, path: str) -> list[tuple[str, Scalar]]:
    if isinstance(node, Scalar):
        return [(path, node)]
    if isinstance(node, Listing):
        return [entry for i, item in enumerate(node.items) for entry in _scalars(item, f"{path}.{i}")]
    assert isinstance(node, MappingNode)
    lead = f"{path}." if path else ""
    return [entry for name, value in node.entries for entry in _scalars(value, f"{lead}{name.text}")]

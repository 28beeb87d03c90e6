"""Keys of one tool of a cell, while they are gathered from a file of another program."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import field
from typing import Any, Final

from gcodesim.frozen import frozen

Json = Mapping[str, Any]

LEFT_OUT: Final = "left out: "
"""How the note of what is no tool begins."""


@frozen
class ReadTool:
    """One tool of a file. `keys` are its keys in a cell, as text; none: it is refused, and `notes` say why."""

    number: int
    name: str
    keys: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def refused(self) -> bool:
        return not self.keys and not "".join(self.notes[:1]).startswith(LEFT_OUT)


def number_of(value: Any) -> float | None:
    """A finite number, or the number that a text such as `6.00 mm` begins with."""
    if isinstance(value, bool) or value is None:
        return None
    if isinstance(value, str):
        match = re.match(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)", value)
        value = float(match[1]) if match else None
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else None


def whole_of(value: Any) -> int | None:
    number = number_of(value)
    return int(number) if number is not None and number == int(number) else None


def quoted(text: str) -> str:
    plain = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return json.dumps(plain, ensure_ascii=False)


class ToolKeys:
    """Keys of one tool while they are gathered."""

    def __init__(self, kind: str, name: str, unit: str) -> None:
        self.found: dict[str, str] = {"type": kind}
        if name.strip():
            self.found["name"] = quoted(name)
        self.unit, self.notes = unit, list[str]()

    def length(self, key: str, value: float | None) -> None:
        if value is not None and value > 0.0:
            self.found[key] = f"{round(value, 6):g} {self.unit}"

    def angle(self, key: str, value: float | None) -> None:
        if value is not None:
            self.found[key] = f"{round(value, 6):g} deg"

    def count(self, key: str, value: Any) -> None:
        number = whole_of(value)
        if number is not None and number > 0:
            self.found[key] = str(number)

    def tool(self, number: int, name: str, needs: tuple[str, ...] = ("diameter",)) -> ReadTool:
        lacking = [key for key in needs if key not in self.found]
        if lacking:
            return ReadTool(number=number, name=name, notes=(f"refused: it does not say its {lacking[0]}",))
        return ReadTool(number=number, name=name, keys=self.found, notes=tuple(self.notes))

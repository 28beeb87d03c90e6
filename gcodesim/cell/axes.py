"""Axes by letter, as machine tools and external axes of robots are written in a cell."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from gcodesim.declarations.kind import Json, Kind
from gcodesim.declarations.map_of import NameRule, read_name
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import FREE, Record, not_a_mapping
from gcodesim.frozen import frozen

SPIN_UP: Final = 0.25  # s to full speed, where no acceleration is given
UNLIMITED: Final = (-math.inf, math.inf)


def nearest_home(lower: float, upper: float) -> float:
    """Where an axis starts that says nothing about it: 0 if that is within the travel, else the nearer end."""
    return min(max(0.0, lower), upper)


@frozen(eq=False)
class AxesKind(Kind):
    """Axes by letter, in chain order: `records` has what each of them takes.

    `what` is how people call one of them, `example` how one is written; `least` of them are wanted.
    """

    records: Mapping[str, Record]
    what: str
    example: str
    least: int = 0

    @property
    def expected(self) -> str:
        return f"axes by letter, such as `{self.example}`"

    def _letter(self, text: str) -> str | None:
        return text.upper() if text.upper() in self.records else None

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        if not isinstance(node, MappingNode):
            return not_a_mapping(node, self.expected, to, path)
        known = tuple(self.records)
        rule = NameRule(what=f"{self.what} ({', '.join(known)})", pattern="", canonical=self._letter, known=known)
        axes: dict[str, Any] = {}
        for name, value in node.entries:
            if name.text.startswith(FREE):
                continue
            letter = read_name(rule, name, path, axes, to)
            if isinstance(letter, Unread):
                axes[name.text] = UNREAD
                continue
            to.named((*path, letter), name.span)
            axes[letter] = self.records[letter].read(value, to, (*path, letter))
        return UNREAD if any(value is UNREAD for value in axes.values()) else axes

    def schema(self, definitions: dict[str, Json]) -> Json:
        patterns: Json = {}
        for cls in dict.fromkeys(record.cls for record in self.records.values()):
            letters = "".join(letter for letter, record in self.records.items() if record.cls is cls)
            patterns[f"^[{letters}{letters.lower()}]$"] = self.records[letters[0]].schema(definitions)
        patterns[f"^{FREE}"] = {}
        wanted = {"minProperties": self.least} if self.least else {}
        return {"type": "object", "patternProperties": patterns, **wanted, "additionalProperties": False}

    def show(self, value: Any) -> Any:
        return {letter: self.records[letter].show(axis) for letter, axis in value.items()}

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", {letter: self.records[letter].plain(axis)[1] for letter, axis in value.items()}

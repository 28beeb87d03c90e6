"""How tolerances are written: `0.5 mm^3`, `2 %`, or `[0.5 mm^3, 2 %]`, where the greater one counts."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path as FilePath
from typing import Any

from gcodesim.declarations.files import Shelf
from gcodesim.declarations.kind import NOT_NEGATIVE, Json, Kind, scalar, short
from gcodesim.declarations.nodes import Listing, Node, Scalar
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import known_keys, not_a_mapping
from gcodesim.declarations.scalars import measured
from gcodesim.declarations.units import DIMENSIONS, find, in_unit
from gcodesim.diagnostics import Findings, Span
from gcodesim.frozen import frozen
from gcodesim.regress.tolerance import QUANTITIES, Tolerance

_PERCENT = "%"


@frozen(kw_only=False)
class ToleranceKind(Kind):
    """A tolerance of a quantity: absolute in its unit, relative in per cent, or both."""

    dimension: str

    @property
    def expected(self) -> str:
        d = DIMENSIONS[self.dimension]
        return f"{d} such as `{d.example}`, per cent such as `2 %`, or both in a list"

    def read(self, node: Node, to: Reading, path: Path) -> Tolerance | Unread:
        items = node.items if isinstance(node, Listing) else (node,)
        if isinstance(node, MappingNode) or not 1 <= len(items) <= 2:
            return to.fault("GS706", node.span, f"`{path[-1]}` is no tolerance; {self.expected} is expected")
        absolute, relative = 0.0, 0.0
        for item in items:
            text = scalar(self, item, to, path)
            if isinstance(text, Unread):
                return UNREAD
            number = measured(text.text)
            if number is not None and number.unit == _PERCENT:
                share = Quantity("ratio", NOT_NEGATIVE).in_si(number, None, text, to, path)
                if isinstance(share, Unread):
                    return UNREAD
                relative = max(relative, share)
                continue
            value = Quantity(self.dimension, NOT_NEGATIVE).read(text, to, path)
            if isinstance(value, Unread):
                return UNREAD
            unit = find(DIMENSIONS[self.dimension].shown, self.dimension) if DIMENSIONS[self.dimension].shown else None
            absolute = max(absolute, in_unit(value, unit) if unit is not None else value)
        return Tolerance(absolute, relative)

    def schema(self, definitions: dict[str, Json]) -> Json:
        one = Quantity(self.dimension).schema(definitions)
        share = Quantity("ratio").schema(definitions)
        entry = {"anyOf": [one, share]}
        return {"anyOf": [one, share, {"type": "array", "items": entry, "minItems": 1, "maxItems": 2}]}

    def show(self, value: Any) -> Any:
        unit = DIMENSIONS[self.dimension].shown
        parts = [f"{value.absolute:.10g} {unit}".strip()] if value.absolute or not value.relative else []
        return [*parts, *([f"{value.relative * 100:.10g} %"] if value.relative else [])]


@frozen(kw_only=False)
class TolerancesKind(Kind):
    """Tolerances by the names of `QUANTITIES`."""

    @property
    def expected(self) -> str:
        return "tolerances by quantity, such as `volume: [0.5 mm^3, 1 %]`"

    def read(self, node: Node, to: Reading, path: Path) -> Mapping[str, Tolerance] | Unread:
        if not isinstance(node, MappingNode):
            return not_a_mapping(node, self.expected, to, path)
        values = {}
        for name, key, value in known_keys(node.entries, list(QUANTITIES), "`tolerances`", to):
            to.named((*path, name), key.span)
            values[name] = ToleranceKind(QUANTITIES[name].dimension).read(value, to, (*path, name))
        good = {name: value for name, value in values.items() if not isinstance(value, Unread)}
        return good if len(good) == len(values) else UNREAD

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {
            "type": "object",
            "properties": {
                name: {**ToleranceKind(quantity.dimension).schema(definitions), "description": quantity.what}
                for name, quantity in QUANTITIES.items()
            },
            "additionalProperties": False,
        }

    def show(self, value: Any) -> Any:
        return {name: ToleranceKind(QUANTITIES[name].dimension).show(one) for name, one in value.items()}


def tolerance_from(name: str, text: str) -> Tolerance | str:
    """The tolerance that a command line gives (`2 %`, `0.5 mm^3`, `0.5 mm^3, 2 %`), or what is wrong with it."""
    findings = Findings()
    to = Reading(file="", findings=findings, shelf=Shelf(folder=FilePath()))
    items = tuple(Scalar(span=Span("", 1, 1, 1, 2), text=part.strip()) for part in text.split(","))
    value = ToleranceKind(QUANTITIES[name].dimension).read(Listing(span=Span("", 1, 1, 1, 2), items=items), to, (name,))
    if isinstance(value, Unread):
        return next((finding.message for finding in findings), f"`{short(text)}` is no tolerance")
    return value


def table() -> list[list[str]]:
    """All tolerances for people: name, default, and what they are for."""
    rows = []
    for name, quantity in QUANTITIES.items():
        default = " or ".join(ToleranceKind(quantity.dimension).show(quantity.default))
        rows.append([name, default, quantity.what])
    return rows

"""Numbers with a unit, alone and in lists."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

from gcodesim.declarations.kind import ANY, Json, Kind, Range, key_name, listing, scalar, short
from gcodesim.declarations.nodes import Node, Scalar
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.scalars import Measured, measured, why_no_number
from gcodesim.declarations.units import DIMENSIONS, Unit, find, in_unit, measures, names, nearest, shown
from gcodesim.frozen import frozen

LAST_UNIT_HOLDS: Final = "the unit of the last entry holds for those without one"
_NUMBER_PATTERN = r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?"
_UNIT_PATTERN = r"[^0-9.eE+\-\s].*"


@frozen(kw_only=False)
class Quantity(Kind):
    """A number with a unit of `dimension`; in SI. `example` is a value that makes sense for the key."""

    dimension: str
    range: Range = ANY
    example: str = ""

    @property
    def expected(self) -> str:
        d = DIMENSIONS[self.dimension]
        return f"{d} such as `{self.example or d.example}`"

    def read(self, node: Node, to: Reading, path: Path) -> float | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        number = self.number(text, to, path)
        return UNREAD if isinstance(number, Unread) else self.in_si(number, None, text, to, path)

    def number(self, node: Scalar, to: Reading, path: Path) -> Measured | Unread:
        """Number and unit text of a scalar."""
        number = measured(node.text)
        if number is None:
            message = f"`{key_name(path)}` is `{short(node.text)}`; {self.expected} is expected"
            return to.fault("GS707", node.span, message, why_no_number(node.text))
        if not math.isfinite(number.value):
            return to.fault("GS707", node.span, f"`{key_name(path)}` is `{short(node.text)}`, too large a number")
        return number

    def in_si(self, number: Measured, inherited: Unit | None, node: Scalar, to: Reading, path: Path) -> float | Unread:
        """SI value; `inherited` is the unit of the last entry of the list."""
        unit = self._unit(number, inherited, node, to, path)
        if isinstance(unit, Unread):
            return UNREAD
        value = number.value * unit.factor + unit.offset if unit is not None else number.value
        if not math.isfinite(value):
            return to.fault("GS707", node.span, f"`{key_name(path)}` is `{short(node.text)}`, too large a number")
        broken = self.range.broken(value)
        if broken is not None:
            has_unit = broken[1] or not DIMENSIONS[self.dimension].zero
            bound = f"{broken[0]} {shown(broken[1], self.dimension) if has_unit else 0}"
            return to.fault("GS710", node.span, f"`{key_name(path)}` is {node.text.strip()}; it must be {bound}")
        return value + 0.0

    def _unit(
        self, number: Measured, inherited: Unit | None, node: Scalar, to: Reading, path: Path
    ) -> Unit | Unread | None:
        d = DIMENSIONS[self.dimension]
        if number.unit:
            unit = find(number.unit, self.dimension)
            return unit if unit is not None else self._wrong_unit(number, node, to, path)
        unit = inherited or to.plain.of(self.dimension)
        if unit is not None or d.plain or (d.zero and number.value == 0.0):
            return unit
        return self.without_unit(node, to, path)

    def without_unit(self, node: Scalar, to: Reading, path: Path, rule: str = "") -> Unread:
        """The finding for a number that needs a unit and has none."""
        d = DIMENSIONS[self.dimension]
        units = ", ".join(names(self.dimension))
        return to.fault(
            "GS708",
            node.span,
            f"`{key_name(path)}` is {node.text.strip()} without a unit; {d} carries its unit",
            f"write for example `{node.text.strip()} {d.shown}`; {rule or f'units are {units}'}",
        )

    def _wrong_unit(self, number: Measured, node: Scalar, to: Reading, path: Path) -> Unread:
        d = DIMENSIONS[self.dimension]
        units = names(self.dimension)
        other = measures(number.unit)
        if other:
            what = " or ".join(dict.fromkeys(str(DIMENSIONS[name]) for name in other))
            return to.fault(
                "GS709",
                node.span,
                f"`{key_name(path)}` is {node.text.strip()}, {what}; {self.expected} is expected",
                f"units of {d}: {', '.join(units)}" if units else "write the number alone",
            )
        guess = nearest(number.unit, self.dimension)
        hint = f"did you mean `{guess}`? " if guess else ""
        return to.fault(
            "GS709",
            node.span,
            f"`{key_name(path)}` is {short(node.text)}: `{short(number.unit)}` is no unit of {d}",
            f"{hint}units of {d}: {', '.join(units)}" if units else "write the number alone",
        )

    def schema(self, definitions: dict[str, Json]) -> Json:
        d = DIMENSIONS[self.dimension]
        name = self.dimension.replace(" ", "_")
        text = {
            "type": "string",
            "pattern": rf"^\s*{_NUMBER_PATTERN}\s*{f'({_UNIT_PATTERN})?' if d.plain else _UNIT_PATTERN}$",
            "description": f"{d} with its unit: {', '.join(names(self.dimension))}",
            "examples": [d.example],
        }
        alone = [{"type": "number"}] if d.plain else [{"const": 0}] if d.zero else []
        definitions.setdefault(name, {"anyOf": [*alone, text]})
        return {"$ref": f"#/$defs/{name}"}

    def show(self, value: Any) -> Any:
        return "none" if value is None or math.isinf(value) else shown(value, self.dimension)

    def plain(self, value: Any) -> tuple[str, Any]:
        d = DIMENSIONS[self.dimension]
        unit = find(d.shown, self.dimension) if d.shown else None
        suffix = f"_{d.suffix}" if d.suffix else ""
        if value is None or not math.isfinite(value):
            return suffix, None
        return suffix, in_unit(value, unit) if unit is not None else value


@frozen(kw_only=False)
class Vector(Kind):
    """A list of quantities; the unit of the last entry holds for those without one."""

    of: Quantity
    count: int | None = None
    example: str = ""

    @property
    def expected(self) -> str:
        d = DIMENSIONS[self.of.dimension]
        example = self.example or f"[{self._example()}]"
        return f"a list of {f'{self.count} ' if self.count else ''}{d.name}s such as `{example}`"

    def _example(self) -> str:
        number, _, unit = DIMENSIONS[self.of.dimension].example.partition(" ")
        count = self.count or 3
        return ", ".join([number] * (count - 1) + [f"{number} {unit}".strip()])

    def read(self, node: Node, to: Reading, path: Path) -> tuple[float, ...] | Unread:
        items = listing(self, node, to, path, self.count)
        if isinstance(items, Unread):
            return UNREAD
        parts: list[tuple[Scalar, Measured | Unread, Path]] = []
        for index, item in enumerate(items):
            text = scalar(self.of, item, to, (*path, index))
            if not isinstance(text, Unread):
                parts.append((text, self.of.number(text, to, (*path, index)), (*path, index)))
        inherited = last_unit(parts, (self.of.dimension,))
        if inherited is None and lacks_unit(parts, [self.of]):
            text, _, at = parts[-1]
            self.of.without_unit(text, to, at, LAST_UNIT_HOLDS)
            return UNREAD
        values = [
            UNREAD if isinstance(number, Unread) else self.of.in_si(number, inherited, text, to, at)
            for text, number, at in parts
        ]
        good = tuple(value for value in values if not isinstance(value, Unread))
        return good if len(good) == len(items) else UNREAD

    def schema(self, definitions: dict[str, Json]) -> Json:
        bounds = {"minItems": self.count, "maxItems": self.count} if self.count else {"minItems": 1}
        # a number of any dimension is allowed in a list whose last entry has the unit
        return {"type": "array", "items": {"anyOf": [{"type": "number"}, self.of.schema(definitions)]}, **bounds}

    def show(self, value: Any) -> Any:
        return [self.of.show(entry) for entry in value]

    def plain(self, value: Any) -> tuple[str, Any]:
        suffix = self.of.plain(0.0)[0]
        return suffix, [self.of.plain(entry)[1] for entry in value]


def lacks_unit(parts: Sequence[tuple[Scalar, Measured | Unread, Path]], quantities: Sequence[Quantity]) -> bool:
    """Whether units are needed and nowhere written in a list, so that one finding says it for all entries."""
    if all(DIMENSIONS[quantity.dimension].plain for quantity in quantities):
        return False
    numbers = [number for _, number, _ in parts if not isinstance(number, Unread)]
    return any(number.value for number in numbers) and not any(number.unit for number in numbers)


def last_unit(parts: Sequence[tuple[Scalar, Measured | Unread, Path]], dimensions: Sequence[str]) -> Unit | None:
    """The unit of the last entry of a list, when it has one of these dimensions."""
    if not parts or isinstance(parts[-1][1], Unread):
        return None
    found = (find(parts[-1][1].unit, dimension) for dimension in dimensions)
    return next((unit for unit in found if unit is not None), None)

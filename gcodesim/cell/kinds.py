"""Kinds of values: what a key of the cell expects, how it is read, checked, described and shown.

A kind turns a node into an SI value, or into FAULT after it has added the
finding. The JSON Schema and `cell show` come from the same kinds, so the three
cannot differ.
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from gcodesim.cell.nodes import Listing, Mapping, Node, Scalar
from gcodesim.cell.reading import FAULT, Fault, Path, Reading, suggestion
from gcodesim.cell.scalars import Measured, integer, measured, switch, why_no_number, why_no_switch
from gcodesim.cell.units import DIMENSIONS, Unit, find, in_unit, measures, names, nearest, shown

Json = dict[str, Any]

LAST_UNIT_HOLDS: Final = "the unit of the last entry holds for those without one"
_NUMBER_PATTERN = r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?"
_UNIT_PATTERN = r"[^0-9.eE+\-\s].*"


class Kind(ABC):
    """What a key expects."""

    @property
    @abstractmethod
    def expected(self) -> str:
        """In words, with an example."""

    @abstractmethod
    def read(self, node: Node, to: Reading, path: Path) -> Any:
        """The value in SI, or FAULT."""

    @abstractmethod
    def schema(self, definitions: dict[str, Json]) -> Json:
        """JSON Schema of what may be written; shared parts go to `definitions`."""

    def show(self, value: Any) -> Any:
        """The value for people: text, number, or lists and mappings of them."""
        return value

    def plain(self, value: Any) -> tuple[str, Any]:
        """For JSON: a suffix of the key that names the unit, and the value in that unit."""
        return "", value


def article_of(node: Node) -> str:
    """What a node is, in words."""
    if isinstance(node, Mapping):
        return "a mapping"
    if isinstance(node, Listing):
        return "a list"
    return "nothing" if node.empty else f"`{short(node.text)}`"


def short(text: str) -> str:
    """A text for a message: one line, not too long."""
    text = " ".join(text.split())
    return text if len(text) <= 40 else text[:39] + "…"


def key_name(path: Path) -> str:
    """The key that a message is about."""
    names_only = [part for part in path if isinstance(part, str)]
    return names_only[-1] if names_only else str(path[-1]) if path else "cell"


def scalar(kind: Kind, node: Node, to: Reading, path: Path) -> Scalar | Fault:
    """`node` as a scalar with something in it."""
    if not isinstance(node, Scalar):
        return to.fault("GS706", node.span, f"`{key_name(path)}` is {article_of(node)}; {kind.expected} is expected")
    if node.empty:
        return to.fault("GS705", to.span(path), f"`{key_name(path)}` has no value; {kind.expected} is expected")
    to.spans[path] = node.span
    return node


@dataclass(frozen=True, slots=True, kw_only=True)
class Range:
    """Bounds in SI; `above` and `below` are exclusive."""

    least: float | None = None
    most: float | None = None
    above: float | None = None
    below: float | None = None

    def broken(self, value: float) -> tuple[str, float] | None:
        """The bound that `value` breaks, in words, and its number."""
        if self.above is not None and not value > self.above:
            return "greater than", self.above
        if self.least is not None and value < self.least:
            return "at least", self.least
        if self.below is not None and not value < self.below:
            return "less than", self.below
        if self.most is not None and value > self.most:
            return "at most", self.most
        return None

    def schema(self) -> Json:
        pairs = {
            "exclusiveMinimum": self.above,
            "minimum": self.least,
            "exclusiveMaximum": self.below,
            "maximum": self.most,
        }
        return {key: bound for key, bound in pairs.items() if bound is not None}


ANY = Range()
POSITIVE = Range(above=0.0)
NOT_NEGATIVE = Range(least=0.0)
WITHIN_REACH = Range(least=-1e4, most=1e4)  # m; nothing of a cell is ten kilometres away, and squares must not overflow


@dataclass(frozen=True, slots=True)
class Quantity(Kind):
    """A number with a unit of `dimension`; in SI."""

    dimension: str
    range: Range = ANY

    @property
    def expected(self) -> str:
        d = DIMENSIONS[self.dimension]
        return f"{d} such as `{d.example}`"

    def read(self, node: Node, to: Reading, path: Path) -> float | Fault:
        text = scalar(self, node, to, path)
        if isinstance(text, Fault):
            return FAULT
        number = self.number(text, to, path)
        return FAULT if isinstance(number, Fault) else self.in_si(number, None, text, to, path)

    def number(self, node: Scalar, to: Reading, path: Path) -> Measured | Fault:
        """Number and unit text of a scalar."""
        number = measured(node.text)
        if number is None:
            message = f"`{key_name(path)}` is `{short(node.text)}`; {self.expected} is expected"
            return to.fault("GS707", node.span, message, why_no_number(node.text))
        if not math.isfinite(number.value):
            return to.fault("GS707", node.span, f"`{key_name(path)}` is `{short(node.text)}`, too large a number")
        return number

    def in_si(self, number: Measured, inherited: Unit | None, node: Scalar, to: Reading, path: Path) -> float | Fault:
        """SI value; `inherited` is the unit of the last entry of the list."""
        unit = self._unit(number, inherited, node, to, path)
        if isinstance(unit, Fault):
            return FAULT
        value = number.value * unit.factor if unit is not None else number.value
        if not math.isfinite(value):
            return to.fault("GS707", node.span, f"`{key_name(path)}` is `{short(node.text)}`, too large a number")
        broken = self.range.broken(value)
        if broken is not None:
            bound = f"{broken[0]} {shown(broken[1], self.dimension) if broken[1] else 0}"
            return to.fault("GS710", node.span, f"`{key_name(path)}` is {node.text.strip()}; it must be {bound}")
        return value + 0.0

    def _unit(
        self, number: Measured, inherited: Unit | None, node: Scalar, to: Reading, path: Path
    ) -> Unit | Fault | None:
        d = DIMENSIONS[self.dimension]
        if number.unit:
            unit = find(number.unit, self.dimension)
            return unit if unit is not None else self._wrong_unit(number, node, to, path)
        unit = inherited or to.plain.of(self.dimension)
        if unit is not None or d.plain or number.value == 0.0:
            return unit
        return self.without_unit(node, to, path)

    def without_unit(self, node: Scalar, to: Reading, path: Path, rule: str = "") -> Fault:
        """The finding for a number that needs a unit and has none."""
        d = DIMENSIONS[self.dimension]
        units = ", ".join(names(self.dimension))
        return to.fault(
            "GS708",
            node.span,
            f"`{key_name(path)}` is {node.text.strip()} without a unit; {d} carries its unit",
            f"write for example `{node.text.strip()} {d.shown}`; {rule or f'units are {units}'}",
        )

    def _wrong_unit(self, number: Measured, node: Scalar, to: Reading, path: Path) -> Fault:
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
        definitions.setdefault(name, {"anyOf": [{"type": "number"} if d.plain else {"const": 0}, text]})
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


@dataclass(frozen=True, slots=True)
class Vector(Kind):
    """A list of quantities; the unit of the last entry holds for those without one."""

    of: Quantity
    count: int | None = None

    @property
    def expected(self) -> str:
        d = DIMENSIONS[self.of.dimension]
        return f"a list of {f'{self.count} ' if self.count else ''}{d.name}s such as `[{self._example()}]`"

    def _example(self) -> str:
        number, _, unit = DIMENSIONS[self.of.dimension].example.partition(" ")
        count = self.count or 3
        return ", ".join([number] * (count - 1) + [f"{number} {unit}".strip()])

    def read(self, node: Node, to: Reading, path: Path) -> tuple[float, ...] | Fault:
        items = listing(self, node, to, path, self.count)
        if isinstance(items, Fault):
            return FAULT
        parts: list[tuple[Scalar, Measured | Fault, Path]] = []
        for index, item in enumerate(items):
            text = scalar(self.of, item, to, (*path, index))
            if not isinstance(text, Fault):
                parts.append((text, self.of.number(text, to, (*path, index)), (*path, index)))
        inherited = last_unit(parts, (self.of.dimension,))
        if inherited is None and lacks_unit(parts, [self.of]):
            text, _, at = parts[-1]
            self.of.without_unit(text, to, at, LAST_UNIT_HOLDS)
            return FAULT
        values = [
            FAULT if isinstance(number, Fault) else self.of.in_si(number, inherited, text, to, at)
            for text, number, at in parts
        ]
        good = tuple(value for value in values if not isinstance(value, Fault))
        return good if len(good) == len(items) else FAULT

    def schema(self, definitions: dict[str, Json]) -> Json:
        bounds = {"minItems": self.count, "maxItems": self.count} if self.count else {"minItems": 1}
        # a number of any dimension is allowed in a list whose last entry has the unit
        return {"type": "array", "items": {"anyOf": [{"type": "number"}, self.of.schema(definitions)]}, **bounds}

    def show(self, value: Any) -> Any:
        return [self.of.show(entry) for entry in value]

    def plain(self, value: Any) -> tuple[str, Any]:
        suffix = self.of.plain(0.0)[0]
        return suffix, [self.of.plain(entry)[1] for entry in value]


def lacks_unit(parts: Sequence[tuple[Scalar, Measured | Fault, Path]], quantities: Sequence[Quantity]) -> bool:
    """Whether units are needed and nowhere written in a list, so that one finding says it for all entries."""
    if all(DIMENSIONS[quantity.dimension].plain for quantity in quantities):
        return False
    numbers = [number for _, number, _ in parts if not isinstance(number, Fault)]
    return any(number.value for number in numbers) and not any(number.unit for number in numbers)


def last_unit(parts: Sequence[tuple[Scalar, Measured | Fault, Path]], dimensions: Sequence[str]) -> Unit | None:
    """The unit of the last entry of a list, when it has one of these dimensions."""
    if not parts or isinstance(parts[-1][1], Fault):
        return None
    found = (find(parts[-1][1].unit, dimension) for dimension in dimensions)
    return next((unit for unit in found if unit is not None), None)


def listing(kind: Kind, node: Node, to: Reading, path: Path, count: int | None = None) -> tuple[Node, ...] | Fault:
    """The items of a list with `count` entries (None: any number above 0)."""
    if not isinstance(node, Listing):
        what = "has no value" if isinstance(node, Scalar) and node.empty else f"is {article_of(node)}"
        return to.fault(
            "GS706",
            node.span if what != "has no value" else to.span(path),
            f"`{key_name(path)}` {what}; {kind.expected} is expected",
        )
    to.spans[path] = node.span
    if (count is not None and len(node.items) != count) or not node.items:
        entries = "entry" if len(node.items) == 1 else "entries"
        return to.fault(
            "GS706", node.span, f"`{key_name(path)}` has {len(node.items)} {entries}; {kind.expected} is expected"
        )
    return node.items


@dataclass(frozen=True, slots=True)
class Whole(Kind):
    """A whole number."""

    range: Range = ANY

    @property
    def expected(self) -> str:
        return "a whole number"

    def read(self, node: Node, to: Reading, path: Path) -> int | Fault:
        text = scalar(self, node, to, path)
        if isinstance(text, Fault):
            return FAULT
        value = integer(text.text)
        if value is None:
            message = f"`{key_name(path)}` is `{short(text.text)}`; a whole number is expected"
            return to.fault("GS707", text.span, message, why_no_number(text.text))
        broken = self.range.broken(value)
        if broken is not None:
            return to.fault("GS710", text.span, f"`{key_name(path)}` is {value}; it must be {broken[0]} {broken[1]:g}")
        return value

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "integer", **{key: int(bound) for key, bound in self.range.schema().items()}}


@dataclass(frozen=True, slots=True)
class Switch(Kind):
    """`true` or `false`."""

    @property
    def expected(self) -> str:
        return "`true` or `false`"

    def read(self, node: Node, to: Reading, path: Path) -> bool | Fault:
        text = scalar(self, node, to, path)
        if isinstance(text, Fault):
            return FAULT
        value = switch(text.text)
        if value is None:
            message = f"`{key_name(path)}` is `{short(text.text)}`; {self.expected} is expected"
            return to.fault("GS706", text.span, message, why_no_switch(text.text))
        return value

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "boolean"}


@dataclass(frozen=True, slots=True)
class Text(Kind):
    """Any text; with `pattern` one of a certain form, which `form` describes."""

    pattern: str = ""
    form: str = "a text"

    @property
    def expected(self) -> str:
        return self.form

    def read(self, node: Node, to: Reading, path: Path) -> str | Fault:
        text = scalar(self, node, to, path)
        if isinstance(text, Fault):
            return FAULT
        if self.pattern and not re.fullmatch(self.pattern, text.text):
            message = f"`{key_name(path)}` is `{short(text.text)}`; {self.form} is expected"
            return to.fault("GS711", text.span, message)
        return text.text

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", **({"pattern": f"^({self.pattern})$"} if self.pattern else {})}


@dataclass(frozen=True, slots=True)
class Choice(Kind):
    """One of a few words."""

    words: tuple[str, ...]
    what: str = "one"

    @property
    def expected(self) -> str:
        return f"{self.what} of {', '.join(f'`{word}`' for word in self.words)}"

    def read(self, node: Node, to: Reading, path: Path) -> str | Fault:
        text = scalar(self, node, to, path)
        if isinstance(text, Fault):
            return FAULT
        if text.text not in self.words:
            return to.fault(
                "GS711",
                text.span,
                f"`{key_name(path)}` cannot be `{short(text.text)}`",
                suggestion(text.text, self.words),
            )
        return text.text

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"enum": list(self.words)}


@dataclass(frozen=True, slots=True)
class ListOf(Kind):
    """A list of values of one kind; a single value may stand without brackets."""

    of: Kind
    single: bool = False

    @property
    def expected(self) -> str:
        return f"a list; {self.of.expected} each"

    def read(self, node: Node, to: Reading, path: Path) -> tuple[Any, ...] | Fault:
        if self.single and isinstance(node, Scalar) and not node.empty:
            value = self.of.read(node, to, (*path, 0))
            return FAULT if isinstance(value, Fault) else (value,)
        if isinstance(node, Listing) and not node.items:
            to.spans[path] = node.span
            return ()
        items = listing(self, node, to, path)
        if isinstance(items, Fault):
            return FAULT
        values = [self.of.read(item, to, (*path, index)) for index, item in enumerate(items)]
        return FAULT if any(isinstance(value, Fault) for value in values) else tuple(values)

    def schema(self, definitions: dict[str, Json]) -> Json:
        many = {"type": "array", "items": self.of.schema(definitions)}
        return {"anyOf": [self.of.schema(definitions), many]} if self.single else many

    def show(self, value: Any) -> Any:
        return [self.of.show(entry) for entry in value]

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", [self.of.plain(entry)[1] for entry in value]


@dataclass(frozen=True, slots=True)
class Either(Kind):
    """One of a few words that mean a fixed value, else the value of another kind."""

    words: tuple[tuple[str, Any], ...]
    other: Kind

    @property
    def expected(self) -> str:
        return f"{', '.join(f'`{word}`' for word, _ in self.words)} or {self.other.expected}"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        if isinstance(node, Scalar):
            for word, value in self.words:
                if node.text == word:
                    to.spans[path] = node.span
                    return value
        if isinstance(node, Scalar) and not node.empty and measured(node.text) is None:
            hint = suggestion(node.text, [word for word, _ in self.words])
            message = f"`{key_name(path)}` is `{short(node.text)}`; {self.expected} is expected"
            return to.fault("GS707", node.span, message, why_no_number(node.text) or hint)
        return self.other.read(node, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"anyOf": [{"enum": [word for word, _ in self.words]}, self.other.schema(definitions)]}

    def show(self, value: Any) -> Any:
        return next((word for word, meaning in self.words if _same(meaning, value)), None) or self.other.show(value)

    def plain(self, value: Any) -> tuple[str, Any]:
        if any(_same(meaning, value) for _, meaning in self.words):
            return self.other.plain(0.0)[0] if isinstance(self.other, Quantity) else "", self.show(value)
        return self.other.plain(value)


def _same(meaning: Any, value: Any) -> bool:
    return type(meaning) is type(value) and bool(meaning == value)

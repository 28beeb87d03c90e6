"""What varies in a study: a key of the cell, a parameter of the program, the program or the cell itself."""

from __future__ import annotations

import math
from typing import Any, Final, Literal

from gcodesim.declarations.deep_value import path_of
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Json, Kind, Range, listing, scalar, short
from gcodesim.declarations.map_of import MapOf, NameRule
from gcodesim.declarations.nodes import Listing, Mapping, Node, Scalar
from gcodesim.declarations.plain_kinds import Switch, Text, Whole
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.declarations.scalars import Measured, measured, why_no_number
from gcodesim.declarations.units import normal
from gcodesim.frozen import frozen
from gcodesim.rs274.presets import Parameter, as_written, parameter_of

PROGRAM: Final = "program"
CELL: Final = "cell"
_DIGITS: Final = 12  # of numbers between two ends: their last bits would tell of the way they were computed

Target = Literal["key", "parameter", "program", "cell"]


@frozen(kw_only=False)
class KeyPath(Kind):
    """The path of a key of the cell."""

    @property
    def expected(self) -> str:
        return "the path of a key of the cell such as `tools.1.diameter`"

    def read(self, node: Node, to: Reading, path: Path) -> tuple[str, ...] | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        found = path_of(text.text)
        if found is None:
            return to.fault("GS711", text.span, f"`{short(text.text)}` is no path; {self.expected} is expected")
        return found

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "examples": ["tools.1.diameter", "fixtures.vise.at"]}

    def show(self, value: Any) -> Any:
        return ".".join(value)


@frozen(kw_only=False)
class ParameterName(Kind):
    """A parameter of the program."""

    @property
    def expected(self) -> str:
        return "a parameter such as `100`, `depth` or, in quotes, `'#<depth>'`"

    def read(self, node: Node, to: Reading, path: Path) -> Parameter | Unread:
        if isinstance(node, Scalar) and node.empty:
            hint = "a `#` begins a comment in YAML: write the name alone, or quotes around it"
            return to.fault("GS705", to.span(path), f"`parameter` has no value; {self.expected} is expected", hint)
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        found = parameter_of(text.text)
        if found is None:
            return to.fault("GS711", text.span, f"`{short(text.text)}` is no parameter; {self.expected} is expected")
        return found

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"anyOf": [{"type": "integer", "minimum": 1}, {"type": "string"}]}

    def show(self, value: Any) -> Any:
        return as_written(value)


@frozen(kw_only=False)
class RangeEnd(Kind):
    """One end of a range: a number with any unit."""

    @property
    def expected(self) -> str:
        return "a number, with the unit of what varies, such as `6 mm`"

    def read(self, node: Node, to: Reading, path: Path) -> Measured | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        number = measured(text.text)
        if number is None or not math.isfinite(number.value):
            message = f"`{path[-1]}` is `{short(text.text)}`; {self.expected} is expected"
            return to.fault("GS707", text.span, message, why_no_number(text.text))
        return number

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": ["number", "string"]}

    def show(self, value: Any) -> Any:
        return f"{value.value:g} {value.unit}".strip()


@frozen(kw_only=False)
class Levels(Kind):
    """The values of a factor as they stand: numbers, names, or lists and mappings as the cell has them."""

    @property
    def expected(self) -> str:
        return "a list of values such as `[6 mm, 8 mm]`"

    def read(self, node: Node, to: Reading, path: Path) -> tuple[Node, ...] | Unread:
        return listing(self, node, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "array", "minItems": 1}

    def show(self, value: Any) -> Any:
        return [text_of(node) for node in value]


@frozen
class FactorKeys:
    """What varies, and which values it takes."""

    cell_key: tuple[str, ...] | None = key(
        KeyPath(), "key of the cell; without `key` and `parameter` the name", name="key", default=None
    )
    parameter: Parameter | None = key(
        ParameterName(), "parameter of the program, set before it begins, in its units", default=None
    )
    values: tuple[Node, ...] | None = key(Levels(), "its values one by one; the last unit holds for all", default=None)
    low: Measured | None = key(RangeEnd(), "where its range begins", name="from", default=None)
    high: Measured | None = key(RangeEnd(), "where its range ends", name="to", default=None)
    steps: int | None = key(
        Whole(Range(least=2.0, most=1e6)), "values of the range in a grid, ends included", default=None
    )
    whole: bool = key(Switch(), "only whole numbers of the range", default=False, quiet=True)
    column: str | None = key(Text(), "its column in the `table`; without values the name", default=None)

    def checked(self, to: Reading, path: Path) -> FactorKeys | Unread:
        at = to.span(path)
        name = path[-1]
        if self.cell_key is not None and self.parameter is not None:
            return to.fault("GS711", at, f"`{name}` is both a `key` of the cell and a `parameter`", "keep one of them")
        if (self.low is None) != (self.high is None):
            return to.fault("GS705", at, f"the range of `{name}` has one end", "a range has `from` and `to`")
        ways = [self.values is not None, self.low is not None, self.column is not None]
        if sum(ways) > 1:
            return to.fault("GS711", at, f"`{name}` has more than one of `values`, `from` and `to`, `column`")
        if self.low is not None and self.high is not None:
            return self._range(to, path, self.low, self.high)
        if self.steps is not None or self.whole:
            return to.fault("GS711", at, f"`{name}` has no range", "`steps` and `whole` go with `from` and `to`")
        return self

    def _range(self, to: Reading, path: Path, low: Measured, high: Measured) -> FactorKeys | Unread:
        units = [unit for unit in (low.unit, high.unit) if unit]
        if len({normal(unit) for unit in units}) > 1:
            message = f"the ends of `{path[-1]}` have two units, {low.unit} and {high.unit}"
            return to.fault("GS709", to.span(path), message, "write both in one unit")
        if not low.value < high.value:
            message = f"the range of `{path[-1]}` ends at {high.value:g}, not above its beginning {low.value:g}"
            return to.fault("GS710", to.span(path), message)
        return self


@frozen
class Factor:
    """One factor of a study. `levels` are its values where they are listed or come from a table, else it has a range.

    `unit` is that of its numbers as written, empty where it has none; `numeric` whether all values are numbers.
    """

    name: str
    target: Target
    path: tuple[str, ...] = ()
    parameter: Parameter = 0
    levels: tuple[Node, ...] | None = None
    low: float = 0.0
    high: float = 0.0
    steps: int | None = None
    whole: bool = False
    column: str | None = None
    unit: str = ""
    numeric: bool = True

    @property
    def heading(self) -> str:
        """The column of tables: the name, with the unit of its numbers."""
        unit = normal(self.unit).replace("%", "percent").replace("·", "").replace("^", "").replace("/", "_")
        return f"{self.name}_{unit}" if unit and self.numeric else self.name

    def between(self, share: float) -> float:
        """The value at a share 0 to 1 of the range."""
        value = self.low + share * (self.high - self.low)
        if self.whole:
            return float(min(math.floor(self.low + share * (self.high - self.low + 1.0)), math.floor(self.high)))
        return float(f"{min(max(value, self.low), self.high):.{_DIGITS}g}")

    def text(self, number: float) -> str:
        """A number of this factor as a cell writes it."""
        shown = repr(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)
        return f"{shown} {self.unit}".strip()


@frozen(kw_only=False)
class FactorKind(Kind):
    """A factor: a list of values, or a mapping that says more."""

    @property
    def expected(self) -> str:
        return "a list of values, or a mapping such as `{key: tools.1.diameter, from: 6 mm, to: 12 mm, steps: 4}`"

    def read(self, node: Node, to: Reading, path: Path) -> Factor | Unread:
        name = str(path[-1])
        if isinstance(node, Listing):
            values = Levels().read(node, to, (*path, "values"))
            keys: Any = UNREAD if isinstance(values, Unread) else FactorKeys(values=values)
        elif isinstance(node, Mapping):
            keys = Record(FactorKeys, f"the factor `{name}`").read(node, to, path)
        else:
            return to.fault("GS706", node.span, f"`{name}` takes {self.expected}")
        return UNREAD if isinstance(keys, Unread) else factor_of(name, keys, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"anyOf": [Levels().schema(definitions), Record(FactorKeys, "the factor").schema(definitions)]}


def factor_of(name: str, keys: FactorKeys, to: Reading, path: Path) -> Factor | Unread:
    """The factor `name` from what is said about it."""
    target, key_path, parameter = _target(name, keys)
    if target == "key" and not key_path:
        return to.fault("GS711", to.key(path), f"`{name}` is no path of a key; say what varies by `key` or `parameter`")
    if target in (PROGRAM, CELL) and keys.low is not None:
        return to.fault("GS706", to.span(path), f"`{name}` is a file, which has no range; list its `values`")
    common: dict[str, Any] = {"name": name, "target": target, "path": key_path, "parameter": parameter}
    if keys.low is not None and keys.high is not None:
        unit = keys.low.unit or keys.high.unit
        if target == "parameter" and unit:
            return _no_unit(name, unit, to, path)
        return Factor(**common, low=keys.low.value, high=keys.high.value, steps=keys.steps, whole=keys.whole, unit=unit)
    if keys.values is None:
        return Factor(**common, column=keys.column or name)
    return with_levels(Factor(**common), keys.values, to, path)


def with_levels(factor: Factor, nodes: tuple[Node, ...], to: Reading, path: Path) -> Factor | Unread:
    """`factor` with these values; numbers of a list take the unit of the last one, as everywhere."""
    from dataclasses import replace

    numbers = [_number(node) for node in nodes]
    if factor.target in (PROGRAM, CELL) or any(number is None for number in numbers):
        if factor.target == "parameter":
            bad = next(node for node, number in zip(nodes, numbers, strict=True) if number is None)
            return to.fault("GS707", bad.span, f"`{factor.name}` is a parameter, whose values are numbers")
        return replace(factor, levels=nodes, column=None, numeric=False)
    known = [number for number in numbers if number is not None]
    units = {normal(number.unit) for number in known if number.unit}
    if len(units) > 1:
        message = f"the values of `{factor.name}` have {len(units)} units: {', '.join(sorted(units))}"
        return to.fault("GS709", to.span(path), message, "write all of them in one unit, so that a table can hold them")
    unit = next((number.unit for number in known if number.unit), "")
    if factor.target == "parameter" and unit:
        return _no_unit(factor.name, unit, to, path)
    factor = replace(factor, levels=nodes, column=None, unit=unit)
    texts = tuple(
        Scalar(span=node.span, text=factor.text(number.value)) for node, number in zip(nodes, known, strict=True)
    )
    return replace(factor, levels=texts)


def _target(name: str, keys: FactorKeys) -> tuple[Target, tuple[str, ...], Parameter]:
    if keys.parameter is not None:
        return "parameter", (), keys.parameter
    if keys.cell_key is not None:
        return "key", keys.cell_key, 0
    if name == PROGRAM:
        return PROGRAM, (), 0
    if name == CELL:
        return CELL, (), 0
    if name.startswith("#") and (parameter := parameter_of(name)) is not None:
        return "parameter", (), parameter
    return "key", path_of(name) or (), 0


def _no_unit(name: str, unit: str, to: Reading, path: Path) -> Unread:
    message = f"`{name}` is a parameter of the program and has the unit `{short(unit)}`"
    return to.fault("GS709", to.span(path), message, "parameters are plain numbers in the units of the program")


def _number(node: Node) -> Measured | None:
    number = measured(node.text) if isinstance(node, Scalar) else None
    return number if number is not None and math.isfinite(number.value) else None


def text_of(node: Node) -> str:
    """A value as one line, for tables."""
    if isinstance(node, Scalar):
        return node.text
    if isinstance(node, Listing):
        return f"[{', '.join(map(text_of, node.items))}]"
    return "{" + ", ".join(f"{name.text}: {text_of(value)}" for name, value in node.entries) + "}"


def _factor_name(text: str) -> str | None:
    return text.strip() or None


FACTORS: Final = MapOf(
    NameRule(what="a name of a factor", pattern=".+", canonical=_factor_name),
    FactorKind(),
    "factors by name, such as `diameter: {key: tools.1.diameter, values: [6 mm, 8 mm]}`",
)

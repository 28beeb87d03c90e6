"""Values of joints and axes in one list or mapping, where each may be a length or an angle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, Literal

from gcodesim.declarations.kind import Json, Kind, listing, scalar
from gcodesim.declarations.nodes import Mapping, Node, Scalar
from gcodesim.declarations.quantity import LAST_UNIT_HOLDS, Quantity, lacks_unit, last_unit
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.declarations.record import FREE
from gcodesim.declarations.scalars import Measured, measured
from gcodesim.declarations.units import shown
from gcodesim.frozen import frozen

Measure = Literal["length", "angle"]
POSITIONS: Final = ("length", "angle")
STIFFNESSES: Final = ("stiffness", "torsional stiffness")
SPEEDS: Final = ("speed", "angular speed")
ACCELERATIONS: Final = ("acceleration", "angular acceleration")
JERKS: Final = ("jerk", "angular jerk")


@frozen
class JointValue:
    """A number as written; what it measures is only known once the machine is."""

    node: Scalar
    number: Measured
    path: Path


@frozen
class JointList(Kind):
    """One value a joint, `[0, -90, 90, 0, 90, 0]`, of one of `dimensions`.

    With `letters` also `{X: 0, Z: -10}`; with `names` also the name of a pose, which is read as its text.
    """

    dimensions: tuple[str, ...] = POSITIONS
    letters: bool = False
    names: bool = False
    example: str = "[0, -90, 90, 0, 90, 0]"

    @property
    def expected(self) -> str:
        named = ", or the name of a pose" if self.names else ""
        return f"one value {'an axis' if self.letters else 'a joint'}, such as `{self.example}`{named}"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        if self.letters and isinstance(node, Mapping):
            return self._by_letter(node, to, path)
        if self.names and isinstance(node, Scalar) and not node.empty and measured(node.text) is None:
            to.spans[path] = node.span
            return node.text
        items = listing(self, node, to, path)
        if isinstance(items, Unread):
            return UNREAD
        values = [self._value(item, to, (*path, index)) for index, item in enumerate(items)]
        good = tuple(value for value in values if not isinstance(value, Unread))
        return good if len(good) == len(values) else UNREAD

    def _value(self, node: Node, to: Reading, path: Path) -> JointValue | Unread:
        quantity = Quantity(self.dimensions[-1])
        text = scalar(quantity, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        number = quantity.number(text, to, path)
        return UNREAD if isinstance(number, Unread) else JointValue(node=text, number=number, path=path)

    def _by_letter(self, node: Mapping, to: Reading, path: Path) -> Any:
        values: dict[str, JointValue | Unread] = {}
        for name, value in node.entries:
            if name.text.startswith(FREE):
                continue
            letter = name.text.upper()
            to.named((*path, letter), name.span)
            values[letter] = self._value(value, to, (*path, letter))
        return UNREAD if any(value is UNREAD for value in values.values()) else values

    def schema(self, definitions: dict[str, Json]) -> Json:
        value = {"anyOf": [{"type": "number"}, *(Quantity(name).schema(definitions) for name in self.dimensions)]}
        many = {"type": "array", "items": value, "minItems": 1}
        if self.names:
            return {"anyOf": [many, {"type": "string"}]}
        return {"anyOf": [many, {"type": "object", "additionalProperties": value}]} if self.letters else many


def in_si(
    values: Sequence[JointValue], quantities: Sequence[Quantity], to: Reading, *, is_list: bool = True
) -> tuple[float, ...] | Unread:
    """SI values, one per joint; in a list the unit of the last entry also applies to those without one if it fits."""
    parts: list[tuple[Scalar, Measured | Unread, Path]] = [(v.node, v.number, v.path) for v in values]
    inherited = last_unit(parts, [q.dimension for q in quantities]) if is_list else None
    if is_list and inherited is None and lacks_unit(parts, quantities):
        last = values[-1]
        return quantities[-1].without_unit(last.node, to, last.path, LAST_UNIT_HOLDS)
    result = []
    for value, quantity in zip(values, quantities, strict=True):
        unit = inherited if inherited is not None and inherited.dimension == quantity.dimension else None
        result.append(quantity.in_si(value.number, unit, value.node, to, value.path))
    good = tuple(v for v in result if not isinstance(v, Unread))
    return good if len(good) == len(values) else UNREAD


def check_within(
    value: float, lower: float, upper: float, measure: Measure, what: str, to: Reading, path: Path
) -> bool:
    """Whether the position of `what` is within its travel; a finding when it is not."""
    slack = 1e-9
    if lower - slack <= value <= upper + slack:
        return True
    bounds = f"{shown(lower, measure)} to {shown(upper, measure)}"
    to.fault("GS723", to.span(path), f"{what} is {shown(value, measure)}, outside its travel {bounds}")
    return False


def unknown_letter(letter: str, known: Sequence[str], path: Path, to: Reading) -> Unread:
    return to.fault("GS712", to.key(path), f"the machine has no axis `{letter}`", suggestion(letter, known))

"""Mappings of names to values of one kind."""

from __future__ import annotations

from collections.abc import Callable, Container
from typing import Any

from gcodesim.declarations.kind import Json, Kind
from gcodesim.declarations.nodes import Mapping, Node, Scalar
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.declarations.record import FREE, not_a_mapping
from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen


@frozen
class NameRule:
    """What the keys of a `MapOf` look like; `canonical` gives the one spelling, or None."""

    what: str
    pattern: str
    canonical: Callable[[str], Any]
    known: tuple[str, ...] = ()


@frozen(kw_only=False)
class MapOf(Kind):
    """A mapping of names to values of one kind. A `lenient` one leaves out what is faulty."""

    name: NameRule
    of: Kind
    what: str
    lenient: bool = False

    @property
    def expected(self) -> str:
        return self.what

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        if not isinstance(node, Mapping):
            return not_a_mapping(node, self.what, to, path)
        values: dict[Any, Any] = {}
        for name, value in node.entries:
            if name.text.startswith(FREE):
                continue
            canonical = read_name(self.name, name, path, values, to)
            if isinstance(canonical, Unread):
                values[name.text] = UNREAD
                continue
            at = (*path, canonical)
            to.named(at, name.span)
            values[canonical] = self.of.read(value, to, at)
        if self.lenient:
            return {name: value for name, value in values.items() if value is not UNREAD}
        return UNREAD if any(value is UNREAD for value in values.values()) else values

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {
            "type": "object",
            "patternProperties": {f"^({self.name.pattern})$": self.of.schema(definitions), f"^{FREE}": {}},
            "additionalProperties": False,
        }

    def show(self, value: Any) -> Any:
        return {name: self.of.show(entry) for name, entry in value.items()}

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", {str(name): self.of.plain(entry)[1] for name, entry in value.items()}


def read_name(name: NameRule, node: Scalar, path: Path, taken: Container[Any], to: Reading) -> Any:
    """The canonical form of a key in the mapping at `path`, or UNREAD when it is none or taken."""
    canonical = name.canonical(node.text)
    if canonical is None:
        return to.fault("GS711", node.span, f"`{node.text}` is no {name.what}", suggestion(node.text, name.known))
    if canonical in taken:
        first: Span = to.key((*path, canonical))
        return to.fault(
            "GS702",
            node.span,
            f"`{node.text}` is {canonical}, which stands a second time",
            f"the first is in line {first.line}",
            related=first,
        )
    return canonical

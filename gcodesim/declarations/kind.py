"""What a key expects: `Kind`, and what all kinds need to read a node.

A kind turns a node into an SI value, or into UNREAD after it has added the
finding. The JSON Schema and `cell show` come from the same kinds, so the three
cannot differ.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Final

from gcodesim.declarations.nodes import Listing, Mapping, Node, Scalar
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.frozen import frozen

Json = dict[str, Any]

SCHEMA_DIALECT: Final = "https://json-schema.org/draft/2020-12/schema"
"""Which JSON Schema our schemas are written in."""


def document(title: str, root: Json, definitions: dict[str, Json] | None = None) -> Json:
    """A whole schema; `definitions` are what it shares, in the order of their names."""
    whole = {"$schema": SCHEMA_DIALECT, "title": title, **root}
    return whole | ({"$defs": {name: definitions[name] for name in sorted(definitions)}} if definitions else {})


class Kind(ABC):
    """What a key expects."""

    @property
    @abstractmethod
    def expected(self) -> str:
        """In words, with an example."""

    @abstractmethod
    def read(self, node: Node, to: Reading, path: Path) -> Any:
        """The value in SI, or UNREAD."""

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


def scalar(kind: Kind, node: Node, to: Reading, path: Path) -> Scalar | Unread:
    """`node` as a scalar that is not empty."""
    if not isinstance(node, Scalar):
        return to.fault("GS706", node.span, f"`{key_name(path)}` is {article_of(node)}; {kind.expected} is expected")
    if node.empty:
        return to.fault("GS705", to.span(path), f"`{key_name(path)}` has no value; {kind.expected} is expected")
    to.spans[path] = node.span
    return node


@frozen
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


def listing(kind: Kind, node: Node, to: Reading, path: Path, count: int | None = None) -> tuple[Node, ...] | Unread:
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

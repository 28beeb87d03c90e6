"""Kinds made of other kinds: a list of them, or a word in place of one."""

from __future__ import annotations

from typing import Any

from gcodesim.declarations.kind import Json, Kind, key_name, listing, short
from gcodesim.declarations.nodes import Listing, Node, Scalar
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.declarations.scalars import measured, why_no_number
from gcodesim.frozen import frozen


@frozen(kw_only=False)
class ListOf(Kind):
    """A list of values of one kind; a single value may stand without brackets."""

    of: Kind
    single: bool = False

    @property
    def expected(self) -> str:
        return f"a list; {self.of.expected} each"

    def read(self, node: Node, to: Reading, path: Path) -> tuple[Any, ...] | Unread:
        if self.single and isinstance(node, Scalar) and not node.empty:
            value = self.of.read(node, to, (*path, 0))
            return UNREAD if isinstance(value, Unread) else (value,)
        if isinstance(node, Listing) and not node.items:
            to.spans[path] = node.span
            return ()
        items = listing(self, node, to, path)
        if isinstance(items, Unread):
            return UNREAD
        values = [self.of.read(item, to, (*path, index)) for index, item in enumerate(items)]
        return UNREAD if any(isinstance(value, Unread) for value in values) else tuple(values)

    def schema(self, definitions: dict[str, Json]) -> Json:
        many = {"type": "array", "items": self.of.schema(definitions)}
        return {"anyOf": [self.of.schema(definitions), many]} if self.single else many

    def show(self, value: Any) -> Any:
        return [self.of.show(entry) for entry in value]

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", [self.of.plain(entry)[1] for entry in value]


@frozen(kw_only=False)
class Either(Kind):
    """One of a few words that mean a fixed value, or a value of another kind."""

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

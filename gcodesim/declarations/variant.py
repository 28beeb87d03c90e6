"""One of a family's classes: a word in the mapping says which, and with it which other keys there are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gcodesim.declarations.keys import all_keys
from gcodesim.declarations.kind import Json, Kind, scalar, short
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.nodes import Node, Scalar
from gcodesim.declarations.plain_kinds import Text
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.declarations.record import Record, not_a_mapping, object_schema
from gcodesim.frozen import frozen


@frozen
class Variant(Kind):
    """A mapping in which `type` names a class of `family`, whose class variable `kind` is that word.

    `what` is how people call a member, `example` how one is written.
    """

    family: Mapping[str, type]
    what: str
    example: str

    @property
    def expected(self) -> str:
        return f"a {self.what} such as `{self.example}`"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        if not isinstance(node, MappingNode):
            return not_a_mapping(node, self.expected, to, path)
        type_node = node.get("type")
        if type_node is None:
            known = ", ".join(f"`{name}`" for name in self.family)
            return to.fault("GS705", to.span(path), f"{self.name(path)} lacks `type`", f"types are {known}")
        word = scalar(Text(form=f"a {self.what} type"), type_node, to, (*path, "type"))
        if isinstance(word, Unread):
            return UNREAD
        if word.text not in self.family:
            message = f"there is no {self.what} type `{short(word.text)}`"
            return to.fault("GS711", word.span, message, suggestion(word.text, list(self.family)))
        others = tuple(entry for entry in node.entries if entry[0].text != "type")
        return self.member(Record(self.family[word.text], f"{self.name(path)} ({word.text})"), others, to, path)

    def name(self, path: Path) -> str:
        """How messages call the one at `path`."""
        return f"{self.what} {path[-1]}"

    def member(self, record: Record, entries: tuple[tuple[Scalar, Node], ...], to: Reading, path: Path) -> Any:
        """The instance that `entries`, the keys besides `type`, describe; or UNREAD."""
        return record.read_entries(entries, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        kinds = []
        for name, cls in self.family.items():
            described = object_schema(list(all_keys(cls).values()), definitions, cls.__doc__ or "")
            described["properties"] = {"type": {"const": name}, **described["properties"]}
            described["required"] = ["type", *described.get("required", [])]
            definitions[name] = described
            kinds.append({"$ref": f"#/$defs/{name}"})
        return {"oneOf": kinds}

    def show(self, value: Any) -> Any:
        return {"type": value.kind, **Record(type(value), self.what).show(value)}

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", {"type": value.kind, **Record(type(value), self.what).plain(value)[1]}

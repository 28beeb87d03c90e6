"""A cell that is open in an editor: findings, what keys mean, what may be written."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, Final

from gcodesim.diagnostics import Diagnostic, Findings, SourceText
from gcodesim.diagnostics.plain import markdown_text
from gcodesim.editor.completion import Offer
from gcodesim.editor.hover import Hover
from gcodesim.editor.place import TextRange, range_of

_KEY: Final = re.compile(r"(?P<indent>[ ]*)(?P<dash>-[ ]+)?(?P<key>[^\s:#,{}\[\]]+)[ ]*:(?P<value>.*)")
_BEGUN: Final = re.compile(r"(?P<head>.*?)(?P<word>[A-Za-z0-9_.-]*)\Z")
_AMOUNT: Final = re.compile(r"[-+]?[0-9.]+(?:e[-+]?[0-9]+)?\s+([^\s,\]}]*)\Z")

Keys = tuple[str, ...]


class CellDocument:
    """The cell at `path`, with its text as the editor has it."""

    def __init__(self, path: Path, text: str, allow_paths: tuple[Path, ...] = ()) -> None:
        self.path, self._allow_paths = path, allow_paths
        self.update(text)

    def update(self, text: str) -> None:
        """Take a new text."""
        self.source = SourceText(self.path.name, text.encode("utf-8", "surrogatepass"), self.path.parent)
        self._findings: list[Diagnostic] | None = None

    @property
    def findings(self) -> list[Diagnostic]:
        """Those of `cell validate`."""
        from gcodesim.cell import read_cell

        if self._findings is None:
            self._findings = list(read_cell(self.source, self.path, self._allow_paths).findings)
        return self._findings

    # -- what stands at a place

    def hover(self, line: int, column: int) -> Hover | None:
        """What the key of a line means."""
        found = _KEY.match(self.source.line(line + 1))
        inline = self._inline_key(line, column)
        if inline is not None:
            path, begin, end = inline
        elif found is not None and found.start("key") <= column < found.end("key"):
            path, (begin, end) = (*self._parents(line), found["key"]), found.span("key")
        else:
            return None
        schema = _schema_at(path)
        text = None if schema is None else schema.get("description")
        if not text:
            return None
        return Hover(f"**{markdown_text(path[-1])}** {text}{_kinds(schema)}", TextRange(line, begin, line, end))

    def offers(self, line: int, column: int) -> list[Offer]:
        """Keys where a key may stand, values where a value may, and units behind a number."""
        before = self.source.line(line + 1)[:column]
        if (amount := _AMOUNT.search(before)) is not None:
            return list(_units(amount.start(1)))
        begun = _BEGUN.match(before)
        assert begun is not None
        begin, head = begun.start("word"), begun["head"]
        opened = _open_braces(before)
        if opened is not None:
            parent, at_value = (*self._parents(line), *opened[0]), opened[1]
        else:
            found = _KEY.match(before)
            at_value = found is not None
            parent = (*self._parents(line), found["key"]) if found is not None else self._parents(line, len(head))
        return list(_values(parent, begin) if at_value else _keys(parent, begin))

    def parts(self) -> list[tuple[str, TextRange, TextRange]]:
        """The sections of the cell: name, place of the name, and all lines up to the next."""
        from gcodesim.declarations.nodes import Mapping, compose

        root = compose(self.source, Findings())
        names = [name for name, _ in root.entries] if isinstance(root, Mapping) else []
        places = [range_of(name.span, self.source) for name in names]
        last = len(self.source.lines) - 1
        found = []
        for number, (name, place) in enumerate(zip(names, places, strict=True), start=1):
            end = max(places[number].line - 1 if number < len(places) else last, place.line)
            whole = TextRange(place.line, place.column, end, len(self.source.line(end + 1)))
            found.append((name.text, place, whole))
        return found

    # -- where a line stands

    def _parents(self, line: int, indent: int | None = None) -> Keys:
        """The keys under which a line stands, by indentation."""
        if indent is None:
            own = _KEY.match(self.source.line(line + 1))
            indent = 0 if own is None else len(own["indent"]) + len(own["dash"] or "")
        keys: list[str] = []
        for above in range(line - 1, -1, -1):
            if indent == 0:
                break
            found = _KEY.match(self.source.line(above + 1))
            if found is None:
                continue
            depth = len(found["indent"]) + len(found["dash"] or "")
            if depth < indent:
                keys.append(found["key"])
                indent = depth
        return tuple(reversed(keys))

    def _inline_key(self, line: int, column: int) -> tuple[Keys, int, int] | None:
        """The key in braces at a place: `{type: flat_end_mill, diameter: 6}`."""
        text = self.source.line(line + 1)
        for found in re.finditer(r"([^\s:#,{}\[\]]+)[ ]*:", text):
            if found.start(1) <= column < found.end(1):
                opened = _open_braces(text[: found.start(1)])
                if opened is not None:
                    return (*self._parents(line), *opened[0], found[1]), found.start(1), found.end(1)
        return None


def _open_braces(before: str) -> tuple[Keys, bool] | None:
    """The keys whose braces are open at the end of a text, and whether a value stands there; None outside braces."""
    keys: list[str] = []
    at_value = False
    depth = 0
    for token in re.finditer(r"([^\s:#,{}\[\]]+)[ ]*:|([{,}])", before):
        if token[1] is not None:
            keys = [*keys[:depth], token[1]]
            at_value = True
        elif token[2] == "{":
            depth += 1
            at_value = False
        elif token[2] == "}":
            depth -= 1
            keys = keys[:depth]
        else:
            keys, at_value = keys[:depth], False
    if depth <= 0:
        return None
    return tuple(keys), at_value


# -- the schema


@cache
def _schema() -> dict[str, Any]:
    from gcodesim.cell.schema import cell_schema

    return cell_schema()


def _resolved(schema: dict[str, Any]) -> list[dict[str, Any]]:
    """The schemas that a schema stands for."""
    if "$ref" in schema:
        target = _schema()["$defs"][schema["$ref"].rpartition("/")[2]]
        return [one | {k: v for k, v in schema.items() if k == "description"} for one in _resolved(target)]
    several = [one for word in ("anyOf", "oneOf", "allOf") for one in schema.get(word, ())]
    return [schema, *(inner for one in several for inner in _resolved(one))]


def _below(schemas: list[dict[str, Any]], key: str) -> list[dict[str, Any]]:
    found = []
    for schema in schemas:
        if key in schema.get("properties", {}):
            found += _resolved(schema["properties"][key])
        elif isinstance(schema.get("additionalProperties"), dict):
            found += _resolved(schema["additionalProperties"])
        for one in schema.get("patternProperties", {}).values():
            found += _resolved(one)
        if isinstance(schema.get("items"), dict):
            found += _below(_resolved(schema["items"]), key)
    return found


def _schemas_at(path: Keys) -> list[dict[str, Any]]:
    schemas = _resolved(_schema())
    for key in path:
        schemas = _below(schemas, key)
    return schemas


def _schema_at(path: Keys) -> dict[str, Any] | None:
    schemas = _schemas_at(path)
    return next((one for one in schemas if one.get("description")), schemas[0] if schemas else None)


def _keys(path: Keys, begin: int) -> Iterator[Offer]:
    seen = set()
    for schema in _schemas_at(path):
        for name, member in schema.get("properties", {}).items():
            if name not in seen:
                seen.add(name)
                yield Offer(name, begin, "key", str(member.get("description", "")))


def _values(path: Keys, begin: int) -> Iterator[Offer]:
    seen = set()
    for schema in _schemas_at(path):
        words = [*schema.get("enum", ()), *([schema["const"]] if "const" in schema else ())]
        words += ["true", "false"] if schema.get("type") == "boolean" else []
        for word in map(str, words):
            if word not in seen:
                seen.add(word)
                yield Offer(word, begin, "value")


def _units(begin: int) -> Iterator[Offer]:
    from gcodesim.declarations.units import UNITS

    seen = set()
    for unit in UNITS:
        if unit.name not in seen:
            seen.add(unit.name)
            yield Offer(unit.name, begin, "unit", unit.dimension)


def _kinds(schema: dict[str, Any] | None) -> str:
    """What may stand behind a key, where the schema names it."""
    words = [] if schema is None else [f"`{word}`" for word in schema.get("enum", ())]
    return f"\n\none of {', '.join(words)}" if words else ""

"""Mappings that become dataclasses, by the keys that these declare."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterator
from dataclasses import is_dataclass
from typing import Any, Final

from gcodesim.declarations.keys import Key, all_keys, fill_derived, inlined, keys, written
from gcodesim.declarations.kind import Json, Kind, article_of, key_name
from gcodesim.declarations.nodes import Mapping, Node, Scalar
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.frozen import frozen

FREE: Final = "x-"
_DIGITS: Final = re.compile(r"[0-9]")
NEARLY: Final = 0.8  # similarity from which on a misspelled key is read as the one that it resembles


@frozen(kw_only=False)
class Record(Kind):
    """A mapping that becomes a `cls`.

    `shorthand` names the key that a lone scalar stands for (`machine: gantry_xyz`). A `lenient` one takes defaults for
    what is faulty and marks it as broken, so that the rest can be checked. A class may have
    a method `checked(to, path)` that returns itself, a changed copy, or UNREAD after adding findings.
    """

    cls: type
    what: str
    shorthand: str = ""
    lenient: bool = False

    @property
    def expected(self) -> str:
        names = list(all_keys(self.cls))
        listed = ", ".join(f"`{name}`" for name in names[:3]) + (" …" if len(names) > 3 else "")
        alone = f"{all_keys(self.cls)[self.shorthand].kind.expected} or " if self.shorthand else ""
        return f"{alone}a mapping with {listed}"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        entries = self._entries(node, to, path)
        return UNREAD if isinstance(entries, Unread) else self.read_entries(entries, to, path)

    def _entries(self, node: Node, to: Reading, path: Path) -> tuple[tuple[Scalar, Node], ...] | Unread:
        if isinstance(node, Mapping):
            to.spans.setdefault(path, node.span)
            return node.entries
        if isinstance(node, Scalar) and self.shorthand and not node.empty:
            return ((Scalar(span=node.span, text=self.shorthand), node),)
        return not_a_mapping(node, self.expected, to, path)

    def read_entries(self, entries: tuple[tuple[Scalar, Node], ...], to: Reading, path: Path, **fixed: Any) -> Any:
        """The instance that the entries of a mapping describe, or UNREAD; `fixed` are fields that are no keys."""
        known = all_keys(self.cls)
        values: dict[str, Any] = {}
        for name, node_of_key, value in known_keys(entries, list(known), self.what, to):
            at = (*path, name)
            to.named(at, node_of_key.span)
            values[name] = known[name].read(value, to, at)
        arguments = fixed | self._arguments(self.cls, values, to, path)
        if self.lenient:
            self._mend(arguments, to)
        if any(value is UNREAD for value in arguments.values()):
            return UNREAD
        instance = _made(self.cls, arguments)
        _list_defaults(instance, values, to, path)
        return _checked(instance, to, path)

    def _arguments(self, cls: type, values: dict[str, Any], to: Reading, path: Path) -> dict[str, Any]:
        """Constructor arguments of `cls` from what was read, with defaults; UNREAD for what is missing."""
        arguments: dict[str, Any] = {}
        for name, declared in keys(cls).items():
            if name in values:
                arguments[declared.field] = values[name]
            elif declared.required:
                arguments[declared.field] = to.fault(
                    "GS705", to.span(path), f"{self.what} lacks `{name}`: {declared.kind.expected}", declared.doc
                )
            else:
                arguments[declared.field] = declared.default
        for name, (inner, always) in inlined(cls).items():
            if always or any(k in values for k in all_keys(inner)):
                within = self._arguments(inner, values, to, path)
                faulty = any(value is UNREAD for value in within.values())
                arguments[name] = UNREAD if faulty else _checked(_made(inner, within), to, path)
        return arguments

    def _mend(self, arguments: dict[str, Any], to: Reading) -> None:
        names = {declared.field: declared for declared in keys(self.cls).values()}
        for name in [name for name, value in arguments.items() if value is UNREAD]:
            arguments[name] = names[name].default if name in names else None
            to.broken.add((names[name].name if name in names else name,))

    def schema(self, definitions: dict[str, Json]) -> Json:
        name = _definition(self.cls)
        if name not in definitions:
            definitions[name] = {}  # a class may contain itself
            definitions[name] = object_schema(list(all_keys(self.cls).values()), definitions, self.cls.__doc__ or "")
        reference = {"$ref": f"#/$defs/{name}"}
        if not self.shorthand:
            return reference
        return {"anyOf": [all_keys(self.cls)[self.shorthand].kind.schema(definitions), reference]}

    def show(self, value: Any) -> Any:
        shown = ((name, kind.show(entry)) for name, kind, entry in written(value))
        return {name: entry for name, entry in shown if entry != {}}

    def plain(self, value: Any) -> tuple[str, Any]:
        shown: Json = {}
        for name, kind, entry in written(value):
            suffix, content = kind.plain(entry)
            if content != {}:
                shown[name + suffix] = content
        return "", shown


def _made(cls: type, arguments: dict[str, Any]) -> Any:
    instance = cls(**arguments)
    fill_derived(instance)
    return instance


def _definition(cls: type) -> str:
    """The name of a class among the definitions of a schema; classes of other packages may be called like ours."""
    package = cls.__module__.partition(".")[0]
    return cls.__name__ if package == __name__.partition(".")[0] else f"{package}.{cls.__name__}"


def _list_defaults(instance: Any, given: dict[str, Any], to: Reading, path: Path) -> None:
    """Note what nobody wrote."""
    cls: type = type(instance)
    for name, declared in keys(cls).items():
        if name not in given and not declared.quiet:
            list_default(getattr(instance, declared.field), declared.rule, to, (*path, name))
    for name in inlined(cls):
        if (inner := getattr(instance, name)) is not None:
            _list_defaults(inner, given, to, path)


def list_default(value: Any, rule: str, to: Reading, path: Path) -> None:
    """Note a default that was taken; of a record, each of its own."""
    cls: type = type(value)
    if is_dataclass(cls) and keys(cls):
        for name, declared in all_keys(cls).items():
            if not declared.quiet:
                list_default(declared.default, declared.rule, to, (*path, name))
    elif value is not None and value != () and value != "":
        to.default(path, value, rule)


def _checked(value: Any, to: Reading, path: Path) -> Any:
    check: Callable[[Reading, Path], Any] | None = getattr(value, "checked", None)
    return value if check is None else check(to, path)


def known_keys(
    entries: tuple[tuple[Scalar, Node], ...], known: list[str], what: str, to: Reading
) -> Iterator[tuple[str, Scalar, Node]]:
    """Name, key and value of the entries; unknown keys become findings, free ones are left out.

    A key that is nearly a known one which is absent is read as that one, so that the faults in its value come to
    light in the same run and nothing is said to be missing because of a slip.
    """
    given = {name.text for name, _ in entries}
    for name, value in entries:
        if name.text in known:
            yield name.text, name, value
        elif not name.text.startswith(FREE):
            comma = "a comma parts entries; decimals have a point" if _DIGITS.match(name.text) else ""
            to.fault("GS704", name.span, f"{what} has no key `{name.text}`", comma or suggestion(name.text, known))
            meant = difflib.get_close_matches(name.text.lower(), known, n=1, cutoff=NEARLY)
            if meant and meant[0] not in given:
                given.add(meant[0])
                yield meant[0], name, value


def not_a_mapping(node: Node, what: str, to: Reading, path: Path) -> Unread:
    """The finding for a value that should have been `key: value` lines."""
    if isinstance(node, Scalar) and node.empty:
        return to.fault(
            "GS705",
            to.span(path),
            f"`{key_name(path)}` has no value; {what} is expected",
            "give it a value, or delete the key",
        )
    return to.fault("GS706", node.span, f"`{key_name(path)}` is {article_of(node)}; {what} is expected")


def object_schema(members: list[Key], definitions: dict[str, Json], doc: str = "") -> Json:
    """JSON Schema of a mapping with these keys."""
    properties = {}
    for member in members:
        described = dict(member.kind.schema(definitions))
        properties[member.name] = {**described, "description": member.doc} if member.doc else described
    schema: Json = {"type": "object"}
    if doc:
        schema["description"] = doc.strip().splitlines()[0]
    schema["properties"] = properties
    required = [member.name for member in members if member.required]
    if required:
        schema["required"] = required
    return schema | {"patternProperties": {f"^{FREE}": {}}, "additionalProperties": False}

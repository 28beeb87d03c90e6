"""Mappings of the cell as dataclasses: a field declared by `key` is a key of the YAML file.

The YAML format is a tree of frozen dataclasses. `Record` reads one, `MapOf`
reads named ones, `inline` lays the keys of one class among those of another
(`in`, `xyz`, `rpy` of everything that stands somewhere).
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterator
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass
from functools import cache
from typing import Any, Final

from gcodesim.cell.kinds import Json, Kind, article_of, key_name
from gcodesim.cell.nodes import Mapping, Node, Scalar
from gcodesim.cell.reading import FAULT, Fault, Path, Reading, suggestion
from gcodesim.diagnostics import Span

_META: Final = "gcodesim.cell"
FREE: Final = "x-"
_DIGITS: Final = re.compile(r"[0-9]")
NEARLY: Final = 0.8  # similarity from which on a misspelled key is read as the one that it resembles


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """What a field tells the reader. `name` is the key in the file; `quiet` defaults are not listed."""

    name: str
    field: str
    kind: Kind
    doc: str
    required: bool
    default: Any
    quiet: bool
    why: str

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        """The value of this key; a fault without a hint of its own says what the key means."""
        before, to.about = to.about, f"`{self.name}`: {self.doc}" if self.doc not in ("", self.name) else ""
        value = self.kind.read(node, to, path)
        to.about = before
        return value


@dataclass(frozen=True, slots=True)
class _Declared:
    kind: Kind | None
    doc: str
    name: str
    quiet: bool
    why: str
    inline: type | None = None
    always: bool = False


def key(kind: Kind, doc: str, *, name: str = "", default: Any = MISSING, quiet: bool = False, why: str = "") -> Any:
    """A dataclass field that is a key of the cell file; required when there is no `default`."""
    return _field(default, _Declared(kind, doc, name, quiet, why))


def inline(cls: type, *, always: bool = True) -> Any:
    """A field that holds a `cls` whose keys stand among ours; None unless `always` or one of them is written."""
    return _field(None, _Declared(None, "", "", False, "", cls, always))


def _field(default: Any, declared: _Declared) -> Any:
    if isinstance(default, (dict, list)):
        return field(default_factory=lambda: type(default)(default), metadata={_META: declared})
    return field(default=default, metadata={_META: declared})


def _default(item: Field[Any]) -> Any:
    return item.default if item.default_factory is MISSING else item.default_factory()


@cache
def keys(cls: type[Any]) -> dict[str, Key]:
    """The keys that `cls` itself declares, by their names in the file."""
    found: dict[str, Key] = {}
    for item in fields(cls):
        declared: _Declared | None = item.metadata.get(_META)
        if declared is None or declared.kind is None:
            continue
        default = _default(item)
        name = declared.name or item.name
        found[name] = Key(
            name=name,
            field=item.name,
            kind=declared.kind,
            doc=declared.doc,
            required=default is MISSING,
            default=default,
            quiet=declared.quiet,
            why=declared.why,
        )
    return found


@cache
def inlined(cls: type) -> dict[str, tuple[type, bool]]:
    """Fields of `cls` that hold another class whose keys stand among ours: class, and whether always built."""
    metas = ((item.name, item.metadata.get(_META)) for item in fields(cls))
    return {name: (meta.inline, meta.always) for name, meta in metas if meta is not None and meta.inline is not None}


@cache
def all_keys(cls: type) -> dict[str, Key]:
    """Own and inlined keys of `cls`."""
    found = dict(keys(cls))
    for inner, _ in inlined(cls).values():
        found |= keys(inner)
    return found


@dataclass(frozen=True, slots=True)
class Record(Kind):
    """A mapping that becomes a `cls`.

    `shorthand` names the key that a lone scalar stands for (`machine: gantry_xyz`). A `lenient` one takes defaults for
    what is faulty and marks it as broken, so that the rest can be checked. A class may have
    a method `checked(to, path)` that returns itself, a changed copy, or FAULT after adding findings.
    """

    cls: type
    what: str
    shorthand: str = ""
    lenient: bool = False

    @property
    def expected(self) -> str:
        names = list(all_keys(self.cls))
        listed = ", ".join(f"`{name}`" for name in names[:3]) + (" …" if len(names) > 3 else "")
        return f"{'a name or ' if self.shorthand else ''}a mapping with {listed}"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        entries = self._entries(node, to, path)
        if isinstance(entries, Fault):
            return FAULT
        known = all_keys(self.cls)
        values: dict[str, Any] = {}
        for name, node_of_key, value in known_keys(entries, list(known), self.what, to):
            at = (*path, name)
            to.named(at, node_of_key.span)
            values[name] = known[name].read(value, to, at)
        return self._build(values, to, path)

    def _entries(self, node: Node, to: Reading, path: Path) -> tuple[tuple[Scalar, Node], ...] | Fault:
        if isinstance(node, Mapping):
            to.spans.setdefault(path, node.span)
            return node.entries
        if isinstance(node, Scalar) and self.shorthand and not node.empty:
            return ((Scalar(span=node.span, text=self.shorthand), node),)
        return not_a_mapping(node, self.expected, to, path)

    def _build(self, values: dict[str, Any], to: Reading, path: Path) -> Any:
        arguments = _arguments(self.cls, values, self.what, to, path)
        for name, (inner, always) in inlined(self.cls).items():
            if always or any(k in values for k in keys(inner)):
                inner_arguments = _arguments(inner, values, self.what, to, path)
                faulty = any(value is FAULT for value in inner_arguments.values())
                arguments[name] = FAULT if faulty else _checked(inner(**inner_arguments), to, path)
        if self.lenient:
            self._mend(arguments, to)
        if any(value is FAULT for value in arguments.values()):
            return FAULT
        return _checked(self.cls(**arguments), to, path)

    def _mend(self, arguments: dict[str, Any], to: Reading) -> None:
        names = {declared.field: declared for declared in keys(self.cls).values()}
        for name in [name for name, value in arguments.items() if value is FAULT]:
            arguments[name] = names[name].default if name in names else None
            to.broken.add((names[name].name if name in names else name,))

    def schema(self, definitions: dict[str, Json]) -> Json:
        name = self.cls.__name__
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


def _arguments(cls: type, values: dict[str, Any], what: str, to: Reading, path: Path) -> dict[str, Any]:
    """Constructor arguments of `cls` out of what was read, with defaults; FAULT for what is missing."""
    arguments: dict[str, Any] = {}
    for name, declared in keys(cls).items():
        if name in values:
            arguments[declared.field] = values[name]
        elif declared.required:
            arguments[declared.field] = to.fault(
                "GS705", to.span(path), f"{what} lacks `{name}`: {declared.kind.expected}", declared.doc
            )
        else:
            arguments[declared.field] = declared.default
            if not declared.quiet:
                list_default(declared.default, declared.why, to, (*path, name))
    return arguments


def list_default(value: Any, why: str, to: Reading, path: Path) -> None:
    """Note a default that was taken; of a record, each of its own."""
    cls: type[Any] = type(value)
    if is_dataclass(cls) and keys(cls):
        for name, declared in all_keys(cls).items():
            if not declared.quiet:
                list_default(declared.default, declared.why, to, (*path, name))
    elif value is not None and value != () and value != "":
        to.default(path, value, why)


def _checked(value: Any, to: Reading, path: Path) -> Any:
    check: Callable[[Reading, Path], Any] | None = getattr(value, "checked", None)
    return value if check is None else check(to, path)


def written(value: Any) -> Iterator[tuple[str, Kind, Any]]:
    """Name, kind and content of all keys of a record that say something: no empty ones, no quiet defaults."""
    for item in fields(value):
        declared: _Declared | None = item.metadata.get(_META)
        if declared is None:
            continue
        content = getattr(value, item.name)
        if declared.inline is not None:
            if content is not None:
                yield from written(content)
        elif declared.kind is not None and content is not None and content != {} and content != ():
            if declared.quiet and content == _default(item):
                continue
            yield declared.name or item.name, declared.kind, content


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


def not_a_mapping(node: Node, what: str, to: Reading, path: Path) -> Fault:
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Name:
    """What the keys of a `MapOf` look like; `canonical` gives the one spelling, or None."""

    what: str
    pattern: str
    canonical: Callable[[str], Any]
    known: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class MapOf(Kind):
    """A mapping of names to values of one kind. A `lenient` one leaves out what is faulty."""

    name: Name
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
            canonical = read_name(self.name, name, [(*path, known) for known in values], to)
            if isinstance(canonical, Fault):
                values[name.text] = FAULT
                continue
            at = (*path, canonical)
            to.named(at, name.span)
            values[canonical] = self.of.read(value, to, at)
        if self.lenient:
            return {name: value for name, value in values.items() if value is not FAULT}
        return FAULT if any(value is FAULT for value in values.values()) else values

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


def read_name(name: Name, node: Scalar, taken: list[Path], to: Reading) -> Any:
    """The canonical form of a key, or FAULT when it is none or taken."""
    canonical = name.canonical(node.text)
    if canonical is None:
        return to.fault("GS711", node.span, f"`{node.text}` is no {name.what}", suggestion(node.text, name.known))
    for path in taken:
        if path[-1] == canonical:
            first: Span = to.key(path)
            return to.fault(
                "GS702",
                node.span,
                f"`{node.text}` is {canonical}, which stands a second time",
                f"the first is in line {first.line}",
                related=first,
            )
    return canonical

"""Fields of dataclasses as keys of a file: a field declared by `key` is a key.

`inline` lays the keys of one class among those of another (`in`, `xyz`, `rpy`
of everything that stands somewhere).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING, Field, dataclass, field, fields
from functools import cache
from typing import Any, Final

from gcodesim.declarations.kind import Kind
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import Path, Reading

_META: Final = "gcodesim.key"


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

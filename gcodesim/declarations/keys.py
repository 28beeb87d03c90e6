"""Fields of dataclasses as keys of a file: a field declared by `key` is a key.

Cells, tools and processes declare what they take in the same words, so that
each has every unit, a place in the schema, in `cell show` and in the docs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import MISSING, Field, field, fields, is_dataclass, replace
from functools import cache
from typing import Any, Final

from gcodesim.declarations.kind import Kind, Range
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.plain_kinds import Switch, Text, Whole
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import Path, Reading, suggestion
from gcodesim.declarations.units import DIMENSIONS
from gcodesim.frozen import frozen

_META: Final = "gcodesim.key"

# what a kind given as a word means besides the dimensions of `units`; the bounds keep squares and cubes finite
_NAMED: Final[dict[str, Kind]] = {
    "length": Quantity("length", Range(least=-1e2, most=1e2)),  # m
    "flow": Quantity("volume flow"),
    "count": Whole(Range(least=1.0, most=1000.0)),
    "text": Text(),
    "switch": Switch(),
}


@frozen
class Key:
    """What a field tells the reader. `name` is the key in the file; `quiet` defaults are not listed.

    `rule` says in words where the value of an absent key comes from; `derived` that it follows from other keys.
    """

    name: str
    field: str
    kind: Kind
    doc: str
    required: bool
    default: Any
    quiet: bool
    rule: str
    derived: bool

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        """The value of this key; a fault without a hint of its own says what the key means."""
        before, to.about = to.about, f"`{self.name}`: {self.doc}" if self.doc not in ("", self.name) else ""
        value = self.kind.read(node, to, path)
        to.about = before
        return value


@frozen
class _Declared:
    kind: Kind | type | None = None
    doc: str = ""
    name: str = ""
    quiet: bool = False
    rule: str = ""
    derive: Callable[[Any], Any] | None = None
    inline: type | None = None
    always: bool = False


def key(
    kind: Kind | str | type,
    doc: str,
    *,
    name: str = "",
    default: Any = MISSING,
    rule: str = "",
    derive: Callable[[Any], Any] | None = None,
    example: str = "",
    quiet: bool = False,
) -> Any:
    """A dataclass field that is a key of the file, `name` or the field's own; `doc` is one line for people.

    `kind` is a dimension of `units` such as `"force"`; `"count"`, `"text"` or `"switch"`; a class whose own fields are
    keys, which makes a group; or any other `Kind`. Values are SI.

    The key is required without `default` and `derive`. `derive` computes the value from the finished instance when the
    key is absent, and `rule` says the same in words. `example` is a value of a quantity for messages and docs, `4 mm`.
    `quiet` defaults are not listed by `cell show`.
    """
    start = None if derive is not None else default
    declared = _Declared(kind=_kind(kind, example), doc=doc, name=name, quiet=quiet, rule=rule, derive=derive)
    if isinstance(start, (dict, list)):
        return field(default_factory=lambda: type(start)(start), metadata={_META: declared})
    return field(default=start, metadata={_META: declared})


def inline(cls: type, *, always: bool = True) -> Any:
    """A field that holds a `cls` whose keys stand among ours; None unless `always` or one of them is written."""
    return field(default=None, metadata={_META: _Declared(inline=cls, always=always)})


def _kind(kind: Kind | str | type, example: str) -> Kind | type:
    if isinstance(kind, str):
        if kind not in _NAMED and kind not in DIMENSIONS:
            raise ValueError(f"`{kind}` is no kind of value; {suggestion(kind, [*_NAMED, *DIMENSIONS])}")
        kind = _NAMED.get(kind) or Quantity(kind)
    return replace(kind, example=example) if example and isinstance(kind, (Quantity, Vector)) else kind


def _default(item: Field[Any]) -> Any:
    return item.default if item.default_factory is MISSING else item.default_factory()


@cache
def _declared(cls: type) -> tuple[tuple[Field[Any], _Declared], ...]:
    """The fields of `cls` that say something to the reader, in the order of listings.

    A class that inherits keys lists required ones first: they are what tells it from its bases.
    """
    any_class: Any = cls
    found = [(item, item.metadata[_META]) for item in fields(any_class) if _META in item.metadata]
    if any(is_dataclass(base) for base in cls.__mro__[1:]):
        found.sort(key=lambda pair: pair[1].kind is None or _default(pair[0]) is not MISSING)
    return tuple(found)


@cache
def keys(cls: type) -> dict[str, Key]:
    """The keys that `cls` itself declares or inherits, by their names in the file."""
    found: dict[str, Key] = {}
    for item, declared in _declared(cls):
        if declared.kind is None:
            continue
        default = _default(item)
        name = declared.name or item.name
        found[name] = Key(
            name=name,
            field=item.name,
            kind=declared.kind if isinstance(declared.kind, Kind) else _group(declared.kind, name),
            doc=f"{declared.doc} (default: {declared.rule})" if declared.rule else declared.doc,
            required=default is MISSING,
            default=default,
            quiet=declared.quiet,
            rule=declared.rule,
            derived=declared.derive is not None,
        )
    return found


def _group(cls: type, name: str) -> Kind:
    from gcodesim.declarations.record import Record  # which reads what is declared here

    return Record(cls, f"`{name}`")


@cache
def inlined(cls: type) -> dict[str, tuple[type, bool]]:
    """Fields of `cls` that hold another class whose keys stand among ours: class, and whether always built."""
    return {item.name: (meta.inline, meta.always) for item, meta in _declared(cls) if meta.inline is not None}


@cache
def all_keys(cls: type) -> dict[str, Key]:
    """Own and inlined keys of `cls`."""
    found = dict(keys(cls))
    for inner, _ in inlined(cls).values():
        found |= all_keys(inner)
    return found


def fill_derived(instance: Any) -> None:
    """Give each value that is absent and follows from others what its rule says.

    The reader does it; a class that is also made in Python calls it from `__post_init__`. A value may follow from one
    that is derived itself, in whatever order they stand.
    """
    cls: type = type(instance)
    rules = {item.name: declared.derive for item, declared in _declared(cls) if declared.derive is not None}
    absent = [name for name in rules if getattr(instance, name) is None]
    while absent:
        waiting = [name for name in absent if not _filled(instance, name, rules[name])]
        if len(waiting) == len(absent):
            rules[absent[0]](instance)  # says what is wrong with the rule
            return
        absent = waiting


def _filled(instance: Any, name: str, rule: Callable[[Any], Any]) -> bool:
    """Derive one value, unless it follows from one that is still absent."""
    try:
        value = rule(instance)
    except TypeError:  # nothing can be reckoned with a value that is absent
        return False
    object.__setattr__(instance, name, value)
    return value is not None


def written(value: Any) -> Iterator[tuple[str, Kind, Any]]:
    """Name, kind and content of all keys of a record that say something: no empty ones, no quiet defaults."""
    cls: type = type(value)
    for item, declared in _declared(cls):
        content = getattr(value, item.name)
        if declared.inline is not None:
            if content is not None:
                yield from written(content)
        elif content is not None and content != {} and content != ():
            name = declared.name or item.name
            if not (declared.quiet and content == _default(item)):
                yield name, keys(cls)[name].kind, content

"""What a tool's fields tell the cell reader: dimension, default rule, one line of text.

A tool kind is a dataclass whose fields are declared by `parameter`. The cell
package makes its keys, its units, its JSON Schema and `cell show` from
`parameters(kind)`, so that a new kind of tool needs no line there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, Field, dataclass, field, fields
from typing import Any, Final, Literal

Dimension = Literal["length", "angle", "count", "mass", "ratio", "text", "group"]

_KEY: Final = "parameter"


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One key of a tool in the cell file.

    `default` is the constant taken when the key is absent, in SI; it is None when the key is `required`, when
    the value follows from others (`rule` says how, in words), or when absent simply means "none".
    `members` are the keys of a `group`; `kind` is the dataclass that such a group becomes.
    """

    name: str
    dimension: Dimension
    doc: str
    required: bool = False
    default: Any = None
    rule: str = ""
    members: tuple[Parameter, ...] = ()
    kind: type | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Declared:
    dimension: Dimension
    doc: str
    rule: str
    derive: Callable[[Any], Any] | None
    kind: type | None


def parameter(
    dimension: Dimension,
    doc: str,
    *,
    default: Any = MISSING,
    rule: str = "",
    derive: Callable[[Any], Any] | None = None,
    kind: type | None = None,
) -> Any:
    """A dataclass field that is a key of the cell file.

    Without `default` and `derive` the key is required. `derive` computes the value from the other fields when the
    key is absent (see `fill_derived`); `rule` says the same in words.
    """
    declared = _Declared(dimension=dimension, doc=doc, rule=rule, derive=derive, kind=kind)
    start = None if derive is not None else default
    return field(default=start, metadata={_KEY: declared})


def fill_derived(instance: Any) -> None:
    """Replace each absent value by what its rule derives; called from `__post_init__` of the frozen kinds."""
    for item in fields(instance):
        declared: _Declared | None = item.metadata.get(_KEY)
        if declared is not None and declared.derive is not None and getattr(instance, item.name) is None:
            object.__setattr__(instance, item.name, declared.derive(instance))


def parameters(kind: type) -> tuple[Parameter, ...]:
    """The keys of a tool kind (or of a group such as `Holder`): required ones first, else in the order declared."""
    found = [_parameter(item) for item in fields(kind) if _KEY in item.metadata]
    return tuple(sorted(found, key=lambda item: not item.required))


def _parameter(item: Field[Any]) -> Parameter:
    declared: _Declared = item.metadata[_KEY]
    required = item.default is MISSING
    return Parameter(
        name=item.name,
        dimension=declared.dimension,
        doc=declared.doc,
        required=required,
        default=None if required else item.default,
        rule=declared.rule,
        members=parameters(declared.kind) if declared.kind is not None else (),
        kind=declared.kind,
    )

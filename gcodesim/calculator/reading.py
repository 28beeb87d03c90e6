"""Inputs of a model: from words of a command line or from a case, by the declarations and units of cells."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from gcodesim.calculator.model import Model, all_spellings, inputs_of
from gcodesim.calculator.unit_names import named_unit, splits, suffix_unit
from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.files import Shelf
from gcodesim.declarations.keys import Key, all_keys
from gcodesim.declarations.kind import Kind
from gcodesim.declarations.nodes import Listing, Node, Scalar, compose
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import Reading, Unread, suggestion
from gcodesim.declarations.record import Record
from gcodesim.declarations.scalars import measured
from gcodesim.declarations.units import DIMENSIONS
from gcodesim.diagnostics import Findings, SourceText, Span

_PLACE = Span("inputs", 1, 1, 1, 2)


class InputsRefusedError(Exception):
    """The inputs cannot be read; the text says all that is wrong with them."""


def model_of_words(cls: type[Model], words: Iterable[str]) -> Model:
    """The model with inputs `key=value`, each value written as in a cell; InputsRefusedError."""
    given: dict[str, Node] = {}
    for word in words:
        name, equals, value = word.partition("=")
        name = name.strip().rpartition(".")[2]
        if not equals or not name:
            raise InputsRefusedError(f"{word} is no input; write NAME=VALUE, such as diameter=10mm")
        findings = Findings()
        root = compose(SourceText(name, f"value: {value}\n".encode()), findings, what="input")
        node = None if root is None else root.get("value")
        if node is None or len(findings):
            raise InputsRefusedError(f"{word}: {next(iter(findings)).message if len(findings) else 'it has no value'}")
        found = _meant(cls, name)
        if found is None:
            known = [*inputs_of(cls), *all_spellings(cls)]
            raise InputsRefusedError(f"{cls.kind} takes no `{name}`; {suggestion(name, known)}")
        key, unit = found
        if key.name in given:
            raise InputsRefusedError(f"`{key.name}` is given twice")
        given[key.name] = _with_unit(node, unit)
    return _read(cls, given)


def model_of_case(cls: type[Model], inputs: Mapping[str, Any]) -> tuple[Model, list[str]]:
    """The model with the inputs of a case, and the names of those that it does not use; InputsRefusedError.

    Units are the ends of names. A number without one is in the unit in which its dimension is shown.
    """
    given: dict[str, Node] = {}
    unused: list[str] = []
    for name, value in _flat(cls, inputs):
        found = _meant(cls, name)
        if found is None:
            unused.append(name)
            continue
        key, unit = found
        if value is not None:
            given[key.name] = _node(value, key.kind, unit)
    return _read(cls, given), unused


def _flat(cls: type[Model], inputs: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Inputs without the groups in which a file puts them."""
    for name, value in inputs.items():
        if isinstance(value, Mapping):
            found = _meant(cls, name)
            if found is None or not isinstance(found[0].kind, Record):
                yield from _flat(cls, value)
                continue
        yield name, value


def _meant(cls: type[Model], name: str) -> tuple[Key, str] | None:
    """The key that a name of an input means, and the unit at its end."""
    keys, spellings = inputs_of(cls), all_spellings(cls)
    if name in keys or name in spellings:
        own = keys[spellings.get(name, name)]
        return own, named_unit(name, _dimension(own.kind))
    for stem, suffix in splits(name):
        key = keys.get(spellings.get(stem, stem))
        if key is None:
            continue
        unit = suffix_unit(suffix, _dimension(key.kind))
        if unit is not None:
            return key, unit.name
    return None


def _dimension(kind: Kind) -> str:
    if isinstance(kind, Vector):
        return kind.of.dimension
    if isinstance(kind, ListOf):
        return _dimension(kind.of)
    return kind.dimension if isinstance(kind, Quantity) else ""


def _with_unit(node: Node, unit: str) -> Node:
    """A number without unit gets that of its name."""
    if not unit:
        return node
    if isinstance(node, Listing):
        return Listing(span=node.span, items=tuple(_with_unit(item, unit) for item in node.items))
    if isinstance(node, Scalar):
        number = measured(node.text)
        if number is not None and not number.unit:
            return Scalar(span=node.span, text=f"{node.text} {unit}", plain=False)
    return node


def _node(value: Any, kind: Kind, unit: str) -> Node:
    """A value of a case as the reader of cells sees it."""
    if isinstance(value, Mapping):
        members = all_keys(kind.cls) if isinstance(kind, Record) else {}
        entries = []
        for name, content in value.items():
            key, own = _member(members, str(name))
            inner = _node(content, key.kind, own) if key is not None else _text(content)
            entries.append((Scalar(span=_PLACE, text=str(name) if key is None else key.name), inner))
        return MappingNode(span=_PLACE, entries=tuple(entries))
    if isinstance(value, list):
        of = kind.of if isinstance(kind, (ListOf, Vector)) else kind
        return Listing(span=_PLACE, items=tuple(_node(item, of, unit) for item in value))
    if isinstance(value, float) and value.is_integer() and not isinstance(kind, (Quantity, Vector)):
        value = int(value)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        dimension = _dimension(kind)
        shown = unit or (DIMENSIONS[dimension].shown if dimension else "")
        return Scalar(span=_PLACE, text=f"{value!r} {shown}".strip(), plain=False)
    return _text(value)


def _text(value: Any) -> Scalar:
    return Scalar(span=_PLACE, text=value if isinstance(value, str) else json.dumps(value), plain=False)


def _member(members: Mapping[str, Key], name: str) -> tuple[Key | None, str]:
    if name in members:
        return members[name], ""
    for stem, suffix in splits(name):
        if stem in members and (unit := suffix_unit(suffix, _dimension(members[stem].kind))) is not None:
            return members[stem], unit.name
    return None, ""


def _read(cls: type[Model], given: Mapping[str, Node]) -> Model:
    to = Reading(file="inputs", findings=Findings(), shelf=Shelf(folder=Path()))
    entries = tuple((Scalar(span=_PLACE, text=name), node) for name, node in given.items())
    model = Record(cls, cls.kind).read_entries(entries, to, ())
    if len(to.findings) or isinstance(model, Unread):
        raise InputsRefusedError("; ".join(_told(finding.message, finding.hint) for finding in to.findings))
    assert isinstance(model, Model)
    return model


def _told(message: str, hint: str) -> str:
    return f"{message} ({hint})" if hint else message

"""Pieces of JSON Schema (2020-12): records with all keys described, and records made of dataclasses."""

from __future__ import annotations

import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, Final, Literal, Union, get_args, get_origin, get_type_hints

from gcodesim.declarations.kind import Json

_PLAIN: Final = {str: "string", float: "number", int: "integer", bool: "boolean", type(None): "null"}


class _Optional(dict[str, Any]):
    """The schema of a member that may be absent."""


def optional(member: Json) -> Json:
    """The same, of a member that a record may leave out."""
    return _Optional(member)


def record(what: str, /, **members: Json) -> Json:
    """An object with exactly these members, all of them unless they are `optional`."""
    return {
        "type": "object",
        "description": what,
        "properties": members,
        "required": [name for name, member in members.items() if not isinstance(member, _Optional)],
        "additionalProperties": False,
    }


def table(what: str, of: Json) -> Json:
    """An object whose keys are names chosen by the user."""
    return {"type": "object", "description": what, "additionalProperties": of}


def array(what: str, of: Json) -> Json:
    return {"type": "array", "description": what, "items": of}


def text(what: str) -> Json:
    return {"type": "string", "description": what}


def number(what: str) -> Json:
    return {"type": "number", "description": what}


def whole(what: str, *, least: int = 0) -> Json:
    return {"type": "integer", "minimum": least, "description": what}


def truth(what: str) -> Json:
    return {"type": "boolean", "description": what}


def choice(what: str, *values: Any) -> Json:
    return {"enum": list(values), "description": what}


def nullable(schema: Json) -> Json:
    """The same, or null."""
    if "$ref" in schema:
        return {"anyOf": [{"$ref": schema["$ref"]}, {"type": "null"}], "description": schema.get("description", "")}
    if "enum" in schema:
        return {**schema, "enum": [*schema["enum"], None]}
    return {**schema, "type": [schema["type"], "null"]}


def ref(name: str, what: str) -> Json:
    """A definition of the document's `$defs`."""
    return {"$ref": f"#/$defs/{name}", "description": what}


def of_dataclass(cls: type, definitions: dict[str, Json]) -> Json:
    """A reference to the record that `dataclasses.asdict` makes of `cls`; nested ones are defined as well."""
    if cls.__name__ not in definitions:
        definitions[cls.__name__] = {}  # a record may hold itself
        hints = get_type_hints(cls)
        assert is_dataclass(cls)
        members = {field.name: of_type(hints[field.name], definitions) for field in fields(cls)}
        definitions[cls.__name__] = record(" ".join((cls.__doc__ or "").split()), **members)
    return {"$ref": f"#/$defs/{cls.__name__}"}


def of_type(hint: Any, definitions: dict[str, Json]) -> Json:
    """The schema of values of a type, as they look in JSON."""
    origin, arguments = get_origin(hint), get_args(hint)
    if hint is Any:
        return {}
    if hint in _PLAIN:
        return {"type": _PLAIN[hint]}
    if is_dataclass(hint):
        assert isinstance(hint, type)
        return of_dataclass(hint, definitions)
    if origin is Literal:
        return {"enum": list(arguments)}
    if origin in (Union, types.UnionType):
        return {"anyOf": [of_type(one, definitions) for one in arguments]}
    if origin is tuple and arguments[1:] == (...,):
        return {"type": "array", "items": of_type(arguments[0], definitions)}
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {"type": "object", "additionalProperties": of_type(arguments[1], definitions)}
    raise TypeError(f"no schema for {hint}")

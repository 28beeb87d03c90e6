"""Fields of log messages by path: `force_n`, `force.x`, `joints[2].position`, `joints[arm/joint_1].position`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

_PART: Final = re.compile(r"(\w+)(?:\[([^\[\]]+)\])?(?:\.|$)")
_NAMES: Final = ("name", "child_frame_id", "id")  # the fields by which an item of a repeated field is called


class FieldStep(NamedTuple):
    """One step of a path: a field, and which item of it when it is repeated ("": all)."""

    field: str
    item: str


def parse_path(path: str) -> tuple[FieldStep, ...]:
    """The steps of a path. ValueError if it is not a path."""
    parts, at = [], 0
    while at < len(path):
        found = _PART.match(path, at)
        if found is None:
            break
        parts.append(FieldStep(found[1], found[2] or ""))
        at = found.end()
    if at < len(path) or not parts or path.endswith("."):
        raise ValueError(f"not a field: '{path}'")
    return tuple(parts)


def value_at(message: Any, parts: tuple[FieldStep, ...]) -> Any:
    """The value in `message`; a list where a repeated field is asked for as a whole.

    ValueError when the message has no such field or no such item.
    """
    (name, item), rest = parts[0], parts[1:]
    if not is_message(message) or name not in message.DESCRIPTOR.fields_by_name:
        raise ValueError(f"no field '{name}'")
    value = getattr(message, name)
    if is_repeated(value):
        if not item:
            return [value_at(one, rest) for one in value] if rest else list(value)
        value = _item(value, name, item)
    elif item:
        raise ValueError(f"'{name}' is not repeated")
    return value_at(value, rest) if rest else value


def _item(values: Any, name: str, item: str) -> Any:
    if item.isdigit() and int(item) < len(values):
        return values[int(item)]
    for value in values:
        if item_name(value) == item:
            return value
    raise ValueError(f"'{name}' has no item '{item}'")


def item_name(value: Any) -> str:
    """The name of an item of a repeated field; empty if it has none."""
    for field in _NAMES:
        if is_message(value) and field in value.DESCRIPTOR.fields_by_name:
            return str(getattr(value, field))
    return ""


def leaves(message: Any, prefix: str = "") -> Iterator[str]:
    """Paths of all numbers and texts that a message has; items of repeated fields by name where they have one."""
    for field in message.DESCRIPTOR.fields:
        if field.has_presence and not message.HasField(field.name):
            continue
        value, path = getattr(message, field.name), prefix + field.name
        if is_repeated(value):
            for i, one in enumerate(value):
                at = f"{path}[{item_name(one) or i}]"
                if is_message(one):
                    yield from leaves(one, f"{at}.")
                else:
                    yield at
        elif is_message(value):
            if field.name != "timestamp":  # it is the time of the message
                yield from leaves(value, f"{path}.")
        else:
            yield path


def is_message(value: Any) -> bool:
    return hasattr(value, "DESCRIPTOR")


def is_repeated(value: Any) -> bool:
    return not is_message(value) and not isinstance(value, (str, bytes, bool, int, float))

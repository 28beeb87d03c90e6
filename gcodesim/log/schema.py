"""Schemas of the log: message descriptors, and the bytes of them that a log stores.

`foxglove.*` messages come from their package. `gcodesim.*` messages are defined
once, in `data/log/gcodesim.proto` and, for sensors, `readings.proto`, which are read here; no compiler is needed.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Final

from google.protobuf import (
    descriptor_pool,
    message_factory,
    timestamp_pb2,  # noqa: F401  (registers the file that ours imports)
)
from google.protobuf.descriptor import FileDescriptor
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet

if TYPE_CHECKING:
    from gcodesim.log.description import ProcessField

_FIELD = re.compile(r"(repeated +)?([\w.]+) +(\w+) *= *(\d+);")
_TYPES: Final = {
    "double": FieldDescriptorProto.TYPE_DOUBLE,
    "uint32": FieldDescriptorProto.TYPE_UINT32,
    "bool": FieldDescriptorProto.TYPE_BOOL,
    "string": FieldDescriptorProto.TYPE_STRING,
}


PROCESS: Final = "gcodesim.Process"
"""The message to which processes add fields of their own."""

FIRST_MORE: Final = 32
"""Number of the first of these fields; those below are the log's own."""


OWN: Final = ("gcodesim.proto", "readings.proto")
"""Our definitions. A log stores those files whole whose messages it has, so what is in one is in every log with it."""


def read_proto(text: str, file_name: str = OWN[0]) -> FileDescriptorProto:
    """The descriptor of a plain proto3 file: messages of scalar and message fields, one field a line.

    ValueError on a line that is none of these.
    """
    file = FileDescriptorProto(name=f"gcodesim/{file_name}", syntax="proto3")
    message = None
    for line in text.splitlines():
        line = line.split("//")[0].strip()
        word, _, rest = line.partition(" ")
        if not line or word == "syntax":
            continue
        if word == "package":
            file.package = rest.rstrip(";")
        elif word == "import":
            file.dependency.append(rest.strip('";'))
        elif word == "message":
            message = file.message_type.add(name=rest.rstrip("{ "))
        elif line == "}":
            message = None
        else:
            found = _FIELD.fullmatch(line)
            if found is None or message is None:
                raise ValueError(f"not a plain proto3 line: {line!r}")
            repeated, kind, name, number = found.groups()
            field = message.field.add(name=name, number=int(number), json_name=_json_name(name))
            field.label = FieldDescriptorProto.LABEL_REPEATED if repeated else FieldDescriptorProto.LABEL_OPTIONAL
            if kind in _TYPES:
                field.type = _TYPES[kind]
            else:
                field.type = FieldDescriptorProto.TYPE_MESSAGE
                field.type_name = f".{kind}" if "." in kind else f".{file.package}.{kind}"
    return file


def _json_name(name: str) -> str:
    first, *others = name.split("_")
    return first + "".join(word.capitalize() for word in others)


def proto_text(file_name: str = OWN[0]) -> str:
    """A definition of `gcodesim.*` messages, as shipped."""
    return (files("gcodesim") / "data" / "log" / file_name).read_text(encoding="utf-8")


@cache
def _own_file(file_name: str) -> FileDescriptor:
    pool = descriptor_pool.Default()  # the pool that has Timestamp, so that its objects fit into our messages
    pool.Add(read_proto(proto_text(file_name), file_name))
    return pool.FindFileByName(f"gcodesim/{file_name}")


@cache
def message_class(schema: str) -> Any:
    """The message class of a schema such as `foxglove.Log` or `gcodesim.Event`."""
    package, name = schema.split(".")
    if package == "gcodesim":
        known = (_own_file(file_name).message_types_by_name for file_name in OWN)
        return message_factory.GetMessageClass(next(types[name] for types in known if name in types))
    return getattr(import_module(f"foxglove_schemas_protobuf.{name}_pb2"), name)


def schema_data(schema: str, more: Sequence[ProcessField] = ()) -> bytes:
    """A serialized FileDescriptorSet of the schema's file and all it needs, dependencies first.

    `more` are fields that the message has in one log, behind its own.
    """
    collected: dict[str, FileDescriptorProto] = {}

    def collect(file: FileDescriptor) -> None:
        for needed in file.dependencies:
            collect(needed)
        if file.name not in collected:
            collected[file.name] = FileDescriptorProto.FromString(file.serialized_pb)

    own = message_class(schema).DESCRIPTOR.file
    collect(own)
    if more:
        message = next(m for m in collected[own.name].message_type if m.name == schema.partition(".")[2])
        for number, field in enumerate(more, start=FIRST_MORE):
            kind = _TYPES["bool" if field.flag else "double"]
            message.field.add(
                name=field.name,
                number=number,
                json_name=_json_name(field.name),
                label=FieldDescriptorProto.LABEL_OPTIONAL,
                type=kind,
            )
    return FileDescriptorSet(file=collected.values()).SerializeToString(deterministic=True)


def decoder(schema: str, data: bytes) -> Any:
    """A message class for `schema`, made from the descriptors stored in a log, which may be of another version."""
    pool = descriptor_pool.DescriptorPool()
    for file in FileDescriptorSet.FromString(data).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(schema))

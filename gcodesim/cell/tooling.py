"""Tools of the cell: keys, units and rules are those that the tool kinds declare for themselves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from gcodesim.declarations.keys import Key
from gcodesim.declarations.kind import Json, Kind, Range, scalar, short
from gcodesim.declarations.map_of import Name
from gcodesim.declarations.nodes import Mapping, Node, Scalar
from gcodesim.declarations.plain_kinds import Text, Whole
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import FAULT, Fault, Path, Reading, suggestion
from gcodesim.declarations.record import known_keys, not_a_mapping, object_schema
from gcodesim.declarations.scalars import integer
from gcodesim.tools import TOOLS, Parameter, parameters

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool

# below zero a tool says itself what is wrong with it; the bounds keep squares and cubes finite
_TOOL_LENGTH: Final = Range(least=-1e2, most=1e2)  # m

_KINDS: Final[dict[str, Callable[[], Kind]]] = {
    "length": lambda: Quantity("length", _TOOL_LENGTH),
    "angle": lambda: Quantity("angle"),
    "mass": lambda: Quantity("mass"),
    "ratio": lambda: Quantity("ratio"),
    "count": lambda: Whole(Range(least=1.0, most=1000.0)),
    "text": lambda: Text(),
}


def tool_number(text: str) -> int | None:
    """`7`, `07` or `"7"` → 7; 0 is the empty spindle, no tool."""
    number = integer(text)
    return number if number is not None and 1 <= number <= 99_999 else None


TOOL_NUMBERS: Final = Name(what="tool number (1 to 99999)", pattern=r"0*[1-9][0-9]{0,4}", canonical=tool_number)


def kind_of(parameter: Parameter) -> Kind:
    """How a parameter of a tool is read."""
    if parameter.dimension == "group":
        assert parameter.kind is not None
        return _Group(parameter.kind, parameter.name)
    return _KINDS[parameter.dimension]()


@dataclass(frozen=True, slots=True)
class _Group(Kind):
    """A part of a tool with keys of its own (`holder`)."""

    cls: type
    name: str

    @property
    def expected(self) -> str:
        return f"a mapping with {', '.join(f'`{p.name}`' for p in parameters(self.cls))}"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        if not isinstance(node, Mapping):
            return not_a_mapping(node, self.expected, to, path)
        to.spans.setdefault(path, node.span)
        values = read_parameters(node.entries, self.cls, f"`{self.name}`", to, path)
        return FAULT if isinstance(values, Fault) else self.cls(**values)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return object_schema(members(self.cls), definitions)

    def show(self, value: Any) -> Any:
        return {p.name: kind_of(p).show(getattr(value, p.name)) for p in parameters(self.cls)}

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", plain_parameters(value, self.cls)


def members(cls: type) -> list[Key]:
    """The parameters of a tool kind as keys of a record."""
    return [
        Key(
            name=p.name,
            field=p.name,
            kind=kind_of(p),
            doc=f"{p.doc} (default: {p.rule})" if p.rule else p.doc,
            required=p.required,
            default=p.default,
            quiet=False,
            why=p.rule,
        )
        for p in parameters(cls)
    ]


def read_parameters(
    entries: tuple[tuple[Scalar, Node], ...], cls: type, what: str, to: Reading, path: Path
) -> dict[str, Any] | Fault:
    """Constructor arguments for `cls` out of the keys of a mapping; keys that are absent are left to its defaults."""
    known = {member.name: member for member in members(cls)}
    values: dict[str, Any] = {}
    for name, key, node in known_keys(entries, list(known), what, to):
        at = (*path, name)
        to.named(at, key.span)
        values[name] = known[name].read(node, to, at)
    for member in known.values():
        if member.required and member.name not in values:
            values[member.name] = to.fault(
                "GS705", to.span(path), f"{what} lacks `{member.name}`: {member.kind.expected}", member.doc
            )
    return FAULT if any(value is FAULT for value in values.values()) else values


def plain_parameters(value: Any, cls: type) -> Json:
    """The parameters of a tool with units in their names."""
    shown: Json = {}
    for p in parameters(cls):
        content = getattr(value, p.name)
        if content is not None:
            suffix, number = kind_of(p).plain(content)
            shown[p.name + suffix] = number
    return shown


@dataclass(frozen=True, slots=True)
class ToolKind(Kind):
    """A tool: `type` says which parameters it has."""

    @property
    def expected(self) -> str:
        return "a tool such as `{type: flat_end_mill, diameter: 10 mm}`"

    def read(self, node: Node, to: Reading, path: Path) -> Tool | Fault:
        if not isinstance(node, Mapping):
            return not_a_mapping(node, self.expected, to, path)
        number = int(path[-1])
        type_node = node.get("type")
        if type_node is None:
            known = ", ".join(f"`{name}`" for name in TOOLS)
            return to.fault("GS705", to.span(path), f"tool {number} lacks `type`", f"types are {known}")
        name = scalar(Text(form="a tool type"), type_node, to, (*path, "type"))
        if isinstance(name, Fault):
            return FAULT
        if name.text not in TOOLS:
            return to.fault(
                "GS711", name.span, f"there is no tool type `{short(name.text)}`", suggestion(name.text, list(TOOLS))
            )
        cls: type = TOOLS[name.text]
        others = tuple(entry for entry in node.entries if entry[0].text != "type")
        values = read_parameters(others, cls, f"tool {number} ({name.text})", to, path)
        if isinstance(values, Fault):
            return FAULT
        tool: Tool = cls(number=number, **values)
        return _possible(tool, values, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        kinds = []
        for name in TOOLS:
            described = object_schema(members(TOOLS[name]), definitions, TOOLS[name].__doc__ or "")
            described["properties"] = {"type": {"const": name}, **described["properties"]}
            described["required"] = ["type", *described.get("required", [])]
            definitions[name] = described
            kinds.append({"$ref": f"#/$defs/{name}"})
        return {"oneOf": kinds}

    def show(self, value: Any) -> Any:
        shown = {
            p.name: kind_of(p).show(getattr(value, p.name))
            for p in parameters(type(value))
            if getattr(value, p.name) is not None
        }
        return {"type": value.kind, **shown}

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", {"type": value.kind, **plain_parameters(value, type(value))}


def _possible(tool: Tool, given: dict[str, Any], to: Reading, path: Path) -> Tool | Fault:
    """`tool`, or FAULT with a finding for each reason why it cannot exist."""
    problems = tool.problems()
    written = [problem for problem in problems if (*path, *problem[0].split(".")) in to.spans]
    docs = {member.name: member.doc for member in members(type(tool))}
    for name, message in written or problems:  # a default that follows from a wrong value is no fault of its own
        key = name.split(".")[0]
        hint = f"`{key}`: {docs[key]}" if written else f"the default of `{name}` does not fit the other keys; write it"
        to.fault("GS720", to.span((*path, *name.split("."))), f"tool {tool.number} is impossible: {message}", hint)
    for p in parameters(type(tool)):
        value = getattr(tool, p.name)
        if p.name not in given and value is not None and p.dimension != "text":
            to.default((*path, p.name), value, p.rule)
    return FAULT if problems else tool

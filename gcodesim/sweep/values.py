"""Values of factors as JSON, on their way to a worker, and what they change there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from gcodesim.declarations.deep_value import DeepValue
from gcodesim.declarations.nodes import Listing, Node, Scalar
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.sweep.design import Point
from gcodesim.sweep.factor import CELL, PROGRAM, Factor
from gcodesim.sweep.study_file import spans_of_values

Json = Any


def point_as_json(vary: Mapping[str, Factor], point: Point) -> dict[str, Json]:
    """What a point says besides program and cell: keys of the cell, and parameters of the program."""
    keys, parameters = [], []
    for name, factor in vary.items():
        if factor.target == "parameter":
            parameters.append([factor.parameter, float(point[name].shown)])
        elif factor.target not in (PROGRAM, CELL):
            keys.append({"name": name, "path": list(factor.path), "value": node_as_json(point[name].node)})
    return {"values": keys, "parameters": parameters}


def deep_values(values: list[dict[str, Json]]) -> Iterator[DeepValue]:
    """The values of keys of the cell that `point_as_json` gave. KeyError, TypeError or ValueError for anything else."""
    for one in values:
        path = tuple(str(part) for part in one["path"])
        yield DeepValue(path=path, node=node_from_json(one["value"], str(one["name"])))


def node_as_json(node: Node) -> Json:
    """A text as `[text, plain]`, a list as `{"list": …}`, a mapping as `{"keys": …}`."""
    if isinstance(node, Scalar):
        return [node.text, node.plain]
    if isinstance(node, Listing):
        return {"list": [node_as_json(item) for item in node.items]}
    return {"keys": [[node_as_json(name), node_as_json(value)] for name, value in node.entries]}


def node_from_json(value: Json, name: str) -> Node:
    """The node of a value of the factor `name`."""
    span = spans_of_values(name)
    if isinstance(value, list):
        text, plain = value
        return Scalar(span=span, text=str(text), plain=plain is True)
    if "list" in value:
        return Listing(span=span, items=tuple(node_from_json(item, name) for item in value["list"]))
    entries = []
    for key, content in value["keys"]:
        text = node_from_json(key, name)
        if not isinstance(text, Scalar):
            raise TypeError("a key is a text")
        entries.append((text, node_from_json(content, name)))
    return MappingNode(span=span, entries=tuple(entries))

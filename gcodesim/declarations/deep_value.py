"""One value deep in a file, given from outside by its path: `tools.1.diameter`, `fixtures.vise.at`, `home.2`."""

from __future__ import annotations

from dataclasses import replace

from gcodesim.declarations.kind import article_of, short
from gcodesim.declarations.nodes import Listing, Mapping, Node, Scalar
from gcodesim.declarations.reading import Reading
from gcodesim.frozen import frozen


@frozen
class DeepValue:
    """`node` in place of what stands at `path`, names of keys or places in lists from 0; findings name its span."""

    path: tuple[str, ...]
    node: Node

    def put(self, root: Mapping, to: Reading) -> Mapping:
        """The file with the value; mappings on the way that are not there are made. A fault changes nothing."""
        changed = self._within(root, 0, to)
        return changed if isinstance(changed, Mapping) else root

    def _within(self, node: Node | None, depth: int, to: Reading) -> Node | None:
        if depth == len(self.path):
            return self.node
        name = self.path[depth]
        if node is None or (isinstance(node, Scalar) and node.empty):
            node = Mapping(span=self.node.span, entries=())
        if isinstance(node, Mapping):
            inner = self._within(node.get(name), depth + 1, to)
            return None if inner is None else self._with(node, name, inner)
        where = ".".join(self.path[:depth])
        if isinstance(node, Listing):
            if not name.isdecimal() or int(name) >= len(node.items):
                message = f"`{where}` is a list of {len(node.items)}, which has no `{short(name)}`"
                to.fault("GS704", self.node.span, message, f"places are 0 to {len(node.items) - 1}")
                return None
            inner = self._within(node.items[int(name)], depth + 1, to)
            if inner is None:
                return None
            items = (*node.items[: int(name)], inner, *node.items[int(name) + 1 :])
            return replace(node, items=items)
        message = f"`{where}` is {article_of(node)} in the file, which has no `{short(name)}` to change"
        to.fault("GS706", self.node.span, message, f"change `{where}` as a whole", related=node.span)
        return None

    def _with(self, node: Mapping, name: str, inner: Node) -> Mapping:
        if any(key.text == name for key, _ in node.entries):
            entries = tuple((key, inner if key.text == name else value) for key, value in node.entries)
        else:
            entries = (*node.entries, (Scalar(span=self.node.span, text=name), inner))
        return replace(node, entries=entries)


def path_of(text: str) -> tuple[str, ...] | None:
    """The path that `tools.1.diameter` means; None where a part of it is empty."""
    parts = tuple(part.strip() for part in text.split("."))
    return parts if all(parts) else None

"""The version of a file's form: `gcodesim: 1` in a cell."""

from __future__ import annotations

from typing import Any

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Json, Kind
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.plain_kinds import Whole
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.frozen import frozen


@frozen(kw_only=False)
class FormVersionKind(Kind):
    """The one version that is read. In a file of another, the same words may mean something else."""

    version: int = 1

    @property
    def expected(self) -> str:
        return f"`{self.version}`"

    def read(self, node: Node, to: Reading, path: Path) -> int | Unread:
        said = Whole().read(node, to, path)
        if isinstance(said, Unread) or said == self.version:
            return said
        message = f"the form is version {said}; this gcodesim reads version {self.version}"
        return to.fault("GS711", node.span, message, f"write `{path[-1]}: {self.version}`")

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"const": self.version}


def form_version(name: str, version: int = 1, quiet: bool = True) -> Any:
    """The key `name` of a file whose form has this version."""
    return key(FormVersionKind(version=version), "version of the form", name=name, default=version, quiet=quiet)

"""Folders of `package://` names."""

from __future__ import annotations

from typing import Any

from gcodesim.declarations.file_kind import FileValue
from gcodesim.declarations.kind import Json, Kind, scalar, short
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.frozen import frozen


@frozen(kw_only=False)
class PackageFolder(Kind):
    """The folder of a package, below the folder of the cell or one that the user allows."""

    @property
    def expected(self) -> str:
        return "the folder of a package"

    def read(self, node: Node, to: Reading, path: Path) -> FileValue | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        folder = to.shelf.folder / text.text
        if "\0" in text.text or not folder.is_dir():
            message = f"the folder of package `{path[-1]}` is not there; tried `{short(text.text)}` beside the cell"
            return to.fault("GS714", text.span, message)
        if not to.shelf.may_read(folder):
            return to.fault(
                "GS715",
                text.span,
                f"the folder `{short(text.text)}` of package `{path[-1]}` lies outside the cell's folder",
                "only who runs gcodesim can open it to a cell: `--allow-path DIR`, or GCODESIM_ALLOW_PATH",
            )
        to.shelf.packages[str(path[-1])] = folder
        return FileValue(name=text.text, path=folder)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "description": "a folder, relative to the cell"}

    def show(self, value: Any) -> Any:
        return value.name

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", value.name

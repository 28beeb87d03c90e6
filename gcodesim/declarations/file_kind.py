"""Names of files and folders: found in allowed places only, and hashed."""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import Any, Final

from gcodesim.declarations.files import Refused
from gcodesim.declarations.kind import Json, Kind, key_name, scalar, short
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.frozen import frozen

_WRONG: Final = {"folder": "is no folder", "file": "is a folder", "special": "is a pipe or a device"}


@frozen
class FileValue:
    """A file of the cell: `name` as written, `path` where it lies."""

    name: str
    path: FilePath


@frozen(kw_only=False)
class File(Kind):
    """The name of a file (or folder) that the cell reads."""

    what: str
    is_folder: bool = False
    hashed: bool = True

    @property
    def expected(self) -> str:
        return f"the name of {self.what}"

    def read(self, node: Node, to: Reading, path: Path) -> FileValue | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        own = to.shelf.seen_from_cell(text.text, text.span.file)
        found = to.shelf.locate(own, is_folder=self.is_folder)
        if not isinstance(found, Refused):
            if self.hashed and not self.is_folder:
                try:
                    to.shelf.open(own, found)
                except OSError as error:
                    return to.fault("GS714", text.span, f"`{short(text.text)}` cannot be read: {error.strerror}")
            return FileValue(name=own, path=found)
        name, whose = key_name(path), to.shelf.whose
        if found.reason == "outside":
            return to.fault(
                "GS715",
                text.span,
                f"`{name}` names `{short(text.text)}`, which lies outside the {whose}'s folder (tried `{found.tried}`)",
                f"move it beside the {whose}, or allow its folder by `--allow-path DIR`",
            )
        if found.reason == "package":
            package = text.text.removeprefix("package://").partition("/")[0]
            return to.fault(
                "GS714",
                text.span,
                f"the folder of package `{short(package)}` is not known",
                suggestion(package, sorted(to.shelf.packages)) or f"add `packages: {{{package}: folder}}`",
            )
        near = suggestion(text.text, list(to.shelf.left)) if self.is_folder else ""
        wrong = _WRONG.get(found.reason, "is not there")
        return to.fault(
            "GS714",
            text.span,
            f"`{name}`: {self.what} `{short(text.text)}` {wrong}; tried `{found.tried}` in the folder of the {whose}",
            near or f"names are relative to the {whose} file",
        )

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "description": f"{self.what}, relative to the cell"}

    def show(self, value: Any) -> Any:
        return value.name

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", value.name

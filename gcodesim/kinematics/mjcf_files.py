"""The files that an MJCF names: includes, meshes, pictures; found, and allowed, before MuJoCo opens them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Final

from gcodesim.kinematics.urdf_meshes import near_file
from gcodesim.kinematics.xml_lines import Faults, LinedElement, XmlError, parse_xml

_FOLDERS: Final = ("meshdir", "texturedir", "assetdir")
_MOST_FILES: Final = 1000  # that include each other


@dataclass(slots=True)
class MjcfFiles:
    """The files that the MJCF at `path` names. `may_read` says which are allowed; `found` are those that are there.

    Where a name lies depends on folders that any <compiler> may name, also one of an included file; MuJoCo opens one of
    the places that a name may mean, so all of them have to be allowed.
    """

    path: Path
    may_read: Callable[[Path], bool] | None
    faults: Faults
    found: list[Path] = field(default_factory=list)
    includes: bool = False

    def look(self, root: LinedElement) -> None:
        """Look for all files that `root` and what it includes name; findings about those that are not to be had."""
        documents = [(root, True)]
        for document, own in documents:  # grows while it is walked
            for e in _elements(document):
                if e.tag != "include":
                    continue
                self.includes = True
                for file in self._locate(e.get("file", ""), [""], e if own else None):
                    if len(documents) > _MOST_FILES:
                        self.faults.find("GS760", "the files of this MJCF include each other without end", e)
                        return
                    try:
                        documents.append((parse_xml(file.read_bytes()), False))
                    except (OSError, XmlError) as error:
                        message = f"the included `{file.name}` cannot be read: {error}"
                        self.faults.find("GS760", message, e if own else None, "save it as XML in UTF-8")
        folders = [""]
        for document, _ in documents:
            for e in _elements(document):
                folders += [e.get(key, "") for key in _FOLDERS if e.tag == "compiler"]
        folders = list(dict.fromkeys(folders))
        for document, own in documents:
            for e in _elements(document):
                if e.tag != "include":
                    for key in (key for key in e.attrib if key.startswith("file")):  # cubes have a picture a side
                        self._locate(e.get(key, ""), folders, e if own else None)

    def _locate(self, text: str, folders: list[str], e: LinedElement | None) -> list[Path]:
        """The files that a name may mean; none with a finding if there is none, or one that may not be read."""
        if not text or "\0" in text:
            return []
        above = self.path.parent
        names = [text, Path(text).name]  # `strippath` leaves out folders
        places = list(dict.fromkeys(above / folder / name for name, folder in product(names, folders)))
        files = [place for place in places if place.is_file()]
        if not files:
            tried = os.path.relpath(places[0], above)
            message = f"file `{text}` not found; tried `{tried}` from the folder of the MJCF"
            self.faults.find("GS761", message, e, near_file(places[0], text))
        for file in files:
            if self.may_read is not None and not self.may_read(file):
                tried = os.path.relpath(file, above)
                message = f"file `{text}` lies outside the folders that may be read (`{tried}`)"
                hint = "only who runs gcodesim can open a folder to a cell: `--allow-path DIR`, or GCODESIM_ALLOW_PATH"
                self.faults.find("GS762", message, e, hint)
                return []
        self.found += [file for file in files if file not in self.found]
        return files


def _elements(root: LinedElement) -> Iterator[LinedElement]:
    return (e for e in root.iter() if isinstance(e, LinedElement))

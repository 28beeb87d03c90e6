"""Where the mesh files of a URDF lie: beside it, or in the package that a name begins with."""

from __future__ import annotations

import difflib
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from gcodesim.kinematics.xml_lines import Faults, LinedElement

_IN_PACKAGE: Final = ("package://", "model://")
EXPAND: Final = "this is for xacro to fill in: `pip install 'gcodesim[xacro]'`, then `xacro FILE > robot.urdf`"
_ELSEWHERE: Final = ("http://", "https://", "ftp://")


@dataclass(slots=True)
class MeshFiles:
    """The mesh files of the URDF at `path`.

    `packages` maps the names in package:// to folders. A package that is not in it is looked for where ROS has it: a
    folder of that name at or beside a folder above the URDF, among those that `may_read` allows.
    """

    path: Path
    packages: Mapping[str, Path]
    may_read: Callable[[Path], bool] | None
    faults: Faults
    found: list[Path] = field(default_factory=list)
    _unknown: dict[str, list[LinedElement]] = field(default_factory=dict)

    def locate(self, e: LinedElement) -> Path | None:
        """The file that a <mesh> names, or None with a finding that names the path tried."""
        text = e.get("filename", "")
        if text.startswith(_ELSEWHERE) or "$(" in text or "\0" in text:
            hint = (
                "nothing is fetched from a network: put the file beside the URDF"
                if text.startswith(_ELSEWHERE)
                else EXPAND
            )
            self.faults.find("GS761", f"mesh `{text}` is no name of a file", e, hint)
            return None
        file = self._spelled(text, e)
        if file is None:
            return None
        tried = os.path.relpath(file, self.path.parent)
        if self.may_read is not None and not self.may_read(file):
            hint = "only who runs gcodesim can open a folder to a cell: `--allow-path DIR`, or GCODESIM_ALLOW_PATH"
            self.faults.find("GS762", f"mesh `{text}` lies outside the folders that may be read (`{tried}`)", e, hint)
            return None
        if not text or not file.is_file():
            message = f"mesh `{text}` not found; tried `{tried}` from the folder of the URDF"
            self.faults.find("GS761", message, e, near_file(file, text))
            return None
        if file not in self.found:
            self.found.append(file)
        return file

    def report_packages(self) -> None:
        """One finding for each package whose folder is not known, at its first mesh."""
        known = ", ".join(f"`{p}`" for p in sorted(self.packages)) or "none"
        for package, meshes in self._unknown.items():
            message = f"mesh `{meshes[0].get('filename', '')}`: the folder of package `{package}` is not known"
            hint = f"add `packages: {{{package}: folder}}` to the cell; packages known: {known}"
            self.faults.find("GS761", message, meshes[0], hint, count=len(meshes))

    def _spelled(self, text: str, e: LinedElement) -> Path | None:
        """The path that a name means; None if its package is not known."""
        scheme = next((s for s in _IN_PACKAGE if text.startswith(s)), None)
        if scheme is None:
            return self.path.parent / text.removeprefix("file://")
        package, _, inner = text.removeprefix(scheme).lstrip("/").partition("/")
        if package in self.packages:
            return self.packages[package] / inner
        folder = next((f for f in self._folders_of(package) if (f / inner).is_file()), None)
        if folder is None:
            self._unknown.setdefault(package, []).append(e)
            return None
        return folder / inner

    def _folders_of(self, package: str) -> Iterator[Path]:
        """Folders of that name at and beside those above the URDF, the nearest first."""
        if package in ("", ".", "..") or "\0" in package:
            return
        for above in self.path.absolute().parents:
            for folder in (above, above / package):
                if folder.name == package and (self.may_read is None or self.may_read(folder)):
                    yield folder


def near_file(file: Path, text: str) -> str:
    """A file that may be meant; case counts, also where the URDF comes from a system where it does not."""
    if "\\" in text:
        return "folders are separated by `/`"
    try:
        names = sorted(entry.name for entry in os.scandir(file.parent))
    except OSError:
        return "names are relative to the URDF; `package://NAME/…` is relative to a package of the cell's `packages`"
    by_lower = {name.lower(): name for name in names if Path(name).suffix.lower() == file.suffix.lower()}
    close = difflib.get_close_matches(file.name.lower(), by_lower, n=1, cutoff=0.8)
    if not close:
        return "get the meshes that belong to the URDF, or take the <mesh> out"
    folder, slash, _ = text.rpartition("/")
    return f"did you mean `{folder}{slash}{by_lower[close[0]]}`?"

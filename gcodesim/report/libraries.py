"""Scripts by others that a page contains, from the packages in which they are installed."""

from __future__ import annotations

import io
import re
import zipfile
from importlib.metadata import PackageNotFoundError, distribution
from typing import Final, NamedTuple

_SCENE_FILE: Final = "trimesh/resources/templates/viewer.zip"
_CHART_FOLDER: Final = "metaflow_extensions/card_uplot/plugins/cards/uplot/uplot"


class LibraryMissingError(Exception):
    """An installed package does not have the script that it should; the text says which."""


class WebLibrary(NamedTuple):
    """A script and the style that it needs."""

    script: str
    style: str


def scene_library() -> str:
    """three.js (MIT), which trimesh carries for its own viewer; the page says `THREE`."""
    packed = _read("trimesh", _SCENE_FILE)
    with zipfile.ZipFile(io.BytesIO(packed)) as archive:
        template = archive.read(archive.namelist()[0]).decode()
    found = re.search(r"<script>(.*?)</script>", template, re.DOTALL)
    if found is None or "Three.js Authors" not in found[1]:
        raise LibraryMissingError("this version of trimesh carries no three.js; 4.4 to 5.2 do")
    # the viewer's own part follows the library and is not needed
    return found[1].split("(function(){const _changeEvent")[0]


def chart_library() -> WebLibrary:
    """uPlot (MIT), from the package of extra `report`."""
    script = _read("metaflow-card-uplot", f"{_CHART_FOLDER}/uPlot.iife.min.js").decode()
    style = _read("metaflow-card-uplot", f"{_CHART_FOLDER}/uPlot.min.css").decode()
    return WebLibrary(script, style)


def _read(package: str, file: str) -> bytes:
    """A file of an installed package, found without importing it."""
    try:
        path = distribution(package).locate_file(file)
        return path.read_bytes()  # type: ignore[attr-defined, no-any-return]
    except (PackageNotFoundError, OSError):
        raise LibraryMissingError(f"{package} is installed here without {file.rpartition('/')[2]}") from None

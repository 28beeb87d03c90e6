"""`gcodesim.yaml`: settings for all programs in a folder and below. `format` has the style of a shop."""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import Final

from gcodesim.declarations.files import Shelf
from gcodesim.declarations.form_version import form_version
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Json, document
from gcodesim.declarations.nodes import compose
from gcodesim.declarations.reading import Reading
from gcodesim.declarations.record import Record
from gcodesim.diagnostics import Diagnostic, Findings, SourceText
from gcodesim.formatting.style import Style
from gcodesim.frozen import frozen

NAME: Final = "gcodesim.yaml"


@frozen
class ShopSettings:
    """All keys of the file."""

    gcodesim_settings: int = form_version("gcodesim-settings")
    format: Style = key(Record(Style, "`format`"), "how `gcodesim fmt` writes programs", default=Style())


_ROOT: Final = Record(ShopSettings, "the settings")


@frozen
class FoundStyle:
    """The style that a file says, or the house style without one (`source` None); None after a finding."""

    style: Style | None = Style()
    source: SourceText | None = None
    findings: tuple[Diagnostic, ...] = ()


def style_for(program: FilePath) -> FoundStyle:
    """The style for programs beside `program`: that of the nearest `gcodesim.yaml`, in its folder or above.

    Folders above the top of the repository are not looked at. OSError when the file cannot be read.
    """
    folder = program.resolve().parent
    for above in (folder, *folder.parents):
        if (above / NAME).is_file():
            return read_style(SourceText.read(above / NAME, NAME), above)
        if (above / ".git").exists():
            break
    return FoundStyle()


def read_style(source: SourceText, folder: FilePath) -> FoundStyle:
    """The style that the settings in `folder` say."""
    findings = Findings()
    to = Reading(file=source.name, findings=findings, shelf=Shelf(folder=folder, whose="settings"))
    root = compose(source, findings, what="settings file", example="format: {case: lower}")
    read = None if root is None else _ROOT.read(root, to, ())
    style = read.format if isinstance(read, ShopSettings) and not findings.has_errors() else None
    return FoundStyle(style=style, source=source, findings=tuple(findings))


def settings_schema() -> Json:
    """JSON Schema (2020-12) of `gcodesim.yaml`, for editors."""
    definitions: dict[str, Json] = {}
    root = _ROOT.schema(definitions)
    return document("gcodesim settings", root, definitions)

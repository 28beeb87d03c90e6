"""Values out of a line of YAML, for tests of kinds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gcodesim.declarations.files import Shelf
from gcodesim.declarations.kind import Kind
from gcodesim.declarations.nodes import compose
from gcodesim.declarations.reading import Reading
from gcodesim.diagnostics import Findings, SourceText


def read(kind: Kind, value: str, folder: Path = Path()) -> tuple[Any, Reading]:
    """What `kind` makes of `x: value`, and what the reading has noted."""
    source = SourceText("x.yaml", f"x: {value}\n".encode())
    to = Reading(file=source.name, findings=Findings(), shelf=Shelf(folder=folder))
    root = compose(source, to.findings)
    assert root is not None
    return kind.read(root.entries[0][1], to, ("x",)), to


def codes(to: Reading) -> list[str]:
    return [finding.code for finding in to.findings]

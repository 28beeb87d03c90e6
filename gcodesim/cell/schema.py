"""The JSON Schema of cell files, from the same declarations that the reader uses."""

from __future__ import annotations

from gcodesim.cell.loader import ROOT
from gcodesim.declarations.kind import Json, document


def cell_schema() -> Json:
    """JSON Schema (2020-12) of a cell, for editors; rules that it cannot express are checked on reading."""
    definitions: dict[str, Json] = {}
    root = ROOT.schema(definitions)
    machines = {"anyOf": [{"required": ["machine"]}, {"required": ["robots"]}]}
    return document("gcodesim cell", root | machines, definitions)

"""The JSON Schema of cell files, from the same declarations that the reader uses."""

from __future__ import annotations

from gcodesim.cell.loader import ROOT
from gcodesim.declarations.kind import SCHEMA_DIALECT, Json


def cell_schema() -> Json:
    """JSON Schema (2020-12) of a cell, for editors; rules that it cannot express are checked on reading."""
    definitions: dict[str, Json] = {}
    root = ROOT.schema(definitions)
    return {
        "$schema": SCHEMA_DIALECT,
        "title": "gcodesim cell",
        **root,
        "anyOf": [{"required": ["machine"]}, {"required": ["robots"]}],
        "$defs": {name: definitions[name] for name in sorted(definitions)},
    }

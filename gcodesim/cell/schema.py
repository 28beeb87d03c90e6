"""The JSON Schema of cell files and the table of units, both out of what the reader itself uses."""

from __future__ import annotations

from gcodesim.cell.loader import ROOT
from gcodesim.declarations.kind import Json
from gcodesim.declarations.units import DIMENSIONS, table

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def cell_schema() -> Json:
    """JSON Schema (2020-12) of a cell, for editors; what it cannot say is checked on reading."""
    definitions: dict[str, Json] = {}
    root = ROOT.schema(definitions)
    return {
        "$schema": DIALECT,
        "title": "gcodesim cell",
        **root,
        "anyOf": [{"required": ["machine"]}, {"required": ["robots"]}],
        "$defs": {name: definitions[name] for name in sorted(definitions)},
    }


def unit_table() -> Json:
    """Units by dimension; `plain` dimensions may go without one."""
    return {
        name: {"plain": DIMENSIONS[name].plain, "units": {unit: list(aliases) for unit, aliases in units.items()}}
        for name, units in table().items()
    }


def units_as_text() -> str:
    """The table of units for people, one dimension a line."""
    width = max(len(name) for name in DIMENSIONS)
    lines = []
    for name, units in table().items():
        spelled = [f"{unit} ({', '.join(aliases)})" if aliases else unit for unit, aliases in units.items()]
        without = "  or a plain number" if DIMENSIONS[name].plain else ""
        lines.append(f"{name:<{width}}  {', '.join(spelled)}{without}")
    return "\n".join(lines)

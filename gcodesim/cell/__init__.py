"""The cell: a YAML file → a frozen description in SI. `load_cell` reads, `placement.place` says where things are.

Names are imported on first use, so that a command that needs no cell does not pay for the reader.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gcodesim.cell.cell import Cell, LoadedCell
    from gcodesim.cell.loader import load_cell, read_cell
    from gcodesim.cell.placement import Placement, place

_PLACES = {
    "Cell": "cell",
    "LoadedCell": "cell",
    "load_cell": "loader",
    "read_cell": "loader",
    "Placement": "placement",
    "place": "placement",
}

__all__ = ["Cell", "LoadedCell", "Placement", "load_cell", "place", "read_cell"]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(name)
    from importlib import import_module

    return getattr(import_module(f"gcodesim.cell.{_PLACES[name]}"), name)

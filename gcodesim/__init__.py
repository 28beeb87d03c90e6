"""Simulate G-code-driven manufacturing cells: programs, robots and machine tools, material and process forces.

    path = gcodesim.read("part.nc")                                  # ToolPath
    cell = gcodesim.load_cell("cell.yaml")                           # Cell
    results = gcodesim.simulate("part.nc", "cell.yaml", out="out")   # Results

Names are imported on first use, so that a light command does not pay for the heavy packages.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from gcodesim.version import __version__

if TYPE_CHECKING:
    from gcodesim.api import InputError, load_cell, read, simulate
    from gcodesim.cell import Cell
    from gcodesim.jobs.results import Results
    from gcodesim.motion import (
        ToolPath,
        build_box_path,
        circular_interpolation,
        linear_interpolation,
        spline_interpolation,
    )
    from gcodesim.session import open_cell

_PLACES = {
    "Cell": "gcodesim.cell",
    "InputError": "gcodesim.api",
    "Results": "gcodesim.jobs.results",
    "ToolPath": "gcodesim.motion",
    "build_box_path": "gcodesim.motion",
    "circular_interpolation": "gcodesim.motion",
    "linear_interpolation": "gcodesim.motion",
    "load_cell": "gcodesim.api",
    "open_cell": "gcodesim.session",
    "read": "gcodesim.api",
    "simulate": "gcodesim.api",
    "spline_interpolation": "gcodesim.motion",
}

__all__ = [
    "Cell",
    "InputError",
    "Results",
    "ToolPath",
    "__version__",
    "build_box_path",
    "circular_interpolation",
    "linear_interpolation",
    "load_cell",
    "open_cell",
    "read",
    "simulate",
    "spline_interpolation",
]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_PLACES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

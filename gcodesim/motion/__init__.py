"""Moves without a machine: the tool path, how its rows are joined, and the time law. Does not know robots."""

from gcodesim.motion.build import build_tool_path
from gcodesim.motion.builders import (
    build_box_path,
    circular_interpolation,
    linear_interpolation,
    spline_interpolation,
)
from gcodesim.motion.tool_path import PathEvent, ToolPath, ToolState

__all__ = [
    "PathEvent",
    "ToolPath",
    "ToolState",
    "build_box_path",
    "build_tool_path",
    "circular_interpolation",
    "linear_interpolation",
    "spline_interpolation",
]

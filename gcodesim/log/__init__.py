"""The log of a run: one MCAP file that opens in Foxglove or Lichtblick. Takes columns, whoever made them."""

from gcodesim.log.blocks import BlockColumns, BlockMessages
from gcodesim.log.byte_strings import ByteStrings
from gcodesim.log.container import LogWriteError
from gcodesim.log.description import LogDescription, MotionColumns, ProcessColumns, ProcessField, StaticFrame
from gcodesim.log.layout import View, ViewerCamera, layout
from gcodesim.log.messages import OutputState, ProgramShown
from gcodesim.log.shapes import DrawnMesh, DrawnShape, DrawnSolid, Entity, PathPart, Polylines
from gcodesim.log.writer import LogWriter

__all__ = [
    "BlockColumns",
    "BlockMessages",
    "ByteStrings",
    "DrawnMesh",
    "DrawnShape",
    "DrawnSolid",
    "Entity",
    "LogDescription",
    "LogWriteError",
    "LogWriter",
    "MotionColumns",
    "OutputState",
    "PathPart",
    "Polylines",
    "ProcessColumns",
    "ProcessField",
    "ProgramShown",
    "StaticFrame",
    "View",
    "ViewerCamera",
    "layout",
]

"""A cell that a Python program moves step by step; world, stock, log and findings are those of a run."""

from gcodesim.session.arm import Arm, JointState
from gcodesim.session.cell_in_hand import OpenCell, open_cell
from gcodesim.session.misuse import MisuseError
from gcodesim.session.tool_in_hand import HandTool

__all__ = ["Arm", "HandTool", "JointState", "MisuseError", "OpenCell", "open_cell"]

"""A cell that a Python program moves step by step; world, stock, log and findings are those of a run."""

from gcodesim.session.open_cell import Arm, HandTool, JointState, MisuseError, OpenCell, open_cell

__all__ = ["Arm", "HandTool", "JointState", "MisuseError", "OpenCell", "open_cell"]

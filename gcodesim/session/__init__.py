"""A cell that a Python program moves step by step; world, stock, log and findings are those of a run."""

from gcodesim.session.cell_in_hand import Arm, HandTool, JointState, MisuseError, OpenCell, open_cell

__all__ = ["Arm", "HandTool", "JointState", "MisuseError", "OpenCell", "open_cell"]

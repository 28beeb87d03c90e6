"""Taking up a program at one of its lines: the file for the control, and the stock that is there then."""

from gcodesim.restart.program import Restart, restart_of

__all__ = ["Restart", "restart_of"]

"""A tool path on a real machine: joints, limits, and when everything happens."""

from gcodesim.planning.machine_tool import plan_machine, start_of_machine
from gcodesim.planning.plan import JointExtremes, Plan

__all__ = ["JointExtremes", "Plan", "plan_machine", "start_of_machine"]

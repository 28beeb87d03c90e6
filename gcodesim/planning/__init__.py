"""A tool path on a real machine: joints, limits, and when everything happens."""

from gcodesim.planning.arm import plan_arm, start_of_arm
from gcodesim.planning.machine_tool import plan_machine, start_of_machine
from gcodesim.planning.orientation import Orientation
from gcodesim.planning.plan import JointExtremes, Plan

__all__ = [
    "JointExtremes",
    "Orientation",
    "Plan",
    "plan_arm",
    "plan_machine",
    "start_of_arm",
    "start_of_machine",
]

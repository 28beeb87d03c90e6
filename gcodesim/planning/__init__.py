"""A tool path on a real machine: joints, limits, and when everything happens."""

from gcodesim.planning.axis_posing import AxisPosing
from gcodesim.planning.fixed_attitude import FixedAttitude
from gcodesim.planning.plan import JointExtremes, Plan
from gcodesim.planning.posing import Posing, plan_path
from gcodesim.planning.shop_posing import posing_of

__all__ = [
    "AxisPosing",
    "FixedAttitude",
    "JointExtremes",
    "Plan",
    "Posing",
    "plan_path",
    "posing_of",
]

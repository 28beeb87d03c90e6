"""A tool path on a real machine: joints, limits, and when everything happens."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gcodesim.planning.axis_posing import AxisPosing
from gcodesim.planning.plan import JointExtremes, Plan
from gcodesim.planning.posing import Posing, plan_path
from gcodesim.planning.shop_posing import posing_of

if TYPE_CHECKING:
    from gcodesim.planning.fixed_attitude import FixedAttitude

__all__ = [
    "AxisPosing",
    "FixedAttitude",
    "JointExtremes",
    "Plan",
    "Posing",
    "plan_path",
    "posing_of",
]


def __getattr__(name: str) -> Any:
    """Load what only arms need when it is asked for."""
    if name != "FixedAttitude":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from gcodesim.planning.fixed_attitude import FixedAttitude

    return FixedAttitude

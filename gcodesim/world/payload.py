"""What a tool weighs on the flange, for laws of motion."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from gcodesim.kinematics.chain import Inertial
from gcodesim.world.body import ToolBody


@lru_cache(maxsize=64)
def payload_of(tool: ToolBody | None) -> Inertial | None:
    """Mass properties of a tool in axes of F, the same object for the same tool; None without one or without mass."""
    if tool is None or tool.mass <= 0.0:
        return None
    xx, yy, zz, xy, xz, yz = tool.inertia
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertial(mass=tool.mass, com=np.array(tool.com), inertia=inertia)

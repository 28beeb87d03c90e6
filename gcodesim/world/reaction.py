"""The wrench between flange and tool, from how the tool moves and what acts on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.frames import Array
from gcodesim.kinematics.machine import rows
from gcodesim.world.body import ToolBody

if TYPE_CHECKING:
    from gcodesim.kinematics.machine import Machine


def tool_reaction(
    machine: Machine, tool: ToolBody | None, q: Array, qd: Array, wrench: Array, gravity_B: Array, dt: float
) -> Array:
    """Wrench (n, 6) of the flange on `tool` at F, base axes, force then torque; zero without a tool.

    Newton and Euler for one rigid body: ``f = m (a - g) - F`` and the balance of
    moments about F. `q`, `qd` (n + 1, j) start with the state before the first
    step; `wrench` (n, 6) acts on the tool at the tip, base axes; `gravity_B`
    (3,) in base axes. Accelerations are differences over one step `dt` [s].

    Bullet has a force sensor for this, but its reading contains a term in
    (qdd_free dt)², the velocity that joints would have without motors, which
    is 0.5 % of a wrench on a small arm at 4 ms.
    """
    n = len(wrench)
    if tool is None or n == 0:
        return np.zeros((n, 6))
    from gcodesim.world.reaction_kernels import FlangeLoad, reactions

    xx, yy, zz, xy, xz, yz = tool.inertia
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    load = FlangeLoad(float(tool.mass), np.array(tool.com, dtype=float), np.array(tool.X_FT.p, dtype=float), inertia)
    out = np.empty((n, 6))
    gravity = np.array(gravity_B, dtype=float)
    reactions(rows(q), rows(qd), rows(wrench), gravity, float(dt), machine.chain.tree, load, out)
    return out

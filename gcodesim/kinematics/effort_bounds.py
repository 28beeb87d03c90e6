"""How great the efforts of a motion can be at most, wherever the arm stands: looked at before they are worked out."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np

from gcodesim.arithmetic.matrices import norms
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain, Inertial
from gcodesim.kinematics.dynamics import bodies

ROUNDING: Final = 1.0 + 1e-9
"""By which bounds are widened for sums in another order."""


@frozen(eq=False)
class EffortBounds:
    """Bounds on efforts of j revolute joints: `weight` (j,) per m/s² of gravity, `inertia` (j, j) per rad/s² of each
    joint, and `swing` (j,) per rad²/s² of the square of all speeds together.

    No link is longer than it is, so body k is never farther from joint i than the links between them laid end to end,
    R_ik. Its acceleration is then at most Σ_i R_ik |q̈_i| + 2 R_0k S² with S = Σ |q̇|: one S² for what spins carry
    inwards, one for axes that other joints turn. The moment about joint i takes m_k R_ik times that, and what turns
    body k itself.
    """

    weight: Array
    inertia: Array
    swing: Array


@lru_cache(maxsize=32)
def effort_bounds(chain: Chain, payload: Inertial | None) -> EffortBounds | None:
    """Those of a chain with `payload` (axes of F) on its flange; None where a joint shifts, so that links grow."""
    tree = chain.tree
    if tree.prismatic.any():
        return None
    count = len(tree.parent)
    link = norms(tree.before[:, :3, 3])
    weight, inertia, swing = np.zeros(count), np.zeros((count, count)), np.zeros(count)
    for k, body in enumerate(bodies(chain, payload)):
        far, own = np.full(count, -1.0), float(np.sqrt(np.square(body.inertia).sum()))
        reach, joint = float(norms(np.asarray(body.com, dtype=float))), k
        while joint >= 0:
            far[joint] = reach
            reach += float(link[joint])
            joint = int(tree.parent[joint])
        moves = np.flatnonzero(far >= 0.0)
        arm = body.mass * far[moves]
        weight[moves] += arm
        inertia[np.ix_(moves, moves)] += arm[:, None] * far[moves] + own
        swing[moves] += 2.0 * (arm * reach + own)
    return EffortBounds(weight=weight, inertia=inertia, swing=swing)

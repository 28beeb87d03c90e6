"""Where a run stands between two legs, and what still moves while its machines stand."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from gcodesim.frames import Array
from gcodesim.frozen import frozen

Going = Callable[[int, int], Array]
"""X_WF (n, 4, 4) of a body at the halt and in the steps after it, from a step (0: the halt itself) on."""


@frozen(eq=False)
class RunHalt:
    """Machines with joints (j,) by their names, the `tool` on the flange of the own one, a gripper `opening` (0 to 1).

    `moving` are parts and devices by their frames: they go on by belts, travels and falls that have begun.
    """

    joints: Mapping[str, Array]
    tool: int
    opening: float
    moving: Mapping[str, Going]

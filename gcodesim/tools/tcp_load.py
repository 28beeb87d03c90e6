"""A load at the tip of a tool that no process makes: a hose that pulls, a spring, a weight, a measured force."""

from __future__ import annotations

from typing import Final

from gcodesim.declarations.keys import key
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.frozen import frozen

LOAD_FRAMES: Final = ("world", "tool")


@frozen
class TcpLoad:
    """Force [N] and torque [N·m] on the tool at its tip; in axes of the world, or of the tool, with which they turn."""

    force: tuple[float, ...] = key(
        Vector(Quantity("force"), 3, "[0, 0, -50 N]"), "on the tool at its tip", default=(0.0, 0.0, 0.0)
    )
    torque: tuple[float, ...] = key(
        Vector(Quantity("torque"), 3, "[0, 0, 2 N·m]"), "on the tool", default=(0.0, 0.0, 0.0)
    )
    frame: str = key(
        Choice(LOAD_FRAMES, "axes"), "whose axes both are meant in; `tool`: they turn with it", default="world"
    )

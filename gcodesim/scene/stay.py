"""Where a part has been for how long: what remains of a run of its holds."""

from __future__ import annotations

from math import inf

from gcodesim.frames import Pose
from gcodesim.frozen import frozen


@frozen(eq=False)
class Stay:
    """From `begin` to `end` [s] the part whose frame is `body` stands at `X` of `parent`; see `Hold`, `PartChange`.

    `holder` is who grips it, empty when nobody does, and `opening` (0 to 1) how far open its fingers are then. On a
    belt the part goes along for at most `room` [m].
    """

    body: str
    parent: str
    X: Pose
    begin: float = 0.0
    end: float = inf
    holder: str = ""
    opening: float = 1.0
    room: float = inf

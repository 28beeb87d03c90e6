"""A controller that knows what pushes the arm."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.controllers import Sense
from gcodesim.controllers.flexible import Flexible
from gcodesim.declarations.keys import key
from gcodesim.frames import Array
from gcodesim.frozen import frozen


@frozen(slots=False, eq=False)
class Steady(Flexible):
    """Turns motors further by a share of what the measured force winds up in the gears."""

    kind: ClassVar[str] = "steady"

    share: float = key("ratio", "of the bend for which it makes up", default=1.0)

    def aim(self, sense: Sense) -> Array:
        return sense.q_ref - self.share * (sense.model.jacobian(sense.q).T @ sense.wrench) / sense.model.gears

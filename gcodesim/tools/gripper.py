"""What grippers of any kind have in common: they hold a part, and let it go."""

from __future__ import annotations

from typing import ClassVar, Final

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.tools.tool import Tool

FRICTION: Final = 0.3
"""Between a gripper and a part where neither names a coefficient: dry steel or rubber on what is not quite clean."""


@frozen
class PadFaces:
    """Two pads across X of T: their faces at `left` and `right` [m], `width` along Y, `length` up from the tip."""

    left: float
    right: float
    width: float
    length: float
    thickness: float


@frozen
class Gripper(Tool):
    """A tool that carries parts. Opening 0 is closed, 1 is open.

    A contact is a row x, y, z [m] in T and a width [m]: a pad of a finger, or a cup.
    """

    process: ClassVar[str] = "gripping"

    closing_time: float = key(
        Quantity("time", NOT_NEGATIVE), "from open to closed; the part is held when it is over", default=0.0
    )
    safety: float = key(
        Quantity("ratio", POSITIVE),
        "how often the grip should have the force that it needs; with less of a reserve, a warning",
        default=1.0,
        example="2",
    )
    friction: float | None = key(
        Quantity("ratio", POSITIVE),
        "between it and a part; of two coefficients the lesser counts",
        default=None,
        rule="that of the part, else 0.3",
        example="0.5",
    )

    def mu(self, part: float | None) -> float:
        """Coefficient of friction between the gripper and a part with one of its own, or None."""
        known = [value for value in (self.friction, part) if value is not None]
        return min(known) if known else FRICTION

    def has(self, contacts: Array) -> float:
        """The force [N] with which it holds at contacts (c, 4); compared with `needs`."""
        raise NotImplementedError

    def needs(self, load: Array, moment: Array, mu: float, contacts: Array) -> Array:
        """Force (n,) [N] that holds `load` (n, 3) [N] and `moment` (n, 3) [N·m] about the tip, in T, at contacts."""
        raise NotImplementedError

    def contacts(self, skin: Array, opening: float) -> tuple[Array, float] | None:
        """Contacts (c, 4) with a body of triangles (t, 3, 3) in T, and the opening (0 to 1) then; None: no contact."""
        raise NotImplementedError

    def too_wide(self, skin: Array, opening: float) -> float | None:
        """The opening [m] that a body between the fingers takes, if that is more than there is; else None."""
        return None

    def pads(self, contacts: Array) -> PadFaces | None:
        """Its pads on a part at contacts (c, 4), if that is held by contact alone; None: by the rule of statics."""
        return None

    @property
    def widest(self) -> float:
        """The greatest opening [m]; 0 where nothing moves."""
        return 0.0

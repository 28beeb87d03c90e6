"""Bodies of a scene: solids and their role."""

from __future__ import annotations

from typing import Final, Literal

from gcodesim.frozen import frozen
from gcodesim.solids import Placed

Role = Literal["link", "tool", "holder", "fixture", "stock", "part", "obstacle", "loose"]
"""`loose` is a piece of a stock that came loose in a run."""

PUT: Final[frozenset[Role]] = frozenset(("part", "loose"))
"""The roles of what a `Stay` puts somewhere."""


@frozen(eq=False)
class Body:
    """A rigid thing. `name` is that of its frame in the scene, in which its solids are placed; see `Scene.frames`.

    `mass` [kg] and `friction` [-] are None where they are not needed. Which bodies are checked against each other
    follows from their roles.
    """

    name: str
    solids: tuple[Placed, ...]
    role: Role
    mass: float | None = None
    friction: float | None = None

    @property
    def label(self) -> str:
        """Its name in messages: `vise` of `fixture/vise`."""
        return self.name.rpartition("/")[2]

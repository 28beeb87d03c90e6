"""Where things stand: a pose in a named frame, and how chains of frames resolve to the world or to a link."""

from __future__ import annotations

import re
from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from typing import Final

from gcodesim.canon.systems import SYSTEM_PATTERN, SYSTEMS, system_name
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import WITHIN_REACH, Json, Kind, scalar
from gcodesim.declarations.map_of import NameRule
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import UNREAD, Path, Reading, Reference, Unread
from gcodesim.frames import WORLD, Pose
from gcodesim.frozen import frozen

MACHINE: Final = "machine"
RESERVED: Final = (WORLD, MACHINE, "tool", "tcp", "part", "camera", "flange", "base")

_NAME = r"[A-Za-z_][A-Za-z0-9_-]*"


def _plain_name(text: str) -> str | None:
    return text if re.fullmatch(_NAME, text) and text not in RESERVED and system_name(text) is None else None


def names_of(what: str) -> NameRule:
    """Names that a user chooses; the names of our own frames are taken."""
    return NameRule(
        what=f"{what} name (letters, digits, `_`, `-`, a letter or `_` first; not {', '.join(RESERVED)})",
        pattern=_NAME,
        canonical=_plain_name,
    )


SYSTEM_NAMES: Final = NameRule(what="work system", pattern=SYSTEM_PATTERN, canonical=system_name, known=SYSTEMS)


@frozen(kw_only=False)
class _FrameName(Kind):
    """The name of a frame; its existence is checked once the whole cell has been read."""

    @property
    def expected(self) -> str:
        return "the name of a frame, or of a link such as `arm/flange`"

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        name = system_name(text.text) or text.text
        to.references.append(Reference(what="frame", name=name, path=path))
        return name

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string"}


FRAME = _FrameName()
POINT = Vector(Quantity("length", WITHIN_REACH), 3)
_ANGLES = Vector(Quantity("angle"), 3, "[0, 0, 90 deg]")
_ZERO = (0.0, 0.0, 0.0)


@frozen
class Place:
    """A pose in a frame: `xyz`, then `rpy` about the fixed axes X, Y, Z of that frame.

    `frame` None: the meaning depends on the owner (the world; for stock, G54).
    """

    frame: str | None = key(FRAME, "what it stands in", name="in", default=None)
    xyz: tuple[float, float, float] = key(
        POINT, "position in that frame", default=_ZERO, quiet=True, example="[650, 0, 400 mm]"
    )
    rpy: tuple[float, float, float] = key(_ANGLES, "roll, pitch, yaw about the fixed axes", default=_ZERO, quiet=True)

    @property
    def X(self) -> Pose:
        """The pose seen from its frame."""
        return Pose.from_xyz_rpy(self.xyz, self.rpy)


@frozen(kw_only=False, eq=False)
class Carried:
    """Where something stands on a link of a robot or machine: at `X` of `link`, such as `arm/flange`."""

    link: str
    X: Pose


@frozen(kw_only=False, eq=False)
class FixedLink:
    """A link of a robot that no joint moves: at `X` of the robot's base, the frame `frame`."""

    frame: str
    X: Pose


@dataclass(slots=True)
class FrameTree:
    """All frames by name, each placed in another one or on one of `links`; their places are found on demand."""

    placed: Mapping[str, tuple[Place | FixedLink, Path]]
    links: Container[str]
    to: Reading
    poses: dict[str, Pose] = field(default_factory=dict)
    carried: dict[str, Carried] = field(default_factory=dict)

    def resolve(self) -> None:
        """Fill `poses`, X_W of every frame that stands still, `world` first, and `carried`, those on links.

        Cycles become findings; unknown frames count as the world.
        """
        self.poses[WORLD] = Pose.identity()
        for name in self.placed:
            self._place(name, ())

    def _place(self, name: str, below: tuple[str, ...]) -> None:
        """Find where the frame `name` is, unless that is already known."""
        if name in self.poses or name in self.carried:
            return
        own, path = self.placed[name]
        parent = self._parent(own, path, (*below, name))
        if isinstance(parent, Carried):
            self.carried[name] = Carried(parent.link, parent.X @ own.X)
        else:
            self.poses[name] = parent @ own.X

    def _parent(self, own: Place | FixedLink, path: Path, chain: tuple[str, ...]) -> Pose | Carried:
        parent = own.frame or WORLD
        if parent in chain:
            circle = " in ".join(f"`{name}`" for name in (*chain[chain.index(parent) :], parent))
            self.to.fault(
                "GS713",
                self.to.span((*path, "in")),
                f"frames stand in a circle: {circle}",
                "one of them has to stand in `world`",
            )
            return Pose.identity()
        if parent in self.placed:
            self._place(parent, chain)
        elif parent in self.links:
            return Carried(parent, Pose.identity())
        if parent in self.carried:
            return self.carried[parent]
        return self.poses.get(parent) or Pose.identity()

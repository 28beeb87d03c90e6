"""What every tool has: a number, a length, a body, a mass."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from gcodesim.declarations.keys import fill_derived, key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frames import Pose
from gcodesim.frozen import frozen
from gcodesim.solids import Placed
from gcodesim.tools.body import MassProperties, Primitive, mass_properties
from gcodesim.tools.own_body import OwnBody
from gcodesim.tools.parts import Color, body_part
from gcodesim.tools.sections import Frustum, Holder, bodies_of, sizes_of, stacked
from gcodesim.tools.tcp import Tcp
from gcodesim.tools.tcp_load import TcpLoad
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.sensors.sensor import Sensor


@frozen
class Tool:
    """A tool on a spindle or flange; all lengths [m], angles [rad].

    Tool frame T: origin at the tip, Z from the holder to the tip; so the body lies on the negative Z axis. Heights
    (`bottom`, `top`, `length`) count from the tip towards the holder.
    """

    kind: ClassVar[str] = ""
    processes: ClassVar[tuple[str, ...]] = ()
    """Names in the PROCESSES family of what the tool does; none: it is only moved. Each acts on its own targets."""
    process: ClassVar[str] = ""
    """The same in short, for a kind of tool with one process."""

    number: int = 0
    name: str = key(
        "text", "name in messages", derive=lambda tool: f"T{tool.number}", rule="T and the number", quiet=True
    )
    length: float = key("length", "from the tip to the holder", default=100.0 * MM, example="100 mm")
    holder: Holder | None = key(Holder, "the holder; none: only the tool itself", default=None)
    mass: float | None = key(
        "mass",
        "mass of tool and holder",
        default=None,
        rule="that of steel bodies of this size",
        example="0.8 kg",
    )
    tcp: Tcp | None = key(
        Tcp, "its tip seen from the flange, where the tool is bent; none: straight out, by its length", default=None
    )
    body: OwnBody | None = key(
        OwnBody, "its own shape from a mesh or a URDF; none: simple bodies of its kind", default=None
    )
    load: TcpLoad | None = key(TcpLoad, "a force and torque at its tip besides those of its process", default=None)
    expected_force: float | None = key(
        Quantity("force", POSITIVE),
        "of the work on its tip in feed moves, in any direction: the timing of arms keeps motors able to give it",
        default=None,
        rule="none",
        quiet=True,
        example="300 N",
    )

    def __init_subclass__(cls) -> None:
        if "process" in vars(cls) and "processes" not in vars(cls):
            cls.processes = (cls.process,) if cls.process else ()

    def __post_init__(self) -> None:
        fill_derived(self)

    @property
    def acts_by(self) -> tuple[str, ...]:
        """Names in the PROCESSES family of all that happens at its tip: what it does, and its load."""
        return self.processes if self.load is None else ("loading", *self.processes)

    @property
    def true_length(self) -> float:
        """From the spindle nose or flange to the tip [m]: `length` and the holder's."""
        return self.length + (self.holder.height if self.holder else 0.0)

    @property
    def reach(self) -> float:
        """How far from its tip it acts [m]; 0 of a tool that has to touch."""
        return 0.0

    @property
    def X_FT(self) -> Pose:
        """Tip frame seen from the flange: straight out by the true length, or as `tcp` or `tip` of its body says."""
        bent = self._bent
        return Pose(np.array([0.0, 0.0, self.true_length]), np.eye(3)) if bent is None else bent

    @property
    def X_FN(self) -> Pose | None:
        """Its nose seen from the flange: where a straight tool of this length would hang; None of a straight tool.

        N has the axes of T and lies behind it by the true length: the nose of an angle head, the bend of a neck.
        """
        bent = self._bent
        return None if bent is None else bent @ Pose(np.array([0.0, 0.0, -self.true_length]), np.eye(3))

    @property
    def _bent(self) -> Pose | None:
        if self.tcp is not None:
            return self.tcp.X_FT
        return None if self.body is None else self.body.X_FT

    @property
    def is_driven(self) -> bool:
        """Whether it turns on a lathe, where other tools stand against work that turns."""
        return False

    @property
    def sensor(self) -> Sensor | None:
        """What it sees or feels with while it is on the flange, from its tip along Z; most tools are no sensor."""
        return None

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """Bodies for drawing and collision, from the tip up; each kind adds what is below the holder."""
        return self._holder_bodies()

    @property
    def plume(self) -> tuple[Primitive, ...]:
        """What it gives off beyond its tip while it is switched on, for drawing only; most tools show nothing."""
        return ()

    @property
    def round_parts(self) -> tuple[Primitive, ...]:
        """Those of its simple bodies that are there: of a tool with a body of its own, what touches the work."""
        return tuple(part for part in self.primitives if self._is_there(part.part))

    def drawn(self, opening: float = 1.0) -> list[tuple[str, Placed]]:
        """All of it by part, in T; a gripper `opening` (0 to 1) open."""
        shapes = [(part, placed) for part, placed in self.shapes(opening) if self._is_there(part)]
        return [*shapes, *self.own_shapes(opening)]

    def shapes(self, opening: float) -> list[tuple[str, Placed]]:
        """The simple bodies of its kind by part, in T, as they are drawn."""
        return [(body.part, body.placed) for body in self.primitives]

    def own_shapes(self, opening: float = 1.0) -> list[tuple[str, Placed]]:
        """The body that it has from a file, by part, in T."""
        if self.body is None:
            return []
        X_TF = self.X_FT.inverse()
        return [(part, placed.at(X_TF)) for part, placed in self.body.solids(opening)]

    def color_of(self, part: str) -> Color:
        """How a part of it is drawn."""
        own = None if self.body is None else self.body.color_of(part)
        return own or body_part(part).color

    def _is_there(self, part: str) -> bool:
        """Whether a simple body is seen: beside an own one only what touches the work, and fingers unless it has its
        own."""
        return self.body is None or (body_part(part).acts and not (self.body.moves and part == "finger"))

    @property
    def holder_frusta(self) -> tuple[Frustum, ...]:
        """The sections of the holder, from the tool up; none when the cell gives no holder."""
        return () if self.holder is None else stacked(self.holder.sections, self.length)

    def _holder_bodies(self) -> tuple[Primitive, ...]:
        return tuple(bodies_of("holder", self.holder_frusta))

    @property
    def inertia(self) -> MassProperties:
        """Mass, centre of mass and inertia; an estimate from steel bodies unless `mass` is given."""
        return mass_properties(self.primitives, self.mass)

    def problems(self) -> list[tuple[str, str]]:
        """What makes this tool impossible, as pairs (key, message); empty for a sound tool."""
        found = [
            (name, f"`{name}` must be greater than 0")
            for name, value in self._positive().items()
            if not (np.isfinite(value) and value > 0.0)
        ]
        if self.mass is not None and not self.mass > 0.0:
            found.append(("mass", "`mass` must be greater than 0"))
        if self.tcp is not None and self.body is not None and self.body.tip is not None:
            found.append(("tcp", "its tip is given twice, by `tcp` and by `tip` of its body; give one"))
        return found

    def _positive(self) -> dict[str, float]:
        """Values that only make sense above zero."""
        values: dict[str, Any] = {"length": self.length}
        if self.holder is not None:
            values |= sizes_of("holder", self.holder.sections)
        return values

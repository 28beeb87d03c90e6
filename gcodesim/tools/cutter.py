"""Rotating cutters: the common part of end mills and drills."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import atan2, cos
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Range
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.record import Record
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cylinder
from gcodesim.tools.sections import Frustum, Shank, bodies_of, sizes_of, stacked
from gcodesim.tools.sizes import exceeds
from gcodesim.tools.teeth import RAKE, is_uneven, teeth_problems
from gcodesim.tools.tool import Tool
from gcodesim.units import DEG, MM

if TYPE_CHECKING:
    from gcodesim.material.sweep_kernels import Shape
    from gcodesim.solids.turned import Outline

Array = NDArray[np.float64]


AS_LONG = 1.0e-3
"""Share of the height of its tip by which `flute_length` may be less and still mean that height: 1.866 for 1.86603."""


def usual_length(diameter: float) -> float:
    """From tip to holder [m], where the cell does not say."""
    return max(4.0 * diameter, 40.0 * MM)


def line_piece(r0: float, z0: float, r1: float, z1: float, weight: float = 1.0) -> tuple[float, ...]:
    """Row of `Cutter.edge` for a straight piece of the edge's outline from (r0, z0) to (r1, z1) [m]."""
    length = math.hypot(r1 - r0, z1 - z0)
    kappa = float(atan2(z1 - z0, r1 - r0))
    return (0.0, r0, z0, kappa, kappa, length, z0, z1, weight)


def arc_piece(rc: float, zc: float, radius: float, kappa0: float, kappa1: float) -> tuple[float, ...]:
    """Row of `Cutter.edge` for an arc about (rc, zc) [m]: r = rc + radius sin kappa, z = zc - radius cos kappa."""
    z0, z1 = zc - radius * cos(kappa0), zc - radius * cos(kappa1)
    return (radius, rc, zc, kappa0, kappa1, radius * (kappa1 - kappa0), float(z0), float(z1), 1.0)


@frozen
class Dynamics:
    """The mode of a tool in its spindle that chatters: how its tip gives way to a force that swings."""

    frequency: float = key(Quantity("frequency", POSITIVE), "natural frequency of the tip", example="800 Hz")
    damping: float = key(Quantity("ratio", Range(above=0.0, below=1.0)), "its damping ratio", example="0.03")
    stiffness: float = key(Quantity("stiffness", POSITIVE), "of that mode", example="8 N/um")


@frozen
class EdgeLife:
    """How long the edges of a tool last in what it cuts (Taylor 1907: v T^n = C, T in minutes): an estimate."""

    constant: float = key(
        Quantity("speed", POSITIVE), "C, the cutting speed at which they last a minute", example="400 m/min"
    )
    exponent: float = key(
        Quantity("ratio", Range(above=0.0, most=1.0)), "n; about 0.12 for HSS, 0.25 for carbide", example="0.25"
    )


@frozen
class Cutter(Tool):
    """A cutter of revolution with `flutes` teeth, all alike unless it says otherwise; lengths [m], angles [rad]."""

    process: ClassVar[str] = "milling"
    center_cutting: ClassVar[bool] = True
    turns: ClassVar[bool] = True
    """Whether the spindle has to turn while it cuts."""
    axial: ClassVar[bool] = False
    """Whether it cuts along its axis only, as drills and taps do."""

    diameter: float = key("length", "cutting diameter")
    flutes: int = key("count", "number of teeth", default=2)
    helix: float = key("angle", "helix angle; positive is right-hand", default=30.0 * DEG, rule="30 deg")
    pitches: tuple[float, ...] | None = key(
        Vector(Quantity("angle", POSITIVE)),
        "from each tooth to the one ahead of it, at the tip: a turn together",
        default=None,
        rule="all alike",
        example="[85, 95, 85, 95 deg]",
    )
    helices: tuple[float, ...] | None = key(
        Vector(Quantity("angle")),
        "helix of each tooth, where they differ",
        default=None,
        rule="that of `helix`",
        example="[35, 38, 35, 38 deg]",
    )
    up_cut: float | None = key(
        Quantity("length", POSITIVE),
        "compression edges: up to this height they lift chips, above they press them down",
        default=None,
        rule="as `helix` has it",
        example="6 mm",
    )
    rake: float | None = key(
        RAKE,
        "of its edges, which corrects forces (1 % a degree)",
        default=None,
        rule="as the table of the material has it",
    )
    length: float = key(
        "length",
        "from the tip to the holder",
        derive=lambda cutter: usual_length(cutter.diameter),
        rule="4 times the diameter, at least 40 mm",
        example="60 mm",
    )
    flute_length: float = key(
        "length",
        "length of the cutting edges from the tip",
        derive=lambda cutter: cutter.length,
        rule="as `length`",
        example="25 mm",
    )

    shank: Shank | None = key(
        Record(Shank, "the shank", shorthand="diameter"),
        "between the edges and the holder: neck and shank, cylinders and cones",
        default=None,
        rule="as thick as its kind has it",
    )
    substrate: str | None = key(
        Choice(("carbide", "hss", "steel")),
        "what it is made of: then it bends like a beam; none: it is rigid",
        default=None,
    )
    runout: float | None = key(
        Quantity("length", NOT_NEGATIVE), "distance of its axis from that of the spindle", default=None, example="5 um"
    )
    runout_angle: float = key("angle", "of that distance, ahead of the first tooth", default=0.0, quiet=True)
    chip_load: tuple[float, ...] | None = key(
        Vector(Quantity("length", POSITIVE), 2),
        "least and greatest thickness of its chips, from the table of its maker",
        default=None,
        example="[0.02, 0.08 mm]",
    )
    dynamics: Dynamics | None = key(Dynamics, "its mode, for a warning of chatter", default=None)

    driven: bool = key(
        "switch",
        "a driven tool of a lathe: S is its speed, and the work stands, or a C axis turns it",
        default=False,
        quiet=True,
    )

    life: EdgeLife | None = key(EdgeLife, "Taylor's law of its edges, for an estimate of wear", default=None)

    def __post_init__(self) -> None:
        Tool.__post_init__(self)
        height, flutes = self.tip_height, self.flute_length
        if (1.0 - AS_LONG) * height <= flutes < height:  # a cone all of whose flanks cut, as it is written
            object.__setattr__(self, "flute_length", height)
        if not exceeds(flutes, self.length) and self.flute_length > self.length:  # flutes up to the holder
            object.__setattr__(self, "length", self.flute_length)

    @property
    def is_driven(self) -> bool:
        return self.driven

    @property
    def watched(self) -> bool:
        """Whether its load is told: how it bends, what run-out does, its chips, chatter."""
        return any(value is not None for value in (self.substrate, self.runout, self.chip_load, self.dynamics))

    @property
    def uneven(self) -> bool:
        """Whether its teeth are not all alike, see `teeth`."""
        return is_uneven(self)

    @property
    def radius(self) -> float:
        """Half the cutting diameter [m]."""
        return 0.5 * self.diameter

    @property
    def edge(self) -> Array:
        """The outline of a cutting edge (k, 9), from the axis outwards and up.

        A row is one piece: radius of the arc (0: straight), r and z of its centre (straight: of its start),
        kappa at start and end [rad], arc length, z at start and end [m], and how many times the force of a sharp edge
        it bears. kappa is the angle between the edge and the plane across the axis: 0 on a flat bottom, 90 degrees
        on the cylinder.
        """
        return np.array(self._edge_pieces(), dtype=np.float64).reshape(-1, 9)

    @property
    def point_diameter(self) -> float:
        """Of the point that the innermost edges make [m]."""
        return self.diameter

    @property
    def chisel_length(self) -> float:
        """Length of the chisel edge between the lips of a drill [m]; it is the first piece of `edge`."""
        return 0.0

    @property
    def leaves_ridges(self) -> bool:
        """Whether passes side by side leave ridges between them: a part of the edge is round."""
        return bool((self.edge[:, 0] > 0.0).any())

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        raise NotImplementedError

    @property
    def edge_height(self) -> float:
        """Height above the tip up to which edges cut [m]."""
        return self.flute_length

    @property
    def cutting_shape(self) -> Shape:
        """The cutting part as a shape of the stock's kernels; it ends at `flute_length`."""
        raise NotImplementedError

    @property
    def form(self) -> Outline | None:
        """The outline of a cutting part that no shape of the kernels holds, else None."""
        return None

    @property
    def shank_diameter(self) -> float:
        """Diameter between flutes and holder [m]."""
        return self.diameter

    @property
    def shank_frusta(self) -> tuple[Frustum, ...]:
        """The sections between flutes and holder, from the flutes up; none where the flutes reach up to the holder."""
        room = self.length - self.flute_length
        if room <= 0.0:
            return ()
        shank = Shank(diameter=self.shank_diameter) if self.shank is None else self.shank
        return stacked(shank.sections(room), self.flute_length)

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """The cutting part, then shank and holder."""
        bodies = self._cutting_bodies()
        bodies += bodies_of("shank", self.shank_frusta)
        return (*bodies, *self._holder_bodies())

    def _cutting_bodies(self) -> list[Primitive]:
        """Tip bodies of the kind, then the cutting cylinder."""
        tip, start = self._tip_bodies()
        if self.flute_length <= start:
            return tip
        return [*tip, cylinder("cutting", self.radius, start, self.flute_length)]

    def _tip_bodies(self) -> tuple[list[Primitive], float]:
        """Bodies below the cutting cylinder, and the height where the cylinder begins [m]."""
        return [], 0.0

    def problems(self) -> list[tuple[str, str]]:
        found = Tool.problems(self)
        found += teeth_problems(self)
        if self.chip_load is not None and self.chip_load[0] > self.chip_load[1]:
            found.append(("chip_load", "`chip_load` names the least thickness first, then the greatest"))
        if exceeds(self.flute_length, self.length):
            found.append(
                (
                    "flute_length",
                    f"`flute_length` {self.flute_length / MM:g} mm is more than `length` {self.length / MM:g} mm: "
                    "the flutes would be inside the holder",
                )
            )
        if self.shank is not None and exceeds(self.shank.height, self.length - self.flute_length):
            found.append(
                (
                    "shank",
                    f"the sections of `shank` are {self.shank.height / MM:g} mm long, and from the flutes to the "
                    f"holder there are {max(self.length - self.flute_length, 0.0) / MM:g} mm",
                )
            )
        elif self.shank is not None and not self.shank_frusta:
            found.append(("shank", "the flutes reach up to the holder, so there is no `shank`; give `flute_length`"))
        if 0.0 < self.flute_length < self.tip_height:
            found.append(
                (
                    "flute_length",
                    f"`flute_length` {self.flute_length / MM:g} mm is less than the height of the tip, "
                    f"{self.tip_height / MM:g} mm",
                )
            )
        return found

    @property
    def tip_height(self) -> float:
        """Height above the tip at which the full diameter is reached [m]."""
        return 0.0

    def _positive(self) -> dict[str, float]:
        values = {"diameter": self.diameter, "flute_length": self.flute_length, **Tool._positive(self)}
        if self.shank is not None:
            values |= sizes_of("shank", self.shank.sections(1.0))
        return values

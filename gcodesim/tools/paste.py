"""Pastes that are laid wet, such as concrete, clay or glue: how high they stand, and how that grows with their age."""

from __future__ import annotations

from math import sqrt
from typing import Final, Literal, NamedTuple

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.units import MINUTE

GRAVITY: Final = 9.80665  # [m/s²]


class KnownPaste(NamedTuple):
    """What has been measured of a paste: density [kg/m³], yield stress [Pa], its growth [Pa/s], and by whom."""

    density: float
    yield_stress: float
    structuration: float
    source: str


KNOWN: Final = {
    "concrete": KnownPaste(
        2070.0,
        3050.0,
        58.0 / MINUTE,
        "Wolfs, Bos and Salet 2018, Cement and Concrete Research 106, 103: printing mortar of Eindhoven, cohesion "
        "3.05 kPa + 0.058 kPa/min over the first 90 min; from memory, the paper was not at hand. That it has about "
        "3 kPa is said where it is quoted; other mixes that print are asked for at most 2.8 kPa at 15 min and 3.1 at "
        "30, and at least 3.4 at 45 (Construction Materials 2025, 5, 80)",
    )
}

WITHOUT_DATA: Final = ("clay", "glue")
"""Pastes that people print with, and of which the library has nothing: they differ by the water and the maker."""


@frozen
class Paste:
    """A paste as a plastic body: it keeps its shape up to its yield stress, which grows evenly while it rests.

    Friction between grains, buckling and drying are left out.
    """

    like: Literal["concrete", "clay", "glue"] | None = key(
        Choice((*KNOWN, *WITHOUT_DATA)),
        "a paste of the library, for what is not given; concrete: the printing mortar of Wolfs, Bos and Salet 2018; of "
        "clay and glue there are no data, so both have to be given",
        default=None,
    )
    density: float | None = key(
        Quantity("density", POSITIVE), "when it is wet", default=None, rule="that of `like`", example="1900 kg/m^3"
    )
    yield_stress: float | None = key(
        Quantity("pressure", POSITIVE),
        "shear stress up to which it stands when it leaves the nozzle",
        default=None,
        rule="that of `like`",
        example="3 kPa",
    )
    structuration: float | None = key(
        Quantity("pressure rate", NOT_NEGATIVE),
        "by how much its yield stress grows with time",
        default=None,
        rule="that of `like`, else 0",
        example="60 Pa/min",
    )

    @property
    def missing(self) -> list[str]:
        """The keys without which nothing can be said."""
        return [name for name in ("density", "yield_stress") if self._of(name) is None]

    def _of(self, name: str) -> float | None:
        own: float | None = getattr(self, name)
        known = KNOWN.get(self.like or "")
        return own if own is not None or known is None else getattr(known, name)

    def strength(self, age: float) -> float:
        """Yield stress [Pa] after resting for `age` [s], growing evenly (Roussel 2006, Cem. Concr. Res. 36, 1797)."""
        return (self._of("yield_stress") or 0.0) + (self._of("structuration") or 0.0) * age

    def standing(self, age: float) -> float:
        """The greatest height [m] that material of this age carries: h = sqrt(3) yield stress / (density g).

        Roussel 2018, Cement and Concrete Research 112, 76: a layer below which nothing flows under the weight above it,
        free to all sides (von Mises).
        """
        return sqrt(3.0) * self.strength(age) / ((self._of("density") or 0.0) * GRAVITY)

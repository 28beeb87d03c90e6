"""What it takes to melt metals: energy for each volume, from heat capacity and latent heat.

Densities, heat capacities at 25 °C, melting points and heats of fusion are those of the pure elements, CRC Handbook of
Chemistry and Physics, sections 4 and 6. The heat capacity counts as constant, which for iron is about a third too
little; alloys and real cuts differ by more than that, so a measured `specific_energy` is better.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from gcodesim.processes.materials import Material

ROOM: Final = 20.0  # °C


class Metal(NamedTuple):
    """Density [kg/m³], heat capacity [J/(kg·K)], melting point [°C], heat of fusion [J/kg]."""

    density: float
    heat_capacity: float
    melting_point: float
    heat_of_fusion: float


METALS: Final = {
    "iron": Metal(7874.0, 449.0, 1538.0, 247.0e3),
    "aluminium": Metal(2700.0, 897.0, 660.3, 397.0e3),
    "copper": Metal(8960.0, 385.0, 1084.6, 203.5e3),
    "titanium": Metal(4506.0, 523.0, 1668.0, 295.6e3),
}

_NAMES: Final = (("titan", "titanium"), ("brass", "copper"), ("bronze", "copper"), ("copper", "copper"))
_ISO: Final = {"P": "iron", "M": "iron", "K": "iron", "H": "iron"}


def melting_energy(metal: Metal, start: float = ROOM) -> float:
    """Energy [J/m³] that heats a volume from `start` [°C] to its melting point and melts it: rho (c dT + L)."""
    return metal.density * (metal.heat_capacity * (metal.melting_point - start) + metal.heat_of_fusion)


def melted(material: Material | None) -> float | None:
    """Energy [J/m³] that melts a material of the library by the metal it mostly is; None where that is not known."""
    metal = mostly(material)
    return None if metal is None else melting_energy(METALS[metal])


def mostly(material: Material | None) -> str | None:
    """Which of `METALS` a material of the library mostly is; None where that is not known."""
    if material is None:
        return None
    name = f"{material.id} {material.name}".lower()
    metal = next((metal for word, metal in _NAMES if word in name), None)
    if metal is None and (name.startswith("al") or "alumin" in name or " al " in name):
        metal = "aluminium"
    return metal or _ISO.get(material.iso[:1])

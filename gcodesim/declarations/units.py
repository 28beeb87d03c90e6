"""The units that a file may write, in one table, and what a plain number means.

A unit belongs to a dimension. `N/mm` is both a stiffness and a force per
length of edge, so the key decides which dimension is meant and only its rows
are looked at.
"""

from __future__ import annotations

import difflib
import re
from functools import cache
from math import pi
from typing import Final

from gcodesim import units as si
from gcodesim.frozen import frozen

INCH_POUND: Final = 0.45359237  # kg
STANDARD_GRAVITY: Final = 9.80665
ICE: Final = 273.15  # K


@frozen
class Dimension:
    """What is measured. `shown` is the unit of listings, `suffix` how it is written in names of JSON keys.

    `plain` says that a number without unit is allowed (lengths, angles, ratios); all others carry their unit, but for
    0, which is the same in all of them where they share their `zero`.
    """

    name: str
    article: str
    shown: str
    suffix: str
    example: str
    plain: bool = False
    zero: bool = True

    def __str__(self) -> str:
        return f"{self.article} {self.name}"


@frozen(kw_only=False)
class Unit:
    """A unit: a number in it, times `factor` plus `offset`, is in SI; `aliases` are other spellings."""

    name: str
    dimension: str
    factor: float
    aliases: tuple[str, ...] = ()
    offset: float = 0.0


def _dimension(
    name: str, shown: str, suffix: str, example: str, *, plain: bool = False, zero: bool = True
) -> Dimension:
    article = "an" if name[0] in "aeiou" else "a"
    return Dimension(name=name, article=article, shown=shown, suffix=suffix, example=example, plain=plain, zero=zero)


DIMENSIONS: Final[dict[str, Dimension]] = {
    d.name: d
    for d in (
        _dimension("length", "mm", "mm", "10 mm", plain=True),
        _dimension("angle", "deg", "deg", "30 deg", plain=True),
        _dimension("ratio", "", "", "0.3", plain=True),
        _dimension("time", "s", "s", "6 s"),
        _dimension("frequency", "Hz", "Hz", "250 Hz"),
        _dimension("speed", "mm/min", "mm_min", "30 m/min"),
        _dimension("angular speed", "deg/s", "deg_s", "180 deg/s"),
        _dimension("rotational speed", "rpm", "rpm", "24000 rpm"),
        _dimension("acceleration", "m/s^2", "m_s2", "3 m/s^2"),
        _dimension("angular acceleration", "deg/s^2", "deg_s2", "600 deg/s^2"),
        _dimension("jerk", "m/s^3", "m_s3", "40 m/s^3"),
        _dimension("angular jerk", "deg/s^3", "deg_s3", "6000 deg/s^3"),
        _dimension("mass", "kg", "kg", "50 kg"),
        _dimension("force", "N", "N", "400 N"),
        _dimension("torque", "N·m", "Nm", "20 N·m"),
        _dimension("power", "W", "W", "3 kW"),
        _dimension("pressure", "N/mm^2", "N_mm2", "1700 N/mm^2"),
        _dimension("pressure rate", "Pa/min", "Pa_min", "60 Pa/min"),
        _dimension("force per length", "N/mm", "N_mm", "13 N/mm"),
        _dimension("stiffness", "N/mm", "N_mm", "1e5 N/mm"),
        _dimension("torsional stiffness", "N·m/rad", "Nm_rad", "1.5e5 N·m/rad"),
        _dimension("area", "mm^2", "mm2", "20 mm^2"),
        _dimension("moment of inertia", "kg·m^2", "kgm2", "0.4 kg·m^2"),
        _dimension("volume", "mm^3", "mm3", "5 mm^3"),
        _dimension("volume flow", "mm^3/s", "mm3_s", "12 mm^3/s"),
        _dimension("mass flow", "g/min", "g_min", "15 g/min"),
        _dimension("density", "kg/m^3", "kg_m3", "2700 kg/m^3"),
        _dimension("voltage", "V", "V", "22 V"),
        _dimension("current", "A", "A", "180 A"),
        _dimension("energy per length", "J/mm", "J_mm", "400 J/mm"),
        _dimension("energy", "J", "J", "500 J"),
        _dimension("power per area", "W/mm^2", "W_mm2", "100 W/mm^2"),
        _dimension("specific heat", "J/kg·K", "J_kgK", "450 J/kg·K"),
        _dimension("latent heat", "kJ/kg", "kJ_kg", "250 kJ/kg"),
        _dimension("energy per volume", "J/mm^3", "J_mm3", "7.3 J/mm^3"),
        _dimension("energy per area", "J/mm^2", "J_mm2", "0.5 J/mm^2"),
        _dimension("temperature", "degC", "degC", "200 degC", zero=False),
    )
}

UNITS: Final[tuple[Unit, ...]] = (
    Unit("mm", "length", si.MM),
    Unit("m", "length", 1.0),
    Unit("cm", "length", 1e-2),
    Unit("um", "length", si.UM),
    Unit("in", "length", si.INCH, ("inch", '"', "ipt", "IPT", "in/tooth")),
    Unit("ft", "length", si.FOOT, ("foot",)),
    Unit("deg", "angle", si.DEG, ("degree", "degrees")),
    Unit("rad", "angle", 1.0),
    Unit("rev", "angle", 2.0 * pi, ("turn",)),
    Unit("%", "ratio", 0.01, ("percent",)),
    Unit("s", "time", 1.0, ("sec",)),
    Unit("ms", "time", 1e-3),
    Unit("us", "time", 1e-6),
    Unit("min", "time", si.MINUTE),
    Unit("h", "time", 3600.0),
    Unit("Hz", "frequency", 1.0, ("1/s",)),
    Unit("kHz", "frequency", 1e3),
    Unit("mm/min", "speed", si.MM_PER_MINUTE),
    Unit("m/min", "speed", 1.0 / si.MINUTE),
    Unit("mm/s", "speed", si.MM),
    Unit("m/s", "speed", 1.0),
    Unit("in/min", "speed", si.INCH / si.MINUTE, ("ipm",)),
    Unit("in/s", "speed", si.INCH),
    Unit("ft/min", "speed", si.FOOT / si.MINUTE, ("sfm", "SFM", "sfpm")),
    Unit("deg/s", "angular speed", si.DEG),
    Unit("rad/s", "angular speed", 1.0),
    Unit("deg/min", "angular speed", si.DEG / si.MINUTE),
    Unit("rpm", "angular speed", si.RPM, ("rev/min", "1/min", "r/min")),
    Unit("rpm", "rotational speed", si.RPM, ("rev/min", "1/min", "r/min", "min^-1")),
    Unit("rad/s", "rotational speed", 1.0),
    Unit("Hz", "rotational speed", 2.0 * pi, ("1/s", "rev/s")),
    Unit("m/s^2", "acceleration", 1.0, ("m/s/s",)),
    Unit("mm/s^2", "acceleration", si.MM, ("mm/s/s",)),
    Unit("in/s^2", "acceleration", si.INCH),
    Unit("g", "acceleration", STANDARD_GRAVITY),
    Unit("deg/s^2", "angular acceleration", si.DEG),
    Unit("rad/s^2", "angular acceleration", 1.0),
    Unit("m/s^3", "jerk", 1.0),
    Unit("mm/s^3", "jerk", si.MM),
    Unit("in/s^3", "jerk", si.INCH),
    Unit("deg/s^3", "angular jerk", si.DEG),
    Unit("rad/s^3", "angular jerk", 1.0),
    Unit("kg", "mass", 1.0),
    Unit("g", "mass", 1e-3),
    Unit("lb", "mass", INCH_POUND),
    Unit("N", "force", 1.0),
    Unit("kN", "force", 1e3),
    Unit("lbf", "force", INCH_POUND * STANDARD_GRAVITY),
    Unit("N·m", "torque", 1.0, ("Nm",)),
    Unit("N·mm", "torque", si.MM, ("Nmm",)),
    Unit("kN·m", "torque", 1e3, ("kNm",)),
    Unit("lbf·ft", "torque", INCH_POUND * STANDARD_GRAVITY * si.FOOT, ("ft·lbf", "ft·lb", "lb·ft")),
    Unit("lbf·in", "torque", INCH_POUND * STANDARD_GRAVITY * si.INCH, ("in·lbf", "in·lb")),
    Unit("W", "power", 1.0),
    Unit("kW", "power", si.KW),
    Unit("hp", "power", si.HP, ("HP",)),
    Unit("PS", "power", si.PS),
    Unit("N/mm^2", "pressure", si.N_PER_MM2, ("MPa",)),
    Unit("Pa", "pressure", 1.0, ("N/m^2",)),
    Unit("kPa", "pressure", 1e3),
    Unit("Pa/min", "pressure rate", 1.0 / si.MINUTE),
    Unit("Pa/s", "pressure rate", 1.0),
    Unit("kPa/min", "pressure rate", 1e3 / si.MINUTE),
    Unit("psi", "pressure", INCH_POUND * STANDARD_GRAVITY / (si.INCH * si.INCH)),
    Unit("bar", "pressure", 1e5),
    Unit("GPa", "pressure", 1e9, ("kN/mm^2",)),
    Unit(
        "hp·min/in^3", "pressure", si.HP * si.MINUTE / (si.INCH * si.INCH * si.INCH), ("hp/in^3/min", "hp/(in^3/min)")
    ),
    Unit("kW·min/cm^3", "pressure", si.KW * si.MINUTE / 1e-6, ("kW/cm^3/min", "kW/(cm^3/min)")),
    Unit("N/mm", "force per length", si.N_PER_MM, ("kN/m",)),
    Unit("N/m", "force per length", 1.0),
    Unit("N/mm", "stiffness", si.N_PER_MM, ("kN/m",)),
    Unit("N/m", "stiffness", 1.0),
    Unit("N/um", "stiffness", 1e6, ("kN/mm",)),
    Unit("N·m/rad", "torsional stiffness", 1.0, ("Nm/rad",)),
    Unit("kN·m/rad", "torsional stiffness", 1e3, ("kNm/rad",)),
    Unit("N·m/deg", "torsional stiffness", 1.0 / si.DEG, ("Nm/deg",)),
    Unit("mm^2", "area", si.MM * si.MM),
    Unit("cm^2", "area", 1e-4),
    Unit("m^2", "area", 1.0),
    Unit("in^2", "area", si.INCH * si.INCH),
    Unit("kg·m^2", "moment of inertia", 1.0, ("kgm^2",)),
    Unit("kg·cm^2", "moment of inertia", 1e-4, ("kgcm^2",)),
    Unit("mm^3", "volume", si.MM3),
    Unit("cm^3", "volume", 1e-6, ("ml",)),
    Unit("in^3", "volume", si.INCH * si.INCH * si.INCH),
    Unit("mm^3/s", "volume flow", si.MM3),
    Unit("cm^3/s", "volume flow", 1e-6, ("ml/s",)),
    Unit("cm^3/min", "volume flow", 1e-6 / si.MINUTE, ("ml/min",)),
    Unit("in^3/min", "volume flow", si.INCH * si.INCH * si.INCH / si.MINUTE),
    Unit("l/min", "volume flow", 1e-3 / si.MINUTE),
    Unit("m^3/s", "volume flow", 1.0),
    Unit("g/min", "mass flow", 1e-3 / si.MINUTE),
    Unit("g/s", "mass flow", 1e-3),
    Unit("kg/h", "mass flow", 1.0 / 3600.0),
    Unit("kg/s", "mass flow", 1.0),
    Unit("kg/m^3", "density", 1.0),
    Unit("g/cm^3", "density", 1e3),
    Unit("V", "voltage", 1.0),
    Unit("A", "current", 1.0),
    Unit("J/mm", "energy per length", 1e3, ("kJ/m",)),
    Unit("kJ/mm", "energy per length", 1e6),
    Unit("kJ/cm", "energy per length", 1e5),
    Unit("J", "energy", 1.0),
    Unit("kJ", "energy", 1000.0),
    Unit("W/mm^2", "power per area", 1000000.0),
    Unit("W/cm^2", "power per area", 10000.0),
    Unit("W/m^2", "power per area", 1.0),
    Unit("J/kg·K", "specific heat", 1.0, ("J/kgK",)),
    Unit("kJ/kg·K", "specific heat", 1000.0, ("kJ/kgK", "J/g·K", "J/gK")),
    Unit("kJ/kg", "latent heat", 1000.0),
    Unit("J/kg", "latent heat", 1.0),
    Unit("J/g", "latent heat", 1000.0),
    Unit("MJ/kg", "latent heat", 1000000.0),
    Unit("J/mm^3", "energy per volume", 1e9, ("GJ/m^3",)),
    Unit("J/cm^3", "energy per volume", 1e6),
    Unit("J/mm^2", "energy per area", 1e6),
    Unit("J/cm^2", "energy per area", 1e4),
    Unit("degC", "temperature", 1.0, ("celsius", "C"), offset=ICE),
    Unit("K", "temperature", 1.0),
    Unit("degF", "temperature", 5.0 / 9.0, ("fahrenheit",), offset=ICE - 160.0 / 9.0),
)

# one way of writing for every sign that keyboards and documents offer
_SPELLING = str.maketrans(
    {"⋅": "·", "∙": "·", "*": "·", "µ": "u", "μ": "u", "²": "^2", "³": "^3", "°": "deg", "″": '"'}
)

_BRACKETS = re.compile(r"\(([^()/]*)\)")


def normal(text: str) -> str:
    """A unit as the table writes it: no blanks, one middle dot, `^2` for ², `u` for µ, `deg` for °, one `/`.

    All behind the first `/` is below the line: `J/(kg K)` and `J/kg/K` are `J/kg·K`. A quotient of a quotient keeps
    its brackets.
    """
    text = text.strip().translate(_SPELLING)
    text = text.replace(" / ", "/").replace("/ ", "/").replace(" /", "/").replace(" · ", "·")
    text = _BRACKETS.sub(r"\1", "·".join(text.split()))
    above, slash, below = text.partition("/")
    if "(" not in below:
        below = below.replace("/", "·")
    return (above + slash + below).replace("s2", "s^2").replace("mm2", "mm^2").replace("mm3", "mm^3").replace("^^", "^")


@cache
def _by_spelling() -> dict[str, tuple[Unit, ...]]:
    table: dict[str, list[Unit]] = {}
    for unit in UNITS:
        for spelling in (unit.name, *unit.aliases):
            table.setdefault(normal(spelling), []).append(unit)
    return {spelling: tuple(units) for spelling, units in table.items()}


def find(text: str, dimension: str) -> Unit | None:
    """The unit of `dimension` that is spelled `text`."""
    return next((u for u in _by_spelling().get(normal(text), ()) if u.dimension == dimension), None)


def measures(text: str) -> tuple[str, ...]:
    """What a unit spelled `text` measures; empty when there is no such unit."""
    return tuple(u.dimension for u in _by_spelling().get(normal(text), ()))


def names(dimension: str) -> tuple[str, ...]:
    """The units of a dimension, the usual ones first."""
    return tuple(u.name for u in UNITS if u.dimension == dimension)


def nearest(text: str, dimension: str) -> str | None:
    """The unit of `dimension` that a misspelled `text` may mean."""
    own = {s.lower(): u.name for s, us in _by_spelling().items() for u in us if u.dimension == dimension}
    close = difflib.get_close_matches(normal(text).lower(), own, n=1, cutoff=0.6)
    return own[close[0]] if close else None


def in_unit(value: float, unit: Unit) -> float:
    """An SI value in `unit`, without the last-digit noise of the division."""
    return float(f"{(value - unit.offset) / unit.factor:.12g}") + 0.0


def table() -> dict[str, dict[str, tuple[str, ...]]]:
    """All units: dimension → unit → its other spellings."""
    return {d: {u.name: u.aliases for u in UNITS if u.dimension == d} for d in DIMENSIONS}


def shown(value: float, dimension: str) -> str:
    """An SI value as people read it: `10 mm`."""
    d = DIMENSIONS[dimension]
    if not d.shown:
        return f"{value:.10g}"
    unit = find(d.shown, dimension)
    assert unit is not None
    return f"{in_unit(value, unit):.10g} {d.shown}"

"""Units as parts of names: `feed_mm_min`, `mean_torque_Nm`, `vacuum_kPa`."""

from __future__ import annotations

from functools import cache

from gcodesim.declarations.units import UNITS, Unit

_WORDS = {"%": ("percent", "pct"), '"': ()}


@cache
def units_by_suffix(dimension: str) -> dict[str, Unit]:
    """Unit by every way of writing it in a name: `mm_min`, `N_mm2`, `Nm`, `lbf_ft`; in lower case as well."""
    found: dict[str, Unit] = {}
    for unit in UNITS:
        if unit.dimension != dimension:
            continue
        for spelling in (unit.name, *unit.aliases):
            plain = spelling.replace("^", "").replace("/", "_")
            for suffix in _WORDS.get(spelling, (plain.replace("·", ""), plain.replace("·", "_"))):
                found.setdefault(suffix, unit)
    for suffix, unit in list(found.items()):
        found.setdefault(suffix.lower(), unit)
    return found


def suffix_unit(suffix: str, dimension: str) -> Unit | None:
    """The unit of `dimension` that a name with this end has."""
    known = units_by_suffix(dimension)
    return known.get(suffix) or known.get(suffix.lower())


def named_unit(name: str, dimension: str) -> str:
    """The unit that a name is by itself, as `sfm`, `ipt` and `rpm` are; else empty. Single letters are none."""
    unit = suffix_unit(name, dimension) if len(name) > 2 else None
    return "" if unit is None else unit.name


def splits(name: str) -> list[tuple[str, str]]:
    """All ways to take a unit off the end of a name: (`feed_mm`, `min`), (`feed`, `mm_min`)."""
    parts = name.split("_")
    return [("_".join(parts[:i]), "_".join(parts[i:])) for i in range(len(parts) - 1, 0, -1)]

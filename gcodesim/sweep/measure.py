"""The figures of a run that people compare, by name, taken from its results."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from typing import Final

from gcodesim.frozen import frozen
from gcodesim.numbers import rounded

Figures = Mapping[str, float | str | None]
"""Numbers and words of `results.json` by their paths; those of a set-up begin with `setups.NAME.`."""


@frozen(kw_only=False)
class Measure:
    """One figure: `pattern` finds it among the paths, `of` joins what is found, `unit` as shown, of `dimension`.

    `at_end`: of several set-ups the last one counts, because the stock is handed on.
    """

    name: str
    dimension: str
    unit: str
    pattern: str
    of: Callable[[Iterable[float]], float]
    says: str
    at_end: bool = False

    @property
    def heading(self) -> str:
        """The column of tables."""
        suffix = self.unit.replace("·", "").replace("^", "").replace("/", "_")
        return f"{self.name}_{suffix}" if suffix else self.name

    def value(self, figures: Figures) -> float | None:
        """The figure in its unit; None where a run has none."""
        found = {
            path: float(value)
            for path, value in figures.items()
            if isinstance(value, (int, float)) and _fits(self.pattern, path)
        }
        if self.at_end and found:
            last = _setup_of(list(found)[-1])
            found = {path: value for path, value in found.items() if _setup_of(path) == last}
        return rounded(self.of(found.values())) if found else None


def _setup_of(path: str) -> str:
    """The set-up whose figure has this path; empty without set-ups."""
    return path.split(".", 2)[1] if path.startswith("setups.") else ""


@lru_cache(maxsize=1 << 16)  # the runs of a study have the same paths
def _fits(pattern: str, path: str) -> bool:
    return re.fullmatch(rf"(?:setups\.[^.]+\.)?(?:{pattern})", path) is not None


MEASURES: Final[dict[str, Measure]] = {
    measure.name: measure
    for measure in (
        Measure("time", "time", "s", r"time\.total_s", sum, "time of the machine"),
        Measure("feed_time", "time", "s", r"time\.feed_s", sum, "time of feed moves"),
        Measure("engaged_time", "time", "s", r"time\.engaged_s", sum, "time in which a tool acted on something"),
        Measure("rapid_time", "time", "s", r"time\.rapid_s", sum, "time of rapids"),
        Measure("feed_distance", "length", "mm", r"distance\.feed_mm", sum, "way of feed moves"),
        Measure("rapid_distance", "length", "mm", r"distance\.rapid_mm", sum, "way of rapids"),
        Measure("removed", "volume", "mm^3", r"stocks\..+\.removed_mm3", sum, "what was cut away"),
        Measure("deposited", "volume", "mm^3", r"stocks\..+\.deposited_mm3", sum, "what was added"),
        Measure("remaining", "volume", "mm^3", r"stocks\..+\.remaining_mm3", sum, "what is left of all stocks", True),
        Measure(
            "force", "force", "N", r"tools\..+\.max_force_N", max, "greatest force on a tool, mean of a revolution"
        ),
        Measure("peak_force", "force", "N", r"tools\..+\.max_peak_force_N", max, "greatest force on a tool, peak"),
        Measure("torque", "torque", "N·m", r"tools\..+\.max_torque_Nm", max, "greatest torque of a spindle"),
        Measure("power", "power", "W", r"tools\..+\.max_power_W", max, "greatest power of a spindle"),
        Measure("bend", "length", "mm", r"tools\..+\.max_tool_bend_mm", max, "greatest bend of a tool"),
        Measure(
            "path_error", "length", "mm", r"path_accuracy\.AT_mm", max, "greatest distance of an arm from its path"
        ),
        Measure("gouge", "volume", "mm^3", r"target\.gouge_mm3", sum, "missing of the target"),
        Measure("excess", "volume", "mm^3", r"target\.excess_mm3", sum, "left beyond the target"),
        Measure("least_deviation", "length", "mm", r"target\.least_deviation_mm", min, "deepest below the target"),
        Measure("most_deviation", "length", "mm", r"target\.most_deviation_mm", max, "farthest above the target"),
        Measure("scallop", "length", "mm", r"target\.scallops\..+\.typical_mm", max, "ridges between passes"),
        Measure("outside", "ratio", "", r"target\.share_outside", max, "share of the target outside its tolerance"),
    )
}


def joint_margin(figures: Figures, unit: str) -> float | None:
    """The least distance of a joint in `unit` (mm or deg) from its limits; None if the machine has no such joint."""
    found = []
    for path, value in figures.items():
        of_unit = figures.get(f"{path.removesuffix('margin')}unit") == unit
        if of_unit and isinstance(value, (int, float)) and _fits(r"joints\..+\.margin", path):
            found.append(float(value))
    return rounded(min(found)) if found else None


MARGINS: Final = {"margin": ("length", "mm"), "angle_margin": ("angle", "deg")}
"""Figures about joints, with their dimension and unit."""


def names() -> tuple[str, ...]:
    """All names, in the order of tables."""
    return (*MEASURES, *MARGINS)


def heading_of(name: str) -> str:
    return MEASURES[name].heading if name in MEASURES else f"{name}_{MARGINS[name][1]}"


def dimension_of(name: str) -> tuple[str, str]:
    """Dimension and shown unit of a figure."""
    if name in MARGINS:
        return MARGINS[name]
    return MEASURES[name].dimension, MEASURES[name].unit


def figure(name: str, figures: Figures) -> float | None:
    """The figure `name`, or the number at that path of the results, in the unit that tables show."""
    if name in MEASURES:
        return MEASURES[name].value(figures)
    if name in MARGINS:
        return joint_margin(figures, MARGINS[name][1])
    value = figures.get(name)
    return float(value) if isinstance(value, (int, float)) else None

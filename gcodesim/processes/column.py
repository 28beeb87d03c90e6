"""Columns: figures that a process gives for each step, declared once by the process itself.

Executor, results, `lines.csv`, log, report and charts go through these declarations, so that a new figure of a process
is one line in the file of that process.
"""

from __future__ import annotations

import re
from enum import Flag, auto
from typing import Final, Literal

from gcodesim.frozen import frozen
from gcodesim.units import DEG, MM, MM3, MM_PER_MINUTE

Of = Literal["sum", "greatest", "any", "last"]
Together = Literal["", "sum", "greatest"]

_NAME: Final = re.compile(r"[a-z][a-z0-9_]*")


class Shown(Flag):
    """Who gets to see a column. A column that nobody sees stays with the steps of the process, for tests."""

    NOWHERE = 0
    LOG = auto()
    """The topic `/process` of the log, and with it tables, charts and the page of a run."""
    LINES = auto()
    """`lines.csv`, one figure for each program line."""
    RESULTS = auto()
    """`results.json`, one figure for each tool, and the summary on the screen."""
    FINDINGS = auto()
    """Findings of the process: as soon as this column is not zero, the process is asked what is wrong."""


LOG, LINES, RESULTS, FINDINGS = Shown.LOG, Shown.LINES, Shown.RESULTS, Shown.FINDINGS


@frozen(kw_only=False)
class ColumnUnit:
    """How a unit is written: in the log (SI) and in files of the shop floor, and how much SI one of the latter is."""

    log: str
    shop: str
    divisor: float = 1.0


UNITS: Final[dict[str, ColumnUnit]] = {
    "": ColumnUnit("", ""),
    "m": ColumnUnit("m", "mm", MM),
    "m^2": ColumnUnit("m2", "mm2", MM * MM),
    "m^3": ColumnUnit("m3", "mm3", MM3),
    "m/s": ColumnUnit("m_s", "mm_min", MM_PER_MINUTE),
    "m^3/s": ColumnUnit("m3_s", "mm3_s", MM3),
    "rad": ColumnUnit("rad", "deg", DEG),
    "rad/s": ColumnUnit("rad_s", "deg_s", DEG),
    "N": ColumnUnit("n", "N"),
    "N·m": ColumnUnit("nm", "Nm"),
    "W": ColumnUnit("w", "W"),
}
"""Units that are spelled in a way of their own; any other is spelled as it is, and is the same in every file."""


_PEOPLE: Final = {
    "mm2": "mm²",
    "mm3": "mm³",
    "mm_min": "mm/min",
    "mm3_s": "mm³/s",
    "deg": "°",
    "deg_s": "°/s",
    "Nm": "N·m",
}


@frozen(kw_only=False)
class Column:
    """One figure of a process, with a value for each step.

    `unit` is the SI unit of the values. `of` says how many steps, such as those of a line or a tool, become one value:

    - `sum` adds them up (a volume); the log shows the sum since the start of the run;
    - `greatest` keeps the greatest in size (a depth); the log shows the value of the step, and as `max_…` the greatest
      size since the sample before, so that no peak between two samples is lost;
    - `any` is a flag; many steps give the time [s] during which it was set, the log shows the flag;
    - `last` holds until the process gives another value (a thickness, a count).

    `together` says how values of several processes, or of one process in several stocks, become one value in the same
    step: by default as `of` says. A torque, the `greatest` of many steps but the sum over two stocks, says
    `together="sum"`. Of two `last` values the later one counts.

    A process that leaves a column out says zero; where the column names another one as `steady`, it says that one: a
    force that does not swing within a step is its own peak.
    """

    name: str
    unit: str = ""
    of: Of = "sum"
    shown_in: Shown = LOG | LINES | RESULTS
    says: str = ""
    together: Together = ""
    steady: str = ""

    def __post_init__(self) -> None:
        if _NAME.fullmatch(self.name) is None:
            raise ValueError(f"a column is named in lower case letters, digits and _, not {self.name!r}")

    @property
    def _spelling(self) -> ColumnUnit:
        known = UNITS.get(self.unit)
        if known is not None:
            return known
        plain = re.sub(r"\W+", "_", self.unit.replace("·", "").replace("^", "")).strip("_")
        return ColumnUnit(plain.lower(), plain)

    @property
    def divisor(self) -> float:
        """SI in one unit of files and screens."""
        return 1.0 if self.of == "any" else self._spelling.divisor

    @property
    def shop_unit(self) -> str:
        """The unit in files and on screens; for a flag, seconds."""
        return "s" if self.of == "any" else self._spelling.shop

    @property
    def people_unit(self) -> str:
        """The unit as people write it, on a screen."""
        if self.of == "any" or self.unit in UNITS:
            return _PEOPLE.get(self.shop_unit, self.shop_unit)
        return self.unit.replace("^2", "²").replace("^3", "³")

    @property
    def key(self) -> str:
        """The name in `results.json` and `lines.csv`, such as `max_film_thickness_mm`."""
        return ("max_" if self.of == "greatest" else "") + _joined(self.name, self.shop_unit)

    @property
    def field(self) -> str:
        """The name in the log, in SI and lower case, such as `film_thickness_m`; a flag has its bare name."""
        return self.name if self.of == "any" else _joined(self.name, self._spelling.log)

    @property
    def peak_field(self) -> str:
        """The name in the log of the greatest value since the sample before, for a column `of="greatest"`."""
        return f"max_{self.field}"

    @property
    def drawn_field(self) -> str:
        """The field of the log that a chart shows: the peak, where there is one."""
        return self.peak_field if self.of == "greatest" else self.field

    @property
    def shop_field(self) -> str:
        """The name in the log of `drawn_field` in units of the shop floor; "" where those are the same as in SI."""
        if self.divisor == 1.0:
            return ""
        return ("max_" if self.of == "greatest" else "") + _joined(self.name, self.shop_unit)

    @property
    def adds(self) -> bool:
        """Whether values of one step are added up over processes and stocks."""
        return (self.together or self.of) == "sum"


def _joined(name: str, unit: str) -> str:
    return f"{name}_{unit}" if unit else name


ENGAGED: Final = Column("engaged", of="any", shown_in=LOG, says="the tool works on something")
REMOVED: Final = Column("removed", "m^3", says="volume taken away")
ADDED: Final = Column("added", "m^3", shown_in=LOG, says="volume put on")
FORCE: Final = Column("force", "N", of="greatest", says="size of the force on the tool, which is that of the wrench")
TORQUE: Final = Column(
    "torque", "N·m", of="greatest", together="sum", shown_in=LOG | RESULTS, says="what the spindle has to give"
)
POWER: Final = Column("power", "W", of="greatest", together="sum", shown_in=LOG | RESULTS, says="of the spindle")

HOUSE: Final = (ENGAGED, REMOVED, ADDED, FORCE, TORQUE, POWER)
"""Columns that every run has, whatever its tools do; a process writes those for which it has values."""

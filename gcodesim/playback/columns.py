"""Names with units for the numbers of a log, as tables and charts show them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final, Literal, NamedTuple

from gcodesim.log.description import with_peaks
from gcodesim.log.series import Series
from gcodesim.log.shop_units import without_twins
from gcodesim.playback.recording import Recording
from gcodesim.units import DEG, MM, MM3, MM_PER_MINUTE, RPM

UnitSystem = Literal["si", "mm"]

_JOINT: Final = re.compile(r"joints\[(.+)\]\.(position|velocity|effort|command)")
_FRAME: Final = re.compile(r"transforms\[(.+)\]\.(translation|rotation)\.([xyzw])")
_POSE: Final = re.compile(r"pose\.(position|orientation)\.([xyzw])")
_VECTOR: Final = re.compile(r"(force|torque)\.([xyz])")
_SPELLING: Final = {"_n": "_N", "_nm": "_Nm", "_w": "_W"}  # field names of a log are in lower case

HOUSE_FIELDS: Final = frozenset(
    (
        *("kind", "engaged", "spindle_rad_s", "force_n", "torque_nm", "power_w", "removal_m3_s", "removed_m3"),
        *("max_force_n", "max_torque_nm", "max_power_w"),
    )
)
"""The fields of `/process` that every log has; others are of the processes of one run."""

# suffix of a name in SI -> suffix on the shop floor, and how much SI one of the latter is
_SHOP_FLOOR: Final[Mapping[str, tuple[str, float]]] = {
    "_m3_s": ("_mm3_s", MM3),
    "_m3": ("_mm3", MM3),
    "_m_s": ("_mm_min", MM_PER_MINUTE),
    "_m": ("_mm", MM),
    "_rad_s": ("_deg_s", DEG),
    "_rad": ("_deg", DEG),
}


_PEOPLE: Final = (
    ("_m3_s", "mm³/s", MM3),
    ("_m3", "mm³", MM3),
    ("_m2", "mm²", MM * MM),
    ("_m_s", "mm/min", MM_PER_MINUTE),
    ("_m", "mm", MM),
    ("_rad_s", "°/s", DEG),
    ("_rad", "°", DEG),
    ("_nm", "N·m", 1.0),
    ("_n", "N", 1.0),
    ("_w", "W", 1.0),
)

_UNITS_BEFORE: Final = ("_j", "_kg", "_n", "_nm", "_pa", "_w")
"""Units before another one, as in `dose_j_m2`: the whole is no length or area, and stays as it is."""


class TableColumn(NamedTuple):
    """A column: its name, which ends in the unit, and by what a number in SI is divided."""

    name: str
    divisor: float


def joint_kinds(recording: Recording) -> dict[str, str]:
    """`revolute` or `prismatic` by joint name, as far as the results of the run say."""
    return {
        joint["name"]: "prismatic" if joint["unit"] == "mm" else "revolute"
        for joint in recording.results.get("joints", ())
    }


def column_of(topic: str, field: str, kinds: Mapping[str, str], units: UnitSystem = "si") -> TableColumn:
    """The column of a field of a periodic topic, such as `force_n` of `/process`: `process.force_N`."""
    name = _si_name(topic, field, kinds)
    if units == "mm":
        for suffix, (shown, divisor) in _SHOP_FLOOR.items():
            if name.endswith(suffix) and not name[: -len(suffix)].endswith(_UNITS_BEFORE):
                if "spindle" in name:
                    shown, divisor = "_rpm", RPM
                elif name.startswith("joint.") and shown == "_mm_min":
                    shown, divisor = "_mm_s", MM
                return TableColumn(name[: -len(suffix)] + shown, divisor)
    return TableColumn(name, 1.0)


def own_fields(recording: Recording) -> list[str]:
    """The numbers of `/process` that only this run's processes have, by their names in the log; without peaks."""
    names = without_twins(recording.series("/process").names)
    return [name for name in with_peaks(names) if name not in HOUSE_FIELDS]


def peak_of(series: Series, field: str) -> str:
    """The field with the greatest value between samples; `field` itself in older logs, which have no other."""
    return with_peaks(series.names).get(field, field)


def shown_as(field: str) -> tuple[str, str, float]:
    """A field such as `film_thickness_m` for people: its title, its unit, and how much SI one of it is."""
    for suffix, unit, divisor in _PEOPLE:
        if field.endswith(suffix) and not field[: -len(suffix)].endswith(_UNITS_BEFORE):
            return field[: -len(suffix)].replace("_", " "), unit, divisor
    return field.replace("_", " "), "", 1.0


def _si_name(topic: str, field: str, kinds: Mapping[str, str]) -> str:
    group = topic.strip("/").replace("/", ".")
    if found := _JOINT.fullmatch(field):
        joint, what = found.groups()
        slides = kinds.get(joint)
        if slides is None:
            return f"joint.{joint}.{what}"
        unit = {"position": "m" if slides == "prismatic" else "rad", "effort": "N" if slides == "prismatic" else "Nm"}
        unit["velocity"], unit["command"] = f"{unit['position']}_s", unit["position"]
        return f"joint.{joint}.{what}_{unit[what]}"
    if found := _FRAME.fullmatch(field):
        frame, what, axis = found.groups()
        return f"tf.{frame}.{axis}_m" if what == "translation" else f"tf.{frame}.q{axis}"
    if found := _POSE.fullmatch(field):
        what, axis = found.groups()
        return f"{group}.{axis}_m" if what == "position" else f"{group}.q{axis}"
    if found := _VECTOR.fullmatch(field):
        what, axis = found.groups()
        return f"{group}.{what}_{axis}_{'N' if what == 'force' else 'Nm'}"
    for ending, spelled in _SPELLING.items():
        if field.endswith(ending):
            return f"{group}.{field[: -len(ending)]}{spelled}"
    return f"{group}.{field}"

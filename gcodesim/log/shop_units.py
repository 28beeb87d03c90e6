"""Numbers of the periodic messages in units of the shop floor, beside those in SI: a viewer converts nothing.

A *twin* is such a field, in single precision. It says the same as its field in SI, so tables and bags, which have units
of their own, leave it out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from gcodesim.log.description import array_of
from gcodesim.units import CM3, CM3_PER_MINUTE, DEG, MM, MM_PER_MINUTE, RPM, UM

if TYPE_CHECKING:
    from gcodesim.log.description import Array, ProcessField


class Twin(NamedTuple):
    """A field that is `column` of an array of the log, divided by `divisor`."""

    field: str
    array: str
    divisor: float
    column: int = 0


MOTION_TWINS: Final = (
    Twin("feed_mm_min", "feed", MM_PER_MINUTE),
    Twin("feed_command_mm_min", "feed_command", MM_PER_MINUTE),
    Twin("x_mm", "position", MM, 0),
    Twin("y_mm", "position", MM, 1),
    Twin("z_mm", "position", MM, 2),
    Twin("position_error_um", "position_error", UM),
    Twin("orientation_error_deg", "orientation_error", DEG),
)
"""Those of `/motion`, in the order of their numbers."""

PROCESS_TWINS: Final = (
    Twin("spindle_rpm", "spindle", RPM),
    Twin("removal_cm3_min", "removal", CM3_PER_MINUTE),
    Twin("removed_cm3", "removed", CM3),
)
"""Those of `/process` that every log has, in the order of their numbers."""

JOINTS_SHOWN: Final = {"joint_shown": "joint_position", "joint_command_shown": "joint_command"}
"""Joints in mm or degrees, by what they are in SI."""

_SHOWN: Final = "_shown"
_SAME: Final = (
    ("_mm_min", "_m_s"),
    ("_mm3_s", "_m3_s"),
    ("_cm3_min", "_m3_s"),
    ("_deg_s", "_rad_s"),
    ("_rpm", "_rad_s"),
    ("_mm", "_m"),
    ("_um", "_m"),
    ("_mm2", "_m2"),
    ("_mm3", "_m3"),
    ("_cm3", "_m3"),
    ("_deg", "_rad"),
)


def twins_of(columns: Mapping[str, Any], scale: Sequence[float], fields: Iterable[ProcessField]) -> dict[str, Array]:
    """The twins (n,) of the `columns` of a window by their names; of the joints (n, j), each divided by its `scale`."""
    made = {}

    def shown(values: Any, divisor: Any) -> Array:
        """As exact as a chart needs; the rest of each double is zero bits, which compress."""
        rounded: Array = (np.asarray(values) / divisor).astype(np.float32).astype(float)
        return rounded

    for twin in (*MOTION_TWINS, *PROCESS_TWINS):
        values = np.asarray(columns[twin.array])
        made[twin.field] = shown(values[:, twin.column] if values.ndim > 1 else values, twin.divisor)
    for name, array in JOINTS_SHOWN.items():
        made[name] = shown(columns[array], np.asarray(scale))
    for field in fields:
        if field.twin_of:
            made[array_of(field.name)] = shown(columns[array_of(field.twin_of)], field.divisor)
    return made


def twins_among(names: Iterable[str]) -> dict[str, str]:
    """The fields that only repeat another one in other units, by that other one in SI."""
    known = list(names)
    pairs = ((name.removesuffix(shop) + si, name) for name in known for shop, si in _SAME if name.endswith(shop))
    return {other: name for other, name in pairs if other in known}


def without_twins(names: Sequence[str]) -> list[str]:
    """The fields of a topic without those that only repeat another one in other units."""
    repeated = set(twins_among(names).values())
    return [name for name in names if name not in repeated and not name.endswith(_SHOWN)]

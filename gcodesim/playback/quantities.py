"""What can be drawn over the time of a run: force, power, feed, joints …, in the units of the shop floor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frozen import frozen
from gcodesim.playback.columns import joint_kinds, own_fields, peak_of, shown_as
from gcodesim.playback.recording import Recording
from gcodesim.units import DEG, MM, MM3, MM_PER_MINUTE, RPM, UM

Array = NDArray[np.float64]

NEGLIGIBLE: Final = 1e-3
"""A force [N], power [W], speed [mm/min], error [µm] … up to this value is noise, in the units of the charts."""


@frozen(eq=False)
class Curve:
    """A line of a chart: `values` (n,) at `t_ns` (n,). `faint`: what was commanded, beside what was."""

    label: str
    t_ns: NDArray[np.int64]
    values: Array
    faint: bool = False


@frozen(eq=False)
class Chart:
    """Curves of one unit that are drawn together; `what` is the requested quantity.

    Values up to `negligible` are noise.
    """

    what: str
    title: str
    unit: str
    curves: tuple[Curve, ...]
    negligible: float = NEGLIGIBLE

    @property
    def speaks(self) -> bool:
        """Whether anything of it is more than rounding."""
        return any(np.abs(curve.values).max(initial=0.0) > self.negligible for curve in self.curves)


def _field(
    topic: str, field: str, what: str, title: str, unit: str, divisor: float, negligible: float = NEGLIGIBLE
) -> Callable[[Recording], list[Chart]]:
    def charts(recording: Recording) -> list[Chart]:
        series = recording.series(topic)
        if field not in series.names:
            return []
        values = series.column(peak_of(series, field)) / divisor
        curve = Curve(label=title.lower(), t_ns=series.t_ns, values=values)
        return [Chart(what=what, title=title, unit=unit, curves=(curve,), negligible=negligible)]

    return charts


def _feed(recording: Recording) -> list[Chart]:
    series = recording.series("/motion")
    curves = tuple(
        Curve(label=label, t_ns=series.t_ns, values=series.column(field) / MM_PER_MINUTE, faint=faint)
        for label, field, faint in (("commanded", "feed_command_m_s", True), ("tool tip", "feed_m_s", False))
        if field in series.names
    )
    return [Chart(what="feed", title="Feed", unit="mm/min", curves=curves)] if curves else []


def _error(recording: Recording) -> list[Chart]:
    """How far the tip is from its command; in µm, because on a good machine it is that small."""
    return _field("/motion", "position_error_m", "error", "Position error", "µm", UM)(recording)


def _joints(
    what: str, field: str, title: str, units: dict[str, tuple[str, float]]
) -> Callable[[Recording], list[Chart]]:
    """One chart for joints that turn, one for those that slide."""

    def charts(recording: Recording) -> list[Chart]:
        series, kinds = recording.series("/joint_states"), joint_kinds(recording)
        found = []
        names = [name[len("joints[") : -len("].position")] for name in series.names if name.endswith("].position")]
        for kind, (unit, divisor) in units.items():
            mine = [name for name in names if kinds.get(name, "revolute") == kind]
            curves = tuple(
                Curve(
                    label=name.rpartition("/")[2],
                    t_ns=series.t_ns,
                    values=series.column(f"joints[{name}].{field}") / divisor,
                )
                for name in mine
            )
            if curves:
                found.append(Chart(what=what, title=title, unit=unit, curves=curves))
        return found

    return charts


QUANTITIES: Final[dict[str, Callable[[Recording], list[Chart]]]] = {
    "force": _field("/process", "force_n", "force", "Force", "N", 1.0),
    "torque": _field("/process", "torque_nm", "torque", "Torque", "N·m", 1.0),
    "power": _field("/process", "power_w", "power", "Power", "W", 1.0),
    "removal": _field("/process", "removal_m3_s", "removal", "Removal rate", "mm³/s", MM3),
    "removed": _field("/process", "removed_m3", "removed", "Removed", "mm³", MM3),
    "spindle": _field("/process", "spindle_rad_s", "spindle", "Spindle", "rpm", RPM),
    "feed": _feed,
    "error": _error,
    "joints": _joints("joints", "position", "Joints", {"revolute": ("°", DEG), "prismatic": ("mm", MM)}),
    "speed": _joints("speed", "velocity", "Joint speed", {"revolute": ("°/s", DEG), "prismatic": ("mm/s", MM)}),
    "effort": _joints("effort", "effort", "Joint effort", {"revolute": ("N·m", 1.0), "prismatic": ("N", 1.0)}),
}


def quantities_of(recording: Recording) -> dict[str, Callable[[Recording], list[Chart]]]:
    """Everything that can be drawn of one run: `QUANTITIES`, and the columns of its processes by their log names."""
    own = {}
    for field in own_fields(recording):
        title, unit, divisor = shown_as(field)
        own[field] = _field("/process", field, field, title.capitalize(), unit, divisor, 0.0)
    return QUANTITIES | own


def charts_of(recording: Recording, what: Sequence[str]) -> list[Chart]:
    """The charts of some quantities, in that order. KeyError for an unknown one."""
    known = QUANTITIES if QUANTITIES.keys() >= set(what) else quantities_of(recording)
    return [chart for name in what for chart in known[name](recording)]


def thinned(t_ns: NDArray[np.int64], values: Array, slots: int) -> tuple[NDArray[np.int64], Array]:
    """At most two points in each of `slots` equal parts of the time: the least and the greatest, in their order.

    A peak of one sample is kept if it is the highest of its part. The
    first and the last point are kept as well.
    """
    count = len(t_ns)
    if count <= 2 * slots:
        return t_ns, values
    kept = extremes(t_ns, values, slots)
    return t_ns[kept], values[kept]


def extremes(t_ns: NDArray[np.int64], values: Array, slots: int) -> NDArray[np.int64]:
    """Indices of the least and the greatest value in each of `slots` equal parts of the time, and both ends."""
    span = max(int(t_ns[-1] - t_ns[0]), 1)
    slot = np.minimum((t_ns - t_ns[0]) * slots // span, slots - 1)
    order = np.lexsort((values, slot))
    first = np.flatnonzero(np.diff(slot[order], prepend=-1))
    last = np.append(first[1:] - 1, len(order) - 1)
    return distinct(np.concatenate([order[first], order[last], [0, len(t_ns) - 1]]))

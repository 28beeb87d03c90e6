"""What a print took: filament by nozzle, time and volume by layer and by feature."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.canon import Extrude
from gcodesim.frames import Array
from gcodesim.motion.filament import tools_of_events, tools_of_rows
from gcodesim.numbers import rounded
from gcodesim.rs274.marlin.estimate import SlicerEstimate
from gcodesim.units import MM, MM3

if TYPE_CHECKING:
    from gcodesim.planning import Plan
    from gcodesim.tools.tool import Tool

_CODE_AROUND: Final = "Custom"
"""What slicers call the code of the printer at the start, the end and between tools."""

_USUAL: Final = 1.75 * MM  # diameter of filament where the cell has no extruder


def printing_of(
    plan: Plan, tools: Mapping[int, Tool], row_time: Array, estimate: SlicerEstimate
) -> dict[str, Any] | None:
    """The part `printing` of the results, None of a program without E words; `row_time` (n,) [s].

    `estimate` is what the slicer says in comments that the print will take.

    Filament is counted by E words alone: `filament` is their sum, `forward` what goes forward, `laid` what does so
    while the head moves. Where no comment names a layer, a layer is a height at which something is laid.
    """
    path, events = plan.path, plan.trajectory.events
    alone = [(timed.row, timed.event, timed.duration) for timed in events if isinstance(timed.event, Extrude)]
    if not path.extrude.any() and not alone:
        return None
    count = len(path)
    numbers = tools_of_rows(path)
    area = np.array([_area(tools.get(state.tool)) for state in path.states])[path.state]
    laid = np.maximum(path.extrude, 0.0)
    by_words = [k for k, each in enumerate(events) if isinstance(each.event, Extrude) and not each.event.by_firmware]
    lengths = np.array([event.length for _, event, _ in alone if not event.by_firmware])
    all_tools = np.concatenate([numbers, tools_of_events(path, events)[by_words]])
    all_lengths = np.concatenate([path.extrude, lengths])
    time = row_time.copy()
    if count:
        np.add.at(
            time,
            np.clip(np.array([row for row, _, _ in alone], dtype=np.int64), 0, count - 1),
            [seconds for _, _, seconds in alone],
        )
    nozzles = []
    for number in distinct(all_tools).tolist():
        mine = all_tools == number
        if not all_lengths[mine].any():
            continue
        own = numbers == number
        nozzles.append(
            {
                "tool": int(number),
                "filament_mm": rounded(float(all_lengths[mine].sum()) / MM),
                "forward_mm": rounded(float(np.maximum(all_lengths[mine], 0.0).sum()) / MM),
                "laid_mm": rounded(float(laid[own].sum()) / MM),
                "laid_mm3": rounded(float((laid * area)[own].sum()) / MM3),
            }
        )
    layer, heights = _layers(plan, laid)
    features = np.array([state.section.feature if state.section is not None else "" for state in path.states])[
        path.state
    ]
    by_feature = [{"feature": name, **each} for name, each in _grouped(features, time, laid, area, laid_only=False)]
    return {
        "filament_mm": rounded(float(all_lengths.sum()) / MM),
        "filament_forward_mm": rounded(float(np.maximum(all_lengths, 0.0).sum()) / MM),
        "filament_laid_mm": rounded(float(laid.sum()) / MM),
        "laid_mm3": rounded(float((laid * area).sum()) / MM3),
        **({} if estimate.time is None else {"slicer_time_s": rounded(estimate.time)}),
        **({} if estimate.filament is None else {"slicer_filament_mm": rounded(estimate.filament / MM)}),
        **_of_model(by_feature, estimate),
        "nozzles": nozzles,
        "layers": [
            {"layer": number, "z_mm": rounded(heights[number] / MM), **each}
            for number, each in _grouped(layer, time, laid, area, laid_only=True)
        ],
        "features": by_feature,
    }


def _of_model(features: list[dict[str, Any]], estimate: SlicerEstimate) -> dict[str, float]:
    """The time of all but the code at the start and the end, where the slicer says what it expects of that."""
    if estimate.model_time is None:
        return {}
    own = sum(each["time_s"] for each in features if each["feature"] not in ("", _CODE_AROUND))
    return {"model_time_s": rounded(own), "slicer_model_time_s": rounded(estimate.model_time)}


def _area(tool: Tool | None) -> float:
    diameter = getattr(tool, "filament_diameter", None) or _USUAL
    return 0.25 * pi * (diameter * diameter)


def _layers(plan: Plan, laid: Array) -> tuple[NDArray[np.int64], dict[int, float]]:
    """The layer (n,) of each row, and the greatest height [m] in G54's coordinates at which each one is laid."""
    path = plan.path
    said = np.array([state.section.layer if state.section is not None else 0 for state in path.states])[path.state]
    zero = np.array([state.system_offset[2] for state in path.states])[path.state]
    height = path.end[:, 2] - zero if len(path) else np.zeros(0)
    rows = laid > 0.0
    if not said.any():
        known = distinct(np.round(height[rows] / (0.01 * MM)))
        at = np.clip(np.searchsorted(known, np.round(height / (0.01 * MM))), 0, max(len(known) - 1, 0))
        said = np.where(rows, at + 1, 0)
        last = np.maximum.accumulate(np.where(rows, np.arange(len(said)), 0)) if len(said) else said
        said = said[last]  # travel belongs to the layer before it
    heights: dict[int, float] = {}
    for number in distinct(said).tolist():
        mine = rows & (said == number)
        heights[number] = float(np.median(height[mine])) if mine.any() else 0.0
    return said.astype(np.int64), heights


def _grouped(
    names: NDArray[Any], time: Array, laid: Array, area: Array, *, laid_only: bool
) -> list[tuple[Any, dict[str, float]]]:
    """Time, filament and volume of each name, in the order in which they come first."""
    known, first, index = np.unique(names, return_index=True, return_inverse=True)
    sums = [np.bincount(index, weights=values, minlength=len(known)) for values in (time, laid, laid * area)]
    found = []
    for at in np.argsort(first).tolist():
        if laid_only and not sums[1][at]:
            continue
        found.append(
            (
                known[at].item(),
                {
                    "time_s": rounded(float(sums[0][at])),
                    "laid_mm": rounded(float(sums[1][at]) / MM),
                    "laid_mm3": rounded(float(sums[2][at]) / MM3),
                },
            )
        )
    return found

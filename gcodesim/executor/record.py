"""What happened in the steps of a window, as columns: the one thing that log, totals and checks look at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.executor.part import Part, deflection_of
from gcodesim.executor.window import StepWindow
from gcodesim.frames import Array

if TYPE_CHECKING:
    from gcodesim.world import WorldSteps

KINDS: Final = ("", "milling", "extrusion")
"""Processes as the log numbers them."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepRecord:
    """n steps: the window, what the world did, and the process summed over stocks.

    wrench, deflection (n, 6) in base axes at the tip; peak_force, torque, power,
    removed [m³] (negative when added), all (n,); `kind` points into KINDS;
    depths [m] of shank and holder in stock; flags of misuse.
    """

    window: StepWindow
    world: WorldSteps
    wrench: Array
    deflection: Array
    peak_force: Array
    torque: Array
    power: Array
    removed: Array
    engaged: NDArray[np.bool_]
    kind: NDArray[np.int64]
    shank_depth: Array
    holder_depth: Array
    stopped: NDArray[np.bool_]
    reversed: NDArray[np.bool_]
    inside: NDArray[np.bool_]
    tilted: NDArray[np.bool_]
    rapid: NDArray[np.bool_]
    adding: NDArray[np.bool_]
    rapid_bound: Array

    def __len__(self) -> int:
        return len(self.window)


def record_of(window: StepWindow, world: WorldSteps, parts: Sequence[Part]) -> StepRecord:
    """Sum up the parts of a window."""
    n = len(window)
    wrench, deflection = np.zeros((n, 6)), np.zeros((n, 6))
    columns: dict[str, Any] = {
        name: np.zeros(n) for name in ("peak_force", "torque", "power", "removed", "shank_depth", "holder_depth")
    }
    marks_of = ("engaged", "stopped", "reversed", "inside", "tilted", "rapid")
    flags: dict[str, Any] = {name: np.zeros(n, dtype=bool) for name in marks_of}
    adding = np.zeros(n, dtype=bool)
    kind, bound = np.zeros(n, dtype=np.int64), np.zeros(n)
    for part in parts:
        answer = part.answer
        if answer is None or part.wrench is None:
            continue
        here = slice(part.begin, part.end)
        wrench[here] += part.wrench
        deflection[here] += deflection_of(part)
        for name, values in columns.items():
            values[here] += getattr(answer, name)
        for name, marks in flags.items():
            marks[here] |= part.window.rapid if name == "rapid" else getattr(answer, name)
        kind[here] = np.where(answer.engaged, KINDS.index(part.task.process.kind), kind[here])
        adding[here] |= not part.task.process.takes
        bound[here] += _rapid_bound(part)
    return StepRecord(
        window=window,
        world=world,
        wrench=wrench,
        deflection=deflection,
        kind=kind,
        rapid_bound=bound,
        adding=adding,
        **columns,
        **flags,
    )


def _rapid_bound(part: Part) -> Array:
    """Volume (n,) [m³] that a rapid may seem to take where it only grazes: half a cell of all wall that it passes."""
    stock, window = part.task.target.stock, part.window
    way = window.piece_end - window.piece_start
    low = np.minimum(window.piece_start[:, 2], window.piece_end[:, 2])
    depth = np.clip(stock.z_range[1] - low, 0.0, stock.z_range[1] - stock.z_range[0])
    walls = 2.0 * np.hypot(way[:, 0], way[:, 1]) * depth + 2.0 * np.pi * part.task.reach * np.abs(way[:, 2])
    bound = np.zeros(window.steps)
    np.add.at(bound, window.piece_step, 0.5 * float(stock.grid[2:].max()) * walls)
    return bound

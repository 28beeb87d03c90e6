"""What tools give off while they are switched on, as the log draws it: spray, light, water, a strand."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.jobs.switching import tools_seen_on
from gcodesim.log import DrawnShape
from gcodesim.recorder.bodies import drawn

if TYPE_CHECKING:
    from gcodesim.motion.tool_path import ToolPath
    from gcodesim.shop import Shop
    from gcodesim.tools.tool import Tool

LOOK_NS: Final = 20_000_000
"""A switch that is shorter may go unseen in the drawing."""

MOST_LOOKS: Final = 2000
"""In a whole run: each change draws the tool anew, and a print switches at every travel."""


def plume_shapes(tool: Tool | None) -> tuple[DrawnShape, ...]:
    """What a tool gives off, in frame `tool`."""
    if tool is None:
        return ()
    shapes = (drawn(part.placed, tool.color_of(part.part)) for part in tool.plume)
    return tuple(shape for shape in shapes if shape is not None)


class Plumes:
    """Looks now and then whether the tool in use is switched on."""

    def __init__(self, shop: Shop, path: ToolPath, duration_ns: int) -> None:
        self._shop = shop
        self._look_ns = max(LOOK_NS, duration_ns // MOST_LOOKS)
        self._has_any = any(tool.plume for tool in shop.cell.tools.values())
        self._lit = 0  # one more than the number of the tool that was on at the last look, 0: none
        self._look = -1
        self.follow(path)

    def follow(self, path: ToolPath) -> None:
        """The run goes on along `path`, which begins with all that there was before."""
        ends_on = np.zeros(len(path) + 1, dtype=bool)  # in each row, and after the last one
        self._on = _rows_on(_with_end(path), self._shop) if self._has_any and len(path) else ends_on

    def changes(
        self, rows: NDArray[np.int64], tools: NDArray[np.int64], t_ns: NDArray[np.int64]
    ) -> list[tuple[int, bool]]:
        """Which of n instants differ from the one before, and whether a tool is on; each has a path row, tool and time.

        The windows of a run may be cut anywhere: only the first instant of each look counts.
        """
        if not self._has_any or not len(rows) or len(self._on) < 2:
            return []
        looks, first = np.unique(t_ns // self._look_ns, return_index=True)
        first = first[looks > self._look]
        if not len(first):
            return []
        self._look = int(looks[-1])
        lit = np.where(self._on[rows[first]], tools[first] + 1, 0)
        fresh = np.flatnonzero(np.diff(lit, prepend=self._lit) != 0)
        self._lit = int(lit[-1])
        return [(int(first[k]), bool(lit[k] > 0)) for k in fresh]

    @property
    def goes_off_at_end(self) -> bool:
        """Whether the tool was seen to be on, and the words after the last move switch it off."""
        return self._lit > 0 and not self._on[-1]


def _with_end(path: ToolPath) -> ToolPath:
    """A path with one row more, in which the machine stands where it has come to."""
    n = len(path)
    columns = {each.name: getattr(path, each.name) for each in fields(path)}
    longer: dict[str, Any] = {
        k: np.concatenate([v, v[-1:]]) for k, v in columns.items() if isinstance(v, np.ndarray) and len(v) == n
    }
    if len(path.extrude):
        longer["extrude"] = np.append(path.extrude, 0.0)
    return replace(path, **longer)


def _rows_on(path: ToolPath, shop: Shop) -> NDArray[np.bool_]:
    """Whether the tool in use is switched on by words of the program, or pushes filament, in each row (n,)."""
    on: NDArray[Any] = path.extrude > 0.0 if len(path.extrude) else np.zeros(len(path), dtype=bool)
    for switched in tools_seen_on(path, shop):
        on = on | (switched.held & switched.on)
    return on

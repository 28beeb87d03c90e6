"""Work that stands on what another program moves, such as a positioner, as an arm sees it that works there.

The work stands still from one wait of the program to the next; a wait is where its program meets others
(`planning/waiting.py`). So its place is known once the plan of the program that moves it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import ToolPath
from gcodesim.planning.marks import is_wait


@frozen(eq=False)
class BorneWork:
    """Places of the work systems that others move.

    `moved[system]` (w + 1, 4, 4) is the motion in B by which a system has gone from where it is with the axes under it
    at zero, after so many waits of the program (0 first). `passed` are the waits of earlier legs, and `before` (4, 4)
    is the motion with which the last of these ended; None: there was none.
    """

    moved: Mapping[int, Array]
    passed: int = 0
    before: Array | None = None

    def on_rows(self, path: ToolPath) -> Array:
        """The motion (n, 4, 4) of the work of each row of a path."""
        waits = np.array([noted.row for noted in path.events if is_wait(noted.event)], dtype=np.int64)
        passed = self.passed + np.searchsorted(waits, np.arange(len(path)), side="right")
        systems = np.array([state.system for state in path.states], dtype=np.int64)[path.state]
        X = np.tile(np.eye(4), (len(path), 1, 1))
        for system, moved in self.moved.items():
            here = systems == system
            X[here] = moved[np.minimum(passed[here], len(moved) - 1)]
        return X

    def shifts_between(self, path: ToolPath) -> NDArray[np.bool_]:
        """Whether (n,) the work of a row stands elsewhere than that of the row before."""
        X = self.on_rows(path)
        first = X[:1] if self.before is None else self.before[None]
        before = np.concatenate([first, X[:-1]])[: len(X)]
        shifts: NDArray[np.bool_] = (np.abs(X - before) > 1e-12).any(axis=(1, 2))
        return shifts

    def carried(self, path: ToolPath) -> ToolPath:
        """The path, given in B for axes at zero, where the work carries it."""
        X = self.on_rows(path)
        R, p = X[:, :3, :3], X[:, :3, 3]
        start, end = path.start.copy(), path.end.copy()
        for points in (start, end):
            points[:, :3] = applied(R, points[:, :3]) + p
        return replace(path, start=start, end=end, center=applied(R, path.center) + p, normal=applied(R, path.normal))

    def turned(self, path: ToolPath, axes: Array) -> Array:
        """Axes (n, 3, 3) of rows, given in B for axes at zero, where the work carries them."""
        rows: Array = multiplied(self.on_rows(path)[:, :3, :3], axes)
        return rows

    def after(self, path: ToolPath) -> BorneWork:
        """The same for the leg that follows this one."""
        waits = sum(is_wait(noted.event) for noted in path.events)
        before = self.on_rows(path)[-1] if len(path) else self.before
        return replace(self, passed=self.passed + waits, before=before)

"""Rows that an arm runs in joint space: away from its home, to it, and from one orientation of the tool to another."""

from __future__ import annotations

from dataclasses import field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import HOME, RAPID, ToolPath


@frozen(kw_only=False, eq=False)
class JointRows:
    """A path and its rows in joint space, `joint` (n,); those that end at home are marked in `home` (n,).

    The first row is one of them, and there is one wherever the orientation of the
    tool changes, so all rows between two of them keep the orientation. `before` are the rows, as they were given,
    before which a move was inserted.
    """

    path: ToolPath
    joint: NDArray[np.bool_]
    home: NDArray[np.bool_]
    before: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    def row(self, given: int) -> int:
        """Where a row is that was given."""
        return given + int(np.searchsorted(self.before, given, side="right"))


def with_joint_rows(
    path: ToolPath,
    R_BO: Array,
    *,
    joint_rapids: bool,
    held: Array | None = None,
    bend: Array | None = None,
    shifts: NDArray[np.bool_] | None = None,
) -> JointRows:
    """Find the joint rows of `path`; where a feed would need one before it, a move on the spot is inserted.

    R_BO (n, 3, 3) is the orientation of each row. `joint_rapids`: all of G0 in joint space. `held` (3, 3) is the
    orientation that the tool has already, None when it has none yet. With another `bend` (n, 4, 4) of the tool the
    flange stands elsewhere, so there is a joint row too; so it is where the work `shifts` (n,) before a row.
    """
    home = path.kind == HOME
    shifts = np.zeros(len(path), dtype=bool) if shifts is None else shifts
    turned = np.zeros(len(path), dtype=bool)
    if len(path):
        same = _same_as_before(R_BO)
        if bend is not None:
            same &= _same_as_before(bend)
        turned[1:] = ~same | home[:-1] | shifts[1:]
        turned[0] = True
    rapid = path.kind == RAPID
    joint = home | (turned & rapid)
    if joint_rapids:
        joint |= rapid
    elif len(path) and held is not None and not shifts[0] and np.all(np.abs(R_BO[0] - held) < 1e-12):
        joint[0] = home[0]  # a move that starts on the spot, straight like any other
    before = np.flatnonzero(turned & ~joint)
    if not len(before):
        return JointRows(path, joint, home)
    moved = _with_moves_on_the_spot(path, before)
    return JointRows(moved, np.insert(joint, before, True), np.insert(home, before, False), before)


def _same_as_before(matrices: Array) -> NDArray[np.bool_]:
    """Whether each but the first of some matrices (n, k, k) is the one before (n - 1,); by entries, as k is small."""
    entries = matrices.reshape(len(matrices), -1)
    same = np.ones(len(entries) - 1, dtype=bool)
    for k in range(entries.shape[1]):
        same &= np.abs(entries[1:, k] - entries[:-1, k]) < 1e-12
    return same


def _with_moves_on_the_spot(path: ToolPath, before: NDArray[np.intp]) -> ToolPath:
    columns: dict[str, Any] = {
        f.name: getattr(path, f.name) for f in fields(ToolPath) if f.name not in ("states", "spans", "events")
    }
    columns = {name: np.insert(column, before, column[before], axis=0) for name, column in columns.items()}
    at = before + np.arange(len(before))
    columns["kind"][at] = RAPID
    columns["end"][at] = columns["start"][at]
    columns["feed"][at] = np.inf
    columns["rotary_feed"][at] = False
    columns["sweep"][at] = 0.0
    columns["stop"][at] = True
    events = tuple(replace(e, row=e.row + int(np.searchsorted(before, e.row, side="left"))) for e in path.events)
    return replace(path, **columns, events=events)

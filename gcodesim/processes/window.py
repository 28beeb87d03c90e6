"""Input and output of a process: columns over the steps of one window, in the frame S of its target."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@frozen(eq=False)
class Window:
    """The motion of a tool over n steps; all vectors in axes of S.

    c straight pieces in order, each inside one step. The tip moves from `piece_start` to `piece_end` (c, 3) [m]
    during step `piece_step` (c,), in the part `piece_share` (c, 2) of its time. Steps may have none (a dwell) or
    several (a corner); without shares a step goes the mean way of its pieces. Positions are those of the rigid
    machine; the process adds the deflection.

    axis (n, 3): unit vector from the tip to the holder at the end of each step, axis_before at its beginning (None: the
    same); velocity (n, 3) [m/s] of the tip; rapid (n,): the step is part
    of a G0; `signals` maps each `Signal` that the process reads to its values (n,), flags as such; compliance
    (n, 6, 6) of the tip: wrench (force, torque) to displacement (translation, rotation), or None for a rigid machine;
    side (n, 3): unit vector along X of the tool at the end of each step. `where(frame)` gives the poses X_SF
    (n, 4, 4) of any frame of the scene at the ends of the steps, seen from S, also of one that another machine moves.

    dt [s] of one step, (n,) where steps are stretches of path of different length, which only a process meets that acts
    `by_path`; filament (c,) [m]: what E words of a printer's program send through the nozzle along each piece, None
    where there are none. `turn(onward)` tells how much the way turns to the left about Z of S (n,) [1/m] in the next
    `onward` [m] from the beginning of each step, or up to a corner; NaN where that is not known, None if it is known
    nowhere. For what acts on parts, pose (n, 4, 4) is the tip X_ST at the end of each step, pose_before (4, 4) at the
    beginning of the first. `fresh` (n,): steps with which a process that looks at the stock for many steps at once has
    to look anew, so that no number depends on where windows begin; None: it may look as seldom as it likes.
    """

    piece_start: Array
    piece_end: Array
    piece_step: Ints
    axis: Array
    velocity: Array
    rapid: Flags
    signals: Mapping[str, NDArray[Any]]
    dt: float | Array
    compliance: Array | None = None
    piece_share: Array | None = None
    axis_before: Array | None = None
    filament: Array | None = None
    side: Array | None = None
    where: Callable[[str], Array] | None = None
    pose: Array | None = None
    pose_before: Array | None = None
    turn: Callable[[float], Array] | None = None
    fresh: Flags | None = None

    @property
    def steps(self) -> int:
        """Number of steps n."""
        return len(self.rapid)

    @property
    def moving(self) -> Flags:
        """Steps (n,) in which the tip goes some way; a stay before a rapid is no part of it."""
        moving = np.zeros(self.steps, dtype=np.bool_)
        moving[self.piece_step[(self.piece_start != self.piece_end).any(axis=1)]] = True
        return moving

    def part(self, begin: int, end: int) -> Window:
        """Steps `begin` to `end`, as a window of their own."""
        first, last = np.searchsorted(self.piece_step, [begin, end])
        pieces, steps, where, turn = slice(first, last), slice(begin, end), self.where, self.turn
        ends = {
            name: None if value is None else value[steps]
            for name, value in (
                ("axis_before", self.axis_before),
                ("compliance", self.compliance),
                ("side", self.side),
                ("pose", self.pose),
            )
        }
        before = self.pose_before if begin == 0 or self.pose is None else self.pose[begin - 1]
        return replace(
            self,
            piece_start=self.piece_start[pieces],
            piece_end=self.piece_end[pieces],
            piece_step=self.piece_step[pieces] - begin,
            piece_share=None if self.piece_share is None else self.piece_share[pieces],
            filament=None if self.filament is None else self.filament[pieces],
            axis=self.axis[steps],
            velocity=self.velocity[steps],
            rapid=self.rapid[steps],
            signals={name: values[steps] for name, values in self.signals.items()},
            dt=self.dt[steps] if isinstance(self.dt, np.ndarray) else self.dt,
            where=None if where is None else lambda frame: where(frame)[steps],
            turn=None if turn is None else lambda onward: turn(onward)[steps],
            pose_before=before,
            fresh=None if self.fresh is None else self.fresh[steps],
            **ends,
        )


@frozen(eq=False)
class ProcessStep:
    """What a process did in each of n steps; vectors in axes of S.

    wrench (n, 6): mean force [N] and torque [N·m] on the tool, about the displaced tip; deflection (n, 3) [m] of the
    tip; `columns` (n,) by name, those that the process declares in `writes`. A column that is left out is zero, or what
    its `steady` says.
    `changes` is what has to change in the rest of the cell, such as a part that is held from now on.
    `by_stock` are the columns of what was removed and added, by the name of the stock, where the target is an
    `StockAssembly` of several; empty where it is one.
    """

    wrench: Array
    deflection: Array
    columns: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    changes: tuple[Any, ...] = ()
    by_stock: Mapping[str, Mapping[str, NDArray[Any]]] = field(default_factory=dict)

    @staticmethod
    def free(
        steps: int,
        columns: Mapping[str, NDArray[Any]] | None = None,
        by_stock: Mapping[str, Mapping[str, NDArray[Any]]] | None = None,
    ) -> ProcessStep:
        """A result without force over `steps` steps; without `columns` nothing happened at all."""
        return ProcessStep(
            wrench=np.zeros((steps, 6)),
            deflection=np.zeros((steps, 3)),
            columns=columns or {},
            by_stock=by_stock or {},
        )

    @staticmethod
    def joined(parts: Sequence[ProcessStep]) -> ProcessStep:
        """The steps of several results, one after the other."""
        if len(parts) == 1:
            return parts[0]
        lengths = [len(part.wrench) for part in parts]
        names = list(dict.fromkeys(name for part in parts for name in part.by_stock))
        return ProcessStep(
            wrench=np.concatenate([part.wrench for part in parts]),
            deflection=np.concatenate([part.deflection for part in parts]),
            columns=_joined([part.columns for part in parts], lengths),
            changes=tuple(change for part in parts for change in part.changes),
            by_stock={name: _joined([part.by_stock.get(name, {}) for part in parts], lengths) for name in names},
        )

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A column (n,); zeros when the process left it out."""
        column = self.columns.get(name)
        return np.zeros(len(self.wrench)) if column is None else column


def _joined(parts: Sequence[Mapping[str, NDArray[Any]]], lengths: Sequence[int]) -> dict[str, NDArray[Any]]:
    """Columns one after the other; zeros where one of the parts, of so many steps, has none of that name."""
    kinds = {name: values.dtype for columns in parts for name, values in columns.items()}
    return {
        name: np.concatenate([columns.get(name, np.zeros(n, kind)) for columns, n in zip(parts, lengths, strict=True)])
        for name, kind in kinds.items()
    }


@dataclass(slots=True, kw_only=True, eq=False)
class ProcessState:
    """What a process carries from one window to the next: it belongs to one tool at one target.

    `values` is laid out by the process (milling: see `STATE` in `milling_kernels`), empty where nothing is remembered.
    It is copied, and restored when a window is undone. A new state means that the tool was just put in; if that is
    inside the stock, it cuts nothing until it has left it.
    """

    values: Array = field(default_factory=lambda: np.zeros(0))


def sums_by_step(step: NDArray[np.int64], value: Array, steps: int) -> Array:
    """Sums (steps,) of `value` (c,) over the pieces of each step, of which `step` (c,) says the number."""
    totals = np.zeros(steps)
    np.add.at(totals, step, value)
    return totals

"""What goes into a process and what comes out: columns over the steps of one window, in the stock frame S."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Window:
    """The motion of a tool over n steps; all vectors in axes of S.

    c straight pieces, in order, each inside one step: the tip moves from `piece_start` to `piece_end` (c, 3) [m]
    during step `piece_step` (c,). Steps may have none (a dwell) or several (a corner). Positions are those of the
    rigid machine; deflection is added here.

    axis (n, 3): unit vector from the tip to the holder; velocity (n, 3) [m/s] of the tip; spindle (n,) [rad/s],
    positive M3; rapid, active (n,): G0 step, process tool switched on; compliance (n, 6, 6) of the tip: wrench
    (force, torque) to displacement (translation, rotation), or None for a rigid machine; dt [s] of one step.
    """

    piece_start: Array
    piece_end: Array
    piece_step: Ints
    axis: Array
    velocity: Array
    spindle: Array
    rapid: Flags
    active: Flags
    dt: float
    compliance: Array | None = None

    @property
    def steps(self) -> int:
        """Number of steps n."""
        return len(self.spindle)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProcessStep:
    """What a process did in each of n steps; vectors in axes of S.

    wrench (n, 6): mean force [N] and torque [N·m] on the tool, about the displaced tip; peak_force (n,) [N]: the
    greatest force within a revolution; torque (n,) [N·m] that the spindle has to give; power (n,) [W];
    removed (n,) [m³], negative when material was added; nominal (n,) [m³] that the process meant to add;
    engaged (n,): the tool works in material; deflection (n, 3) [m] of the tip.

    Engagement: axial_depth and radial_width [m] of the cut, entry and exit angle [rad] clockwise from the left of the
    feed, chip [m] the greatest chip thickness; 0 where nothing is cut.
    Misuse: shank_depth and holder_depth [m] in material; stopped, reversed: in a cut with the spindle at rest or
    running backwards (no force is computed then); inside: the tool stands in material that it may not cut, because
    it was put there and has not been outside since; tilted: no cut is computed for a tool that is not upright in S.
    """

    wrench: Array
    peak_force: Array
    torque: Array
    power: Array
    removed: Array
    engaged: Flags
    deflection: Array
    axial_depth: Array
    radial_width: Array
    entry: Array
    exit: Array
    chip: Array
    shank_depth: Array
    holder_depth: Array
    stopped: Flags
    reversed: Flags
    inside: Flags
    tilted: Flags
    nominal: Array

    @staticmethod
    def idle(steps: int) -> ProcessStep:
        """Nothing happened in `steps` steps."""
        zeros = np.zeros(steps)
        none = np.zeros(steps, dtype=np.bool_)
        return ProcessStep(
            wrench=np.zeros((steps, 6)), peak_force=zeros, torque=zeros, power=zeros, removed=zeros, engaged=none,
            deflection=np.zeros((steps, 3)), axial_depth=zeros, radial_width=zeros, entry=zeros, exit=zeros,
            chip=zeros, shank_depth=zeros, holder_depth=zeros, stopped=none, reversed=none, inside=none, tilted=none,
            nominal=zeros,
        )  # fmt: skip


@dataclass(slots=True, kw_only=True, eq=False)
class ProcessState:
    """What a process carries from one window to the next: it belongs to one tool in one stock.

    `values` is laid out by the kernels (see `STATE` in `milling_kernels`), empty where nothing is remembered.
    A new state means: tool just placed; when that is inside the stock it cuts
    nothing until it has left it.
    """

    values: Array = field(default_factory=lambda: np.zeros(0))

"""What every world offers.

A world moves one robot (or machine tool) along commanded joint vectors with a
fixed step. Row k of a run is the state at the end of step k, so a world
without dynamics answers `q = q_command`. Velocity and acceleration are those
of the integrator, ``qd_k = (q_k - q_{k-1}) / dt`` and
``qdd_k = (qd_k - qd_{k-1}) / dt``. Both worlds agree on them, they need no
look into the next window, and no number depends on how a run is split into windows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.world.body import ToolBody

if TYPE_CHECKING:
    from gcodesim.processes.swing_kernels import Swings

# acceleration of free fall [m/s²] in W; the conventional value (CGPM 1901)
STANDARD_GRAVITY: Final = (0.0, 0.0, -9.80665)

# couple(first, q (m, j)) -> wrench (m, 6) on the tool at the tip in base axes, force then torque
Couple = Callable[[int, Array], Array]


class Reacting(Protocol):
    """A process that is told what the machine does. `react` is what a world calls for each step, in order."""

    def react(self, k: int, q_before: Array, q_free: Array, response: Array) -> Array:
        """The wrench (6,) on the tool at the tip in step `k`, base axes.

        The joints (j,) of the links begin the step at `q_before` and end it at `q_free` if there is no wrench; a
        wrench F moves the tip by `response` (6, 6) F besides (translation, rotation vector).
        """


class NotAtOnce(Exception):  # noqa: N818  (it is no error)
    """The first steps have to be run alone, `after` of them; nothing has happened.

    How a run is cut into windows may not matter, so this is decided from step to step.
    """

    def __init__(self, after: int) -> None:
        super().__init__(after)
        self.after = after


class SwungAtOnce(Protocol):
    """A process that can tell about many steps of a machine whose gears swing at once.

    A world may ask `swing` in place of all `react`. None: it cannot, and nothing has happened.
    """

    @property
    def divisible(self) -> bool:
        """Whether its steps may be run in parts; where not, a world never raises `NotAtOnce`."""

    @property
    def swung(self) -> NDArray[np.bool_]:
        """In which steps (n,) `swing` can tell."""

    def swing(self, swings: Swings) -> Array | None:
        """The wrenches (n, 6) on the tool at the tip, base axes; the winds of `swings` are filled."""

    def save(self) -> Callable[[], None]:
        """Remember what steps change; calling the result restores it."""


class WorldUnavailable(RuntimeError):  # noqa: N818  (it is no error of ours: something is not installed here)
    """This world cannot be opened on this machine; the text says what would help."""


@frozen(eq=False)
class WorldSteps:
    """What happened in n steps of a robot with j joints; row k is the end of step k.

    q        (n, j) joint positions, motor side [rad, m]
    qd       (n, j) joint velocities [rad/s, m/s]
    qdd      (n, j) joint accelerations [rad/s², m/s²]
    effort   (n, j) what the motors deliver [N·m, N]
    saturated (n, j) the motor is at its effort limit, or the motion would need more than that
    reaction (n, 6) wrench of the flange on the tool at the flange F, base axes, force then torque [N, N·m];
             zero without a tool
    gear     (n, j) how far the links are off the motors, besides what gravity does [rad, m]; None where no gear is
             part of the world
    """

    q: Array
    qd: Array
    qdd: Array
    effort: Array
    saturated: NDArray[np.bool_]
    reaction: Array
    gear: Array | None = None

    def at(self, steps: NDArray[np.int64]) -> WorldSteps:
        """Some of the steps, in this order."""
        return WorldSteps(
            q=self.q[steps],
            qd=self.qd[steps],
            qdd=self.qdd[steps],
            effort=self.effort[steps],
            saturated=self.saturated[steps],
            reaction=self.reaction[steps],
            gear=None if self.gear is None else self.gear[steps],
        )

    @staticmethod
    def joined(parts: Sequence[WorldSteps]) -> WorldSteps:
        """One after another; at least one, all of one world."""
        if len(parts) == 1:
            return parts[0]
        names = ["q", "qd", "qdd", "effort", "saturated", "reaction"]
        if parts[0].gear is not None:
            names.append("gear")
        return WorldSteps(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


class World(Protocol):
    """A robot that obeys joint commands; one of WORLDS."""

    step_ns: int
    may_lag: bool
    """Whether joints can be elsewhere than commanded."""
    keeps_to_command: bool
    """Whether they usually are where they are commanded to be, so that it pays to cut ahead."""

    tells_efforts: bool
    """Whether it tells speeds and efforts, for which it is asked tick by tick; if not, they are zero."""

    @property
    def tool(self) -> ToolBody | None:
        """The tool on the flange."""

    @property
    def parked(self) -> Mapping[str, tuple[ToolBody, Pose]]:
        """Tools that were taken off, by name, with the pose of their flange side (F) in W."""

    def reset(self, q: Array) -> None:
        """Stand still at joint vector `q` (j,)."""

    def attach(self, tool: ToolBody | None, pocket: Pose | None = None) -> None:
        """Change the tool; positions and velocities of the joints stay as they are.

        The old tool stays at `pocket`, the pose of its flange side in W, as a
        body of its own; None: it leaves the scene. A parked tool of the new
        tool's name is taken out of its pocket.
        """

    def run(self, q_command: Array, couple: Couple | Array | None = None) -> WorldSteps:
        """Move through `q_command` (n, j), one row a step.

        `couple` gives the wrench on the tool at the tip in base axes: a
        function `couple(first, q)` of the rows `first` to `first + len(q)`, an
        array (n, 6) when it is known beforehand, or None for no wrench. The
        kinematic world calls the function once with all rows, `bullet` once a
        step, in order, with the position that the step is expected to reach.

        Raises `NotAtOnce` with a `SwungAtOnce` whose first steps go another way than the others.
        """

    def keeps_up(self, q_command: Array, wrench: Array) -> bool:
        """Whether every step of `q_command` (n, j) under `wrench` (n, 6) will end on its command.

        If so, a process that was asked about all rows at once, at
        the commanded joints, has given the same answer as step by
        step, and the array can be passed to `run`, which is far quicker.
        """

    def close(self) -> None:
        """Free what the world holds; a second call does nothing."""

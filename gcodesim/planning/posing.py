"""How a machine is posed for what a program commands: one family of posings behind one function, `plan_path`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from gcodesim.canon import Axes
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.motion.look_ahead import LookAhead
from gcodesim.motion.pieces import Pieces
from gcodesim.motion.standing import Duration
from gcodesim.motion.timing import Caps, time_law
from gcodesim.motion.tool_path import Commanded, ToolPath
from gcodesim.planning.feeds import without_zero_feeds
from gcodesim.planning.moments import PathFindings
from gcodesim.planning.plan import JointPath, Plan

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics


@frozen(kw_only=False, eq=False)
class Posed:
    """A path laid out for a machine: its pieces, the joints along them, and what these allow.

    `caps` limit speed and acceleration along segments of the pieces; None where the limits of the pieces are enough.
    """

    pieces: Pieces
    joints: JointPath
    caps: Caps | None = None


class Posing(Protocol):
    """The way from what is commanded to joints. Times, feeds of zero and the order of findings are `plan_path`'s."""

    @property
    def understands(self) -> frozenset[Commanded]:
        """What a program may command."""
        ...

    def start(self, kinematics: Kinematics, home: Array) -> Axes:
        """Where the controlled point is in M when the joints are at `home` (j,), without tool length offset."""
        ...

    def pose(self, path: ToolPath, kinematics: Kinematics, home: Array, findings: PathFindings) -> Posed:
        """Lay out `path`, given in M, for a machine that stands at `home` (j,) first.

        What does not fit is added to `findings` and still laid out, so that everything is found at once.
        """
        ...

    def after(self, leg: JointPath, path: ToolPath, home: Array) -> Posing:
        """The posing with which the next leg of the program goes on from where `leg` along `path` ended.

        Choices that were made stay. `home` (j,) is where the machine stood before the first leg.
        """
        ...


def plan_path(
    path: ToolPath,
    kinematics: Kinematics,
    posing: Posing,
    *,
    home: Array,
    duration_of: Duration | None = None,
    tool_frames: Mapping[int, Pose] | None = None,
    look_ahead: LookAhead | None = None,
) -> Plan:
    """Run `path` on a machine whose joints stand at `home` (j,) first.

    `duration_of` says how long an event takes [s]; `tool_frames` maps a tool number to X_FT; `look_ahead` says what
    the control knows of the way ahead, None: all. Raises ValueError when the path commands what `posing` does
    not understand: the reader of the program should have refused it.
    """
    unknown = {state.control for state in path.states} - posing.understands
    if unknown:
        raise ValueError(f"{type(posing).__name__} cannot be commanded by {', '.join(sorted(unknown))}")
    findings = PathFindings()
    path = without_zero_feeds(path, findings)
    posed = posing.pose(path, kinematics, home, findings)
    trajectory = time_law(posed.pieces, posed.caps, duration_of=duration_of, look_ahead=look_ahead)
    return Plan(trajectory, findings.timed(trajectory, posed.joints), kinematics, posed.joints, tool_frames or {})

"""A robot program before it is put into words: what every control is told, in SI."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

from gcodesim.diagnostics import Span
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics


@frozen(eq=False)
class ArmPlace:
    """Where the tool is, and how the machine stands there.

    `X_BT` is the tip seen from the base of the arm (of an arm that is carried: its base while that stands at zero),
    `q` (k,) the joints of the arm [rad], `externals` (e,) the external axes [m, rad].
    """

    X_BT: Pose
    q: Array
    externals: Array


@frozen(eq=False)
class RobotStep:
    """One thing that the robot is told; `span` is the place of the program that asks for it."""

    span: Span


@frozen(eq=False)
class RobotMove(RobotStep):
    """A move to `to`, by joints, along a line, or along the circle through `via`.

    `speed` [m/s] of the tip; `share` of the greatest joint speeds, for moves by joints; `seconds` is how long it was
    planned to take. The corner at its end is rounded from `blend` [m] before the point on; 0: it stops there.
    `frame` and `tool` are numbers of `RobotProgram.frames` and `tools`.
    """

    kind: Literal["joint", "linear", "circular"]
    to: ArmPlace
    via: ArmPlace | None = None
    speed: float = 0.0
    share: float = 1.0
    seconds: float = 0.0
    blend: float = 0.0
    frame: int = 1
    tool: int = 0


@frozen(eq=False)
class RobotWait(RobotStep):
    """Stand for `seconds`."""

    seconds: float


@frozen(eq=False)
class RobotSwitch(RobotStep):
    """Set an output of the control, by its name there; `digital`: on where `value` is not 0.

    `with_motion`: where the next move begins, without a stop.
    """

    signal: str
    digital: bool
    value: float
    with_motion: bool = False


@frozen(eq=False)
class RobotAwait(RobotStep):
    """Stand until a digital input of the control, by its name there, is `on`, or off."""

    signal: str
    on: bool


@frozen(eq=False)
class RobotCall(RobotStep):
    """Call a program that the control has, with a number: `name(2)`."""

    name: str
    argument: int


@frozen(eq=False)
class RobotHalt(RobotStep):
    """Stop until somebody starts the program again; `text` says why."""

    text: str


@frozen(eq=False)
class Remark(RobotStep):
    """A comment."""

    text: str


@frozen(eq=False)
class ToldFrame:
    """A frame in which places are told: `X_BP` seen from the base of the arm, with its name, as G54."""

    name: str
    X_BP: Pose


@frozen(eq=False)
class ToolFrame:
    """A tool: its tip `X_FT` seen from the flange, its name and mass [kg], with the centre of it [m] in F."""

    name: str
    X_FT: Pose
    mass: float
    centre: tuple[float, float, float]


@frozen(eq=False)
class RobotProgram:
    """All that is to be said: `steps` in order, with `frames` and `tools` by number, and what stands in the heading.

    `kinematics` is that of the arm alone; `external_names` and `external_slides` (whether it slides) of its external
    axes. `joint_speeds` (k,) [rad/s] are the greatest of the arm.
    """

    name: str
    source: str
    cell: str
    steps: tuple[RobotStep, ...]
    frames: Mapping[int, ToldFrame]
    tools: Mapping[int, ToolFrame]
    kinematics: Kinematics
    joint_speeds: Array
    external_names: tuple[str, ...] = ()
    external_slides: tuple[bool, ...] = ()

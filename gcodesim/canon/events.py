"""The canonical events: frozen values in SI with the source span that caused them.

`end` is the controlled point in the machine frame M, tool length offset not
included: x, y, z [m], a, b, c [rad]. Axes stand at ``end + tool_offset``. The
kinds and fields are those of LinuxCNC's canonical machining functions
(Kramer, Proctor and Messina 2000, section 4), so listings can be compared.
Acts happen in time; states hold from where they stand until changed.
"""

from __future__ import annotations

from typing import Final, Literal

from gcodesim.canon.printing import MotionLimits, Section
from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen

__all__ = [
    "AXIS_LETTERS",
    "Action",
    "ArcFeed",
    "Axes",
    "Coolant",
    "Dwell",
    "End",
    "EndOfFile",
    "Event",
    "Extrude",
    "FeedUnit",
    "Input",
    "LinearFeed",
    "Log",
    "Message",
    "Move",
    "OptionalStop",
    "Orient",
    "Output",
    "Override",
    "PalletShuttle",
    "PathMode",
    "PlannerLimits",
    "Point",
    "PointControl",
    "Print",
    "ProbeMove",
    "Rapid",
    "SectionStart",
    "Spindle",
    "SplineFeed",
    "Stop",
    "Tap",
    "ToolChange",
    "ToolNumber",
    "ToolOffset",
    "ToolSelect",
    "WorkSystem",
]

Axes = tuple[float, float, float, float, float, float]
AXIS_LETTERS: Final = ("X", "Y", "Z", "A", "B", "C")
"""What the six are called, in their order."""
Point = tuple[float, float, float]

# speed of the XYZ path [m/s] or [m/rev]; of the rotary axes [rad/s] or [rad/rev] when only those move
FeedUnit = Literal["m/s", "m/rev", "rad/s", "rad/rev"]

ZERO_AXES: Axes = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@frozen
class Event:
    """Anything a program causes; `span` is the place that caused it."""

    span: Span


@frozen
class Move(Event):
    """A move of the controlled point to `end`. `block` counts executed blocks; `word` is the motion word, as G1."""

    end: Axes
    block: int = 0
    word: str = ""


@frozen
class Rapid(Move):
    """Move at full speed. `home` names the stored position (G28, G30) when the target is one that was never stored."""

    home: str = ""


@frozen
class LinearFeed(Move):
    """Straight cut at `feed` in `feed_unit`; in threading `pitch` [m/rev] rules instead and `feed` is 0.

    `extrude` [m] of filament goes along with it (E words); it is drawn back where that is negative.
    """

    feed: float
    feed_unit: FeedUnit = "m/s"
    pitch: float | None = None
    extrude: float = 0.0


@frozen
class ArcFeed(Move):
    """Arc or helix about `center` (at the height of the end along `normal`).

    `sweep` [rad] is signed, counterclockwise about `normal` positive, full
    turns included; `turns` counts full circles begun, 1 for less than one.
    `extrude` as in `LinearFeed`.
    """

    center: Point
    normal: Point
    ccw: bool
    turns: int
    sweep: float
    feed: float
    feed_unit: FeedUnit = "m/s"
    extrude: float = 0.0


@frozen
class SplineFeed(Move):
    """A spline as control points and as a polyline `points` that stays within 2 um of it."""

    points: tuple[Point, ...]
    control_points: tuple[Point, ...]
    feed: float
    feed_unit: FeedUnit = "m/s"


@frozen
class ProbeMove(Move):
    """Straight move until the probe trips: G38.2 to G38.5."""

    feed: float
    feed_unit: FeedUnit = "m/s"
    towards: bool = True
    must_trip: bool = True


@frozen
class Tap(Move):
    """Rigid tap: synchronous to `end` and back to where it began; `pitch` [m/rev]."""

    pitch: float


@frozen
class Dwell(Event):
    """Wait [s]."""

    seconds: float


@frozen
class Extrude(Event):
    """Filament alone, while the head stands: `length` [m], drawn back where negative, at `feed` [m/s] under `limits`.

    `by_firmware`: G10 or G11 moves it, no E word.
    """

    length: float
    feed: float
    limits: MotionLimits
    by_firmware: bool = False


@frozen
class PlannerLimits(Event):
    """State: limits of the planner of a printer, or of grbl."""

    limits: MotionLimits


@frozen
class SectionStart(Event):
    """State: what the following moves print."""

    section: Section


@frozen
class ToolSelect(Event):
    """T word: the tool that the next change brings."""

    tool: int


@frozen
class ToolChange(Event):
    """M6; tool 0 empties the spindle."""

    tool: int


@frozen
class ToolNumber(Event):
    """M61: the tool in the spindle is called by this number from now on."""

    tool: int


@frozen
class ToolOffset(Event):
    """State: the length offset in force, added to `end` to give axes."""

    offset: Axes


@frozen
class PointControl(Event):
    """State: whether moves are those of the tool's tip in the work, which rotary axes do not displace (`on`).

    X, Y, Z of `end` are then in the frame of the work, which lies on M while the axes of the table stand at zero. `at`
    is what the controlled point reads from now on. The machine does not move by it.
    """

    on: bool
    at: Axes


@frozen
class Spindle(Event):
    """State: speed [rad/s], or cutting speed [m/s] under G96 with the cap `max_speed` [rad/s]."""

    direction: Literal["off", "cw", "ccw"]
    speed: float
    unit: Literal["rad/s", "m/s"] = "rad/s"
    max_speed: float | None = None


@frozen
class Coolant(Event):
    """State."""

    flood: bool
    mist: bool


@frozen
class PathMode(Event):
    """State: G61, G61.1 or G64 with `tolerance` P [m] and merge tolerance `naive` Q [m] (0: none given)."""

    mode: Literal["exact_path", "exact_stop", "blend"]
    tolerance: float = 0.0
    naive: float = 0.0


@frozen
class Override(Event):
    """State: which overrides are allowed (M48 to M53)."""

    feed: bool
    speed: bool
    adaptive: bool
    hold: bool


@frozen
class WorkSystem(Event):
    """State: the work system in force; `index` 1 (G54) to 9 (G59.3), or more (`canon.systems`).

    ``end = R(rotation) (program + g92) + offset``, R about Z [rad]. Where the system leans against the machine,
    `axes` are the rows of a rotation that comes before the offset is added.
    """

    index: int
    offset: Axes
    g92: Axes
    rotation: float
    axes: tuple[Point, Point, Point] | None = None


@frozen
class Orient(Event):
    """M19: spindle angle [rad]; direction 0 shortest, 1 clockwise, 2 counterclockwise."""

    angle: float
    direction: int


@frozen
class Output(Event):
    """M62 to M65, M67, M68. `with_motion`: takes effect where the next move begins."""

    type: Literal["digital", "analog"]
    index: int
    value: float
    with_motion: bool


@frozen
class Input(Event):
    """M66, when somebody answers: the value of an input at once, or when what `wait` names has happened.

    `rise`, `fall`, `high` and `low` are L1 to L4; they give up after `timeout` [s].
    """

    type: Literal["digital", "analog"]
    index: int
    wait: Literal["immediate", "rise", "fall", "high", "low"] = "immediate"
    timeout: float = 0.0


@frozen
class Action(Event):
    """An M-code that the cell maps to a tool or gripper: `verb` on `target`."""

    m: int
    p: float | None
    q: float | None
    target: str
    verb: str


@frozen
class Message(Event):
    """(MSG, ...) and (DEBUG, ...): shown to the operator."""

    text: str


@frozen
class Print(Event):
    """(PRINT, ...)"""

    text: str


@frozen
class Log(Event):
    """(LOG, ...)"""

    text: str


@frozen
class Stop(Event):
    """M0, and M60 after its shuttle."""


@frozen
class OptionalStop(Event):
    """M1."""


@frozen
class PalletShuttle(Event):
    """M30 and M60."""


@frozen
class End(Event):
    """M2 or M30."""


@frozen
class EndOfFile(Event):
    """The closing % of a program without M2."""

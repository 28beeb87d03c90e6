"""What a run answers to a program that asks, and the events of its own that come of it. No program causes these."""

from __future__ import annotations

from gcodesim.canon.events import Axes, Dwell, Event, Point
from gcodesim.frozen import frozen


@frozen
class Touched:
    """The answer to a `ProbeMove`, in M [m, rad] like the ends of moves.

    `point` is where the controlled point was when the probe changed, the end of the move when it never did (then
    `tripped` is false). `stop` is where the machine came to rest. `refused`: the probe was in contact already, or free
    already when contact was to be left, so that nothing moved.
    """

    point: Axes
    stop: Axes
    tripped: bool
    refused: bool = False


@frozen
class Heard:
    """The answer to an `Input`: its `value`; None when the time for waiting ran out."""

    value: float | None


Answer = Touched | Heard


@frozen
class Waited(Dwell):
    """The time [s] that M66 took before its input answered."""


@frozen
class Noticed(Event):
    """M66 has heard the sensor of this name; `what` is the frame of what was before it, empty where nothing was."""

    sensor: str
    value: float | None
    what: str = ""


@frozen
class ToolAwaited(Event):
    """The machine is about to fetch a tool, and stands until it is there: another machine may have it."""

    tool: int


@frozen
class ToolReturned(Event):
    """The machine has put a tool back where others can fetch it."""

    tool: int


@frozen
class Pause(Dwell):
    """The rest of a step in which the machine came to rest: the answer comes with the next."""


@frozen
class Trip(Event):
    """What a probing move came to.

    The controlled point was at `point` [m, rad] in M when the probe changed, the tip of the tool at `tip` [m] in the
    world; `body` is what was touched. Not `tripped`: they are the end of the move. The machine went on by `over` [m]
    before it came to rest.
    """

    tripped: bool
    point: Axes
    tip: Point
    over: float = 0.0
    body: str = ""
    word: str = ""

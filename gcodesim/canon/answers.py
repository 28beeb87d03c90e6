"""What a run answers to a program that asks: where a probe stopped, what an input read."""

from __future__ import annotations

from dataclasses import dataclass

from gcodesim.canon.events import Axes


@dataclass(frozen=True, slots=True, kw_only=True)
class Touched:
    """The answer to a `Probe`, in M [m, rad] like the ends of moves.

    `point` is where the controlled point was when the probe changed, the end of the move when it never did (then
    `tripped` is false). `stop` is where the machine came to rest. `refused`: the probe was in contact already, or free
    already when contact was to be left, so that nothing moved.
    """

    point: Axes
    stop: Axes
    tripped: bool
    refused: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Heard:
    """The answer to an `Input`: its `value`; None when the time for waiting ran out."""

    value: float | None


Answer = Touched | Heard

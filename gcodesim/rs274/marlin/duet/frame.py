"""The data of the running program or macro, with its blocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from gcodesim.rs274.frame import Frame
from gcodesim.rs274.marlin.duet.blocks import IndentedBlocks
from gcodesim.rs274.marlin.duet.syntax import Value
from gcodesim.rs274.marlin.duet.tool_change import ChangeStep


class ModesOfCaller(NamedTuple):
    """What a macro may change for itself alone: units [m], G90 or G91, M82 or M83, and the feed [units/min]."""

    unit: float
    incremental: bool
    e_relative: bool
    feed: float


@dataclass(slots=True)
class BlockFrame(Frame):
    """The main program, or a macro, of a printer that knows conditions and loops.

    `given` are the letters of the call, which are `param.S` and the like inside; `modes` come back at the end of it.
    `then` is what else belongs to a change of tools.
    """

    blocks: IndentedBlocks = field(default_factory=lambda: IndentedBlocks({}, counts=True))
    given: Mapping[str, Value] = field(default_factory=dict)
    modes: ModesOfCaller | None = None
    then: tuple[ChangeStep, ...] = ()

    def situation(self) -> tuple[object, ...]:
        return (*Frame.situation(self), self.blocks.situation(), dict(self.given), self.modes, self.then)

"""The data of the running program, with its blocks."""

from __future__ import annotations

from dataclasses import dataclass, field

from gcodesim.rs274.frame import Frame
from gcodesim.rs274.marlin.duet.blocks import IndentedBlocks


@dataclass(slots=True)
class BlockFrame(Frame):
    """The main program of a printer that knows conditions and loops."""

    blocks: IndentedBlocks = field(default_factory=lambda: IndentedBlocks(counts=True))

    def situation(self) -> tuple[object, ...]:
        return (*Frame.situation(self), self.blocks.situation())

"""The control of a lathe that has executed all lines before one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from gcodesim.frozen import frozen
from gcodesim.rs274.entry.halted import Halted, Modal

_CYCLES: Final = frozenset((*(float(code) for code in range(70, 77)), 90.0, 92.0, 94.0))
_REPEATED_BY: Final = frozenset("xzuw")


@frozen(eq=False)
class HaltedLathe(Halted):
    """With the `simple_cycle` in force (90, 92, 94), and the `prepared` ones, whose first of two lines has been read.

    `in_face_plane`: it is between G12.1 and G13.1.
    """

    simple_cycle: float | None
    prepared: frozenset[float]
    in_face_plane: bool

    def own_obstacles(self, line: int) -> Iterator[str]:
        if self.in_face_plane:
            yield "X and C are a plane (polar coordinate interpolation, G12.1)"
        if self._is_second(line):
            yield "it is the second of two lines of one cycle"

    def cycle(self) -> Modal | None:
        if self.simple_cycle is None:
            return None
        return Modal(code=round(10.0 * self.simple_cycle), repeated_by=_REPEATED_BY, ended_by=_CYCLES)

    def _is_second(self, line: int) -> bool:
        """Whether `line` names a prepared cycle, and the line before it does, too."""
        if not self.prepared:
            return False
        here = self.codes(line - 1) & self.prepared
        before = next((self.codes(i) for i in range(line - 2, -1, -1) if self.file.lines[i].strip()), frozenset())
        return bool(here & before)

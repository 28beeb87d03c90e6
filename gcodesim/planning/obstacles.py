"""What an arm may hit in the postures that a search tries: asked by planners, answered by whoever knows the bodies."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.kinematics.assembly import Assembly
    from gcodesim.motion.tool_path import ToolPath
    from gcodesim.planning.flange import Flange

Numbers = NDArray[np.int64] | NDArray[np.intp] | NDArray[np.int32]


class Obstacles(Protocol):
    """The bodies of a machine and around it, as they are at the start."""

    def hit(self, q: Array, tools: Numbers) -> NDArray[np.bool_]:
        """Whether a body that may not is in another one with all joints at q (n, j) and these tools (n,) held."""
        ...

    def pair(self, q: Array, tool: int) -> tuple[str, str] | None:
        """The first two bodies that are in each other with all joints at q (j,), in words; None: none are."""
        ...

    def shifted(self, shift: Array) -> Obstacles:
        """The same where all that goes along with the work has been moved by (3,) [m] in the base."""
        ...

    def with_round_tools(self) -> Obstacles:
        """The same where round tools may not be in a fixture either.

        Such a tool is in it with all joints that bring it to its place, so that searches do without.
        """
        ...


@frozen(eq=False)
class Around:
    """Obstacles at the poses of a cut: the tool that is held there (n,), and where external axes stand (n, e)."""

    obstacles: Obstacles
    tools: Numbers
    assembly: Assembly | None = None
    values: Array | None = None

    @staticmethod
    def on_rows(obstacles: Obstacles | None, path: ToolPath, row: Numbers) -> Around | None:
        """Those at poses on rows (n,) of a path, without external axes; None where nobody knows of any."""
        if obstacles is None:
            return None
        numbers = np.array([state.tool for state in path.states], dtype=np.int64)
        return Around(obstacles=obstacles, tools=numbers[path.state[row]])

    @staticmethod
    def at(obstacles: Obstacles | None, flange: Flange, piece: NDArray[np.int64], s: Array) -> Around | None:
        """Those at places `s` (n,) of `piece` (n,); None where nobody knows of any."""
        around = Around.on_rows(obstacles, flange.pieces.path, flange.pieces.row_first[piece])
        if around is None or flange.guide is None or flange.guide.outside is None:
            return around
        values = flange.guide.externals(piece, s, flange.pieces.points(piece, s)[0])
        return replace(around, assembly=flange.guide.outside.assembly, values=values)

    def taken(self, poses: slice) -> Around:
        """Those at some of the poses."""
        return replace(self, tools=self.tools[poses], values=None if self.values is None else self.values[poses])

    def shifted(self, shift: Array) -> Around:
        """The same with the work, and what goes along with it, moved by (3,) [m] in the base."""
        return replace(self, obstacles=self.obstacles.shifted(shift))

    def hit(self, q: Array, pose: Numbers) -> NDArray[np.bool_]:
        """Whether joints q (m, j) of the arm hit anything, each at a `pose` (m,)."""
        return self.obstacles.hit(self._all_joints(q, pose), self.tools[pose])

    def pair(self, q: Array, pose: int) -> tuple[str, str] | None:
        """What hits what with joints q (j,) of the arm at a pose."""
        return self.obstacles.pair(self._all_joints(q[None], np.array([pose]))[0], int(self.tools[pose]))

    def _all_joints(self, q: Array, pose: Numbers) -> Array:
        if self.assembly is None or self.values is None:
            return q
        return self.assembly.together(q, self.values[pose])

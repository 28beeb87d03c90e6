"""`ToolPath` with columns of points, as PyBullet Industrial has it; `moves` makes the other kind of path of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.frames import Array
from gcodesim.motion import ToolPath as Moves
from gcodesim.pybullet_industrial.turns import matrix_of, quaternion_of


class ToolPath:
    """n poses: `positions` (3, n) [m], `orientations` (4, n) quaternions x y z w, `tool_activations` (n,).

    Without orientations all are [0, 0, 0, 1], without activations the tool is off. The arrays are kept as they are
    given, not copied; lists become arrays where that is needed. ValueError when they have different lengths. Iterating
    gives position, orientation, activation.
    """

    def __init__(
        self, positions: Array, orientations: Array | None = None, tool_acivations: ArrayLike | None = None
    ) -> None:
        count = len(positions[0])
        if orientations is None:
            orientations = np.zeros((4, count))
            orientations[3] = 1.0
        elif len(orientations[0]) != count:
            raise ValueError(f"{len(orientations[0])} orientations do not fit {count} positions")
        activations: Any = np.zeros(count) if tool_acivations is None else tool_acivations
        if len(activations) != count:
            raise ValueError(f"{len(activations)} tool activations do not fit {count} positions")
        self.positions, self.orientations, self.tool_activations = positions, orientations, activations

    def translate(self, vector: Sequence[float] | Array) -> None:
        """Shift this path itself by `vector` (3,) [m]."""
        for row in range(3):
            self.positions[row] += vector[row]

    def get_start_pose(self) -> tuple[Array, Array]:
        """Position (3,) and orientation (4,) of the first point."""
        return self.positions[:, 0], self.orientations[:, 0]

    def rotate(self, quaternion: ArrayLike) -> None:
        """Turn this path itself: positions about the origin, each orientation about its own axes."""
        R = matrix_of(quaternion)
        self.positions, self.orientations = np.asarray(self.positions), np.asarray(self.orientations)
        self.positions[:] = applied(R, np.ascontiguousarray(self.positions.T, dtype=float)).T
        turned = [quaternion_of(multiplied(matrix_of(own), R)) for own in self.orientations.T]
        self.orientations[:] = np.array(turned).reshape(-1, 4).T

    def draw(self, pose: bool = False, color: Sequence[float] = (0, 0, 1)) -> None:
        """Draw the path in the window of the client: a line in `color`, or with `pose` a small frame at every point."""
        from gcodesim.pybullet_industrial.utility import draw_coordinate_system, draw_path

        if not pose:
            draw_path(self.positions, color)
            return
        for position, orientation in zip(np.transpose(self.positions), np.transpose(self.orientations), strict=True):
            draw_coordinate_system(position, orientation)

    def append(self, tool_path: ToolPath) -> None:
        """Put another path after this one."""
        self._join(self, tool_path)

    def prepend(self, tool_path: ToolPath) -> None:
        """Put another path before this one."""
        self._join(tool_path, self)

    def moves(self, feed: float = np.inf) -> Moves:
        """The same path as a `gcodesim.ToolPath` [m], run with `feed` [m/s]; inf: as rapids.

        A move is on if the pose at its end is. Orientations count only if one of them is not [0, 0, 0, 1].
        """
        upright = np.allclose(self.orientations, np.array([[0.0], [0.0], [0.0], [1.0]]), atol=1e-12)
        on = np.asarray(self.tool_activations, dtype=bool)[1:]
        return Moves.from_points(self.positions.T, None if upright else self.orientations.T, on, feed)

    @staticmethod
    def of_moves(path: Moves) -> ToolPath:
        """The points of a `gcodesim.ToolPath`: its start and the end of every move."""
        poses = list(path)
        positions, orientations = (np.array([pose[k] for pose in poses], dtype=float).T for k in (0, 1))
        return ToolPath(positions, orientations, np.array([float(on) for _, _, on in poses]))

    def _join(self, first: ToolPath, second: ToolPath) -> None:
        both = (first, second)
        self.positions, self.orientations, self.tool_activations = (
            np.concatenate([path.positions for path in both], axis=1),
            np.concatenate([path.orientations for path in both], axis=1),
            np.concatenate([path.tool_activations for path in both]),
        )

    def __len__(self) -> int:
        return len(self.positions[0])

    def __iter__(self) -> ToolPath:
        self.current_index = 0
        return self

    def __next__(self) -> tuple[Array, Array, Any]:
        at = self.current_index
        if at >= len(self):
            raise StopIteration
        self.current_index = at + 1
        return self.positions[:, at], self.orientations[:, at], self.tool_activations[at]

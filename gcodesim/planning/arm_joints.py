"""Joints of an arm along a trajectory, with its external axes if it has any."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.path_kernels import JUMP
from gcodesim.motion.trajectory import Samples
from gcodesim.planning.flange import Flange
from gcodesim.planning.joint_moves import JointMove
from gcodesim.planning.nodes import Nodes
from gcodesim.planning.plan import JointExtremes

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics
    from gcodesim.planning.grips import Grips


@frozen(slots=False, kw_only=False, eq=False)
class ArmJoints:
    """Joints along a trajectory: exact inverse kinematics from the nearest node, straight lines in joint moves.

    Where the path is out of reach (`bridged`, by the node that ends the segment) joints run straight between nodes.
    """

    kinematics: Kinematics
    flange: Flange
    nodes: Nodes
    q_nodes: Array
    bridged: NDArray[np.bool_]
    home: Array
    moves: dict[int, JointMove]  # of pieces in joint space
    grips: Grips | None = None  # as they are at the end

    def joints(self, samples: Samples) -> Array:
        """Joint values (n, j) [rad, m] at samples in order of time."""
        q = np.tile(self.home, (len(samples), 1))
        pieces = self.flange.pieces
        if not len(pieces) or not len(samples):
            return q
        own = pieces.fixed[samples.piece]
        after = self.nodes.at_or_after(self._keys, samples.piece, samples.s, pieces.length)
        bridge = ~own & self.bridged[after]
        # runs of samples on one joint move, on one bridge, or of exact joints between them
        run = np.where(own, 3 * samples.piece, 3 * np.cumsum(pieces.fixed)[samples.piece] + 1 + bridge)
        starts = np.flatnonzero(np.append(True, (run[1:] != run[:-1]) | self._far(after)))
        for a, b in zip(starts, np.append(starts[1:], len(run)), strict=True):
            if own[a]:
                q[a:b] = self.moves[int(samples.piece[a])].at(samples.s[a:b])
            elif bridge[a]:
                q[a:b] = self._on_bridge(after[a:b], samples.piece[a:b], samples.s[a:b])
            else:
                seed = int(after[a]) - (not self.nodes.head[after[a]])
                q[a:b] = self._exact(samples.piece[a:b], samples.s[a:b], samples.position[a:b], self.q_nodes[seed])
        return q

    def _far(self, node: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Whether joints at the nodes (k,) of samples in a row are too far apart (k - 1,) to follow from each other.

        Of places that leave much of the path out, the inverse kinematics would take a turn or a branch that is nearer.
        """
        skips = np.flatnonzero(np.diff(node) > 1)
        far = np.zeros(max(len(node) - 1, 0), dtype=bool)
        far[skips] = np.abs(self.q_nodes[node[skips + 1]] - self.q_nodes[node[skips]]).max(axis=1) > JUMP
        return far

    def _exact(self, piece: NDArray[np.int64], s: Array, position: Array, seed: Array) -> Array:
        """Joints (k, j) that go on from those of the node before, also where that is beyond a limit."""
        X, guide = self.flange.poses(piece, s, position), self.flange.guide
        if guide is None or guide.outside is None:
            return self.kinematics.inverse(X, seed, on_path=True)[0]
        assembly = guide.outside.assembly
        values = guide.outside.values(piece, s, position)
        return assembly.together(assembly.arm.inverse(X, seed[assembly.own], on_path=True)[0], values)

    @cached_property
    def _keys(self) -> Array:
        return self.nodes.keys(self.flange.pieces.length)

    def _on_bridge(self, node: NDArray[np.intp], piece: NDArray[np.int64], s: Array) -> Array:
        nodes = self.nodes
        begin = np.where(nodes.piece[node] == nodes.piece[node - 1], nodes.s[node - 1], 0.0)
        share = np.clip((s - begin) / np.maximum(nodes.s[node] - begin, 1e-300), 0.0, 1.0)[:, None]
        q: Array = self.q_nodes[node - 1] + share * (self.q_nodes[node] - self.q_nodes[node - 1])
        return q

    def extremes(self) -> JointExtremes:
        """How far each joint goes at the nodes and at the ends of joint moves."""
        q, piece = [self.home[None], self.q_nodes], [np.zeros(1, dtype=np.int64), self.nodes.piece]
        for number, move in self.moves.items():
            q.append(move.end[None])
            piece.append(np.array([number]))
        table = np.concatenate(q)
        rows = self.flange.pieces.row_first
        row = rows[np.concatenate(piece)].astype(np.int64) if len(rows) else np.zeros(len(table), dtype=np.int64)
        low, high = table.argmin(axis=0), table.argmax(axis=0)
        return JointExtremes(table.min(axis=0), table.max(axis=0), row[low], row[high])

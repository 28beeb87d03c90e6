"""What all machine families share: forward kinematics, link poses and Jacobians of any tree."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import inverse_pose, multiplied
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain, Indices, Joints, LinkShape
from gcodesim.kinematics.tree_kernels import jacobians_along, poses_along


def rows(q: Array) -> Array:
    """Joint values (n, j) in the form for kernels; for a read-only array they would be compiled once more."""
    return np.require(np.atleast_2d(q), np.float64, ["C", "W"])


def poses(X: Array) -> Array:
    """Poses (n, 4, 4) in the form for kernels."""
    return np.require(np.reshape(X, (-1, 4, 4)), np.float64, ["C", "W"])


@frozen(slots=False, eq=False)
class Machine:
    """A tree of joints; families add the way back from pose to joints."""

    chain: Chain

    @property
    def joints(self) -> Joints:
        return self.chain.driven_joints

    @property
    def link_names(self) -> tuple[str, ...]:
        return self.chain.link_names

    @cached_property
    def link_shapes(self) -> tuple[LinkShape, ...]:
        return self.chain.shapes()

    def _poses(self, q: Array, carrier: Indices, offset: Array) -> Array:
        q, tree = rows(q), self.chain.tree
        out = np.empty((len(q), len(carrier), 4, 4))
        frames = np.empty((q.shape[1], 4, 4))
        poses_along(q, tree, carrier, offset, frames, out)
        return out

    def links(self, q: Array) -> Array:
        """Poses of all links, (n, L, 4, 4), in B."""
        return self._poses(q, self.chain.tree.carrier, self.chain.tree.offset)

    def link(self, q: Array, index: int) -> Array:
        """X_BL (n, 4, 4) of the link at `index` of `link_names`."""
        tree = self.chain.tree
        poses_: Array = self._poses(
            q, tree.carrier[index : index + 1], np.ascontiguousarray(tree.offset[index : index + 1])
        )
        return poses_[:, 0]

    def table(self, q: Array) -> Array:
        """X_BC (n, 4, 4): the table frame C, which coincides with B while the table's axes stand at zero."""
        q = rows(q)
        if self.chain.table is None:
            return np.tile(np.eye(4), (len(q), 1, 1))
        index = self.link_names.index(self.chain.table)
        return multiplied(self.link(q, index), inverse_pose(self.link(np.zeros((1, q.shape[1])), index)))

    def table_travel(self, q: Array) -> Array:
        """How far (n, 3) [m] in B the table's linear axes have carried it; turns of the table left out.

        A work system moves with that, but not with the turns, because a control adds
        its offsets to the positions of the axes.
        """
        q = rows(q)
        index = self.link_names.index(self.chain.table) if self.chain.table is not None else 0
        on_table = {int(j) for j in np.flatnonzero(self.chain.tree.prismatic)} - {
            int(j) for j in np.flatnonzero(self.chain.tree.path)
        }
        if self.chain.table is None or not on_table:
            return np.zeros((len(q), 3))
        still = np.zeros_like(q)
        for joint in sorted(on_table):
            still[:, joint] = q[:, joint]
        travel: Array = self.link(still, index)[:, :3, 3] - self.link(np.zeros((1, q.shape[1])), index)[:, :3, 3]
        return travel

    def forward(self, q: Array) -> Array:
        """X_BF (n, 4, 4) of joints (n, j)."""
        tree = self.chain.tree
        poses = self._poses(q, np.array([tree.flange_carrier]), tree.flange_offset[None])
        flange: Array = poses[:, 0]
        return flange

    def branches(self, X_BF: Array) -> Array:
        """All joint vectors (b, j) of one pose (4, 4): the family's own way."""
        raise NotImplementedError

    def branches_along(self, X_BF: Array) -> tuple[Array, NDArray[np.bool_]]:
        """All joint vectors (n, b, j) of poses (n, 4, 4), limits not asked, and which of them exist (n, b)."""
        found = [self.branches(X) for X in poses(X_BF)]
        most = max(map(len, found), default=0)
        out = np.zeros((len(found), most, len(self.joints)))
        exists = np.zeros((len(found), most), dtype=bool)
        for k, q in enumerate(found):
            out[k, : len(q)], exists[k, : len(q)] = q, True
        return out, exists

    def jacobian(self, q: Array) -> Array:
        """Jacobian (n, 6, j) at the flange, base axes, velocity then angular velocity."""
        q, tree = rows(q), self.chain.tree
        count = q.shape[1]
        out = np.empty((len(q), 6, count))
        frames, flange = np.empty((count, 4, 4)), np.empty((4, 4))
        jacobians_along(q, tree, frames, flange, out)
        return out

"""What all machine families share: forward kinematics, link poses and Jacobians of any tree."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gcodesim.frames import Array
from gcodesim.kinematics.chain import Chain, Indices, Joints, LinkShape
from gcodesim.kinematics.tree_kernels import jacobians_along, poses_along


def rows(q: Array) -> Array:
    """Joint values (n, j) as the kernels want them; a read-only array would be compiled for once more."""
    return np.require(np.atleast_2d(q), np.float64, ["C", "W"])


def poses(X: Array) -> Array:
    """Poses (n, 4, 4) as the kernels want them."""
    return np.require(np.reshape(X, (-1, 4, 4)), np.float64, ["C", "W"])


@dataclass(frozen=True, kw_only=True, eq=False)
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
        poses_along(q, tree.parent, tree.before, tree.axis, tree.prismatic, carrier, offset, frames, out)
        return out

    def links(self, q: Array) -> Array:
        """Poses of all links, (n, L, 4, 4), in B."""
        return self._poses(q, self.chain.tree.carrier, self.chain.tree.offset)

    def forward(self, q: Array) -> Array:
        """X_BF (n, 4, 4) of joints (n, j)."""
        tree = self.chain.tree
        poses = self._poses(q, np.array([tree.flange_carrier]), np.ascontiguousarray(tree.flange_offset[None]))
        flange: Array = poses[:, 0]
        return flange

    def jacobian(self, q: Array) -> Array:
        """Jacobian (n, 6, j) at the flange, base axes, velocity then angular velocity."""
        q, tree = rows(q), self.chain.tree
        count = q.shape[1]
        out = np.empty((len(q), 6, count))
        room = np.empty((count, 4, 4)), np.empty((4, 4))
        jacobians_along(
            q,
            tree.parent,
            tree.before,
            tree.axis,
            tree.prismatic,
            tree.path,
            tree.flange_carrier,
            tree.flange_offset,
            *room,
            out,
        )
        return out

"""What every machine family offers, and how it reports a pose that is out of reach."""

from __future__ import annotations

from enum import IntEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain, Joints, LinkShape

Statuses = NDArray[np.uint8]


class Status(IntEnum):
    """The outcome for one pose of a path.

    OK: joints found. REACH: no joint vector has this pose; the row repeats the
    joints before. LIMIT: the row holds the solution that goes on from the row
    before, and it breaks a joint limit. SINGULAR: joints found, but here some
    joint speeds are unbounded. FLIP: joints found within limits, but only by a
    jump from the row before (on another branch), because there is no smooth way.
    The first row of a path takes the nearest solution within limits, however far.
    """

    OK = 0
    REACH = 1
    LIMIT = 2
    SINGULAR = 3
    FLIP = 4


@frozen
class Reason:
    """Why a pose has its status: `what` in words, `value` against `limit` in `unit`, the joint at fault or None.

    `what` is None where a pose is out of reach and no single number says why.
    """

    status: Status
    what: str | None
    value: float
    limit: float
    unit: str
    joint: int | None = None


class Kinematics(Protocol):
    """A machine: joints to poses and back. One row per step; q (n, j) [rad] or [m], poses (n, 4, 4) in B (or M)."""

    @property
    def chain(self) -> Chain: ...

    @property
    def joints(self) -> Joints: ...

    @property
    def link_names(self) -> tuple[str, ...]: ...

    @property
    def link_shapes(self) -> tuple[LinkShape, ...]: ...

    def links(self, q: Array) -> Array:
        """Poses of all links, (n, L, 4, 4), in the order of `link_names`."""
        ...

    def link(self, q: Array, index: int) -> Array:
        """Pose (n, 4, 4) of the link at `index` of `link_names`."""
        ...

    def forward(self, q: Array) -> Array:
        """X_BF (n, 4, 4)."""
        ...

    def table(self, q: Array) -> Array:
        """X_BC (n, 4, 4) of what carries the work, which coincides with B while its joints stand at zero."""
        ...

    def table_travel(self, q: Array) -> Array:
        """How far (n, 3) [m] linear joints have carried the work, turns left out; zeros where none does."""
        ...

    def jacobian(self, q: Array) -> Array:
        """Jacobian (n, 6, j) at the flange in base axes: velocity [m/s], then angular velocity [rad/s]."""
        ...

    def inverse(self, X_BF: Array, seed: Array, *, on_path: bool = False) -> tuple[Array, Statuses]:
        """Joints (n, j) and `Status` (n,) along a path, continuous from `seed` (j,) on.

        `on_path` says that `seed` is the row before on the same path, so that a
        path may come in pieces; else a path begins here.
        """
        ...

    def branches(self, X_BF: Array) -> Array:
        """All joint vectors (b, j) of one pose (4, 4), in branch order, limits not asked."""
        ...

    def branches_along(self, X_BF: Array) -> tuple[Array, NDArray[np.bool_]]:
        """All joint vectors (n, b, j) of poses (n, 4, 4), limits not asked, and which of them exist (n, b)."""
        ...

    def reason(self, X_BF: Array, previous: Array, status: int) -> Reason:
        """The facts behind the `status` that `inverse` gave the pose (4, 4), coming from joints `previous` (j,)."""
        ...

"""An arm with external axes: carriages that carry it, and positioners that carry the work, as one tree of joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import inverse_pose, multiplied
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain, Joint, Link
from gcodesim.kinematics.driven_axis import joint_of, link_of
from gcodesim.kinematics.machine import Machine, poses, rows
from gcodesim.kinematics.protocol import Reason, Statuses

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics


@frozen
class ExternalAxis:
    """One external axis; `vector` and `point` [m] are in the frame E of what it belongs to. Limits as in `Joint`."""

    name: str
    kind: Literal["revolute", "prismatic"]
    vector: tuple[float, float, float]
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    lower: float = -np.inf
    upper: float = np.inf
    speed: float = np.inf
    acceleration: float | None = None
    jerk: float | None = None
    effort: float = np.inf
    moving_mass: float | None = None


@frozen(eq=False)
class Carrier:
    """External axes in chain order, with their frame E at `X_BE`. It `carries_arm`, or else the work.

    What it carries is the link `name`, which lies on E while all its axes stand at zero.
    """

    name: str
    axes: tuple[ExternalAxis, ...]
    X_BE: Pose
    carries_arm: bool = False


def assembled(arm: Chain, carriers: Sequence[Carrier]) -> Chain:
    """The chain of `arm` with `carriers`; the first one that carries the arm stands on the ground.

    B is the base of the arm while what carries it stands at zero. Joints come in the order: those that carry the arm,
    the arm's, those of positioners. ValueError: two links have one name.
    """
    links: list[Link] = []
    joints: list[Joint] = []
    driven: list[int] = []

    def add(carrier: Carrier, parent: str) -> str:
        """The joints of a carrier on the link `parent`, whose frame is B with all at zero; the link that it moves."""
        at = carrier.X_BE
        for number, axis in enumerate(carrier.axes, start=1):
            child = f"{carrier.name}_{number}"
            vector = np.array(axis.vector, dtype=float)
            X = at @ Pose(np.array(axis.point, dtype=float), np.eye(3))
            driven.append(len(joints))
            joints.append(joint_of(axis, axis.name, axis.kind, (parent, child), X.matrix, vector))
            links.append(link_of(axis, child))
            parent, at = child, Pose(-np.array(axis.point, dtype=float), np.eye(3))
        return fix(carrier.name, parent, at)

    def fix(name: str, parent: str, X: Pose) -> str:
        links.append(Link(name=name))
        joints.append(Joint(name=name, kind="fixed", parent=parent, child=name, X=X.matrix))
        return name

    root = arm.links[0].name
    moved = [carrier for carrier in carriers if carrier.carries_arm]
    ground = f"{moved[0].name}_base" if moved else root
    if moved:
        links.append(Link(name=ground))
        below = ground
        for carrier in moved:
            below = add(carrier, below)
            below = fix(f"{carrier.name}_top", below, carrier.X_BE.inverse())
        joints.append(Joint(name=f"{root} stands", kind="fixed", parent=below, child=root, X=np.eye(4)))
    first = len(joints)
    links += arm.links
    joints += arm.joints
    driven += [first + index for index in arm.driven]
    platforms = [add(carrier, ground) for carrier in carriers if not carrier.carries_arm]
    names = [link.name for link in links]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(twice)
    return replace(
        arm,
        links=tuple(links),
        joints=tuple(joints),
        driven=tuple(driven),
        table=platforms[0] if len(platforms) == 1 else None,
    )


@frozen(slots=False, eq=False)
class Assembly(Machine):
    """An arm with external axes; q has all joints, in the order of `assembled`.

    `arm` is the arm alone, `own` and `externals` say where its joints and the external ones are in q; `platforms` are
    the links that carry work.
    """

    arm: Kinematics
    own: NDArray[np.intp]
    externals: NDArray[np.intp]
    platforms: tuple[str, ...]

    @staticmethod
    def of(arm: Kinematics, carriers: Sequence[Carrier]) -> Assembly:
        chain = assembled(arm.chain, carriers)
        before = sum(len(carrier.axes) for carrier in carriers if carrier.carries_arm)
        count, all_of_them = len(arm.joints), len(chain.driven)
        own = np.arange(before, before + count)
        return Assembly(
            chain=chain,
            arm=arm,
            own=own,
            externals=np.setdiff1d(np.arange(all_of_them), own),
            platforms=tuple(carrier.name for carrier in carriers if not carrier.carries_arm),
        )

    def together(self, q_arm: Array, values: Array) -> Array:
        """q (n, j) of joints of the arm (n, 6) and values (n, e) of the external axes."""
        q = np.empty((len(q_arm), len(self.joints)))
        q[:, self.own], q[:, self.externals] = q_arm, values
        return q

    def base(self, values: Array) -> Array:
        """X_BA (n, 4, 4): where the base A of the arm is with the external axes at `values` (n, e)."""
        return self.link(self._outside(values), self.link_names.index(self.arm.link_names[0]))

    def platform(self, index: int, values: Array) -> Array:
        """X_BC (n, 4, 4) of a platform, which lies on B while its axes stand at zero."""
        link = self.link_names.index(self.platforms[index])
        X: Array = multiplied(
            self.link(self._outside(values), link),
            inverse_pose(self.link(np.zeros((1, len(self.joints))), link)),
        )
        return X

    def _outside(self, values: Array) -> Array:
        q = np.zeros((len(values), len(self.joints)))
        q[:, self.externals] = values
        return q

    def _from_arm(self, X_BF: Array, values: Array) -> Array:
        X: Array = multiplied(inverse_pose(self.base(values)), poses(X_BF))
        return X

    def inverse(self, X_BF: Array, seed: Array, *, on_path: bool = False) -> tuple[Array, Statuses]:
        """Joints (n, j) and status (n,); external axes stay where they are in `seed` (j,)."""
        seed = rows(seed)
        values = seed[:, self.externals]
        q, status = self.arm.inverse(self._from_arm(X_BF, values), seed[0, self.own], on_path=on_path)
        return self.together(q, values), status

    def branches(self, X_BF: Array) -> Array:
        """The joint vectors (b, j) of one pose (4, 4) with the external axes at zero."""
        values = np.zeros((1, len(self.externals)))
        return self.together(self.arm.branches(self._from_arm(X_BF, values)[0]), values)

    def branches_along(self, X_BF: Array) -> tuple[Array, NDArray[np.bool_]]:
        """All joint vectors (n, b, j) of poses (n, 4, 4) with the external axes at zero, and which exist (n, b)."""
        X = self._from_arm(X_BF, np.zeros((1, len(self.externals))))
        found, exists = self.arm.branches_along(X)
        q = np.zeros((*found.shape[:2], len(self.joints)))
        q[:, :, self.own] = found
        return q, exists

    def reason(self, X_BF: Array, previous: Array, status: int) -> Reason:
        """What the arm says with the external axes as in `previous` (j,)."""
        before = rows(previous)
        X = self._from_arm(X_BF, before[:, self.externals])[0]
        return self.arm.reason(X, before[0, self.own], status)

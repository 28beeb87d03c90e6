"""Machine tools: linear axes X, Y, Z and rotary axes A, B, C, each on the tool's or on the work's side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Final, Literal

import numpy as np

from gcodesim.arithmetic.elementary import acos
from gcodesim.arithmetic.matrices import applied, inverse_pose, least_inverse, multiplied, norm
from gcodesim.canon import AXIS_LETTERS
from gcodesim.frames import Array, Pose, rotation_from_rpy
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain, Joint, JointKind, Link
from gcodesim.kinematics.driven_axis import joint_of, link_of
from gcodesim.kinematics.machine import Machine, poses
from gcodesim.kinematics.protocol import Reason, Status, Statuses
from gcodesim.kinematics.reasons import limit_reason
from gcodesim.kinematics.serial import SerialArm

_REACHED: Final = 1e-9  # [m], [rad] between the pose asked for and the pose of the axes found
_VECTORS: Final = dict(zip(AXIS_LETTERS, np.vstack([np.eye(3), np.eye(3)]), strict=True))


@frozen
class Axis:
    """One axis of a machine tool. Travel, speed, acceleration, jerk, effort in m, rad, s, N, N·m; `point` [m] in M.

    `vector` is the direction of positive motion of what the axis carries. Default:
    the letter's own axis of M for what carries the tool and for every rotary axis,
    the opposite for a linear axis of the table, so that +X always moves the tool
    towards +X of the work (ISO 841). A rotary axis on the table side turns the
    work right-handed about `vector`, as LinuxCNC has it; give −`vector` for a
    machine whose letter means the tool's motion as seen from the work. `point` None: its place is unknown, only time is
    known and it moves nothing. `side` default: X, Y, Z tool, A, B, C table.
    """

    letter: str
    lower: float = -np.inf
    upper: float = np.inf
    speed: float = np.inf
    acceleration: float | None = None
    jerk: float | None = None
    effort: float = np.inf
    vector: tuple[float, float, float] | None = None
    side: Literal["tool", "table"] | None = None
    point: tuple[float, float, float] | None = None
    moving_mass: float | None = None


def chain_of_axes(axes: Sequence[Axis], name: str = "machine") -> Chain:
    """The chain of a machine tool from its axes in chain order; ValueError on a letter that is unknown or used twice.

    At machine zero the spindle nose F is at the origin of M with its Z along −Z.
    """
    letters = [axis.letter for axis in axes]
    if len(set(letters)) < len(letters) or any(letter not in AXIS_LETTERS for letter in letters):
        raise ValueError(f"axes {letters}: each of X, Y, Z, A, B, C at most once")
    nose = Pose(np.zeros(3), rotation_from_rpy(np.pi, 0.0, 0.0)).matrix
    links = [Link(name="base")]
    joints: list[Joint] = []
    driven: list[int] = []
    ends: dict[str, tuple[str, Array]] = {"tool": ("base", np.zeros(3)), "table": ("base", np.zeros(3))}
    for side in ("tool", "table"):
        for axis in axes:
            rotary = axis.letter in "ABC"
            if side != (axis.side or ("table" if rotary else "tool")):
                continue
            usual = _VECTORS[axis.letter] if rotary or side == "tool" else -_VECTORS[axis.letter]
            parent, at = ends[side]
            point = np.array(axis.point if rotary and axis.point is not None else at, dtype=float)
            vector = np.array(usual if axis.vector is None else axis.vector, dtype=float)
            child = f"link_{axis.letter}"
            X = Pose(point - at, np.eye(3)).matrix
            links.append(link_of(axis, child))
            driven.append(len(joints))
            kind: JointKind = "revolute" if rotary else "prismatic"
            joints.append(joint_of(axis, axis.letter, kind, (parent, child), X, vector))
            if not (rotary and axis.point is None):  # otherwise the axis has no known place and carries nothing
                ends[side] = child, point
    for link, (parent, at), X in (("flange", ends["tool"], nose), ("table", ends["table"], np.eye(4))):
        back = Pose(-at, np.eye(3)).matrix
        links.append(Link(name=link))
        joints.append(Joint(name=link, kind="fixed", parent=parent, child=link, X=multiplied(back, X)))
    return Chain(
        name=name, links=tuple(links), joints=tuple(joints), driven=tuple(driven), flange="flange", table="table"
    )


def with_table(chain: Chain, axes: Sequence[Axis], name: str, X_ME: Pose) -> Chain:
    """`chain` with one more table on its own, or on its base: the link `name`, at `X_ME` with all axes at zero.

    `axes` turn it, in chain order from the ground on, about points and directions in M with all axes at zero.
    """
    below = chain.table or chain.links[0].name
    machine = Machine(chain=chain)
    X_pM = inverse_pose(machine.link(np.zeros((1, len(chain.driven))), machine.link_names.index(below)))[0]
    links, joints, driven = list(chain.links), list(chain.joints), list(chain.driven)
    for axis in axes:
        point = Pose(np.array(axis.point, dtype=float), np.eye(3)).matrix
        child, vector = f"link_{axis.letter}", np.array(axis.vector, dtype=float)
        links.append(link_of(axis, child))
        driven.append(len(joints))
        joints.append(joint_of(axis, axis.letter, "revolute", (below, child), multiplied(X_pM, point), vector))
        below, X_pM = child, inverse_pose(point)
    links.append(Link(name=name))
    joints.append(Joint(name=name, kind="fixed", parent=below, child=name, X=multiplied(X_pM, X_ME.matrix)))
    return replace(chain, links=tuple(links), joints=tuple(joints), driven=tuple(driven), table=name)


@frozen(slots=False, eq=False)
class Cartesian(Machine):
    """A machine tool. Its base frame is M; q is in the order of its joints, whose names are the axis letters."""

    @staticmethod
    def of(chain: Chain) -> Cartesian | None:
        """The machine tool that `chain` is, or None: its joints are named by axis letters, X, Y, Z are linear."""
        joints = chain.driven_joints
        named = all(name in AXIS_LETTERS for name in joints.names)
        linear = all(
            (kind == "prismatic") == (name in "XYZ") for name, kind in zip(joints.names, joints.kinds, strict=True)
        )
        return Cartesian(chain=chain) if named and linear else None

    @cached_property
    def _rotary_head(self) -> bool:
        tree = self.chain.tree
        return bool(np.any((tree.path == 1) & (tree.prismatic == 0)))

    def inverse(self, X_BF: Array, seed: Array, *, on_path: bool = False) -> tuple[Array, Statuses]:
        """Joints (n, j) and status (n,) of spindle nose poses (n, 4, 4) in M; table axes stay at `seed` (j,).

        Linear axes are solved directly; with rotary axes in the head the numeric
        method of any serial arm is used.
        """
        X = poses(X_BF)
        if self._rotary_head:
            return SerialArm(chain=self.chain).inverse(X, seed, on_path=on_path)
        seed = np.array(seed, dtype=np.float64)
        tree = self.chain.tree
        on = np.flatnonzero(tree.path)
        J = self.jacobian(seed)[0][:3, on]
        here = self.forward(seed)[0]
        q = np.tile(seed, (len(X), 1))
        q[:, on] += applied(least_inverse(J), X[:, :3, 3] - here[:3, 3])
        missed = np.abs(self.forward(q) - X).max(axis=(1, 2)) > _REACHED
        outside = ((q > self.joints.upper + _REACHED) | (q < self.joints.lower - _REACHED)).any(axis=1)
        status = np.where(missed, Status.REACH, np.where(outside, Status.LIMIT, Status.OK)).astype(np.uint8)
        for row in np.flatnonzero(missed):  # rare: such a path is refused anyway
            q[row] = q[row - 1] if row else seed
        return q, status

    def _beside_axes(self, way: Array) -> float:
        """How far the nose cannot go along `way` (3,), for want of an axis [m]."""
        on = np.flatnonzero(self.chain.tree.path)
        J = self.jacobian(np.zeros(len(self.joints)))[0][:3, on]
        return norm(way - applied(J, applied(least_inverse(J), way)))

    def branches(self, X_BF: Array) -> Array:
        """The joint vectors (b, j) of one pose (4, 4): one, or none when the head cannot turn so."""
        if self._rotary_head:
            return SerialArm(chain=self.chain).branches(X_BF)
        q, status = self.inverse(X_BF, np.zeros(len(self.joints)))
        reached: Array = q[status != Status.REACH]
        return reached

    def reason(self, X_BF: Array, previous: Array, status: int) -> Reason:
        """The facts behind a status: the axis over its travel, or by how much the head cannot turn."""
        if self._rotary_head:
            return SerialArm(chain=self.chain).reason(X_BF, previous, status)
        if status == Status.LIMIT:
            return limit_reason(self.joints, self.inverse(X_BF, previous)[0][0])
        X, here = poses(X_BF)[0], self.forward(previous)[0]
        cosine = 0.5 * ((here[:3, :3] * X[:3, :3]).sum() - 1.0)
        angle = acos(np.clip(cosine, -1.0, 1.0))
        away = self._beside_axes(X[:3, 3] - here[:3, 3])
        if not angle > 0.0 and away > 0.0:
            what = "distance from where its axes lead"
            return Reason(status=Status.REACH, what=what, value=away, limit=0.0, unit="m")
        return Reason(
            status=Status.REACH, what="turn of the spindle from its own direction", value=angle, limit=0.0, unit="rad"
        )

"""The tip of a tool in the work, on machine tools with rotary axes in the head, under the table, or both.

The rotary axes come first: from words, or from the direction of the tool (two branches). With them fixed the tip is
an affine function of the three linear axes, so these follow from one linear system for each point.
"""

from __future__ import annotations

from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, determinant, multiplied, norm, space_solutions
from gcodesim.canon import AXIS_LETTERS
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.cartesian import Cartesian
from gcodesim.kinematics.directions import angle_about, two_turns

_TURN: Final = 2.0 * np.pi
_SLACK: Final = 1e-9  # [rad] past the travel that is rounding


class Turn(NamedTuple):
    """A rotary joint as the tool's direction in the work sees it: which one, about which axis, in which sense."""

    joint: int
    axis: Array  # (3,) in C with all axes at zero, so that +angle turns the tool as seen from the work


@frozen(slots=False, kw_only=False, eq=False)
class ToolPoint:
    """Tip and axes of a machine tool `kinematics`.

    Points are in C, the frame of the work, which lies on the base while the axes of the table stand at zero. A tool's
    length offset (3,) [m] is what a control adds to the tip to give axes, as X, Y, Z of a spindle at zero.
    """

    kinematics: Cartesian

    @staticmethod
    def of(kinematics: object) -> ToolPoint | None:
        """None where three linear axes or a rotary axis are missing, or the linear ones do not span space."""
        if not isinstance(kinematics, Cartesian):
            return None
        found = ToolPoint(kinematics)
        if len(found.linear) != 3 or not len(found.rotary):
            return None
        directions = found._affine(np.zeros((1, len(kinematics.joints))), np.zeros((1, 3)))[1][0]
        return found if abs(determinant(directions)) > 1e-6 else None

    @cached_property
    def linear(self) -> NDArray[np.intp]:
        """Which joints are X, Y, Z, in this order."""
        names = self.kinematics.joints.names
        return np.array([names.index(letter) for letter in "XYZ" if letter in names], dtype=np.intp)

    @cached_property
    def rotary(self) -> NDArray[np.intp]:
        """Which joints are rotary and have a place."""
        chain = self.kinematics.chain
        carrying = {joint.parent for joint in chain.joints} | {chain.table, chain.flange}
        joints = [chain.joints[index] for index in chain.driven]
        return np.array(
            [i for i, joint in enumerate(joints) if joint.kind == "revolute" and joint.child in carrying],
            dtype=np.intp,
        )

    @cached_property
    def letters(self) -> tuple[str, ...]:
        """The letters of its rotary axes."""
        return tuple(self.kinematics.joints.names[joint] for joint in self.rotary)

    @cached_property
    def columns(self) -> NDArray[np.intp]:
        """Which of x y z a b c each joint is."""
        return np.array([AXIS_LETTERS.index(name) for name in self.kinematics.joints.names], dtype=np.intp)

    # -- tip and axes

    def tips(self, q: Array, offset: Array) -> Array:
        """The tip (n, 3) in C with joints at `q` (n, j) and length offsets `offset` (n, 3)."""
        X_BF, X_BC = self.kinematics.forward(q), self.kinematics.table(q)
        arm = applied(self._nose, offset)  # in F: R_FB at zero times minus the offset
        p_B = X_BF[:, :3, 3] + applied(X_BF[:, :3, :3], arm)
        tips: Array = applied(X_BC[:, :3, :3].swapaxes(1, 2), p_B - X_BC[:, :3, 3])
        return tips

    @cached_property
    def _nose(self) -> Array:
        zero = np.zeros((1, len(self.kinematics.joints)))
        nose: Array = -self.kinematics.forward(zero)[0, :3, :3].T
        return nose

    def _affine(self, q: Array, offset: Array) -> tuple[Array, Array]:
        """The tip (n, 3) with the linear axes at zero, and its change (n, 3, 3) per metre of each of them."""
        still = q.copy()
        still[:, self.linear] = 0.0
        zero = self.tips(still, offset)
        directions = np.empty((len(q), 3, 3))
        for column, joint in enumerate(self.linear):
            still[:, joint] = 1.0
            directions[:, :, column] = self.tips(still, offset) - zero
            still[:, joint] = 0.0
        return zero, directions

    def joints(self, points: Array, offset: Array) -> Array:
        """Joints (n, j) with the tip at `points` (n, 6): x, y, z in C and the rotary axes as they stand."""
        q = np.ascontiguousarray(points[:, self.columns])
        zero, directions = self._affine(q, offset)
        q[:, self.linear] = space_solutions(directions, points[:, :3] - zero)
        return q

    def points(self, q: Array, offset: Array) -> Array:
        """The inverse of `joints`: x, y, z of the tip in C and rotary axes (n, 6)."""
        out = np.zeros((len(q), 6))
        out[:, self.columns] = q
        out[:, :3] = self.tips(q, offset)
        return out

    # -- attitude

    @cached_property
    def turns(self) -> tuple[Turn, ...]:
        """The rotary joints from the work to the tool: R_CF = exp(a1 q1) exp(a2 q2) … at zero."""
        tree, names = self.kinematics.chain.tree, self.kinematics.joints.names
        zero = np.zeros((1, len(names)))
        table: list[Turn] = []
        head: list[Turn] = []
        for joint in self.rotary:
            q = zero.copy()
            q[0, joint] = 0.5 * np.pi
            on_tool = bool(tree.path[joint])
            moved = (self.kinematics.forward if on_tool else self.kinematics.table)(q)[0, :3, :3]
            still = (self.kinematics.forward if on_tool else self.kinematics.table)(zero)[0, :3, :3]
            R = multiplied(moved, still.T)
            axis = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
            (head if on_tool else table).append(Turn(int(joint), axis if on_tool else -axis))
        return (*reversed(table), *head)

    @cached_property
    def upright(self) -> Array:
        """The direction (3,) from the tip to the holder with all axes at zero, in C."""
        zero = np.zeros((1, len(self.kinematics.joints)))
        direction: Array = -self.kinematics.forward(zero)[0, :3, 2]
        return direction

    def directions(self, q: Array) -> Array:
        """The direction (n, 3) from the tip to the holder, in C."""
        X_BF, X_BC = self.kinematics.forward(q), self.kinematics.table(q)
        directions: Array = -applied(X_BC[:, :3, :3].swapaxes(1, 2), X_BF[:, :3, 2])
        return directions

    def attitudes(self, direction: Array, seed: Array) -> list[Array]:
        """Joints (j,) that bring the tool into `direction` (3,) in C; at most two, none where it cannot turn so.

        Linear axes stay as in `seed` (j,), and so does an axis that the direction leaves free (the pole).
        """
        w = np.asarray(direction, dtype=float)
        w = w / norm(w)
        if len(self.turns) == 1:
            turn = self.turns[0]
            angle = angle_about(turn.axis, self.upright, w, float(seed[turn.joint]))
            return [] if angle is None else [self._with(seed, {turn.joint: angle})]
        if len(self.turns) != 2:
            return []
        first, second = self.turns
        free = (float(seed[first.joint]), float(seed[second.joint]))
        return [
            self._with(seed, {second.joint: inner, first.joint: outer})
            for outer, inner in two_turns(first.axis, second.axis, self.upright, w, free)
        ]

    def within_travel(self, q: Array, near: Array) -> Array | None:
        """`q` (j,) with its rotary axes whole turns on, inside the travel and as near to `near` (j,) as can be."""
        out, joints = q.copy(), self.kinematics.joints
        for joint in self.rotary:
            low, high = joints.lower[joint] - _SLACK, joints.upper[joint] + _SLACK
            turns = np.round((near[joint] - q[joint]) / _TURN) + np.arange(-1.0, 2.0)
            if np.isfinite(low):
                turns = np.append(turns, np.ceil((low - q[joint]) / _TURN))
            if np.isfinite(high):
                turns = np.append(turns, np.floor((high - q[joint]) / _TURN))
            values = q[joint] + _TURN * turns
            values = values[(values >= low) & (values <= high)]
            if not len(values):
                return None
            out[joint] = values[np.argmin(np.abs(values - near[joint]))]
        return out

    def beyond_travel(self, q: Array) -> tuple[int, float, float]:
        """Which rotary joint of `q` (j,) is farthest beyond its travel, whole turns on or back; its value and its limit
        [rad]. One that is within its travel is beyond it by less than nothing.
        """
        joints, worst = self.kinematics.joints, (-np.inf, -1, 0.0, 0.0)
        for joint in self.rotary:
            low, high = float(joints.lower[joint]), float(joints.upper[joint])
            middle = 0.5 * (low + high) if np.isfinite(low + high) else float(q[joint])
            value = float(q[joint] + _TURN * np.round((middle - q[joint]) / _TURN))
            limit = high if value - high >= low - value else low
            beyond = abs(value - limit) if value > high or value < low else -min(high - value, value - low)
            worst = max(worst, (beyond, int(joint), value, limit))
        return worst[1:]

    def _with(self, seed: Array, angles: dict[int, float]) -> Array:
        q = np.array(seed, dtype=float)
        for joint, angle in angles.items():
            q[joint] = angle
        return q

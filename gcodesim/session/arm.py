"""A robot, or a machine tool, of an open cell: sent to joints and poses, and along paths."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from gcodesim.arithmetic.matrices import multiplied, norms
from gcodesim.controllers import Controller
from gcodesim.frames import Array, Pose, quaternion_from_rotation, rotation_from_quaternion
from gcodesim.frozen import frozen
from gcodesim.given import number, numbers, quaternions
from gcodesim.motion.tool_path import ToolPath
from gcodesim.planning.joint_spline import TipPace
from gcodesim.session.misuse import MisuseError, as_misuse
from gcodesim.session.pose_path import between
from gcodesim.session.posture import joints_along, joints_at
from gcodesim.shop import controller_of

if TYPE_CHECKING:
    from gcodesim.session.cell_in_hand import OpenCell
    from gcodesim.session.machine import MovedMachine
    from gcodesim.session.tool_in_hand import HandTool


@frozen(eq=False)
class JointState:
    """A robot after the last step, in the order of its joints: positions, velocities and efforts of motors (j,), SI.

    `reaction` (6,): force [N] and torque [N·m] of the flange on the tool, at the flange, in axes of the base.
    """

    names: tuple[str, ...]
    position: Array
    velocity: Array
    effort: Array
    reaction: Array


Joints = str | Mapping[str, float] | ArrayLike
"""What a script gives for joints: all of them (j,), some by name, or the name of a pose of the cell."""


class Arm:
    """A robot, or a machine tool, of an open cell. Joint values in rad and m, in the order of `joint_names`."""

    def __init__(self, cell: OpenCell, machine: MovedMachine) -> None:
        self._cell, self._machine = cell, machine

    @property
    def name(self) -> str:
        return self._machine.shop.name

    @property
    def joint_names(self) -> tuple[str, ...]:
        return self._machine.shop.kinematics.joints.names

    @property
    def joint_state(self) -> JointState:
        """The state after the last step; zeros, at home, before the first."""
        last, q = self._cell._last_of(self._machine), self._machine.q
        if last is None:
            zero = np.zeros(len(q))
            return JointState(
                names=self.joint_names, position=q.copy(), velocity=zero, effort=zero, reaction=np.zeros(6)
            )
        return JointState(
            names=self.joint_names,
            position=last.q[-1].copy(),
            velocity=last.qd[-1].copy(),
            effort=last.effort[-1].copy(),
            reaction=last.reaction[-1].copy(),
        )

    @property
    def controller(self) -> Controller:
        """How its motors follow what they are told; may be set until the first step (see `gcodesim.controllers`)."""
        from gcodesim.world import usual_controller

        mover = self._machine.shop.mover
        return mover.controller or usual_controller(self._machine.job.world, mover.stiffness)

    @controller.setter
    def controller(self, controller: Controller) -> None:
        """MisuseError once a step has run, and for machine tools, which have no model of their motors."""
        shop = self._machine.shop
        self._cell._check_open()
        if self._machine.has_begun:
            raise MisuseError("a controller is set before the first step")
        if shop.mover.joints_are_axes:
            raise MisuseError(f"`{self.name}` is a machine tool; controllers are for robots")
        if not isinstance(controller, Controller):
            raise MisuseError(f"a controller is one of `gcodesim.controllers`; {type(controller).__name__} is given")
        count = len(self.joint_names)
        for name, values in controller.lists().items():
            if len(values) not in (0, 1, count):
                raise MisuseError(f"`{name}` has {len(values)} entries; `{self.name}` has {count} joints")
        mover = replace(shop.mover, controller=controller_of(controller, shop.kinematics))
        scene = replace(shop.scene, movers={**shop.scene.movers, mover.name: mover})
        self._machine.job.shop = replace(shop, mover=mover, scene=scene)

    @property
    def tool(self) -> HandTool | None:
        """The tool that it holds."""
        number = self._machine.state.tool
        return self._cell.tool(number) if number else None

    @property
    def endeffector_pose(self) -> tuple[Array, Array]:
        """Position (3,) [m] and orientation x y z w in the world of the tip of the tool, or of the flange."""
        last, shop = self._cell._last_of(self._machine), self._machine.shop
        q = self._machine.q if last is None else last.q[-1]
        X_BF = Pose.from_matrix(shop.kinematics.forward(q[None])[0])
        X_WT = shop.X_WB @ X_BF @ self._X_FT()
        return X_WT.p, quaternion_from_rotation(X_WT.R)

    def set_joint_position(self, q: Joints) -> None:
        """Where the joints are to go with the next steps: all (j,), some by name, or the name of a pose.

        MisuseError beyond a limit.
        """
        self._aim(self._joints_of(q))

    def move_joints(self, *vectors: Joints) -> None:
        """Go through joint vectors from rest to rest, all joints together (PTP); returns when the last is reached.

        A text is the name of one of the robot's `poses` in the cell; external axes stay where they are.
        MisuseError beyond a limit, before anything moves, and while the robot moves already.
        """
        self._check_ready()
        for target in [self._joints_of(q) for q in vectors]:
            self._move_joints(target)

    def follow_joints(self, vectors: Sequence[Joints], active: bool | None = None) -> None:
        """Go through joint vectors without a stop, and wait; `active` switches the process of the tool meanwhile.

        A cubic spline from rest to rest, as fast as the limits of the joints allow (`planning.joint_spline`).
        MisuseError beyond a limit, before anything moves, and while the robot moves already.
        """
        self._check_ready()
        if isinstance(vectors, (str, Mapping)) or not isinstance(vectors, Iterable):
            raise MisuseError("a path in joints is a list of joint vectors, or of names of poses")
        table = [self._joints_of(q) for q in vectors]
        if not table:
            raise MisuseError("the path has no joint vectors")
        self._follow_joints(np.array(table), active)

    def follow(
        self,
        positions: ArrayLike,
        orientations: ArrayLike | None = None,
        *,
        feed: float | None = None,
        spacing: float = 5e-3,
        active: bool | None = None,
    ) -> None:
        """Bring the tip through poses in the world without a stop, and wait; it begins where the tip stands.

        `positions` (n, 3) [m], `orientations` (n, 4) x y z w, or one for all, or None: the tool keeps its own. Between
        two poses the tip goes straight, and turns evenly, through further poses that are at most `spacing` [m] (or as
        many radians times 0.1 m) apart; joints go through all of them as in `follow_joints`, and with `feed` [m/s] the
        tip no faster than that. MisuseError, with the number of the pose, where one cannot be reached, before anything
        moves.
        """
        self._check_ready()
        p0, q0 = self.endeffector_pose
        with as_misuse():
            one = isinstance(positions, Sequence | np.ndarray) and np.ndim(positions) == 1 and len(positions) > 0
            points = numbers([positions] if one else positions, (None, 3), "a path of poses")
            if not len(points):
                raise MisuseError("the path has no poses")
            wanted = q0
            if orientations is not None:
                shape = (4,) if np.ndim(orientations) == 1 else (len(points), 4)
                wanted = quaternions(orientations, shape, "the orientation of a pose")
            spacing = number(spacing, "the spacing of poses [m]", above=0.0)
            feed = None if feed is None else number(feed, "the feed of a way [m/s]", above=0.0)
        ends, turns = np.vstack([p0, points]), np.broadcast_to(wanted, (len(points), 4))
        poses, leads_to = between(ends, np.vstack([q0, turns]), spacing)
        shop = self._machine.shop
        X_FT, X_BW = self._X_FT().inverse().matrix, shop.X_WB.inverse().matrix
        q = joints_along(self.name, shop.kinematics, multiplied(X_BW, poses, X_FT), leads_to, self._machine.q)
        gone = np.cumsum(norms(np.diff(poses[:, :3, 3], axis=0, prepend=p0[None])))
        self._follow_joints(q, active, None if feed is None else TipPace(gone, feed))

    def move_to(self, position: ArrayLike, orientation: ArrayLike | None = None) -> None:
        """Bring the tip to a pose in the world by a joint move (PTP), and wait; as `set_endeffector_pose` otherwise."""
        self._check_ready()
        self.set_endeffector_pose(position, orientation)
        self._move_joints(self._machine.target.copy())

    @property
    def poses(self) -> Mapping[str, Mapping[str, float]]:
        """The named poses that the cell gives this robot: joint values [rad, m] by the names of joints."""
        shop = self._machine.shop
        if shop.mover.joints_are_axes:
            return {}
        robot = shop.cell.robots[shop.name]
        names = robot.chain.driven_joints.names
        return {pose: dict(zip(names, values, strict=True)) for pose, values in robot.poses.items()}

    def _joints_of(self, q: Joints) -> Array:
        """All joint values (j,) that a script means; MisuseError when they are none of this robot's."""
        if isinstance(q, str):
            poses = self.poses
            if q not in poses:
                raise MisuseError(f"`{self.name}` has no pose `{q}`; it has {', '.join(poses) or 'none'}")
            q = poses[q]
        joints = self._machine.shop.kinematics.joints
        target = self._machine.target.copy()
        if isinstance(q, Mapping):
            for name, value in q.items():
                if name not in joints.names:
                    raise MisuseError(f"`{self.name}` has no joint `{name}`; it has {', '.join(joints.names)}")
                with as_misuse():
                    target[joints.names.index(name)] = number(value, f"the place of {name}")
        else:
            with as_misuse():
                given = numbers(q, (None,), "a joint vector")
            if given.shape != target.shape:
                raise MisuseError(f"`{self.name}` has {len(target)} joints; {given.size} values are given")
            target = given.copy()
        for k in np.flatnonzero(~((target >= joints.lower) & (target <= joints.upper))):
            raise MisuseError(
                f"{joints.names[k]} cannot go to {target[k]:.6g}: its limits are {joints.lower[k]:.6g} and "
                f"{joints.upper[k]:.6g} {'m' if joints.kinds[k] == 'prismatic' else 'rad'}"
            )
        return target

    def set_endeffector_pose(self, position: ArrayLike, orientation: ArrayLike | None = None) -> None:
        """Where the tip of the tool, or the flange, is to be with the next steps, in the world; joints go evenly there.

        `orientation` x y z w; without it the tool keeps its own. MisuseError, with the reason, when no joints do it.
        """
        shop, held = self._machine.shop, self._machine.target
        with as_misuse():
            goal = numbers(position, (3,), "the place of a pose")
            held_q = (0.0, 0.0, 0.0, 1.0) if orientation is None else orientation
            turned = quaternions(held_q, (4,), "the orientation of a pose")
        if orientation is None:
            R = (shop.X_WB @ Pose.from_matrix(shop.kinematics.forward(held[None])[0]) @ self._X_FT()).R
        else:
            R = rotation_from_quaternion(turned)
        X_WT = Pose(goal, R)
        X_BF = shop.X_WB.inverse() @ X_WT @ self._X_FT().inverse()
        self._aim(joints_at(self.name, shop.kinematics, X_BF.matrix, X_WT, held))

    def run(self, path: ToolPath, frame: str = "G54") -> None:
        """Run the moves of a path with the tip of the tool, from where the robot stands to the end, as a program does.

        Points are those of `frame`: a work system, `world`, or another frame of the cell that stands still. The tool is
        held as the cell says (`orientation:`). MisuseError while the robot moves, for an unknown frame, for a path
        without moves, or where it is switched on and no tool is held.
        """
        self._cell._run_path(self._machine, path, frame, None)

    def _X_FT(self) -> Pose:
        tool = self._machine.shop.tool(self._machine.state.tool)
        return Pose.identity() if tool is None else tool.X_FT

    # ---- inside

    def _check_ready(self) -> None:
        self._cell._check_open()
        self._machine.check_rest()

    def _aim(self, q: Array) -> None:
        self._cell._check_open()
        self._machine.target = q

    def _move_joints(self, target: Array) -> None:
        """Go to `target` (j,) from rest to rest, all joints together, and wait until that is done."""
        self._cell._wait_for(self._machine, self._machine.move(target))
        self._machine.stand_at(target)

    def _follow_joints(self, vectors: Array, active: bool | None, along: TipPace | None = None) -> None:
        """Go through joint vectors (n, j) without a stop, from where the robot stands, and wait until that is done."""
        self._cell._wait_for(self._machine, self._machine.follow(vectors, along), active)
        self._machine.stand_at(vectors[-1])

"""The world with dynamics: PyBullet without a window, one client a world.

Robot and tool are one multibody, rebuilt at a tool change with the joints where
they were. Motors hold the joints: Bullet's position motor asks for the velocity
``positionGain (q_command - q) / dt + (1 - velocityGain) qd``, so with both
gains 1 a step ends on its command, whatever gravity and process do, as long as
the effort limit allows. The part of a real arm that yields, its gears, is not in here:
the elastic gears are laid over these motor-side joints by the process.

Bullet's solver stops at a residual of 1e-7 (rad/s)² by default, which leaves
1 µm at the tip of a small arm; here it goes on to 1e-16, at no noticeable cost.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from itertools import chain
from operator import itemgetter
from typing import Any, Final

import numpy as np

from gcodesim.frames import Array, Pose, rotation_from_quaternion
from gcodesim.kinematics.dynamics import inverse_dynamics
from gcodesim.solids import Box, Cylinder, Placed, Sphere
from gcodesim.world.body import RobotBody, ToolBody, centred
from gcodesim.world.engine_sines import give_to
from gcodesim.world.model import BulletModel, joint_name, merged_model
from gcodesim.world.payload import payload_of
from gcodesim.world.protocol import STANDARD_GRAVITY, Couple, WorldSteps, WorldUnavailable
from gcodesim.world.reaction import tool_reaction
from gcodesim.world.state import WorldBase, reaction_of, wrench_rows

# what a motor without limit may give [N·m, N]: far above any machine, and still an ordinary number for the solver
UNLIMITED: Final = 1e9
# a motor that delivers this share of its limit is at its limit; the rest is rounding
SATURATED: Final = 1.0 - 1e-6
# below this share of the limit a motor surely has enough
ENOUGH: Final = 0.999
# a joint farther from its command than the solver leaves it has not kept up [rad, m]
LATE: Final = 1e-8
SOLVER_ITERATIONS: Final = 500
SOLVER_RESIDUAL: Final = 1e-16
# joint states are turned into arrays this many steps at a time, since as tuples they are 20 times as big
CHUNK: Final = 1024
UPRIGHT: Final = (0.0, 0.0, 0.0, 1.0)

# one entry for each joint: position, velocity, sensor reading, motor effort
JointStates = tuple[tuple[float, float, tuple[float, ...], float], ...]
# push(k): let the process act during step k of a chunk
Push = Callable[[int], None]


def import_pybullet() -> Any:
    """The module pybullet, without the build date that it writes to stderr; `WorldUnavailable` when it is missing.

    Its sines are the same on every processor (`engine_sines`).
    """
    if "pybullet" in sys.modules:
        give_to(sys.modules["pybullet"])
        return sys.modules["pybullet"]
    if sys.stderr is not None:  # a worker of somebody who has closed it
        sys.stderr.flush()
    kept = os.dup(2)
    null = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(null, 2)
        import pybullet
    except ImportError as error:
        raise WorldUnavailable(
            "the bullet world needs pybullet, which is not installed here; `pip install pybullet` works for Python "
            "up to 3.11 on x86-64 Linux; elsewhere choose `simulation: {world: kinematic}`"
        ) from error
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(null)
    give_to(pybullet)
    return pybullet


class BulletWorld(WorldBase):
    """A robot with masses, motors and gravity in PyBullet; see `gcodesim.world.protocol.World`."""

    may_lag = True
    keeps_to_command = True
    require = staticmethod(import_pybullet)

    def __init__(
        self,
        robot: RobotBody,
        step_ns: int,
        *,
        gravity: tuple[float, float, float] = STANDARD_GRAVITY,
    ) -> None:
        super().__init__(robot, step_ns, gravity=gravity)
        self._bullet = import_pybullet()
        self._limit = robot.effort_limit
        self._body = -1
        self._pockets: dict[str, int] = {}
        self._q = self._qd = self._commanded = np.zeros(self.joint_count)
        self._felt = np.zeros(6)
        self._client = self._bullet.connect(self._bullet.DIRECT)
        if self._client < 0:
            raise WorldUnavailable("pybullet gives no further world in this process; close one first")
        p, client = self._bullet, self._client
        p.setPhysicsEngineParameter(
            fixedTimeStep=self.dt,
            numSubSteps=0,
            numSolverIterations=SOLVER_ITERATIONS,
            solverResidualThreshold=SOLVER_RESIDUAL,
            deterministicOverlappingPairs=1,
            enableFileCaching=0,
            physicsClientId=client,
        )
        p.setGravity(*self.gravity.tolist(), physicsClientId=client)
        self._load(None)

    # building

    def _load(self, tool: ToolBody | None) -> None:
        """Put robot and `tool` into the world as one multibody with the present state of the joints."""
        p, client = self._bullet, self._client
        model = merged_model(self.robot.chain, tool)
        if self._body >= 0:
            p.removeBody(self._body, physicsClientId=client)
        self._body = self._load_text(model.text)
        names = {
            p.getJointInfo(self._body, i, physicsClientId=client)[1].decode(): i
            for i in range(p.getNumJoints(self._body, physicsClientId=client))
        }
        self._joints = [names[joint_name(i)] for i in range(self.joint_count)]
        # Bullet damps every link by default; motors should only give what gravity, inertia and process ask for
        for index in range(-1, len(names)):
            p.changeDynamics(
                self._body, index, linearDamping=0.0, angularDamping=0.0, jointDamping=0.0, physicsClientId=client
            )
        self._find_tip(model)
        self._write_state()

    def _load_text(self, text: str) -> int:
        """Body number of a URDF; Bullet only reads files, so the text goes through a temporary one."""
        p = self._bullet
        base = self.robot.X_WB
        with tempfile.TemporaryDirectory(prefix="gcodesim-") as folder:
            path = os.path.join(folder, "machine.urdf")
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            body: int = p.loadURDF(
                path,
                base.p.tolist(),
                base.q.tolist(),
                useFixedBase=True,
                flags=p.URDF_USE_INERTIA_FROM_FILE,
                physicsClientId=self._client,
            )
        return body

    def _find_tip(self, model: BulletModel) -> None:
        """The tip in the inertial frame of the link that is pushed, which is the frame that link states give."""
        self._tip_link = None if model.carrier < 0 else self._joints[model.carrier]
        self._p_tip: list[float] = [0.0, 0.0, 0.0]
        if self._tip_link is not None:
            info = self._bullet.getDynamicsInfo(self._body, self._tip_link, physicsClientId=self._client)
            X_LI = Pose(np.array(info[3]), rotation_from_quaternion(np.array(info[4])))
            self._p_tip = X_LI.inverse().apply(model.p_LT).tolist()

    # state

    def _write_state(self) -> None:
        for joint, position, velocity in zip(self._joints, self._q.tolist(), self._qd.tolist(), strict=True):
            self._bullet.resetJointState(self._body, joint, position, velocity, physicsClientId=self._client)

    def reset(self, q: Array) -> None:
        """Stand still at joint vector `q` (j,)."""
        self._q = self._commanded = self._joint_vector(q)
        self._qd, self._felt = np.zeros(self.joint_count), np.zeros(6)
        self._write_state()

    def attach(self, tool: ToolBody | None, pocket: Pose | None = None) -> None:
        """Change the tool; the multibody is rebuilt with the joints at their present positions and speeds."""
        old = self.tool
        self._exchange(tool, pocket)
        if tool is not None and tool.name in self._pockets:
            self._bullet.removeBody(self._pockets.pop(tool.name), physicsClientId=self._client)
        if old is not None and old.name in self.parked and old.name not in self._pockets:
            self._pockets[old.name] = self._add_parked(*self.parked[old.name])
        self._load(tool)

    def _add_parked(self, tool: ToolBody, X_WF: Pose) -> int:
        """A tool in its pocket: a body that can be seen, but not run into."""
        p, client = self._bullet, self._client
        visual = -1
        if tool.solids:
            solids = [_visual(p, placed) for placed in tool.solids]
            columns = {key: [solid[key] for solid in solids] for key in solids[0]}
            visual = p.createVisualShapeArray(**columns, physicsClientId=client)
        number: int = p.createMultiBody(
            baseMass=0.0,
            baseVisualShapeIndex=visual,
            basePosition=X_WF.p.tolist(),
            baseOrientation=X_WF.q.tolist(),
            physicsClientId=client,
        )
        return number

    # moved by torques: for a robot with a controller

    def take_torques(self, dt: float) -> None:
        """From now on steps of `dt` [s] in which joints have no motors, only the torques of `under_torques`."""
        p, client = self._bullet, self._client
        p.setPhysicsEngineParameter(fixedTimeStep=dt, physicsClientId=client)
        none = [0.0] * len(self._joints)
        p.setJointMotorControlArray(
            self._body, self._joints, p.VELOCITY_CONTROL, targetVelocities=none, forces=none, physicsClientId=client
        )

    def put(self, q: Array, qd: Array) -> None:
        """Put the joints at `q` (j,) with speeds `qd` (j,)."""
        self._q, self._qd = q.copy(), qd.copy()
        self._write_state()

    def under_torques(self, torque: Array) -> tuple[Array, Array]:
        """One step under `torque` (j,) [N·m, N] at the joints; joints and their speeds (j,) after it."""
        p, client = self._bullet, self._client
        p.setJointMotorControlArray(
            self._body, self._joints, p.TORQUE_CONTROL, forces=torque.tolist(), physicsClientId=client
        )
        p.stepSimulation(client)
        states = p.getJointStates(self._body, self._joints, client)
        return np.array([s[0] for s in states]), np.array([s[1] for s in states])

    # stepping

    def run(self, q_command: Array, couple: Couple | Array | None = None) -> WorldSteps:
        """Move through `q_command` (n, j); see `World.run`."""
        commands = self._commands(q_command)
        n, count = commands.shape
        q, qd, effort = np.empty((n + 1, count)), np.empty((n + 1, count)), np.empty((n, count))
        q[0], qd[0] = self._q, self._qd
        wrench = np.zeros((n, 6))
        if couple is not None and not callable(couple):
            wrench[:] = wrench_rows(couple, 0, commands)
        for first in range(0, n, CHUNK):
            rows = slice(first, min(first + CHUNK, n))
            push: Push | None = None
            if callable(couple):
                states = self._asking_loop(commands[rows], wrench[rows], partial(reaction_of, couple), first)
            else:
                push = None if couple is None else self._push(wrench[rows])
                states = self._lean_loop(commands[rows], push)
            after = slice(first + 1, rows.stop + 1)
            joints = list(chain.from_iterable(states))
            for field, column in ((0, q[after]), (1, qd[after]), (3, effort[rows])):
                column.ravel()[:] = np.fromiter(map(itemgetter(field), joints), dtype=float, count=len(joints))
            self._felt = wrench[rows.stop - 1].copy()
            self._q, self._qd, self._commanded = q[rows.stop].copy(), qd[rows.stop].copy(), commands[rows.stop - 1]
        return WorldSteps(
            q=q[1:],
            qd=qd[1:],
            qdd=np.diff(qd, axis=0) / self.dt,
            effort=effort,
            saturated=np.abs(effort) >= self._limit * SATURATED,
            reaction=tool_reaction(self.machine, self.tool, q, qd, wrench, self.gravity_B, self.dt),
        )

    def keeps_up(self, q_command: Array, wrench: Array) -> bool:
        """Whether no motor will reach its limit; see `World.keeps_up`.

        Motors deliver what Newton and Euler require in the state in which a step
        begins, so the answer is known without making a step.
        """
        commands = self._commands(q_command)
        wrench = wrench_rows(wrench, 0, commands)
        if np.abs(self._q - self._commanded).max() > LATE:
            return False
        if not len(commands) or np.isinf(self._limit).all():
            return True
        q = np.vstack([self._q, commands])
        qd = np.vstack([self._qd, np.diff(q, axis=0) / self.dt])
        effort = inverse_dynamics(
            self.robot.chain,
            q[:-1],
            qd[:-1],
            np.diff(qd, axis=0) / self.dt,
            payload_of(self.tool),
            wrench,
            p_FT=np.zeros(3) if self.tool is None else self.tool.X_FT.p,
            gravity=self.gravity_B,
        )
        return bool((np.abs(effort) < self._limit * ENOUGH).all())

    def _lean_loop(self, commands: Array, push: Push | None) -> list[JointStates]:
        """Joint states after each step; the only Python code that runs once per step."""
        p, client, body, joints = self._bullet, self._client, self._body, self._joints
        command, step, read, mode = p.setJointMotorControlArray, p.stepSimulation, p.getJointStates, p.POSITION_CONTROL
        gains = [1.0] * len(joints)
        forces = np.where(np.isinf(self._limit), UNLIMITED, self._limit).tolist()
        states: list[JointStates] = []
        keep = states.append
        for k, target in enumerate(commands.tolist()):
            if push is not None:
                push(k)
            command(
                body,
                joints,
                mode,
                targetPositions=target,
                positionGains=gains,
                velocityGains=gains,
                forces=forces,
                physicsClientId=client,
            )
            step(client)
            keep(read(body, joints, client))
        return states

    def _asking_loop(self, commands: Array, wrench: Array, ask: Callable[..., Array], first: int) -> list[JointStates]:
        """The same, with a process that is asked before each step; its answers fill `wrench` (m, 6).

        It hears where the joints will be (`Foresight`); `first` is the number of the first step in the run.
        """
        from gcodesim.world.foresight import Foresight

        foresight = Foresight(self.robot.chain, self.tool, self.gravity_B, self._limit, self.dt)
        push = self._push(wrench)
        q, qd, before = self._q, self._qd, self._commanded
        states: list[JointStates] = []
        for k, command in enumerate(commands):
            felt = wrench[k - 1] if k else self._felt
            free, response, target = foresight.of(q.copy(), qd.copy(), before, command, felt)
            wrench[k] = ask(first + k, q, free, response)
            late = np.abs(q - before) > LATE
            states += self._lean_loop(np.where(late, target, command)[None], _at(push, k))
            q, qd = (np.array([joint[field] for joint in states[-1]]) for field in (0, 1))
            before = command
        return states

    def _push(self, wrench: Array) -> Push:
        """Let `wrench` (m, 6), base axes, act on the tool at the tip; row k as it is when step k begins."""
        p, client, body, link = self._bullet, self._client, self._body, self._tip_link
        R_WB: list[list[float]] = self.robot.X_WB.R.tolist()

        def push(k: int) -> None:
            row = wrench[k].tolist()
            if link is None or not any(row):
                return
            # asking for the tip also refreshes the place of the link, from which Bullet computes the lever
            tip = self._tip_now()
            fx, fy, fz, mx, my, mz = row
            force = [x * fx + y * fy + z * fz for x, y, z in R_WB]
            moment = [x * mx + y * my + z * mz for x, y, z in R_WB]
            p.applyExternalForce(body, link, force, tip, p.WORLD_FRAME, client)
            p.applyExternalTorque(body, link, moment, p.WORLD_FRAME, client)

        return push

    def _tip_now(self) -> tuple[float, ...]:
        """The tip in W as Bullet sees it; without forward kinematics the answer would be one step old."""
        centre = self._bullet.getLinkState(
            self._body, self._tip_link, computeForwardKinematics=1, physicsClientId=self._client
        )
        tip: tuple[float, ...] = self._bullet.multiplyTransforms(centre[0], centre[1], self._p_tip, UPRIGHT)[0]
        return tip

    def close(self) -> None:
        """Disconnect from Bullet."""
        if self._client >= 0:
            self._bullet.disconnect(self._client)
            self._client = -1


def _at(push: Push, k: int) -> Push:
    """`push` of row `k`, for a loop of one step."""
    return lambda _: push(k)


def _visual(p: Any, placed: Placed) -> dict[str, Any]:
    """One entry of createVisualShapeArray, which requires every key for every shape."""
    shape, X = centred(placed)
    return {
        "shapeTypes": {Box: p.GEOM_BOX, Cylinder: p.GEOM_CYLINDER, Sphere: p.GEOM_SPHERE}[type(shape)],
        "halfExtents": [0.5 * edge for edge in shape.size] if isinstance(shape, Box) else [0.0, 0.0, 0.0],
        "radii": 0.0 if isinstance(shape, Box) else shape.radius,
        "lengths": shape.length if isinstance(shape, Cylinder) else 0.0,
        "visualFramePositions": X.p.tolist(),
        "visualFrameOrientations": X.q.tolist(),
    }

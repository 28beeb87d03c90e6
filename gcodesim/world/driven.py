"""Robots whose motors obey a controller: motors, gears and links move by their equations of motion.

In the kinematic world the links move by our own equations, in `bullet` by Bullet's; motors, gears and controllers are
the same. So both agree as far as two ways to integrate do. Steps that are swung at once (see `swinging`) are the same
in both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from gcodesim.controllers.controller import Controller, RobotModel, Sense, Servo
from gcodesim.frames import Array, Pose
from gcodesim.kinematics.dynamics import inverse_dynamics
from gcodesim.kinematics.elasticity import shift_jacobian
from gcodesim.world.body import RobotBody, ToolBody
from gcodesim.world.payload import payload_of
from gcodesim.world.protocol import STANDARD_GRAVITY, Couple, NotAtOnce, SwungAtOnce, WorldSteps
from gcodesim.world.reaction import tool_reaction
from gcodesim.world.state import WorldBase, reaction_of, wrench_rows

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Joints
    from gcodesim.world.drive_kernels import Drives

SHORTEST_NS: Final = 250_000
"""A step is divided into parts of at most this time: 0.25 ms, at which modes up to 100 Hz keep most of their swing."""

LATE: Final = 1e-9
"""[rad, m] A motor that is farther from its command has been at its limit, and catches up."""

SPELL: Final = 16
"""Where a motor reaches its limit, so many steps go one by one; then it is asked again whether all can be swung."""

LONGEST: Final = 1 << 30
"""So many steps are tried at once as long as no motor has reached its limit: more than any window has."""

USUAL_ROTOR: Final = 500.0
"""[rad/s², m/s²] with which a motor at its limit accelerates itself, where nobody says how heavy its rotor is."""


class DrivenWorld(WorldBase):
    """A robot with a controller; see `World`. Its `q` are those of the motors, `gear` how far links are off them."""

    may_lag = True
    keeps_to_command = False

    def __init__(
        self, robot: RobotBody, step_ns: int, *, gravity: tuple[float, float, float] = STANDARD_GRAVITY
    ) -> None:
        from gcodesim.world.drive_kernels import Aim, DriveState, room_of
        from gcodesim.world.foresight import links_of

        super().__init__(robot, step_ns, gravity=gravity)
        self._limit = robot.effort_limit
        self._parts = -(-step_ns // SHORTEST_NS)
        j = self.joint_count
        self._state = DriveState(*(np.zeros(j) for _ in range(5)))
        self._aim = Aim(*(np.zeros(j) for _ in range(5)))
        self._mean = np.zeros(j)
        self._wrench = np.zeros(6)
        self._room = room_of(j, self._parts)
        self._memory: dict[str, Any] = {}
        self._wound: Array | None = None  # (2j,) how links are off their motors, where the last steps were swung
        self._steps = 0
        self._spell = 0  # steps that are still to go one by one
        self._reach = LONGEST  # steps that are tried at once
        self._before = np.zeros((2, j))  # motors and links, their speeds at the end of the last step
        self._body = links_of(robot.chain, None, self.gravity_B)
        self._home = np.zeros(j)
        self._drives = self._drives_of()
        self.reset(np.zeros(j))

    # building

    def _drives_of(self) -> Drives:
        """Motors and gears; gains of servos by the inertia in the posture at which the robot was put."""
        from gcodesim.world import drive_kernels as d

        own, joints = self.robot.controller, self.robot.chain.driven_joints
        j = self.joint_count
        law = {"placed": d.PLACED, "servo": d.SERVO, "computed": d.COMPUTED, "given": d.GIVEN}[own.law]
        gear = np.zeros(j) if self.robot.stiffness is None else np.array(self.robot.stiffness, dtype=float)
        gear = np.where(np.isfinite(gear), gear, 0.0)
        rotor = rotors_of(own, self._limit)
        coulomb, viscous = friction_of(own, joints)
        stiffness, damping = np.zeros(j), np.zeros(j)
        if isinstance(own, Servo):
            self._weigh_at(self._home)
            inertia = np.diag(self._room.mass) + rotor
            omega = np.full(j, 2.0 * np.pi * own.bandwidth)
            if own.stiffness:
                given = _per_joint(own.stiffness, j)
                omega = np.where(given > 0.0, np.sqrt(given / inertia), omega)
            stiffness, damping = inertia * omega * omega, inertia * 2.0 * own.damping * omega
        return d.Drives(
            law=law,
            rotor=rotor,
            gear=gear,
            gear_damping=own.gear_damping * gear,
            limit=np.array(self._limit, dtype=float),
            coulomb=coulomb,
            viscous=viscous,
            stiffness=stiffness,
            damping=damping,
            ahead=own.ahead,
        )

    def _weigh_at(self, q: Array) -> None:
        """Bring the room to joints `q` at rest."""
        from gcodesim.world.drive_kernels import DriveState, weigh

        zero = np.zeros(self.joint_count)
        weigh(self._body, DriveState(np.array(q, dtype=float), zero, zero, zero, zero), self._room)

    def _wind_up(self, *, motors_stay: bool) -> None:
        """Gears as gravity winds them up where the links are; links stay where they are."""
        state, gear = self._state, self._drives.gear
        self._wound = None
        self._weigh_at(state.q)
        sag = np.where(gear > 0.0, self._room.static / np.where(gear > 0.0, gear, 1.0), 0.0)
        state.theta[:] = state.theta + (sag - state.sag) if motors_stay else state.q + sag
        state.sag[:] = sag

    # state

    def reset(self, q: Array) -> None:
        """Stand still at joint vector `q` (j,)."""
        q = self._joint_vector(q)
        self._home = q.copy()
        self._drives = self._drives_of()
        self._state.q[:] = q
        for values in (self._state.qd, self._state.thetad, self._state.sag, self._mean, self._wrench):
            values[:] = 0.0
        self._wind_up(motors_stay=False)
        self._aim.q0[:] = self._aim.q1[:] = q
        self._aim.v0[:] = self._aim.v1[:] = 0.0
        self._aim.forward[:] = 0.0
        self._before[:] = 0.0
        self._last_q = np.array([q, q])
        self._memory, self._steps, self._spell, self._reach = {}, 0, 0, LONGEST
        self._placed()

    def _placed(self) -> None:
        """The links were put somewhere, or their masses have changed: tell those who move them."""

    def attach(self, tool: ToolBody | None, pocket: Pose | None = None) -> None:
        """Change the tool; see `World.attach`. Motors turn by what the new weight winds up in the gears."""
        from gcodesim.world.foresight import links_of

        self._exchange(tool, pocket)
        self._body = links_of(self.robot.chain, tool, self.gravity_B)
        self._wind_up(motors_stay=True)
        self._placed()

    # stepping

    def run(self, q_command: Array, couple: Couple | Array | None = None) -> WorldSteps:
        """Move through `q_command` (n, j); see `World.run`."""
        commands = self._commands(q_command)
        if callable(couple):
            return self._first(commands, couple)
        wrench = None if couple is None else np.array(wrench_rows(couple, 0, commands))
        parts: list[WorldSteps] = []
        while not parts or len(commands):
            parts.append(self._first(commands, wrench))
            done = len(parts[-1].q)
            commands, wrench = commands[done:], None if wrench is None else wrench[done:]
        return WorldSteps.joined(parts)

    def _first(self, commands: Array, couple: Couple | Array | None) -> WorldSteps:
        """The first of some steps: as many as go the same way, all at once or one by one.

        Raises `NotAtOnce` where they are not all and a process has to be divided.
        """
        n = len(commands)
        process = cast("SwungAtOnce", couple) if hasattr(couple, "swing") else None
        swung = self._swung_steps(n, couple, process)
        at_once = bool(n and swung[0])
        same = n if n == 0 or (swung == at_once).all() else int(np.argmax(swung != at_once))
        if at_once:
            same = min(same, self._reach)
        if process is not None and same < n:
            if process.divisible:
                raise NotAtOnce(same)
            at_once, same = False, n
        commands, couple = commands[:same], _rows(couple, same)
        if at_once:
            done = self._swing(commands, couple, process)
            if isinstance(done, WorldSteps):
                self._reach = min(2 * self._reach, LONGEST)
                return done
            self._reach = SPELL
            if 0 < done < same and (process is None or process.divisible):
                if process is not None:
                    raise NotAtOnce(done)
                return self._first(commands[:done], _rows(couple, done))
            self._spell = SPELL
            return self._first(commands, couple)
        self._spell = max(self._spell - same, 0)
        return self._by_steps(commands, couple)

    def _swung_steps(self, n: int, couple: Couple | Array | None, process: SwungAtOnce | None) -> NDArray[np.bool_]:
        """Which of the next n steps may be swung at once: motors are where they are to be, and gears alone give way."""
        own, state = self.robot.controller, self._state
        if own.law != "placed" or own.aims or (callable(couple) and process is None) or not self._drives.gear.any():
            return np.zeros(n, dtype=bool)
        if self._spell == 0 and np.abs(state.theta - state.sag - self._aim.q1).max() > LATE:
            self._spell = SPELL
        swung = np.ones(n, dtype=bool) if process is None else process.swung
        swung[: self._spell] = False
        return swung

    def _by_steps(self, commands: Array, couple: Couple | Array | None) -> WorldSteps:
        """The steps one by one."""
        from gcodesim.world.foresight_kernels import DriveOutcome

        n, j = commands.shape
        self._wound = self._wound if n == 0 else None
        outcome = DriveOutcome(np.empty((n, j)), np.empty((n, j)), np.empty((n, j)), np.zeros((n, j), dtype=np.int64))
        wrench = np.zeros((n, 6))
        if couple is not None and not callable(couple):
            wrench[:] = couple
        ask = couple if callable(couple) else None
        own = self.robot.controller
        if ask is None and not own.aims and own.law != "given":
            self._run_known(commands, wrench, outcome)
        else:
            for k in range(n):
                self._run_asked(k, commands[k], ask, wrench, outcome)
        self._steps += n
        if n:
            self._wrench[:] = wrench[-1]
        return self._told(outcome, wrench)

    def _swing(self, commands: Array, couple: Couple | Array | None, process: SwungAtOnce | None) -> WorldSteps | int:
        """The steps in one call; or how many of the first could be, where a motor cannot: nothing has changed then."""
        from gcodesim.world.foresight_kernels import DriveOutcome
        from gcodesim.world.swinging import Swinging

        state = self._state
        swinging = Swinging(self._drives, self._body, self.dt, self._parts)
        y = self._wound
        if y is None:
            y = np.concatenate([state.q - state.theta + state.sag, state.qd - self._aim.v1])
        swinging.prepare(commands, self._aim, self._mean, y)
        if process is not None:
            undo = process.save()
            wrench = process.swing(swinging.swings)
        else:
            wrench = swinging.under(None if callable(couple) else couple)
        if wrench is None:
            return 0
        enough = swinging.motors_can(wrench)
        if enough < len(commands):
            if process is not None:
                undo()
            return enough
        swinging.leave(state, self._aim, self._mean)
        self._wound = swinging.swings.winds[-1].copy()
        self._placed()
        self._steps += len(commands)
        self._wrench[:] = wrench[-1]
        full = np.zeros(commands.shape, dtype=np.int64)
        return self._told(DriveOutcome(swinging.links, commands, swinging.effort, full), wrench)

    def _run_known(self, commands: Array, wrench: Array, outcome: Any) -> None:
        """Steps under wrenches (n, 6) that are known, with a law that is compiled."""
        from gcodesim.world.foresight_kernels import drive_along

        drive_along(
            commands, wrench, self.dt, self._drives, self._body, self._aim, self._mean, self._state, self._room, outcome
        )

    def _run_asked(
        self, k: int, command: Array, ask: Callable[[int, Array], Array] | None, wrench: Array, outcome: Any
    ) -> None:
        """One step: ask the controller, then the process."""
        from gcodesim.world.drive_kernels import feed_forward, weigh
        from gcodesim.world.foresight_kernels import foresee, next_aim, note_outcome

        state, room = self._state, self._room
        next_aim(self._aimed(k, command, wrench), self.dt, self._aim, self._mean)
        weigh(self._body, state, room)
        feed_forward(self.dt, self._drives, self._aim, state, room)
        if ask is not None:
            free = np.empty(self.joint_count)
            foresee(self.dt / self._parts, self.dt, self._drives, self._aim, state, self._felt(k, wrench), room, free)
            wrench[k] = reaction_of(ask, k, state.q.copy(), free, room.response.copy())
        effort = np.empty(self.joint_count)
        self._go(wrench[k], effort)
        note_outcome(k, state, room, effort, outcome)

    def _felt(self, k: int, wrench: Array) -> Array:
        """The wrench (6,) of the step before step `k` of a run."""
        return self._wrench if k == 0 else wrench[k - 1]

    def _aimed(self, k: int, command: Array, wrench: Array) -> Array:
        """What the controller makes of a command (j,)."""
        own = self.robot.controller
        if not own.aims and own.law != "given":
            return command
        mean = (command - self._aim.q1) / self.dt
        motors = self._state.theta - self._state.sag
        sense = Sense(
            time=(self._steps + k) * self.dt,
            dt=self.dt,
            q_ref=command.copy(),
            qd_ref=mean + 0.5 * (mean - self._mean),
            qdd_ref=(mean - self._mean) / self.dt,
            q=motors,
            qd=self._state.thetad.copy(),
            wrench=self._felt(k, wrench).copy(),
            model=self._model,
            memory=self._memory,
        )
        aimed = _answer(own.aim(sense), self.joint_count, f"`aim` of {type(own).__name__}")
        if own.law == "given":
            torques = _answer(own.torques(sense), self.joint_count, f"`torques` of {type(own).__name__}")
            self._aim.forward[:] = np.clip(torques, -self._limit, self._limit)
        return aimed

    @property
    def _model(self) -> RobotModel:
        """The robot as its controller knows it."""
        chain, tool = self.robot.chain, self.tool
        X_FT = Pose.identity() if tool is None else tool.X_FT
        payload = payload_of(tool)

        def jacobian(q: Array) -> Array:
            rows = np.atleast_2d(np.asarray(q, dtype=float))
            J: Array = shift_jacobian(self.machine.jacobian(rows), self.machine.forward(rows), X_FT.p)[0]
            return J

        def efforts(q: Array, qd: Array, qdd: Array) -> Array:
            row: Array = inverse_dynamics(chain, q, qd, qdd, payload, gravity=self.gravity_B)[0]
            return row

        def mass(q: Array) -> Array:
            rows = np.tile(np.asarray(q, dtype=float), (self.joint_count, 1))
            unit = np.eye(self.joint_count)
            weight = inverse_dynamics(chain, rows, 0.0, 0.0, payload, gravity=self.gravity_B)
            columns: Array = (inverse_dynamics(chain, rows, 0.0, unit, payload, gravity=self.gravity_B) - weight).T
            return columns

        gear = self._drives.gear
        return RobotModel(
            jacobian=jacobian,
            mass=mass,
            efforts=efforts,
            gears=np.where(gear > 0.0, gear, np.inf),
            rotors=self._drives.rotor.copy(),
            limit=np.array(self._limit),
        )

    def _go(self, wrench: Array, effort: Array) -> None:
        """One step under `wrench` (6,); `effort` (j,) is filled. `weigh` has been called."""
        from gcodesim.world.drive_kernels import whole_step

        whole_step(
            self.dt / self._parts, self.dt, self._drives, self._aim, self._state, wrench, self._room, False, effort
        )

    def _told(self, outcome: Any, wrench: Array) -> WorldSteps:
        """Steps of motors and links in the words of `WorldSteps`."""
        columns = []
        for side, q in enumerate((outcome.motors, outcome.links)):
            path = np.vstack([self._last_q[side], q])
            speed = np.vstack([self._before[side], np.diff(path, axis=0) / self.dt])
            columns.append((path, speed))
        if len(wrench):
            self._last_q = np.array([outcome.motors[-1], outcome.links[-1]])
            self._before = np.array([columns[0][1][-1], columns[1][1][-1]])
        return WorldSteps(
            q=outcome.motors,
            qd=columns[0][1][1:],
            qdd=np.diff(columns[0][1], axis=0) / self.dt,
            effort=outcome.effort,
            saturated=outcome.full != 0,
            reaction=tool_reaction(self.machine, self.tool, *columns[1], wrench, self.gravity_B, self.dt),
            gear=outcome.links - outcome.motors,
        )

    def keeps_up(self, q_command: Array, wrench: Array) -> bool:
        """Never: the links are where gears and motors let them be."""
        return False

    def close(self) -> None:
        """Does nothing; there is nothing to free."""


def rotors_of(own: Controller, limit: Array) -> Array:
    """Inertia of the rotors (j,) seen from the links, of motors with the effort `limit` (j,)."""
    if own.rotor_inertia:
        return _per_joint(own.rotor_inertia, len(limit))
    usual: Array = np.where(np.isfinite(limit), limit, 0.0) / USUAL_ROTOR
    return usual


def friction_of(own: Controller, joints: Joints) -> tuple[Array, Array]:
    """Coulomb [N·m, N] and viscous [N·m·s/rad, N·s/m] friction (j,) of motors and gears."""
    top = np.where(np.isfinite(joints.speed), joints.speed, 1.0)
    return _per_joint(own.friction, len(top)), _per_joint(own.viscous_friction, len(top)) / top


def _per_joint(values: tuple[float, ...], count: int) -> Array:
    """Values (count,) of a key that has none, one for all, or one a joint."""
    if not values:
        return np.zeros(count)
    return np.full(count, values[0]) if len(values) == 1 else np.array(values, dtype=float)


def _rows(couple: Couple | Array | None, count: int) -> Couple | Array | None:
    """The first rows of wrenches that are known; any other couple as it is."""
    return couple[:count] if isinstance(couple, np.ndarray) else couple


def _answer(values: Array, count: int, who: str) -> Array:
    """What a controller returned, checked; ValueError for another shape and for what is no number."""
    answer: Array = np.asarray(values, dtype=float)
    if answer.shape != (count,) or not np.isfinite(answer).all():
        raise ValueError(f"{who} returned {values!r}; {count} finite numbers are expected")
    return answer

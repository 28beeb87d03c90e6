"""Steps in which motors are where they are commanded to be, and links swing on the gears."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.frames import Array
from gcodesim.world.state import wrench_rows

if TYPE_CHECKING:
    from gcodesim.processes.swing_kernels import Swings
    from gcodesim.world.drive_kernels import Aim, Drives, DriveState, LinkBodies
    from gcodesim.world.gear_kernels import MotorWay, StepLoads


class Swinging:
    """n steps of `dt` [s], each in at least so many `parts`; first `prepare`, then ask.

    `swings` are the steps as maps, and what came of them once a process, or `under`, has filled their `winds`.
    """

    swings: Swings
    effort: Array
    """(n, j) means of the motors, once `motors_can` was asked."""

    def __init__(self, drives: Drives, body: LinkBodies, dt: float, parts: int) -> None:
        self._drives, self._body, self._dt = drives, body, dt
        self._halvings = (max(parts, 1) - 1).bit_length()

    def prepare(self, commands: Array, aim: Aim, mean: Array, y: Array) -> None:
        """For motors that go through `commands` (n, j), from `aim` on with the `mean` speed (j,) of the last step.

        `y` (2j,) is how far links are off their motors, and how fast.
        """
        from gcodesim.processes.swing_kernels import Swings
        from gcodesim.world.gear_kernels import MotorWay, StepLoads, fill_swings

        n, j = commands.shape
        q = np.concatenate([aim.q1[None], commands])
        means = np.concatenate([mean[None], np.diff(q, axis=0) / self._dt])
        self._mean: Array = means[-1]
        speeds = means[1:] + 0.5 * np.diff(means, axis=0)
        self._motors: MotorWay = MotorWay(q, np.concatenate([aim.v1[None], speeds]), means[0])
        self.swings = Swings(
            dt=self._dt,
            keep=np.empty((n, 2 * j, 2 * j)),
            push=np.empty((n, 2 * j, j)),
            drive=np.empty((n, j)),
            jerk=np.empty((n, 2 * j)),
            tip=np.empty((n, 6, j)),
            begin=y,
            winds=np.empty((n, 2 * j)),
        )
        self._loads: StepLoads = StepLoads(np.empty((n, j, j)), np.empty((n, j)))
        fill_swings(self._motors, self._drives, self._body, self._halvings, self.swings, self._loads)

    def under(self, wrench: Array | None) -> Array:
        """Let wrenches (n, 6) that are known act, or none; returns them."""
        from gcodesim.processes.swing_kernels import swing_along

        n = len(self.swings.drive)
        rows = np.zeros((n, 6)) if wrench is None else np.ascontiguousarray(wrench_rows(wrench, 0, self.links_told))
        swing_along(self.swings, rows)
        return rows

    @property
    def links_told(self) -> Array:
        """Joints (n, j) as commanded."""
        return self._motors.q[1:]

    @property
    def links(self) -> Array:
        """Where the links are (n, j)."""
        links: Array = self._motors.q[1:] + self.swings.winds[:, : self._motors.q.shape[1]]
        return links

    def motors_can(self, wrench: Array) -> int:
        """In how many of the first steps no motor reaches its limit under the wrenches (n, 6) that have acted."""
        from gcodesim.world.gear_kernels import motor_efforts

        self.effort = np.empty(self._motors.q[1:].shape)
        return int(motor_efforts(self._motors, self._drives, self.swings, self._loads, wrench, self.effort))

    def leave(self, state: DriveState, aim: Aim, mean: Array) -> None:
        """Bring what a world keeps to the end of the last step."""
        q, qd, _ = self._motors
        j = q.shape[1]
        gear = self._drives.gear
        state.sag[:] = np.where(gear > 0.0, self._loads.known[-1] / np.where(gear > 0.0, gear, 1.0), 0.0)
        state.theta[:], state.thetad[:] = q[-1] + state.sag, qd[-1]
        state.q[:], state.qd[:] = q[-1] + self.swings.winds[-1, :j], qd[-1] + self.swings.winds[-1, j:]
        aim.q0[:], aim.v0[:], aim.q1[:], aim.v1[:] = q[-2], qd[-2], q[-1], qd[-1]
        mean[:] = self._mean

"""Moves in joint space: all joints start and stop together."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from math import sqrt
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.ramp_kernels import peak_speed, ramp_at, ramp_time

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Joints
    from gcodesim.planning.loads import Loads, Slowing

STILL: Final = 1e-12  # [rad, m] of a joint that does not move
SHORTEST: Final = 1e-9  # [s] of a move on which nothing moves: a nanosecond
_LOOKS: Final = 64  # places of a move at which its efforts are asked for
_CLOSE_LOOKS: Final = 1024  # the same where one is near its limit: between two of 64 weight may take what motion has
_NEAR: Final = 0.9  # of a limit
_WITHIN: Final = 1e-9  # of a ramp, before its end


@frozen(slots=False, kw_only=False, eq=False)
class JointMove:
    """From joints `start` to `end` (j,), from rest to rest, along the straight line between them.

    `speed` [1/s], `acceleration` [1/s²] and `jerk` [1/s³] (infinite: any) are those that the slowest joint allows for
    the share of the way that is done. Without jerk the speed is a trapezoid; else its ramps are S-curves with at most
    seven phases (Biagiotti, Melchiorri: Trajectory Planning, 2008, section 3.4).
    """

    start: Array
    end: Array
    speed: float
    acceleration: float
    jerk: float

    @staticmethod
    def between(start: Array, end: Array, joints: Joints) -> JointMove:
        """The fastest one under the limits of `joints`."""
        way = np.abs(end - start)
        moving = way > STILL
        if not moving.any():
            return JointMove(start, end, 1.0, 1.0, np.inf)
        speed = np.minimum(joints.speed, 1e6)[moving] / way[moving]
        acceleration = np.minimum(joints.acceleration, 1e6)[moving] / way[moving]
        jerk = joints.jerk[moving] / way[moving]
        return JointMove(start, end, float(speed.min()), float(acceleration.min()), float(jerk.min()))

    @property
    def moves(self) -> bool:
        """Whether anything moves."""
        return bool(np.any(np.abs(self.end - self.start) > STILL))

    @cached_property
    def peak(self) -> float:
        """The greatest speed [1/s] that is reached."""
        v, a, j = self.speed, self.acceleration, self.jerk
        if np.isinf(j):
            return a * min(v / a, float(1.0 / np.sqrt(a)))
        return peak_speed(1.0, v, a, j)

    def _ramp(self, peak: float) -> float:
        """Time [s] from rest to `peak` [1/s]."""
        return ramp_time(peak, self.acceleration, self.jerk)

    @property
    def duration(self) -> float:
        """Time [s]; 0 when nothing moves."""
        if not self.moves:
            return 0.0
        v, a = self.speed, self.acceleration
        if not np.isinf(self.jerk):
            return 1.0 / self.peak + self._ramp(self.peak)
        return float(2.0 / np.sqrt(a)) if v * v >= a else 1.0 / v + v / a

    def at(self, t: Array) -> Array:
        """Joints (n, j) at times `t` (n,) [s] from the start on; before and after it the ends."""
        if not self.moves:
            return np.tile(self.end, (len(t), 1))
        q: Array = self.start + self.share_at(t)[:, None] * (self.end - self.start)
        return q

    def share_at(self, t: Array) -> Array:
        """Share 0…1 of the move that is done at times `t` (n,) [s]."""
        if not np.isinf(self.jerk):
            return self.law_at(t)[0]
        a = self.acceleration
        ramp = min(self.speed / a, 1.0 / np.sqrt(a))
        top = a * ramp
        total = 1.0 / top + ramp
        t = np.clip(t, 0.0, total)
        left = total - t
        up, down = 0.5 * a * (t * t), 1.0 - 0.5 * a * (left * left)
        share: Array = np.where(t < ramp, up, np.where(left < ramp, down, top * (t - 0.5 * ramp)))
        return share

    def law_at(self, t: Array) -> tuple[Array, Array, Array]:
        """Share of the way, and its first and second derivative by time, at `t` (n,) [s]."""
        ramp, top = self._ramp(self.peak), self.peak
        total = 1.0 / top + ramp
        t = np.clip(t, 0.0, total)
        begins, ends = t < ramp, total - t < ramp
        s, v, a = self._on_ramp(np.where(begins, t, np.where(ends, total - t, ramp)))
        share = np.where(begins, s, np.where(ends, 1.0 - s, top * (t - 0.5 * ramp)))
        return share, v, np.where(begins, a, np.where(ends, -a, 0.0))

    def _on_ramp(self, t: Array) -> tuple[Array, Array, Array]:
        """Way, speed and acceleration at `t` (n,) [s] of the ramp from rest to the peak."""
        top, j = self.peak, self.jerk
        if np.isinf(j):
            a = self.acceleration
            return 0.5 * a * t * t, a * t, np.full(len(t), a)
        return ramp_at(t, top, self.acceleration, j)

    def within(self, loads: Loads, tool: int, piece: int = 0) -> tuple[JointMove, Slowing | None]:
        """The move slowed evenly so that motors can give its efforts with `tool`; and where, on `piece`, if it was.

        Or where they cannot bear the weight, which is as it is however slow the move.
        """
        if not self.moves or not loads.matter:
            return self, None
        share, slowing = self._asks(loads, tool, piece, _LOOKS)
        if share > _NEAR:
            _, slowing = self._asks(loads, tool, piece, _CLOSE_LOOKS)
        heavy = np.flatnonzero(slowing.overweight.any(axis=1))
        worst = slowing.at(distinct(np.append(heavy, slowing.share.argmin())))
        k = float(worst.share.min())
        if k >= 1.0:
            return self, worst if len(heavy) else None
        slower = replace(
            self, speed=self.peak * sqrt(k), acceleration=self.acceleration * k, jerk=self.jerk * k * sqrt(k)
        )
        return slower, replace(worst, s=worst.s / sqrt(k))

    def _asks(self, loads: Loads, tool: int, piece: int, count: int) -> tuple[float, Slowing]:
        """The greatest share of a limit that an effort takes at `count` places of the move, and what they allow."""
        step, looks = self.end - self.start, self._looks(count)
        share, rate, change = self.law_at(looks)
        q, tools = self.start + share[:, None] * step, np.full(len(looks), tool)
        qd = rate[:, None] * step
        static, moved = loads.efforts(tools, q, (0.0, 0.0), (qd, change[:, None] * step))
        reserve = loads.reserve(tools, q, qd, np.zeros(len(looks), dtype=bool))
        most = float(((np.maximum(np.abs(static), np.abs(moved)) + reserve) / loads.limit).max())
        return most, loads.slowing((np.full(len(looks), piece), looks), static, moved, reserve=reserve)

    def _looks(self, count: int) -> Array:
        """Times [s] at which efforts are asked for: evenly, and where speed and acceleration are greatest together.

        These are the ends of the ramps, as seen from within them.
        """
        ramp = self._ramp(self.peak)
        total, within = 1.0 / self.peak + ramp, ramp * (1.0 - _WITHIN)
        return np.concatenate([(np.arange(count) + 0.5) / count * total, [0.0, within, total - within, total]])

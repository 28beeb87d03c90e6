"""What M66 hears of a switch of the cell: whether something is before it, now and while the machine waits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gcodesim.arithmetic.matrices import applied
from gcodesim.cell.inputs import InputSource, Wait
from gcodesim.frames import Array, Pose
from gcodesim.observation.schedule import Station
from gcodesim.observation.stage import Hand, Stage, surface_of
from gcodesim.sensors.switch import SightSwitch

if TYPE_CHECKING:
    from gcodesim.executor.halt import RunHalt
    from gcodesim.shop import Shop

_AT_ONCE: Final = 512
"""Steps that are looked at together: a wait mostly ends long before its time is over."""


class HeardSwitch(NamedTuple):
    """What M66 has read, None when its time ran out; how long it waited [s]; the frame of what was there then."""

    value: float | None
    seconds: float
    what: str


class Hearing:
    """A switch on `station` in a shop, heard while the machine stands as `halt` says; steps last `dt` [s].

    Machines, tools, stocks and fixtures stand still; parts, belts, doors and what falls go on.
    """

    def __init__(self, shop: Shop, station: Station, halt: RunHalt, dt: float) -> None:
        assert isinstance(station.sensor, SightSwitch)
        self._shop, self._sensor, self._station, self._dt = shop, station.sensor, station, dt
        self._stage = Stage.of(shop)
        self._q = {name: joints[None] for name, joints in halt.joints.items()}
        self._hands = {shop.name: Hand(tool=halt.tool, opening=halt.opening)}
        self._moving = halt.moving
        self._still, self._what = self._first_of_what_stands()

    @property
    def where(self) -> str:
        """The place at which it looks, in words."""
        return self._sensor.where

    def wait(self, wait: Wait, begin: float, timeout: float) -> HeardSwitch:
        """What M66 reads that begins at `begin` [s] and gives up after `timeout` [s]."""
        values: list[float] = []
        times: list[float] = []
        for index, (value, name) in enumerate(self._states()):
            if not values or value != values[-1]:
                values.append(value)
                times += [begin + index * self._dt] if index else []
            enough = index * self._dt >= timeout or wait == "immediate"
            if enough or index == 0 or value != values[0]:
                source = InputSource(values=tuple(values), times=tuple(times))
                heard, waited = source.read(wait, begin, timeout, {})
                if heard is not None or enough:
                    return HeardSwitch(heard, waited, name)
        raise AssertionError("states have no end")

    def _states(self) -> Iterator[tuple[float, str]]:
        """What the input reads at the end of the last step and of each that follows, and what is there."""
        first = 0
        while True:
            shares = np.full(_AT_ONCE, self._still)
            nearest = np.full(_AT_ONCE, -1)
            for number, (frame, poses) in enumerate(self._moving.items()):
                met = self._met(frame, poses(first, _AT_ONCE))
                nearest = np.where(met < shares, number, nearest)
                shares = np.minimum(met, shares)
            names = list(self._moving)
            read = self._sensor.signal(shares)
            for k in range(_AT_ONCE):
                name = names[nearest[k]] if nearest[k] >= 0 else self._what
                yield float(read[k]), name if np.isfinite(shares[k]) else ""
            first += _AT_ONCE

    def _line(self, count: int) -> tuple[Array, Array]:
        """Begin and way (count, 3) [m] of the sensor's line in the world."""
        rows = {name: np.broadcast_to(joints, (count, joints.shape[1])) for name, joints in self._q.items()}
        X = self._shop.scene.track(self._station.frame, rows)
        return self._sensor.line_in(np.ascontiguousarray(X))

    def _met(self, frame: str, X_WF: Array) -> Array:
        """Where (n,) the line meets a body first that is at X_WF (n, 4, 4)."""
        starts, ways = self._line(len(X_WF))
        R = np.swapaxes(X_WF[:, :3, :3], 1, 2)
        begin, way = applied(R, starts - X_WF[:, :3, 3]), applied(R, ways)
        return _first(self._stage.triangles_of(frame), begin, way)

    def _first_of_what_stands(self) -> tuple[float, str]:
        """Where the line meets something first that does not move while the machine stands, and what."""
        starts, ways = self._line(1)
        best, what = np.inf, ""
        for name, triangles in self._stage.standing(self._q, self._hands, set(self._moving)):
            share = float(_first(triangles, starts, ways)[0])
            if share < best:
                best, what = share, name
        for name, placed in self._shop.stocks.items():
            X = Pose.from_matrix(self._shop.scene.track(placed.frame, self._q)[0]).inverse()
            begin, way = X.apply(starts), applied(X.R, ways)
            low, high = placed.stock.bounds
            if _misses(begin[0], way[0], low, high):
                continue
            surface = surface_of(placed)
            share = float(_first(surface.vertices[surface.faces], begin, way)[0])
            if share < best:
                best, what = share, name
        return best, what


def _first(triangles: Array, starts: Array, ways: Array) -> Array:
    from gcodesim.sensors.sightline_kernels import first_met

    shares = np.empty(len(starts))
    first_met(np.ascontiguousarray(triangles), np.ascontiguousarray(starts), np.ascontiguousarray(ways), shares)
    return shares


def _misses(start: Array, way: Array, low: Array, high: Array) -> bool:
    """Whether a line certainly passes beside a box."""
    end = start + way
    return bool((np.maximum(start, end) < low).any() or (np.minimum(start, end) > high).any())

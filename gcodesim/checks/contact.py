"""Where a probing move touches: the tip of the tool, swept along the planned path, against stocks and fixtures.

Nothing is removed and nothing is pushed; geometry alone decides what the tip meets first, and when.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.arithmetic.matrices import inverse_pose, multiplied, norms
from gcodesim.checks.clearance import Standing
from gcodesim.checks.collisions import ToolParts, fixture_touches
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.material.contact import in_material

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.planning.plan import Plan
    from gcodesim.tools.tool import Tool

TIPS: Final = ("tip", "cutting", "nozzle")
"""Parts of a tool that may touch: the first of these that it has, otherwise all of it."""

FACETS: Final = 16  # points along a radius of the tip: a ball is within 0.05 % of its radius, and exact along the axes
_MOST_POSES: Final = 20_000  # of one move
_FEWEST_POSES: Final = 64
_HALVINGS: Final = 40
_AT_ONCE: Final = 16  # poses, so that little is asked behind the first contact


@frozen
class Contact:
    """`time` [s] in the plan at which the tip begins to touch `body`, or stops touching anything."""

    time: float
    body: str


@frozen(eq=False)
class TargetStock:
    """A stock that can be touched; `pose` gives X_BS (n, 4, 4) at joints (n, j)."""

    name: str
    stock: Stock
    pose: Callable[[Array], Array]

    @property
    def cell(self) -> float:
        """Width [m] of the finer side of a column."""
        return float(min(self.stock.spacing))


@frozen(kw_only=False, eq=False)
class _Way:
    """Times (n,) of the plan, with joints and tip X_BT."""

    times: Array
    q: Array
    X_BT: Array

    def seen_from(self, pose: Callable[[Array], Array] | None) -> Array:
        """The tip (n, 4, 4) seen from a frame at `pose`; None: from B."""
        X: Array = self.X_BT if pose is None else multiplied(inverse_pose(pose(self.q)), self.X_BT)
        return X

    def part(self, rows: NDArray[np.intp]) -> _Way:
        return _Way(self.times[rows], self.q[rows], self.X_BT[rows])


@frozen(slots=False, kw_only=False, eq=False)
class Touching:
    """The last move of `plan` with `tool` in the spindle, against everything around it."""

    plan: Plan
    tool: Tool
    stocks: Sequence[TargetStock]
    standing: Sequence[Standing]

    def first(self, *, begin: float, towards: bool) -> Contact | None:
        """The first contact from `begin` [s] to the end of the plan, or the first loss of it; None: there is none.

        It is at `begin` itself if the tip touches already, or if it touches nothing although contact is to be lost.
        """
        way = self._way_from(begin)
        if towards:
            met = [*self._stock_contacts(way), *self._fixture_contacts(way)]
            return min(met, key=lambda contact: (contact.time, contact.body), default=None)
        touched = self._bodies(way)
        free = np.flatnonzero([not bodies for bodies in touched])
        if not len(free):
            return None
        index = int(free[0])
        if index == 0:
            return Contact(time=begin, body="")
        low, high = float(way.times[index - 1]), float(way.times[index])
        time = self._turn(low, high, lambda here: bool(self._bodies(here)[0]))
        return Contact(time=time, body=touched[index - 1][0])

    # -- where the tip is

    def _way(self, times: Array) -> _Way:
        samples = self.plan.trajectory.sample(times)
        q = self.plan.joints(samples)
        return _Way(times, q, self.plan.tip(q, samples.row))

    def _way_from(self, begin: float) -> _Way:
        """Times so close that the tip goes less than half the finest cell, or half its own radius, between two."""
        end = self.plan.trajectory.duration
        coarse = self._way(np.linspace(begin, end, _FEWEST_POSES + 1))
        frames = [target.pose for target in self.stocks] + [some.carrier for some in self.standing]
        ways = [np.diff(coarse.seen_from(pose)[:, :3, 3], axis=0) for pose in frames]
        longest = max((float(norms(way).max()) for way in ways), default=0.0)
        finest = 0.5 * min([self._radius, *(target.cell for target in self.stocks)])
        wanted = int(np.ceil(_FEWEST_POSES * longest / max(finest, 1e-6)))
        return self._way(np.linspace(begin, end, min(max(wanted, _FEWEST_POSES), _MOST_POSES) + 1))

    @cached_property
    def _parts(self) -> ToolParts:
        """The part of the tool that may touch."""
        outlines = ToolParts.of(self.tool).outlines
        names = [name for name, _ in outlines]
        part = next((name for name in TIPS if name in names), None)
        own = tuple(one for one in outlines if part in (None, one[0]))
        return ToolParts(name=self.tool.name, outlines=own)

    @cached_property
    def _radius(self) -> float:
        return max((float(outline[:, 0].max()) for _, outline in self._parts.outlines), default=1e-3)

    @cached_property
    def _skin(self) -> Array:
        """Points (n, 3) of the surface of the tip in T."""
        step = max([self._radius / FACETS, *(0.25 * target.cell for target in self.stocks)])
        outlines = [outline for _, outline in self._parts.outlines]
        return np.concatenate([np.zeros((1, 3)), *(surface_points(outline, step) for outline in outlines)])

    # -- stocks

    def _stock_contacts(self, way: _Way) -> list[Contact]:
        found = []
        for target in self.stocks:
            inside = self._first_inside(target, way)
            if inside is None:
                continue
            index, points = inside
            time = float(way.times[index])
            if index > 0:  # what touches at that pose has come in since the one before
                time = self._turn(float(way.times[index - 1]), time, partial(self._is_in, target, points))
            found.append(Contact(time=time, body=target.name))
        return found

    def _is_in(self, target: TargetStock, points: Array, here: _Way) -> bool:
        return bool(_in_material(target, here, points).any())

    def _first_inside(self, target: TargetStock, way: _Way) -> tuple[int, Array] | None:
        """The first of n times at which the tip is in material, and the points (k, 3) of its surface that are."""
        near = self._near(target, way)
        for first in range(0, len(near), _AT_ONCE):
            some = near[first : first + _AT_ONCE]
            inside = _in_material(target, way.part(some), self._skin)
            touched = inside.any(axis=1)
            if touched.any():
                index = int(np.argmax(touched))
                return int(some[index]), self._skin[inside[index]]
        return None

    def _in_stock(self, target: TargetStock, way: _Way) -> NDArray[np.bool_]:
        """Whether the tip is in material at n times."""
        touched = np.zeros(len(way.times), dtype=bool)
        near = self._near(target, way)
        for first in range(0, len(near), _AT_ONCE):
            some = near[first : first + _AT_ONCE]
            touched[some] = _in_material(target, way.part(some), self._skin).any(axis=1)
        return touched

    def _near(self, target: TargetStock, way: _Way) -> NDArray[np.intp]:
        """Those of n times at which the tip may touch at all."""
        low, high = target.stock.bounds
        reach = float(norms(self._skin).max())
        p = way.seen_from(target.pose)[:, :3, 3]
        near: NDArray[np.intp] = np.flatnonzero(np.all((p > low - reach) & (p < high + reach), axis=1))
        return near

    # -- fixtures

    def _fixture_contacts(self, way: _Way) -> list[Contact]:
        found = []
        for some in self.standing:
            X = way.seen_from(some.carrier)
            axis = -(X[:-1, :3, 2] + X[1:, :3, 2])
            axis /= norms(axis)[:, None]
            for touch in fixture_touches(self._parts, some.bodies, X[:-1, :3, 3], X[1:, :3, 3], axis):
                before, after = way.times[touch.piece], way.times[touch.piece + 1]
                found.append(Contact(time=float(before + touch.share * (after - before)), body=touch.fixture))
        return found

    def _bodies(self, way: _Way) -> list[list[str]]:
        """What the tip touches at each of n times."""
        touched: list[list[str]] = [[] for _ in way.times]
        for target in self.stocks:
            for index in np.flatnonzero(self._in_stock(target, way)).tolist():
                touched[index].append(target.name)
        for some in self.standing:
            X = way.seen_from(some.carrier)
            p, axis = X[:, :3, 3], -X[:, :3, 2]
            for touch in fixture_touches(self._parts, some.bodies, p, p, axis):
                for index in range(touch.piece, touch.piece + touch.pieces):
                    touched[index].append(touch.fixture)
        return touched

    def _turn(self, before: float, after: float, state: Callable[[_Way], bool]) -> float:
        """When the answer of `state` changes between two times [s]: the later end of the interval that is left."""
        low, high = before, after
        last = state(self._way(np.array([high])))
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if state(self._way(np.array([middle]))) == last:
                high = middle
            else:
                low = middle
        return high


def _in_material(target: TargetStock, way: _Way, points: Array) -> NDArray[np.bool_]:
    """Which of the points (k, 3) of the tip are in material at each of n times; (n, k)."""
    X_ST = way.seen_from(target.pose)
    flat = (multiplied(points, X_ST[:, :3, :3].transpose(0, 2, 1)) + X_ST[:, None, :3, 3]).reshape(-1, 3)
    low, high = target.stock.bounds
    within = np.flatnonzero(np.all((flat > low) & (flat < high), axis=1))
    hit = np.zeros(len(flat), dtype=bool)
    hit[within] = in_material(target.stock, flat[within])
    return hit.reshape(len(X_ST), -1)


def surface_points(outline: Array, step: float) -> Array:
    """Points (n, 3) in T on the body of revolution that `outline` (k, 2), radius and height [m], is the hull of.

    Neighbours are about `step` [m] apart, on straight walls along the axis up to a 16th of their height.
    """
    hull = _profile(outline)
    rings: list[tuple[float, float]] = [(float(hull[0, 0]), float(hull[0, 1]))]
    for (r0, h0), (r1, h1) in zip(hull[:-1].tolist(), hull[1:].tolist(), strict=True):
        length = math.hypot(r1 - r0, h1 - h0)
        own = max(step, length / FACETS) if abs(r1 - r0) < 1e-12 else step
        count = max(1, int(np.ceil(length / own)))
        rings += [(r0 + (r1 - r0) * k / count, h0 + (h1 - h0) * k / count) for k in range(1, count + 1)]
    points = []
    for radius, height in rings:
        count = max(1, 4 * int(np.ceil(0.5 * np.pi * radius / step)))  # with one towards each axis
        angle = 2.0 * np.pi * np.arange(count) / count
        ring = np.stack([radius * cos(angle), radius * sin(angle), np.full(count, -height)], axis=1)
        points.append(ring)
    return np.concatenate(points)


def _profile(outline: Array) -> Array:
    """The outer side of the hull of points (k, 2), radius and height, from the axis below to the axis above."""
    low, high = float(outline[:, 1].min()), float(outline[:, 1].max())
    points = sorted({(float(h), float(r)) for r, h in outline} | {(low, 0.0), (high, 0.0)})
    upper: list[tuple[float, float]] = []
    for h, r in points:  # monotone chain along the axis, keeping the greatest radii
        while len(upper) >= 2 and _turns_in(upper[-2], upper[-1], (h, r)):
            upper.pop()
        upper.append((h, r))
    profile = np.array([(r, h) for h, r in upper])
    ends = [(0.0, low)] if profile[0, 0] > 0.0 else []
    tops = [(0.0, high)] if profile[-1, 0] > 0.0 else []
    return np.concatenate([np.array(ends).reshape(-1, 2), profile, np.array(tops).reshape(-1, 2)])


def _turns_in(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    """Whether b lies on the inner side of a to c, so that a hull leaves it out."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) >= 0.0

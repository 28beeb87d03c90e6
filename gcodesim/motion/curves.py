"""The geometry of moves: straight lines, arcs and helices with a length along which they are run."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos, cos, cos_sin, hypot, sin
from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.curve_kernels import ROUND, STRAIGHT, CurveColumns
from gcodesim.motion.tool_path import ARC, ToolPath


@frozen(slots=False, kw_only=False, eq=False)
class Curves:
    """c curves in M, run by s from 0 to `length`.

    `kind` STRAIGHT, ROUND, TIMED or OWN; `start`, `end` (c, 6) [m, rad]. Of a round
    one ``center + (1 + growth u) (cos(sweep u) radial + sin(sweep u) sideways)
    + u lift`` with u = s / length; its rotary axes run evenly. `length` is [m];
    [rad] when only rotary axes move, [s] of TIMED and OWN ones.
    """

    kind: NDArray[np.uint8]
    start: Array
    end: Array
    center: Array
    radial: Array
    sideways: Array
    lift: Array
    sweep: Array
    growth: Array
    length: Array

    @staticmethod
    def of(path: ToolPath) -> Curves:
        """One curve a row, as programmed."""
        n = len(path)
        kind = np.full(n, STRAIGHT, dtype=np.uint8)
        step = path.end - path.start
        length: Array = norms(step[:, :3])
        rotary = length <= 1e-12
        length[rotary] = norms(step[rotary, 3:])
        center, radial, sideways, lift = (np.zeros((n, 3)) for _ in range(4))
        sweep, growth = np.zeros(n), np.zeros(n)
        arc = np.flatnonzero(path.kind == ARC)
        if len(arc):
            kind[arc] = ROUND
            normal = path.normal[arc]
            start, end, middle = path.start[arc, :3], path.end[arc, :3], path.center[arc]
            height = dots(start - middle, normal)
            rise = dots(end - start, normal)
            middle = middle + height[:, None] * normal
            r0 = start - middle
            r1 = end - middle - rise[:, None] * normal
            size0, size1 = norms(r0), norms(r1)
            center[arc], radial[arc], sideways[arc] = middle, r0, np.cross(normal, r0)
            lift[arc] = rise[:, None] * normal
            sweep[arc] = path.sweep[arc]
            growth[arc] = np.divide(size1, size0, out=np.ones_like(size0), where=size0 > 0.0) - 1.0
            length[arc] = hypot(0.5 * (size0 + size1) * np.abs(sweep[arc]), rise)
        return Curves(kind, path.start.copy(), path.end.copy(), center, radial, sideways, lift, sweep, growth, length)

    def __len__(self) -> int:
        return len(self.kind)

    @property
    def arrays(self) -> CurveColumns:
        """The columns as kernels take them."""
        return CurveColumns(
            self.kind,
            self.start,
            self.end,
            self.center,
            self.radial,
            self.sideways,
            self.lift,
            self.sweep,
            self.growth,
            self.length,
        )

    def take(self, rows: NDArray[np.intp]) -> Curves:
        """Copies of some of the curves."""
        return Curves(**{f.name: getattr(self, f.name).take(rows, axis=0) for f in fields(self)})

    def followed_by(self, others: Curves) -> Curves:
        """All of both; these themselves where there are no others."""
        if not len(others):
            return self
        return Curves(**{f.name: np.concatenate([getattr(c, f.name) for c in (self, others)]) for f in fields(self)})

    def end_tangents(self) -> tuple[Array, Array]:
        """Derivatives of position by s at start and end: two arrays (c, 6)."""
        length = np.where(self.length > 0.0, self.length, 1.0)[:, None]
        first = (self.end - self.start) / length
        last = first.copy()
        arc = np.flatnonzero(self.kind == ROUND)
        if len(arc):
            sweep, growth = self.sweep[arc, None], self.growth[arc, None]
            radial, sideways, lift = self.radial[arc], self.sideways[arc], self.lift[arc]
            c, s = cos_sin(sweep)
            first[arc, :3] = (sweep * sideways + growth * radial + lift) / length[arc]
            out, along = c * radial + s * sideways, -s * radial + c * sideways
            last[arc, :3] = (sweep * (1.0 + growth) * along + growth * out + lift) / length[arc]
        return first, last

    def polyline(self, chord: float) -> Array:
        """Points (m, 3) along all curves one after the other; arcs as chords within `chord` [m]."""
        if not len(self):
            return np.zeros((0, 3))
        row, u = self.shares(chord)
        return np.concatenate([self.start[:1, :3], self.points_at(row, u)])

    def points_at(self, row: NDArray[np.intp], u: Array) -> Array:
        """Points (k, 3) at shares `u` (k,) in 0…1 of curves `row` (k,)."""
        share = u[:, None]
        points: Array = self.start[row, :3] + share * (self.end[row, :3] - self.start[row, :3])
        arc = self.kind[row] == ROUND
        angle = self.sweep[row, None] * share
        bent = self.center[row] + share * self.lift[row]
        bent += (1.0 + self.growth[row, None] * share) * (
            cos(angle) * self.radial[row] + sin(angle) * self.sideways[row]
        )
        points[arc] = bent[arc]
        return points

    def shares(self, chord: float) -> tuple[NDArray[np.intp], Array]:
        """Curve and share in 0…1 of the ends of chords that stay within `chord` [m] of the curves."""
        radius = norms(self.radial) * np.maximum(1.0, 1.0 + self.growth)
        bend = 2.0 * acos(np.clip(1.0 - chord / np.maximum(radius, 1e-12), -1.0, 1.0))
        count = np.where(self.kind == ROUND, np.ceil(np.abs(self.sweep) / np.clip(bend, 1e-3, 0.5)), 1.0).astype(int)
        count = np.maximum(count, 1)
        row = np.repeat(np.arange(len(self)), count)
        step = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + 1
        return row, step / count[row]

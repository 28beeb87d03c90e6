"""A working plane that leans against its work system: its zero, and its axes as a rotation."""

from __future__ import annotations

from typing import NamedTuple

Triple = tuple[float, float, float]
Rows = tuple[Triple, Triple, Triple]


class Tilt(NamedTuple):
    """point of the work = zero + R (point of the plane); `rows` are those of R, `zero` in program units."""

    zero: Triple
    rows: Rows

    def direction(self, v: Triple) -> Triple:
        """A direction of the plane, in the work."""
        x, y, z = (row[0] * v[0] + row[1] * v[1] + row[2] * v[2] for row in self.rows)
        return (x, y, z)

    def point(self, p: Triple) -> Triple:
        """A point of the plane, in the work."""
        x, y, z = self.direction(p)
        return (x + self.zero[0], y + self.zero[1], z + self.zero[2])

    def back(self, p: Triple) -> Triple:
        """A point of the work, in the plane."""
        d = (p[0] - self.zero[0], p[1] - self.zero[1], p[2] - self.zero[2])
        x, y, z = (sum(self.rows[k][column] * d[k] for k in range(3)) for column in range(3))
        return (x, y, z)

    def scaled(self, factor: float) -> Tilt:
        """The same plane in other units."""
        x, y, z = self.zero
        return Tilt((x * factor, y * factor, z * factor), self.rows)

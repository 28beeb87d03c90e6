"""Noise of sensors: seeded, and with the same bits on every processor."""

from __future__ import annotations

from math import pi
from zlib import crc32

import numpy as np

from gcodesim.arithmetic.elementary import cos, log, sin
from gcodesim.frames import Array
from gcodesim.frozen import frozen


@frozen(kw_only=False)
class Noise:
    """The noise of reading `number` of the sensor `name` in a run with this `seed`; no reading shares another's."""

    seed: int
    name: str
    number: int

    def normal(self, count: int) -> Array:
        """`count` values of mean 0 and standard deviation 1, not correlated (Box and Muller 1958, eq. 1)."""
        bits = np.random.PCG64([self.seed % 2**63, crc32(self.name.encode()), self.number])
        pairs = -(-count // 2)
        uniform = np.random.Generator(bits).random(2 * pairs)  # whole numbers times 2^-53: the same everywhere
        radius = np.sqrt(-2.0 * _logs(1.0 - uniform[:pairs]))
        angle = 2.0 * pi * uniform[pairs:]
        return np.concatenate([radius * cos(angle), radius * sin(angle)])[:count]


def _logs(values: Array) -> Array:
    """Natural logarithms (n,) of values in (0, 1]."""
    return np.array([log(float(value)) for value in values]) if len(values) < 64 else _many_logs(values)


def _many_logs(values: Array) -> Array:
    from gcodesim.sensors.raster_kernels import logarithms

    out = np.empty_like(values)
    logarithms(values, out)
    return out

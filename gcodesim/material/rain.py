"""Material that a nozzle throws as particles, along the rays of a cone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.arithmetic.matrices import norms
from gcodesim.frozen import frozen
from gcodesim.material.rain_kernels import Fallen, Rain, rain_down

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]


@frozen
class NozzleRays:
    """Rays of a nozzle: `spread` is the tangent of half the opening [-], `far` [m] the length of a ray, `number` how
    many there are for each piece of the way, `seed` where their random numbers begin."""

    spread: float
    far: float
    number: int
    seed: int


def rays_of(cone: NozzleRays, starts: Array, ends: Array, axes: Array, first: int) -> tuple[Array, Array]:
    """Where the rays of c pieces begin, and their directions, both (c number, 3).

    Tips go from `starts` to `ends` (c, 3), `axes` (c, 3) point from the tip to the holder. Rays are spread evenly over
    the round spot on a plane across the axis, and over the way of the piece. `first` is the number of rays that were
    drawn before, so that no ray depends on how a run is cut into windows.
    """
    count = len(starts) * cone.number
    draws = np.random.Philox(key=cone.seed)
    draws.advance(first)  # by four numbers a ray
    u = np.random.Generator(draws).random((count, 4))
    piece = np.repeat(np.arange(len(starts)), cone.number)
    radius, turn = cone.spread * np.sqrt(u[:, 0]), 2.0 * np.pi * u[:, 1]
    axis = axes[piece]
    flat = np.abs(axis[:, 2]) < 0.9
    across = np.cross(axis, np.where(flat[:, None], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]))
    across /= norms(across)[:, None]
    beside = np.cross(axis, across)
    ways = (radius * cos(turn))[:, None] * across + (radius * sin(turn))[:, None] * beside - axis
    ways /= norms(ways)[:, None]
    return starts[piece] + u[:, 2:3] * (ends[piece] - starts[piece]), ways


def rain_on(
    stock: Stock, cone: NozzleRays, starts: Array, ends: Array, axes: Array, volumes: Array, first: int
) -> Fallen:
    """Throw `volumes` (c,) [m³] along the rays of each of c pieces, in place; what became of each piece (c,).

    What strikes nothing within the length of a ray is lost. Columns along x and y are given up.
    """
    stock.lattice = None
    origins, ways = rays_of(cone, starts, ends, axes, first)
    each = np.repeat(volumes / cone.number, cone.number)
    rain = Rain(np.ascontiguousarray(origins), np.ascontiguousarray(ways), each, cone.far)
    fallen = Fallen(*np.zeros((2, len(ways))))
    done = 0
    while (done := rain_down(stock.field, rain, done, fallen)) < len(ways):
        stock.grow()
    shape = (len(starts), cone.number)
    return Fallen(fallen.volume.reshape(shape).sum(axis=1), fallen.flight.reshape(shape).min(axis=1, initial=np.inf))

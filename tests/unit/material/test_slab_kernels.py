"""Lines against slabs of a body of revolution, beside a slow twin that looks at many places and times."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material.slab_kernels import Slab, line_of, swept


def any_slab(rng):
    if rng.random() < 0.4:
        radius, centre = rng.uniform(1.0, 5.0), rng.uniform(-2.0, 2.0)
        low = centre - radius * rng.uniform(0.0, 1.0)
        return Slab(1.0, low, low + radius * rng.uniform(0.1, 1.0), radius, centre, radius)
    low = rng.uniform(-2.0, 2.0)
    high = low + rng.uniform(0.1, 6.0)
    r0 = rng.choice([0.0, rng.uniform(0.0, 4.0)])
    r1 = rng.choice([max(r0, 0.5), rng.uniform(0.1, 4.0)])
    growth = (r1 - r0) / (high - low)
    return Slab(0.0, low, high, r0 - growth * low, growth, max(r0, r1))


def sampled(u, v, axis, move, slab, s, t):
    q = (u - t * move[0] + 0.0 * s, v - t * move[1] + 0.0 * s, s - t * move[2])
    height = q[0] * axis[0] + q[1] * axis[1] + q[2] * axis[2]
    apart2 = q[0] ** 2 + q[1] ** 2 + q[2] ** 2 - height**2
    if slab.round:
        inside = apart2 + (height - slab.g) ** 2 <= slab.k**2
    else:
        inside = apart2 <= (slab.k + slab.g * height) ** 2
    return (inside & (height >= slab.h0) & (height <= slab.h1)).any(axis=1)


@pytest.mark.parametrize("seed", range(120))
def test_a_line_shares_one_interval_with_what_a_slab_sweeps(seed):
    rng = np.random.default_rng(seed)
    slab = any_slab(rng)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    axis = [axis, axis, axis, np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])][seed % 5]
    free = rng.normal(size=3) * rng.uniform(0.0, 6.0)
    move = [free, free, axis * rng.uniform(-4.0, 4.0), np.zeros(3), np.array([0.0, 0.0, 3.0])][seed // 5 % 5]
    u, v = rng.uniform(-3.0, 3.0, 2)

    low, high = swept(line_of(u, v, *axis, *move, slab), slab)

    s, t = np.linspace(-20.0, 20.0, 4001), np.linspace(0.0, 1.0, 401)
    hit = np.flatnonzero(sampled(u, v, axis, move, slab, s[:, None], t[None, :]))
    if not len(hit):
        assert high - low < 0.15  # a corner between two samples
    else:
        assert low - 1e-9 <= s[hit[0]] and s[hit[-1]] <= high + 1e-9
        assert low >= s[hit[0]] - 0.08 and high <= s[hit[-1]] + 0.08

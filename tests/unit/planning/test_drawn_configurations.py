"""Drawn cuts against a brute force: all branches, whole turns and spins of a grid, every pair of neighbours tried.

With a fixed spin both see the same ways, so the answers are the same. With a free one the grid of the brute force is
coarser: whatever it finds, the search has to find, with at least 90 % of the margin.
"""

from itertools import product

import numpy as np
import pytest

from gcodesim.frames import Array, rotation_about
from gcodesim.planning.configuration import search
from gcodesim.planning.ladder import Passage
from gcodesim.units import DEG
from tests.configuration_cases import kinematics_for

REACH = {  # [m] up to where cuts are drawn
    "abb_irb1200_5_90": 0.8,
    "fanuc_m20ia": 1.5,
    "kuka_kr10_r1100_2": 0.9,
    "kuka_kr10_r1100_sixx": 0.9,
    "staubli_tx2_90": 0.85,
}
SPINS = np.arange(-180.0, 180.0, 10.0) * DEG
SAME = 1e-6  # [rad]
UP = np.array([0.0, 0.0, 1.0])


def drawn(rng):
    """The name of an arm and a cut: round a part, straight, over a dome, or past the singularity of the wrist."""
    name = str(rng.choice(list(REACH)))
    size = REACH[name]
    u = np.linspace(0.0, 1.0, 14)
    p = size * np.array([rng.uniform(0.4, 0.8), rng.uniform(-0.3, 0.3), rng.uniform(0.1, 0.6)])
    kind = rng.integers(4)
    if kind == 0:
        turn, r = u * rng.choice([1.0, 1.5, 2.0]) * np.pi, rng.uniform(0.05, 0.2) * size
        round_ = np.column_stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)])
        p, z = p + r * round_, -round_ - rng.uniform(0.2, 2.0) * UP
    elif kind == 1:
        p, z = p + np.outer(u, 0.4 * size * rng.normal(size=3)), np.tile(rng.normal(size=3) - 1.5 * UP, (len(u), 1))
    elif kind == 2:
        turn, lean = u * np.pi * rng.choice([2.0, 3.0]), 0.2 + u * rng.uniform(0.4, 1.2)
        z = -np.column_stack([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), np.cos(lean)])
        p = p - 0.1 * size * z
    else:
        p = p + np.outer(u - 0.5, [0.0, 0.6 * size, 0.0])
        z = np.tile([1.0, *(0.05 * rng.normal(size=2))], (len(u), 1))
    z /= np.linalg.norm(z, axis=1)[:, None]
    x = [1.0, 0.3, 0.0] - z * (z @ [1.0, 0.3, 0.0])[:, None]
    x /= np.linalg.norm(x, axis=1)[:, None]
    X_BT, X_FT = np.tile(np.eye(4), (len(u), 1, 1)), np.eye(4)
    X_BT[:, :3] = np.stack([x, np.cross(z, x), z, p], axis=2)
    X_FT[:3, 3] = rng.choice([0.0, 0.05]), 0.0, rng.uniform(0.05, 0.3)
    X_FT[:3, :3] = rotation_about(np.array([0.0, 1.0, 0.0]), float(rng.choice([0.0, 45.0, 90.0])) * DEG)
    return name, X_BT, X_FT, np.full(6, rng.choice([30.0, 45.0, 60.0]) * DEG)


def rung(arm, X_BT: Array, X_TF: Array, spins: Array) -> Array:
    """All joints (n, 6) within the limits that hold the tool there at one of `spins`."""
    found = []
    for spin in spins:
        X = X_BT.copy()
        X[:3, :3] = X[:3, :3] @ rotation_about(UP, float(spin))
        for q in arm.branches(X @ X_TF):
            turns = np.add.outer(q, 2.0 * np.pi * np.arange(-1, 2))
            within = (turns >= arm.joints.lower[:, None]) & (turns <= arm.joints.upper[:, None])
            found += product(*(row[good] for row, good in zip(turns, within, strict=True)))
    return np.array(found).reshape(-1, 6)


def brute(arm, cut: Passage) -> tuple[int, float]:
    """How many poses can be run from the start, and the best margin [rad] of the way through them."""
    spins, best = SPINS if cut.free else np.zeros(1), np.empty(0)
    before = np.empty((0, 6))
    for number, X in enumerate(cut.X_BT):
        q = rung(arm, X, np.linalg.inv(cut.X_FT), spins)
        margin = np.minimum(q - arm.joints.lower, arm.joints.upper - q).min(axis=1, initial=np.inf)
        if number:
            near = (np.abs(q[:, None] - before) <= cut.step).all(axis=2)
            margin = np.minimum(margin, np.where(near, best, -np.inf).max(axis=1, initial=-np.inf))
        if not np.isfinite(margin).any():
            return number, float(best.max(initial=0.0))
        before, best = q[np.isfinite(margin)], margin[np.isfinite(margin)]
    return len(cut.X_BT), float(best.max())


def check(seeds: range) -> None:
    whole = 0
    for seed in seeds:
        name, X_BT, X_FT, step = drawn(np.random.default_rng(seed))
        arm = kinematics_for(name)
        for free in (False, True):
            cut = Passage(X_BT=X_BT, X_FT=X_FT, free=free, step=step)
            prefix, margin = brute(arm, cut)
            found = search(arm, cut)
            assert found.prefix >= prefix if free else found.prefix == prefix, seed
            if found.clear is None:
                continue
            q = found.clear.q
            if found.prefix == prefix:
                assert found.clear.margin >= 0.9 * margin - SAME, seed
            X = arm.forward(q) @ X_FT
            assert np.abs(X[:, :3, 2:] - X_BT[: len(q), :3, 2:]).max() < SAME, seed
            assert np.abs(np.diff(q, axis=0)).max(initial=0.0) <= step[0] + SAME, seed
            assert ((q >= arm.joints.lower - SAME) & (q <= arm.joints.upper + SAME)).all(), seed
            whole += found.continuous
    assert whole > len(seeds) // 4


def test_drawn_cuts_have_the_answer_of_a_brute_force() -> None:
    check(range(6))


@pytest.mark.slow
def test_many_drawn_cuts_have_the_answer_of_a_brute_force() -> None:
    check(range(6, 150))

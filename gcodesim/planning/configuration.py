"""The configuration of an arm for a whole cut: which branch, turns and spins lead through all its poses.

Among all branches, whole turns and spins on a grid, dynamic programming finds whether there is a continuous way, the
one that stays farthest from the limits of the joints and the one on which they travel least; both are refined
between the spins of the grid.
"""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Indices
from gcodesim.planning.arm_kernels import joint_rates
from gcodesim.planning.ladder import Passage, Rungs, rungs_of
from gcodesim.planning.ladder_kernels import ENDLESS, TURN, Rails, earliest, link, shortest, trace, widest
from gcodesim.planning.spin_choice import REGULAR

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics

SPINS: Final = 144  # of a free tool all around: 2.5 deg apart
_BESIDE: Final = 4  # spins on each side of the last best one in a refinement
_WITHIN: Final = (1.0, 1.0, 0.5, 0.25)  # steps of the grid, within which each refinement looks
_SAME: Final = 1e-6  # [rad, m] between joints that count as the same
START_SHARE: Final = 0.02  # of the squared way from where the arm stands to where a cut begins, in the cost of the cut
_HALF_METRE: Final = 0.5  # [m] that count as one radian
_NEAR: Final = 0.25  # [rad²] that a pose on a singularity costs
_SHARE: Final = 0.98  # of the best margin that the way which keeps clear has; of those the shortest is taken


class Hindrance(StrEnum):
    """Why a pose is not reached.

    REACH: no joints put the tool there. LIMIT: such joints exist, but none within limits. COLLISION: the arm would hit
    something, there or on every way to there. WAY: there are some within limits that hit nothing, but no continuous
    way leads to them from the start.
    """

    REACH = "reach"
    LIMIT = "limit"
    COLLISION = "collision"
    WAY = "way"


@frozen(kw_only=False, eq=False)
class LadderWay:
    """Joints q (n, j) and spins (n,) [rad] through a cut.

    `margin` is their least distance from limits and `travel` the sum of what all of them go [rad, m]. `vectors` (n,)
    are those of the ladder that it came from.
    """

    q: Array
    spins: Array
    margin: float
    travel: float
    vectors: Indices


@frozen(eq=False)
class Configuration:
    """What a search found: how far a cut can be run from its start, and the ways.

    `prefix` counts the poses that can be run from the start; `stretch` is the first and the last pose of the longest
    part that can be run (0, −1: none). `clear` is the way that stays farthest from the limits and `short` the one that
    travels least. Where the cut cannot be run whole, they end with `prefix` (None where that is 0), and `obstacle`
    says why.
    """

    prefix: int
    stretch: tuple[int, int]
    clear: LadderWay | None
    short: LadderWay | None
    obstacle: Hindrance | None = None

    @property
    def continuous(self) -> bool:
        """Whether the whole cut can be run."""
        return self.obstacle is None


def grid(cut: Passage, count: int = SPINS) -> Array:
    """Spins (n, s) [rad] to try at every pose: all around if the tool is free."""
    around = TURN * np.arange(count) / count if cut.free else np.zeros(1)
    return np.tile(around, (len(cut), 1))


def search(
    kinematics: Kinematics, cut: Passage, *, spins: int = SPINS, branches: tuple[int, ...] | None = None
) -> Configuration:
    """The ways through `cut` (at least one pose); so many `spins` are tried all around. `branches`: only these."""
    rungs = rungs_of(kinematics, cut, grid(cut, spins), branches)
    rails = link(rungs.ladder, cut.step, False)
    prefix, first, last = earliest(rungs.ladder, rails)
    obstacle = None
    if prefix < len(cut):
        run = (prefix, first, last)
        obstacle = hindrance(kinematics, cut, rungs, prefix, run, spins=spins, branches=branches)
    if prefix == 0:
        return Configuration(prefix=0, stretch=(first, last), clear=None, short=None, obstacle=obstacle)
    if obstacle is not None:
        cut = cut.part(0, prefix)
        rungs = rungs_of(kinematics, cut, grid(cut, spins), branches)
        rails = link(rungs.ladder, cut.step, False)
    best = widest(rungs.ladder, rails)
    clear, short = way_with(rungs, rails, _SHARE * best), way_with(rungs, rails, 0.0)
    for steps in _WITHIN if cut.free else ():
        apart = steps * TURN / spins
        clear, short = (
            refined(kinematics, cut, clear, apart, branches, clear=True),
            refined(kinematics, cut, short, apart, branches, clear=False),
        )
    return Configuration(prefix=prefix, stretch=(first, last), clear=clear, short=short, obstacle=obstacle)


def even_way(
    kinematics: Kinematics,
    cut: Passage,
    *,
    margin: float,
    start: Array,
    spins: int,
    branches: tuple[int, ...] | None = None,
) -> LadderWay | None:
    """The way through `cut` on which joints move most evenly, beginning near joints `start` (j,); None: there is none.

    It goes round singularities where the way round is not long, and keeps `margin` [rad, m] from limits, or nearly the
    best one where that is less.
    """
    way: LadderWay | None = None
    for steps in (None, *_WITHIN) if cut.free else (None,):
        tried = grid(cut, spins) if steps is None or way is None else _spins_beside(way, steps * TURN / spins)
        rungs = rungs_of(kinematics, cut.without_obstacles(), tried, branches)
        if not rungs.counts.all():
            return None
        rails = link(rungs.ladder, cut.step, True)
        best = widest(rungs.ladder, rails)
        if best < 0.0:
            return None
        rails.way[: rails.first[-1]] += np.repeat(_toll(kinematics, rungs.ladder.q), np.diff(rails.first))
        way = _free_way(cut, rungs, rails, best, margin, start)
        if way is None:
            return None
    return way


def _free_way(cut: Passage, rungs: Rungs, rails: Rails, best: float, margin: float, start: Array) -> LadderWay | None:
    """The cheapest way that hits nothing, on a ladder whose vectors nobody has asked about that; None: there is none.

    Whether a vector hits something takes far longer than a way. So the cheapest way of all is asked first, then all
    vectors beside the poses at which it hits something, and so on: the way that hits nothing at last is the cheapest.
    """
    asked, reach = np.zeros(len(cut), dtype=bool), 1
    while best >= 0.0:
        way = way_with(rungs, rails, min(_SHARE * best, margin), start)
        hits = _hits(cut, way, asked)
        if not len(hits):
            return way
        near = _beside(hits, reach, asked)
        asked[near], reach = True, 2 * reach
        rungs, rails = rungs.where(rails, _is_free(cut, rungs, near))
        best = widest(rungs.ladder, rails)
    return None


def _hits(cut: Passage, way: LadderWay, asked: NDArray[np.bool_]) -> Indices:
    """The poses of a way through a cut at which the arm hits something, but for those that have been `asked` (n,)."""
    open_ = np.flatnonzero(~asked)
    if cut.around is None or not len(open_):
        return np.zeros(0, dtype=np.int64)
    found: Indices = open_[cut.around.hit(np.ascontiguousarray(way.q[open_]), open_)]
    return found


def _beside(poses: Indices, reach: int, asked: NDArray[np.bool_]) -> Indices:
    """Poses up to `reach` from some `poses`, but for those that have been `asked` (n,)."""
    near = np.zeros(len(asked), dtype=bool)
    for shift in range(-reach, reach + 1):
        near[np.clip(poses + shift, 0, len(asked) - 1)] = True
    found: Indices = np.flatnonzero(near & ~asked)
    return found


def _is_free(cut: Passage, rungs: Rungs, poses: Indices) -> NDArray[np.bool_]:
    """Which vectors (N,) hit nothing, those of other than these `poses` not asked."""
    assert cut.around is not None
    free = np.ones(len(rungs.ladder.q), dtype=bool)
    pose = np.repeat(np.arange(len(cut)), rungs.counts)
    mine = np.isin(pose, poses)
    free[mine] = ~cut.around.hit(np.ascontiguousarray(rungs.ladder.q[mine]), pose[mine])
    return free


def _toll(kinematics: Kinematics, q: Array) -> Array:
    """What joints (n, j) cost besides the way to them [rad²], because they are near a singularity.

    How near tells 1 / |J⁻¹|, lengths in half metres, which is at most the least gain of the Jacobian.
    """
    J = np.ascontiguousarray(kinematics.jacobian(q))
    J[:, :3] /= _HALF_METRE
    square = np.zeros(len(q))
    axes = np.eye(6)
    for k in range(0, 6, 2):
        for rates in joint_rates(J, np.tile(axes[k], (len(q), 1)), np.tile(axes[k + 1], (len(q), 1))):
            square += np.sum(rates * rates, axis=1)
    short = np.maximum(1.0 - 1.0 / (REGULAR * np.sqrt(square)), 0.0)
    toll: Array = _NEAR * short * short
    return toll


def _spins_beside(way: LadderWay, apart: float) -> Array:
    """Spins (n, s) [rad] at and beside those of `way`, up to `apart` [rad] away."""
    spins: Array = way.spins[:, None] + apart * np.arange(-_BESIDE, _BESIDE + 1) / _BESIDE
    return spins


def on_branches(kinematics: Kinematics, X_BF: Array, q: Array, branches: tuple[int, ...]) -> bool:
    """Whether joints q (n, j) at poses (n, 4, 4) are all on these `branches`; any is where two of them meet."""
    found, exists = kinematics.branches_along(X_BF)
    away = found - q[:, None]
    away -= np.where(kinematics.chain.tree.prismatic == 0, TURN * np.floor(0.5 + away / TURN), 0.0)
    here = exists & (np.abs(away).max(axis=2, initial=0.0) < _SAME)
    return bool(here[:, [b for b in branches if b < here.shape[1]]].any(axis=1).all())


def hindrance(
    kinematics: Kinematics,
    cut: Passage,
    rungs: Rungs,
    pose: int,
    run: tuple[int, int, int],
    *,
    spins: int,
    branches: tuple[int, ...] | None,
) -> Hindrance:
    """Why `pose`, the first one beyond what can be `run`, is not reached.

    `run`: how many poses from the start on, and the first and last of the longest part, as `earliest` says of `rungs`.
    """
    if not rungs.in_reach[pose]:
        return Hindrance.REACH
    if not rungs.counts[pose]:
        return Hindrance.COLLISION if rungs.within[pose] else Hindrance.LIMIT
    if cut.around is None:
        return Hindrance.WAY
    bare = cut.without_obstacles()
    ladder = rungs_of(kinematics, bare, grid(bare, spins), branches).ladder
    prefix, first, last = earliest(ladder, link(ladder, cut.step, False))
    farther = prefix > run[0] if pose == run[0] else last - first > run[2] - run[1]
    return Hindrance.COLLISION if farther else Hindrance.WAY


def refined(
    kinematics: Kinematics, cut: Passage, way: LadderWay, apart: float, branches: tuple[int, ...] | None, *, clear: bool
) -> LadderWay:
    """The best way with spins beside those of `way`, within `apart` [rad]: the clearest, else the shortest."""
    rungs = rungs_of(kinematics, cut, _spins_beside(way, apart), branches)
    rails = link(rungs.ladder, cut.step, False)
    return way_with(rungs, rails, _SHARE * widest(rungs.ladder, rails) if clear else 0.0)


def way_with(rungs: Rungs, rails: Rails, margin: float, start: Array | None = None) -> LadderWay:
    """The cheapest of the ways through all rungs that keep `margin` from limits; there has to be one.

    With joints `start` (j,) it also counts how far from there the way begins.
    """
    ladder = rungs.ladder
    parent = np.empty((len(ladder.q), len(ladder.whole)), dtype=np.int16)
    begin = np.zeros((ladder.first[1], len(ladder.whole)))
    if start is not None:
        away = ladder.q[: len(begin), None] + TURN * ladder.whole - start
        away = np.where(ladder.kind == ENDLESS, 0.0, away)
        begin = START_SHARE * np.sum(away * away, axis=2)
    cost, vector, turn = shortest(ladder, rails, margin, begin, parent)
    if vector < 0 or not np.isfinite(cost):
        raise ValueError("no way with this margin")
    steps = np.empty((len(ladder.first) - 1, 2), dtype=np.int64)
    trace(ladder, rails, parent, vector, turn, steps)
    q = ladder.q[steps[:, 0]] + TURN * ladder.whole[steps[:, 1]]
    endless = ladder.kind == ENDLESS
    if endless.any():
        whole = np.floor(0.5 + np.diff(q[:, endless], axis=0) / TURN)
        q[1:, endless] -= TURN * np.cumsum(whole, axis=0)
    room = np.minimum(q - ladder.lower, ladder.upper - q)[:, ~endless]
    travel = float(np.abs(np.diff(q, axis=0)).sum())
    vectors = steps[:, 0].copy()
    return LadderWay(q, rungs.spin[vectors], float(room.min(initial=np.inf)), travel, vectors)

"""Which spin of the tool and which configuration of the arm suit a whole program."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import least_gains
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.curves import Curves
from gcodesim.motion.pieces import AxisLimits
from gcodesim.planning.arm_kernels import joint_rates
from gcodesim.planning.axis_posing import offsets
from gcodesim.planning.flange_poses import candidates, flange_origins, flange_poses, unbent
from gcodesim.planning.joint_rows import JointRows

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics
    from gcodesim.planning.guide import Guide
    from gcodesim.planning.obstacles import Around

SPINS: Final = 24  # candidates all around
POSES: Final = 240  # at which a candidate is tried
CHAINS: Final = 40  # of poses between joint moves that are tried
COMFORT: Final = 0.25  # [rad] from the nearest joint limit beyond which more is no better
REGULAR: Final = 0.03  # least singular value of the Jacobian, lengths in half metres, beyond which more is no better
_AT_ONCE: Final = 48  # poses at which what the arm hits is asked together
_SHARP: Final = 0.1  # share of poses that may be slower than the limits used for rounding corners


@frozen(kw_only=False, eq=False)
class SampledPath:
    """Some flange origins (k, 3) of a path with R_BO (k, 3, 3), in chains that begin where a joint move ends.

    `chains` holds first and last + 1 of each; `number` which of the path's chains it is. They are at `share` (k,) of
    `row` (k,). `bend` is X_NF (k, 4, 4) there where some tool is bent.
    """

    p_BO: Array
    R_BO: Array
    chains: list[tuple[int, int]]
    number: list[int]
    row: NDArray[np.intp]
    share: Array
    bend: Array | None = None

    def poses(self, spin: float) -> Array:
        """X_BF (k, 4, 4) with the tool turned by `spin` [rad]."""
        return unbent(flange_poses(self.p_BO, self.R_BO, spin), self.bend)

    @staticmethod
    def of(rows: JointRows, R_BO: Array, guide: Guide | None = None, bend: Array | None = None) -> SampledPath:
        """Points all along the path, not more than about `POSES` of them; with a `guide` as the arm's base sees them.

        External axes that are chosen are at rest. `bend` (n, 4, 4) is that of each row.
        """
        path = rows.path
        heads = np.flatnonzero(rows.joint & ~rows.home)
        bounds = np.append(np.flatnonzero(rows.joint), len(path))
        curves = Curves.of(path)
        chosen = _spread(len(heads), CHAINS)
        way = np.where(rows.joint, 0.0, curves.length)
        step = max(way.sum() / POSES, 1e-6)
        row_parts: list[Array] = []
        share_parts: list[Array] = []
        chains: list[tuple[int, int]] = []
        at = 0
        for head in heads[chosen]:
            after = int(bounds[np.searchsorted(bounds, head, side="right")])
            inside = np.arange(head + 1, after)
            count = np.maximum(np.ceil(way[inside] / step), 1).astype(int)
            row = np.repeat(inside, count)
            share = (np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + 1) / np.repeat(count, count)
            few = _spread(len(row), max(POSES // max(len(chosen), 1), 8))
            row, share = np.append(head, row[few]), np.append(1.0, share[few])
            row_parts.append(row)
            share_parts.append(share)
            chains.append((at, at + len(row)))
            at += len(row)
        row = np.concatenate(row_parts) if row_parts else np.zeros(0, dtype=np.intp)
        share = np.concatenate(share_parts) if share_parts else np.zeros(0)
        R, points = R_BO[row], curves.points_at(row, share)
        if guide is not None:
            words = path.start[row, 3:] + share[:, None] * (path.end[row, 3:] - path.start[row, 3:])
            points = np.concatenate([points, words], axis=1)
            R = guide.leaning(R, row, points)
        origins = flange_origins(points[:, :3], offsets(path)[row, :3], R)
        if guide is not None and guide.outside is not None:
            origins, R = guide.from_arm(origins, R, row, guide.outside.commanded(points))
        own = None if bend is None else bend[row]
        return SampledPath(origins, R, chains, [int(c) for c in chosen], row, share, own)


@frozen(kw_only=False, eq=False)
class SpinChoice:
    """The choice: `spin` [rad], joints to start some chains from, and what the arm can do along x, y, z there."""

    spin: float
    seeds: dict[int, Array]
    limits: AxisLimits


def choose_spin(
    kinematics: Kinematics,
    probe: SampledPath,
    home: Array,
    near: float,
    spin: float | None,
    around: Around | None = None,
) -> SpinChoice:
    """The spin with the fewest bad poses, then the most margin, then nearest to `near`; a given `spin` [rad] is kept.

    Margin counts joint limits and singularities up to a comfortable distance,
    so that among good ones the nearest to the present joints wins. A pose is bad too where the arm hits what `around`
    knows.
    """
    best: tuple[tuple[float, float, int], float, dict[int, Array], Array] | None = None
    for order, angle in enumerate(candidates(near, SPINS) if spin is None else np.array([spin])):
        tried = _try(kinematics, probe, home, float(angle), around, math.inf if best is None else best[0][0])
        if tried is None:
            continue
        q, bad, seeds = tried
        margin = round(_margin(kinematics, q), 6)
        score = (bad, -margin, order)
        if best is None or score < best[0]:
            best = (score, float(angle), seeds, q)
        if bad == 0 and margin >= 1.0:
            break
    assert best is not None
    return SpinChoice(best[1], best[2], _limits(kinematics, best[3]))


def _try(
    kinematics: Kinematics, probe: SampledPath, home: Array, spin: float, around: Around | None, most: float
) -> tuple[Array, int, dict[int, Array]] | None:
    """Joints (k, j) at the poses of `probe`, how many are bad, and seeds that had to be searched.

    None where more than `most` are bad: then nobody looks for how many.
    """
    X = probe.poses(spin)
    q = np.empty((len(X), len(home)))
    seeds: dict[int, Array] = {}
    bad, previous = 0, home
    for number, (a, b) in zip(probe.number, probe.chains, strict=True):
        poses, allowed = np.arange(a, b), most - bad
        q[a:b], faults = _from(kinematics, X, poses, previous, around, allowed + 1)
        if faults:
            for branch in kinematics.branches(X[a]):
                turned, count = _from(kinematics, X, poses, branch, around, min(faults, allowed + 1))
                if count < faults:
                    faults, q[a:b], seeds[number] = count, turned, branch
        if faults > allowed:
            return None
        bad += faults
        previous = q[b - 1]
    return q, bad, seeds


def _from(
    kinematics: Kinematics, X: Array, poses: NDArray[np.intp], seed: Array, around: Around | None, enough: float
) -> tuple[Array, int]:
    """Joints (k, j) at some `poses` (k,) of X, going on from `seed` (j,), and how many are bad; counted up to `enough`.

    What the arm hits takes far longer to find than its joints, so it is asked last, and only of poses that are good.
    """
    found, status = kinematics.inverse(X[poses], seed)
    good = np.flatnonzero(status == 0)
    count = len(poses) - len(good)
    for at in range(0, len(good) if around is not None else 0, _AT_ONCE):
        if count >= enough:
            break
        some = good[at : at + _AT_ONCE]
        assert around is not None
        count += int(np.count_nonzero(around.hit(np.ascontiguousarray(found[some]), poses[some])))
    return found, count


def _margin(kinematics: Kinematics, q: Array) -> float:
    """0 at a limit or singularity, 1 in comfort."""
    if not len(q):
        return 1.0
    joints = kinematics.joints
    to_limit = np.minimum(q - joints.lower, joints.upper - q).min()
    J = kinematics.jacobian(q[_spread(len(q), POSES // 3)]).copy()
    J[:, :3] /= 0.5
    regular = least_gains(J).min()
    return float(max(min(to_limit / COMFORT, regular / REGULAR, 1.0), 0.0))


def _limits(kinematics: Kinematics, q: Array) -> AxisLimits:
    """Speed and acceleration that the joints allow along x, y and z at most poses; used only to size corner arcs."""
    speed, acceleration = np.full(6, np.inf), np.full(6, np.inf)
    if not len(q):
        return AxisLimits(speed=speed, acceleration=acceleration)
    joints = kinematics.joints
    J = np.ascontiguousarray(kinematics.jacobian(q))
    unit = [np.tile(row, (len(q), 1)) for row in np.eye(3)]
    rates = [*joint_rates(J, unit[0], unit[1]), joint_rates(J, unit[2], unit[2])[0]]
    for axis, rate in enumerate(rates):
        size = np.maximum(np.abs(rate), 1e-12)
        speed[axis] = np.quantile(np.min(joints.speed / size, axis=1), _SHARP)
        acceleration[axis] = np.quantile(np.min(joints.acceleration / size, axis=1), _SHARP)
    return AxisLimits(speed=np.maximum(speed, 1e-3), acceleration=np.maximum(acceleration, 1e-2))


def _spread(count: int, most: int) -> NDArray[np.intp]:
    """Indices of at most `most` of `count` things, evenly spread, with both ends."""
    if count <= most:
        return np.arange(count)
    return distinct(np.rint(np.linspace(0, count - 1, most)).astype(np.intp))

"""A ladder of joint vectors for a cut: one rung for each pose, with all branches and spins within the limits."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos_sin
from gcodesim.arithmetic.matrices import inverse_pose, multiplied
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Indices, Joints
from gcodesim.planning.ladder_kernels import ENDLESS, LIMITED, LINEAR, SLACK, TURN, Ladder, Rails
from gcodesim.planning.obstacles import Around

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics

_MOST_TURNS: Final = 256  # vectors of whole turns that a search follows
_EXACTLY: Final = 1e-6  # of a turn, by which a range may exceed whole turns without making room for one more


@frozen(eq=False)
class Passage:
    """Poses of the tip that have to be reached one after the other without a jump.

    X_BT (n, 4, 4) at spin 0; X_FT (4, 4). `free`: the tool may be turned about its own axis, Z of T, by any angle at
    every pose. `step` (j,) is how far each joint may go from one pose to the next [rad, m], less than half a turn.
    `around`: what the arm may hit at the poses.
    """

    X_BT: Array
    X_FT: Array
    free: bool
    step: Array
    around: Around | None = None

    def __len__(self) -> int:
        return len(self.X_BT)

    def part(self, first: int, end: int) -> Passage:
        """Poses `first` to `end` (left out)."""
        return self.taken(slice(first, end))

    def taken(self, poses: slice) -> Passage:
        """Only some of the poses."""
        around = None if self.around is None else self.around.taken(poses)
        return replace(self, X_BT=self.X_BT[poses], around=around)

    def without_obstacles(self) -> Passage:
        """The same poses where nothing stands around."""
        return replace(self, around=None)

    def shifted(self, shift: Array) -> Passage:
        """The same with all positions, and what stands around and goes along, moved by `shift` (3,) [m] in B."""
        X_BT = self.X_BT.copy()
        X_BT[:, :3, 3] += shift
        return replace(self, X_BT=X_BT, around=None if self.around is None else self.around.shifted(shift))

    def flange(self, spins: Array) -> Array:
        """X_BF (n, s, 4, 4) with the tool turned by `spins` (n, s) [rad]."""
        n, s = spins.shape
        cosine, sine = cos_sin(spins)
        X = np.zeros((n, s, 4, 4))
        for k, (across, back) in enumerate(((cosine, -sine), (sine, cosine))):
            X[:, :, k, 0], X[:, :, k, 1] = across, back
        X[:, :, 2, 2] = X[:, :, 3, 3] = 1.0
        turned = X.reshape(-1, 4, 4)
        X_BT = np.repeat(self.X_BT, s, axis=0)
        flange: Array = multiplied(multiplied(X_BT, turned), inverse_pose(self.X_FT))
        return flange.reshape(n, s, 4, 4)


@frozen(kw_only=False, eq=False)
class Rungs:
    """A ladder; which spin each vector has (N,), and of each pose whether joints put the tool there at all (n,).

    `within` (n,): whether some of these are within limits, if what stands around is not asked.
    """

    ladder: Ladder
    spin: Array
    in_reach: NDArray[np.bool_]
    within: NDArray[np.bool_]

    @property
    def counts(self) -> Indices:
        """How many joint vectors within limits each pose has (n,)."""
        counts: Indices = np.diff(self.ladder.first)
        return counts

    def where(self, rails: Rails, kept: NDArray[np.bool_]) -> tuple[Rungs, Rails]:
        """The ladder with only the vectors that are `kept` (N,), and the rails between these."""
        number = np.cumsum(kept) - 1
        ends = np.repeat(np.arange(len(kept)), np.diff(rails.first))
        source = rails.source[: len(ends)]
        held = kept[source] & kept[ends]
        count = np.bincount(number[ends[held]], minlength=int(kept.sum())) if held.any() else np.zeros(int(kept.sum()))
        first = np.append(0, np.cumsum(count)).astype(np.int64)
        rails = Rails(first, number[source[held]], rails.shift[: len(ends)][held], rails.way[: len(ends)][held])
        rung = np.append(0, np.cumsum(kept))[self.ladder.first]
        ladder = self.ladder._replace(first=rung.astype(np.int64), q=np.ascontiguousarray(self.ladder.q[kept]))
        return replace(self, ladder=ladder, spin=self.spin[kept]), rails


def rungs_of(kinematics: Kinematics, cut: Passage, spins: Array, branches: tuple[int, ...] | None = None) -> Rungs:
    """The ladder of `cut` at `spins` (n, s) [rad]; `branches` keeps only those of a closed form."""
    n, s = spins.shape
    flange = cut.flange(spins).reshape(-1, 4, 4)
    q, exists = kinematics.branches_along(flange)
    if branches is not None:
        exists = exists & np.isin(np.arange(exists.shape[1]), branches)
    q, exists = q.reshape(n, -1, q.shape[-1]), exists.reshape(n, -1)
    joints = kinematics.joints
    kind, lower, upper, turns = turns_of(joints)
    low = np.where(kind == LIMITED, lower - SLACK, -0.5 * TURN)
    q = np.where(kind == LINEAR, q, q - TURN * np.floor((q - low) / TURN))
    inside = exists & np.all((kind == ENDLESS) | ((q >= lower - SLACK) & (q <= upper + SLACK)), axis=2)
    within: NDArray[np.bool_] = inside.any(axis=1)
    if cut.around is not None:
        inside[inside] = ~cut.around.hit(np.ascontiguousarray(q[inside]), np.nonzero(inside)[0])
    first = np.zeros(n + 1, dtype=np.int64)
    np.cumsum(inside.sum(axis=1), out=first[1:])
    ladder = Ladder(
        first=first,
        q=np.ascontiguousarray(q[inside]),
        lower=lower,
        upper=upper,
        kind=kind,
        turns=turns,
        whole=np.ascontiguousarray(np.array(list(np.ndindex(*turns)), dtype=np.int64)),
    )
    per_spin = inside.shape[1] // s
    spin = np.repeat(spins, per_spin, axis=1)[inside]
    in_reach: NDArray[np.bool_] = np.any(exists, axis=1)
    return Rungs(ladder, spin, in_reach, within)


def turns_of(joints: Joints) -> tuple[Indices, Array, Array, Indices]:
    """Kinds, limits and numbers of whole turns of joints, each (j,)."""
    linear = np.array([kind == "prismatic" for kind in joints.kinds])
    endless = ~linear & ~(np.isfinite(joints.lower) & np.isfinite(joints.upper))
    kind = np.where(linear, LINEAR, np.where(endless, ENDLESS, LIMITED)).astype(np.int64)
    lower = np.where(endless, -np.inf, joints.lower)
    upper = np.where(endless, np.inf, joints.upper)
    span = np.where(kind == LIMITED, joints.upper - joints.lower, TURN)
    turns = np.maximum(np.ceil(span / TURN - _EXACTLY), 1).astype(np.int64)
    while np.prod(turns) > _MOST_TURNS:  # the joints with most of them do without the last ones
        turns[np.argmax(turns)] -= 1
    return kind, lower, upper, turns

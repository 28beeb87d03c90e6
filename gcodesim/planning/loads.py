"""What the motors of an arm have to give along a path, and by how much it has to be slowed so that they can."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain, Inertial
from gcodesim.kinematics.dynamics import GRAVITY, inverse_dynamics

_SHARE: Final = 0.98  # of an effort limit; the rest is for what changes between the places that are looked at
_LEAST: Final = 1e-4  # of speed squared: slower than a hundredth nothing is run


@frozen(eq=False)
class Loads:
    """Masses on an arm: those of its `chain`, a payload among them, and of `tools` by number, in axes of F.

    `gravity` (3,) [m/s²] is in base axes. What the tool does to the work is not among them: no plan knows it.
    """

    chain: Chain
    gravity: Array = field(default_factory=lambda: np.array(GRAVITY))
    tools: Mapping[int, Inertial | None] = field(default_factory=dict)

    @property
    def limit(self) -> Array:
        """Effort limits (j,) [N·m, N]; infinite: none."""
        limit: Array = self.chain.driven_joints.effort
        return limit

    @property
    def matter(self) -> bool:
        """Whether there is a limit and a mass."""
        return bool(np.isfinite(self.limit).any()) and any(link.inertial is not None for link in self.chain.links)

    def efforts(
        self, tool: NDArray[np.int64], q: Array, *motions: tuple[Array | float, Array | float]
    ) -> tuple[Array, ...]:
        """Efforts (n, j) with `tool` (n,) on the flange at q (n, j), for each of several `motions` (qd, qdd)."""
        out = np.empty((len(q), len(motions), q.shape[1]))
        rates, changes = (
            np.stack([np.broadcast_to(values, q.shape) for values in kind], axis=1)
            for kind in zip(*motions, strict=True)
        )
        for number in distinct(tool).tolist():
            here = tool == number
            # motions through one place stand together: the kernel works out its frames once
            at = np.repeat(q[here], len(motions), axis=0)
            qd, qdd = rates[here].reshape(at.shape), changes[here].reshape(at.shape)
            payload = self.tools.get(number)
            found = inverse_dynamics(self.chain, at, qd, qdd, payload, gravity=self.gravity)
            out[here] = found.reshape(-1, *out.shape[1:])
        return tuple(np.ascontiguousarray(out[:, m]) for m in range(len(motions)))

    def slowing(self, piece: NDArray[np.int64], static: Array, *moved: Array) -> Slowing:
        """The share of speed squared and of acceleration that is allowed at n places, which are on `piece` (n,).

        Efforts (n, j) are `static` at rest and each of `moved` at full speed and acceleration. A motion that is slowed
        evenly by k in speed squared and in acceleration takes ``static + k (moved - static)``. Where rest alone is too
        much, nothing is gained by going slower.
        """
        limit = _SHARE * self.limit
        rows = np.arange(len(static))
        share, joint, most = np.ones(len(static)), np.full(len(static), -1), np.zeros(len(static))
        for efforts in moved:
            change = efforts - static
            room = np.where(change >= 0.0, limit - static, limit + static)
            with np.errstate(divide="ignore", invalid="ignore"):
                allowed = np.where((np.abs(efforts) > limit) & (room > 0.0), room / np.abs(change), 1.0)
            least = allowed.argmin(axis=1)
            value = allowed[rows, least]
            lower = value < share
            share, joint = np.where(lower, value, share), np.where(lower, least, joint)
            most = np.where(lower, np.abs(efforts[rows, least]), most)
        return Slowing(piece=piece, share=np.maximum(share, _LEAST), joint=joint, effort=most)


@frozen(kw_only=False, eq=False)
class Slowing:
    """At n places of `piece` (n,): the `share` (n,) of speed squared that motors allow, and for which `joint` (n,).

    -1: for none. `effort` (n,) [N·m, N] is what that joint would have to give otherwise.
    """

    piece: NDArray[np.int64]
    share: Array
    joint: NDArray[np.int64]
    effort: Array

    def at(self, places: NDArray[np.intp]) -> Slowing:
        """That of some of the places."""
        return Slowing(self.piece[places], self.share[places], self.joint[places], self.effort[places])

    @property
    def needed(self) -> Slowing:
        """That of the places where motors need it."""
        return self.at(np.flatnonzero(self.joint >= 0))

    @staticmethod
    def together(some: Sequence[Slowing]) -> Slowing:
        """All places of several."""
        none = Slowing(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros(0))
        columns = zip(*((s.piece, s.share, s.joint, s.effort) for s in (none, *some)), strict=True)
        return Slowing(*(np.concatenate(column) for column in columns))

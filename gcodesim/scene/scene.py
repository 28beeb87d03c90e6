"""The tree of frames: which frame stands in which, and where each one is while machines move.

A frame stands in the world, in another frame, or in a frame of a mover
(`arm/flange`, `machine/table`). Its parent changes by a `Hold` only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace

import numpy as np

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.frozen import frozen
from gcodesim.scene.body import Body
from gcodesim.scene.mover import Mover


@frozen(kw_only=False, eq=False)
class Stand:
    """Where a frame stands: at `X` of its `parent`."""

    parent: str
    X: Pose


@frozen(eq=False)
class Hold:
    """From `step` on the frame of `body` stands at `X` of `parent`; step 0 is the first row of the joints beside it."""

    step: int
    body: str
    parent: str
    X: Pose


@frozen(eq=False)
class Scene:
    """All frames by name, the movers on which they may depend, and the bodies that stand in them."""

    movers: Mapping[str, Mover]
    frames: Mapping[str, Stand] = field(default_factory=dict)
    bodies: tuple[Body, ...] = ()

    def with_frames(self, frames: Mapping[str, Stand]) -> Scene:
        """The scene with more frames, or with others of the same names."""
        return replace(self, frames={**self.frames, **frames})

    def track(self, frame: str, q: Mapping[str, Array], holds: Sequence[Hold] = ()) -> Array:
        """X_WF (n, 4, 4): where a frame is while the joints of each mover are at `q[mover]` (n, j).

        A mover that `q` does not name stands at home.
        """
        if not self._may_move(frame, holds):
            return _still(self.at_rest(frame), q)
        own = _holds_of(frame, holds)
        if own:
            return self._held(frame, q, holds, own)
        split = self._mover_of(frame)
        if split is not None:
            mover, link = split
            X: Array = multiplied(mover.X_WB.matrix, mover.seen_from_base(link, _joints(mover, q)))
            return X
        stand = self.frames[frame]
        return multiplied(self.track(stand.parent, q, holds), stand.X.matrix)

    def seen_from(self, base: str, frame: str, q: Mapping[str, Array], holds: Sequence[Hold] = ()) -> Array:
        """X_BF (n, 4, 4): a frame seen from the base B of the mover `base`."""
        mover = self.movers[base]
        if not self._may_move(frame, holds):
            return _still(mover.X_WB.inverse() @ self.at_rest(frame), q)
        if not holds:
            X = self._in_base(mover, frame, q)
            if X is not None:
                return X
        X_BF: Array = multiplied(mover.X_WB.inverse().matrix, self.track(frame, q, holds))
        return X_BF

    def moves(self, frame: str) -> bool:
        """Whether a joint of any mover moves the frame."""
        split = self._mover_of(frame)
        if split is not None:
            mover, link = split
            return mover.moves(link)
        return frame != WORLD and self.moves(self.frames[frame].parent)

    def at_rest(self, frame: str) -> Pose:
        """X_WF of a frame that does not move; of others with all movers at home."""
        if frame == WORLD:
            return Pose.identity()
        split = self._mover_of(frame)
        if split is not None:
            mover, link = split
            if link == mover.kinematics.chain.base_name:
                return mover.X_WB
            return mover.X_WB @ Pose.from_matrix(mover.seen_from_base(link, mover.home[None])[0])
        stand = self.frames[frame]
        return stand.X if stand.parent == WORLD else self.at_rest(stand.parent) @ stand.X

    def standing_on(self, frame: str) -> tuple[str, Pose]:
        """The frame of a mover, or the world, that carries a frame, and X of the frame in it."""
        if frame == WORLD or self._mover_of(frame) is not None:
            return frame, Pose.identity()
        stand = self.frames[frame]
        if stand.parent == WORLD or self._mover_of(stand.parent) is not None:
            return stand.parent, stand.X
        carrier, X = self.standing_on(stand.parent)
        return carrier, X @ stand.X

    def _mover_of(self, frame: str) -> tuple[Mover, str] | None:
        """The mover and its link if `frame` belongs to a mover."""
        name, slash, link = frame.partition("/")
        return (self.movers[name], link) if slash and name in self.movers and frame not in self.frames else None

    def _may_move(self, frame: str, holds: Sequence[Hold]) -> bool:
        """Whether the rows of a track may differ; a link that no joint carries counts as moving."""
        if frame == WORLD:
            return False
        if _holds_of(frame, holds):
            return True
        split = self._mover_of(frame)
        if split is not None:
            return split[1] != split[0].kinematics.chain.base_name
        return self._may_move(self.frames[frame].parent, holds)

    def _in_base(self, mover: Mover, frame: str, q: Mapping[str, Array]) -> Array | None:
        """X_BF of a frame that stands on `mover`; None when it stands on another one."""
        split = self._mover_of(frame)
        if split is not None:
            return mover.seen_from_base(split[1], _joints(mover, q)) if split[0] is mover else None
        stand = self.frames[frame]
        X_BP = self._in_base(mover, stand.parent, q) if stand.parent != WORLD else None
        if X_BP is None:
            return None
        X: Array = multiplied(X_BP, stand.X.matrix)
        return X

    def _held(self, frame: str, q: Mapping[str, Array], holds: Sequence[Hold], own: Sequence[Hold]) -> Array:
        """The track of a frame whose parent changes."""
        others = [hold for hold in holds if hold.body != frame]
        count = _count(q)
        X = np.tile(np.eye(4), (count, 1, 1))
        first = max(own[0].step, 0)
        if first:
            X[:first] = self.track(frame, _rows(q, 0, first), others)
        for hold, end in zip(own, [*(h.step for h in own[1:]), count], strict=True):
            begin, end = max(hold.step, 0), min(max(end, 0), count)
            if begin < end:
                shifted = [replace(other, step=other.step - begin) for other in others]
                X[begin:end] = multiplied(self.track(hold.parent, _rows(q, begin, end), shifted), hold.X.matrix)
        return X


def _holds_of(frame: str, holds: Sequence[Hold]) -> list[Hold]:
    return sorted((hold for hold in holds if hold.body == frame), key=lambda hold: hold.step)


def _count(q: Mapping[str, Array]) -> int:
    return len(next(iter(q.values())))


def _joints(mover: Mover, q: Mapping[str, Array]) -> Array:
    """Joints (n, j) of a mover; its home where nothing moves it."""
    return q[mover.name] if mover.name in q else np.tile(mover.home, (_count(q), 1))


def _rows(q: Mapping[str, Array], begin: int, end: int) -> dict[str, Array]:
    return {name: joints[begin:end] for name, joints in q.items()}


def _still(X: Pose, q: Mapping[str, Array]) -> Array:
    return np.tile(X.matrix, (_count(q), 1, 1))

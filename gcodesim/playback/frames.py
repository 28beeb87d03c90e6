"""Where every frame of a log stands in the world."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.frames import rotation_from_quaternion
from gcodesim.frozen import frozen
from gcodesim.log.series import Series

Array = NDArray[np.float64]

_PREFIX = "transforms["


@frozen(kw_only=False, eq=False)
class RecordedFrames:
    """Frames over n instants `t_ns` (n,): each has a parent and poses (n or 1, 4, 4) in it, 1 when it stands still."""

    t_ns: NDArray[np.int64]
    parents: dict[str, str]
    poses: dict[str, Array]

    @staticmethod
    def of(static: Any, moving: Series) -> RecordedFrames:
        """From the message of `/tf_static` (None: there is none) and the columns of `/tf`."""
        parents: dict[str, str] = {}
        poses: dict[str, Array] = {}
        for one in static.transforms if static is not None else ():
            p, q = one.translation, one.rotation
            parents[one.child_frame_id] = one.parent_frame_id
            poses[one.child_frame_id] = _matrices(np.array([[p.x, p.y, p.z]]), np.array([[q.x, q.y, q.z, q.w]]))
        for name, parent in moving.texts.items():
            if name.endswith("].parent_frame_id") and parent:
                item = name[: -len("parent_frame_id")]
                child = item[len(_PREFIX) : -2]
                parents[child] = parent[0]
                p = moving.columns(*(f"{item}translation.{axis}" for axis in "xyz"))
                q = moving.columns(*(f"{item}rotation.{axis}" for axis in "xyzw"))
                poses[child] = _matrices(p, q)
        return RecordedFrames(moving.t_ns, parents, poses)

    def joined(self, other: RecordedFrames) -> RecordedFrames:
        """These frames and those of another channel, which were recorded at the same times."""
        if len(other.t_ns) != len(self.t_ns):  # a part of the log is missing
            return self
        return RecordedFrames(self.t_ns, {**self.parents, **other.parents}, {**self.poses, **other.poses})

    def in_world(self, frame: str) -> Array:
        """X_WF (n or 1, 4, 4) of a frame; one that the log does not have is at the origin of the world."""
        X = np.eye(4)[None]
        while frame in self.poses:
            X = multiplied(self.poses[frame], X)
            frame = self.parents[frame]
        return X

    def at(self, frame: str, t_ns: int) -> Array:
        """X_WF (4, 4) at the last instant not after `t_ns`."""
        X = self.in_world(frame)
        index = max(int(np.searchsorted(self.t_ns, t_ns, side="right")) - 1, 0)
        pose: Array = X[min(index, len(X) - 1)]
        return pose


def _matrices(p: Array, q: Array) -> Array:
    q = np.where(q.any(axis=1, keepdims=True), q, [0.0, 0.0, 0.0, 1.0])
    X = np.zeros((len(p), 4, 4))
    X[:, :3, :3] = rotation_from_quaternion(q)
    X[:, :3, 3] = p
    X[:, 3, 3] = 1.0
    return X

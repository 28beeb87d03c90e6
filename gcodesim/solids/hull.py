"""A convex body in the form that collision checks need."""

from __future__ import annotations

from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen


@frozen(kw_only=False, eq=False)
class Hull:
    """A convex body: hull of `corners` (k, 3) [m], with `normals` (m, 3) of its faces."""

    corners: Array
    normals: Array

    def at(self, X: Pose) -> Hull:
        """The same body with its frame at `X`."""
        return Hull(X.apply(self.corners), X.rotate(self.normals))

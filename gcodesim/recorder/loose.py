"""Pieces that came loose, as the log draws them: on their way down, and where they lie."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from gcodesim.frames import WORLD, Pose
from gcodesim.log import DrawnMesh, Entity
from gcodesim.recorder.frames import Frames
from gcodesim.scene.colors import CUT

if TYPE_CHECKING:
    from gcodesim.executor.loose_bodies import LooseBody

PERIOD_NS: Final = 40_000_000
"""A piece that falls is drawn this often."""


class LoosePieces:
    """The pieces of a run so far; a tick lasts `step_ns`."""

    def __init__(self, frames: Frames, step_ns: int) -> None:
        self._frames, self._step_ns = frames, step_ns
        self._bodies: list[LooseBody] = []
        self._drawn_ns = -1
        self._late = False

    def add(self, body: LooseBody) -> None:
        """Draw a piece, too. What was drawn before stays, so one that comes late is drawn from the next call on."""
        self._bodies.append(body)
        self._late |= body.begin * self._step_ns <= self._drawn_ns

    def until(self, t_ns: int) -> Iterator[tuple[int, list[Entity]]]:
        """Everything that is drawn from the last call on up to `t_ns`, whenever it changes."""
        times = {at for body in self._bodies for at in self._changes(body) if self._drawn_ns < at <= t_ns}
        if self._late:
            times.add(min(self._drawn_ns + 1, t_ns))
        self._drawn_ns, self._late = t_ns, False
        for at in sorted(times):
            yield at, [self._entity(body, at) for body in self._bodies if body.begin * self._step_ns <= at]

    def _changes(self, body: LooseBody) -> Iterator[int]:
        """Times [ns] at which a piece is drawn anew."""
        ticks = max(PERIOD_NS // self._step_ns, 1)
        yield from (tick * self._step_ns for tick in range(body.begin, body.end, ticks))
        yield body.end * self._step_ns

    def _entity(self, body: LooseBody, t_ns: int) -> Entity:
        X_WP = body.at(t_ns // self._step_ns)
        frame, X = self._carrier(body) if X_WP is None else (WORLD, Pose.from_matrix(X_WP))
        points, triangles = body.skin.points, body.skin.faces
        drawn = DrawnMesh(points=points, triangles=triangles, p=X.p, q=X.q, color=CUT)
        return Entity(id=body.name, frame=frame, shapes=(drawn,))

    def _carrier(self, body: LooseBody) -> tuple[str, Pose]:
        """The frame of the log with which a piece goes that lies, and where it is in it."""
        if body.parent == WORLD:
            return WORLD, body.X
        frame, X = self._frames.carrier(body.parent)
        return frame, X @ body.X

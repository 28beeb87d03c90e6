"""When what findings tell of happens: places on a path that get their time once the time law is known."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from gcodesim.diagnostics import Diagnostic, Findings
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.trajectory import Trajectory

if TYPE_CHECKING:
    from gcodesim.planning.plan import JointPath

_LOOKS: Final = 256  # at a row, for where a joint passes its limit
_HALVINGS: Final = 50  # of a time, down to its last place
_SLACK: Final = 1e-9  # [m, rad] beyond a limit that are rounding


class PathMoment(Protocol):
    """A place on a path, or what happens on it."""

    def time(self, trajectory: Trajectory, joints: JointPath) -> float:
        """When [s] the machine is there first."""
        ...


@frozen(kw_only=False)
class OnBlock:
    """Where a block begins, by the number of its rows: posings put rows of their own between them."""

    block: int

    def time(self, trajectory: Trajectory, joints: JointPath) -> float:
        del joints
        return _times_of(trajectory, self.block)[0]


@frozen(kw_only=False)
class OnPiece:
    """At `s` [m, rad, s] of a piece; its end, where that is more than its length.

    A corner between two rows counts for the later one, from where that begins.
    """

    piece: int
    s: float

    def time(self, trajectory: Trajectory, joints: JointPath) -> float:
        del joints
        p = trajectory.phases
        earliest = float(trajectory.row_start[trajectory.pieces.row_last[self.piece]])
        own = np.flatnonzero((p.piece == self.piece) & (p.event < 0))
        if not len(own):
            return earliest
        s = min(self.s, float(trajectory.pieces.length[self.piece]))
        k = int(own[max(int(np.searchsorted(p.s[own], s, side="right")) - 1, 0)])
        begin, speed, change, jerk = (float(column[k]) for column in (p.s, p.speed, p.acceleration, p.jerk))
        low, high = 0.0, float(p.duration[k])
        for _ in range(_HALVINGS):
            t = 0.5 * (low + high)
            if begin + t * (speed + t * (0.5 * change + t * jerk / 6.0)) < s:
                low = t
            else:
                high = t
        return max(float(p.time[k]) + high, earliest)


@frozen(kw_only=False)
class LimitPassing:
    """Where a joint goes beyond its `limit` [m, rad] in a block: above it with a `sign` of 1, below it with -1.

    In a block that stays within, since its corner is cut, this is where it comes nearest.
    """

    block: int
    joint: int
    limit: float
    sign: float

    def time(self, trajectory: Trajectory, joints: JointPath) -> float:
        begin, end = _times_of(trajectory, self.block)
        times = np.linspace(begin, end, _LOOKS)

        def beyond(t: Array) -> Array:
            away: Array = self.sign * (joints.joints(trajectory.sample(t))[:, self.joint] - self.limit) - _SLACK
            return away

        away = beyond(times)
        first = int(np.argmax(away > 0.0))
        if away[first] <= 0.0:
            return float(times[int(np.argmax(away))])
        if first == 0:
            return begin
        low, high = float(times[first - 1]), float(times[first])
        for _ in range(_HALVINGS):
            t = 0.5 * (low + high)
            if beyond(np.array([t]))[0] > 0.0:
                high = t
            else:
                low = t
        return high


def _times_of(trajectory: Trajectory, block: int) -> tuple[float, float]:
    """When [s] the first row of a block begins and its last one ends."""
    own = np.flatnonzero(trajectory.path.block == block)
    return float(trajectory.row_start[own[0]]), float(trajectory.row_end[own[-1]])


@dataclass(slots=True)
class PathFindings(Findings):
    """Findings about a path that has no times yet."""

    _moments: dict[tuple[object, ...], PathMoment] = field(default_factory=dict)

    def add(self, finding: Diagnostic, *, key: tuple[object, ...] | None = None, at: PathMoment | None = None) -> None:
        """Add `finding`, which happens `at` a moment; None: where its block begins. Of those with one key the first
        counts.
        """
        key = key or (finding.code, finding.message, finding.span)
        if at is not None and key not in self._items:
            self._moments[key] = at
        Findings.add(self, finding, key=key)

    def timed(self, trajectory: Trajectory, joints: JointPath) -> Findings:
        """The same findings, each with the time [s] at which it happens."""
        out, path = Findings(), trajectory.path
        for key, finding in sorted(self._items.items(), key=lambda item: item[1].order):
            time, moment = finding.time, self._moments.get(key)
            if time is None and moment is not None:
                time = moment.time(trajectory, joints)
            elif time is None and finding.span in path.spans:
                row = int(np.argmax(path.source == path.spans.index(finding.span)))
                time = float(trajectory.row_start[row])
            elif time is None:
                time = next((timed.time for timed in trajectory.events if timed.event.span == finding.span), None)
            out.add(replace(finding, time=time))
        return out

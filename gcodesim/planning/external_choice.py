"""Where external axes stand that the planner may choose, along the whole path of an arm.

The same search as over configurations: a ladder whose rungs hold, for some poses of the path, all branches and spins of
the arm at all places of those axes on a grid. The best way through it keeps the joints of the arm from their limits and
moves everything evenly; its places are smoothed, and the arm's own search then has them as given.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.planning.configuration import way_with
from gcodesim.planning.flange_poses import flange_poses, turned, unbent
from gcodesim.planning.guide import CHOSEN, Guide, Outside
from gcodesim.planning.ladder import Rungs, turns_of
from gcodesim.planning.ladder_kernels import ENDLESS, LIMITED, LINEAR, SLACK, TURN, Ladder, link, widest
from gcodesim.planning.obstacles import Numbers, Obstacles
from gcodesim.planning.spin_along import SpinAlong

if TYPE_CHECKING:
    from gcodesim.motion.pieces import Pieces
    from gcodesim.motion.tool_path import ToolPath
    from gcodesim.planning.spin_choice import SampledPath

_RUNGS: Final = 40  # of all chains together
_FEWEST: Final = 3  # of one chain
_SPINS: Final = 12  # all around, where the tool is free
_PLACES: Final = (0, 13, 7, 5, 4, 3, 3)  # on the grid of each axis, by how many are chosen
_MORE_PLACES: Final = (0, 25, 17, 5, 4, 3, 3)  # the same where ways between those do not lead through
_SHORT: Final = 0.35  # [rad, m] that an axis may go from rung to rung then, where a step of the grid is more
_FINER: Final = (0.5, 0.25)  # of a step of the grid, in the refinements
_ROOM: Final = 0.25  # [rad] from limits beyond which more is no better
_WIDE: Final = 2.5  # [rad] that a joint may turn between two rungs: these are far apart
_EDGE: Final = 1e-4  # of its travel that an axis stays away from its ends: a spline swings a little beyond its knots
_FAR: Final = 1e3  # limits of an external axis in the ladder: its grid lies inside its travel
_SMOOTHING: Final = 6


@frozen(kw_only=False, eq=False)
class ChosenPlaces:
    """Values (k, e) of all external axes at places of the path, each at `share` (k,) of its chain.

    `knots` are those that were chosen, for each chain with a `number`; values between them are interpolated.
    """

    values: Array
    share: Array
    knots: list[NDArray[np.int64]]
    number: list[int]

    def along(self, outside: Outside, pieces: Pieces, heads: NDArray[np.intp]) -> Outside:
        """`outside` with splines through these places; `heads` are the pieces with which chains begin."""
        fixed = np.append(np.flatnonzero(pieces.fixed), len(pieces))
        ends = fixed[np.searchsorted(fixed, heads, side="right")]
        places: list[NDArray[np.int64]] = []
        ways: list[Array] = []
        values: list[Array] = []
        last = self.values[0]
        for chain, (head, end) in enumerate(zip(heads, ends, strict=True)):
            if chain in self.number:
                knots = self.knots[self.number.index(chain)]
                share, own = self.share[knots], self.values[knots]
            else:
                share, own = np.zeros(1), last[None]
            last = own[-1]
            piece, s = _on_pieces(pieces, int(head), int(end), share)
            places.append(piece)
            ways.append(s)
            values.append(own)
        soft = bool(np.isfinite(outside.assembly.joints.jerk).any())
        splines = tuple(
            SpinAlong.through(pieces, places, ways, [own[:, axis] for own in values], soft=soft)
            if column == CHOSEN
            else None
            for axis, column in enumerate(outside.columns)
        )
        return Outside(assembly=outside.assembly, columns=outside.columns, rest=outside.rest, along=splines)


def _on_pieces(pieces: Pieces, head: int, end: int, share: Array) -> tuple[NDArray[np.int64], Array]:
    """Piece and s at shares (k,) of a chain, from the joint move `head` to the piece before `end`."""
    if end == head + 1:
        return np.full(len(share), head, dtype=np.int64), np.zeros(len(share))
    bounds = np.concatenate([[0.0], np.cumsum(pieces.length[head + 1 : end])])
    way = share * bounds[-1]
    at = np.clip(np.searchsorted(bounds, way, side="right") - 1, 0, end - head - 2)
    s: Array = np.clip(way - bounds[at], 0.0, pieces.length[head + 1 + at])
    return (head + 1 + at).astype(np.int64), s


def choose_places(
    path: ToolPath,
    probe: SampledPath,
    guide: Guide,
    *,
    spin: float | None,
    home: Array,
    held: bool,
    branches: tuple[int, ...] | None,
    obstacles: Obstacles | None = None,
) -> ChosenPlaces:
    """Places for the poses of `probe`, whose origins and axes are in the work.

    `home` (j,) is where all joints stand first; with `held` the chosen axes begin there. They keep clear of `obstacles`
    where they can.
    """
    outside = guide.outside
    assert outside is not None
    values, tools = _commanded(path, probe, outside)
    share = np.zeros(len(values))
    knots: list[NDArray[np.int64]] = []
    before = home[outside.assembly.externals], home[outside.assembly.own]
    for k, (a, b) in enumerate(probe.chains):
        share[a:b] = _shares(path, probe.row[a:b], probe.share[a:b])
        chosen = _rungs_between(a, b, len(values))
        found, own = None, values
        for avoided, finely in product(dict.fromkeys((obstacles, None)), (False, True)):
            search = _Search(probe, guide, values, chosen, spin, branches, avoided, tools, finely=finely)
            tried = search.best(before, pinned=held and k == 0)
            if tried is None:
                continue
            along = values.copy()
            for axis in np.flatnonzero(outside.columns == CHOSEN):
                along[a:b, axis] = np.interp(share[a:b], share[chosen], tried[0][:, axis])
            every = _Search(probe, guide, along, np.arange(a, b), spin, branches, None, tools)
            leads = every.reaches_all()
            if found is None or leads:
                found, own = tried, along
            if leads:
                break
        knots.append(chosen if found is not None else chosen[:1])
        if found is None:
            continue  # what the arm does not reach from anywhere is told by its own search
        values = own
        before = values[b - 1], found[1][-1]
    return ChosenPlaces(values, share, knots, probe.number)


def _commanded(path: ToolPath, probe: SampledPath, outside: Outside) -> tuple[Array, NDArray[np.int64]]:
    """Values (k, e) of the external axes at the poses of `probe` as far as words command them, and the tools (k,)."""
    words = path.start[probe.row] + probe.share[:, None] * (path.end[probe.row] - path.start[probe.row])
    numbers = np.array([state.tool for state in path.states], dtype=np.int64)
    return outside.commanded(words), numbers[path.state[probe.row]]


def _rungs_between(first: int, end: int, total: int) -> NDArray[np.int64]:
    """Which of the poses from `first` to the one before `end`, of `total` ones, are the rungs of their chain."""
    count = max(_RUNGS * (end - first) // max(total, 1), _FEWEST)
    return distinct(np.rint(np.linspace(first, end - 1, count)).astype(np.int64))


@frozen(eq=False)
class OutsideCut:
    """One chain of a path of an arm with external axes, wherever those that are free may stand."""

    probe: SampledPath
    guide: Guide
    values: Array
    chosen: NDArray[np.int64]
    spin: float | None
    branches: tuple[int, ...] | None
    obstacles: Obstacles | None
    tools: NDArray[np.int64]

    @staticmethod
    def of(
        path: ToolPath,
        probe: SampledPath,
        guide: Guide,
        *,
        spin: float | None,
        branches: tuple[int, ...] | None,
        obstacles: Obstacles | None,
    ) -> list[OutsideCut]:
        """All chains of `path`; origins and axes of `probe` are in the work."""
        assert guide.outside is not None
        values, tools = _commanded(path, probe, guide.outside)
        return [
            OutsideCut(
                probe=probe,
                guide=guide,
                values=values,
                chosen=_rungs_between(a, b, len(values)),
                spin=spin,
                branches=branches,
                obstacles=obstacles,
                tools=tools,
            )
            for a, b in probe.chains
        ]

    def margin(self, shift: Array) -> float:
        """The most room [rad] of the joints of the arm to their limits with the work shifted by (3,) [m] in B.

        Negative: there is no way.
        """
        probe = replace(self.probe, p_BO=self.probe.p_BO + shift)
        obstacles = None if self.obstacles is None else self.obstacles.shifted(shift)
        return _Search(
            probe, self.guide, self.values, self.chosen, self.spin, self.branches, obstacles, self.tools
        ).room()


def _shares(path: ToolPath, row: NDArray[np.intp], share: Array) -> Array:
    """How much of a chain is done at shares of rows (k,), the first of which is its joint move."""
    lengths = np.maximum(path.length, 1e-12)
    first, last = int(row[0]) + 1, int(row[-1])
    if last < first:
        return np.zeros(len(row))
    before = np.concatenate([[0.0], np.cumsum(lengths[first : last + 1])])
    done = np.where(row < first, 0.0, before[np.maximum(row - first, 0)] + share * lengths[row])
    shares: Array = np.clip(done / before[-1], 0.0, 1.0)
    return shares


class _Search:
    """One chain: the poses `chosen` of a sampled path, and everything that the arm can do there."""

    def __init__(
        self,
        probe: SampledPath,
        guide: Guide,
        values: Array,
        chosen: NDArray[np.int64],
        spin: float | None,
        branches: tuple[int, ...] | None,
        obstacles: Obstacles | None,
        tools: Numbers,
        *,
        finely: bool = False,
    ) -> None:
        assert guide.outside is not None
        self.guide, self.outside, self.branches = guide, guide.outside, branches
        self.obstacles, self.tools = obstacles, tools[chosen]
        self.rows = probe.row[chosen]
        self.p, self.R = probe.p_BO[chosen], probe.R_BO[chosen]
        self.bend = None if probe.bend is None else probe.bend[chosen]
        self.values = values[chosen]
        self.spins = TURN * np.arange(_SPINS) / _SPINS if spin is None else np.array([spin])
        self.free = np.flatnonzero(self.outside.columns == CHOSEN)
        joints = self.outside.assembly.joints.part(self.outside.assembly.externals[self.free])
        self.low = np.where(np.isfinite(joints.lower), joints.lower, -0.5 * TURN)
        self.high = np.where(np.isfinite(joints.upper), joints.upper, 0.5 * TURN)
        self.count = (_MORE_PLACES if finely else _PLACES)[len(self.free)]
        self.step = (self.high - self.low) / (self.count - 1)
        self.far = np.minimum(self.step, _SHORT) if finely else self.step

    def best(self, before: tuple[Array, Array], *, pinned: bool) -> tuple[Array, Array] | None:
        """Values (r, e) of the external axes and joints (r, j) of the arm; None: there is no way."""
        tried = self._everywhere()
        found = None
        for finer in (1.0, *_FINER):
            if found is not None:
                near = finer * self.step * np.array(list(product((-1, 0, 1), repeat=len(self.free))))
                tried = np.clip(found[0][:, None, self.free] + near, self.low, self.high)
            if pinned:
                tried[0] = before[0][self.free]
            found = self._through(tried, before)
            if found is None:
                return None
        assert found is not None
        places, q = found
        for _ in range(_SMOOTHING):
            places[1:-1] = 0.25 * places[:-2] + 0.5 * places[1:-1] + 0.25 * places[2:]
        first, edge = int(pinned), _EDGE * (self.high - self.low)
        places[first:, self.free] = np.clip(places[first:, self.free], self.low + edge, self.high - edge)
        return places, q

    def reaches_all(self) -> bool:
        """Whether the arm reaches all poses with external axes where their values have them."""
        rungs, _ = self._rungs(self.values[:, None, self.free])
        return bool(rungs.counts.all())

    def room(self) -> float:
        """The most room [rad] to limits of the arm on the grid of places; negative where there is no way."""
        rungs, values = self._rungs(self._everywhere())
        if not rungs.counts.all():
            return -1.0
        return float(widest(rungs.ladder, link(rungs.ladder, self._bound(rungs, values), True)))

    def _everywhere(self) -> Array:
        """All places of the chosen axes on the grid, for each rung (r, c, f)."""
        grid = np.array(
            list(product(*(np.linspace(a, b, self.count) for a, b in zip(self.low, self.high, strict=True))))
        )
        return np.tile(grid, (len(self.rows), 1, 1))

    def _bound(self, rungs: Rungs, values: Array) -> Array:
        """How far each joint may go from rung to rung."""
        e = values.shape[1]
        return np.concatenate([2.5 * self._apart(), np.full(rungs.ladder.q.shape[1] - e, _WIDE)])

    def _through(self, tried: Array, before: tuple[Array, Array]) -> tuple[Array, Array] | None:
        """The best way with the chosen axes at one of the places `tried` (r, c, f) in each rung."""
        rungs, values = self._rungs(tried)
        if not rungs.counts.all():
            return None
        e = values.shape[1]
        rails = link(rungs.ladder, self._bound(rungs, values), True)
        best = widest(rungs.ladder, rails)
        if best < 0.0:
            return None
        way = way_with(rungs, rails, min(0.98 * best, _ROOM), np.concatenate([before[0], before[1]]))
        return way.q[:, :e], way.q[:, e:]

    def _apart(self) -> Array:
        """How far external axes (e,) may go from rung to rung: some steps of the grid, and what is commanded."""
        apart = np.abs(np.diff(self.values, axis=0)).max(axis=0, initial=0.0) + 1e-9
        apart[self.free] = self.far
        bound: Array = apart
        return bound

    def _rungs(self, tried: Array) -> tuple[Rungs, Array]:
        assembly = self.outside.assembly
        arm = assembly.arm
        r, c = tried.shape[:2]
        s = len(self.spins)
        values = np.repeat(self.values, c, axis=0)
        values[:, self.free] = tried.reshape(r * c, len(self.free))
        row = np.repeat(self.rows, c)
        p, R = self.guide.from_arm(np.repeat(self.p, c, axis=0), np.repeat(self.R, c, axis=0), row, values)
        X = np.repeat(flange_poses(p, R, 0.0), s, axis=0)
        bend = None if self.bend is None else np.repeat(np.repeat(self.bend, c, axis=0), s, axis=0)
        q, exists = arm.branches_along(unbent(turned(X, np.tile(self.spins, r * c)), bend))
        if self.branches is not None:
            exists = exists & np.isin(np.arange(exists.shape[1]), self.branches)
        kind, lower, upper, turns = turns_of(arm.joints)
        low = np.where(kind == LIMITED, lower - SLACK, -0.5 * TURN)
        q = np.where(kind == LINEAR, q, q - TURN * np.floor((q - low) / TURN))
        inside = exists & np.all((kind == ENDLESS) | ((q >= lower - SLACK) & (q <= upper + SLACK)), axis=2)
        e = values.shape[1]
        whole = np.array(list(np.ndindex(*turns)), dtype=np.int64)
        every = np.repeat(np.repeat(values, s, axis=0)[:, None], q.shape[1], axis=1)
        joined = np.concatenate([every, q], axis=2).reshape(r, -1, e + q.shape[2])
        within = inside.reshape(r, -1).any(axis=1)
        if self.obstacles is not None:
            every_joint = assembly.together(q[inside], every[inside])
            pose = np.nonzero(inside)[0] // (c * s)
            inside[inside] = ~self.obstacles.hit(every_joint, self.tools[pose])
        here = inside.reshape(r, -1)
        first = np.zeros(r + 1, dtype=np.int64)
        np.cumsum(here.sum(axis=1), out=first[1:])
        ladder = Ladder(
            first=first,
            q=np.ascontiguousarray(joined[here]),
            lower=np.concatenate([np.full(e, -_FAR), lower]),
            upper=np.concatenate([np.full(e, _FAR), upper]),
            kind=np.concatenate([np.full(e, LINEAR, dtype=np.int64), kind]),
            turns=np.concatenate([np.ones(e, dtype=np.int64), turns]),
            whole=np.ascontiguousarray(np.concatenate([np.zeros((len(whole), e), dtype=np.int64), whole], axis=1)),
        )
        spin = np.broadcast_to(self.spins[None, :, None], (r * c, s, q.shape[1])).reshape(r, -1)[here]
        return Rungs(ladder, spin, np.any(exists.reshape(r, -1), axis=1), within), values

"""When bodies of a cell meet that no single machine carries: parts, devices, and machines beside each other.

The time of a run is divided where a part is taken or let go and where a tool is changed. In between, what stands on
what is fixed, and `meetings` looks at the whole way in one search.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import applied
from gcodesim.checks.cell_bodies import CellBodies, CellBody
from gcodesim.checks.meetings import TOUCH, JointWay, Meeting, MovingBodies
from gcodesim.checks.pairs import pairs_by_kind
from gcodesim.checks.timed_way import TimedWay
from gcodesim.checks.way_kernels import JointTree
from gcodesim.frames import Array, Pose
from gcodesim.kinematics.chain import Tree
from gcodesim.scene import PUT, Stay

WANTED: Final = 0.5e-3
"""How deep [m] bodies may be in each other that are meant to touch: a part in what it stands on, a clamp in a part."""

AT_ONCE: Final = 2048
"""Nodes of a way at which places of bodies are kept at a time."""

Flags = NDArray[np.bool_]
Pairs = NDArray[np.int64]

_LYING: Final = frozenset(("part", "obstacle", "fixture", "stock"))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CellMeeting:
    """Two bodies, when they meet first and when they are deepest in each other (times [s]); `gap` [m] as in `Meeting`.

    `held` are the parts of both that somebody holds then, by their frames, with who does.
    """

    one: CellBody
    other: CellBody
    begin: float
    deepest: float
    gap: float
    held: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mounted:
    """From `begin` to `end` [s] a mover has this tool."""

    mover: str
    tool: int
    begin: float
    end: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Docking:
    """From `begin` to `end` [s] the flange of a mover comes to the tool in its stand, or leaves it there."""

    mover: str
    tool: int
    begin: float
    end: float


def may_meet(one: CellBody, other: CellBody, grippers: Collection[int]) -> bool:
    """Whether a meeting of two bodies is looked for here; see `MachineChecks` for those of one machine.

    Grippers are no bodies of revolution, and do not keep their shape: what they do to fixtures is looked for here, too.
    """
    roles = {one.role, other.role}
    if "loose" in roles:  # what it lies on, or beside, is found out when it falls
        return bool(roles & {"link", "tool", "holder"})
    if one.stand or other.stand:
        return not roles <= {"fixture", "stock"}
    if roles & {"part", "obstacle"}:
        return True
    if "fixture" in roles and (one.tool in grippers or other.tool in grippers):
        return True
    if not one.mover or not other.mover or one.mover == other.mover:
        return False
    return not ("stock" in roles and roles & {"tool", "stock"})  # a tool works there


def wanted(
    one: CellBody, other: CellBody, grippers: Mapping[int, float], grain: Mapping[str, float] | None = None
) -> float:
    """How deep [m] these may be in each other in any case.

    `grippers` says how far their contacts give, `grain` how exactly the shapes of loose pieces are known.
    """
    roles = {one.role, other.role}
    if "loose" in roles:
        return max((grain or {}).get(body.frame, TOUCH) for body in (one, other))
    if "part" in roles:
        for body in (one, other):
            if body.tool in grippers:
                return max(WANTED, grippers[body.tool])
    if "obstacle" in roles and roles <= _LYING:
        return WANTED
    return TOUCH


@dataclass(frozen=True, eq=False)
class CellSearch:
    """What meets in a cell while its joints go along `way`, with parts and tools where they are.

    `grippers` are the tools that hold parts, and by how much [m] their contacts give. Bodies whose names are `apart`
    as a pair are not checked against each other. `grain` [m] is how exactly the shapes of loose pieces are known, by
    their frames. Who tells of several meetings by the first of them says by `keys` which belong together; how deep
    bodies come in each other is found out for the first of each key only, and `gap` of the others is that at their
    beginning.
    """

    cell: CellBodies
    way: TimedWay
    stays: Sequence[Stay]
    mounted: Sequence[Mounted]
    grippers: Mapping[int, float]
    clearance: float | None = None
    dockings: Sequence[Docking] = ()
    apart: frozenset[frozenset[str]] = frozenset()
    grain: Mapping[str, float] = field(default_factory=dict)
    keys: Callable[[Sequence[CellMeeting]], Sequence[Hashable]] | None = None
    overlaps: list[tuple[CellBody, CellBody, float]] = field(default_factory=list)
    """Lying things that are drawn in each other, and since when [s]: they are not checked against each other."""

    def meetings(self) -> list[CellMeeting]:
        """Every collision, in the order of time; then `overlaps` is known as well."""
        return self._found(None)

    def near_misses(self) -> list[CellMeeting]:
        """Every time that two bodies come nearer than the clearance and do not meet."""
        return [] if self.clearance is None else self._found(self.clearance)

    # ---- pairs

    @cached_property
    def pairs(self) -> Pairs:
        """Bodies that may not meet, as pairs (p, 2)."""
        bodies, apart = self.cell.bodies, self.apart
        kinds = [(body.role, body.mover, body.tool, body.stand) for body in bodies]
        found = pairs_by_kind(kinds, lambda i, j: may_meet(bodies[i], bodies[j], self.grippers))
        if apart:
            found = [(i, j) for i, j in found if frozenset((bodies[i].rigid.name, bodies[j].rigid.name)) not in apart]
        return np.array(found, dtype=np.int64).reshape(-1, 2)

    @cached_property
    def _depth(self) -> Array:
        """How deep (p,) [m] the bodies of each pair may be in each other."""
        bodies = self.cell.bodies
        return np.array([wanted(bodies[i], bodies[j], self.grippers, self.grain) for i, j in self.pairs.tolist()])

    @cached_property
    def _lying(self) -> Flags:
        """Whether (p,) neither body of a pair belongs to a machine."""
        lies = np.array([body.role in _LYING and not body.tool for body in self.cell.bodies], dtype=bool)
        both: Flags = np.all(lies[self.pairs], axis=1)
        return both

    # ---- phases

    def _found(self, clearance: float | None) -> list[CellMeeting]:
        """Meetings, or what comes nearer than the clearance."""
        found: list[CellMeeting] = []
        open_ones: dict[tuple[int, int], int] = {}
        drawn: set[tuple[int, int]] = set()
        beside: dict[int, set[int]] = {}
        known: dict[str, Stay] = {}
        if not len(self.pairs):
            return found
        for begin, end in self._phases():
            now = _Phase.of(self, begin, end)
            fresh = {name for name, stay in now.stays.items() if known.get(name) is not stay}
            known = dict(now.stays)
            rows = now.moving()
            if len(rows):
                self._look_beside(now, fresh, rows, beside, drawn, clearance, tell=clearance is None)
                self._search(now, rows, beside, drawn, clearance, found, open_ones)
        return sorted(found, key=lambda each: each.begin)

    def _phases(self) -> Iterator[tuple[float, float]]:
        first, last = float(self.way.time[0]), float(self.way.time[-1])
        ends = [stay.begin for stay in self.stays] + [stay.end for stay in self.stays]
        ends += [at for each in self.mounted for at in (each.begin, each.end)]
        ends += [at for each in self.dockings for at in (each.begin, each.end)]
        times = sorted({first, last, *(float(at) for at in ends if first < at < last)})
        yield from pairwise(times)

    def _look_beside(
        self,
        now: _Phase,
        fresh: set[str],
        rows: NDArray[np.intp],
        beside: dict[int, set[int]],
        drawn: set[tuple[int, int]],
        clearance: float | None,
        *,
        tell: bool,
    ) -> None:
        """What parts stand on or beside: when they came there and when they leave; what is drawn in each other."""
        bodies, pairs = self.cell.bodies, self.pairs
        first = now.begin == float(self.way.time[0])
        news = {i for i, body in enumerate(bodies) if body.frame in fresh}
        for i in news:
            beside[i] = set()
            drawn.difference_update({pair for pair in drawn if i in pair})
        of_news = np.isin(pairs[rows], list(news)).any(axis=1) if news else np.zeros(len(rows), dtype=bool)
        asked = rows[(of_news | first) & self._lying[rows]]
        room = max(WANTED, clearance or 0.0)
        for stretch, share, some in ((0, 0.0, asked), (len(now.way.time) - 2, 1.0, rows[self._lying[rows]])):
            for meeting in now.standing(some, now.way.way.at(stretch, share), room):
                i, j = meeting.first, meeting.second
                for one, other in ((i, j), (j, i)):
                    if bodies[one].role == "part" and (share == 0.0 or self._leaves(bodies[one].frame, now)):
                        beside.setdefault(one, set()).add(other)
                if share == 0.0 and meeting.gap < -WANTED and (i, j) not in drawn:
                    drawn.add((i, j))
                    if tell:
                        self.overlaps.append((bodies[i], bodies[j], now.begin))

    @staticmethod
    def _leaves(name: str, now: _Phase) -> bool:
        """Whether a part is somewhere else after a phase."""
        return now.stays[name].end <= now.end

    def _search(
        self,
        now: _Phase,
        rows: NDArray[np.intp],
        beside: dict[int, set[int]],
        drawn: set[tuple[int, int]],
        clearance: float | None,
        found: list[CellMeeting],
        open_ones: dict[tuple[int, int], int],
    ) -> None:
        """Add the meetings of one phase; what has begun in an earlier one goes on."""
        stands = np.array([j in beside.get(i, ()) or i in beside.get(j, ()) for i, j in self.pairs[rows].tolist()])
        allowed = np.array([pair in drawn for pair in map(tuple, self.pairs[rows].tolist())])
        depth = np.where(stands, np.maximum(self._depth[rows], WANTED), self._depth[rows])
        keep = ~allowed if clearance is None else ~allowed & ~stands & (self._depth[rows] <= TOUCH)
        last = len(now.way.time) - 2
        for level in distinct(depth[keep]).tolist():
            some = rows[keep & (depth == level)]
            searched = now.search(some, -level) if clearance is None else now.search(some, clearance, tells_all=True)
            for meeting in searched:
                if clearance is not None and meeting.gap < -TOUCH:
                    continue
                pair = (meeting.first, meeting.second)
                known = open_ones.get(pair)
                one = now.told(meeting)
                if known is not None and meeting.stretch == 0 and meeting.share <= 0.0:
                    before = found[known]
                    if one.gap < before.gap:
                        found[known] = replace(before, gap=one.gap, deepest=one.deepest)
                else:
                    found.append(one)
                    known = len(found) - 1
                if meeting.last >= last:
                    open_ones[pair] = known
                else:
                    open_ones.pop(pair, None)


@dataclass(frozen=True, eq=False)
class _Phase:
    """A stretch of time in which no part is taken or let go, and no tool changed."""

    search_of: CellSearch
    begin: float
    end: float
    way: TimedWay
    stays: Mapping[str, Stay]
    places: Mapping[str, tuple[int, Pose]]
    tools: Mapping[str, int]
    docking: Collection[tuple[str, int]]

    @staticmethod
    def of(search: CellSearch, begin: float, end: float) -> _Phase:
        middle = 0.5 * (begin + end)
        stays = {stay.body: stay for stay in search.stays if stay.begin <= middle < stay.end}
        tools = {each.mover: each.tool for each in search.mounted if each.begin <= middle < each.end}
        places = {name: _place(search, name, stays) for name in stays}
        known = {name: at for name, at in places.items() if at is not None}
        docking = {(each.mover, each.tool) for each in search.dockings if each.begin <= middle < each.end}
        return _Phase(search, begin, end, search.way.part(begin, end), stays, known, tools, docking)

    @property
    def cell(self) -> CellBodies:
        return self.search_of.cell

    def _is_there(self, body: CellBody) -> bool:
        if body.role in PUT:
            return body.frame in self.places
        if body.stand:
            return body.stand not in self.tools.values()
        if not body.tool:
            return True
        if self.tools.get(body.mover) != body.tool:
            return False
        held = [stay.opening for stay in self.stays.values() if stay.holder and _is_on(stay.parent, body.mover)]
        return body.opening == (min(held) if held and body.tool in self.search_of.grippers else 1.0)

    @cached_property
    def _joint(self) -> NDArray[np.int64]:
        """The joint (b,) of a mover or device that carries each body in this phase."""
        joint = self.cell.carrier.copy()
        for i, body in enumerate(self.cell.bodies):
            if body.role in PUT:
                joint[i] = self.places[body.frame][0] if body.frame in self.places else -1
        return joint

    @cached_property
    def _moves(self) -> Flags:
        """Whether each joint (j,) of movers and devices moves."""
        q, bend = self.way.way.q, self.way.way.bend
        moves: Flags = (np.ptp(q, axis=0) > 0.0) | (bend.max(axis=0, initial=0.0) > 0.0)
        return moves

    def moving(self) -> NDArray[np.intp]:
        """Pairs, by their rows, that are there, move against each other and may come near each other."""
        bodies, pairs, tree = self.cell.bodies, self.search_of.pairs, self.cell.tree
        there = np.array([self._is_there(body) for body in bodies])
        moved_by = np.array(
            [next((j for j in tree.carrying(int(joint)) if self._moves[j]), -1) for joint in self._joint]
        )
        low, high = self._boxes()
        i, j = pairs[:, 0], pairs[:, 1]
        maybe = there[i] & there[j] & (moved_by[i] != moved_by[j])
        maybe &= (low[i] <= high[j]).all(axis=1) & (low[j] <= high[i]).all(axis=1)
        for mover, number in self.docking:
            flange = np.array([body.mover == mover and tree.is_flange(mover, body) for body in bodies])
            stand = np.array([body.stand == number for body in bodies])
            maybe &= ~((flange[i] & stand[j]) | (stand[i] & flange[j]))
        return np.flatnonzero(maybe)

    def _boxes(self) -> tuple[Array, Array]:
        """Corners (b, 3) of boxes in the world that no body leaves, with half of the clearance around them."""
        woods, way = self.cell.woods, self.way.way
        reach = self.cell.reach(np.abs(way.q).max(axis=0), [(at, name, X) for name, (at, X) in self.places.items()])
        leaves = applied(0.5 * np.abs(np.diff(way.q, axis=0)) + way.bend, reach).max(initial=0.0)
        room = float(leaves) + max(WANTED, self.search_of.clearance or 0.0)
        bodies, root = self.cell.bodies, woods.root
        there = np.array([b for b, body in enumerate(bodies) if body.role not in PUT or body.frame in self.places])
        centre = woods.forest.centre[root[there]]
        for index, b in enumerate(there.tolist()):
            if bodies[b].role in PUT:
                centre[index] = self.places[bodies[b].frame][1].apply(centre[index])
        size = (woods.forest.radius[root[there]] + room)[:, None]
        low, high = np.zeros((len(bodies), 3)), np.zeros((len(bodies), 3))
        least, most = _extent(self.cell.tree.joints, way.q, self._joint[there], centre)
        low[there], high[there] = least - size, most + size
        return low, high

    def _moving(self, rows: NDArray[np.intp]) -> tuple[MovingBodies, int]:
        """The pairs in a tree with no more parts than they have; how many parts these are."""
        cell, pairs = self.cell, self.search_of.pairs[rows]
        used = sorted({int(b) for b in pairs.ravel() if cell.bodies[b].role in PUT})
        names = dict.fromkeys(cell.bodies[b].frame for b in used)
        joints = cell.tree.with_parts({name: self.places[name] for name in names})
        carrier = cell.carrier.copy()
        for index, name in enumerate(names):
            carrier[carrier == cell.tree.part[name]] = cell.tree.shared + index
        mine = np.ascontiguousarray(pairs)
        return MovingBodies(joints, cell.rigid, mine, cell.woods, carrier), len(names)

    def search(self, rows: NDArray[np.intp], level: float, *, tells_all: bool = False) -> list[Meeting]:
        """When these pairs come below a level [m]; see `CellSearch` for those whose gap is not looked for."""
        moving, parts = self._moving(rows)
        way = self.way.way
        none = np.zeros((len(way.q), parts))
        whole = JointWay(np.hstack([way.q, none]), np.hstack([way.bend, none[1:]]))
        return moving.search(whole, level=level, followed=None if tells_all else self._first_ones)

    def _first_ones(self, meetings: Sequence[Meeting]) -> list[int]:
        """Which of some meetings come first of those with their key, or go on from the phase before."""
        if self.search_of.keys is None:
            return list(range(len(meetings)))
        found = [self.told(meeting) for meeting in meetings]
        first: dict[Hashable, int] = {}
        order = sorted(range(len(found)), key=lambda e: found[e].begin)
        for e, key in zip(order, self.search_of.keys([found[e] for e in order]), strict=True):
            first.setdefault(key, e)
        goes_on = {e for e, meeting in enumerate(meetings) if meeting.stretch == 0 and meeting.share <= 0.0}
        return sorted(goes_on | set(first.values()))

    def standing(self, rows: NDArray[np.intp], q: Array, level: float) -> list[Meeting]:
        """Those of these pairs that are nearer than a level [m] with joints at `q` (j,)."""
        if not len(rows):
            return []
        moving, parts = self._moving(rows)
        return moving.search(JointWay.straight(np.append(q, np.zeros(parts))[None]), level=level)

    def told(self, meeting: Meeting) -> CellMeeting:
        one, other = self.cell.bodies[meeting.first], self.cell.bodies[meeting.second]
        return CellMeeting(
            one=one,
            other=other,
            begin=self.way.at(meeting.stretch, meeting.share),
            deepest=self.way.at(*meeting.deepest),
            gap=meeting.gap,
            held={
                body.frame: stay.holder
                for body in (one, other)
                if (stay := self.stays.get(body.frame)) is not None and stay.holder
            },
        )


def _is_on(frame: str, mover: str) -> bool:
    return frame.partition("/")[0] == mover


def _place(search: CellSearch, name: str, stays: Mapping[str, Stay]) -> tuple[int, Pose] | None:
    """The joint that carries a part, and where on it; None while what it stands on is nowhere."""
    stay = stays[name]
    if stay.parent in search.cell.tree.part:
        below = _place(search, stay.parent, stays) if stay.parent in stays else None
        if below is None:
            return None
        carrier, X_below = below
        return carrier, X_below @ stay.X
    joint, X = search.cell.tree.carrier(stay.parent)
    return joint, X @ stay.X


def _extent(joints: JointTree, q: Array, carrier: NDArray[np.int64], points: Array) -> tuple[Array, Array]:
    """Corners (m, 3) of boxes that points (m, 3) [m] do not leave that ride on joints `carrier` (m,) along q (n, j)."""
    from gcodesim.kinematics.tree_kernels import poses_along

    count, base = q.shape[1], np.eye(4)
    none = np.zeros(0, dtype=np.int64)
    tree = Tree(*joints, np.zeros(count, dtype=np.int64), none, np.zeros((0, 4, 4)), -1, base)
    offset = np.tile(base, (len(points), 1, 1))
    offset[:, :3, 3] = points
    low, high = np.full(points.shape, np.inf), np.full(points.shape, -np.inf)
    for first in range(0, len(q), AT_ONCE):
        some = np.ascontiguousarray(q[first : first + AT_ONCE])
        X = np.zeros((len(some), len(points), 4, 4))
        poses_along(some, tree, carrier, offset, np.zeros((count, 4, 4)), X)
        low, high = np.minimum(low, X[:, :, :3, 3].min(axis=0)), np.maximum(high, X[:, :, :3, 3].max(axis=0))
    return low, high

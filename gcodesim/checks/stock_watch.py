"""What links of a machine, and what it carries, do to stocks in the shape that these have at the moment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks.clearance import tip_in_words
from gcodesim.checks.collisions import FIRST_TOUCH
from gcodesim.checks.machine_bodies import CarriedBody, may_meet_by_motion, on_joint
from gcodesim.checks.machine_collisions import STOCK_HINT, STOCK_HIT, MachineChecks, body_in_words
from gcodesim.checks.meetings import TOUCH, MovingBodies
from gcodesim.checks.rigid import RigidBody
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.frozen import frozen
from gcodesim.scene import Scene
from gcodesim.solids import Box, Placed
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.checks.gap_kernels import Convexes
    from gcodesim.checks.stock_gap_kernels import SightRoom, StockSight
    from gcodesim.checks.way_kernels import Couple
    from gcodesim.material.stock import Stock
    from gcodesim.planning.plan import Plan

NEAR: Final = "GS308"
_UP: Final = (0.0, 0.0, 1.0)


@frozen(eq=False)
class WatchedStock:
    """A stock that is looked at while it changes: how it is called, and its frame; X_JS on joint `carrier`.

    `grows`: material may be laid on it, so that what was free need not stay free.
    """

    name: str
    stock: Stock
    carrier: int
    X_JS: Pose
    grows: bool = False

    @staticmethod
    def of(scene: Scene, base: str, name: str, frame: str, stock: Stock, *, grows: bool = False) -> WatchedStock | None:
        """The stock of a frame of the scene, seen by the mover `base`; None where another one or a belt may move it."""
        parent, X = scene.standing_on(frame)
        if parent != WORLD and parent.partition("/")[0] != base:
            return None
        carrier, X_JF = on_joint(scene.movers[base], parent)
        return WatchedStock(name=name, stock=stock, carrier=carrier, X_JS=X_JF @ X, grows=grows)

    @property
    def body(self) -> CarriedBody:
        """All the room that it may take at the start."""
        low, high = self.stock.bounds
        box = Box(lower=tuple(low.tolist()), upper=tuple(high.tolist()))
        rigid = RigidBody(name=self.name, solids=(Placed(box, self.X_JS),), carrier=self.carrier)
        return CarriedBody(rigid=rigid, role="stock")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sighting:
    """What one look at n steps has found: `steps` (p, n, 3) by pairs, see `stock_gap_kernels.approach`; `state`

    (p, STATE) is what is known of the pairs after them. `q` (n + 1, j) are the joints. `free`: in so many steps no
    body is nearer than the level; if that is not all of them, nothing else may be known. `goes_on`: one was before.
    """

    pairs: _Pairs
    q: Array
    steps: Array
    state: Array
    free: int
    goes_on: bool

    @property
    def meets(self) -> bool:
        """Whether a body comes nearer than the level."""
        return self.free < len(self.q) - 1


@dataclass(slots=True, kw_only=True, eq=False)
class _Event:
    """Steps in a row in which a pair is nearer than the level: where it meets, and where it is deepest."""

    first: _Moment | None
    deepest: _Moment


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Moment:
    gap: float
    row: int
    time: float
    q: Array


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Those bodies that are watched while one tool is in the spindle, and the stocks that they may meet."""

    bodies: Sequence[CarriedBody]
    stocks: Sequence[WatchedStock]
    couple: Couple
    table: Convexes
    sights: Sequence[StockSight]
    room: SightRoom
    moving: MovingBodies

    @staticmethod
    def of(checks: MachineChecks, stocks: Sequence[WatchedStock], tool: int, travel: Array) -> _Pairs | None:
        """Pairs of a machine with this tool; None where nothing is to be watched."""
        machine = checks.machine
        held = checks.tools.get(tool)
        moved = [body for body in machine.bodies if body.role != "stock"]
        moved += [part for part in (machine.of_tool(held) if held is not None else ()) if part.any_shape]
        met = [
            (body, stock)
            for stock in stocks
            for body in moved
            if may_meet_by_motion(body, stock.body, machine.tree)
            and frozenset((body.rigid.name, stock.name)) not in checks.apart
            and len(body.rigid.convexes.first)
        ]
        if not met:
            return None
        from gcodesim.checks.gap_kernels import gap_room
        from gcodesim.checks.stock_gap_kernels import StockSight, sight_room
        from gcodesim.checks.way_kernels import way_room

        bodies = [each for body, stock in met for each in (body, stock.body)]
        moving = machine.moving(bodies, [(2 * p, 2 * p + 1) for p in range(len(met))])
        table, ranges = moving.table()
        sights = [
            StockSight(
                p,
                np.ascontiguousarray(stock.X_JS.matrix),
                *ranges[2 * p],
                ranges[2 * p + 1][0],
                checks.clearance or -TOUCH,
                float(stock.stock.z_range[0]),
                False,
            )
            for p, (_, stock) in enumerate(met)
        ]
        room = sight_room(way_room(len(travel)), gap_room())
        owners, others = zip(*met, strict=True)
        return _Pairs(owners, others, moving.couple(travel), table, sights, room, moving)

    def bounded_by(self, travel: Array) -> _Pairs:
        """The same for joints that shift by no more than `travel` (j,)."""
        return replace(self, couple=self.moving.couple(travel))

    def look(self, q: Array, state: Array, *, whether: bool) -> tuple[Array, int]:
        """What happens (p, n, 3) on the way through joints q (n + 1, j), and how many steps are free.

        `state` (p, STATE) is brought to the end of these. `whether`: the look ends where a body is nearer than the
        level.
        """
        from gcodesim.checks.stock_gap_kernels import FREE, approach

        steps = np.full((len(self.sights), len(q) - 1, 3), np.inf)
        free = len(q) - 1
        for p, (sight, watched) in enumerate(zip(self.sights, self.stocks, strict=True)):
            if watched.grows:
                state[p, FREE] = 0.0
            asked = sight._replace(whether=whether)
            field = watched.stock.view(_UP)
            way = q[: free + 1] if whether else q
            many = approach(
                way, asked, self.couple, self.moving.chain, field, self.table, state[p], self.room, steps[p]
            )
            free = min(free, int(many))
        if not whether:
            met = np.flatnonzero((steps[:, :, 0] <= self.sights[0].level).any(axis=0))
            free = int(met[0]) if len(met) else free
        return steps, free


@dataclass(slots=True, eq=False)
class StockWatch:
    """Looks, stretch by stretch of a run, at how near a machine comes to stocks as they are by then.

    `look` and `keep` belong to the thread that cuts, `take` and `findings` to the one that counts.
    """

    checks: MachineChecks
    stocks: Sequence[WatchedStock]
    plan: Plan
    _known: dict[int, _Pairs | None] = field(default_factory=dict)
    _state: dict[int, Array] = field(default_factory=dict)
    _tool: int = -1
    _open: dict[tuple[int, int], _Event] = field(default_factory=dict)
    _events: list[tuple[CarriedBody, WatchedStock, _Event]] = field(default_factory=list)
    _told: int = 0
    _travel: Array = field(init=False)

    def __post_init__(self) -> None:
        self._travel = self._travel_of(self.plan)

    @staticmethod
    def _travel_of(plan: Plan) -> Array:
        """How far (j,) [m, rad] each joint goes from zero."""
        extremes = plan.extremes()
        travel: Array = np.maximum(np.abs(extremes.least), np.abs(extremes.most))
        return travel

    def follow(self, plan: Plan) -> None:
        """The run goes on with a plan that has further legs."""
        self.plan = plan
        travel = self._travel_of(plan)
        if (travel > self._travel).any():  # pairs are bounded by how far joints go, and by nothing else of the way
            self._travel = travel
            self._known = {tool: pairs and pairs.bounded_by(travel) for tool, pairs in self._known.items()}

    # ---- in the thread that cuts

    def look(self, q: Array, tool: int, *, whether: bool) -> Sighting | None:
        """The way through joints q (n + 1, j) with a tool, among the stocks as they are now; None: nothing to see.

        `whether`: the look ends where a body comes nearer than the level.
        """
        from gcodesim.checks.stock_gap_kernels import LAST

        pairs = self._pairs_of(tool)
        if pairs is None or len(q) < 2:
            return None
        state = self._state[tool].copy() if tool == self._tool and tool in self._state else _unknown(len(pairs.sights))
        goes_on = bool((state[:, LAST] <= pairs.sights[0].level).any())
        steps, free = pairs.look(np.ascontiguousarray(q), state, whether=whether)
        return Sighting(pairs=pairs, q=q, steps=steps, state=state, free=free, goes_on=goes_on)

    def keep(self, sighting: Sighting | None, tool: int) -> None:
        """The run has gone through the steps of this look."""
        self._tool = tool
        if sighting is not None:
            self._state[tool] = sighting.state

    def forget(self) -> None:
        """Steps that were kept are taken back: nothing is known of what is free."""
        self._state.clear()

    def _pairs_of(self, tool: int) -> _Pairs | None:
        if tool not in self._known:
            self._known[tool] = _Pairs.of(self.checks, self.stocks, tool, self._travel)
        return self._known[tool]

    # ---- in the thread that counts

    def take(self, sighting: Sighting | None, tool: int, rows: NDArray[np.int64], times: Array) -> None:
        """What was seen in n steps of path `rows` (n,) between `times` (n + 1,) [s]."""
        level = self.checks.clearance or -TOUCH
        near = None if sighting is None else sighting.steps[:, :, 0] <= level
        for key in [key for key in self._open if near is None or key[0] != tool or not near[key[1], 0]]:
            del self._open[key]
        if sighting is None or near is None:
            return
        for p in np.flatnonzero(near.any(axis=1)).tolist():
            before = -2
            for k in np.flatnonzero(near[p]).tolist():
                if k != before + 1 and k:
                    self._open.pop((tool, p), None)
                before = k
                self._count(sighting, tool, p, k, int(rows[k]), (float(times[k]), float(times[k + 1])))
            if before != near.shape[1] - 1:
                self._open.pop((tool, p), None)

    def _count(self, seen: Sighting, tool: int, p: int, k: int, row: int, time: tuple[float, float]) -> None:
        """Step k of what was seen of a pair, which is near in it."""
        gap, first, deepest = seen.steps[p, k].tolist()

        def moment(share: float) -> _Moment:
            q = seen.q[k] + share * (seen.q[k + 1] - seen.q[k])
            return _Moment(gap=gap, row=row, time=time[0] + share * (time[1] - time[0]), q=q)

        event = self._open.get((tool, p))
        if event is None:
            event = self._open[tool, p] = _Event(first=None, deepest=moment(deepest))
            self._events.append((seen.pairs.bodies[p], seen.pairs.stocks[p], event))
        if gap < event.deepest.gap:
            event.deepest = moment(deepest)
        if event.first is None and first <= 1.0:
            event.first = moment(first)

    def fresh(self) -> list[Diagnostic]:
        """Findings about what has begun since the last question."""
        new, self._told = self._events[self._told :], len(self._events)
        return [self._finding(*event) for event in new if event[2].first is not None]

    def findings(self) -> list[Diagnostic]:
        """GS307 and GS308, one for each event, the first of a pair in a block."""
        first: dict[tuple[object, ...], Diagnostic] = {}
        for found in (self._finding(*event) for event in self._events):
            key = (found.code, found.span, found.bodies)
            known = first.get(key)
            first[key] = found if known is None else replace(known, count=known.count + 1)
        return list(first.values())

    def _finding(self, body: CarriedBody, stock: WatchedStock, event: _Event) -> Diagnostic:
        depth, at = -event.deepest.gap / MM, event.first or event.deepest
        tip = tip_in_words(self.plan, at.q, at.row, self.checks.X_BM)
        hits = event.first is not None
        clearance = (self.checks.clearance or 0.0) / MM
        who, what = body_in_words(body), f"stock `{stock.name}`"
        if hits:
            says = f"{who} hits {what}, {depth:.3f} mm deep; {FIRST_TOUCH} {tip}"
        else:
            says = (
                f"{who} passes {what} at {max(-depth, 0.0):.3f} mm, less than {clearance:g} mm, with the tip at {tip}"
            )
        return Diagnostic(
            code=STOCK_HIT if hits else NEAR,
            message=says,
            span=self.plan.path.span(at.row),
            hint=STOCK_HINT if hits else "keep more distance, or change `clearance` under `limits`",
            time=at.time,
            value=depth if hits else max(-depth, 0.0),
            limit=0.0 if hits else clearance,
            unit="mm",
            bodies=(body.rigid.name, stock.name),
        )


def _unknown(pairs: int) -> Array:
    """The state of pairs of which nothing is known."""
    from gcodesim.checks.stock_gap_kernels import CONVEX, LAST, STATE

    state = np.zeros((pairs, STATE))
    state[:, LAST] = np.inf
    state[:, CONVEX] = -1.0
    return state

"""What the links of a machine, its tools and what it carries hit on the way of a whole plan."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.checks.clearance import tip_in_words
from gcodesim.checks.collisions import FIRST_TOUCH
from gcodesim.checks.machine_bodies import CarriedBody, MachineBodies, may_meet_by_motion
from gcodesim.checks.rigid import RigidBody, bounds_of
from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.frames import Array, Pose
from gcodesim.kinematics.chain import Tree
from gcodesim.tools.gripper import Gripper
from gcodesim.tools.parts import body_part
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.checks.meetings import JointWay, Meeting, MovingBodies
    from gcodesim.checks.plan_way import PlanWay
    from gcodesim.planning.plan import Plan
    from gcodesim.tools.tool import Tool

Pairs = list[tuple[int, int]]

SELF: Final = "GS306"
STOCK_HIT: Final = "GS307"
STOCK_HINT: Final = "use a longer tool, or move the stock"
_BESIDE: Final = 5e-3
"""How near [m] a tool must come to a fixture for its sweep to be looked at; far more than that sweep rounds off."""

_HINTS: Final = {
    "GS305": "move the fixture or the work, or reach it another way",
    SELF: "another orientation of the tool or another place of the work keeps the links apart",
    STOCK_HIT: STOCK_HINT,
}


@dataclass(frozen=True, eq=False)
class MachineChecks:
    """A machine, its tools by number and what is around it, checked plan by plan; `X_BM` is machine zero in B.

    Links, tools and carried fixtures that come nearer than `clearance` [m] to a fixture are near misses.
    `allowed` are names of bodies of the machine that were in each other where a plan began; pairs of names that are
    `apart` are not looked at.
    """

    machine: MachineBodies
    tools: Mapping[int, Tool]
    X_BM: Pose
    clearance: float | None = None
    allowed: set[tuple[str, str]] = field(default_factory=set)
    apart: frozenset[frozenset[str]] = frozenset()

    def fixtures_beside(self, plan: Plan) -> frozenset[str] | None:
        """Labels of the fixtures that a tool may come nearer to than `_BESIDE`; None: of any."""
        if not len(plan.path) or not len(plan.trajectory.pieces):
            return None
        return _Check(plan, self).fixtures_beside()

    def findings(self, plan: Plan) -> list[Diagnostic]:
        """GS305 to GS308 and GS930 along a plan, in the order of time."""
        if not len(plan.path) or not len(plan.trajectory.pieces):
            return []
        return _once_a_block(_Check(plan, self).findings())


@dataclass(frozen=True, eq=False)
class _Check:
    """One plan, and the machine that runs it."""

    plan: Plan
    checks: MachineChecks

    @property
    def machine(self) -> MachineBodies:
        return self.checks.machine

    def findings(self) -> Iterator[Diagnostic]:
        own = self.machine.bodies
        pairs = self.machine.pairs()
        yield from self._of_bodies(own, pairs, None)
        yield from self._near_misses(own, [pair for pair in pairs if _is_beside(own[pair[0]], own[pair[1]])], None)
        for number, tool in sorted(self.checks.tools.items()):
            if not (self._tool_of_row == number).any():
                continue
            parts = self.machine.of_tool(tool)
            bodies = [*own, *parts]
            pairs = [
                (i, j)
                for j in range(len(own), len(bodies))
                for i in range(len(own))
                if may_meet_by_motion(bodies[i], bodies[j], self.machine.tree)
            ]
            beside = [
                (i, j)
                for j in range(len(own), len(bodies))
                for i in range(len(own))
                if own[i].role == "fixture"
                and own[i].carrier != bodies[j].carrier
                and self.checks.clearance
                and not isinstance(tool, Gripper)  # see `cell_meetings`
            ]
            if self._maybe(bodies, pairs) or self._maybe(bodies, beside):
                for run in self._runs_of(number):
                    yield from self._of_bodies(bodies, pairs, run)
                    yield from self._near_misses(bodies, beside, run)

    def fixtures_beside(self) -> frozenset[str] | None:
        """See `MachineChecks.fixtures_beside`."""
        own = [body for body in self.machine.bodies if body.role == "fixture"]
        found: set[str] = set()
        for number, tool in sorted(self.checks.tools.items()):
            if not (self._tool_of_row == number).any():
                continue
            bodies = [*own, *self.machine.of_tool(tool)]
            couples = [(i, j) for j in range(len(own), len(bodies)) for i in range(len(own))]
            found |= {own[i].rigid.name for i, j in couples if own[i].carrier == bodies[j].carrier}
            pairs = self._maybe(bodies, [(i, j) for i, j in couples if own[i].rigid.name not in found], _BESIDE)
            if not pairs:
                continue
            from gcodesim.checks.meetings import MOST

            for run in self._runs_of(number):
                near = self.machine.moving(bodies, pairs).search(self._part(run)[1], level=_BESIDE)
                if len(near) >= MOST:
                    return None
                found |= {own[meeting.first].rigid.name for meeting in near}
        return frozenset(found)

    @cached_property
    def _tool_of_row(self) -> NDArray[np.int64]:
        path = self.plan.path
        tools: NDArray[np.int64] = np.array([state.tool for state in path.states])[path.state]
        return tools

    def _runs_of(self, number: int) -> list[tuple[int, int]]:
        """Stretches with this tool in the spindle, run by run."""
        rows = self.plan.trajectory.pieces.row_first[self._way.piece]
        mine = np.concatenate([[False], self._tool_of_row[rows] == number, [False]])
        edges = np.flatnonzero(mine[1:] != mine[:-1])
        return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]

    @cached_property
    def _way(self) -> PlanWay:
        from gcodesim.checks.plan_way import PlanWay

        return PlanWay.of(
            self.plan, self.machine.greatest_reach(self.checks.tools.values(), np.abs(self._travel).max(axis=0))
        )

    @cached_property
    def _travel(self) -> tuple[Array, Array]:
        extremes = self.plan.extremes()
        return extremes.least, extremes.most

    def _maybe(self, bodies: Sequence[CarriedBody], pairs: Pairs, least: float = 0.0) -> Pairs:
        """Those pairs whose bounds may meet somewhere in the travel of the plan."""
        boxes = [self._swept(body) for body in bodies]
        room = max(self.checks.clearance or 0.0, least)
        names = [body.rigid.name for body in bodies]
        asked = [pair for pair in pairs if frozenset(names[k] for k in pair) not in self.checks.apart]
        return [(i, j) for i, j in asked if _cross(boxes[i], boxes[j], room)]

    def _swept(self, body: CarriedBody) -> Bounds | None:
        """See `swept_bounds`; asked for once for each body, which may have millions of triangles."""
        if body.rigid not in self._boxes:
            self._boxes[body.rigid] = swept_bounds(body, self.machine.tree, *self._travel)
        return self._boxes[body.rigid]

    @cached_property
    def _boxes(self) -> dict[RigidBody, Bounds | None]:
        return {}

    def _of_bodies(
        self, bodies: Sequence[CarriedBody], pairs: Pairs, run: tuple[int, int] | None
    ) -> Iterator[Diagnostic]:
        """Findings for some of the bodies on a run of stretches; None: on all of the way."""
        pairs = self._maybe(bodies, pairs)
        if not pairs:
            return
        begin, way = self._part(run)
        moving = self.machine.moving(bodies, pairs)
        for i, j in self._touching_at_start(bodies, moving, way):
            names = (bodies[i].rigid.name, bodies[j].rigid.name)
            if names not in self.checks.allowed:
                self.checks.allowed.add(names)
                yield self._allowed(*names, begin)
        rest = [(i, j) for i, j in pairs if (bodies[i].rigid.name, bodies[j].rigid.name) not in self.checks.allowed]
        for meeting in moving.of_pairs(rest).search(way):
            yield self._finding(bodies[meeting.first], bodies[meeting.second], meeting, begin)

    def _part(self, run: tuple[int, int] | None) -> tuple[int, JointWay]:
        """The first stretch of a run, and the way along it; None: all of the way."""
        from gcodesim.checks.meetings import JointWay

        begin, end = run or (0, len(self._way.piece))
        whole = self._way.way
        return begin, JointWay(whole.q[begin : end + 1], whole.bend[begin:end])

    def _near_misses(
        self, bodies: Sequence[CarriedBody], pairs: Pairs, run: tuple[int, int] | None
    ) -> Iterator[Diagnostic]:
        """GS308 for each time that one of the pairs comes nearer than the clearance without a collision."""
        clearance = self.checks.clearance
        pairs = self._maybe(bodies, pairs) if clearance else []
        if not pairs or clearance is None:
            return
        from gcodesim.checks.meetings import TOUCH

        begin, way = self._part(run)
        for meeting in self.machine.moving(bodies, pairs).search(way, level=clearance):
            if meeting.gap > -TOUCH:
                yield self._near_miss(bodies[meeting.first], bodies[meeting.second], meeting, begin, clearance)

    def _touching_at_start(self, bodies: Sequence[CarriedBody], moving: MovingBodies, way: JointWay) -> Pairs:
        """Pairs of the machine itself that are in each other where the way begins: so it was drawn."""
        from gcodesim.checks.meetings import JointWay

        own = [(i, j) for i, j in moving.pairs.tolist() if of_machine_itself(bodies[i], bodies[j])]
        met = moving.of_pairs(own).search(JointWay.straight(way.q[:1]))
        return [(meeting.first, meeting.second) for meeting in met]

    def _allowed(self, one: str, other: str, begin: int) -> Diagnostic:
        return Diagnostic(
            code="GS930",
            message=f"`{one}` and `{other}` are in each other at the start; they are not checked against each other",
            span=self.plan.path.span(self._way.row(begin)),
            hint="their shapes overlap by design, or the machine stands in itself: look at the start of the replay",
            bodies=(one, other),
        )

    def _near_miss(
        self, one: CarriedBody, other: CarriedBody, meeting: Meeting, begin: int, clearance: float
    ) -> Diagnostic:
        stretch, share = begin + meeting.deepest[0], meeting.deepest[1]
        if other.part or other.role == "link":
            one, other = other, one
        gap = max(meeting.gap, 0.0) / MM
        return Diagnostic(
            code="GS308",
            message=f"{body_in_words(one)} passes {_object(other)} at {gap:.3f} mm, less than {clearance / MM:g} mm, "
            f"with the tip at {self._tip_words(stretch, share)}",
            span=self.plan.path.span(self._way.row(stretch)),
            hint="keep more distance, or change `clearance` under `limits`",
            time=self._way.time(stretch, share),
            value=gap,
            limit=clearance / MM,
            unit="mm",
            bodies=(one.rigid.name, other.rigid.name),
        )

    def _tip_words(self, stretch: int, share: float) -> str:
        """Where the tip is, in the work system in force."""
        return tip_in_words(self.plan, self._way.way.at(stretch, share), self._way.row(stretch), self.checks.X_BM)

    def _finding(self, one: CarriedBody, other: CarriedBody, meeting: Meeting, begin: int) -> Diagnostic:
        way = self._way
        stretch = begin + meeting.stretch
        if other.any_shape or one.role == "stock" or (one.role == "link" and other.role == "tool"):
            one, other = other, one
        code = _code(one, other)
        depth = -meeting.gap / MM
        return Diagnostic(
            code=code,
            severity=Severity.WARNING if code == STOCK_HIT else None,  # it may have been cut away by then
            message=f"{body_in_words(one)} hits {_object(other)}, {depth:.3f} mm deep; "
            f"{FIRST_TOUCH} {self._tip_words(stretch, meeting.share)}",
            span=self.plan.path.span(way.row(stretch)),
            hint=_HINTS[code],
            time=way.time(stretch, meeting.share),
            value=depth,
            limit=0.0,
            unit="mm",
            bodies=(one.rigid.name, other.rigid.name),
        )


def of_machine_itself(one: CarriedBody, other: CarriedBody) -> bool:
    """Whether both belong to the machine: links, tools, and what is fixed to a link beside another one."""
    return {one.role, other.role} <= {"link", "tool", "holder"} or (
        "link" in (one.role, other.role) and min(one.carrier, other.carrier) >= 0
    )


def _is_beside(one: CarriedBody, other: CarriedBody) -> bool:
    """Whether one is a fixture and the other no stock; links of one machine are near each other by design."""
    return "fixture" in (one.role, other.role) and "stock" not in (one.role, other.role)


def _code(one: CarriedBody, other: CarriedBody) -> str:
    roles = {one.role, other.role}
    if "stock" in roles:
        return STOCK_HIT
    return "GS305" if "fixture" in roles else SELF


def body_in_words(body: CarriedBody) -> str:
    """A body as messages name it."""
    if body.part:
        return f"{body_part(body.part).words} of {body.rigid.name}"
    return f"`{body.rigid.name}`" if body.role == "link" else body.rigid.name


def _object(body: CarriedBody) -> str:
    return f"stock `{body.rigid.name}` as it is at the start" if body.role == "stock" else body_in_words(body)


def _once_a_block(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """In the order of time; where a machine folds into itself in one block, the first pair of bodies with their count.

    Of several parts of one body that hit the same other one in one block, the first.
    """
    first: dict[tuple[object, ...], Diagnostic] = {}
    for found in sorted(findings, key=lambda finding: finding.time or 0.0):
        key = (found.code, found.span) if found.code == SELF else (found.code, found.span, found.bodies)
        known = first.get(key)
        first[key] = found if known is None else replace(known, count=known.count + (found.code == SELF))
    return list(first.values())


Bounds = tuple[Array, Array]


def swept_bounds(body: CarriedBody, tree: Tree, least: Array, most: Array) -> Bounds | None:
    """Corners in the base of all that a body may take while joints shift from `least` to `most`; None if they turn."""
    X = Pose.identity()
    chain = []
    joint = body.carrier
    while joint >= 0:
        if not tree.prismatic[joint]:
            return None
        chain.append(joint)
        X = Pose.from_matrix(tree.before[joint]) @ X
        joint = int(tree.parent[joint])
    low, high = bounds_of(body.rigid.convexes, X)
    R = np.eye(3)
    for joint in reversed(chain):
        R = multiplied(R, tree.before[joint, :3, :3])
        way = applied(R, tree.axis[joint])
        ends = np.array([way * least[joint], way * most[joint]])
        low, high = low + ends.min(axis=0), high + ends.max(axis=0)
    return low, high


def _cross(one: Bounds | None, other: Bounds | None, room: float) -> bool:
    """Whether two boxes come nearer than `room` [m] along each axis; what is not known may."""
    if one is None or other is None:
        return True
    return bool((one[0] <= other[1] + room).all() and (other[0] <= one[1] + room).all())

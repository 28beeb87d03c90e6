"""Tool changes of an arm that drives for them: to the stand of the tool that it holds, then to that of the next one.

All of it are moves in joint space, put into the path where the program says M6. With a tool the flange comes to a stand
the way in which tools slide out, without one along its own Z; so it leaves again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import inverse_pose, multiplied
from gcodesim.diagnostics import Diagnostic, Findings, Span
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import ToolPath
from gcodesim.planning.added_rows import AddedRows, AddedStop, Moments
from gcodesim.planning.handing_over import changes_of_tool
from gcodesim.planning.reach import why

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics
    from gcodesim.planning.guide import Outside


@frozen(eq=False)
class StandPlace:
    """Where the flange is in the base, X_BF (4, 4).

    `coupled` at the tool in its stand, `back` from it without the tool, `out` of it with the tool.
    """

    coupled: Array
    back: Array
    out: Array


@frozen(eq=False)
class StandWay:
    """The joints (j,) with the flange at the places of a stand."""

    coupled: Array
    back: Array
    out: Array


@frozen(eq=False)
class Stands:
    """The stands of the tools by their numbers; `mounted` is the tool on the flange, 0 for none.

    `away` are those that are in no stand: on the flange, or taken out by hand (M61). `outside` are the external axes of
    the arm; they are at home when it changes tools.
    """

    places: Mapping[int, StandPlace]
    mounted: int = 0
    away: frozenset[int] = frozenset()
    outside: Outside | None = None

    def after(self, path: ToolPath) -> Stands:
        """What is where after a path."""
        mounted, away = self.mounted, set(self.away)
        for _, before, now, by_hand in changes_of_tool(path, mounted):
            if not by_hand:
                away.discard(before)
            away.add(now)
            mounted = now
        return replace(self, mounted=mounted, away=frozenset(away))

    def driven(
        self, path: ToolPath, kinematics: Kinematics, home: Array, findings: Findings
    ) -> tuple[ToolPath, dict[int, Array]]:
        """The path with the way to stands at each M6, and where the joints (j,) are at the end of these rows.

        A stand that is out of reach, empty or missing is a finding; the tool is then changed where the arm is.
        """
        ways = _Ways(self, kinematics, home, findings)
        away, inserted = set(self.away), AddedRows(path)
        for noted, before, now, by_hand in changes_of_tool(path, self.mounted):
            span = noted.event.span
            down = [] if by_hand else list(self._down(before, ways, span))
            stops = [] if by_hand else [*down, *self._up(now, away, ways, span)]
            if not by_hand:
                away.discard(before)
            away.add(now)
            if stops:
                done = max(k for k, stop in enumerate(stops) if stop.changes) + 1
                awaited = len(down) if len(down) < done else done - 1
                inserted.add(noted, stops, Moments(awaited=awaited, changed=done, returned=len(down)))
        return inserted.path(), inserted.goals

    def _down(self, tool: int, ways: _Ways, span: Span) -> Iterator[AddedStop]:
        """Put a tool into its stand."""
        way = ways.to(tool, span)
        if way is not None:
            yield AddedStop(tool=tool, goal=way.out)
            yield AddedStop(tool=tool, goal=way.coupled, changes=True)
            yield AddedStop(tool=0, goal=way.back)

    def _up(self, tool: int, away: set[int], ways: _Ways, span: Span) -> Iterator[AddedStop]:
        """Take a tool out of its stand."""
        way = ways.to(tool, span)
        if way is None:
            return
        if tool in away:
            ways.findings.add(_empty(tool, span))
        yield AddedStop(tool=0, goal=way.back)
        yield AddedStop(tool=0, goal=way.coupled, changes=True)
        yield AddedStop(tool=tool, goal=way.out)


def _empty(tool: int, span: Span) -> Diagnostic:
    return Diagnostic(
        code="GS625",
        span=span,
        message=f"the stand of T{tool} is empty: the tool was taken out of it by hand (M61, `loaded_tool`)",
        hint=f"set T{tool} down with an M6 before it is asked for again",
    )


class _Ways:
    """The joints at stands, found once for each; a finding for those that there are not."""

    def __init__(self, stands: Stands, kinematics: Kinematics, home: Array, findings: Findings) -> None:
        self.stands, self.kinematics, self.home, self.findings = stands, kinematics, home, findings
        self.known: dict[int, StandWay | None] = {}

    def to(self, tool: int, span: Span) -> StandWay | None:
        if tool == 0:
            return None
        if tool not in self.stands.places:
            message = f"T{tool} has no stand: it is changed where the arm is, by nobody"
            hint = f"add `stands: {{{tool}: {{in: …, xyz: […], rpy: […]}}}}` to the magazine"
            self.findings.add(Diagnostic(code="GS626", span=span, message=message, hint=hint))
            return None
        if tool not in self.known:
            self.known[tool] = self._found(tool, span)
        return self.known[tool]

    def _found(self, tool: int, span: Span) -> StandWay | None:
        place, outside = self.stands.places[tool], self.stands.outside
        arm = self.kinematics if outside is None else outside.assembly.arm
        poses = np.stack([place.coupled, place.back, place.out])
        rest = None
        start = self.home
        if outside is not None:
            rest = self.home[outside.assembly.externals][None]
            poses = multiplied(inverse_pose(outside.assembly.base(rest)), poses)
            start = self.home[outside.assembly.own]
        worst = None
        for seed in (start, *arm.branches(poses[0])):
            coupled, status = arm.inverse(poses[:1], seed)
            beside = [arm.inverse(pose[None], coupled[0]) for pose in poses[1:]]
            states = [int(status[0]), *(int(own[0]) for _, own in beside)]
            if not any(states):
                q = np.concatenate([coupled, *(joints for joints, _ in beside)])
                if outside is not None and rest is not None:
                    q = outside.assembly.together(q, np.repeat(rest, len(q), axis=0))
                return StandWay(coupled=q[0], back=q[1], out=q[2])
            worst = worst or next((k, state) for k, state in enumerate(states) if state)
        assert worst is not None
        k, state = worst
        reason = arm.reason(poses[k], start, state)
        where = ("at", "before", "beside")[k]
        self.findings.add(
            Diagnostic(
                code="GS232",
                span=span,
                message=f"the arm does not get to the stand of T{tool}: {where} it, {why(arm, reason)}",
                hint="move the stand, or turn it: its Z is that of the flange, into the tool",
                value=reason.value,
                limit=reason.limit,
                unit=reason.unit,
            )
        )
        return None

"""Findings about parts, devices, machines and tools in stands that meet: GS304, GS305, GS308 to GS311, GS567, GS930."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.canon import ToolChange
from gcodesim.checks.cell_bodies import CellBody
from gcodesim.checks.cell_meetings import CellMeeting
from gcodesim.checks.clearance import tip_in_words
from gcodesim.checks.collisions import FIRST_TOUCH
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Array, Pose
from gcodesim.scene import PUT, Stay
from gcodesim.tools.parts import body_part
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.planning.plan import Plan

LINK: Final = "GS305"
PART: Final = "GS309"
DEVICE: Final = "GS310"
MACHINES: Final = "GS311"
NEAR: Final = "GS308"
CHANGED: Final = "GS567"

_HINTS: Final = {
    LINK: "go round the tool in its stand, or move the stand",
    PART: "go round it or above it, or move it in the cell",
    DEVICE: "wait until it is out of the way (`M66` on an input of it), or switch it later",
    MACHINES: "let one wait for the other at a mark, or give each a zone of its own",
}
LOOSE_HINT: Final = "clear it away before this line (`M0`), leave tabs, or cut it free last"
_AFTER: Final = 1e-7  # [s] by which a row has begun that begins at a time


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Running:
    """A program that moves the mover `name`, on the clock of the run; `X_BM` is machine zero in its base.

    `switched` are the devices that it switches, by their frames, with the times [s] and the words.
    """

    name: str
    plan: Plan
    X_BM: Pose
    switched: Mapping[str, Sequence[tuple[float, Span]]]
    _standing: dict[float, bool] = field(default_factory=dict)
    _joints: dict[float, Array] = field(default_factory=dict)
    _rows: dict[float, int] = field(default_factory=dict)

    def row(self, time: float) -> int:
        if time not in self._rows:
            self.look_at([time])
        return self._rows[time]

    def span(self, time: float) -> Span | None:
        path = self.plan.path
        return path.span(min(self.row(time), len(path) - 1)) if len(path) else None

    def stands(self, time: float) -> bool:
        """Whether it stands still at a time."""
        if time not in self._standing:
            self.look_at([time])
        return self._standing[time]

    def look_at(self, times: Iterable[float]) -> None:
        """Find out where it is at these times, and whether it stands; many take little longer than one."""
        trajectory, asked = self.plan.trajectory, np.array(sorted(set(times) - self._standing.keys()))
        rows = np.zeros(len(asked), dtype=np.int64)
        if len(self.plan.path):
            rows = trajectory.rows_at(np.minimum(asked + _AFTER, trajectory.duration))
        self._rows.update(zip(asked.tolist(), rows.tolist(), strict=True))
        joints = self.plan.joints(trajectory.sample(np.minimum(asked, trajectory.duration)))
        self._joints.update(zip(asked.tolist(), joints, strict=True))
        runs = asked[asked < trajectory.duration]
        q = [self.plan.joints(trajectory.sample(at)) for at in (np.maximum(runs - _AFTER, 0.0), runs + _AFTER)]
        self._standing.update(dict.fromkeys(asked.tolist(), True))
        self._standing.update(zip(runs.tolist(), (q[0] == q[1]).all(axis=1).tolist(), strict=True))

    def tip_words(self, time: float) -> str:
        """Where the tip is, in the work system in force."""
        if time not in self._joints:
            self.look_at([time])
        row = min(self.row(time), max(len(self.plan.path) - 1, 0))
        return tip_in_words(self.plan, self._joints[time], row, self.X_BM)


@dataclass(frozen=True, eq=False)
class CellWords:
    """Puts meetings into words. `running` are the programs, the first channel first; `span_of` says where the cell

    describes a body.
    """

    running: Sequence[Running]
    span_of: Callable[[CellBody], Span]

    def collisions(self, meetings: Iterable[CellMeeting]) -> list[Diagnostic]:
        """GS309 to GS311, one for each pair of bodies and line, in the order of time.

        What links of one machine do to the same body in one line is one finding with a count; of several parts of one
        tool it is the first.
        """
        found = sorted(meetings, key=lambda meeting: meeting.begin)
        first: dict[Hashable, CellMeeting] = {}
        others: dict[Hashable, int] = {}
        for meeting, key in zip(found, self.keys(found), strict=True):
            known = first.setdefault(key, meeting)
            if self._names(known) != self._names(meeting):
                others[key] = others.get(key, 0) + 1
        return [replace(self._collision(each), count=1 + others.get(key, 0)) for key, each in first.items()]

    def near_misses(self, meetings: Iterable[CellMeeting], clearance: float) -> list[Diagnostic]:
        """GS308."""
        found = list(meetings)
        self._look_at(found, [meeting.deepest for meeting in found])
        return _once([self._near_miss(meeting, clearance) for meeting in found])

    def keys(self, meetings: Sequence[CellMeeting]) -> list[Hashable]:
        """What a collision is told by: of meetings with the same key the first is told, and how many there are."""
        self._look_at(meetings, ())
        return [self._key(meeting) for meeting in meetings]

    def _look_at(self, meetings: Sequence[CellMeeting], times: Iterable[float]) -> None:
        at = [*(meeting.begin for meeting in meetings), *times]
        for each in self.running:
            each.look_at(at)

    def _key(self, meeting: CellMeeting) -> Hashable:
        one, other = self._ordered(meeting)
        _, span = self._blamed(meeting, one, other, meeting.begin)
        code, _ = _code_of(one, other)
        return code, span, *(name.partition("/")[0] for name in self._names(meeting))

    def overlaps(self, drawn: Iterable[tuple[CellBody, CellBody, float]]) -> Iterator[Diagnostic]:
        """GS930 for things that lie in each other."""
        told = set()
        for one, other, time in drawn:
            names = (one.rigid.name, other.rigid.name)
            if names not in told:
                told.add(names)
                message = f"`{names[0]}` and `{names[1]}` are in each other"
                when = " at the start" if time <= 0.0 else f" when one of them comes to rest, at {time:.3f} s"
                yield Diagnostic(
                    code="GS930",
                    message=f"{message}{when}; they are not checked against each other",
                    span=self.span_of(one),
                    hint="their shapes overlap by design, or one is not where it is meant to be",
                    bodies=names,
                )

    def _collision(self, meeting: CellMeeting) -> Diagnostic:
        one, other = self._ordered(meeting)
        code, hint = _code_of(one, other)
        span, where = self._place(meeting, one, other, meeting.begin, f"; {FIRST_TOUCH}")
        depth = -meeting.gap / MM
        return Diagnostic(
            code=code,
            message=f"{_words(one, meeting.held)} hits {_words(other, meeting.held)}, {depth:.3f} mm deep{where}",
            span=span,
            hint=hint,
            time=meeting.begin,
            value=depth,
            limit=0.0,
            unit="mm",
            bodies=(one.rigid.name, other.rigid.name),
        )

    def _near_miss(self, meeting: CellMeeting, clearance: float) -> Diagnostic:
        one, other = self._ordered(meeting)
        span, where = self._place(meeting, one, other, meeting.deepest)
        gap = max(meeting.gap, 0.0) / MM
        return Diagnostic(
            code=NEAR,
            message=f"{_words(one, meeting.held)} passes {_words(other, meeting.held)} at {gap:.3f} mm, "
            f"less than {clearance / MM:g} mm{where}",
            span=span,
            hint="keep more distance, or change `clearance` under `limits`",
            time=meeting.deepest,
            value=gap,
            limit=clearance / MM,
            unit="mm",
            bodies=(one.rigid.name, other.rigid.name),
        )

    def _ordered(self, meeting: CellMeeting) -> tuple[CellBody, CellBody]:
        """Who hits whom: a machine that moves, or the part that it holds, comes first."""
        one, other = meeting.one, meeting.other
        movers = self._movers(meeting)

        def rank(body: CellBody) -> tuple[bool, bool, int]:
            mover = body.mover or meeting.held.get(body.frame, "").partition(" ")[0]
            order = [each.name for each in movers]
            moves = mover in order
            return not moves, body.role == "fixture", order.index(mover) if moves else 0

        return (other, one) if rank(other) < rank(one) else (one, other)

    def _names(self, meeting: CellMeeting) -> tuple[str, str]:
        one, other = self._ordered(meeting)
        return one.rigid.name, other.rigid.name

    def _movers(self, meeting: CellMeeting) -> list[Running]:
        """The programs that move one of both bodies: those that are under way first."""
        names = {meeting.one.mover, meeting.other.mover} | {who.partition(" ")[0] for who in meeting.held.values()}
        mine = [each for each in self.running if each.name in names]
        return sorted(mine, key=lambda each: each.stands(meeting.begin))

    def _place(
        self, meeting: CellMeeting, one: CellBody, other: CellBody, time: float, before: str = ", with the tip at"
    ) -> tuple[Span, str]:
        """The line that is to blame, and where its tip is then."""
        who, span = self._blamed(meeting, one, other, time)
        if who is None:
            return span, ""
        beside = "".join(
            f"; `{each.name}` is in line {other_span.line} of {other_span.file}"
            for each in self._movers(meeting)[1:]
            if (other_span := each.span(time)) is not None
        )
        return span, f"{before} {who.tip_words(time)}{beside}" if len(who.plan.path) else beside

    def _blamed(self, meeting: CellMeeting, one: CellBody, other: CellBody, time: float) -> tuple[Running | None, Span]:
        """The program that moves then, with its line; None: the line has switched a device."""
        movers = self._movers(meeting)
        devices = [body.frame for body in (one, other) if body.role == "obstacle"]
        if not movers or movers[0].stands(time):
            words = [
                (at, span)
                for each in self.running
                for device in devices
                for at, span in each.switched.get(device, ())
                if at <= time
            ]
            if words:
                return None, max(words, key=lambda word: word[0])[1]
        who = movers[0] if movers else self.running[0]
        return who, who.span(time) or self.span_of(one)


def _code_of(one: CellBody, other: CellBody) -> tuple[str, str]:
    """The code of a collision, and what helps."""
    roles = {one.role, other.role}
    code = PART if roles & PUT else DEVICE if "obstacle" in roles else MACHINES
    if code == MACHINES and "fixture" in roles and one.part and not other.mover:
        return body_part(one.part).code, body_part(one.part).hint
    if code == MACHINES and other.stand:
        return LINK, _HINTS[LINK]
    return code, LOOSE_HINT if "loose" in roles else _HINTS[code]


def changes_with_a_part(
    running: Sequence[Running], stays: Iterable[Stay], tools: Mapping[int, str], end: float
) -> Iterator[Diagnostic]:
    """GS567 for each tool that comes into a spindle by `end` [s] while the one before it holds a part."""
    for stay in stays:
        mover, _, gripper = stay.holder.partition(" ")
        for each in (own for own in running if own.name == mover):
            for timed in each.plan.trajectory.events:
                change = timed.event
                if not isinstance(change, ToolChange) or not stay.begin < timed.time < min(stay.end, end + _AFTER):
                    continue
                after = tools.get(change.tool, "an empty spindle")
                if after != gripper:
                    name = stay.body.rpartition("/")[2]
                    yield Diagnostic(
                        code=CHANGED,
                        message=f"{gripper} is changed for {after} while it holds `{name}`; the part is left where the "
                        "gripper was on the flange",
                        span=change.span,
                        hint="set the part down and open the gripper before the change",
                        time=timed.time,
                    )
                    break


def _words(body: CellBody, held: Mapping[str, str]) -> str:
    name = body.rigid.name
    if body.part:
        return f"{body_part(body.part).words} of {name}"
    if body.role == "part":
        who = held.get(body.frame, "").partition(" ")[2]
        return f"part `{name}`, held by {who}," if who else f"part `{name}`"
    if body.role == "loose":
        return f"loose piece {name}"
    if body.role == "obstacle":
        return f"device `{name}`"
    if body.role == "stock":
        return f"stock `{name}` as it is at the start"
    return f"`{name}`" if body.role == "link" else name


def _once(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """In the order of time; what links of one machine pass in one line is one finding with a count."""
    first: dict[tuple[object, ...], Diagnostic] = {}
    for found in sorted(findings, key=lambda finding: finding.time or 0.0):
        key = (found.code, found.span, *(name.partition("/")[0] for name in found.bodies))
        known = first.get(key)
        if known is None:
            first[key] = found
        elif known.bodies != found.bodies:
            first[key] = replace(known, count=known.count + 1)
    return list(first.values())

"""A plan as a robot program: the points of the program's own blocks, with corners rounded as they were checked."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from gcodesim.arithmetic.matrices import dot, norm
from gcodesim.canon.systems import name_of_system
from gcodesim.cell.cell import MAIN
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Pose
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import ARC
from gcodesim.planning.arm_joints import ArmJoints
from gcodesim.post.blends import CutCorner, Passing, rounded
from gcodesim.post.meeting import MeetingLines, meetings_of
from gcodesim.post.moves import ArmPlace, RobotMove, RobotProgram, RobotStep, ToldFrame, ToolFrame
from gcodesim.post.nodes import PlannedArm
from gcodesim.post.said import Said
from gcodesim.post.straight import Stray, StrayOfJoints, StrayOfLine, needed
from gcodesim.world.body import tool_body
from gcodesim.world.payload import payload_of

if TYPE_CHECKING:
    from gcodesim.jobs.job import Job
    from gcodesim.post.language import RobotLanguage
    from gcodesim.shop import Shop

Motion = Literal["joint", "linear"]

_MOST_SWEEP: Final = 170.0 / 180.0 * math.pi  # [rad] of one circular move
_SHORT_ARC: Final = 1e-4  # [m] of arc below which a line does
_NOWHERE: Final = Span("")
_STILL: Final = 1e-9  # [m, rad] on which nothing moves
_LIFT: Final = 1e-6  # [m] of a helix that a circle may leave out


class NotPostedError(ValueError):
    """There is no robot program of this; the text says why."""


@frozen
class Wish:
    """What is wanted.

    `motion` by joints or along lines and circles; `tolerance` [m] is how far the way may be off between its points;
    `signals` are outputs of the control by what they are in the program: `P1`, `E0`, `spindle`, `M10` …
    `tool_change` is the control's own program for that; empty: it stops for the new tool. `meet` has the lines of each
    channel's control to each other one.
    """

    motion: Motion = "linear"
    tolerance: float = 1e-5
    signals: Mapping[str, str] = field(default_factory=dict)
    tool_change: str = ""
    meet: Mapping[tuple[str, str], MeetingLines] = field(default_factory=dict)


def program_of(
    job: Job, language: RobotLanguage, wish: Wish, beside: Sequence[Job] = ()
) -> tuple[RobotProgram, list[Diagnostic]]:
    """The planned path of a job's own channel, and what of it cannot be said; `beside` are all jobs that run with it.

    NotPostedError where it is not that of an arm, or depends on what a run finds.
    """
    plan, shop = job.plan, job.shop
    if plan is None or shop is None:
        raise NotPostedError("the program cannot be planned in this cell")
    if shop.mover.joints_are_axes:
        raise NotPostedError(f"`{shop.name}` is a machine tool, whose control reads G-code: --for fanuc, grbl …")
    if not isinstance(plan.joint_path, ArmJoints):
        raise NotPostedError("the program asks where a probe touches or what an input reads (G38, M66)")
    planned = PlannedArm(plan=plan, joints=plan.joint_path)
    if planned.assembly is not None and not language.moves_externals:
        names = ", ".join(_externals(planned)["external_names"])
        raise NotPostedError(f"programs of {language.kind} do not move external axes, and this one has {names}")
    frames, frame_of_state = _frames(shop, planned)
    lines = {other: line for (own, other), line in wish.meet.items() if own == job.channel}
    meetings = meetings_of(job, [one for one in beside if one.plan is not None], lines)
    said = Said(language, wish, meetings)
    steps = [*meetings.at_begin(_NOWHERE), *_steps(planned, said, wish, frame_of_state)]
    program = RobotProgram(
        name=_name(job, language, several=len(beside) > 1),
        source=job.program.name,
        cell=job.loaded.path.name,
        steps=tuple(rounded(steps, planned.begin())),
        frames=frames,
        tools=_tools(shop, planned),
        kinematics=planned.arm,
        joint_speeds=planned.arm.joints.speed,
        **_externals(planned),
    )
    return program, said.findings


def _name(job: Job, language: RobotLanguage, *, several: bool) -> str:
    """What the program is called; where several run, those beside the first have the name of their channel in it."""
    own = job.program.name.rpartition(":")[2]
    if not several or job.channel == MAIN:
        return own
    begin = own.rpartition("/")[2].partition(".")[0]
    return f"{begin[: language.longest_name - len(job.channel) - 1]}_{job.channel}"


def _steps(planned: PlannedArm, said: Said, wish: Wish, frame_of_state: list[int]) -> Iterator[RobotStep]:
    """All steps; where the robot goes on, corners are not rounded yet."""
    path = planned.plan.path
    events = list(path.events)
    here = planned.begin()
    tool = path.state_of(0).tool if len(path) else 0
    yield RobotMove(span=Span(path.spans[0].file), kind="joint", to=here, tool=tool)
    happened = 0
    for row in range(len(path)):
        while happened < len(events) and events[happened].row <= row:
            yield from said.steps(events[happened].event)
            happened += 1
        state = int(path.state[row])
        span, frame, tool = path.span(row), frame_of_state[state], path.states[state].tool
        end = planned.end_of(row)
        moves = [replace(move, span=span, frame=frame, tool=tool) for move in _moves(planned, wish, row, here, end)]
        for number, move in enumerate(moves, start=1):
            corner = _corner(planned, wish, row, last=number == len(moves))
            yield move if corner is None else Passing(span=move.span, move=move, corner=corner)
        here = end
    for noted in events[happened:]:
        yield from said.steps(noted.event)


def _corner(planned: PlannedArm, wish: Wish, row: int, *, last: bool) -> CutCorner | None:
    """What holds at the end of a move of a row, the last one or one before; None where the robot stops."""
    if not last:
        return CutCorner(zone=None, tolerance=wish.tolerance)
    if planned.by_joints(row) or not planned.goes_on[row]:
        return None
    zone = float(planned.zones[row])
    tolerance = max(wish.tolerance, float(planned.plan.path.naive[row]))
    return CutCorner(zone=None if math.isnan(zone) else zone, tolerance=tolerance)


def _moves(planned: PlannedArm, wish: Wish, row: int, here: ArmPlace, end: ArmPlace) -> Iterator[RobotMove]:
    """The moves of a row from where the arm is."""
    path = planned.plan.path
    if path.kind[row] != ARC and _same(here, end):
        return
    if planned.by_joints(row):
        yield RobotMove(span=_NOWHERE, kind="joint", to=end, share=planned.share_of_joints(row))
    elif wish.motion == "joint":
        tip = partial(planned.tip_at, row)
        yield from _short_moves(planned, row, here, end, StrayOfJoints(tolerance=wish.tolerance, tip=tip), "joint")
    elif not planned.keeps_attitude:
        yield from _short_moves(planned, row, here, end, StrayOfLine(tolerance=wish.tolerance), "linear")
    elif path.kind[row] != ARC:
        yield RobotMove(span=_NOWHERE, kind="linear", to=end, speed=_speed(planned, row))
    else:
        yield from _arc_moves(planned, row, end, wish.tolerance)


def _short_moves(
    planned: PlannedArm, row: int, here: ArmPlace, end: ArmPlace, stray: Stray, kind: Motion
) -> Iterator[RobotMove]:
    """As many moves as keep the tool on the way that was checked, each as fast as it was planned."""
    times, inside = planned.way(row)
    t = planned.plan.trajectory
    when = np.concatenate([[t.row_start[row]], times, [t.row_end[row]]])
    places = [here, *inside, end]
    programmed = _speed(planned, row) if planned.work_rests(row) and planned.feeds_tip(row) else None
    before = 0
    for number in needed(places, stray):
        start, to = places[before], places[number]
        seconds = max(float(when[number] - when[before]), 1e-9)
        shares = np.abs(to.q - start.q) / planned.arm.joints.speed / seconds
        yield RobotMove(
            span=_NOWHERE,
            kind=kind,
            to=to,
            speed=norm(to.X_BT.p - start.X_BT.p) / seconds if programmed is None else programmed,
            share=min(1.0, float(shares.max())),
            seconds=seconds,
        )
        before = number


def _arc_moves(planned: PlannedArm, row: int, end: ArmPlace, tolerance: float) -> Iterator[RobotMove]:
    """Circles of less than half a turn; a helix as lines, since a circle lies in a plane."""
    path = planned.plan.path
    sweep, length = abs(float(path.sweep[row])), float(path.length[row])
    lift = abs(dot(path.end[row, :3] - path.start[row, :3], path.normal[row]))
    plane = length > _SHORT_ARC and lift < _LIFT
    step = _MOST_SWEEP if plane else math.sqrt(8.0 * tolerance * max(sweep, _STILL) / max(length, tolerance))
    count = max(1, math.ceil(sweep / step))
    for number in range(1, count + 1):
        yield RobotMove(
            span=_NOWHERE,
            kind="circular" if plane else "linear",
            to=end if number == count else planned.at(row, number / count),
            via=planned.at(row, (number - 0.5) / count) if plane else None,
            speed=_speed(planned, row),
        )


def _speed(planned: PlannedArm, row: int) -> float:
    """Of the tip [m/s]: as programmed, or as fast as it was planned to go."""
    return float(planned.plan.path.feed[row]) if planned.feeds_tip(row) else planned.greatest_speed(row)


def _same(first: ArmPlace, second: ArmPlace) -> bool:
    """Whether nothing moves between two places."""
    values = (np.concatenate([one.q, one.externals]) for one in (first, second))
    return bool(np.abs(next(values) - next(values)).max() < _STILL)


def _frames(shop: Shop, planned: PlannedArm) -> tuple[dict[int, ToldFrame], list[int]]:
    """The work systems of a plan by number, and which of them each state of its path has."""
    frames: dict[int, ToldFrame] = {}
    numbers: list[int] = []
    for state in planned.plan.path.states:
        X_BP = shop.X_BM @ state.X_MP
        name = name_of_system(state.system)
        known = (
            n for n, frame in frames.items() if frame.name == name and np.array_equal(frame.X_BP.matrix, X_BP.matrix)
        )
        number = next(known, 0)
        if not number:
            number = len(frames) + 1
            frames[number] = ToldFrame(name=name, X_BP=X_BP)
        numbers.append(number)
    return frames, numbers


def _tools(shop: Shop, planned: PlannedArm) -> dict[int, ToolFrame]:
    """The tools of a plan by T number."""
    tools: dict[int, ToolFrame] = {}
    for number in dict.fromkeys(state.tool for state in planned.plan.path.states):
        tool = shop.tool(number)
        X_FT = planned.plan.tool_frames.get(number)
        load = None if tool is None else payload_of(tool_body(tool))
        tools[number] = ToolFrame(
            name=f"T{number}" if tool is None else tool.name,
            X_FT=Pose.identity() if X_FT is None else X_FT,
            mass=0.0 if load is None else load.mass,
            centre=(0.0, 0.0, 0.0) if load is None else tuple(load.com.tolist()),
        )
    return tools


def _externals(planned: PlannedArm) -> dict[str, Any]:
    assembly = planned.assembly
    if assembly is None:
        return {}
    joints = assembly.joints.part(assembly.externals)
    return {
        "external_names": tuple(joints.names),
        "external_slides": tuple(kind == "prismatic" for kind in joints.kinds),
    }

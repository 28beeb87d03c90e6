"""What several programs share: zones in which only one machine may be, and tools that exist once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, product
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, norms
from gcodesim.canon import ToolChange, ToolNumber
from gcodesim.checks.machine_bodies import readable
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import ToolPath

if TYPE_CHECKING:
    from gcodesim.planning import Plan
    from gcodesim.tools.tool import Tool

Flags = NDArray[np.bool_]

INTERVAL: Final = 0.01  # [s] between two looks at the machines; at 1 m/s they go 10 mm
_BLOCK: Final = 20_000  # times whose poses are kept at once


@frozen(eq=False)
class Occupant:
    """A program that runs beside others: its plan on the common clock, its machine at `X_WB`, and the cell's tools.

    `loaded` is the number of the tool in the spindle at the start.
    """

    channel: str
    plan: Plan
    X_WB: Pose
    tools: Mapping[int, Tool]
    loaded: int = 0


@frozen(eq=False)
class SharedZone:
    """A box from `low` to `high` (3,) [m] in the frame at `X_W`, in which only one machine may be."""

    name: str
    X_W: Pose
    low: Array
    high: Array


def sharing_findings(zones: Sequence[SharedZone], occupants: Sequence[Occupant]) -> Iterator[Diagnostic]:
    """GS623 for machines that are in one zone at the same time, GS624 for a tool that is in two spindles."""
    end = max((each.plan.trajectory.duration for each in occupants), default=0.0)
    times: Array = np.arange(0.0, end + INTERVAL, INTERVAL)
    if zones:
        stays = {each.channel: _stays(each, zones, times) for each in occupants}
        for index, zone in enumerate(zones):
            for one, other in combinations(occupants, 2):
                both = stays[one.channel][index] & stays[other.channel][index]
                if both.any():
                    yield _crowded(zone, one, other, both, times)
    for one, other in combinations(occupants, 2):
        yield from _tools_twice(one, other)


def _stays(occupant: Occupant, zones: Sequence[SharedZone], times: Array) -> Flags:
    """Whether the machine is in each of the z zones at each of `times` (n,): (z, n).

    Counted are the lines between its joints, and its tool from tip to flange, as thick as its thickest part.
    """
    plan = occupant.plan
    found = np.zeros((len(zones), len(times)), dtype=bool)
    for first in range(0, len(times), _BLOCK):
        here = slice(first, first + _BLOCK)
        samples = plan.trajectory.sample(times[here])
        q = plan.joints(samples)
        rows = np.minimum(samples.row, max(len(plan.path) - 1, 0))
        flange = plan.kinematics.forward(q)[:, None, :3, 3]
        joints = np.concatenate([plan.kinematics.links(q)[:, :, :3, 3], flange], axis=1)
        tip = plan.tip(q, rows)[:, None, :3, 3]
        thick = _thickness(plan.path, rows, occupant.tools)
        for index, zone in enumerate(zones):
            X = zone.X_W.inverse() @ occupant.X_WB
            points, ends = _moved(X, joints), _moved(X, np.concatenate([flange, tip], axis=1))
            inside = _cross(points[:, :-1], points[:, 1:], zone.low, zone.high).any(axis=1)
            grown = thick[:, None]
            inside |= _cross(ends[:, 0], ends[:, 1], zone.low - grown, zone.high + grown)
            found[index, here] = inside
    return found


def _moved(X: Pose, points: Array) -> Array:
    moved: Array = applied(X.R, points) + X.p
    return moved


def _thickness(path: ToolPath, rows: NDArray[np.int64], tools: Mapping[int, Tool]) -> Array:
    """The greatest radius (n,) [m] of the tool in each of `rows` (n,)."""
    radii = {number: _radius(tool) for number, tool in tools.items()}
    of_state = np.array([radii.get(state.tool, 0.0) for state in path.states])
    return of_state[path.state[rows]] if len(path) else np.full(len(rows), of_state[0])


def _radius(tool: Tool) -> float:
    """How far a tool reaches from its axis [m]."""
    reach = [
        np.abs(np.add(body.placed.X.p[:2], corner[:2])).max()
        for body in tool.round_parts
        for corner in body.placed.solid.bounds
    ]
    for _, placed in tool.own_shapes():
        if readable(placed):
            corners = placed.X.apply(np.array(list(product(*zip(*placed.solid.bounds, strict=True)))))
            reach.append(norms(corners * np.array([1.0, 1.0, 0.0])).max())
    return float(max(reach, default=0.0))


def _cross(start: Array, end: Array, low: Array, high: Array) -> Flags:
    """Whether the line from `start` to `end` (…, 3) meets the box: it is in all three slabs at one time."""
    way = end - start
    safe = np.where(np.abs(way) < 1e-15, 1e-15, way)
    a, b = (low - start) / safe, (high - start) / safe
    enter = np.minimum(a, b).max(axis=-1)
    leave = np.maximum(a, b).min(axis=-1)
    met: Flags = (np.maximum(enter, 0.0) <= np.minimum(leave, 1.0)) & (enter <= leave)
    return met


def _crowded(zone: SharedZone, one: Occupant, other: Occupant, both: Flags, times: Array) -> Diagnostic:
    begins = np.flatnonzero(both & ~np.concatenate([[False], both[:-1]]))
    first = float(times[begins[0]])
    until = float(times[begins[0] + int(np.argmin(np.append(both[begins[0] :], False))) - 1])
    here, there = _span_at(one.plan, first), _span_at(other.plan, first)
    return Diagnostic(
        code="GS623",
        span=here,
        related=there,
        message=f"`{one.channel}` and `{other.channel}` are both in zone `{zone.name}`, "
        f"for {until - first + INTERVAL:.2f} s from {first:.2f} s on; `{other.channel}` is in line {there.line}",
        hint="let one of them wait at a mark until the other has left the zone",
        count=len(begins),
        time=first,
        value=float(both.sum()) * INTERVAL,
        limit=0.0,
        unit="s",
    )


def _span_at(plan: Plan, time: float) -> Span:
    """The block that a program is in at `time` [s]."""
    path = plan.path
    samples = plan.trajectory.sample(np.array([time]))
    if samples.event[0] >= 0 and plan.trajectory.events:
        return plan.trajectory.events[int(samples.event[0])].event.span
    return path.span(int(samples.row[0])) if len(path) else Span("")


def _tools_twice(one: Occupant, other: Occupant) -> Iterator[Diagnostic]:
    """GS624 for each tool that both have in the spindle at the same time, at its first time."""
    told = set()
    for number, begin, end, span in _in_spindle(one):
        for same, start, stop, place in _in_spindle(other):
            if same != number or number in told or min(end, stop) <= max(begin, start):
                continue
            told.add(number)
            later, earlier = (span, place) if begin >= start else (place, span)
            who, owner = (one, other) if begin >= start else (other, one)
            yield Diagnostic(
                code="GS624",
                span=later,
                related=earlier,
                message=f"`{who.channel}` takes T{number} at {max(begin, start):.2f} s, "
                f"which `{owner.channel}` has in its spindle",
                hint="nobody waits for what is loaded at the start (`loaded_tool`) or put in by hand (M61): give each "
                "a tool of its own, or let it be fetched by an M6",
                time=max(begin, start),
            )


def _in_spindle(occupant: Occupant) -> list[tuple[int, float, float, Span]]:
    """Which tool is in the spindle from when until when [s], and where the program takes it."""
    changes = [timed for timed in occupant.plan.trajectory.events if isinstance(timed.event, ToolChange | ToolNumber)]
    numbers = [occupant.loaded, *(timed.event.tool for timed in changes)]  # type: ignore[attr-defined]
    begins = [0.0, *(timed.time for timed in changes)]
    spans = [_span_at(occupant.plan, 0.0), *(timed.event.span for timed in changes)]
    ends = [*begins[1:], np.inf]
    return [row for row in zip(numbers, begins, ends, spans, strict=True) if row[0] != 0]

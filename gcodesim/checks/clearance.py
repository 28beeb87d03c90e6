"""A whole plan against the fixtures of a cell: where the tool goes, which one it is, and what it hits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon.systems import name_of_system
from gcodesim.cell.stock import Box, Cylinder, Mesh, Shape
from gcodesim.checks.collisions import FixtureBody, ToolParts, collision_finding, fixture_touches
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Array, Pose, rotation_about
from gcodesim.motion.tool_path import ToolState

if TYPE_CHECKING:
    from gcodesim.planning.plan import Plan
    from gcodesim.tools.tool import Tool

# between two of these times the tip is taken to go straight: 0.02 mm off on an arc of 20 mm radius at 10 m/min
CHORD: Final = 0.01  # [s]
_BLOCK: Final = 50_000  # times whose poses are kept at once
_UP: Final = np.array([0.0, 0.0, 1.0])


def fixture_body(name: str, shape: Shape, X: Pose) -> FixtureBody | None:
    """A fixture of the cell with its own frame at `X`; None for a shape that is no body."""
    if isinstance(shape, Box):
        return FixtureBody.box(name, shape.lower, shape.upper, X)
    if isinstance(shape, Cylinder):
        return FixtureBody.cylinder(name, shape.radius, shape.bottom, shape.top, X)
    if isinstance(shape, Mesh):
        from gcodesim.material.mesh import read_mesh

        points, triangles = read_mesh(shape.path, shape.scale)
        return FixtureBody.mesh(name, points, triangles, X)
    return None


@dataclass(frozen=True, slots=True, eq=False)
class Standing:
    """Fixtures that stand on one thing: their places in its frame C, and X_BC (n, 4, 4) at joints `q` (n, j).

    Without `carrier` they stand still, and their places are those in B.
    """

    fixtures: tuple[FixtureBody, ...]
    carrier: Callable[[Array], Array] | None = None


def clearance_findings(
    plan: Plan, tools: Mapping[int, Tool], standing: Iterable[Standing], *, X_BM: Pose | None = None
) -> list[Diagnostic]:
    """GS301 to GS304 of every time that a tool enters a fixture on the whole plan.

    `X_BM` is machine zero in B, for places in the work system.
    """
    trajectory, path = plan.trajectory, plan.path
    standing = [some for some in standing if some.fixtures]
    if not standing or not len(path):
        return []
    duration = trajectory.duration
    regular = np.arange(0.0, duration, CHORD)
    time = np.unique(np.concatenate([regular, trajectory.boundaries(0.0, duration), [duration]]))
    found = [hit for some in standing for hit in _hits(plan, tools, some, time, X_BM or Pose.identity())]
    return [finding for _, finding in sorted(found, key=lambda entry: entry[0])]


def _hits(
    plan: Plan, tools: Mapping[int, Tool], standing: Standing, time: Array, X_BM: Pose
) -> Iterator[tuple[float, Diagnostic]]:
    """When a tool enters one of these fixtures, and what is to be said about it."""
    trajectory, path, carrier = plan.trajectory, plan.path, standing.carrier
    way = _way(plan, time, carrier)
    tool_of_chord = np.array([state.tool for state in path.states])[path.state[way.row]]
    for number in np.unique(tool_of_chord).tolist():
        if number not in tools:
            continue
        mine = np.flatnonzero(tool_of_chord == number)
        tips = way.nose + tools[number].true_length * way.out
        axis = -(way.out[:-1] + way.out[1:])[mine]
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
        touches = fixture_touches(ToolParts.of(tools[number]), standing.fixtures, tips[mine], tips[mine + 1], axis)
        for touch in touches:
            chord = int(mine[touch.piece])
            when = float(time[chord] + touch.share * (time[chord + 1] - time[chord]))
            point_B = np.array(touch.tip)
            if carrier is not None:
                q = plan.joints(trajectory.sample(np.array([when])))
                point_B = Pose.from_matrix(carrier(q)[0]).apply(point_B)
            state = path.state_of(int(way.row[chord]))
            system, point = place_in_system(X_BM.inverse().apply(point_B), state)
            span = path.span(int(way.row[chord]))
            yield when, collision_finding(touch, span, system, point, when)


@dataclass(frozen=True, slots=True, eq=False)
class _Way:
    """Chords of a plan: the flange at n + 1 times, `nose` (n + 1, 3) and its Z `out`, and the path row (n,) of each."""

    nose: Array
    out: Array
    row: NDArray[np.int64]


def _way(plan: Plan, time: Array, carrier: Callable[[Array], Array] | None) -> _Way:
    nose, out = np.empty((len(time), 3)), np.empty((len(time), 3))
    for first in range(0, len(time), _BLOCK):
        rows = slice(first, first + _BLOCK)
        q = plan.joints(plan.trajectory.sample(time[rows]))
        X = plan.kinematics.forward(q)
        if carrier is not None:
            X = np.linalg.inv(carrier(q)) @ X
        nose[rows], out[rows] = X[:, :3, 3], X[:, :3, 2]
    # the row in the middle of a chord, since its ends may belong to two
    return _Way(nose, out, plan.trajectory.sample(0.5 * (time[:-1] + time[1:])).row)


def place_in_system(p_M: Array, state: ToolState) -> tuple[str, Array]:
    """Name of the work system in force and the point (3,) of M as the program would write it [m].

    The other way round as on a control: ``end = R(rotation) (program + g92) + offset``.
    """
    R = rotation_about(_UP, state.rotation)
    point = R.T @ (p_M - np.array(state.system_offset[:3])) - np.array(state.g92[:3])
    return name_of_system(state.system), point

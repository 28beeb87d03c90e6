"""Checks a whole plan against the fixtures of a cell: where each tool goes, and what it hits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied, norms
from gcodesim.canon.systems import name_of_system
from gcodesim.checks.collisions import Obstacle, ToolParts, collision_finding, fixture_touches, place_in_words
from gcodesim.checks.pairs import may_not_meet
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import ToolState
from gcodesim.scene import Role, Scene

if TYPE_CHECKING:
    from gcodesim.planning.plan import Plan
    from gcodesim.tools.tool import Tool

# between two of these times the tip is taken to go straight: 0.02 mm off on an arc of 20 mm radius at 10 m/min
CHORD: Final = 0.01  # [s]
_BLOCK: Final = 50_000  # times whose poses are kept at once


@frozen(kw_only=False, eq=False)
class Standing:
    """Bodies of one role on one carrier: their places in its frame C, and X_BC (n, 4, 4) at joints `q` (n, j).

    Without `carrier` they stand still, and their places are those in B.
    """

    bodies: tuple[Obstacle, ...]
    carrier: Callable[[Array], Array] | None = None
    role: Role = "fixture"

    def only(self, names: frozenset[str] | None) -> Standing:
        """Those of these bodies that have one of the names; None: all."""
        if names is None:
            return self
        return Standing(tuple(body for body in self.bodies if body.name in names), self.carrier, self.role)


def standing_bodies(scene: Scene, base: str) -> list[Standing]:
    """The bodies of a scene that a tool on the mover `base` may not enter, by what they stand on."""
    found: dict[tuple[str, Role], list[Obstacle]] = {}
    X_BW = scene.movers[base].X_WB.inverse()
    for body in scene.bodies:
        if body.solids and any(may_not_meet(role, body.role) for role in ("tool", "holder")):
            carrier, X = scene.standing_on(body.name)
            if carrier.partition("/")[0] != base and scene.moves(carrier):
                continue  # another machine moves it: `cell_meetings` looks at that
            X = X_BW @ X if carrier == WORLD else X
            obstacle = Obstacle.of(body.label, [placed.at(X) for placed in body.solids])
            found.setdefault((carrier, body.role), []).append(obstacle)
    return [
        Standing(tuple(bodies), None if carrier == WORLD else partial(_carrier, scene, base, carrier), role)
        for (carrier, role), bodies in found.items()
    ]


def _carrier(scene: Scene, base: str, frame: str, q: Array) -> Array:
    """X_BC (n, 4, 4) of what carries something."""
    return scene.seen_from(base, frame, {base: q})


def clearance_findings(
    plan: Plan, tools: Mapping[int, Tool], standing: Iterable[Standing], *, X_BM: Pose | None = None
) -> list[Diagnostic]:
    """GS301 to GS304, for every time that a tool enters a fixture during the whole plan.

    `X_BM` is machine zero in B, for places in the work system.
    """
    trajectory, path = plan.trajectory, plan.path
    standing = [some for some in standing if some.bodies]
    if not standing or not len(path):
        return []
    duration = trajectory.duration
    regular = np.arange(0.0, duration, CHORD)
    time = distinct(np.concatenate([regular, trajectory.boundaries(0.0, duration), [duration]]))
    found = [hit for some in standing for hit in _hits(plan, tools, some, time, X_BM or Pose.identity())]
    return [finding for _, finding in sorted(found, key=lambda entry: entry[0])]


def _hits(
    plan: Plan, tools: Mapping[int, Tool], standing: Standing, time: Array, X_BM: Pose
) -> Iterator[tuple[float, Diagnostic]]:
    """When a tool enters one of these fixtures, with the finding."""
    trajectory, path, carrier = plan.trajectory, plan.path, standing.carrier
    way = _way(plan, time, carrier)
    tool_of_chord = np.array([state.tool for state in path.states])[path.state[way.row]]
    for number in distinct(tool_of_chord).tolist():
        if number not in tools:
            continue
        mine = np.flatnonzero(tool_of_chord == number)
        tips, out = tips_of(tools[number], way.flange)
        axis = -(out[:-1] + out[1:])[mine]
        axis /= norms(axis)[:, None]
        parts = ToolParts.of(tools[number]).against(standing.role)
        touches = fixture_touches(parts, standing.bodies, tips[mine], tips[mine + 1], axis)
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


@frozen(kw_only=False, eq=False)
class _Way:
    """Chords of a plan: the flange X_CF (n + 1, 4, 4) at their ends, and the path row (n,) of each."""

    flange: Array
    row: NDArray[np.int64]


def tips_of(tool: Tool, flange: Array) -> tuple[Array, Array]:
    """Where the tip of a tool is (n, 3), and where it points (n, 3), on flanges (n, 4, 4)."""
    nose, out = flange[:, :3, 3], flange[:, :3, 2]
    if tool.X_FN is None:
        return nose + tool.true_length * out, out
    X_FT = tool.X_FT
    return applied(flange[:, :3, :3], X_FT.p) + nose, applied(flange[:, :3, :3], X_FT.R[:, 2])


def _way(plan: Plan, time: Array, carrier: Callable[[Array], Array] | None) -> _Way:
    flange = np.empty((len(time), 4, 4))
    for first in range(0, len(time), _BLOCK):
        rows = slice(first, first + _BLOCK)
        q = plan.joints(plan.trajectory.sample(time[rows]))
        X = plan.kinematics.forward(q)
        if carrier is not None:
            X = multiplied(inverse_pose(carrier(q)), X)
        flange[rows] = X
    # the row in the middle of a chord, since its ends may belong to two
    return _Way(flange, plan.trajectory.sample(0.5 * (time[:-1] + time[1:])).row)


def place_in_system(p_M: Array, state: ToolState) -> tuple[str, Array]:
    """Name of the work system in force and the point (3,) of M as the program would write it [m].

    The other way round as on a control: ``end = X_MP (program + g92)``.
    """
    point = state.X_MP.inverse().apply(p_M) - np.array(state.g92[:3])
    return name_of_system(state.system), point


def tip_in_words(plan: Plan, q: Array, row: int, X_BM: Pose) -> str:
    """Where the tip is with the joints at q (j,), in the work system in force in a path row; machine zero is X_BM."""
    tip = plan.tip(q[None], np.array([row]))[0, :3, 3]
    system, point = place_in_system(X_BM.inverse().apply(tip), plan.path.state_of(row))
    return place_in_words(system, point)

"""Whether round tools enter fixtures that stay where they are, when the work of an arm is moved."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import norms
from gcodesim.checks.clearance import Standing, tips_of
from gcodesim.checks.collisions import Obstacle, ToolParts, fixture_touches
from gcodesim.frames import Array
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.planning.arm_joints import ArmJoints
    from gcodesim.tools.tool import Tool


class _Sweep(NamedTuple):
    """The `parts` of a tool whose tip goes from `start` to `end` (m, 3) in B, `axis` (m, 3) pointing to the holder."""

    parts: ToolParts
    start: Array
    end: Array
    axis: Array


@frozen(kw_only=False, eq=False)
class MovedWork:
    """What tools sweep along the cuts of an arm, and the bodies that stay, all in B, while its work is where it is."""

    sweeps: tuple[_Sweep, ...]
    staying: tuple[Obstacle, ...]

    @staticmethod
    def of(
        paths: Iterable[ArmJoints], tools: Mapping[int, Tool], standing: Iterable[Standing], along: frozenset[str]
    ) -> MovedWork:
        """Of paths without external axes; bodies that go `along` with the work, by their names, are no matter."""
        still = [each for each in standing if each.carrier is None]
        staying = tuple(body for each in still for body in each.bodies if body.name not in along)
        return MovedWork(tuple(s for path in paths for s in _sweeps_of(path, tools)) if staying else (), staying)

    def enters(self, shift: Array) -> bool:
        """Whether a tool enters one of the bodies with the work moved by (3,) [m] in B."""
        return any(
            fixture_touches(sweep.parts, self.staying, sweep.start + shift, sweep.end + shift, sweep.axis)
            for sweep in self.sweeps
        )


def _sweeps_of(path: ArmJoints, tools: Mapping[int, Tool]) -> list[_Sweep]:
    """Those of each tool along straight stretches from node to node, without the joint moves between cuts."""
    nodes, pieces = path.nodes, path.flange.pieces
    ends = nodes.segments
    if not len(ends):
        return []
    flange = path.flange.at(nodes.piece, nodes.s)
    numbers = np.array([state.tool for state in pieces.path.states], dtype=np.int64)
    held = numbers[pieces.path.state[pieces.row_first[nodes.piece[ends]]]]
    found = []
    for number in distinct(held).tolist():
        if number in tools:
            own = ends[held == number]
            tips, out = tips_of(tools[number], flange)
            axis = -(out[own - 1] + out[own])
            parts = ToolParts.of(tools[number]).against("fixture")
            found.append(_Sweep(parts, tips[own - 1], tips[own], axis / norms(axis)[:, None]))
    return found

"""Postures of an arm in which it hits something: what its planner asks while it searches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import applied
from gcodesim.checks.machine_bodies import CarriedBody, MachineBodies, joint_at_zero, may_meet_by_motion
from gcodesim.checks.machine_collisions import body_in_words, of_machine_itself
from gcodesim.checks.meetings import MovingBodies
from gcodesim.checks.pairs import may_not_meet
from gcodesim.checks.rigid import RigidBody
from gcodesim.frames import Array, Pose

if TYPE_CHECKING:
    from gcodesim.checks.machine_collisions import MachineChecks
    from gcodesim.tools.tool import Tool

Moving = tuple[MovingBodies, tuple[CarriedBody, ...]]


@dataclass(frozen=True, eq=False)
class Postures:
    """An arm, its tools by number and what is around it at the start.

    Bodies of the machine that are in each other at `home` (j,) are drawn so, and pairs of names that are `apart` are
    not looked at. What goes `along` with the work when that is shifted, is named by its label.
    Whether `round_tools` are in fixtures counts only if asked.
    """

    machine: MachineBodies
    tools: Mapping[int, Tool]
    home: Array
    apart: frozenset[frozenset[str]] = frozenset()
    along: frozenset[str] = frozenset()
    round_tools: bool = False
    _known: dict[int, Moving] = field(default_factory=dict)

    @staticmethod
    def of(checks: MachineChecks, home: Array) -> Postures:
        """The postures of what `checks` look at on the way of a plan."""
        return Postures(checks.machine, checks.tools, np.asarray(home, dtype=float), checks.apart)

    def shifted(self, shift: Array) -> Postures:
        """The same where all that goes along with the work has been moved by (3,) [m] in the base, joints at zero."""

        def at(body: CarriedBody) -> CarriedBody:
            if body.role == "link" or body.rigid.name not in self.along:
                return body
            R_BJ = joint_at_zero(self.machine.tree, body.carrier)[:3, :3]
            moved = Pose(applied(R_BJ.T, np.asarray(shift, dtype=float)), np.eye(3))
            solids = tuple(solid.at(moved) for solid in body.rigid.solids)
            return replace(body, rigid=RigidBody(name=body.rigid.name, solids=solids, carrier=body.carrier))

        machine = replace(self.machine, bodies=tuple(at(body) for body in self.machine.bodies))
        return replace(self, machine=machine, _known={})

    def with_round_tools(self) -> Postures:
        """The same where round tools may not be in a fixture either."""
        return replace(self, round_tools=True, _known={})

    def hit(self, q: Array, tools: NDArray[np.int64] | NDArray[np.intp] | NDArray[np.int32]) -> NDArray[np.bool_]:
        """Whether a body that may not is in another one with all joints at q (n, j) and these tools (n,) held."""
        found = np.zeros(len(q), dtype=bool)
        for number in distinct(tools).tolist():
            mine = np.flatnonzero(tools == number)
            found[mine] = self._moving(number)[0].touching(q[mine]) >= 0
        return found

    def pair(self, q: Array, tool: int) -> tuple[str, str] | None:
        """The first two bodies that are in each other with all joints at q (j,), in words; None: none are."""
        moving, bodies = self._moving(tool)
        row = int(moving.touching(q[None])[0])
        if row < 0:
            return None
        one, other = (bodies[k] for k in moving.pairs[row].tolist())
        if other.part or (other.role == "link" and one.role in ("fixture", "stock")):
            one, other = other, one
        return body_in_words(one), body_in_words(other)

    def _moving(self, number: int) -> Moving:
        """All bodies with one of the tools, and those pairs of them that may not meet."""
        if number not in self._known:
            own = self.machine.bodies
            pairs = self.machine.pairs()
            bodies = list(own)
            if number in self.tools:
                bodies += self.machine.of_tool(self.tools[number])
                pairs += [
                    (i, j)
                    for j in range(len(own), len(bodies))
                    for i in range(len(own))
                    if may_meet_by_motion(bodies[i], bodies[j], self.machine.tree)
                    or (self._asks_for_tools(bodies[i]) and _enters(bodies[j], bodies[i]))
                ]
            names = [body.rigid.name for body in bodies]
            pairs = [pair for pair in pairs if frozenset(names[k] for k in pair) not in self.apart]
            drawn = [pair for pair in pairs if of_machine_itself(*(bodies[k] for k in pair))]
            moving = self.machine.moving(bodies, pairs)
            inside = [pair for pair in drawn if moving.of_pairs([pair]).touching(self.home[None])[0] >= 0]
            moving = moving.of_pairs([pair for pair in pairs if pair not in inside])
            self._known[number] = moving, tuple(bodies)
        return self._known[number]

    def _asks_for_tools(self, body: CarriedBody) -> bool:
        """Whether round tools may not be in a body; of one that goes along with the work no other place says more."""
        return self.round_tools and body.rigid.name not in self.along


def _enters(tool: CarriedBody, other: CarriedBody) -> bool:
    """Whether a part of a tool would be in a body that moves against it, which is a collision."""
    return tool.carrier != other.carrier and may_not_meet(tool.role, other.role)

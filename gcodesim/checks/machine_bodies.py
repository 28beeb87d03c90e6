"""The bodies that a machine carries and those around it, on its joints, and which of them may not meet."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import inverse_pose, multiplied, norm, norms
from gcodesim.checks.meetings import MovingBodies
from gcodesim.checks.pairs import keep_apart, pairs_by_kind, role_of_part
from gcodesim.checks.rigid import RigidBody
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.kinematics.chain import BASE, FLANGE, Tree
from gcodesim.processes import PROCESSES
from gcodesim.scene import WORK, Mover, Role, Scene
from gcodesim.solids import Mesh, Placed
from gcodesim.tools.parts import body_part

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool

BASE_JOINT: Final = -1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CarriedBody:
    """A rigid body of a cell: its `role`, and the `part` of a tool that it is.

    `any_shape`: the part is no body of revolution, so what it does to fixtures and stock is looked for here, too, as
    of a link; `clearance` sees round ones. `works`: it touches the work by design.
    """

    rigid: RigidBody
    role: Role
    part: str = ""
    any_shape: bool = False
    works: bool = False

    @property
    def carrier(self) -> int:
        return self.rigid.carrier


@dataclass(frozen=True, slots=True, eq=False)
class MachineBodies:
    """Links of `mover` and what stands on them or around them."""

    mover: Mover
    bodies: tuple[CarriedBody, ...]

    @staticmethod
    def of(scene: Scene, name: str) -> MachineBodies:
        """Bodies of a scene with a solid that can be read; a stock has the shape it has at the start."""
        mover = scene.movers[name]
        return MachineBodies(mover, (*links_of(mover), *_around(scene, mover)))

    @property
    def tree(self) -> Tree:
        return self.mover.kinematics.chain.tree

    def of_tool(self, tool: Tool) -> list[CarriedBody]:
        """Each part of a tool on the flange."""
        tree = self.tree
        X_JT = Pose.from_matrix(tree.flange_offset) @ tool.X_FT
        shapes = [(body.part, body.placed, False) for body in tool.round_parts]
        shapes += [(part, placed, True) for part, placed in tool.own_shapes() if readable(placed)]
        parts: dict[tuple[str, bool], list[Placed]] = {}
        for part, placed, any_shape in shapes:
            parts.setdefault((part, any_shape), []).append(placed.at(X_JT))
        return [
            CarriedBody(
                rigid=RigidBody(name=tool.name, solids=tuple(solids), carrier=tree.flange_carrier),
                role=role_of_part(part),
                part=part,
                any_shape=any_shape,
                works=_works(tool, part),
            )
            for (part, any_shape), solids in parts.items()
        ]

    def greatest_reach(self, tools: Iterable[Tool], travel: Array) -> Array:
        """How far (j,) [m] a joint that turns may move any point per radian; 1 for joints that shift.

        `travel` (j,) [m] is how far each of these goes from zero at most.
        """
        tree = self.tree
        reach = np.where(tree.prismatic == 1, 1.0, 0.0)
        bodies = [*self.bodies, *(part for tool in tools for part in self.of_tool(tool))]
        for body in bodies:
            centre, size = body.rigid.balls
            far = float((norms(centre) + size).max())
            joint = body.carrier
            while joint >= 0:
                shifts = bool(tree.prismatic[joint])
                reach[joint] = max(reach[joint], 0.0 if shifts else far)
                far += norm(tree.before[joint, :3, 3]) + (float(travel[joint]) if shifts else 0.0)
                joint = int(tree.parent[joint])
        return reach

    def pairs(self) -> list[tuple[int, int]]:
        """Bodies that may not meet, and that move against each other."""
        bodies, tree, allowed = self.bodies, self.tree, self._allowed()

        def meets(i: int, j: int) -> bool:
            one, other = bodies[i], bodies[j]
            links = one.role == other.role == "link"
            if links and frozenset((one.carrier, other.carrier)) in allowed:
                return False
            return may_meet_by_motion(one, other, tree)

        return pairs_by_kind([(body.carrier, body.role, body.any_shape) for body in bodies], meets)

    def _allowed(self) -> frozenset[frozenset[int]]:
        """Joints whose links the cell lets meet; what is fixed to a link is one body with it."""
        names, carriers = self.mover.kinematics.link_names, self.tree.carrier
        return frozenset(frozenset(int(carriers[names.index(name)]) for name in pair) for pair in self.mover.may_meet)

    def moving(self, bodies: Sequence[CarriedBody], pairs: Sequence[tuple[int, int]]) -> MovingBodies:
        """These bodies on the joints."""
        rows: NDArray[np.int64] = np.array(pairs, dtype=np.int64).reshape(-1, 2)
        return MovingBodies(self.tree, [body.rigid for body in bodies], rows)


def may_meet_by_motion(one: CarriedBody, other: CarriedBody, tree: Tree) -> bool:
    """Whether two bodies move against each other and may not meet; neighbours on a joint touch by design."""
    roles: list[Role] = ["link" if body.any_shape else body.role for body in (one, other)]
    if one.carrier == other.carrier or not keep_apart(roles[0], roles[1]):
        return False
    if "stock" in roles and (one.works or other.works):
        return False
    both_links = one.role == other.role == "link"
    neighbours = _parent(tree, one.carrier) == other.carrier or _parent(tree, other.carrier) == one.carrier
    return not (both_links and neighbours)


def _works(tool: Tool, part: str) -> bool:
    """Whether a part touches the work: by its kind, as the tip, or as part of a tool without one that lays material."""
    if body_part(part).acts or tool.body is None:
        return body_part(part).acts
    lays = any(PROCESSES[kind].lays for kind in tool.processes)
    return lays if tool.body.tip is None else part == tool.body.tip


def _parent(tree: Tree, joint: int) -> int | None:
    """The joint that carries a joint; None for the base."""
    return int(tree.parent[joint]) if joint >= 0 else None


def links_of(mover: Mover) -> Iterator[CarriedBody]:
    """The links of a mover by their shapes for collisions; what is fixed to each other is one body."""
    chain = mover.kinematics.chain
    tree = chain.tree
    solids: dict[int, list[Placed]] = {}
    names: dict[int, str] = {}
    for shape in chain.shapes("collision"):
        if readable(shape.placed):
            carrier = int(tree.carrier[shape.link])
            name = chain.link_names[shape.link] if shape.link else chain.base_name
            names.setdefault(carrier, name)
            solids.setdefault(carrier, []).append(shape.placed.at(Pose.from_matrix(tree.offset[shape.link])))
    for carrier in sorted(solids):
        rigid = RigidBody(name=f"{mover.name}/{names[carrier]}", solids=tuple(solids[carrier]), carrier=carrier)
        yield CarriedBody(rigid=rigid, role="link")


def _around(scene: Scene, mover: Mover) -> Iterator[CarriedBody]:
    """Fixtures and stocks, on the joint that moves them or on the base; not what another machine moves.

    `cell_meetings` looks at that, by the motion of both.
    """
    for body in scene.bodies:
        solids = [placed for placed in body.solids if readable(placed)]
        if body.role == "link" or not solids:
            continue
        frame, X = scene.standing_on(body.name)
        if frame.partition("/")[0] != mover.name and scene.moves(frame):
            continue
        carrier, X_JF = on_joint(mover, frame)
        placed = tuple(solid.at(X_JF @ X) for solid in solids)
        yield CarriedBody(rigid=RigidBody(name=body.label, solids=placed, carrier=carrier), role=body.role)


def on_joint(mover: Mover, frame: str) -> tuple[int, Pose]:
    """The joint that moves a frame of the mover, and where the frame stands on it; others stand on the base."""
    name, _, link = frame.partition("/")
    if frame == WORLD or name != mover.name:
        return BASE_JOINT, mover.X_WB.inverse()
    chain = mover.kinematics.chain
    tree = chain.tree
    if link == WORK:
        joint = int(tree.carrier[chain.link_names.index(chain.table)]) if chain.table is not None else BASE_JOINT
    elif link in chain.link_names:
        joint = int(tree.carrier[chain.link_names.index(link)])
    elif link == FLANGE:
        joint = int(tree.flange_carrier)
    else:
        assert link in (BASE, chain.base_name), frame
        joint = BASE_JOINT
    zero = np.zeros((1, len(mover.kinematics.joints)))
    X_BF: Array = mover.seen_from_base(link, zero)[0]
    if joint == BASE_JOINT:
        return joint, Pose.from_matrix(X_BF)
    return joint, Pose.from_matrix(multiplied(inverse_pose(joint_at_zero(tree, joint)[None])[0], X_BF))


def joint_at_zero(tree: Tree, joint: int) -> Array:
    """Pose (4, 4) of a joint in the base with all joints at zero."""
    X: Array = np.eye(4)
    while joint >= 0:
        X = multiplied(tree.before[joint], X)
        joint = int(tree.parent[joint])
    return X


def readable(placed: Placed) -> bool:
    """Whether the triangles of a solid can be read; a run tells of those that cannot (GS770)."""
    if isinstance(placed.solid, Mesh):
        try:
            _ = placed.solid.triangles
        except ValueError:
            return False
    return True

"""Everything that moves in a cell on one tree of joints: all machines, devices, and parts wherever they stand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import multiplied, norm
from gcodesim.checks.machine_bodies import links_of, on_joint, readable
from gcodesim.checks.pairs import role_of_part
from gcodesim.checks.rigid import RigidBody, Woods
from gcodesim.checks.way_kernels import JointTree
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.scene import PUT, Mover, Role, Scene
from gcodesim.solids import Placed

if TYPE_CHECKING:
    from gcodesim.cell.device import Device
    from gcodesim.tools.tool import Tool

STILL: Final = -1
"""The joint of what stands in the world."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CellBody:
    """A rigid body: its `role`, its `frame` in the scene, and of a link or tool the `mover` and the tool's number.

    `part` is which part of a tool it is, `opening` (0 to 1) how far open a gripper is that has this shape. `stand` is
    the number of a tool that waits in its stand.
    """

    rigid: RigidBody
    role: Role
    frame: str = ""
    mover: str = ""
    part: str = ""
    tool: int = 0
    opening: float = 1.0
    stand: int = 0


@dataclass(frozen=True, eq=False)
class CellTree:
    """Joints of movers, then of devices that move, then one for each part, which a `Stay` puts somewhere.

    All is seen from the world. `first` is the first joint of each mover, `device` that of each device, `part` that of
    each part, by their frames.
    """

    scene: Scene
    devices: Mapping[str, Device]

    @cached_property
    def first(self) -> dict[str, int]:
        found, count = {}, 0
        for name, mover in self.scene.movers.items():
            found[name] = count
            count += len(mover.home)
        return found

    @cached_property
    def device(self) -> dict[str, int]:
        count = sum(len(mover.home) for mover in self.scene.movers.values())
        return {name: count + index for index, name in enumerate(self.devices)}

    @cached_property
    def part(self) -> dict[str, int]:
        count = self.shared
        names = [body.name for body in self.scene.bodies if body.role in PUT]
        return {name: count + index for index, name in enumerate(names)}

    @property
    def shared(self) -> int:
        """How many joints there are without those of parts."""
        return sum(len(mover.home) for mover in self.scene.movers.values()) + len(self.devices)

    @cached_property
    def joints(self) -> JointTree:
        """The joints of movers and devices."""
        parent, before, axis, prismatic = [], [], [], []
        for name, mover in self.scene.movers.items():
            tree, at = mover.kinematics.chain.tree, self.first[name]
            for j in range(len(mover.home)):
                root = tree.parent[j] < 0
                parent.append(STILL if root else at + int(tree.parent[j]))
                before.append(multiplied(mover.X_WB.matrix, tree.before[j]) if root else tree.before[j])
                axis.append(tree.axis[j])
                prismatic.append(int(tree.prismatic[j]))
        for name, device in self.devices.items():
            parent.append(STILL)
            before.append(self.scene.at_rest(name).matrix)
            axis.append(direction_of(device))
            prismatic.append(1)
        return JointTree(
            np.array(parent, dtype=np.int64),
            np.array(before, dtype=float).reshape(-1, 4, 4),
            np.array(axis, dtype=float).reshape(-1, 3),
            np.array(prismatic, dtype=np.int64),
        )

    def is_flange(self, mover: str, body: CellBody) -> bool:
        """Whether a link is the one of a mover that carries tools."""
        return body.rigid.carrier == self.first[mover] + self.scene.movers[mover].kinematics.chain.tree.flange_carrier

    def carrier(self, frame: str) -> tuple[int, Pose]:
        """The joint that carries a frame which is no part's, and where the frame is on it."""
        if frame in self.device:
            return self.device[frame], Pose.identity()
        at, X = self.scene.standing_on(frame)
        if at == WORLD:
            return STILL, X
        name = at.partition("/")[0]
        mover = self.scene.movers[name]
        joint, X_JF = on_joint(mover, at)
        if joint < 0:
            return STILL, mover.X_WB @ X_JF @ X
        return self.first[name] + joint, X_JF @ X

    def carrying(self, joint: int) -> list[int]:
        """The joints from one of movers and devices to the world, the outermost first."""
        found = []
        while joint >= 0:
            found.append(joint)
            joint = int(self.joints.parent[joint])
        return found

    def with_parts(self, places: Mapping[str, tuple[int, Pose]]) -> JointTree:
        """The tree with joints for these parts alone, in their order, each at a pose on a joint; they do not move."""
        joints, count = self.joints, len(places)
        before = np.array([X.matrix for _, X in places.values()]).reshape(-1, 4, 4)
        return JointTree(
            np.concatenate([joints.parent, np.array([at for at, _ in places.values()], dtype=np.int64)]),
            np.ascontiguousarray(np.concatenate([joints.before, before])),
            np.ascontiguousarray(np.concatenate([joints.axis, np.tile([1.0, 0.0, 0.0], (count, 1))])),
            np.concatenate([joints.prismatic, np.ones(count, dtype=np.int64)]),
        )


def direction_of(device: Device) -> Array:
    """The direction (3,) in its frame in which a device, or its belt, goes."""
    travel = np.array(device.travel)
    way = norm(travel)
    if device.speed > 0.0 or way == 0.0:
        return np.array([1.0, 0.0, 0.0])
    direction: Array = travel / way
    return direction


@dataclass(frozen=True, eq=False)
class CellBodies:
    """All bodies of a cell that may meet by motion, on the joints of `tree`."""

    tree: CellTree
    bodies: tuple[CellBody, ...]

    @staticmethod
    def of(
        tree: CellTree,
        tools: Mapping[str, Sequence[tuple[int, Tool, Sequence[float]]]],
        parked: Sequence[tuple[int, Tool, Pose]] = (),
    ) -> CellBodies:
        """`tools` are those that each mover takes, with their numbers and how far open a gripper is seen.

        `parked` are those that have a stand, with the poses X_WT in it.
        """
        bodies = [body for mover in tree.scene.movers.values() for body in _links(tree, mover)]
        bodies += _standing(tree)
        bodies += [_parked(number, tool, X_WT) for number, tool, X_WT in parked]
        for name, own in tools.items():
            for number, tool, openings in own:
                for opening in openings:
                    bodies += _tool(tree, tree.scene.movers[name], number, tool, opening)
        return CellBodies(tree, tuple(bodies))

    @cached_property
    def rigid(self) -> list[RigidBody]:
        return [body.rigid for body in self.bodies]

    @cached_property
    def woods(self) -> Woods:
        return Woods.of(self.rigid)

    @cached_property
    def carrier(self) -> NDArray[np.int64]:
        """The joint (b,) of each body."""
        return np.array([body.rigid.carrier for body in self.bodies], dtype=np.int64)

    def reach(self, travel: Array, places: Sequence[tuple[int, str, Pose]]) -> Array:
        """How far (j,) [m] a joint that turns may move any point per radian; 1 for joints that shift.

        `travel` (j,) [m] is how far these go at most, `places` where parts stand in the course of time.
        """
        joints = self.tree.joints
        reach = np.where(joints.prismatic == 1, 1.0, 0.0)
        farthest = [(body.rigid.carrier, float(far)) for body, far in zip(self.bodies, self.woods.far, strict=True)]
        size = {body.frame: float(far) for body, far in zip(self.bodies, self.woods.far, strict=True)}
        on_parts = [(at, norm(X.p) + size[name]) for at, name, X in places if name in size]
        for carrier, far in [*(each for each in farthest if each[0] < len(reach)), *on_parts]:
            for joint in self.tree.carrying(carrier):
                shifts = bool(joints.prismatic[joint])
                reach[joint] = max(reach[joint], 0.0 if shifts else far)
                far += norm(joints.before[joint, :3, 3]) + (float(travel[joint]) if shifts else 0.0)
        return reach


def _links(tree: CellTree, mover: Mover) -> list[CellBody]:
    """The links of a mover, seen from the world."""
    found = []
    for link in links_of(mover):
        joint, rigid = link.carrier, link.rigid
        solids = rigid.solids if joint >= 0 else tuple(solid.at(mover.X_WB) for solid in rigid.solids)
        at = tree.first[mover.name] + joint if joint >= 0 else STILL
        body = RigidBody(name=rigid.name, solids=solids, carrier=at)
        found.append(CellBody(rigid=body, role="link", frame=rigid.name, mover=mover.name))
    return found


def _standing(tree: CellTree) -> list[CellBody]:
    """Fixtures, stocks in their shape at the start, devices, parts and loose pieces."""
    found = []
    for body in tree.scene.bodies:
        solids = tuple(placed for placed in body.solids if readable(placed))
        if body.role == "link" or not solids:
            continue
        if body.role in PUT:
            joint = tree.part[body.name]
        elif body.name in tree.devices and tree.devices[body.name].speed > 0.0:  # its belt moves, and it does not
            X_W = tree.scene.at_rest(body.name)
            joint, solids = STILL, tuple(placed.at(X_W) for placed in solids)
        else:
            joint, X = tree.carrier(body.name)
            solids = tuple(placed.at(X) for placed in solids)
        rigid = RigidBody(name=body.label, solids=solids, carrier=joint)
        mover = next((name for name, first in tree.first.items() if first <= joint < first + _count(tree, name)), "")
        found.append(CellBody(rigid=rigid, role=body.role, frame=body.name, mover=mover))
    return found


def _parked(number: int, tool: Tool, X_WT: Pose) -> CellBody:
    """A tool in its stand."""
    solids = tuple(placed.at(X_WT) for _, placed in tool.drawn() if readable(placed))
    rigid = RigidBody(name=f"{tool.name} in its stand", solids=solids, carrier=STILL)
    return CellBody(rigid=rigid, role="fixture", stand=number)


def _count(tree: CellTree, mover: str) -> int:
    return len(tree.scene.movers[mover].home)


def _tool(tree: CellTree, mover: Mover, number: int, tool: Tool, opening: float) -> list[CellBody]:
    """Each part of a tool on the flange, its fingers so far open."""
    kinematics = mover.kinematics.chain.tree
    joint = int(kinematics.flange_carrier)
    X_JT = Pose.from_matrix(kinematics.flange_offset) @ tool.X_FT
    if joint < 0:
        X_JT = mover.X_WB @ X_JT
    parts: dict[str, list[Placed]] = {}
    for part, placed in tool.drawn(opening):
        if not readable(placed):
            continue
        parts.setdefault(part, []).append(placed.at(X_JT))
    carrier = tree.first[mover.name] + joint if joint >= 0 else STILL
    return [
        CellBody(
            rigid=RigidBody(name=tool.name, solids=tuple(solids), carrier=carrier),
            role=role_of_part(part),
            mover=mover.name,
            part=part,
            tool=number,
            opening=opening,
        )
        for part, solids in parts.items()
    ]

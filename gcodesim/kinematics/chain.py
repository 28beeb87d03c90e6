"""A machine as data: links, joints, and the flattened tree that the kernels walk.

A `Chain` is what a URDF (or a table of axes) says: a tree of links whose root is
the base frame B (or M on a machine tool) and one of whose links is the flange F.
`Tree` is the same thing without fixed joints, as arrays.
"""

from __future__ import annotations

from dataclasses import field
from functools import cached_property
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.solids import Placed, Solid

JointKind = Literal["revolute", "prismatic", "fixed"]
Indices = NDArray[np.int64]

BASE = "base"
FLANGE = "flange"

SPIN_UP: float = 0.25  # [s] to full speed, where nothing names an acceleration
GREY = (0.6, 0.6, 0.62, 1.0)


@frozen(eq=False)
class LinkSolid:
    """A solid of a link, posed in the link frame by `X` (4, 4)."""

    solid: Solid
    X: Array
    rgba: tuple[float, float, float, float] = GREY


@frozen(eq=False)
class Inertial:
    """Mass [kg], centre of mass (3,) [m], inertia about it (3, 3) [kg·m²]; axes of the link, or of F for a payload."""

    mass: float
    com: Array
    inertia: Array


@frozen(eq=False)
class Link:
    """A rigid body of the chain."""

    name: str
    inertial: Inertial | None = None
    visuals: tuple[LinkSolid, ...] = ()
    collisions: tuple[LinkSolid, ...] = ()


@frozen(eq=False)
class Joint:
    """A joint from link `parent` to link `child`.

    `X` (4, 4) is the joint frame in the parent link at zero, `axis` a unit
    vector in it. Limits [rad] or [m], speed [rad/s] or [m/s], acceleration
    [rad/s²] or [m/s²], jerk [rad/s³] or [m/s³] (None: any), effort [N·m] or [N];
    infinite means unlimited.
    `mimic` names the joint that this one follows, with factor and offset.
    """

    name: str
    kind: JointKind
    parent: str
    child: str
    X: Array
    axis: Array = field(default_factory=lambda: np.array([1.0, 0.0, 0.0]))
    lower: float = -np.inf
    upper: float = np.inf
    speed: float = np.inf
    acceleration: float | None = None
    jerk: float | None = None
    effort: float = np.inf
    mimic: tuple[str, float, float] | None = None


@frozen(eq=False)
class Joints:
    """The driven joints in the one order that every array of joint values has.

    Arrays (j,), units as in `Joint`. `assumed_acceleration` (j,) marks
    accelerations that no source names: full speed in 0.25 s. An infinite jerk is none.
    """

    names: tuple[str, ...]
    kinds: tuple[JointKind, ...]
    lower: Array
    upper: Array
    speed: Array
    acceleration: Array
    jerk: Array
    effort: Array
    assumed_acceleration: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.names)

    def index(self, name: str) -> int:
        """Place of joint `name`; ValueError when there is none."""
        return self.names.index(name)

    def part(self, chosen: Indices) -> Joints:
        """Only the joints at places `chosen` (k,)."""
        return Joints(
            names=tuple(self.names[i] for i in chosen),
            kinds=tuple(self.kinds[i] for i in chosen),
            lower=self.lower[chosen],
            upper=self.upper[chosen],
            speed=self.speed[chosen],
            acceleration=self.acceleration[chosen],
            jerk=self.jerk[chosen],
            effort=self.effort[chosen],
            assumed_acceleration=self.assumed_acceleration[chosen],
        )


@frozen(eq=False)
class LinkShape:
    """A solid of a link, for scene and collision checks: `link` indexes `link_names`."""

    link: int
    placed: Placed
    rgba: tuple[float, float, float, float]


class Tree(NamedTuple):
    """The chain without fixed joints, in the form that kernels take: joints j in the order of q, arrays in C order.

    Joint i hangs on joint `parent[i]` (−1: on the base) at `before[i]` (4, 4)
    and moves about or along `axis[i]`; `prismatic[i]` is 1 or 0. Link l rides on
    joint `carrier[l]` (−1: base) at `offset[l]`; the flange likewise.
    `path[i]` is 1 when joint i moves the flange.
    """

    parent: Indices
    before: Array
    axis: Array
    prismatic: Indices
    path: Indices
    carrier: Indices
    offset: Array
    flange_carrier: int
    flange_offset: Array


@frozen(slots=False, eq=False)
class Chain:
    """A machine: `links` and `joints` (fixed ones too) from the root outwards, `driven` indices of the joints of q.

    Movable joints that are not driven (fingers, followers) stand at zero.
    `files` are the mesh files that the description names.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    driven: tuple[int, ...]
    flange: str
    table: str | None = None
    files: tuple[Path, ...] = ()

    @property
    def link_names(self) -> tuple[str, ...]:
        return tuple(link.name for link in self.links)

    @property
    def base_name(self) -> str:
        """What the root is called in the log and in cells: `base`, or its own name if another link is called so."""
        return self.links[0].name if BASE in self.link_names[1:] else BASE

    @property
    def flange_name(self) -> str:
        """What F is called in the log and in cells: `flange`, or its own name if another link is called so."""
        return self.flange if FLANGE in self.link_names else FLANGE

    @property
    def carriers(self) -> tuple[str, ...]:
        """Names in the log of everything that can carry something, the root and the flange among them."""
        return tuple(dict.fromkeys((self.base_name, *self.link_names[1:], self.flange_name)))

    @property
    def fixed_links(self) -> dict[str, Pose]:
        """X_BL of the links that no joint moves, by their own names; the root is among them, the identity."""
        tree = self.tree
        still = np.flatnonzero(tree.carrier < 0)
        return {self.links[i].name: Pose.from_matrix(tree.offset[i]) for i in still}

    @cached_property
    def driven_joints(self) -> Joints:
        """Limits of the driven joints as arrays."""
        chosen = [self.joints[i] for i in self.driven]
        speed = np.array([j.speed for j in chosen])
        named = np.array([np.nan if j.acceleration is None else j.acceleration for j in chosen])
        return Joints(
            names=tuple(j.name for j in chosen),
            kinds=tuple(j.kind for j in chosen),
            lower=np.array([j.lower for j in chosen]),
            upper=np.array([j.upper for j in chosen]),
            speed=speed,
            acceleration=np.where(np.isnan(named), speed / SPIN_UP, named),
            jerk=np.array([np.inf if j.jerk is None else j.jerk for j in chosen]),
            effort=np.array([j.effort for j in chosen]),
            assumed_acceleration=np.isnan(named),
        )

    @cached_property
    def tree(self) -> Tree:
        """The arrays that the kernels walk."""
        root = self.links[0].name
        carrier: dict[str, int] = {root: -1}
        offset: dict[str, Array] = {root: np.eye(4)}
        place = {joint: i for i, joint in enumerate(self.driven)}
        count = len(self.driven)
        parent = np.full(count, -1, dtype=np.int64)
        before = np.zeros((count, 4, 4))
        for index, joint in enumerate(self.joints):
            X = multiplied(offset[joint.parent], joint.X)
            if index in place:
                i = place[index]
                parent[i], before[i] = carrier[joint.parent], X
                carrier[joint.child], offset[joint.child] = i, np.eye(4)
            else:
                carrier[joint.child], offset[joint.child] = carrier[joint.parent], X
        path = np.zeros(count, dtype=np.int64)
        i = carrier[self.flange]
        while i >= 0:
            path[i] = 1
            i = int(parent[i])
        return Tree(
            parent=parent,
            before=before,
            axis=np.array([self.joints[i].axis for i in self.driven]).reshape(count, 3),
            prismatic=np.array([self.joints[i].kind == "prismatic" for i in self.driven], dtype=np.int64),
            path=path,
            carrier=np.array([carrier[link.name] for link in self.links], dtype=np.int64),
            offset=np.array([offset[link.name] for link in self.links]),
            flange_carrier=carrier[self.flange],
            flange_offset=np.ascontiguousarray(offset[self.flange]),
        )

    def shapes(self, what: Literal["visual", "collision"] = "visual") -> tuple[LinkShape, ...]:
        """All bodies; if a link has only bodies of the other kind, those are shown."""
        found = []
        for index, link in enumerate(self.links):
            first, second = (link.visuals, link.collisions) if what == "visual" else (link.collisions, link.visuals)
            for s in first or second:
                found.append(LinkShape(link=index, placed=Placed(s.solid, Pose.from_matrix(s.X)), rgba=s.rgba))
        return tuple(found)

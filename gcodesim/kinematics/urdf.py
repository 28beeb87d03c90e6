"""Reader of URDF: any user's robot description becomes a `Chain`, faults become findings.

Read are links with inertials, visuals and collisions (box, cylinder, capsule,
sphere, mesh file), and joints with limits and mimic. The attributes
`acceleration` ([rad/s²] or [m/s²]) and `jerk` ([rad/s³] or [m/s³]) of `<limit>` are
extensions of ours that other readers skip. The flange F is the link that the cell
names, else `tool0`, else `flange`, else `tcp`, else the end of the longest chain; a link
`table` on a branch of its own is the work side of a machine tool.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

import numpy as np

from gcodesim.arithmetic.matrices import multiplied, norm
from gcodesim.declarations.reading import suggestion
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Array, Pose, rotation_from_rpy
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import GREY, Chain, Inertial, Joint, JointKind, Link, LinkSolid
from gcodesim.kinematics.urdf_meshes import EXPAND, MeshFiles
from gcodesim.kinematics.urdf_tree import TreeReader
from gcodesim.kinematics.xml_lines import Faults, LinedElement, read_description
from gcodesim.solids import Box, Cylinder, Mesh, MeshFile, Sphere

_BODIES: Final = "box, cylinder, capsule, sphere or mesh"
_OTHERS: Final = {
    "sdf": "Gazebo's SDF is another format: export a URDF",
    "mujoco": "MuJoCo's MJCF goes beside `mjcf:`",
    "mujocoinclude": "this is a part of an MJCF: name the file that includes it, by `mjcf:`",
}
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_KINDS: Final[dict[str, JointKind]] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}


@frozen
class NamedFlange:
    """The link that a cell takes as the flange, and where the cell says so."""

    link: str
    span: Span


def load_urdf(
    path: Path,
    *,
    name: str | None = None,
    packages: Mapping[str, Path] | None = None,
    may_read: Callable[[Path], bool] | None = None,
    flange: NamedFlange | None = None,
    robot: bool = True,
) -> tuple[Chain | None, list[Diagnostic]]:
    """The chain that the file describes, and what is wrong with it; None when an error leaves no chain.

    `name` is how findings call the file (default: its name). `packages` maps the
    names in package:// to folders; `may_read` says which mesh files are allowed.
    Mesh files are looked for, not read. What is no `robot`, such as a tool, need not move: then every joint that
    moves and follows none is driven, and F is the root unless it is named. Never raises for a fault of the file.
    """
    faults = Faults(name or path.name)
    root = read_description(path, "URDF", faults)
    if root is None:
        return None, faults.findings
    chain = _Reader(path, faults, MeshFiles(path, packages or {}, may_read, faults), flange, robot).chain(root)
    return (None if faults.failed else chain), faults.findings


class _Reader:
    """One file being read; findings are collected, faulty parts left out."""

    def __init__(self, path: Path, faults: Faults, meshes: MeshFiles, flange: NamedFlange | None, robot: bool) -> None:
        self.path = path
        self.faults = faults
        self.find = faults.find
        self.meshes = meshes
        self.flange = flange
        self.robot = robot
        self.colours: dict[str, tuple[float, ...]] = {}
        self.places: dict[str, LinedElement] = {}

    # numbers

    def numbers(self, e: LinedElement, key: str, count: int, default: tuple[float, ...]) -> tuple[float, ...]:
        """The `count` numbers of attribute `key`, or `default` with a finding when they are not numbers."""
        text = e.get(key)
        if text is None:
            return default
        words = text.split()
        if len(words) != count or not all(_NUMBER.fullmatch(word) for word in words):
            wanted = "a number" if count == 1 else f"{count} numbers"
            self.find("GS765", f'`{key}="{text}"` of <{e.tag}> should be {wanted}', e, _remedy(text, count))
            return default
        values = tuple(float(word) for word in words)
        if not all(np.isfinite(values)):
            self.find("GS765", f'`{key}="{text}"` of <{e.tag}> is too large a number', e, "units are m, rad and kg")
            return default
        return values

    def number(self, e: LinedElement, key: str, default: float) -> float:
        return self.numbers(e, key, 1, (default,))[0]

    def pose(self, e: LinedElement) -> Array:
        """The matrix (4, 4) of the child <origin>, identity without one."""
        origin = e.child("origin")
        if origin is None:
            return np.eye(4)
        x, y, z = self.numbers(origin, "xyz", 3, (0.0, 0.0, 0.0))
        roll, pitch, yaw = self.numbers(origin, "rpy", 3, (0.0, 0.0, 0.0))
        return Pose(np.array([x, y, z]), rotation_from_rpy(roll, pitch, yaw)).matrix

    # links

    def inertial(self, e: LinedElement) -> Inertial | None:
        found = e.child("inertial")
        if found is None:
            return None
        mass_element, tensor = found.child("mass"), found.child("inertia")
        mass = self.number(mass_element, "value", 0.0) if mass_element is not None else 0.0
        if mass < 0.0:
            self.find("GS765", f"a mass of {mass:g} kg cannot be", mass_element, "0 if it is not known")
        tensor3 = np.zeros((3, 3))
        if tensor is not None:
            for r, c, key in ((0, 0, "ixx"), (1, 1, "iyy"), (2, 2, "izz"), (0, 1, "ixy"), (0, 2, "ixz"), (1, 2, "iyz")):
                tensor3[r, c] = tensor3[c, r] = self.number(tensor, key, 0.0)
        X = self.pose(found)
        return Inertial(mass=mass, com=X[:3, 3].copy(), inertia=multiplied(X[:3, :3], tensor3, X[:3, :3].T))

    def colour(self, e: LinedElement) -> tuple[float, ...] | None:
        material = e.child("material")
        if material is None:
            return None
        colour = material.child("color")
        if colour is None:
            return self.colours.get(material.get("name", ""))
        return self.numbers(colour, "rgba", 4, GREY)

    def shapes(self, e: LinedElement) -> list[LinkSolid]:
        """The bodies of one <visual> or <collision>; a capsule becomes a cylinder and two spheres."""
        geometry = e.child("geometry")
        body = next((c for c in geometry if isinstance(c, LinedElement)), None) if geometry is not None else None
        if body is None:
            hint = f"take the <{e.tag}> out, or put a body into it: {_BODIES}"
            self.find("GS765", f"<{e.tag}> has no <geometry> with a body", e, hint)
            return []
        X = self.pose(e)
        r, g, b, a = self.colour(e) or GREY
        rgba = (r, g, b, a)
        if body.tag == "box":
            x, y, z = self.numbers(body, "size", 3, (0.0, 0.0, 0.0))
            return [LinkSolid(solid=Box.about_origin((x, y, z)), X=X, rgba=rgba)]
        if body.tag == "sphere":
            return [LinkSolid(solid=Sphere(radius=self.number(body, "radius", 0.0)), X=X, rgba=rgba)]
        if body.tag in ("cylinder", "capsule"):
            radius, length = self.number(body, "radius", 0.0), self.number(body, "length", 0.0)
            rod = Cylinder(radius=radius, bottom=-0.5 * length, top=0.5 * length)
            parts = [LinkSolid(solid=rod, X=X, rgba=rgba)]
            if body.tag == "capsule":
                for end in (-0.5 * length, 0.5 * length):
                    shift = Pose(np.array([0.0, 0.0, end]), np.eye(3)).matrix
                    parts.append(LinkSolid(solid=Sphere(radius=radius), X=multiplied(X, shift), rgba=rgba))
            return parts
        if body.tag == "mesh":
            mesh = self.meshes.locate(body)
            x, y, z = self.numbers(body, "scale", 3, (1.0, 1.0, 1.0))
            if mesh is None:
                return []
            return [LinkSolid(solid=Mesh(source=MeshFile(path=mesh, scale=(x, y, z))), X=X, rgba=rgba)]
        self.find("GS765", f"<{body.tag}> is no body that URDF knows", body, _BODIES)
        return []

    def link(self, e: LinedElement) -> Link:
        visuals = [shape for v in e.children("visual") for shape in self.shapes(v)]
        collisions = [shape for c in e.children("collision") for shape in self.shapes(c)]
        name = e.get("name", "")
        return Link(name=name, inertial=self.inertial(e), visuals=tuple(visuals), collisions=tuple(collisions))

    # joints

    def joint(self, e: LinedElement) -> Joint | None:
        """One <joint>; None with a finding if it cannot be used."""
        name, kind = e.get("name", ""), e.get("type", "")
        ends = [e.child("parent"), e.child("child")]
        parent, child = ("" if end is None else end.get("link", "") for end in ends)
        if kind not in _KINDS:
            hint = "revolute, continuous, prismatic and fixed joints are simulated"
            self.find("GS766", f"joint `{name}` is of type `{kind}`, which is not simulated", e, hint)
            return None
        axis = self.axis(e, name) if _KINDS[kind] != "fixed" else np.array([1.0, 0.0, 0.0])
        if axis is None:
            return None
        lower, upper, speed, effort, acceleration = self.limits(e, name, kind)
        limit = e.child("limit")
        mimic = None
        follows = e.child("mimic")
        if follows is not None:
            factor, offset = self.number(follows, "multiplier", 1.0), self.number(follows, "offset", 0.0)
            mimic = (follows.get("joint", ""), factor, offset)
        return Joint(
            name=name,
            kind=_KINDS[kind],
            parent=parent,
            child=child,
            X=self.pose(e),
            axis=axis,
            lower=lower,
            upper=upper,
            speed=speed,
            acceleration=acceleration,
            jerk=None if limit is None else self.number(limit, "jerk", 0.0) or None,
            effort=effort,
            mimic=mimic,
        )

    def axis(self, e: LinedElement, name: str) -> Array | None:
        """The unit vector (3,) about or along which a joint moves, X by default; None with a finding if it is zero."""
        element = e.child("axis")
        if element is None:
            return np.array([1.0, 0.0, 0.0])
        axis = np.array(self.numbers(element, "xyz", 3, (1.0, 0.0, 0.0)))
        length = norm(axis)
        if length < 1e-9:
            hint = 'for a joint that does not move, write `type="fixed"`'
            self.find("GS765", f"joint `{name}` has an axis without direction", element, hint)
            return None
        return axis / length

    def limits(self, e: LinedElement, name: str, kind: str) -> tuple[float, float, float, float, float | None]:
        """Lower, upper, speed, effort and acceleration of a joint. An effort or speed of 0 means: not known."""
        inf = float("inf")
        limit = e.child("limit")
        if kind == "fixed":
            return -inf, inf, inf, inf, None
        if limit is None:
            if e.child("mimic") is None:
                what = "speed" if kind == "continuous" else "travel and speed"
                self.find("GS763", f"joint `{name}` has no <limit>: its {what} are not checked", e)
            return -inf, inf, inf, inf, None
        lower, upper = -inf, inf
        if kind != "continuous":
            lower, upper = self.number(limit, "lower", 0.0), self.number(limit, "upper", 0.0)
            if not lower < upper:
                self.find(
                    "GS763", f"joint `{name}` may move from {lower:g} to {upper:g}: its travel is not checked", limit
                )
                lower, upper = -inf, inf
        speed, effort = self.number(limit, "velocity", 0.0), self.number(limit, "effort", 0.0)
        if speed <= 0.0:
            self.find("GS763", f"joint `{name}` has no `velocity` above 0: its speed is not checked", limit)
        acceleration = self.number(limit, "acceleration", 0.0)
        return lower, upper, speed if speed > 0.0 else inf, effort if effort > 0.0 else inf, acceleration or None

    # the whole

    def chain(self, root: LinedElement) -> Chain | None:
        """The whole robot; None when links and joints make no tree."""
        if root.tag != "robot":
            hint = _OTHERS.get(root.tag, "")
            self.find("GS760", f"a URDF begins with <robot>, this file with <{root.tag}>", root, hint)
            return None
        if any(e.tag.startswith("xacro:") or "ros.org/wiki/xacro" in e.tag for e in root.iter()):
            self.find("GS760", "this is a xacro template, not a URDF", root, EXPAND)
            return None
        for material in root.children("material"):
            colour = material.child("color")
            if colour is not None:
                self.colours[material.get("name", "")] = self.numbers(colour, "rgba", 4, GREY)
        links = self.links(root)
        joints = self.joints(root, links)
        self.meshes.report_packages()
        flange = None if self.flange is None else self.flange.link
        if self.flange is not None and self.flange.link not in links:
            message = f"the {'robot' if self.robot else 'tool'} has no link `{self.flange.link}`"
            hint = suggestion(self.flange.link, list(links))
            self.faults.findings.append(Diagnostic(code="GS712", message=message, span=self.flange.span, hint=hint))
        if self.faults.failed:
            return None
        reader = TreeReader(root, links, joints, self.places, self.faults)
        tree = reader.tree(flange) if self.robot else reader.loose(flange)
        if tree is None:
            return None
        return Chain(
            name=root.get("name", self.path.stem),
            links=tuple(links[name] for name in tree.links),
            joints=tree.joints,
            driven=tree.driven,
            flange=tree.flange,
            table=tree.table,
            files=tuple(self.meshes.found),
        )

    def links(self, root: LinedElement) -> dict[str, Link]:
        """All links by name."""
        links: dict[str, Link] = {}
        for e in root.children("link"):
            link = self.link(e)
            if link.name in links or not link.name:
                self.find("GS764", f"link name `{link.name}` is empty or used before", e, "each link has its own name")
                continue
            links[link.name], self.places[link.name] = link, e
        return links

    def joints(self, root: LinedElement, links: Mapping[str, Link]) -> list[Joint]:
        """The joints that can be used, in the order of the file."""
        joints: list[Joint] = []
        held: set[str] = set()
        for e in root.children("joint"):
            joint = self.joint(e)
            if joint is None:
                continue
            missing = [f"`{end}`" for end in (joint.parent, joint.child) if end not in links]
            if missing:
                message = f"joint `{joint.name}` names the link {' and '.join(missing)}, which is not there"
                near = suggestion(missing[0].strip("`"), list(links))
                hint = near if near.startswith("did") else f'add `<link name="{missing[0].strip("`")}"/>`'
                self.find("GS764", message, e, hint)
            elif joint.child in held:
                hint = "every link but the root is the child of exactly one joint"
                self.find("GS764", f"joint `{joint.name}` hangs up the link `{joint.child}` a second time", e, hint)
            elif not joint.name or f"joint {joint.name}" in self.places:
                hint = "each joint has its own name"
                self.find("GS764", f"joint name `{joint.name}` is empty or used before", e, hint)
            else:
                joints.append(joint)
                held.add(joint.child)
                self.places[f"joint {joint.name}"] = e
        return joints


def _remedy(text: str, count: int) -> str:
    """What may be wrong with numbers that cannot be read."""
    if "$" in text:
        return EXPAND
    if "," in text:
        return "numbers are separated by spaces, and their decimal sign is a point"
    return f"exactly {count} plain numbers, separated by spaces" if count > 1 else "a plain number such as 0.125"

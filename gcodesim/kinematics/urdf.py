"""Reader of URDF: any user's robot description becomes a `Chain`, faults become findings.

Read are links with inertials, visuals and collisions (box, cylinder, capsule,
sphere, mesh file), and joints with limits and mimic. The attribute
`acceleration` of `<limit>` is an extension of ours ([rad/s²] or [m/s²]) that
other readers skip. The flange F is the link `tool0`, else `flange`, else `tcp`,
else the end of the longest chain; a link `table` on a branch of its own is the
work side of a machine tool.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

import numpy as np

from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.frames import Array, Pose, rotation_from_rpy
from gcodesim.kinematics.chain import GREY, Chain, Inertial, Joint, JointKind, Link, LinkSolid
from gcodesim.kinematics.xml_lines import LinedElement, XmlError, parse_xml
from gcodesim.solids import Box, Cylinder, Mesh, MeshFile, Sphere

FLANGE_NAMES: Final = ("tool0", "flange", "tcp")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_KINDS: Final[dict[str, JointKind]] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}


def load_urdf(
    path: Path,
    *,
    name: str | None = None,
    packages: Mapping[str, Path] | None = None,
    may_read: Callable[[Path], bool] | None = None,
) -> tuple[Chain | None, list[Diagnostic]]:
    """The chain that the file describes, and what is wrong with it; None when an error leaves no chain.

    `name` is how findings call the file (default: its name). `packages` maps the
    names in package:// to folders; `may_read` says which mesh files are allowed.
    Mesh files are looked for, not read. Never raises for a fault of the file.
    """
    reader = _Reader(path, name or path.name, packages or {}, may_read)
    try:
        root = parse_xml(path.read_bytes())
    except OSError as error:
        reader.find("GS760", f"`{reader.file}` cannot be read: {error.strerror}", None)
        return None, reader.findings
    except XmlError as error:
        span = Span(reader.file, error.line, error.column, error.line, error.column + 1)
        reader.findings.append(Diagnostic(code="GS760", message=f"the URDF is not well-formed XML: {error}", span=span))
        return None, reader.findings
    chain = reader.chain(root)
    return (None if reader.failed else chain), reader.findings


class _Reader:
    """One file being read; findings are collected, faulty parts left out."""

    def __init__(
        self, path: Path, file: str, packages: Mapping[str, Path], may_read: Callable[[Path], bool] | None
    ) -> None:
        self.path = path
        self.file = file
        self.packages = packages
        self.may_read = may_read
        self.findings: list[Diagnostic] = []
        self.colours: dict[str, tuple[float, ...]] = {}
        self.meshes: list[Path] = []
        self.places: dict[str, LinedElement] = {}

    @property
    def failed(self) -> bool:
        return any(f.level >= Severity.ERROR for f in self.findings)

    def find(self, code: str, message: str, at: LinedElement | None, hint: str = "") -> None:
        span = Span(self.file)
        if at is not None:
            span = Span(self.file, at.line, at.column, at.line, at.column + len(at.tag) + 1)
        self.findings.append(Diagnostic(code=code, message=message, span=span, hint=hint))

    # numbers

    def numbers(self, e: LinedElement, key: str, count: int, default: tuple[float, ...]) -> tuple[float, ...]:
        """The `count` numbers of attribute `key`, or `default` with a finding when they are not numbers."""
        text = e.get(key)
        if text is None:
            return default
        words = text.split()
        if len(words) != count or not all(_NUMBER.fullmatch(word) for word in words):
            wanted = "a number" if count == 1 else f"{count} numbers"
            self.find("GS765", f'`{key}="{text}"` of <{e.tag}> should be {wanted}', e)
            return default
        values = tuple(float(word) for word in words)
        if not all(np.isfinite(values)):
            self.find("GS765", f'`{key}="{text}"` of <{e.tag}> is too large a number', e)
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
            self.find("GS765", f"a mass of {mass:g} kg cannot be", mass_element)
        tensor3 = np.zeros((3, 3))
        if tensor is not None:
            for r, c, key in ((0, 0, "ixx"), (1, 1, "iyy"), (2, 2, "izz"), (0, 1, "ixy"), (0, 2, "ixz"), (1, 2, "iyz")):
                tensor3[r, c] = tensor3[c, r] = self.number(tensor, key, 0.0)
        X = self.pose(found)
        return Inertial(mass=mass, com=X[:3, 3].copy(), inertia=X[:3, :3] @ tensor3 @ X[:3, :3].T)

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
            self.find("GS765", f"<{e.tag}> has no <geometry> with a body", e)
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
                    parts.append(LinkSolid(solid=Sphere(radius=radius), X=X @ shift, rgba=rgba))
            return parts
        if body.tag == "mesh":
            mesh = self.mesh(body)
            x, y, z = self.numbers(body, "scale", 3, (1.0, 1.0, 1.0))
            if mesh is None:
                return []
            return [LinkSolid(solid=Mesh(source=MeshFile(path=mesh, scale=(x, y, z))), X=X, rgba=rgba)]
        self.find("GS765", f"<{body.tag}> is no body that URDF knows", body, "box, cylinder, capsule, sphere or mesh")
        return []

    def mesh(self, e: LinedElement) -> Path | None:
        """The file that a <mesh> names, or None with a finding that names the path tried."""
        text = e.get("filename", "")
        if text.startswith("package://"):
            package, _, inner = text.removeprefix("package://").partition("/")
            if package not in self.packages:
                known = ", ".join(f"`{p}`" for p in sorted(self.packages)) or "none"
                hint = f"add `packages: {{{package}: folder}}` to the cell; packages known: {known}"
                self.find("GS761", f"mesh `{text}`: the folder of package `{package}` is not known", e, hint)
                return None
            file = self.packages[package] / inner
        else:
            file = self.path.parent / text.removeprefix("file://")
        tried = os.path.relpath(file, self.path.parent)
        if self.may_read is not None and not self.may_read(file):
            self.find("GS762", f"mesh `{text}` lies outside the folders that may be read (`{tried}`)", e)
            return None
        if not text or not file.is_file():
            self.find("GS761", f"mesh `{text}` not found; tried `{tried}` from the folder of the URDF", e)
            return None
        if file not in self.meshes:
            self.meshes.append(file)
        return file

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
        axis = np.array([1.0, 0.0, 0.0])
        axis_element = e.child("axis")
        if axis_element is not None:
            axis = np.array(self.numbers(axis_element, "xyz", 3, (1.0, 0.0, 0.0)))
            length = float(np.linalg.norm(axis))
            if length < 1e-9:
                self.find("GS765", f"joint `{name}` has an axis without direction", axis_element)
                return None
            axis = axis / length
        lower, upper, speed, effort, acceleration = self.limits(e, name, kind)
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
            effort=effort,
            mimic=mimic,
        )

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

    # the tree

    def chain(self, root: LinedElement) -> Chain | None:
        """The whole robot; None when links and joints make no tree."""
        if root.tag != "robot":
            self.find("GS760", f"a URDF begins with <robot>, this file with <{root.tag}>", root)
            return None
        if any(e.tag.startswith("xacro:") or "ros.org/wiki/xacro" in e.tag for e in root.iter()):
            self.find("GS760", "this is a xacro template, not a URDF", root, "run `xacro FILE > robot.urdf` first")
            return None
        for material in root.children("material"):
            colour = material.child("color")
            if colour is not None:
                self.colours[material.get("name", "")] = self.numbers(colour, "rgba", 4, GREY)
        links: dict[str, Link] = {}
        for e in root.children("link"):
            link = self.link(e)
            if link.name in links or not link.name:
                self.find("GS764", f"link name `{link.name}` is empty or used before", e)
                continue
            links[link.name], self.places[link.name] = link, e
        joints: list[Joint] = []
        for e in root.children("joint"):
            joint = self.joint(e)
            if joint is None:
                continue
            missing = [f"`{end}`" for end in (joint.parent, joint.child) if end not in links]
            if missing:
                self.find(
                    "GS764", f"joint `{joint.name}` names the link {' and '.join(missing)}, which is not there", e
                )
            elif joint.child in (j.child for j in joints):
                self.find("GS764", f"joint `{joint.name}` hangs up the link `{joint.child}` a second time", e)
            elif not joint.name or f"joint {joint.name}" in self.places:
                self.find("GS764", f"joint name `{joint.name}` is empty or used before", e)
            else:
                joints.append(joint)
                self.places[f"joint {joint.name}"] = e
        if self.failed:
            return None
        return self.tree(root, links, joints)

    def tree(self, root: LinedElement, links: dict[str, Link], joints: list[Joint]) -> Chain | None:
        """Order from the root outwards, flange, driven joints."""
        children = {joint.child for joint in joints}
        roots = [name for name in links if name not in children]
        if len(roots) != 1:
            what = ", ".join(f"`{r}`" for r in roots) or "none (a ring of joints)"
            self.find("GS764", f"a robot has one root link; this one has {what}", root)
            return None
        ordered: list[Joint] = []
        depth = {roots[0]: 0}
        reached = [roots[0]]
        for link in reached:  # grows while it is walked: breadth first, in the order of the file
            for joint in joints:
                if joint.parent == link:
                    ordered.append(joint)
                    reached.append(joint.child)
                    depth[joint.child] = depth[link] + 1
        if len(reached) < len(links):
            lost = ", ".join(f"`{name}`" for name in links if name not in depth)
            self.find("GS764", f"the links {lost} hang on each other, not on the root", root)
            return None
        flange = next((n for n in FLANGE_NAMES if n in depth), max(reached, key=lambda n: depth[n]))
        above = {joint.child: index for index, joint in enumerate(ordered)}
        driven = self._driven(ordered, above, flange)
        table = "table" if "table" in depth and self._driven(ordered, above, "table") else None
        if table is not None:
            driven += [i for i in self._driven(ordered, above, table) if i not in driven]
        if not driven:
            self.find("GS767", f"no joint between the root `{roots[0]}` and the flange `{flange}` can move", root)
            return None
        self._remark(ordered, driven, links)
        return Chain(
            name=root.get("name", self.path.stem),
            links=tuple(links[name] for name in reached),
            joints=tuple(ordered),
            driven=tuple(driven),
            flange=flange,
            table=table,
            files=tuple(self.meshes),
        )

    @staticmethod
    def _driven(joints: list[Joint], above: Mapping[str, int], link: str) -> list[int]:
        """Indices of the movable joints from the root to `link`."""
        found: list[int] = []
        while link in above:
            index = above[link]
            if joints[index].kind != "fixed":
                found.insert(0, index)
            link = joints[index].parent
        return found

    def _has_mass(self, link: str, joints: list[Joint], links: Mapping[str, Link]) -> bool:
        """Whether `link`, or what is fixed to it, weighs anything."""
        inertial = links[link].inertial
        if inertial is not None and inertial.mass > 0.0:
            return True
        return any(self._has_mass(j.child, joints, links) for j in joints if j.parent == link and j.kind == "fixed")

    def _remark(self, joints: list[Joint], driven: list[int], links: Mapping[str, Link]) -> None:
        """Findings about a tree that holds together: followers in the chain, idle joints, links without mass."""
        for index, joint in enumerate(joints):
            at = self.places[f"joint {joint.name}"]
            if index in driven:
                if joint.mimic is not None:
                    message = (
                        f"joint `{joint.name}` follows `{joint.mimic[0]}`; followers inside the chain are not simulated"
                    )
                    self.find("GS766", message, at)
                elif not self._has_mass(joint.child, joints, links):
                    self.find("GS769", f"link `{joint.child}` has no mass: joint efforts leave it out", at)
            elif joint.kind != "fixed":
                follows = f", follows `{joint.mimic[0]}`" if joint.mimic is not None else ""
                self.find(
                    "GS768", f"joint `{joint.name}` is not on the way to the flange{follows}: it stands at zero", at
                )

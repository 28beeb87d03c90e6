"""A MoveIt configuration as a cell: the robot description with what its SRDF and joint_limits.yaml say of it.

Facts: MoveIt 2, `moveit_setup_assistant`; SRDF, `wiki.ros.org/srdf`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Final

from gcodesim.declarations.record import FREE
from gcodesim.importers.importer import (
    FoundSetting,
    FoundSettings,
    Imported,
    Importer,
    NoSettingsError,
    heading,
    number_in,
    quoted,
    read_text,
    relative,
    written,
)
from gcodesim.kinematics.xml_lines import LinedElement, XmlError, parse_xml
from gcodesim.units import DEG, MM

_MOST_FILES: Final = 2000
_DOWN: Final = -0.9  # cosine of the flange with the vertical, below which it looks down
_UNDER: Final = 100.0  # mm from there to the work

_REASONS: Final = (
    ("virtual_joint", "where the robot stands: `base`", True),
    ("end_effector", "tools are under `tools`", True),
    ("passive_joint", "a joint without a motor", True),
    ("group", "groups of joints: a program moves the whole arm", False),
    ("link_sphere_approximation", "shapes are those of the description", False),
    ("default_", "a program says how fast it goes", False),
)


class MoveIt(Importer):
    """`import moveit FOLDER`."""

    kind: ClassVar[str] = "moveit"
    says: ClassVar[str] = (
        "a MoveIt configuration (folder or SRDF): robot, flange, named poses, allowed collisions, limits"
    )

    def read(self, path: Path, folder: Path) -> Imported:
        root = path if path.is_dir() else path.parent.parent if path.parent.name == "config" else path.parent
        srdf = _srdf(path)
        settings = FoundSettings([])
        robot = _parsed(srdf)
        urdf = _urdf(root, robot.get("name", ""))
        arm = _Arm(settings, robot, srdf, urdf)
        arm.limits(root / "config" / "joint_limits.yaml")
        lines = [*heading(srdf, "a MoveIt configuration"), *arm.lines(folder)]
        taken, left = settings.finished(_REASONS)
        return Imported(what="MoveIt configuration", lines=tuple(lines), taken=taken, left=left)


def _parsed(path: Path) -> LinedElement:
    try:
        root = parse_xml(path.read_bytes())
    except XmlError as error:
        raise NoSettingsError(f"{path}:{error.line}: no XML: {error}") from None
    if root.tag != "robot":
        raise NoSettingsError(f"{path} does not begin with <robot>")
    return root


def _srdf(path: Path) -> Path:
    """The SRDF of a folder; a plain one, since xacro templates are programs."""
    if path.is_file():
        return path
    found = sorted(path.glob("config/*.srdf")) or sorted(path.glob("*.srdf"))
    if not found:
        xacro = next(iter(sorted(path.glob("config/*.srdf.xacro"))), None)
        hint = f"; expand {xacro.name} with xacro first" if xacro else ""
        raise NoSettingsError(f"{path} has no config/*.srdf{hint}")
    return found[0]


def _urdf(root: Path, name: str) -> Path:
    """The robot description: as the setup assistant noted it, in one of the packages beside; else one of that name."""
    noted = root / ".setup_assistant"
    told = (
        re.search(r"^\s*relative_path:\s*(\S+\.urdf\S*)", read_text(noted), re.MULTILINE) if noted.is_file() else None
    )
    places = [root, *sorted(p for p in root.parent.iterdir() if p.is_dir() and p != root)]
    if told is not None:
        for place in places:
            if (place / told[1]).is_file():
                return place / told[1]
    for place in places:
        for file in sorted(place.glob("**/*.urdf"))[:_MOST_FILES]:
            if file.stem == name:
                return file
    raise NoSettingsError(
        f"no robot description {told[1] if told else name + '.urdf'} is beside {root}; expand its xacro first"
    )


class _Arm:
    """One arm: the description, and what is said of its joints and links."""

    def __init__(self, settings: FoundSettings, robot: LinedElement, srdf: Path, urdf: Path) -> None:
        from gcodesim.diagnostics import Span
        from gcodesim.kinematics.urdf import NamedFlange, load_urdf

        self.settings, self.robot, self.srdf, self.urdf = settings, robot, srdf, urdf
        self.packages = _packages(urdf)
        self.tip = self._tip()
        chain, faults = load_urdf(
            urdf, packages=self.packages, flange=NamedFlange(link=self.tip, span=Span(srdf.name)) if self.tip else None
        )
        if chain is None:
            first = next(iter(faults)).message
            raise NoSettingsError(f"{urdf}: {first}")
        self.chain = chain
        self.joints = list(chain.driven_joints.names)
        self.named = {joint: n for n, joint in enumerate(self.joints)}
        self.speed: dict[str, float] = {}
        self.acceleration: dict[str, float] = {}
        self.jerk: dict[str, float] = {}

    def _note(self, element: LinedElement, text: str) -> FoundSetting:
        setting = FoundSetting(element.tag, text, self.srdf.name, element.line)
        self.settings.all.append(setting)
        return setting

    def _tip(self) -> str:
        """The last link of the first group that is a chain."""
        for group in self.robot.children("group"):
            for chain in group.children("chain"):
                return str(chain.get("tip_link", ""))
        return ""

    def limits(self, file: Path) -> None:
        """Speeds, accelerations and jerks of joint_limits.yaml."""
        if not file.is_file():
            return
        for setting, joint, name, value, used in _limits(file):
            self.settings.all.append(setting)
            table = {"max_velocity": self.speed, "max_acceleration": self.acceleration, "max_jerk": self.jerk}.get(name)
            if joint not in self.named:
                if joint:
                    self.settings.leave(setting, "no joint of this arm")
            elif table is not None and value is not None and used:
                table[joint] = value
                self.settings.values(setting.name)
            elif name.startswith("has_"):
                self.settings.values(setting.name)
            else:
                self.settings.leave(
                    setting,
                    "limits of travel are those of the description" if "position" in name else "not in force",
                    matters="position" in name,
                )

    def lines(self, folder: Path) -> Iterator[str]:
        seen = relative(self.urdf, folder)
        if seen is None:
            raise NoSettingsError(f"the cell has to lie above {self.urdf}, or in its folder: say where by -o")
        poses = dict(self._poses())
        pairs = list(self._pairs())
        self._others()
        packages = {name: relative(place, folder) for name, place in self.packages.items()}
        there = {name: place for name, place in packages.items() if place is not None}
        if there:
            shown = ", ".join(f"{name}: {quoted(place or '.')}" for name, place in there.items())
            yield f"packages: {{{shown}}}"
        yield "robots:"
        yield "  arm:"
        yield f"    urdf: {quoted(seen)}"
        if self.tip:
            yield f"    flange: {quoted(self.tip)}"
        kinds = self.chain.driven_joints.kinds
        if poses:
            yield f"    home: {quoted(next(iter(poses)))}"
            yield "    poses:"
            for name, values in poses.items():
                yield f"      {quoted(name)}: [{_listed(values, kinds)}]"
        for key, table, unit in (
            ("speed", self.speed, "/s"),
            ("acceleration", self.acceleration, "/s^2"),
            ("jerk", self.jerk, "/s^3"),
        ):
            own = [float(v) for v in self.chain.driven_joints.speed] if key == "speed" else []
            limits = dict(zip(self.joints, own, strict=False)) | table
            if table and set(self.joints) <= set(limits):
                told = [_in(limits[joint], kind, unit) for joint, kind in zip(self.joints, kinds, strict=True)]
                yield f"    {key}: [{', '.join(told)}]"
            elif table:
                yield f"    # {key} is not said of every joint"
        if pairs:
            yield "    allow_collisions:  # disabled in the SRDF"
            for one, other in pairs:
                yield f"    - [{quoted(one)}, {quoted(other)}]"
        yield "# put the work where it is, and your tools"
        yield f"work_offsets: {{G54: {{in: world, xyz: [{self._reachable(poses)} mm]}}}}"
        yield "tools:"
        yield "  1: {type: flat_end_mill, diameter: 6, length: 50}"

    def _poses(self) -> Iterator[tuple[str, list[float]]]:
        """Named poses that tell every joint of the arm."""
        for element in self.robot.children("group_state"):
            name = str(element.get("name", ""))
            setting = self._note(element, name)
            values: dict[str, float] = {}
            for joint in element.children("joint"):
                value = number_in(str(joint.get("value", "")).split()[0]) if joint.get("value") else None
                if value is not None:
                    values[str(joint.get("name", ""))] = value
            if why := self._why_no_pose(name.strip(), values):
                self.settings.leave(setting, why)
            else:
                self.settings.take(setting)
                yield name.strip(), [values[joint] for joint in self.joints]

    def _why_no_pose(self, name: str, values: Mapping[str, float]) -> str:
        """Why a named pose cannot be one of the robot in the cell; empty if it can."""
        if not set(self.joints) <= set(values):
            return "it does not tell every joint of the arm"
        limits = self.chain.driven_joints
        for n, joint in enumerate(self.joints):
            if not limits.lower[n] - 1e-9 <= values[joint] <= limits.upper[n] + 1e-9:
                return f"`{joint}` is outside its travel there"
        return "" if name and not name.startswith(FREE) else "a cell has no pose of such a name"

    def _pairs(self) -> Iterator[tuple[str, str]]:
        for element in self.robot.children("disable_collisions"):
            pair = (str(element.get("link1", "")), str(element.get("link2", "")))
            setting = self._note(element, " and ".join(pair))
            if all(link in self.chain.link_names for link in pair):
                self.settings.take(setting)
                yield pair
            else:
                self.settings.leave(setting, "not both are links of the arm")

    def _others(self) -> None:
        """What else the SRDF says."""
        for tag in ("virtual_joint", "end_effector", "passive_joint", "group", "link_sphere_approximation"):
            for element in self.robot.children(tag):
                self._note(element, str(element.get("name", element.get("link", ""))))

    def _reachable(self, poses: Mapping[str, list[float]]) -> str:
        """A place [mm] for the work: under the flange in the named pose in which it looks down most; without one that
        looks down, a bit nearer and lower than the flange with all joints at zero."""
        import numpy as np

        from gcodesim.kinematics import kinematics_of

        kinematics = kinematics_of(self.chain)
        joints = self.chain.driven_joints
        rest = np.clip(np.zeros(len(joints)), joints.lower, joints.upper)
        X = kinematics.forward(np.array([rest, *poses.values()]))
        lowest = int(X[:, 2, 2].argmin())
        p = X[lowest, :3, 3] / MM
        if X[lowest, 2, 2] < _DOWN:
            p[2] -= _UNDER
        else:
            p = X[0, :3, 3] / MM * [0.6, 0.6, 0.4]
        return ", ".join(written(round(float(v), 1)) for v in p)


def _packages(urdf: Path) -> dict[str, Path]:
    """Folders of the packages that meshes of the description name, as far as they are beside it."""
    names = sorted(set(re.findall(r"package://([\w.-]+)/", read_text(urdf))))
    found: dict[str, Path] = {}
    manifests = [place / "package.xml" for place in (urdf.parent, *urdf.parents) if (place / "package.xml").is_file()]
    root = manifests[0].parent.parent if manifests else urdf.parent
    for manifest in sorted(root.glob("*/package.xml")):
        told = re.search(r"<name>\s*([\w.-]+)\s*</name>", read_text(manifest))
        if told is not None and told[1] in names:
            found[told[1]] = manifest.parent
    return {name: found[name] for name in names if name in found}


def _limits(file: Path) -> Iterator[tuple[FoundSetting, str, str, float | None, bool]]:
    """Each setting with its joint, name, number, and whether its `has_…_limits` lets it hold."""
    lines: list[tuple[int, int, str, str]] = []
    for number, raw in enumerate(read_text(file).splitlines(), start=1):
        line = raw.partition("#")[0].rstrip()
        if line.strip() and ":" in line:
            name, _, value = line.strip().partition(":")
            lines.append((number, len(line) - len(line.lstrip()), name.strip().strip("\"'"), value.strip()))
    has = {}
    joint, depth = "", 0
    rows: list[tuple[int, str, str, str]] = []
    for number, indent, name, value in lines:
        if indent == 0 or (not value and name == "joint_limits"):
            joint, depth = "", indent
        elif not value:
            joint, depth = name, indent
            continue
        elif indent <= depth:
            joint = ""
        if value:
            rows.append((number, joint, name, value))
            if name.startswith("has_"):
                has[joint, name] = value.lower() == "true"
    for number, joint, name, value in rows:
        kind = {"max_velocity": "velocity", "max_acceleration": "acceleration", "max_jerk": "jerk"}.get(name, "")
        used = bool(has.get((joint, f"has_{kind}_limits"), kind == "velocity"))
        full = f"{joint}.{name}" if joint else name
        yield FoundSetting(full, value, file.name, number), joint, name, number_in(value), used


def _listed(values: list[float], kinds: Any) -> str:
    return ", ".join(_in(v, kind, "") for v, kind in zip(values, kinds, strict=True))


def _in(value: float, kind: str, per: str) -> str:
    """A value [m or rad] in mm or degrees."""
    return f"{written(value * 1000.0)} mm{per}" if kind == "prismatic" else f"{written(round(value / DEG, 6))} deg{per}"

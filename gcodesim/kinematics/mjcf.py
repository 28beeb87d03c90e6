"""Reader of MJCF, MuJoCo's robot descriptions: MuJoCo's own loader compiles the file, and its model becomes a `Chain`.

Bodies are links, their hinges and slides joints; a body with several joints gets a link for each of them. `world` is
the root. Positions of joints are those of MuJoCo, so a joint is at its `ref` where the file draws it. Travel is the
`range` of a joint, effort the least of `actuatorfrcrange` and of what its actuators give. An MJCF knows no speeds. The
flange F is the body or site that the cell names, else the one called `tool0`, `flange`, `tcp` or `attachment_site`,
else the end of the longest chain. Springs, damping, friction, armature and sensors are not taken over.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.declarations.reading import suggestion
from gcodesim.diagnostics import Diagnostic
from gcodesim.extras import ExtraMissingError, require_extra
from gcodesim.frames import Array, Pose, rotation_about
from gcodesim.kinematics.chain import Chain, Inertial, Joint, Link
from gcodesim.kinematics.mjcf_files import MjcfFiles
from gcodesim.kinematics.mjcf_shapes import pose_of, shapes_of
from gcodesim.kinematics.urdf import NamedFlange
from gcodesim.kinematics.urdf_tree import FLANGE_NAMES, LinkTree, TreeReader
from gcodesim.kinematics.xml_lines import Faults, LinedElement, read_description

_SITES: Final = (*FLANGE_NAMES, "attachment_site")
_LINE = re.compile(r"line (\d+)")
_HERE: Final = 1e-12  # [m]


def load_mjcf(
    path: Path,
    *,
    name: str | None = None,
    may_read: Callable[[Path], bool] | None = None,
    flange: NamedFlange | None = None,
    has_speeds: bool = False,
) -> tuple[Chain | None, list[Diagnostic]]:
    """The chain that the file describes, and what is wrong with it; None when an error leaves no chain.

    `name` is how findings call the file (default: its name); `may_read` says which files it may name. `has_speeds`: who
    asks knows how fast the joints are. Never raises for a fault of the file, nor without the extra `mjcf`.
    """
    faults = Faults(name or path.name)
    root = read_description(path, "MJCF", faults)
    if root is None:
        return None, faults.findings
    if root.tag != "mujoco":
        hint = "a URDF goes beside `urdf:`" if root.tag == "robot" else ""
        faults.find("GS760", f"an MJCF begins with <mujoco>, this file with <{root.tag}>", root, hint)
        return None, faults.findings
    files = MjcfFiles(path, may_read, faults)
    files.look(root)
    if faults.failed:
        return None, faults.findings
    try:
        require_extra("mjcf", "a robot in MJCF")
    except ExtraMissingError as missing:
        faults.find("GS760", f"`{faults.file}`: {missing}", root, "or export a URDF, and name it by `urdf:`")
        return None, faults.findings
    import mujoco

    try:
        spec = mujoco.MjSpec.from_file(str(path))
        model = spec.compile()
    except (ValueError, RuntimeError) as error:
        text = " ".join(str(error).split()).removesuffix(".")
        line = None if files.includes else _LINE.search(text)
        hint = "MuJoCo itself refuses it; what it says is above"
        faults.find_at(int(line[1]) if line else None, 1, "GS760", f"the MJCF cannot be compiled: {text}", hint)
        return None, faults.findings
    reader = _Reader(mujoco, spec, model, path, root, faults, flange, has_speeds)
    chain = reader.chain(tuple(files.found))
    return (None if faults.failed else chain), faults.findings


class _Reader:
    """A compiled `model` being read; what stands in included files has no line."""

    def __init__(
        self,
        mujoco: Any,
        spec: Any,
        model: Any,
        path: Path,
        root: LinedElement,
        faults: Faults,
        flange: NamedFlange | None,
        has_speeds: bool,
    ) -> None:
        self.mujoco, self.spec, self.model = mujoco, spec, model
        self.path, self.root, self.faults, self.flange, self.has_speeds = path, root, faults, flange, has_speeds
        self.places: dict[str, LinedElement | None] = {}
        self.links: dict[str, Link] = {}
        self.joints: list[Joint] = []
        self.between: set[str] = set()
        self.meshes = self._mesh_files()

    def chain(self, files: tuple[Path, ...]) -> Chain | None:
        """The whole robot; None where nothing leads to a flange."""
        for body in range(self.model.nbody):
            self._body(body)
        for site in range(self.model.nsite):
            self._site(site)
        named = None if self.flange is None else self.flange.link
        if self.flange is not None and named not in self.links:
            message, hint = f"the robot has no body or site `{named}`", suggestion(self.flange.link, list(self.links))
            self.faults.findings.append(Diagnostic(code="GS712", message=message, span=self.flange.span, hint=hint))
        if self.faults.failed:
            return None
        known = named or next((name for name in _SITES if name in self.links), None)
        reader = TreeReader(
            self.root, self.links, self.joints, self.places, self.faults, key="mjcf", between=frozenset(self.between)
        )
        tree = reader.tree(known)
        if tree is None:
            return None
        self._remark(tree)
        return Chain(
            name=str(self.spec.modelname) or self.path.stem,
            links=tuple(self.links[name] for name in tree.links),
            joints=tree.joints,
            driven=tree.driven,
            flange=tree.flange,
            table=tree.table,
            files=files,
        )

    # ---- names and places

    def _body_name(self, body: int) -> str:
        return "world" if body == 0 else self.model.body(body).name or f"body_{body}"

    def _joint_name(self, joint: int) -> str:
        return self.model.joint(joint).name or f"joint_{joint}"

    def _element(self, tags: tuple[str, ...], name: str) -> LinedElement | None:
        """The element of this name in the file; None for one without a name, or of an included file."""
        return next(
            (e for e in self.root.iter() if isinstance(e, LinedElement) and e.tag in tags and e.get("name") == name),
            None,
        )

    def _mesh_files(self) -> dict[int, Path]:
        """The files of meshes by their numbers; those that are written in the MJCF itself are left out."""
        folder = self.path.parent / str(self.spec.meshdir)
        found = {}
        for mesh in self.spec.meshes:
            own = str(mesh.file)
            if own and not any(mesh.refpos) and tuple(mesh.refquat) == (1.0, 0.0, 0.0, 0.0):
                found[int(mesh.id)] = folder / (Path(own).name if self.spec.strippath else own)
        return found

    # ---- bodies and joints

    def _body(self, body: int) -> None:
        """A body as a link, with the joints that hold it."""
        model, name = self.model, self._body_name(body)
        at = self._element(("body",), name)
        if name in self.links:
            message = f"body `{name}` is called as another link of this robot"
            self.faults.find("GS764", message, at, "each body has its own name")
            return
        visuals, collisions = shapes_of(self.mujoco, model, body, self.meshes, self.faults, at)
        R = pose_of(np.zeros(3), model.body_iquat[body])[:3, :3]
        inertia = multiplied(R, np.diag(model.body_inertia[body]), R.T)
        mass = float(model.body_mass[body])
        inertial = Inertial(mass=mass, com=model.body_ipos[body].copy(), inertia=inertia) if mass > 0.0 else None
        self.places[name] = at
        self.links[name] = Link(name=name, inertial=inertial, visuals=visuals, collisions=collisions)
        if body == 0:
            return
        parent = self._body_name(int(model.body_parentid[body]))
        X = pose_of(model.body_pos[body], model.body_quat[body])
        first = int(model.body_jntadr[body])
        joints = range(first, first + int(model.body_jntnum[body]))
        for number, joint in enumerate(joints, 1):
            anchor = model.jnt_pos[joint].copy()
            ends = number == len(joints) and bool(np.abs(anchor).max() < _HERE)
            child = name if ends else f"{name}/{self._joint_name(joint)}"
            made = self._joint(joint, parent, child, multiplied(X, _shift(anchor)))
            if made is None:
                return
            self._add(made, self._element(("joint", "freejoint"), made.name))
            if not ends:
                self.links[child], self.places[child] = Link(name=child), at
                if number < len(joints):
                    self.between.add(child)
            parent, X = child, _shift(np.zeros(3) if ends else -anchor)
        if parent != name:
            self._add(Joint(name=f"{name}/fixed", kind="fixed", parent=parent, child=name, X=X), at)

    def _site(self, site: int) -> None:
        """A site as a link, if a tool may hang on it."""
        name = self.model.site(site).name
        wanted = (self.flange.link,) if self.flange is not None else _SITES
        if name not in wanted or name in self.links:
            return
        X, at = pose_of(self.model.site_pos[site], self.model.site_quat[site]), self._element(("site",), name)
        parent = self._body_name(int(self.model.site_bodyid[site]))
        self.links[name], self.places[name] = Link(name=name), at
        self._add(Joint(name=f"{name}/fixed", kind="fixed", parent=parent, child=name, X=X), at)

    def _add(self, joint: Joint, at: LinedElement | None) -> None:
        self.joints.append(joint)
        self.places[f"joint {joint.name}"] = at

    def _joint(self, joint: int, parent: str, child: str, X: Array) -> Joint | None:
        """A hinge or a slide; None with a finding for another kind."""
        model, kinds, name = self.model, self.mujoco.mjtJoint, self._joint_name(joint)
        kind = int(model.jnt_type[joint])
        if kind not in (kinds.mjJNT_HINGE, kinds.mjJNT_SLIDE):
            what = "free" if kind == kinds.mjJNT_FREE else "ball"
            hint = "hinges and slides are simulated; where the robot stands is said by `base` in the cell"
            at = self._element(("joint", "freejoint"), name)
            self.faults.find("GS766", f"joint `{name}` is of type `{what}`, which is not simulated", at, hint)
            return None
        axis, drawn = model.jnt_axis[joint].copy(), float(model.qpos0[model.jnt_qposadr[joint]])
        turns = kind == kinds.mjJNT_HINGE
        back = Pose(np.zeros(3), rotation_about(axis, -drawn)).matrix if turns else _shift(-drawn * axis)
        lower, upper = (float(v) for v in model.jnt_range[joint]) if model.jnt_limited[joint] else (-np.inf, np.inf)
        return Joint(
            name=name,
            kind="revolute" if turns else "prismatic",
            parent=parent,
            child=child,
            X=multiplied(X, back) if drawn else X,
            axis=axis,
            lower=lower,
            upper=upper,
            effort=self._effort(joint),
            mimic=self._follows(joint),
        )

    def _effort(self, joint: int) -> float:
        """The greatest effort [N·m, N] of a joint; infinite where nothing says it."""
        model, most = self.model, np.inf
        if model.jnt_actfrclimited[joint]:
            most = float(np.abs(model.jnt_actfrcrange[joint]).max())
        given = []
        for motor in range(model.nu):
            if model.actuator_trntype[motor] != self.mujoco.mjtTrn.mjTRN_JOINT:
                continue
            if model.actuator_trnid[motor, 0] != joint:
                continue
            gear = abs(float(model.actuator_gear[motor, 0]))
            force = np.inf
            if model.actuator_forcelimited[motor]:
                force = float(np.abs(model.actuator_forcerange[motor]).max())
            gain, bias = self.mujoco.mjtGain.mjGAIN_FIXED, self.mujoco.mjtBias.mjBIAS_NONE
            plain = model.actuator_gaintype[motor] == gain and model.actuator_biastype[motor] == bias
            if plain and model.actuator_ctrllimited[motor]:
                gives = abs(float(model.actuator_gainprm[motor, 0])) * float(
                    np.abs(model.actuator_ctrlrange[motor]).max()
                )
                force = min(force, gives)
            given.append(gear * force)
        return min(most, sum(given)) if given else most

    def _follows(self, joint: int) -> tuple[str, float, float] | None:
        """Which joint this one follows by an equality, with factor and offset; of a polynomial its straight part."""
        model = self.model
        for k in range(model.neq):
            if model.eq_type[k] != self.mujoco.mjtEq.mjEQ_JOINT or int(model.eq_obj1id[k]) != joint:
                continue
            other = int(model.eq_obj2id[k])
            offset = float(model.eq_data[k, 0]) + float(model.qpos0[model.jnt_qposadr[joint]])
            if other < 0:
                return "", 0.0, offset
            factor = float(model.eq_data[k, 1])
            return self._joint_name(other), factor, offset - factor * float(model.qpos0[model.jnt_qposadr[other]])
        return None

    # ---- what is missing

    def _remark(self, tree: LinkTree) -> None:
        """Findings about driven joints: travel and speeds that are not known, loops of bodies."""
        driven = [tree.joints[index] for index in tree.driven]
        for joint in driven:
            if not np.isfinite([joint.lower, joint.upper]).all():
                message = f"joint `{joint.name}` has no `range`: its travel is not checked"
                self.faults.find("GS763", message, self.places[f"joint {joint.name}"], 'write `range="…"`')
        if not self.has_speeds:
            units = ("deg/s" if joint.kind == "revolute" else "mm/s" for joint in driven)
            wanted = ", ".join(f"180 {unit}" for unit in units)
            message = "an MJCF knows no speeds of joints: they are not checked"
            self.faults.find("GS763", message, self.root, f"write them beside `mjcf:`, such as `speed: [{wanted}]`")
        moved = {joint.child for joint in driven}
        for joint in tree.joints:
            if joint.parent in moved:
                moved.add(joint.child)
        self._loops(moved)

    def _loops(self, moved: set[str]) -> None:
        """A finding for each equality that holds a body or a tendon of the arm."""
        kinds, model = self.mujoco.mjtEq, self.model
        for k in range(model.neq):
            kind = kinds(int(model.eq_type[k]))
            if kind not in (kinds.mjEQ_CONNECT, kinds.mjEQ_WELD):
                continue
            site = model.eq_objtype[k] == self.mujoco.mjtObj.mjOBJ_SITE
            ends = [int(model.eq_obj1id[k]), int(model.eq_obj2id[k])]
            names = [self._body_name(int(model.site_bodyid[i]) if site else i) for i in ends]
            if any(name in moved for name in names):
                what = kind.name.removeprefix("mjEQ_").lower()
                message = f"a `{what}` holds `{names[0]}` and `{names[1]}`; loops of bodies are not simulated"
                self.faults.find("GS766", message, self._element((what,), model.equality(k).name), "take it out")


def _shift(p: Array) -> Array:
    """The matrix (4, 4) of a shift (3,)."""
    return Pose(np.asarray(p, dtype=float), np.eye(3)).matrix

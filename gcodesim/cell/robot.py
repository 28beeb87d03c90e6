"""A robot of the cell: a shipped model or a URDF, where it stands, where it starts, and how stiff it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from gcodesim.cell.joints import (
    ACCELERATIONS,
    JERKS,
    SPEEDS,
    STIFFNESSES,
    JointList,
    JointValue,
    Measure,
    check_within,
    in_si,
)
from gcodesim.cell.models import shipped, shipped_chain
from gcodesim.cell.placing import POINT, Place
from gcodesim.controllers import CONTROLLERS, Controller
from gcodesim.declarations.composed import Either, ListOf
from gcodesim.declarations.file_kind import File, FileValue
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Json, Kind
from gcodesim.declarations.map_of import MapOf, NameRule
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.plain_kinds import Choice, Text
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.declarations.record import Record
from gcodesim.declarations.variant import Variant
from gcodesim.frames import Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.branch_names import PAIRS, WORDS
from gcodesim.kinematics.user_urdf import mjcf_chain, user_chain

if TYPE_CHECKING:
    from gcodesim.cell.externals import External
    from gcodesim.cell.machine_axes import MachineAxis
    from gcodesim.kinematics.chain import Chain

RIGID: Final = "rigid"
_CONFIGURATION: Final = ListOf(Choice(WORDS, "a configuration"), single=True)
_POSE_NAMES: Final = NameRule(what="pose name", pattern=r"\S(.*\S)?", canonical=lambda text: text.strip() or None)
_STIFFNESS_OF: Final[dict[Measure, str]] = {"angle": "torsional stiffness", "length": "stiffness"}
_LIMITS: Final[dict[str, dict[Measure, str]]] = {
    "speed": {"angle": "angular speed", "length": "speed"},
    "acceleration": {"angle": "angular acceleration", "length": "acceleration"},
    "jerk": {"angle": "angular jerk", "length": "jerk"},
}


@frozen
class ControllerKind(Variant):
    """A controller of a robot."""

    def name(self, path: Path) -> str:
        return "the controller"


@frozen
class Payload:
    """A mass at the flange besides the tool, such as a spindle; `xyz` is its centre of mass in F."""

    mass: float = key(
        Quantity("mass", NOT_NEGATIVE), "mass of what hangs at the flange besides the tool", example="6 kg"
    )
    xyz: tuple[float, float, float] = key(
        POINT,
        "its centre of mass, seen from the flange",
        default=(0.0, 0.0, 0.0),
        quiet=True,
        example="[0, 0, 80 mm]",
    )


_CONTROLLER: Final = ControllerKind(
    family=CONTROLLERS, what="controller", example="{type: computed_torque, bandwidth: 15 Hz}"
)


@frozen
class RobotForm:
    """A robot as written in the cell."""

    model: str | None = key(Text(form="the name of a shipped model"), "a model that ships with gcodesim", default=None)
    urdf: FileValue | None = key(File("a URDF file"), "your own robot description", default=None)
    mjcf: FileValue | None = key(
        File("an MJCF file"),
        "your own robot description for MuJoCo (extra `mjcf`); write its `speed` beside it",
        default=None,
        quiet=True,
    )
    flange: str | None = key(
        Text(form="the name of a link"),
        "the link of the URDF that carries the tool, or the body or site of the MJCF",
        default=None,
        quiet=True,
    )
    base: Place = key(Record(Place, "a place"), "where the base stands", default=Place(), quiet=True)
    home: Any = key(JointList(names=True), "joints at the start, or one of the `poses`", default=None)
    poses: Mapping[str, Any] = key(
        MapOf(_POSE_NAMES, JointList(), "joints by the name of a pose, such as `{ready: [0, -90, 90, 0, 90, 0]}`"),
        'joints that have a name: for `home`, and for sessions (`arm.move_joints("ready")`)',
        default={},
        quiet=True,
    )
    stiffness: Any = key(
        Either(((RIGID, RIGID),), JointList(dimensions=STIFFNESSES, example="[1.5e5, 1.4e5, 9e4 N·m/rad]")),
        "stiffness of each gear, or `rigid`",
        default=None,
    )
    speed: Any = key(
        JointList(dimensions=SPEEDS, example="[300, 300, 320, 380, 400, 490 deg/s]"),
        "greatest speed of each joint (default: as the description says)",
        default=None,
        quiet=True,
    )
    acceleration: Any = key(
        JointList(dimensions=ACCELERATIONS, example="[900, 900, 1200, 1500, 1500, 1800 deg/s^2]"),
        "greatest acceleration of each joint (assumed: full speed in 0.25 s)",
        default=None,
        quiet=True,
    )
    jerk: Any = key(
        JointList(dimensions=JERKS, example="[6000, 6000, 6000, 12000, 12000, 12000 deg/s^3]"),
        "greatest change of acceleration of each joint (default: any)",
        default=None,
        quiet=True,
    )
    allow_collisions: tuple[tuple[str, ...], ...] = key(
        ListOf(ListOf(Text(form="the name of a link"))),
        "pairs of its links that may meet, such as `[[link_1, link_3], [link_2, link_4]]`",
        default=(),
        quiet=True,
    )
    payload: Payload | None = key(
        Record(Payload, "a payload", "mass"), "what hangs at the flange besides the tool", default=None
    )
    controller: Controller | None = key(
        _CONTROLLER,
        "how motors follow the command",
        default=None,
        rule="`ideal`; in `bullet`, with `stiffness`, `{type: flexible, feed_forward: true}`",
        quiet=True,
    )
    configuration: tuple[str, ...] | None = key(
        _CONFIGURATION,
        "how the arm has to stand: of each pair front or back, up or down (elbow), noflip or flip (wrist), at most one",
        default=None,
        quiet=True,
        example="[front, up, noflip]",
    )

    def checked(self, to: Reading, path: Path) -> Robot | Unread:
        given = [name for name in ("model", "urdf", "mjcf") if getattr(self, name) is not None]
        if not given:
            message = "the robot has neither `model` nor `urdf` nor `mjcf`"
            return to.fault("GS705", to.span(path), message, "give one of them")
        if len(given) > 1:
            message = f"the robot has a `{given[0]}` and a `{given[1]}`"
            return to.fault("GS719", to.key((*path, given[1])), message, "give one of them")
        if self.model is not None:
            model = shipped(self.model, "arm", to, (*path, "model"))
            if isinstance(model, Unread):
                return UNREAD
            if self.flange is not None:
                message = "`flange` is for a `urdf` or an `mjcf`; a model has its own"
                return to.fault("GS719", to.key((*path, "flange")), message)
            return self._robot(shipped_chain(model.name), model.path, model.home, model.stiffness, to, path)
        if self.mjcf is not None:
            chain = mjcf_chain(self.mjcf, to, (*path, "mjcf"), self.flange, has_speeds=self.speed is not None)
        else:
            assert self.urdf is not None
            chain = user_chain(self.urdf, to, (*path, "urdf"), self.flange)
        if isinstance(chain, Unread):
            return UNREAD
        joints = chain.driven_joints
        resting = tuple(float(v) for v in np.clip(np.zeros(len(joints)), joints.lower, joints.upper))
        return self._robot(chain, None if self.urdf is None else self.urdf.path, resting, None, to, path)

    def _robot(
        self,
        chain: Chain,
        description: FilePath | None,
        home: tuple[float, ...],
        stiffness: tuple[float, ...] | None,
        to: Reading,
        path: Path,
    ) -> Robot | Unread:
        measures = measures_of(chain)
        poses = self._poses(chain, to, (*path, "poses"))
        if isinstance(poses, Unread):
            return UNREAD
        if self.home is None:
            to.default((*path, "home"), home)
        else:
            read = self._home(chain, poses, to, (*path, "home"))
            if isinstance(read, Unread):
                return UNREAD
            home = read
        if self.stiffness is None:
            to.default((*path, "stiffness"), stiffness, "" if stiffness is not None else "no stiffness is known")
        elif self.stiffness == RIGID:
            stiffness = None
        else:
            written = self._per_joint("stiffness", self.stiffness, _STIFFNESS_OF, measures, to, path)
            if isinstance(written, Unread):
                return UNREAD
            stiffness = written
        limits: dict[str, tuple[float, ...]] = {}
        for name, dimension in _LIMITS.items():
            values = getattr(self, name)
            if values is not None:
                read = self._per_joint(name, values, dimension, measures, to, path)
                if isinstance(read, Unread):
                    return UNREAD
                limits[name] = read
        if not self._pairs_exist(chain, to, (*path, "allow_collisions")):
            return UNREAD
        if self.base.frame is None:
            to.default((*path, "base", "in"), "world")
        if not self._can_stand(chain, to, (*path, "configuration")):
            return UNREAD
        lists = {} if self.controller is None else self.controller.lists()
        for name, values in lists.items():
            if len(values) not in (0, 1, len(measures)):
                span = to.span((*path, "controller", name))
                return to.fault(
                    "GS706", span, f"`{name}` has {len(values)} entries; the robot has {len(measures)} joints"
                )
        return Robot(
            name=str(path[-1]),
            model=self.model,
            urdf=None if self.urdf is None else self.urdf.name,
            mjcf=None if self.mjcf is None else self.mjcf.name,
            flange=self.flange,
            description=description,
            chain=with_limits(chain, limits),
            base=self.base,
            home=home,
            poses=poses,
            stiffness=stiffness,
            limits=limits,
            allow_collisions=tuple((one, other) for one, other in self.allow_collisions),
            payload=self.payload,
            configuration=self.configuration,
            controller=self.controller,
        )

    def _per_joint(
        self,
        name: str,
        values: tuple[JointValue, ...],
        dimension: Mapping[Measure, str],
        measures: tuple[Measure, ...],
        to: Reading,
        path: Path,
    ) -> tuple[float, ...] | Unread:
        """The positive values of key `name`, one a joint, in SI."""
        if len(values) != len(measures):
            span = to.span((*path, name))
            return to.fault("GS706", span, f"`{name}` has {len(values)} entries; the robot has {len(measures)} joints")
        return in_si(values, [Quantity(dimension[m], POSITIVE) for m in measures], to)

    def _pairs_exist(self, chain: Chain, to: Reading, path: Path) -> bool:
        """Whether `allow_collisions` names two links of the chain each time."""
        good = True
        for index, pair in enumerate(self.allow_collisions):
            if len(pair) != 2:
                to.fault("GS706", to.span((*path, index)), f"a pair has two links, not {len(pair)}")
                good = False
            for name in pair:
                if name not in chain.link_names:
                    known = suggestion(name, chain.link_names)
                    to.fault("GS712", to.span((*path, index)), f"`{chain.name}` has no link `{name}`", known)
                    good = False
        return good

    def _can_stand(self, chain: Chain, to: Reading, path: Path) -> bool:
        """Whether `configuration` means something for this arm."""
        if not self.configuration:
            return True
        from gcodesim.kinematics.choice import kinematics_of
        from gcodesim.kinematics.closed_form import ClosedForm

        if not isinstance(kinematics_of(chain), ClosedForm):
            to.fault(
                "GS719",
                to.span(path),
                f"`configuration` names branches of a closed form, and `{chain.name}` has none",
                "leave it out and choose `home` near the joints that the arm is to have",
            )
            return False
        for pair in PAIRS:
            if set(pair) <= set(self.configuration):
                to.fault("GS719", to.span(path), f"`configuration` says {pair[0]} and {pair[1]}", "give one of them")
                return False
        return True

    def _poses(self, chain: Chain, to: Reading, path: Path) -> dict[str, tuple[float, ...]] | Unread:
        read = {
            name: joint_positions(values, f"pose `{name}`", chain, to, (*path, name))
            for name, values in self.poses.items()
        }
        good = {name: values for name, values in read.items() if not isinstance(values, Unread)}
        return good if len(good) == len(read) else UNREAD

    def _home(
        self, chain: Chain, poses: Mapping[str, tuple[float, ...]], to: Reading, path: Path
    ) -> tuple[float, ...] | Unread:
        if not isinstance(self.home, str):
            return joint_positions(self.home, "home", chain, to, path)
        if self.home in poses:
            return poses[self.home]
        known = suggestion(self.home, tuple(poses)) if poses else "its `poses` name none"
        return to.fault("GS712", to.span(path), f"the robot has no pose `{self.home}`", known)


def joint_positions(
    values: tuple[JointValue, ...], what: str, chain: Chain, to: Reading, path: Path
) -> tuple[float, ...] | Unread:
    """One position a joint [rad, m], each within its travel; `what` they are (home, a pose), people are told."""
    measures, joints = measures_of(chain), chain.driven_joints
    if len(values) != len(measures):
        named = "`home`" if what == "home" else what
        return to.fault(
            "GS706", to.span(path), f"{named} has {len(values)} entries; the robot has {len(measures)} joints"
        )
    read = in_si(values, [Quantity(m) for m in measures], to)
    if isinstance(read, Unread):
        return UNREAD
    within = [
        check_within(
            value,
            float(joints.lower[i]),
            float(joints.upper[i]),
            measures[i],
            f"{what} of joint `{joints.names[i]}`",
            to,
            (*path, i),
        )
        for i, value in enumerate(read)
    ]
    return read if all(within) else UNREAD


def measures_of(chain: Chain) -> tuple[Measure, ...]:
    """What each joint's value measures."""
    return tuple("length" if kind == "prismatic" else "angle" for kind in chain.driven_joints.kinds)


def with_limits(chain: Chain, limits: Mapping[str, tuple[float, ...]]) -> Chain:
    """The chain with these limits (j,) of speed, acceleration, jerk [rad, m, s] on its driven joints."""
    joints = list(chain.joints)
    for name, values in limits.items():
        for index, value in zip(chain.driven, values, strict=True):
            changed: dict[str, Any] = {name: value}
            joints[index] = replace(joints[index], **changed)
    return replace(chain, joints=tuple(joints)) if limits else chain


@frozen
class Robot:
    """A robot in the cell.

    `model` names a shipped one, else `urdf` or `mjcf` is the file's name as written in the cell, and `flange` the link
    written there; `description` is where a URDF is, and `chain` what it says. `home` [rad] or [m], `poses` likewise,
    `stiffness` of the gears [N·m/rad] or [N/m], or None for rigid ones; `limits` of its joints, speed, acceleration and
    jerk [rad, m, s], where the cell says them; `allow_collisions` are links that may meet; `configuration` names the
    branches on which it has to be (None: all); `controller` is how its motors follow the command; `X_WB` is its base
    in the world.
    """

    axes: ClassVar[tuple[MachineAxis, ...]] = ()
    """Axes that a program names by letters: a robot has none."""

    tip_first: ClassVar[bool] = False
    """Whether kinematics that the cell names hold the tip before the program says so: those of a robot have no name."""

    name: str
    model: str | None
    urdf: str | None
    mjcf: str | None
    flange: str | None
    description: FilePath | None
    chain: Chain = field(compare=False, repr=False)
    base: Place
    home: tuple[float, ...]
    poses: Mapping[str, tuple[float, ...]]
    stiffness: tuple[float, ...] | None
    limits: Mapping[str, tuple[float, ...]]
    allow_collisions: tuple[tuple[str, str], ...]
    payload: Payload | None
    configuration: tuple[str, ...] | None = None
    controller: Controller | None = None
    X_WB: Pose = field(default_factory=Pose.identity, compare=False)
    externals: tuple[External, ...] = field(default=(), compare=False, repr=False)

    @property
    def whole(self) -> Chain:
        """The chain of arm and external axes."""
        if not self.externals:
            return self.chain
        from gcodesim.kinematics.assembly import assembled

        return assembled(self.chain, [external.carrier(self.X_WB) for external in self.externals])

    @property
    def link_names(self) -> tuple[str, ...]:
        """Everything that can carry something: base, links and flange, what external axes carry."""
        return self.whole.carriers

    @property
    def base_frame(self) -> str:
        """The name of its base: `arm/base`."""
        return f"{self.name}/{self.whole.base_name}"

    @property
    def platforms(self) -> dict[str, Pose]:
        """X_WC of what carries work, with its axes at zero, by the names of the links: `arm/positioner`."""
        return {f"{self.name}/{external.name}": external.X_WE for external in self.externals if not external.carries}

    def axis(self, letter: str) -> MachineAxis | None:
        return None

    @property
    def X_WM(self) -> Pose:
        """Machine zero of an arm whose work systems are upright: its base."""
        return self.X_WB

    def at(self, X_WB: Pose) -> Robot:
        return replace(self, X_WB=X_WB)

    def with_externals(self, externals: tuple[External, ...]) -> Robot:
        return replace(self, externals=externals)


def _show_stiffness(robot: Robot) -> list[str]:
    assert robot.stiffness is not None
    dimensions = [_STIFFNESS_OF[m] for m in measures_of(robot.chain)]
    return [Quantity(d).show(k) for d, k in zip(dimensions, robot.stiffness, strict=True)]


def _description(robot: Robot) -> Json:
    if robot.model:
        return {"model": robot.model}
    named = {"urdf": robot.urdf} if robot.mjcf is None else {"mjcf": robot.mjcf}
    return named | ({} if robot.flange is None else {"flange": robot.flange})


_FORM: Final = Record(RobotForm, "the robot", "model")


@frozen(kw_only=False)
class RobotKind(Kind):
    """A robot."""

    @property
    def expected(self) -> str:
        return "a robot such as `{model: kuka_kr10_r1100_2}`"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        return _FORM.read(node, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return _FORM.schema(definitions)

    def show(self, value: Any) -> Any:
        shown = _description(value)
        shown["base"] = Record(Place, "a place").show(value.base)
        shown["home"] = [Quantity(m).show(v) for m, v in zip(measures_of(value.chain), value.home, strict=True)]
        if value.poses:
            shown["poses"] = {
                name: [Quantity(m).show(v) for m, v in zip(measures_of(value.chain), values, strict=True)]
                for name, values in value.poses.items()
            }
        shown["stiffness"] = RIGID if value.stiffness is None else _show_stiffness(value)
        for name, values in value.limits.items():
            kinds = [Quantity(_LIMITS[name][m]) for m in measures_of(value.chain)]
            shown[name] = [kind.show(v) for kind, v in zip(kinds, values, strict=True)]
        if value.allow_collisions:
            shown["allow_collisions"] = [list(pair) for pair in value.allow_collisions]
        if value.payload is not None:
            shown["payload"] = Record(Payload, "a payload").show(value.payload)
        if value.controller is not None:
            shown["controller"] = _CONTROLLER.show(value.controller)
        if value.configuration is not None:
            shown["configuration"] = _CONFIGURATION.show(value.configuration)
        return shown

    def plain(self, value: Any) -> tuple[str, Any]:
        measures = measures_of(value.chain)
        shown = _description(value)
        shown["base"] = Record(Place, "a place").plain(value.base)[1]
        shown["joint_units"] = ["mm" if m == "length" else "deg" for m in measures]
        shown["home"] = [Quantity(m).plain(v)[1] for m, v in zip(measures, value.home, strict=True)]
        if value.poses:
            shown["poses"] = {
                name: [Quantity(m).plain(v)[1] for m, v in zip(measures, values, strict=True)]
                for name, values in value.poses.items()
            }
        shown["stiffness_SI"] = None if value.stiffness is None else list(value.stiffness)
        for name, values in value.limits.items():
            shown[f"{name}_SI"] = list(values)
        if value.allow_collisions:
            shown["allow_collisions"] = [list(pair) for pair in value.allow_collisions]
        if value.payload is not None:
            shown["payload"] = Record(Payload, "a payload").plain(value.payload)[1]
        if value.controller is not None:
            shown["controller"] = _CONTROLLER.plain(value.controller)[1]
        if value.configuration is not None:
            shown["configuration"] = list(value.configuration)
        return "", shown

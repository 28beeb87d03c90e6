"""A machine tool: a shipped model, or one that is described by its axes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.canon import AXIS_LETTERS
from gcodesim.cell.joints import JointList, JointValue, Measure, check_within, in_si, unknown_letter
from gcodesim.cell.models import shipped, shipped_chain
from gcodesim.cell.placing import POINT, Place
from gcodesim.declarations.composed import Either
from gcodesim.declarations.keys import key
from gcodesim.declarations.keys import keys as keys_of
from gcodesim.declarations.kind import POSITIVE, WITHIN_REACH, Json, Kind
from gcodesim.declarations.map_of import NameRule, read_name
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.plain_kinds import Choice, Text
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import FREE, Record, not_a_mapping, object_schema
from gcodesim.declarations.units import shown
from gcodesim.frames import Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import BASE, FLANGE

if TYPE_CHECKING:
    from gcodesim.cell.externals import External
    from gcodesim.kinematics.cartesian import Axis as KinematicAxis
    from gcodesim.kinematics.chain import Chain, Link

LINEAR: Final = ("X", "Y", "Z")
ROTARY: Final = ("A", "B", "C")
SPIN_UP: Final = 0.25  # s to full speed, where no acceleration is given
UNLIMITED: Final = (-math.inf, math.inf)

Side = Literal["tool", "table"]


@frozen
class LinearAxis:
    """An axis X, Y or Z as written in the cell."""

    travel: tuple[float, float] | None = key(
        Vector(Quantity("length", WITHIN_REACH), 2, "[0, 600 mm]"), "least and greatest position", default=None
    )
    speed: float | None = key(Quantity("speed", POSITIVE), "greatest speed", default=None)
    acceleration: float | None = key(
        Quantity("acceleration", POSITIVE), "acceleration (assumed: full speed in 0.25 s)", default=None
    )
    home: float | None = key(
        Quantity("length"), "position at the start (default 0, else the nearer end)", default=None, example="0 mm"
    )
    side: Side | None = key(Choice(("tool", "table")), "what the axis moves", default=None)
    moving_mass: float | None = key(Quantity("mass", POSITIVE), "mass that the axis moves", default=None)
    effort: float | None = key(
        Either((("none", math.inf),), Quantity("force", POSITIVE)), "greatest force, `none`: unlimited", default=None
    )


@frozen
class RotaryAxis:
    """An axis A, B or C as written in the cell."""

    travel: tuple[float, float] | None = key(
        Either((("unlimited", UNLIMITED),), Vector(Quantity("angle"), 2, "[-120, 120 deg]")),
        "least and greatest position, or `unlimited`",
        default=None,
    )
    speed: float | None = key(Quantity("angular speed", POSITIVE), "greatest speed", default=None)
    acceleration: float | None = key(
        Quantity("angular acceleration", POSITIVE), "acceleration (assumed: full speed in 0.25 s)", default=None
    )
    home: float | None = key(
        Quantity("angle"), "position at the start (default 0, else the nearer end)", default=None, example="0 deg"
    )
    side: Side | None = key(Choice(("tool", "table")), "what the axis moves", default=None)
    at: tuple[float, float, float] | None = key(
        POINT, "a point on the axis; without it the axis only takes time", default=None, example="[300, 200, -350 mm]"
    )
    direction: tuple[float, float, float] | None = key(
        Vector(Quantity("ratio"), 3, "[0, 1, 1]"),
        "what the axis carries turns right-handed about it (default: X, Y or Z by the letter); any length",
        default=None,
    )
    moving_mass: float | None = key(Quantity("mass", POSITIVE), "mass that the axis moves", default=None)
    effort: float | None = key(
        Either((("none", math.inf),), Quantity("torque", POSITIVE)), "greatest torque, `none`: unlimited", default=None
    )


AxisForm = LinearAxis | RotaryAxis


@frozen
class MachineAxis:
    """One axis of a machine, complete. [m] or [rad], per s and s²; `effort` [N] or [N·m], infinite: unlimited.

    `at` is a point on a rotary axis in M [m]; None: its place is not known (the axis gives time only).
    `direction` (3,) in M is what it turns right-handed about; None: by its letter.
    """

    letter: str
    rotary: bool
    lower: float
    upper: float
    speed: float
    acceleration: float
    assumed_acceleration: bool
    home: float
    side: Side
    at: tuple[float, float, float] | None = None
    direction: tuple[float, float, float] | None = None
    moving_mass: float | None = None
    effort: float = math.inf

    @property
    def measure(self) -> Measure:
        return "angle" if self.rotary else "length"

    @property
    def middle(self) -> float:
        """Mid-travel; infinite travel has none."""
        return 0.5 * (self.lower + self.upper)


def _letter(text: str) -> str | None:
    return text.upper() if text.upper() in AXIS_LETTERS else None


_AXIS_NAMES: Final = NameRule(
    what=f"axis ({', '.join(AXIS_LETTERS)})", pattern="[XYZABCxyzabc]", canonical=_letter, known=AXIS_LETTERS
)
_RECORDS: Final = {
    letter: Record(LinearAxis if letter in LINEAR else RotaryAxis, f"axis {letter}") for letter in AXIS_LETTERS
}


@frozen(kw_only=False)
class _AxesKind(Kind):
    """Axes by letter, in chain order."""

    @property
    def expected(self) -> str:
        return "axes by letter, such as `X: {travel: [0, 500 mm], speed: 20 m/min}`"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        if not isinstance(node, MappingNode):
            return not_a_mapping(node, self.expected, to, path)
        axes: dict[str, Any] = {}
        for name, value in node.entries:
            if name.text.startswith(FREE):
                continue
            letter = read_name(_AXIS_NAMES, name, [(*path, known) for known in axes], to)
            if isinstance(letter, Unread):
                axes[name.text] = UNREAD
                continue
            to.named((*path, letter), name.span)
            axes[letter] = _RECORDS[letter].read(value, to, (*path, letter))
        return UNREAD if any(value is UNREAD for value in axes.values()) else axes

    def schema(self, definitions: dict[str, Json]) -> Json:
        linear, rotary = (
            object_schema(list(keys_of(cls).values()), definitions, cls.__doc__ or "")
            for cls in (LinearAxis, RotaryAxis)
        )
        definitions |= {"LinearAxis": linear, "RotaryAxis": rotary}
        patterns = {
            "^[XYZxyz]$": {"$ref": "#/$defs/LinearAxis"},
            "^[ABCabc]$": {"$ref": "#/$defs/RotaryAxis"},
            f"^{FREE}": {},
        }
        return {"type": "object", "patternProperties": patterns, "additionalProperties": False}


@frozen
class MachineForm:
    """A machine tool as written in the cell: `model`, or all its `axes`."""

    model: str | None = key(
        Text(form="the name of a shipped machine"), "a machine that ships with gcodesim", default=None
    )
    axes: Mapping[str, AxisForm] = key(
        _AxesKind(), "axes in chain order; with a model, what differs from it", default={}, quiet=True
    )
    rapids: Literal["linear", "independent"] = key(
        Choice(("linear", "independent")), "G0 in a straight line, or each axis for itself", default="linear"
    )
    home: Any = key(JointList(letters=True, example="[0, 0, 0]"), "axes at the start", default=None)
    lathe: bool | None = key(
        "switch", "the work turns about Z at X0 of the machine (default: as the model)", default=None, quiet=True
    )
    base: Place = key(Record(Place, "a place"), "where machine zero is", default=Place(), quiet=True)

    def checked(self, to: Reading, path: Path) -> MachineTool | Unread:
        if self.model is not None:
            model = shipped(self.model, "machine", to, (*path, "model"))
            if isinstance(model, Unread):
                return UNREAD
            chain, turned = shipped_chain(model.name), model.lathe
            axes = _model_axes(chain, model.home, self.axes, to, (*path, "axes"))
        elif self.axes:
            chain, turned = None, False
            axes = _own_axes(self.axes, to, (*path, "axes"))
        else:
            return to.fault("GS705", to.span(path), "the machine has neither `model` nor `axes`", "give one of them")
        if isinstance(axes, Unread):
            return UNREAD
        axes = self._with_home(axes, to, (*path, "home"))
        if isinstance(axes, Unread):
            return UNREAD
        within = [
            check_within(
                axis.home,
                axis.lower,
                axis.upper,
                axis.measure,
                f"axis {axis.letter}",
                to,
                self._home_path(axis.letter, i, path),
            )
            for i, axis in enumerate(axes)
        ]
        if not all(within):
            return UNREAD
        turns = bool(self.lathe) if self.lathe is not None else turned
        return MachineTool(model=self.model, shipped=chain, axes=axes, rapids=self.rapids, base=self.base, lathe=turns)

    def _home_path(self, letter: str, index: int, path: Path) -> Path:
        if self.home is None:
            return (*path, "axes", letter, "home")
        return (*path, "home", letter if isinstance(self.home, dict) else index)

    def _with_home(self, axes: tuple[MachineAxis, ...], to: Reading, path: Path) -> tuple[MachineAxis, ...] | Unread:
        """The axes with the machine's own `home` entered."""
        if self.home is None:
            return axes
        values: dict[str, JointValue]
        if isinstance(self.home, dict):
            values = self.home
            strangers = [letter for letter in values if letter not in [axis.letter for axis in axes]]
            for letter in strangers:
                unknown_letter(letter, [axis.letter for axis in axes], (*path, letter), to)
            if strangers:
                return UNREAD
        elif len(self.home) == len(axes):
            values = {axis.letter: value for axis, value in zip(axes, self.home, strict=True)}
        else:
            return to.fault(
                "GS706", to.span(path), f"`home` has {len(self.home)} entries; the machine has {len(axes)} axes"
            )
        chosen = [axis for axis in axes if axis.letter in values]
        written, kinds = [values[axis.letter] for axis in chosen], [Quantity(axis.measure) for axis in chosen]
        home = in_si(written, kinds, to, is_list=not isinstance(self.home, dict))
        if isinstance(home, Unread):
            return UNREAD
        by_letter = {axis.letter: value for axis, value in zip(chosen, home, strict=True)}
        return tuple(replace(axis, home=by_letter.get(axis.letter, axis.home)) for axis in axes)


def _bounds(form: AxisForm, letter: str, to: Reading, path: Path) -> tuple[float, float] | Unread | None:
    if form.travel is None:
        return None
    lower, upper = form.travel
    if lower < upper:
        return lower, upper
    measure: Measure = "length" if letter in LINEAR else "angle"
    return to.fault(
        "GS710",
        to.span((*path, letter, "travel")),
        f"travel of axis {letter} goes from {shown(lower, measure)} to {shown(upper, measure)}",
        "the second must be greater",
    )


def _home_default(lower: float, upper: float) -> float:
    """0 if that is within the travel, else the nearer end."""
    return min(max(0.0, lower), upper)


def _own_axes(forms: Mapping[str, AxisForm], to: Reading, path: Path) -> tuple[MachineAxis, ...] | Unread:
    """Complete axes of a machine that is described in the cell."""
    axes: list[MachineAxis | Unread] = []
    for letter, form in forms.items():
        at = (*path, letter)
        travel = _bounds(form, letter, to, path)
        missing = [name for name in ("travel", "speed") if getattr(form, name) is None]
        declared = keys_of(RotaryAxis if letter in ROTARY else LinearAxis)
        for name in missing:
            to.fault("GS705", to.span(at), f"axis {letter} lacks `{name}`: {declared[name].kind.expected}")
        if missing or isinstance(travel, Unread) or travel is None or form.speed is None:
            axes.append(UNREAD)
            continue
        if form.acceleration is None:
            to.default((*at, "acceleration"), form.speed / SPIN_UP, f"assumed: full speed in {SPIN_UP:g} s")
        home = _home_default(*travel) if form.home is None else form.home
        if form.home is None:
            to.default((*at, "home"), home)
        rotary = letter in ROTARY
        if isinstance(form, RotaryAxis) and form.direction is not None and not any(form.direction):
            place = to.span((*path, letter, "direction"))
            axes.append(to.fault("GS710", place, f"the direction of axis {letter} has no length", "such as [0, 1, 1]"))
            continue
        side: Side = form.side or ("table" if rotary else "tool")
        if form.side is None:
            to.default((*at, "side"), side)
        axes.append(
            MachineAxis(
                letter=letter,
                rotary=rotary,
                lower=travel[0],
                upper=travel[1],
                speed=form.speed,
                acceleration=form.acceleration or form.speed / SPIN_UP,
                assumed_acceleration=form.acceleration is None,
                home=home,
                side=side,
                at=form.at if isinstance(form, RotaryAxis) else None,
                direction=form.direction if isinstance(form, RotaryAxis) else None,
                moving_mass=form.moving_mass,
                effort=math.inf if form.effort is None else form.effort,
            )
        )
    good = tuple(axis for axis in axes if not isinstance(axis, Unread))
    return good if len(good) == len(axes) else UNREAD


def _model_axes(
    chain: Chain, home: tuple[float, ...], forms: Mapping[str, AxisForm], to: Reading, path: Path
) -> tuple[MachineAxis, ...] | Unread:
    """Axes of a shipped machine, with the changes of the cell."""
    joints = chain.driven_joints
    strangers = [letter for letter in forms if letter not in joints.names]
    for letter in strangers:
        unknown_letter(letter, joints.names, (*path, letter), to)
    if strangers:
        return UNREAD
    on_tool_side = _ancestors(chain, chain.flange)
    axes: list[MachineAxis] = []
    good = True
    for i, letter in enumerate(joints.names):
        rotary = joints.kinds[i] != "prismatic"
        form = forms.get(letter) or (RotaryAxis() if rotary else LinearAxis())
        travel = _bounds(form, letter, to, path)
        good &= not isinstance(travel, Unread)
        joint = chain.joints[chain.driven[i]]
        side: Side = "tool" if joint.child in on_tool_side else "table"
        point = chain_point(chain, i) if rotary else None
        good &= _agrees(form, letter, side, point, to, path)
        lower, upper = travel if isinstance(travel, tuple) else (float(joints.lower[i]), float(joints.upper[i]))
        start = form.home if form.home is not None else min(max(home[i], lower), upper)
        speed = form.speed or float(joints.speed[i])
        assumed = form.acceleration is None and bool(joints.assumed_acceleration[i])
        named = speed / SPIN_UP if assumed else float(joints.acceleration[i])
        axes.append(
            MachineAxis(
                letter=letter,
                rotary=rotary,
                lower=lower,
                upper=upper,
                speed=speed,
                acceleration=form.acceleration or named,
                assumed_acceleration=assumed,
                home=start,
                side=side,
                at=point,
                moving_mass=form.moving_mass,
                effort=float(joints.effort[i]) if form.effort is None else form.effort,
            )
        )
    return tuple(axes) if good else UNREAD


def _agrees(
    form: AxisForm, letter: str, side: Side, point: tuple[float, float, float] | None, to: Reading, path: Path
) -> bool:
    """Whether the cell keeps the structure of a shipped machine; limits may change, the chain may not."""
    rotary = isinstance(form, RotaryAxis)
    given = {
        "side": form.side,
        "at": form.at if rotary else None,  # type: ignore[union-attr]
        "direction": form.direction if rotary else None,  # type: ignore[union-attr]
    }
    shipped_as = {"side": side, "at": point, "direction": None}
    changed = [name for name, value in given.items() if value is not None and not _near(value, shipped_as[name])]
    for name in changed:
        message = f"`{name}` of axis {letter} belongs to the model and cannot be changed"
        to.fault("GS719", to.key((*path, letter, name)), message, "describe a machine of your own by all its `axes`")
    return not changed


def _near(value: Any, other: Any) -> bool:
    if isinstance(value, tuple) and isinstance(other, tuple):
        return all(abs(a - b) < 1e-9 for a, b in zip(value, other, strict=True))
    return bool(value == other)


def _ancestors(chain: Chain, link: str) -> set[str]:
    """`link` and all links between it and the root."""
    parents = {joint.child: joint.parent for joint in chain.joints}
    found = {link}
    while link in parents:
        link = parents[link]
        found.add(link)
    return found


def chain_point(chain: Chain, driven: int) -> tuple[float, float, float]:
    """The origin of a driven joint in the root frame, all joints at zero [m]."""
    above = {joint.child: joint for joint in chain.joints}
    joint = chain.joints[chain.driven[driven]]
    X = joint.X
    while joint.parent in above:
        joint = above[joint.parent]
        X = multiplied(joint.X, X)
    return float(X[0, 3]), float(X[1, 3]), float(X[2, 3])


@frozen
class MachineTool:
    """A machine tool of the cell. `shipped` is the content of the URDF of its `model`, None without a model.

    On a `lathe` the work turns about Z at X0 of the machine.
    """

    model: str | None
    axes: tuple[MachineAxis, ...]
    rapids: Literal["linear", "independent"]
    base: Place
    shipped: Chain | None = field(compare=False, repr=False, default=None)
    X_WM: Pose = field(default_factory=Pose.identity, compare=False)
    lathe: bool = False

    @property
    def externals(self) -> tuple[External, ...]:
        """Axes outside of it: a machine tool has none."""
        return ()

    @property
    def platforms(self) -> dict[str, Pose]:
        """What external axes carry."""
        return {}

    @property
    def home(self) -> tuple[float, ...]:
        """Axes at the start, in chain order."""
        return tuple(axis.home for axis in self.axes)

    @property
    def X_WB(self) -> Pose:
        """Its base in the world, which is machine zero."""
        return self.X_WM

    @property
    def link_names(self) -> tuple[str, ...]:
        """Everything that can carry something: base, links and flange."""
        if self.shipped is not None:
            return self.shipped.carriers
        return (BASE, *(f"link_{axis.letter}" for axis in self.axes), FLANGE, "table")

    def axis(self, letter: str) -> MachineAxis | None:
        return next((axis for axis in self.axes if axis.letter == letter), None)

    @property
    def chain(self) -> Chain:
        """The machine for the kinematics, with the limits that apply here; built again at each call.

        Importing the kinematics of machine tools loads the compiler, so reading a cell does not do it.
        """
        if self.shipped is None:
            from gcodesim.kinematics import cartesian

            return cartesian.chain_of_axes([_kinematic(axis, cartesian.Axis) for axis in self.axes])
        joints = list(self.shipped.joints)
        for axis, index in zip(self.axes, self.shipped.driven, strict=True):
            joints[index] = replace(
                joints[index],
                lower=axis.lower,
                upper=axis.upper,
                speed=axis.speed,
                acceleration=None if axis.assumed_acceleration else axis.acceleration,
                effort=axis.effort,
            )
        return replace(self.shipped, joints=tuple(joints), links=self._links(self.shipped))

    def _links(self, chain: Chain) -> tuple[Link, ...]:
        """The links of a shipped machine, with the masses that the cell gives."""
        from gcodesim.kinematics.chain import Inertial

        masses = {
            chain.joints[index].child: axis.moving_mass
            for axis, index in zip(self.axes, chain.driven, strict=True)
            if axis.moving_mass is not None
        }
        nothing = np.zeros((3, 3))
        return tuple(
            replace(link, inertial=Inertial(mass=masses[link.name], com=np.zeros(3), inertia=nothing))
            if link.name in masses
            else link
            for link in chain.links
        )

    def at(self, X_WM: Pose) -> MachineTool:
        return replace(self, X_WM=X_WM)


def _kinematic(axis: MachineAxis, kind: type[KinematicAxis]) -> KinematicAxis:
    """`axis` in the form that the kinematics takes."""
    return kind(
        letter=axis.letter,
        lower=axis.lower,
        upper=axis.upper,
        speed=axis.speed,
        acceleration=None if axis.assumed_acceleration else axis.acceleration,
        effort=axis.effort,
        side=axis.side,
        point=axis.at,
        vector=axis.direction,
        moving_mass=axis.moving_mass,
    )


_FORM: Final = Record(MachineForm, "the machine", "model")


@frozen(kw_only=False)
class MachineKind(Kind):
    """A machine tool."""

    @property
    def expected(self) -> str:
        return "a machine such as `gantry_xyz`, or `{axes: …}`"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        return _FORM.read(node, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return _FORM.schema(definitions)

    def show(self, value: Any) -> Any:
        shown_machine: Json = {"model": value.model} if value.model else {}
        shown_machine |= {"rapids": value.rapids, "axes": {axis.letter: _show_axis(axis) for axis in value.axes}}
        return shown_machine | {"base": Record(Place, "a place").show(value.base)}

    def plain(self, value: Any) -> tuple[str, Any]:
        machine: Json = {"model": value.model} if value.model else {}
        machine |= {"rapids": value.rapids, "axes": {axis.letter: _plain_axis(axis) for axis in value.axes}}
        return "", machine | {"base": Record(Place, "a place").plain(value.base)[1]}


def _axis_kinds(axis: MachineAxis) -> dict[str, tuple[Quantity, Any]]:
    place, speed, push, effort = (
        ("angle", "angular speed", "angular acceleration", "torque")
        if axis.rotary
        else ("length", "speed", "acceleration", "force")
    )
    return {
        "speed": (Quantity(speed), axis.speed),
        "acceleration": (Quantity(push), axis.acceleration),
        "home": (Quantity(place), axis.home),
        "moving_mass": (Quantity("mass"), axis.moving_mass),
        "effort": (Quantity(effort), axis.effort),
    }


def _show_axis(axis: MachineAxis) -> Json:
    place = Quantity(axis.measure)
    unlimited = math.isinf(axis.lower)
    row: Json = {"travel": "unlimited" if unlimited else [place.show(axis.lower), place.show(axis.upper)]}
    row |= {name: kind.show(value) for name, (kind, value) in _axis_kinds(axis).items() if value is not None}
    row["side"] = axis.side
    row |= {"at": POINT.show(axis.at)} if axis.at is not None else {}
    return row | ({"direction": list(axis.direction)} if axis.direction is not None else {})


def _plain_axis(axis: MachineAxis) -> Json:
    place = Quantity(axis.measure)
    suffix = place.plain(0.0)[0]
    row: Json = {"travel" + suffix: [place.plain(axis.lower)[1], place.plain(axis.upper)[1]]}
    for name, (kind, value) in _axis_kinds(axis).items():
        if value is not None:
            unit, number = kind.plain(value)
            row[name + unit] = number
    row |= {"side": axis.side, "assumed_acceleration": axis.assumed_acceleration}
    row |= {"at_mm": POINT.plain(axis.at)[1]} if axis.at is not None else {}
    return row | ({"direction": list(axis.direction)} if axis.direction is not None else {})


def is_lathe(machine: object) -> bool:
    """Whether a machine turns the work against a tool that stands; an arm never does."""
    return bool(getattr(machine, "lathe", False))

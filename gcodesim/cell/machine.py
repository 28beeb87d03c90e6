"""A machine tool: a shipped model, or one that is described by its axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from gcodesim import canon
from gcodesim.arithmetic.matrices import multiplied
from gcodesim.canon import AXIS_LETTERS
from gcodesim.cell.axes import AxesKind
from gcodesim.cell.joints import JointList, JointValue, check_within, in_si, unknown_letter
from gcodesim.cell.machine_axes import (
    LINEAR,
    AxisForm,
    LinearAxis,
    MachineAxis,
    RotaryAxis,
    ancestors,
    model_axes,
    own_axes,
    plain_axis,
    show_axis,
)
from gcodesim.cell.models import shipped, shipped_chain
from gcodesim.cell.named_kinematics import NAMED_KINEMATICS, KinematicsKind, NamedKinematics
from gcodesim.cell.placing import MACHINE, Place
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Json, Kind
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.plain_kinds import Choice, Text
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.frames import Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import BASE, FLANGE
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.cell.externals import External
    from gcodesim.kinematics.cartesian import Axis as KinematicAxis
    from gcodesim.kinematics.chain import Chain, Link

_AXES: Final = AxesKind(
    records={
        letter: Record(LinearAxis if letter in LINEAR else RotaryAxis, f"axis {letter}") for letter in AXIS_LETTERS
    },
    what="axis",
    example="X: {travel: [0, 500 mm], speed: 20 m/min}",
)
_NAMED: Final = KinematicsKind(
    family=NAMED_KINEMATICS, what="kinematics", example="{type: xyzac-trt-kins, y_offset: 20 mm}"
)


@frozen
class MachineForm:
    """A machine tool as written in the cell: `model`, or all its `axes`."""

    model: str | None = key(
        Text(form="the name of a shipped machine"), "a machine that ships with gcodesim", default=None
    )
    axes: Mapping[str, AxisForm] = key(
        _AXES, "axes in chain order; with a model, what differs from it", default={}, quiet=True
    )
    kinematics: NamedKinematics | None = key(
        _NAMED, "kinematics of LinuxCNC by name, which says where its rotary axes lie", default=None
    )
    rapids: Literal["linear", "independent"] = key(
        Choice(("linear", "independent")), "G0 in a straight line, or each axis for itself", default="linear"
    )
    home: Any = key(JointList(letters=True, example="[0, 0, 0]"), "axes at the start", default=None)
    lathe: bool | None = key(
        "switch", "the work turns about Z of its nose (default: as the model)", default=None, quiet=True
    )
    nose: Any = key(
        JointList(letters=True, example="[-150, -600 mm]"),
        "on a lathe: where the nose of its spindle is, as the axes count, X as a radius (default: at machine zero)",
        default=None,
        quiet=True,
    )
    base: Place = key(Record(Place, "a place"), "where machine zero is", default=Place(), quiet=True)

    def checked(self, to: Reading, path: Path) -> MachineTool | Unread:
        if self.model is not None:
            model = shipped(self.model, "machine", to, (*path, "model"))
            if isinstance(model, Unread):
                return UNREAD
            chain, turned = shipped_chain(model.name), model.lathe
            if self.kinematics is not None:
                message = f"`{model.name}` has kinematics of its own"
                return to.fault("GS719", to.key((*path, "kinematics")), message, "give its `axes` in place of `model`")
            nose = self._nose(chain.driven_joints.names, turned, to, (*path, "nose"))
            if isinstance(nose, Unread):
                return UNREAD
            axes = model_axes(chain, model.home, self.axes, nose, to, (*path, "axes"))
        elif self.axes:
            chain, turned = None, False
            nose = self._nose(tuple(self.axes), bool(self.lathe), to, (*path, "nose"))
            if isinstance(nose, Unread):
                return UNREAD
            forms = self.axes if self.kinematics is None else self.kinematics.seated(self.axes, to, path)
            axes = UNREAD if isinstance(forms, Unread) else own_axes(forms, to, (*path, "axes"))
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
                f"home of axis {axis.letter}",
                to,
                self._home_path(axis.letter, i, path),
            )
            for i, axis in enumerate(axes)
        ]
        if not all(within):
            return UNREAD
        turns = bool(self.lathe) if self.lathe is not None else turned
        if (named := self.kinematics) is not None:  # only now, as `home` may be a list in the order of the file
            axes = tuple(sorted(axes, key=lambda axis: named.rank(axis.letter)))
        return MachineTool(
            model=self.model,
            shipped=chain,
            axes=axes,
            rapids=self.rapids,
            base=self.base,
            lathe=turns,
            kinematics=self.kinematics,
            nose=nose,
        )

    def _nose(self, letters: Sequence[str], turns: bool, to: Reading, path: Path) -> canon.Point | Unread:
        """Where the nose of a lathe's spindle is in M [m]."""
        if self.nose is None:
            return (0.0, 0.0, 0.0)
        if not turns:
            return to.fault("GS710", to.key(path), "`nose` is the place of a lathe's spindle", "say `lathe: true` too")
        linear = [letter for letter in letters if letter in LINEAR]
        named: Mapping[str, JointValue]
        if isinstance(self.nose, dict):
            named = self.nose
        elif len(self.nose) == len(linear):
            named = dict(zip(linear, self.nose, strict=True))
        else:
            message = f"`nose` has {len(self.nose)} entries; the machine has {len(linear)} linear axes"
            return to.fault("GS706", to.span(path), message)
        strangers = [letter for letter in named if letter not in linear]
        for letter in strangers:
            unknown_letter(letter, linear, (*path, letter), to)
        if strangers:
            return UNREAD
        lengths = [Quantity("length")] * len(named)
        places = in_si(list(named.values()), lengths, to, is_list=not isinstance(self.nose, dict))
        if isinstance(places, Unread):
            return UNREAD
        at = dict(zip(named, places, strict=True))
        return (at.get("X", 0.0), at.get("Y", 0.0), at.get("Z", 0.0))

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


@frozen
class MachineTool:
    """A machine tool of the cell. `shipped` is the content of the URDF of its `model`, None without a model.

    On a `lathe` the work turns about the Z of `nose`, the place of its spindle in M [m], which is its base B; on
    others B is M. `kinematics` has said where its rotary axes lie.
    `externals` are a table on its own one, or beside it; its axes are the last of `axes`, once their place is known.
    """

    model: str | None
    axes: tuple[MachineAxis, ...]
    rapids: Literal["linear", "independent"]
    base: Place
    shipped: Chain | None = field(compare=False, repr=False, default=None)
    X_WM: Pose = field(default_factory=Pose.identity, compare=False)
    lathe: bool = False
    kinematics: NamedKinematics | None = None
    nose: canon.Point = (0.0, 0.0, 0.0)
    externals: tuple[External, ...] = field(default=(), compare=False, repr=False)

    @property
    def tip_first(self) -> bool:
        """Whether kinematics that the cell names hold the tip before the program says so."""
        return self.kinematics is not None and self.kinematics.from_start

    @property
    def platforms(self) -> dict[str, Pose]:
        """X_WC of what external axes carry, with these at zero, by the name of the link: `machine/table`."""
        return {f"{MACHINE}/{external.name}": external.X_WE for external in self.externals}

    @property
    def home(self) -> tuple[float, ...]:
        """Axes at the start, in chain order."""
        return tuple(axis.home for axis in self.axes)

    @property
    def X_WB(self) -> Pose:
        """Its base in the world: machine zero, or the nose of a lathe's spindle."""
        return self.X_WM @ Pose(np.array(self.nose), np.eye(3)) if any(self.nose) else self.X_WM

    @property
    def link_names(self) -> tuple[str, ...]:
        """Everything that can carry something: base, links and flange."""
        outside = tuple(external.name for external in self.externals)
        if self.shipped is not None:
            return (*self.shipped.carriers, *outside)
        return (BASE, *(f"link_{axis.letter}" for axis in self.built_in_axes), FLANGE, "table", *outside)

    @property
    def own_table(self) -> str | None:
        """The link on which things stand that name none, where an external carries the work; None: without one."""
        if not self.externals:
            return None
        chain = self._own_chain
        return chain.table or chain.links[0].name

    @property
    def built_in_axes(self) -> tuple[MachineAxis, ...]:
        """Its axes without those of externals."""
        letters = {letter for external in self.externals for letter in external.axes}
        return tuple(axis for axis in self.axes if axis.letter not in letters)

    def axis(self, letter: str) -> MachineAxis | None:
        return next((axis for axis in self.axes if axis.letter == letter), None)

    @property
    def chain(self) -> Chain:
        """The machine for the kinematics, with the limits that apply here; built again at each call.

        Importing the kinematics of machine tools loads the compiler, so reading a cell does not do it.
        """
        from gcodesim.kinematics import cartesian

        chain = self._own_chain
        for external in self.externals:
            axes = [_kinematic(axis, cartesian.Axis) for axis in self.axes if axis.letter in external.axes]
            X_BE = self.X_WB.inverse() @ external.X_WE
            chain = cartesian.with_table(chain, axes, external.name, X_BE)
        return chain

    @property
    def _own_chain(self) -> Chain:
        """The same without externals."""
        if self.shipped is None:
            from gcodesim.kinematics import cartesian

            own = cartesian.chain_of_axes([_kinematic(axis, cartesian.Axis) for axis in self.built_in_axes])
            return self._seen_from_nose(own)
        joints = list(self.shipped.joints)
        for axis, index in zip(self.built_in_axes, self.shipped.driven, strict=True):
            joints[index] = replace(
                joints[index],
                lower=axis.lower,
                upper=axis.upper,
                speed=axis.speed,
                acceleration=None if axis.assumed_acceleration else axis.acceleration,
                effort=axis.effort,
                jerk=axis.jerk,
            )
        return self._seen_from_nose(replace(self.shipped, joints=tuple(joints), links=self._links(self.shipped)))

    def _seen_from_nose(self, chain: Chain) -> Chain:
        """`chain`, whose flange is in its base with all axes at zero, with the flange at machine zero then."""
        if not any(self.nose):
            return chain
        back = Pose(-np.array(self.nose), np.eye(3)).matrix
        root, on_tool_side = chain.links[0].name, ancestors(chain, chain.flange)
        joints = [
            replace(joint, X=multiplied(back, joint.X))
            if joint.parent == root and joint.child in on_tool_side
            else joint
            for joint in chain.joints
        ]
        return replace(chain, joints=tuple(joints))

    def _links(self, chain: Chain) -> tuple[Link, ...]:
        """The links of a shipped machine, with the masses that the cell gives."""
        from gcodesim.kinematics.chain import Inertial

        masses = {
            chain.joints[index].child: axis.moving_mass
            for axis, index in zip(self.built_in_axes, chain.driven, strict=True)
            if axis.moving_mass is not None
        }
        nothing = np.zeros((3, 3))
        return tuple(
            replace(link, inertial=Inertial(mass=masses[link.name], com=np.zeros(3), inertia=nothing))
            if link.name in masses
            else link
            for link in chain.links
        )

    def at(self, X_WM: Pose, externals: tuple[External, ...] = ()) -> MachineTool:
        """The machine with its zero there, and with `externals` whose places are known."""
        X_WB = replace(self, X_WM=X_WM).X_WB
        more = [axis for external in externals for axis in external.of_machine(X_WB)]
        return replace(self, X_WM=X_WM, axes=(*self.built_in_axes, *more), externals=externals)


def _kinematic(axis: MachineAxis, kind: type[KinematicAxis]) -> KinematicAxis:
    """`axis` in the form that the kinematics takes."""
    return kind(
        letter=axis.letter,
        lower=axis.lower,
        upper=axis.upper,
        speed=axis.speed,
        acceleration=None if axis.assumed_acceleration else axis.acceleration,
        effort=axis.effort,
        jerk=axis.jerk,
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
        shown_machine |= {} if value.kinematics is None else {"kinematics": _NAMED.show(value.kinematics)}
        axes = {axis.letter: show_axis(axis) for axis in value.built_in_axes}
        shown_machine |= {"rapids": value.rapids, "axes": axes}
        return shown_machine | _plain_nose(value.nose) | {"base": Record(Place, "a place").show(value.base)}

    def plain(self, value: Any) -> tuple[str, Any]:
        machine: Json = {"model": value.model} if value.model else {}
        machine |= {} if value.kinematics is None else {"kinematics": _NAMED.plain(value.kinematics)[1]}
        machine |= {"rapids": value.rapids, "axes": {axis.letter: plain_axis(axis) for axis in value.built_in_axes}}
        return "", machine | _plain_nose(value.nose) | {"base": Record(Place, "a place").plain(value.base)[1]}


def _plain_nose(nose: canon.Point) -> Json:
    """The entry of a spindle nose; none where it is at machine zero."""
    return {"nose": [f"{at / MM:.10g} mm" for at in nose]} if any(nose) else {}


def is_lathe(machine: object) -> bool:
    """Whether a machine turns the work against a tool that stands; an arm never does."""
    return bool(getattr(machine, "lathe", False))

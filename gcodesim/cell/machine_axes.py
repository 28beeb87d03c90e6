"""Axes of a machine tool: as the cell writes them, and complete."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final, Literal

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.cell.axes import SPIN_UP, UNLIMITED, nearest_home
from gcodesim.cell.joints import Measure, unknown_letter
from gcodesim.cell.placing import POINT
from gcodesim.declarations.composed import Either
from gcodesim.declarations.keys import key
from gcodesim.declarations.keys import keys as keys_of
from gcodesim.declarations.kind import POSITIVE, WITHIN_REACH, Json
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.units import shown
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Chain

LINEAR: Final = ("X", "Y", "Z")
ROTARY: Final = ("A", "B", "C")

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
    jerk: float | None = key(
        Quantity("jerk", POSITIVE), "greatest change of acceleration (default: any)", default=None, quiet=True
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
    jerk: float | None = key(
        Quantity("angular jerk", POSITIVE), "greatest change of acceleration (default: any)", default=None, quiet=True
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

    `jerk` [m/s³, rad/s³]; None: any.

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
    jerk: float | None = None

    @property
    def measure(self) -> Measure:
        return "angle" if self.rotary else "length"

    @property
    def middle(self) -> float:
        """Mid-travel; infinite travel has none."""
        return 0.5 * (self.lower + self.upper)


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


def own_axes(forms: Mapping[str, AxisForm], to: Reading, path: Path) -> tuple[MachineAxis, ...] | Unread:
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
        home = nearest_home(*travel) if form.home is None else form.home
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
                jerk=form.jerk,
            )
        )
    good = tuple(axis for axis in axes if not isinstance(axis, Unread))
    return good if len(good) == len(axes) else UNREAD


def model_axes(
    chain: Chain,
    home: tuple[float, ...],
    forms: Mapping[str, AxisForm],
    nose: tuple[float, float, float],
    to: Reading,
    path: Path,
) -> tuple[MachineAxis, ...] | Unread:
    """Axes of a shipped machine, with the changes of the cell; `nose` [m] is where its base stands in M."""
    joints = chain.driven_joints
    strangers = [letter for letter in forms if letter not in joints.names]
    for letter in strangers:
        unknown_letter(letter, joints.names, (*path, letter), to)
    if strangers:
        return UNREAD
    on_tool_side = ancestors(chain, chain.flange)
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
        shift = 0.0 if rotary else nose[LINEAR.index(letter)]
        shipped = (float(joints.lower[i]) + shift, float(joints.upper[i]) + shift)
        lower, upper = travel if isinstance(travel, tuple) else shipped
        start = form.home if form.home is not None else min(max(home[i] + shift, lower), upper)
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
                jerk=form.jerk if form.jerk is not None else joint.jerk,
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


def ancestors(chain: Chain, link: str) -> set[str]:
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


def _axis_kinds(axis: MachineAxis) -> dict[str, tuple[Quantity, Any]]:
    place, speed, push, jerk, effort = (
        ("angle", "angular speed", "angular acceleration", "angular jerk", "torque")
        if axis.rotary
        else ("length", "speed", "acceleration", "jerk", "force")
    )
    return {
        "speed": (Quantity(speed), axis.speed),
        "acceleration": (Quantity(push), axis.acceleration),
        "jerk": (Quantity(jerk), axis.jerk),
        "home": (Quantity(place), axis.home),
        "moving_mass": (Quantity("mass"), axis.moving_mass),
        "effort": (Quantity(effort), axis.effort),
    }


def show_axis(axis: MachineAxis) -> Json:
    place = Quantity(axis.measure)
    unlimited = math.isinf(axis.lower)
    row: Json = {"travel": "unlimited" if unlimited else [place.show(axis.lower), place.show(axis.upper)]}
    row |= {name: kind.show(value) for name, (kind, value) in _axis_kinds(axis).items() if value is not None}
    row["side"] = axis.side
    row |= {"at": POINT.show(axis.at)} if axis.at is not None else {}
    return row | ({"direction": list(axis.direction)} if axis.direction is not None else {})


def plain_axis(axis: MachineAxis) -> Json:
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

"""External axes of a robot: carriages that carry it, and positioners that carry the work."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.cell.axes import SPIN_UP, UNLIMITED, AxesKind, nearest_home
from gcodesim.cell.joints import Measure, check_within
from gcodesim.cell.placing import MACHINE, POINT, Place
from gcodesim.declarations.composed import Either
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, WITHIN_REACH
from gcodesim.declarations.plain_kinds import Switch, Text
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.declarations.record import Record
from gcodesim.declarations.units import shown
from gcodesim.frames import Pose
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.cell.cell import Cell
    from gcodesim.cell.machine import MachineTool
    from gcodesim.cell.machine_axes import MachineAxis
    from gcodesim.cell.robot import Robot
    from gcodesim.kinematics.assembly import Carrier

TURNING: Final = ("A", "B", "C")
SLIDING: Final = ("U", "V", "W")
_DIRECTION: Final = Vector(Quantity("ratio"), 3, "[0, 1, 0]")


@frozen
class SlidingAxis:
    """A linear external axis as written in the cell: U, V or W."""

    travel: tuple[float, float] = key(
        Vector(Quantity("length", WITHIN_REACH), 2, "[0, 3 m]"), "least and greatest position"
    )
    speed: float = key(Quantity("speed", POSITIVE), "greatest speed")
    acceleration: float | None = key(
        Quantity("acceleration", POSITIVE), "acceleration (assumed: full speed in 0.25 s)", default=None
    )
    jerk: float | None = key(
        Quantity("jerk", POSITIVE), "greatest change of acceleration (default: any)", default=None, quiet=True
    )
    home: float | None = key(
        Quantity("length"), "position at the start (default 0, else the nearer end)", default=None, example="0 mm"
    )
    direction: tuple[float, float, float] | None = key(
        _DIRECTION, "the way of positive motion in `base` (default: X, Y, Z for U, V, W)", default=None, quiet=True
    )
    moving_mass: float | None = key(
        Quantity("mass", POSITIVE), "mass that the axis moves besides what stands on it", default=None, quiet=True
    )
    effort: float | None = key(
        Either((("none", math.inf),), Quantity("force", POSITIVE)),
        "greatest force, `none`: unlimited",
        default=None,
        quiet=True,
    )
    free: bool | None = key(Switch(), "the planner chooses where it stands", default=None, quiet=True)


@frozen
class TurningAxis:
    """A rotary external axis as written in the cell: A, B or C."""

    travel: tuple[float, float] = key(
        Either((("unlimited", UNLIMITED),), Vector(Quantity("angle"), 2, "[-120, 120 deg]")),
        "least and greatest position, or `unlimited`",
    )
    speed: float = key(Quantity("angular speed", POSITIVE), "greatest speed")
    acceleration: float | None = key(
        Quantity("angular acceleration", POSITIVE), "acceleration (assumed: full speed in 0.25 s)", default=None
    )
    jerk: float | None = key(
        Quantity("angular jerk", POSITIVE), "greatest change of acceleration (default: any)", default=None, quiet=True
    )
    home: float | None = key(
        Quantity("angle"), "position at the start (default 0, else the nearer end)", default=None, example="0 deg"
    )
    at: tuple[float, float, float] = key(
        POINT, "a point on the axis, in `base`", default=(0.0, 0.0, 0.0), quiet=True, example="[0, 0, 150 mm]"
    )
    direction: tuple[float, float, float] | None = key(
        _DIRECTION,
        "what it turns right-handed about, in `base` (default: X, Y, Z for A, B, C)",
        default=None,
        quiet=True,
    )
    moving_mass: float | None = key(
        Quantity("mass", POSITIVE), "mass that the axis moves besides what stands on it", default=None, quiet=True
    )
    effort: float | None = key(
        Either((("none", math.inf),), Quantity("torque", POSITIVE)),
        "greatest torque, `none`: unlimited",
        default=None,
        quiet=True,
    )
    free: bool | None = key(Switch(), "the planner chooses where it stands", default=None, quiet=True)


AxisForm = SlidingAxis | TurningAxis


_AXES: Final = AxesKind(
    records={
        **{letter: Record(TurningAxis, f"axis {letter}") for letter in TURNING},
        **{letter: Record(SlidingAxis, f"axis {letter}") for letter in SLIDING},
    },
    what="external axis",
    example="U: {travel: [0, 3 m], speed: 1 m/s}",
    least=1,
)


@frozen
class External:
    """External axes that carry a robot, or the work. `X_WE` is their frame in the world, once frames are known."""

    axes: Mapping[str, AxisForm] = key(_AXES, "its axes in chain order, from the ground on")
    carries: str | None = key(
        Text(form="the name of a robot"), "the robot that stands on it; without: it carries work", default=None
    )
    robot: str | None = key(
        Text(form="the name of a robot, or `machine`"),
        "whose program moves it (default: the only robot, or the machine where there is none)",
        default=None,
        quiet=True,
    )
    base: Place = key(Record(Place, "a place"), "where it stands with all axes at zero", default=Place())
    free: bool = key(Switch(), "the planner chooses where its axes stand", default=False)
    name: str = ""
    X_WE: Pose = field(default_factory=Pose.identity, compare=False)

    def checked(self, to: Reading, path: Path) -> External | Unread:
        good = True
        for letter, axis in self.axes.items():
            at = (*path, "axes", letter)
            measure: Measure = "length" if letter in SLIDING else "angle"
            low, high = axis.travel
            if not low < high:
                message = f"travel of axis {letter} goes from {shown(low, measure)} to {shown(high, measure)}"
                to.fault("GS710", to.span((*at, "travel")), message, "the second must be greater")
                good = False
            elif axis.home is not None:
                good &= check_within(axis.home, low, high, measure, f"home of axis {letter}", to, (*at, "home"))
            if axis.direction is not None and not any(axis.direction):
                to.fault("GS710", to.span((*at, "direction")), f"the direction of axis {letter} has no length")
                good = False
        if not self.axes:
            hint = "such as `axes: {U: {travel: [0, 3 m], speed: 1 m/s}}`"
            to.fault("GS705", to.span(path), "an external without axes", hint)
            good = False
        return replace(self, name=str(path[-1])) if good else UNREAD

    @property
    def homes(self) -> tuple[float, ...]:
        """Where its axes start [m, rad]."""
        return tuple(nearest_home(*axis.travel) if axis.home is None else axis.home for axis in self.axes.values())

    def is_free(self, letter: str) -> bool:
        """Whether the planner chooses where this axis stands."""
        own = self.axes[letter].free
        return self.free if own is None else own

    def of_machine(self, X_WM: Pose) -> tuple[MachineAxis, ...]:
        """Its turning axes as those of a machine tool with machine zero at `X_WM`."""
        from gcodesim.cell.machine_axes import MachineAxis

        X_ME = X_WM.inverse() @ self.X_WE
        found = []
        for (letter, axis), home in zip(self.axes.items(), self.homes, strict=True):
            assert isinstance(axis, TurningAxis)
            direction = np.array(axis.direction or np.eye(3)[TURNING.index(letter)])
            x, y, z = X_ME.apply(np.array(axis.at)).tolist()
            a, b, c = X_ME.rotate(direction).tolist()
            found.append(
                MachineAxis(
                    letter=letter,
                    rotary=True,
                    lower=axis.travel[0],
                    upper=axis.travel[1],
                    speed=axis.speed,
                    acceleration=axis.acceleration or axis.speed / SPIN_UP,
                    assumed_acceleration=axis.acceleration is None,
                    home=home,
                    side="table",
                    at=(x, y, z),
                    direction=(a, b, c),
                    moving_mass=axis.moving_mass,
                    effort=math.inf if axis.effort is None else axis.effort,
                    jerk=axis.jerk,
                )
            )
        return tuple(found)

    def carrier(self, X_WB: Pose) -> Carrier:
        """What `kinematics.assembly` takes, for a robot with its base at `X_WB`."""
        from gcodesim.kinematics.assembly import Carrier, ExternalAxis

        units = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        axes = tuple(
            ExternalAxis(
                name=f"{self.name}/{letter}",
                kind="prismatic" if letter in SLIDING else "revolute",
                vector=axis.direction or units["ABCUVW".index(letter) % 3],
                point=axis.at if isinstance(axis, TurningAxis) else (0.0, 0.0, 0.0),
                lower=axis.travel[0],
                upper=axis.travel[1],
                speed=axis.speed,
                acceleration=axis.acceleration or axis.speed / SPIN_UP,
                effort=math.inf if axis.effort is None else axis.effort,
                jerk=axis.jerk,
                moving_mass=axis.moving_mass,
            )
            for letter, axis in self.axes.items()
        )
        return Carrier(name=self.name, axes=axes, X_BE=X_WB.inverse() @ self.X_WE, carries_arm=self.carries is not None)


def columns_of(externals: Sequence[External], taken: Sequence[int] = ()) -> dict[str, int]:
    """Which of the words a, b, c of a path (0 to 2) holds each commanded letter; -1 where there is no room.

    A, B, C have their own; U, V, W take what is left. `taken` are words that lean the tool.
    """
    letters = [letter for external in externals for letter in external.axes if not external.is_free(letter)]
    columns = {letter: TURNING.index(letter) for letter in letters if letter in TURNING}
    left = [column for column in range(3) if column not in (*columns.values(), *taken)]
    for letter in letters:
        if letter in SLIDING:
            columns[letter] = left.pop(0) if left else -1
    return columns


def with_externals(cell: Cell, to: Reading) -> Cell:
    """`cell` with its externals given to those whose programs move them; faults become findings of `to`."""
    given: dict[str, list[External]] = {}
    robots = list(cell.robots)
    for name, external in cell.externals.items():
        path: Path = ("externals", name)
        owner = external.carries or external.robot
        which = "carries" if external.carries else "robot"
        if owner is None and len(robots) <= 1:
            owner = robots[0] if robots else MACHINE
        if owner == MACHINE and (MACHINE,) in to.keys:
            if cell.machine is not None and _suits_machine(cell.machine, external, given.get(MACHINE, ()), to):
                given.setdefault(MACHINE, []).append(external)
            continue
        if owner is None or owner not in robots:
            if owner is None:
                message = f"whose program moves `{name}` nobody can know"
                to.fault("GS722", to.span(path), message, "write `robot:` with its name")
            elif owner not in to.names_in("robots"):  # else it has a fault of its own
                to.fault("GS712", to.span((*path, which)), f"there is no robot `{owner}`", suggestion(owner, robots))
            continue
        if name in cell.robots or name in cell.placed_frames:
            to.fault("GS719", to.key(path), f"`{name}` is the name of something else too", "choose another one")
            continue
        given.setdefault(owner, []).append(external)
    machine = cell.machine
    if machine is not None and MACHINE in given:
        machine = replace(machine, externals=tuple(given.pop(MACHINE)))
    equipped = dict(cell.robots)
    for owner, own in given.items():
        if _fits(equipped[owner], own, to):
            equipped[owner] = equipped[owner].with_externals(tuple(own))
    return replace(cell, robots=equipped, machine=machine)


def _suits_machine(machine: MachineTool, external: External, others: Sequence[External], to: Reading) -> bool:
    """Whether a machine tool can have these axes: tables that turn its work, moved by letters that nothing else has."""
    path: Path = ("externals", external.name)
    if external.name in machine.link_names or external.name == MACHINE:
        message = f"`{external.name}` is the name of a link of the machine"
        to.fault("GS719", to.key(path), message, "choose another one")
        return False
    if external.carries is not None:
        message = "a machine tool stands; nothing carries it"
        to.fault("GS719", to.span((*path, "carries")), message, "write the way as its X, Y or Z")
        return False
    if others:
        message = f"the work of a machine tool stands on one table, and `{others[0].name}` is one already"
        to.fault("GS719", to.key(path), message, "write the axes of both under one name, from the ground on")
        return False
    good = True
    for letter in external.axes:
        span = to.key((*path, "axes", letter))
        if letter in SLIDING:
            message = f"{letter} is no word of a machine tool"
            to.fault("GS719", span, message, "a way under the work is its X, Y or Z, with `side: table`")
        elif external.is_free(letter):
            message = f"the program moves {letter}; there is nothing to choose on a machine tool"
            to.fault("GS719", span, message, "leave `free` out")
        elif machine.axis(letter) is not None:
            message = f"axis {letter} is commanded in `machine` and in `{external.name}`"
            to.fault("GS719", span, message, "one letter, one axis")
        else:
            continue
        good = False
    return good


def _fits(robot: Robot, externals: Sequence[External], to: Reading) -> bool:
    """Whether letters and names are there once."""
    first: dict[str, str] = {}
    good = True
    for external in externals:
        path: Path = ("externals", external.name)
        if external.name in robot.chain.link_names:
            message = f"`{external.name}` is the name of a link of `{robot.name}`"
            to.fault("GS719", to.key(path), message, "choose another one")
            good = False
        for letter in external.axes:
            if external.is_free(letter):
                continue
            if letter in first:
                message = f"axis {letter} is commanded in `{first[letter]}` and in `{external.name}`"
                to.fault("GS719", to.key((*path, "axes", letter)), message, "one letter, one axis")
                good = False
            first.setdefault(letter, external.name)
    return good


def check_words(cell: Cell, to: Reading) -> None:
    """WordTurns that lean a tool are not those of an external axis, and there is room for all of them."""
    for name, channel in cell.channels.items():
        robot = cell.robots.get(str(channel.robot))
        if robot is None or not robot.externals:
            continue
        words = () if channel.orientation is None else channel.orientation.words or ()
        columns = columns_of(robot.externals, [turn.word for turn in words])
        for external in robot.externals:
            for letter in external.axes:
                column = columns.get(letter)
                leans = letter in TURNING and column in [turn.word for turn in words]
                if column is None or (column >= 0 and not leans):
                    continue
                span = to.key(("externals", external.name, "axes", letter))
                if leans:
                    message = f"{letter} turns `{external.name}`, and by `words` the tool of channel `{name}` too"
                    to.fault("GS719", span, message, "let the planner choose (`free: true`), or take other words")
                else:
                    message = f"{letter} is the fourth word besides X, Y, Z; a program may have three"
                    to.fault("GS719", span, message, "let the planner choose where an axis stands: `free: true`")

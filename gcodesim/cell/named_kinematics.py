"""Kinematics of LinuxCNC by name: where rotary axes of a machine lie, in the words of that control's modules.

Each becomes places and directions of the axes of the cell, so that there is one way from axes to the tip, whoever
describes the machine. Parameters are those of the modules; `tool-offset` and `tool-length` are none of them, because
the length offset of the program (G43) always counts along the tool. Facts: LinuxCNC, `src/emc/kinematics/trtfuncs.c`,
`5axiskins.c`, `maxkins.c`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Final, NamedTuple

from gcodesim.cell.machine_axes import LINEAR, AxisForm, RotaryAxis, Side
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE
from gcodesim.declarations.plain_kinds import Switch
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.variant import Variant
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.canon import Point

_X: Final = (1.0, 0.0, 0.0)
_Y: Final = (0.0, 1.0, 0.0)
_Z: Final = (0.0, 0.0, 1.0)


class Seat(NamedTuple):
    """Where a rotary axis lies: on which side, a point on it [m] in M, and what its side turns right-handed about."""

    side: Side
    at: Point
    direction: Point


@frozen
class NamedKinematics:
    """What all of them have. A rotary axis of another letter only takes time, as there it is passed on as it is."""

    kind: ClassVar[str]

    @property
    def seats(self) -> Mapping[str, Seat]:
        """The rotary axes that move tip or work, in chain order."""
        raise NotImplementedError

    @property
    def from_start(self) -> bool:
        """Whether words are those of the tip before any M428."""
        return not getattr(self, "identity_first", False)

    def rank(self, letter: str) -> int:
        """Where an axis stands in the chain: linear ones first."""
        order = (*LINEAR, *self.seats)
        return order.index(letter) if letter in order else len(order)

    def seated(self, axes: Mapping[str, AxisForm], to: Reading, path: Path) -> dict[str, AxisForm] | Unread:
        """`axes` of the machine at `path` with their places; what contradicts them is a finding."""
        missing = [letter for letter in (*LINEAR, *self.seats) if letter not in axes]
        if missing:
            message = f"`{self.kind}` moves {', '.join((*LINEAR, *self.seats))}; `axes` lacks {', '.join(missing)}"
            hint = f"such as `{missing[0]}: {{travel: …, speed: …}}`"
            return to.fault("GS705", to.key((*path, "axes")), message, hint)
        seated: dict[str, AxisForm] = {}
        good = True
        for letter, form in axes.items():
            seat = self.seats.get(letter)
            for name in ("side", "at", "direction") if isinstance(form, RotaryAxis) else ():
                if getattr(form, name) is not None:
                    message = f"`{name}` of axis {letter} follows from `{self.kind}`"
                    hint = "leave it out, or describe the machine by its axes without `kinematics`"
                    to.fault("GS719", to.key((*path, "axes", letter, name)), message, hint)
                    good = False
            seated[letter] = form if seat is None else replace(form, **seat._asdict())
        return seated if good else UNREAD


def _length(doc: str, default: float | None = 0.0) -> Any:
    return key(Quantity("length"), doc, default=default, quiet=True, example="20 mm")


@frozen
class _Switched:
    """What kinematics have that a program can switch off."""

    identity_first: bool = key(
        Switch(), "a program begins with its axes, and M428 switches these kinematics on", default=False
    )


@frozen
class _TiltingTable(NamedKinematics, _Switched):
    """A rotary table C on a cradle A or B."""

    x_rot_point: float = _length("where C lies along X, in machine coordinates")
    y_rot_point: float = _length("where C lies along Y, in machine coordinates")
    z_rot_point: float = _length("what `z_offset` counts from, in machine coordinates")
    z_offset: float = _length("from there to the axis of the cradle along Z")
    conventional_directions: bool = key(
        Switch(), "angles are those of the tool as seen from the work (ISO 841), not those of the table", default=False
    )

    def _table(self, letter: str, beside: Point, vector: Point) -> dict[str, Seat]:
        sign = -1.0 if self.conventional_directions else 1.0
        x, y, z = self.x_rot_point, self.y_rot_point, self.z_rot_point
        cradle = (x + beside[0], y + beside[1], z + beside[2])
        turned: Point = (sign * vector[0], sign * vector[1], sign * vector[2])
        return {letter: Seat("table", cradle, turned), "C": Seat("table", (x, y, z), (0.0, 0.0, sign))}


@frozen
class TrunnionA(_TiltingTable):
    """A mill whose table C sits on a cradle A."""

    kind: ClassVar[str] = "xyzac-trt-kins"

    y_offset: float = _length("from C to the axis of the cradle along Y")

    @property
    def seats(self) -> Mapping[str, Seat]:
        return self._table("A", (0.0, self.y_offset, self.z_offset), _X)


@frozen
class TrunnionB(_TiltingTable):
    """A mill whose table C sits on a cradle B."""

    kind: ClassVar[str] = "xyzbc-trt-kins"

    x_offset: float = _length("from C to the axis of the cradle along X")

    @property
    def seats(self) -> Mapping[str, Seat]:
        return self._table("B", (self.x_offset, 0.0, self.z_offset), _Y)


@frozen
class BridgeMill(NamedKinematics, _Switched):
    """A bridge mill whose head turns by C and tilts by B, against the usual sense."""

    kind: ClassVar[str] = "5axiskins"

    pivot_length: float = key(
        Quantity("length", NOT_NEGATIVE), "from the point where B and C meet to the spindle nose", default=0.25
    )

    @property
    def seats(self) -> Mapping[str, Seat]:
        pivot = (0.0, 0.0, self.pivot_length)
        return {"C": Seat("tool", pivot, _Z), "B": Seat("tool", pivot, (0.0, -1.0, 0.0))}


@frozen
class Max(NamedKinematics):
    """A mill with a head that tilts by B, over a table that turns by C at X0 Y0."""

    kind: ClassVar[str] = "maxkins"

    pivot_length: float = key(
        Quantity("length", NOT_NEGATIVE), "from the axis of B to the spindle nose", example="160 mm"
    )
    conventional_directions: bool = key(Switch(), "B turns in the usual sense (ISO 841)", default=False)

    @property
    def seats(self) -> Mapping[str, Seat]:
        sign = 1.0 if self.conventional_directions else -1.0
        head = Seat("tool", (0.0, 0.0, self.pivot_length), (0.0, sign, 0.0))
        return {"B": head, "C": Seat("table", (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))}


NAMED_KINEMATICS: Final[Mapping[str, type[NamedKinematics]]] = {
    cls.kind: cls for cls in (TrunnionA, TrunnionB, BridgeMill, Max)
}


@frozen
class KinematicsKind(Variant):
    """Kinematics of LinuxCNC."""

    def name(self, path: Path) -> str:
        return "the kinematics"

"""Tool centre point control: what the reader of programs asks of a machine whose rotary axes turn tool or work."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from gcodesim import canon
from gcodesim.rs274.state import AXES, Vector
from gcodesim.units import DEG

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gcodesim.rs274.control import Control


CENTRE_POINT = (434, 435)
"""G43.4 and G43.5: length modes in which the control holds the tip."""


CLOSE = 1e-9
"""[rad] between turns that count as equally far."""


class ToolPointLaw(Protocol):
    """Tip and axes of one machine, in M [m, rad]; `offset` is the length offset in force."""

    @property
    def letters(self) -> tuple[str, ...]:
        """Its rotary axes whose place is known; of an arm, the words that turn the tool or an external axis."""
        ...

    @property
    def in_system(self) -> bool:
        """Whether directions are in axes of the work system, along which its words turn; else in those of the work."""
        ...

    def axes(self, tip: canon.Axes, offset: canon.Axes) -> canon.Axes:
        """Where the axes stand with the tip there; x y z in the frame of the work, a b c as the rotary axes stand."""
        ...

    def tip(self, axes: canon.Axes, offset: canon.Axes) -> canon.Axes:
        """The inverse of `axes`."""
        ...

    def attitudes(self, direction: canon.Point, axes: canon.Axes) -> list[canon.Axes]:
        """Axes turned so that the tool points from its tip along `direction`, as `in_system` says.

        At most two ways, each within the travel and as near to `axes` as it can be; the linear axes stay.
        """
        ...

    def words_of(self, directions: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Words a, b, c (n, 3) [rad] of `attitudes` for many directions (n, 3).

        None where they depend on where the axes stand, or tip and axes are farther apart than by the offset.
        """
        ...

    def carried(self, vector: canon.Point, before: canon.Axes, now: canon.Axes) -> canon.Point | None:
        """Where `vector`, which stands on the table, points when axes have gone from `before` to `now`; in M.

        None where no table is turned by an axis whose place is known.
        """
        ...


def direction_for(law: ToolPointLaw, control: Control, own: canon.Point) -> canon.Point:
    """A direction along axes of the active work system as `law` takes it."""
    return own if law.in_system else control.leant(own)


def tilting_axis(law: ToolPointLaw) -> int:
    """Which of x y z a b c tilts the tool: the first rotary axis that is not called C."""
    return next((3 + "ABC".index(letter) for letter in law.letters if letter != "C"), 3)


def nearest(ways: list[canon.Axes], here: canon.Axes, tilting: int) -> canon.Axes:
    """The way with the shortest turns from `here`; of two as short, that with the greater angle of the tilting axis."""

    def effort(way: canon.Axes) -> tuple[float, float]:
        return round(sum(abs(a - b) for a, b in zip(way[3:], here[3:], strict=True)) / CLOSE), -way[tilting]

    return min(ways, key=effort)


def is_possible(control: Control, *, by_vector: bool = False) -> bool:
    """Whether words turn the tool in known ways, or a vector does; without a cell nobody asks where axes stand."""
    law = control.settings.tool_point
    if law is None:
        return not control.settings.has_cell
    return by_vector or bool(law.letters)


def switch(control: Control, *, on: bool) -> None:
    """Begin or end the control of the tip; the axes do not move."""
    state = control.state
    if state.point_control == on:
        return
    axes = control.axes()
    state.point_control = on
    control.stay_at(axes)
    say(control)


def say(control: Control) -> None:
    """The state event, with what the controlled point reads from now on."""
    state = control.state
    at = control.si_axes(control.tip(state.current))
    control.out.append(canon.PointControl(span=control.span, on=state.point_control, at=at))


def axes_at(control: Control, tip: Vector, law: ToolPointLaw) -> Vector:
    """Axes in program units with the tip at `tip`."""
    state = control.state
    return _program(control, law.axes(control.si_axes(tip), control.si_axes(state.tool_offset)), tip)


def tip_at(control: Control, axes: Vector, law: ToolPointLaw) -> Vector:
    """The tip in program units with the axes at `axes`."""
    state = control.state
    return _program(control, law.tip(control.si_axes(axes), control.si_axes(state.tool_offset)), axes)


def _program(control: Control, values: canon.Axes, rest: Vector) -> Vector:
    unit = control.state.unit
    x, y, z, a, b, c = values
    if control.settings.columns:
        found = [x / unit, y / unit, z / unit, a / DEG, b / DEG, c / DEG, *rest[6:]]
        for letter, column in control.settings.columns.items():
            found[AXES.index(letter)], found[3 + column] = values[3 + column] / unit, rest[3 + column]
        return tuple(found)  # type: ignore[return-value]
    return (x / unit, y / unit, z / unit, a / DEG, b / DEG, c / DEG, *rest[6:])

"""Fanuc's frames: work offset, external offset, preset, local shift and turn, each on its own.

    axes = turn(point - centre) + centre + G52 + G92 + G5x + external + G54.2 + tool offset

The turn is in the plane of its G68. About Z it fits the base class, which knows `R(point + g92) + origin`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from gcodesim import canon
from gcodesim.canon.systems import ADDITIONAL
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects.fanuc import FIXTURES
from gcodesim.rs274.dialects.systems import first_of_system
from gcodesim.rs274.fanuc import fixture
from gcodesim.rs274.fanuc import variables as numbers
from gcodesim.rs274.fanuc.variables import Variables
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import ZERO, ModalState, Vector, add, scaled, subtract
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.rs274.circles import Point
    from gcodesim.rs274.dialects import Dialect
    from gcodesim.rs274.fanuc.corner_circle import CornerCircle
    from gcodesim.rs274.fanuc.corners import Corner
    from gcodesim.rs274.fanuc.flow import FanucFrame
    from gcodesim.rs274.fanuc.polar import Polar
    from gcodesim.rs274.fanuc.tilted import Begun
    from gcodesim.rs274.settings import Settings
    from gcodesim.rs274.tilt import Tilt

_XY = (0, 1)


@dataclass(slots=True)
class FanucState(ModalState):
    """What Fanuc remembers besides."""

    preset: Vector = ZERO  # G92
    local: Vector = ZERO  # G52
    turn: float | None = None  # G68 [deg]
    turn_axes: tuple[int, int] = _XY  # the axes of the plane that is turned
    turn_centre: tuple[float, float] = (0.0, 0.0)  # on those axes
    fixture: int = 0  # G54.2 P
    tilt: Tilt | None = None  # G68.2
    plane_begun: Begun | None = None  # a G68.2 of several blocks
    upright: bool = False  # G53.1 has turned the tool upright to the plane
    mirror: tuple[float | None, float | None, float | None] = (None, None, None)  # G51.1
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)  # G51
    scale_centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    path_code: int = 640  # G61 to G64 as written
    length_mode: int = 490
    length_number: int = 0  # H
    radius_number: int = 0  # D
    before_cycle: int = 0  # the motion of group 1 that goes on after G80
    clear: float | None = None  # heights of the chain of cycles, in the work system
    bottom: float | None = None
    polar: Polar | None = None  # G16
    comp_starting: bool = False  # the held move starts the compensation
    comp_crossing: bool = False  # the next move lies on the other side
    comp_circle: CornerCircle | None = None  # a G39 that waits for the next move
    comp_idle: int = 0  # blocks since the last move in the plane
    comp_lost: str = ""  # why the next corner is not worked out
    comp_corners: tuple[tuple[Point, Point], ...] = ()  # the last corners, as programmed and as passed
    stroke: int = 220  # G22 or G23
    last_m: int = 0  # the last M code that is no call
    corner: Corner | None = None  # a move that waits for the next one


class FanucControl(Control):
    """The control with Fanuc's memory and frames."""

    state: FanucState
    parameters: Variables
    writing: bool = False  # between a G10 that writes data of the control and G11
    sequence: int = 0  # the last N before the block at hand
    via: Vector | None = None  # where the last G28 or G30 went through, of the axes, in program units

    def __init__(self, settings: Settings, dialect: Dialect) -> None:
        super().__init__(settings, dialect)
        self.in_increments = dialect.option("decimal_point", settings.options) == "increments"
        self.goes_round = dialect.option("compensation_start", settings.options) == "B"  # at its start, and at G40
        self.blocks_ahead = int(dialect.option("compensation_blocks", settings.options))
        from gcodesim.rs274.fanuc.compensation import FanucCorners

        self.corner_rule = FanucCorners(self)

    def situation(self) -> tuple[object, ...]:
        return (*super().situation(), self.sequence, self.via, self.writing)

    def _first_state(self) -> ModalState:
        return FanucState()

    def _memory(self) -> Variables:
        return Variables(self)

    @property
    def has_figure(self) -> bool:
        state = self.state
        turned = state.turn is not None or state.tilt is not None or state.fixture != 0 or state.polar is not None
        return turned or state.scale != (1.0, 1.0, 1.0) or state.mirror != (None, None, None) or super().has_figure

    def length_number(self) -> int | None:
        return self.state.length_number or None

    # -- frames

    def base(self) -> Vector:
        """Where the program's zero lies without G68; program units."""
        state = self.state
        shift = add(self.stored(numbers.EXTERNAL), self.system_offset(state.system)[0])
        if self.lean is not None:
            own = add(state.preset, state.local)
            return add(shift, (*self.leant(own[:3]), *own[3:]))
        return add(add(shift, state.preset), state.local)

    def stored(self, first: int) -> Vector:
        """Six stored numbers in program units."""
        get = self.parameters.numbers.get
        values = [self.program_units(get(first + axis, 0.0), axis) for axis in range(6)]
        return (*values, 0.0, 0.0, 0.0)  # type: ignore[return-value]

    def shift(self) -> Vector:
        return add(self.state.preset, self.state.local)

    def reframe(self, **changes: Any) -> None:
        """Change what frames depend on; the axes stay where they are."""
        stay = self.staying()
        state = self.state
        for name, value in changes.items():
            setattr(state, name, value)
        base = self.base()
        if state.turn is None:
            state.origin, state.rotation, state.g92 = base, 0.0, ZERO
        else:
            centre = list(ZERO)
            for axis, value in zip(state.turn_axes, state.turn_centre, strict=True):
                centre[axis] = value
            state.origin = add(base, (*self.leant((centre[0], centre[1], centre[2])), *ZERO[3:]))
            state.rotation = state.turn if state.turn_axes == _XY else 0.0
            state.g92 = subtract(ZERO, tuple(centre))  # type: ignore[arg-type]
        stay()
        self.say_system()

    def tip(self, point: Vector) -> Vector:
        return fixture.shifted(self, self._tip(point), 1.0)

    def _tip(self, point: Vector) -> Vector:
        state = self.state
        if state.tilt is not None:
            return add((*self.leant(state.tilt.point(point[:3])), *point[3:]), state.origin)
        if state.turn is None or state.turn_axes == _XY:
            return super().tip(point)
        turned = self._turned(add(point, state.g92), state.turn)
        return add((*self.leant(turned[:3]), *turned[3:]), state.origin)

    def point_of(self, tip: Vector) -> Vector:
        state = self.state
        tip = fixture.shifted(self, tip, -1.0)
        if state.tilt is None and (state.turn is None or state.turn_axes == _XY):
            return super().point_of(tip)
        point = self._unleant(subtract(tip, state.origin))
        if state.tilt is not None:
            return (*state.tilt.back(point[:3]), *point[3:])
        return subtract(self._turned(point, -(state.turn or 0.0)), state.g92)

    def unturned(self, tip: Vector) -> Vector:
        """What a tip reads in the work system without G68."""
        return self._unleant(subtract(fixture.shifted(self, tip, -1.0), self.base()))

    def _unleant(self, point: Vector) -> Vector:
        return point if (lean := self.lean) is None else (*lean.back(point[:3]), *point[3:])

    def normal(self, axis: int) -> canon.Point:
        if self.state.tilt is None:
            return super().normal(axis)
        along = [0.0, 0.0, 0.0]
        along[axis] = 1.0
        return self.leant(self.state.tilt.direction((along[0], along[1], along[2])))

    def _turned(self, point: Vector, degrees: float) -> Vector:
        """`point` turned in the plane of G68 about its zero."""
        (first, second), out = self.state.turn_axes, list(point)
        cos, sin = self._turn(degrees)
        out[first] = point[first] * cos - point[second] * sin
        out[second] = point[first] * sin + point[second] * cos
        return tuple(out)  # type: ignore[return-value]

    def system_offset(self, index: int) -> tuple[Vector, float]:
        return self.stored(first_of_system(index)), 0.0

    def use_system(self, index: int) -> None:
        self.reframe(system=index)

    def restore_systems(self) -> None:
        x, y, z, a, b, c = self.settings.start
        degrees = [self.machine_angle(v) for v in (a, b, c)]
        self.state.current = (x / MM, y / MM, z / MM, *degrees, 0.0, 0.0, 0.0)  # type: ignore[assignment]
        axes = self.state.current
        self.state.origin = self.base()
        self.stay_at(axes)

    @staticmethod
    def machine_angle(radians: float) -> float:
        from gcodesim.units import DEG

        return radians / DEG

    def change_unit(self, unit: float) -> None:
        state = self.state
        factor = state.unit / unit
        if factor != 1.0:
            state.preset, state.local = scaled(state.preset, factor), scaled(state.local, factor)
            state.tilt = None if state.tilt is None else state.tilt.scaled(factor)
            state.turn_centre = (state.turn_centre[0] * factor, state.turn_centre[1] * factor)
            state.mirror = tuple(None if v is None else v * factor for v in state.mirror)  # type: ignore[assignment]
            state.scale_centre = tuple(v * factor for v in state.scale_centre)  # type: ignore[assignment]
            state.clear = None if state.clear is None else state.clear * factor
            state.bottom = None if state.bottom is None else state.bottom * factor
            state.cycle_start *= factor
            if state.polar is not None:
                x, y = state.polar.centre
                state.polar = replace(state.polar, centre=(x * factor, y * factor), radius=state.polar.radius * factor)
        super().change_unit(unit)

    # -- tool data

    def tool_data(self, kind: int, number: int) -> float:
        """Length or radius [mm], geometry or wear, of offset `number`: as set, or from the tool table."""
        known = self.parameters.numbers.get(kind + number)
        if known is not None:
            return known
        entry = self.tools.get(number)
        if entry is None or kind in (numbers.LENGTH_WEAR, numbers.RADIUS_WEAR):
            return 0.0
        return (entry.offset[2] if kind == numbers.LENGTH_GEOMETRY else entry.diameter / 2.0) / MM

    # -- what programs may ask

    def remember_trip(self, point: Vector, *, tripped: bool) -> None:
        """Where the skip signal came, or the move ended: the axes in the work system, kept in mm."""
        place = subtract(self.axes_of(point), self.base())
        for axis in range(6):
            self.parameters.numbers[numbers.SKIPPED_AT + axis] = self.machine_units(place[axis], axis)

    def position_variable(self, number: int) -> float | None:
        """#5001 … block end, #5021 … machine, #5041 … present, #5061 … skip, #5081 … tool offset."""
        kind, axis = divmod(number - 5001, 20)
        if axis >= 6:
            return None
        if kind == 0:
            return self.unturned(self.tip(self.state.current))[axis]
        if kind == 2:  # as the control shows it: with the tool's length
            return self.unturned(self.axes())[axis]
        if kind == 1:
            return self.axes()[axis]
        if kind == 3:  # with the tool's length as well
            return self.program_units(self.parameters.numbers.get(number, 0.0), axis)
        if kind == 4:
            return self.state.tool_offset[axis]
        return 0.0

    def fixture_variable(self, place: int) -> float:
        """#5500, the P of G54.2 in force, and #5501 … #5506, its stored offset; program units."""
        number = self.state.fixture
        if not place:
            return float(number)
        return self.stored(FIXTURES[number - 1])[place - 1] if number else 0.0

    def mode_variable(self, number: int) -> float:
        """#4001 …: G codes by group, and the last D F H M N O P S T words.

        Raises `Fault` for groups of codes that are not simulated.
        """
        state = self.state
        motion = state.motion if state.motion != 800 else state.before_cycle
        frame: FanucFrame = self.frames[-1]  # type: ignore[assignment]
        known: dict[int, float] = {
            1: motion / 10.0 if motion <= 30 else state.before_cycle / 10.0,
            2: state.plane / 10.0,
            3: 91.0 if state.incremental else 90.0,
            4: state.stroke / 10.0,
            5: state.feed_mode / 10.0,
            6: 21.0 if state.unit == MM else 20.0,
            7: {0: 40.0, 1: 41.0, -1: 42.0}[state.side],
            8: state.length_mode / 10.0,
            9: motion / 10.0 if motion >= 730 else 80.0,
            10: state.retract / 10.0,
            11: 50.0 if state.scale == (1.0, 1.0, 1.0) else 51.0,
            12: 66.0 if frame.calls else 67.0,
            13: 96.0 if state.surface_speed else 97.0,
            14: 53.0 + state.system if state.system <= 6 else 54.1,
            15: state.path_code / 10.0,
            16: 68.2 if state.tilt is not None else 69.0 if state.turn is None else 68.0,
            17: 15.0 if state.polar is None else 16.0,
            22: 50.1 if state.mirror == (None, None, None) else 51.1,
            107: float(state.radius_number),
            109: state.feed * state.feed_unit / state.unit,
            111: float(state.length_number),
            113: float(state.last_m),
            114: float(self.sequence),
            115: float(frame.part.number or 0),
            119: state.speed,
            120: float(max(state.selected, 0)),
            130: float(max(state.system - ADDITIONAL, 0)),
        }
        if number - 4000 not in known:
            hint = "known are groups 1 to 17 and 22, and #4107, #4109, #4111, #4113 to #4115, #4119, #4120, #4130"
            raise Fault("GS121", f"what #{number} tells is not simulated", hint=hint)
        return known[number - 4000]


__all__ = ["FanucControl", "FanucState"]

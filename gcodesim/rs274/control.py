"""The control: executes block after block and says what the machine is told to do.

A block is checked before anything changes; if a fault shows only half-way,
the run restores the state (`Control.begin`, `Control.roll_back`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Literal

from gcodesim import canon
from gcodesim.arithmetic.scalars import cos_sin
from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.rs274 import parameters as numbers
from gcodesim.rs274 import tool_point
from gcodesim.rs274.block import ColumnRange
from gcodesim.rs274.dialects import Dialect
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.frame import Frame
from gcodesim.rs274.parameters import Parameters
from gcodesim.rs274.settings import Settings
from gcodesim.rs274.state import AXES, LINEAR, ModalState, Vector, add, scaled, subtract
from gcodesim.rs274.tilt import Tilt
from gcodesim.rs274.tool_table import ToolEntry
from gcodesim.units import DEG, MINUTE, MM, RPM

if TYPE_CHECKING:
    from gcodesim.rs274.compensation import CornerRule
    from gcodesim.rs274.words import Words

_SAME_LENGTH = 1e-9  # [m]
_PATH_MODES: dict[int, str] = {610: "exact_path", 611: "exact_stop", 640: "blend"}


def _no_contour(number: int) -> Iterable[Words]:
    raise Fault("GS106", f"there is no subroutine O{number}", at="q")


class Control:
    """State, memory and tool table of a control, and the events of the current block (`out`)."""

    state: ModalState
    span: Span
    sub_level: int
    returned: float
    value_returned: bool

    def __init__(self, settings: Settings, dialect: Dialect) -> None:
        self.settings = settings
        self.dialect = dialect
        self.state = self._first_state()
        self.state.motion = dialect.first_motion
        self.parameters = self._memory()
        self.parameters.numbers.update(settings.parameters)
        self.tools: dict[int, ToolEntry] = dict(settings.tool_table.entries)
        self.spindle_tool: ToolEntry = ToolEntry(number=0)
        self.out: list[canon.Event] = []
        self.notes: list[Diagnostic] = []
        self.span = Span("")
        self.block_number = 0
        self.last_system: canon.WorkSystem | None = None
        self.not_simulated: dict[str, tuple[int, Span]] = {}
        self.contours: Callable[[int], Iterable[Words]] = _no_contour  # the blocks of subroutine O…, for G70 to G72
        self.corner_rule: CornerRule | None = None  # of cutter compensation; None for RS274's
        self.auto_length = False  # M6 also applies the length: nothing in the program is about lengths
        self.length_cancelled = False  # G49 is all that the program says about them
        self.sub_level = 0
        self.finished = False
        self.frames: list[Frame] = []
        self.returned = 0.0
        self.value_returned = False
        self.restore_systems()

    def _first_state(self) -> ModalState:
        return ModalState()

    def _memory(self) -> Parameters:
        return Parameters(self._read_only, self._predefined)

    def fresh(self) -> Control:
        """Another one of the kind, as before the first block."""
        return type(self)(self.settings, self.dialect)

    def situation(self) -> tuple[object, ...]:
        """All that it knows besides parameters, as a copy."""
        said = (self.returned, self.value_returned, self.spindle_tool)
        return (self.state.copy(), said, dict(self.tools))

    @property
    def has_figure(self) -> bool:
        """Whether a figure of the control (`Dialect.figures`) turns, tilts, scales or mirrors what the program says."""
        return self.lean is not None

    # -- frames

    def tip(self, point: Vector) -> Vector:
        """The controlled point in the machine frame of a point in the active work system; program units."""
        state = self.state
        x, y, z, a, b, c, u, v, w = map(float.__add__, point, state.g92)
        if state.rotation:
            cos, sin = self._turn(state.rotation)
            x, y = x * cos - y * sin, x * sin + y * cos
        if (lean := self.lean) is not None:
            x, y, z = lean.direction((x, y, z))
        o = state.origin
        return (x + o[0], y + o[1], z + o[2], a + o[3], b + o[4], c + o[5], u + o[6], v + o[7], w + o[8])

    def point_of(self, tip: Vector) -> Vector:
        """The inverse of `tip`."""
        state = self.state
        x, y, z, *rest = subtract(tip, state.origin)
        if (lean := self.lean) is not None:
            x, y, z = lean.back((x, y, z))
        if state.rotation:
            cos, sin = self._turn(state.rotation)
            x, y = x * cos + y * sin, y * cos - x * sin
        return subtract((x, y, z, *rest), state.g92)  # type: ignore[arg-type]

    @property
    def lean(self) -> Tilt | None:
        """How the axes of the active work system lie in the machine, where they are not just turned about Z."""
        return self.settings.leans.get(self.state.system)

    def leant(self, v: canon.Point) -> canon.Point:
        """A direction or way along axes of the active work system, without its turn about Z, in the machine frame."""
        return v if (lean := self.lean) is None else lean.direction(v)

    def normal(self, axis: int) -> canon.Point:
        """The direction of X, Y or Z of the active work system, in the machine frame."""
        along = [0.0, 0.0, 0.0]
        along[axis] = 1.0
        if self.state.rotation and axis != 2:
            cos, sin = self._turn(self.state.rotation)
            along = [along[0] * cos - along[1] * sin, along[0] * sin + along[1] * cos, along[2]]
        return self.leant((along[0], along[1], along[2]))

    @staticmethod
    def _turn(degrees: float) -> tuple[float, float]:
        return cos_sin(math.radians(degrees))

    def axes(self) -> Vector:
        """Where the machine's axes stand, in program units."""
        return self.axes_of(self.state.current)

    def axes_of(self, point: Vector) -> Vector:
        """The machine's axes where the tool stands at `point` of the active work system; program units."""
        tip = self.tip(point)
        law = self.settings.tool_point
        if self.state.point_control and law is not None:
            return tool_point.axes_at(self, tip, law)
        return add(tip, self.length)

    @property
    def length(self) -> Vector:
        """The length offset in force, from the tip to the axes; an arm turns the tool with a system that leans."""
        offset = self.state.tool_offset
        if not self.settings.length_leans or self.lean is None:
            return offset
        return (*self.leant(offset[:3]), *offset[3:])

    def length_number(self) -> int | None:
        """The H that brings the length offset in force: that of the tool in the spindle if it does; None: none."""
        wanted = self.state.tool_offset
        near = _SAME_LENGTH / self.state.unit
        known = [n for n, entry in self.tools.items() if math.dist(self.from_si(entry.offset), wanted) < near]
        return self.state.tool if self.state.tool in known else known[0] if known else None

    def stay_at(self, axes: Vector) -> None:
        """After a change of frames: the axes did not move, so the current point reads differently."""
        law = self.settings.tool_point
        if self.state.point_control and law is not None:
            self.state.current = self.point_of(tool_point.tip_at(self, axes, law))
        else:
            self.state.current = self.point_of(subtract(axes, self.length))

    def staying(self) -> Callable[[], None]:
        """What to call after a change of the work system, so that nothing has moved.

        Where the tool leans along with the system, that is the tip: an arm turns the tool only when it moves.
        """
        if self.settings.length_leans:
            tip = self.tip(self.state.current)
            return lambda: setattr(self.state, "current", self.point_of(tip))
        axes = self.axes()
        return lambda: self.stay_at(axes)

    def si_axes(self, tip: Vector) -> canon.Axes:
        """X to C of `tip` in SI; U, V, W that move something take the place of one of A, B, C."""
        unit = self.state.unit
        if self.settings.columns:
            words = [tip[3] * DEG, tip[4] * DEG, tip[5] * DEG]
            for letter, column in self.settings.columns.items():
                words[column] = tip[AXES.index(letter)] * unit
            return (tip[0] * unit, tip[1] * unit, tip[2] * unit, words[0], words[1], words[2])
        return (tip[0] * unit, tip[1] * unit, tip[2] * unit, tip[3] * DEG, tip[4] * DEG, tip[5] * DEG)

    def check_letters(self, words: Words) -> None:
        """A fault where the block has one of A, B, C whose place is taken by U, V or W."""
        for column in self.settings.columns.values():
            letter = "abc"[column]
            if letter in words.values:
                moved = ", ".join(sorted(name.upper() for name in self.settings.columns))
                raise Fault(
                    "GS207",
                    f"the program moves {letter.upper()}, which this machine does not have",
                    at=letter,
                    hint=f"its external axes are {moved}",
                )

    def si_point(self, point: Vector) -> canon.Point:
        """X, Y, Z of a point in the active work system, in the machine frame and SI."""
        tip = self.tip(point)
        unit = self.state.unit
        return (tip[0] * unit, tip[1] * unit, tip[2] * unit)

    def remember_trip(self, point: Vector, *, tripped: bool) -> None:
        """Keep where a probe tripped, in the active work system and program units."""
        for axis in range(9):
            self.parameters.numbers[numbers.PROBE + axis] = point[axis]
        self.parameters.numbers[numbers.PROBE_RESULT] = float(tripped)

    def machine_units(self, value: float, axis: int) -> float:
        """A value of `axis` in program units as the parameters hold it: mm or degrees."""
        return value * self.state.unit / MM if LINEAR[axis] else value

    def program_units(self, value: float, axis: int) -> float:
        """A value of a parameter in program units."""
        return value * MM / self.state.unit if LINEAR[axis] else value

    def from_si(self, offset: Vector) -> Vector:
        """A vector of a tool table in program units and degrees."""
        unit = self.state.unit
        x, y, z, a, b, c, u, v, w = offset
        return (x / unit, y / unit, z / unit, a / DEG, b / DEG, c / DEG, u / unit, v / unit, w / unit)

    # -- work systems

    def system_offset(self, index: int) -> tuple[Vector, float]:
        """Offset and rotation [deg] of system 1 to 9 as stored."""
        first = numbers.FIRST_SYSTEM + 20 * (index - 1)
        get = self.parameters.get
        offset = tuple(self.program_units(get(first + axis), axis) for axis in range(9))
        return offset, get(first + 9)  # type: ignore[return-value]

    def use_system(self, index: int) -> None:
        """Make system `index` the active one; the axes stay."""
        stay = self.staying()
        state = self.state
        state.system = index
        state.origin, state.rotation = self.system_offset(index)
        self.parameters.set(numbers.ACTIVE_SYSTEM, float(index))
        stay()
        self.say_system()

    def say_system(self) -> None:
        """The state event of the work system, when it changed."""
        state = self.state
        event = canon.WorkSystem(
            span=self.span,
            index=state.system,
            offset=self.si_axes(state.origin),
            g92=self.si_axes(state.g92),
            rotation=state.rotation * DEG,
            axes=None if (lean := self.lean) is None else lean.rows,
        )
        last = self.last_system
        new = (event.index, event.offset, event.g92, event.rotation)
        if last is None or new != (last.index, last.offset, last.g92, last.rotation):
            self.last_system = event
            self.out.append(event)

    @property
    def _start_axes(self) -> Vector:
        """Where the machine's axes stand before the first block, in mm and degrees."""
        x, y, z, a, b, c = self.settings.start
        values = [x / MM, y / MM, z / MM, a / DEG, b / DEG, c / DEG, 0.0, 0.0, 0.0]
        for letter, column in self.settings.columns.items():
            values[AXES.index(letter)], values[3 + column] = (a, b, c)[column] / MM, 0.0
        axes: Vector = tuple(values)  # type: ignore[assignment]
        return axes

    def at_home(self) -> Vector:
        """The point of the active work system at which the tool stands once the joints are where they began."""
        axes: Vector = tuple(self.program_units(at, axis) for axis, at in enumerate(self._start_axes))  # type: ignore[assignment]
        return self.point_of(subtract(axes, self.length))

    def restore_systems(self) -> None:
        """Put the offsets of a parameter file in force from the start."""
        get = self.parameters.get
        index = round(get(numbers.ACTIVE_SYSTEM))
        state = self.state
        axes = self._start_axes
        state.system = index if 1 <= index <= 9 else 1
        self.parameters.numbers[numbers.ACTIVE_SYSTEM] = float(state.system)
        state.origin, state.rotation = self.system_offset(state.system)
        if get(numbers.G92_ON):
            state.g92 = self.stored_g92()
        known = self.settings.tool_point is not None
        state.point_control = self.settings.tip_first and known and bool(self.dialect.tip_m_codes)
        self.stay_at(axes)

    def stored_g92(self) -> Vector:
        get = self.parameters.get
        return tuple(self.program_units(get(numbers.G92_OFFSET + axis), axis) for axis in range(9))  # type: ignore[return-value]

    # -- what programs may ask for

    def _read_only(self, number: int) -> float:
        state = self.state
        if number >= numbers.POSITION:
            if state.side:
                message = f"#{number} cannot be read while cutter compensation is on"
                raise Fault("GS150", message, hint="say G40 first, or read #<_x>")
            return state.current[number - numbers.POSITION]
        tool = self.spindle_tool
        if number == numbers.TOOL:
            return float(state.tool)
        if number <= 5409:  # of the tool in the spindle, whatever G43 says
            axis = number - 5401
            return tool.offset[axis] / (MM if LINEAR[axis] else DEG)
        values = (tool.diameter / MM, tool.front_angle / DEG, tool.back_angle / DEG, float(tool.orientation))
        return values[number - 5410]

    def _predefined(self, name: str) -> float | None:
        from gcodesim.rs274.predefined import PREDEFINED

        ask: Callable[[Control], float] | None = PREDEFINED.get(name)
        return None if ask is None else ask(self)

    # -- events

    def feed(self, linear: bool) -> tuple[float, canon.FeedUnit]:
        """The feed in force for a move that is linear or of rotary axes only."""
        state = self.state
        size = state.feed * (state.feed_unit if linear else DEG)
        if state.feed_mode == 950:
            return size, "m/rev" if linear else "rad/rev"
        return size / MINUTE, "m/s" if linear else "rad/s"

    def rapid(self, end: Vector, word: str = "G0") -> None:
        self.out.append(
            canon.Rapid(span=self.span, end=self.si_axes(self.tip(end)), block=self.block_number, word=word)
        )
        self.state.current = end

    def line(self, end: Vector, word: str = "G1", pitch: float | None = None) -> None:
        """A straight feed; `pitch` [m/rev] makes it a thread."""
        feed, unit = (0.0, "m/s") if pitch is not None else self.feed(self.moves_linear(end))
        self.out.append(
            canon.LinearFeed(
                span=self.span,
                end=self.si_axes(self.tip(end)),
                block=self.block_number,
                word=word,
                feed=feed,
                feed_unit=unit,  # type: ignore[arg-type]
                pitch=pitch,
            )
        )
        self.state.current = end

    def moves_linear(self, end: Vector) -> bool:
        """Whether a move to `end` moves X, Y or Z; one that moves nothing counts as linear."""
        state = self.state
        if state.strayed is not None:
            goal, here = self.si_axes(self.tip(end)), state.strayed[1]
            return goal[:3] != here[:3] or goal[3:6] == here[3:6]
        now = state.comp_emitted if state.comp_leaving else state.current
        return end[:3] != now[:3] or end[3:6] == now[3:6]

    def dwell(self, seconds: float) -> None:
        if seconds < 0.0:
            self.warn("GS106", f"the dwell is negative: {seconds:g} s; the program goes on at once")
            return
        self.out.append(canon.Dwell(span=self.span, seconds=seconds))

    def say_spindle(self) -> None:
        state = self.state
        if not state.spindle:
            self.out.append(canon.Spindle(span=self.span, direction="off", speed=0.0))
            return
        direction: Literal["cw", "ccw"] = "cw" if state.spindle > 0 else "ccw"
        if state.surface_speed:
            # S is m/min under G21 and ft/min under G20, as it was when S was written
            speed = state.speed * (1.0 if state.speed_unit == MM else 0.3048) / MINUTE
            cap = None if state.surface_speed_cap is None else state.surface_speed_cap * RPM
            self.out.append(canon.Spindle(span=self.span, direction=direction, speed=speed, unit="m/s", max_speed=cap))
        else:
            self.out.append(canon.Spindle(span=self.span, direction=direction, speed=state.speed * RPM))

    def say_coolant(self) -> None:
        self.out.append(canon.Coolant(span=self.span, flood=self.state.flood, mist=self.state.mist))

    def say_path(self, mode: int | None = None) -> None:
        self.out.append(self.path_mode(mode))

    def path_mode(self, mode: int | None = None) -> canon.PathMode:
        """The event of path mode `mode` (610, 611, 640), or of the one in force."""
        state = self.state
        mode = mode or state.path
        blend = mode == 640
        return canon.PathMode(
            span=self.span,
            mode=_PATH_MODES[mode],  # type: ignore[arg-type]
            tolerance=state.path_tolerance if blend else 0.0,
            naive=state.path_naive if blend else 0.0,
        )

    def say_overrides(self, **changes: bool) -> None:
        """Say that some of the switches `feed`, `speed`, `adaptive`, `hold` change; the machine keeps the others.

        A cycle may leave a switch otherwise than M48 to M53 set it, so the machine's are remembered by themselves.
        """
        state = self.state
        state.switches = {**state.switches, **changes}
        self.out.append(canon.Override(span=self.span, **state.switches))

    def say_tool_offset(self) -> None:
        self.out.append(canon.ToolOffset(span=self.span, offset=self.si_axes(self.state.tool_offset)))
        if self.state.point_control:
            tool_point.say(self)

    def shift(self) -> Vector:
        """What G92 and G52 add, in program units."""
        return self.state.g92

    def skip(self, word: str, place: ColumnRange | None = None) -> None:
        """Count a word that is read but not simulated; it is at `place` in the line."""
        count, first = self.not_simulated.get(word, (0, None))
        self.not_simulated[word] = (count + 1, first or self._span_of(place))

    def _span_of(self, place: ColumnRange | None) -> Span:
        """A place in the current line; the whole line if it is None."""
        span = self.span
        if place is None:
            return span
        return Span(span.file, span.line, place[0] + 1, span.line, place[1] + 1, span.callers)

    def warn(self, code: str, message: str, hint: str = "", place: ColumnRange | None = None) -> None:
        """A finding that does not stop the block, about `place` in its line or all of it."""
        span = self._span_of(place)
        self.notes.append(Diagnostic(code=code, message=message, span=span, hint=hint, severity=Severity.WARNING))

    def change_unit(self, unit: float) -> None:
        """G20 or G21: everything that is kept in program units is converted; nothing moves."""
        state = self.state
        if unit == state.unit:
            return
        factor = state.unit / unit
        state.unit = unit
        state.current = scaled(state.current, factor)
        state.origin = scaled(state.origin, factor)
        state.g92 = scaled(state.g92, factor)
        state.tool_offset = scaled(state.tool_offset, factor)
        state.comp_programmed = scaled(state.comp_programmed, factor)
        state.comp_radius *= factor

    def tool_entry(self, number: int, at: str) -> ToolEntry:
        """The entry of tool `number`; a fault when the table has none."""
        entry = self.tools.get(number)
        if entry is None:
            raise Fault(
                "GS160",
                f"tool T{number} is not in the tool table",
                at=at,
                hint=f"add it {'under `tools` of the cell' if self.settings.has_cell else 'to the tool table'}; "
                f"known are {_listed(self.tools)}"
                if self.tools
                else "no tool is known; name a cell or a tool table",
            )
        return entry


def _listed(tools: dict[int, ToolEntry]) -> str:
    names = [f"T{number}" for number in sorted(tools)]
    return ", ".join(names[:12]) + (", …" if len(names) > 12 else "")


def axis_index(letter: str) -> int:
    """0 to 8 for X to W."""
    return AXES.index(letter)


__all__ = ["Control", "axis_index"]

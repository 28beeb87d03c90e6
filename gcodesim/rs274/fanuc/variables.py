"""Variables of custom macros: #1–#33 of the running macro, common ones, and system variables.

Stored positions and offsets are kept in mm, whatever the program's unit; a
program reads and writes them in its own.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from gcodesim.rs274.dialects.fanuc import FAR_SYSTEMS, FIXTURES, NEAR_SYSTEMS
from gcodesim.rs274.dialects.systems import APART
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.parameters import FIRST_SYSTEM, Parameters

if TYPE_CHECKING:
    from gcodesim.rs274.fanuc.control import FanucControl

LOCALS: Final = range(1, 34)
EXTERNAL: Final = 5201  # external work offset, six axes
FIRST_OF_ALL: Final = 14001  # G54.1 P1 to P300 once more, where a control has so many
LENGTH_WEAR, LENGTH_GEOMETRY, RADIUS_WEAR, RADIUS_GEOMETRY = 10000, 11000, 12000, 13000
MOST_OFFSETS: Final = 999
ALARM, STOP = 3000, 3006
FIXTURE: Final = 5500  # the P of G54.2, and from the next on its offset
SKIPPED_AT: Final = 5061  # where the last G31 ended, six axes

_COMMON: Final = (range(100, 200), range(500, 1000))
_OFFSETS: Final = (
    range(EXTERNAL, EXTERNAL + 6),
    *(range(FIRST_SYSTEM + 20 * n, FIRST_SYSTEM + 20 * n + 6) for n in range(6)),
    *(range(block.first, block.first + APART * len(block.systems)) for block in (NEAR_SYSTEMS, FAR_SYSTEMS)),
    range(FIXTURES.start, FIXTURES.stop),
)
_TOOL_OFFSETS: Final = tuple(range(first + 1, first + 1 + MOST_OFFSETS) for first in (10000, 11000, 12000, 13000))
_SIGNALS: Final = (range(1000, 1036), range(1100, 1136))
_CLOCKS: Final = (*range(3001, 3006), 3011, 3012, 3901, 3902, 3007)
_MODES: Final = (*range(4001, 4031), *range(4101, 4131))
_POSITIONS: Final = range(5001, 5109)


def _no_name(name: str) -> float | None:
    return None


class Variables(Parameters):
    """The control's memory. `read` gives None for a vacant variable; `local` belongs to the running macro."""

    def __init__(self, control: FanucControl) -> None:
        super().__init__(self._read_or_zero, _no_name)
        self._control = control
        self.local: dict[int, float] = {}

    def _read_or_zero(self, number: int) -> float:
        return self.read(number) or 0.0

    def index(self, value: float) -> int:
        number = round(value)
        if abs(value - number) > 1e-4:
            raise Fault("GS121", f"#{value:g} is no variable: the number must be whole")
        if not self._known(number):
            raise Fault("GS121", f"#{number} is no variable of this control", hint="#1–#33, #100–#199, #500–#999")
        return number

    @staticmethod
    def _known(number: int) -> bool:
        return (
            0 <= number <= 33
            or any(number in part for part in (*_COMMON, *_OFFSETS, *_TOOL_OFFSETS, *_SIGNALS, _MODES, _POSITIONS))
            or 2001 <= number <= 2400
            or FIRST_OF_ALL <= number < FAR_SYSTEMS.first
            or number in _CLOCKS
            or number in (ALARM, STOP)
            or FIXTURE <= number <= FIXTURE + 6
        )

    def read(self, number: int) -> float | None:
        """The value of #number in program units."""
        if number in LOCALS:
            return self.local.get(number)
        if number == 0 or any(number in part for part in _COMMON):
            return self.numbers.get(number) if number else None
        number = _where_kept(number)
        control = self._control
        for part in _OFFSETS:
            if number in part:
                return control.program_units(self.numbers.get(number, 0.0), _axis(number, part))
        for part in _TOOL_OFFSETS:
            if number in part:
                return control.program_units(control.tool_data(part.start - 1, number - part.start + 1), 2)
        if number in _POSITIONS:
            return control.position_variable(number)
        if number in _MODES:
            return control.mode_variable(number)
        if FIXTURE <= number <= FIXTURE + 6:
            return control.fixture_variable(number - FIXTURE)
        if number == 3007:
            return float(sum(2**axis for axis in range(3) if control.state.mirror[axis] is not None))
        return self.numbers.get(number, 0.0)

    def preset(self, parameter: int | str, value: float) -> None:
        if isinstance(parameter, str):
            raise Fault("GS121", f"#<{parameter}> is no variable of this control", hint="#1–#33, #100–#199, #500–#999")
        self.write(self.index(float(parameter)), value)

    def everything(self) -> dict[object, float]:
        return {number: value for store in (self.numbers, self.local) for number, value in store.items()}

    def kept(self) -> Iterable[int]:
        """#500–#999 and all offsets."""
        kept = (range(500, 1000), *_OFFSETS, *_TOOL_OFFSETS)
        return [number for number in self.numbers if any(number in part for part in kept)]

    def get(self, number: int) -> float:
        """As other files of the package read: #1–#33 of the running macro, everything else as stored."""
        if number in LOCALS:
            return self.local.get(number, 0.0)
        return self.numbers.get(number, 0.0)

    def write(self, number: int, value: float | None) -> None:
        """`#number=value` in a program."""
        of_fixture = FIXTURE <= number <= FIXTURE + 6
        if number == 0 or number in _POSITIONS or number in _MODES or number == 3007 or of_fixture:
            raise Fault("GS122", f"#{number} cannot be set")
        store = self.local if number in LOCALS else self.numbers
        number = _where_kept(number)
        control = self._control
        kept = value
        if kept is not None:
            for part in _OFFSETS:
                if number in part:
                    kept = control.machine_units(kept, _axis(number, part))
            if any(number in part for part in _TOOL_OFFSETS):
                kept = control.machine_units(kept, 2)
        self.undo.append((store, number, store.get(number)))
        if kept is None:
            store.pop(number, None)
        else:
            store[number] = kept
        if any(number in part for part in _OFFSETS):
            control.reframe()


def _axis(number: int, part: range) -> int:
    """The axis whose offset #number is; a machine with more than six has rotary ones there."""
    return min((number - part.start) % 20, 5)


def _where_kept(number: int) -> int:
    """The number under which a value is kept that has two.

    #2001–#2400 are the first 100 of each kind of tool offset in the larger memory, #14001–#14960 G54.1 P1 to P48.
    """
    if FIRST_OF_ALL <= number < FAR_SYSTEMS.first:
        return NEAR_SYSTEMS.first + number - FIRST_OF_ALL
    if 2001 <= number <= 2400:
        kind, tool = divmod(number - 2001, 100)
        first = (LENGTH_WEAR, LENGTH_GEOMETRY, RADIUS_WEAR, RADIUS_GEOMETRY)[kind]
        return first + tool + 1
    return number

"""The door to the compiled lane of a printer's program: thousands of moves come as one batch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, cast

import numpy as np
from numpy.typing import NDArray

from gcodesim import canon
from gcodesim.canon.batch import LINE, MoveBatch
from gcodesim.compiled import Kernel
from gcodesim.compiled.arguments import Argument, name_of
from gcodesim.compiled.object_code import is_kept
from gcodesim.diagnostics import Span
from gcodesim.rs274.marlin import lane_kernels as at
from gcodesim.rs274.marlin.comments import take_comment
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.units import MINUTE, MM

if TYPE_CHECKING:
    from gcodesim.rs274.marlin.executor import PrinterExecutor

Array = NDArray[np.float64]

MOST_ROWS: Final = 1 << 15
"""Rows of a batch; so much memory is in use at a time however long the program is."""

_WORTH_A_BATCH: Final = 12  # moves; fewer are looked at faster one by one
_REALS, _WHOLE = Argument("f8", 1), Argument("i8", 1)
_TAKES: Final = (
    Argument("u1", 1, readonly=True),
    _WHOLE,
    Argument(parts=(_REALS, _WHOLE), named=name_of(at.PrintState) or ""),
    Argument(parts=(Argument("f8", 2), Argument("i4", 2)), named=name_of(at.PrintRows) or ""),
    Argument("i8"),
    Argument("i8"),
)
"""What `read_lines` is called with."""


def is_ready() -> bool:
    """Whether the lane can be opened without compiling it."""
    return is_kept(cast(Kernel, at.read_lines), _TAKES)


class PrinterLane:
    """Carries out the lines that the kernels know."""

    def __init__(self, do: PrinterExecutor) -> None:
        self._do = do
        self.worth_a_batch = 1 if do.run.settings.lane == "compiled" else _WORTH_A_BATCH
        self._text = do.run.source.table
        self._state = at.PrintState(np.zeros(at.NUMBERS), np.zeros(at.MODES, dtype=np.int64))
        self._rows = at.PrintRows(np.empty((MOST_ROWS, at.VALUES)), np.empty((MOST_ROWS, at.FACTS), dtype=np.int32))

    def is_open(self) -> bool:
        """Whether the line at hand may be tried: a turned work system is left to the other lane, as is homing first."""
        return not self._do.control.state.rotation and not self._do.homes_first

    def run(self, block: int, most: int) -> tuple[int, MoveBatch | None, tuple[ProgramFile, int]]:
        """Carry out at most `most` lines from the one at hand on, as far as the kernels know them.

        `block` is the number of the first one. Returns how many, the moves, and file and index of the last line.
        """
        do, frame = self._do, self._do.flow.frame
        state, printer = do.control.state, do.printer
        numbers, modes = self._state
        numbers[:] = (*state.current[:3], printer.e, printer.feed)
        modes[:] = (state.incremental, printer.e_relative, 0, 0)
        first = frame.at
        done = at.read_lines(self._text.data, self._text.starts, self._state, self._rows, first, most)
        if done == 0:
            return 0, None, (frame.file, first)
        frame.at = first + done
        batch = self._batch(block - first) if modes[at.ROWS] else None
        x, y, z, printer.e, printer.feed = numbers.tolist()
        state.current = (x, y, z, *state.current[3:])
        return done, batch, (frame.file, first + done - 1)

    def _batch(self, blocks_before: int) -> MoveBatch | None:
        """The rows of the last call; None if they say nothing."""
        do = self._do
        count = int(self._state.modes[at.ROWS])
        values, facts = self._rows.values[:count], self._rows.facts[:count]
        moving = facts[:, at.KIND] < at.FILAMENT
        between = tuple(self._between(moving))
        values, facts = values[moving], facts[moving]
        if not len(values) and not between:
            return None
        state, printer = do.control.state, do.printer
        shift, origin, unit = np.array(state.g92), np.array(state.origin), state.unit
        end = np.zeros((len(values), 6))
        end[:, :3] = ((values[:, :3] + shift[:3]) + origin[:3]) * unit
        end[:, 3:] = do.control.si_axes(do.control.tip(state.current))[3:]
        kinds = facts[:, at.KIND].copy()
        return MoveBatch(
            origins=((do.file.name, ()),),
            kind=np.full(len(values), LINE, dtype=np.int32),
            word=kinds,
            end=end,
            feed=values[:, 3] * printer.pace * unit / MINUTE,
            rotary=np.zeros(len(values), dtype=bool),
            per_revolution=False,
            place=facts[:, at.LINE : at.END_COLUMN + 1] + np.array([1, 0, 0], dtype=np.int32),
            origin=np.zeros(len(values), dtype=np.int32),
            block=facts[:, at.LINE] + np.int32(blocks_before),
            shapes=np.zeros((0, 8)),
            acts=np.zeros((0, 2), dtype=np.int32),
            path=do.control.path_mode(),
            dwell=0.0,
            extrude=self._filament(values[:, 4]),
            between=between,
        )

    def _filament(self, step: Array) -> Array:
        """`Printer.filament` of many steps (n,)."""
        printer = self._do.printer
        area = printer.areas.get(printer.tool, 0.0)
        length = step / area * MM if area > 0.0 else step * self._do.control.state.unit
        return length * printer.flow.get(printer.tool, 1.0)

    def _between(self, moving: NDArray[np.bool_]) -> list[tuple[int, canon.Event]]:
        """Sections that begin, and filament alone, each before a move (by its number)."""
        do, found = self._do, []
        printer, unit = do.printer, do.control.state.unit
        before: NDArray[np.int64] = np.cumsum(moving) - moving
        for row in np.flatnonzero(~moving).tolist():
            kind, line, column, end_column = self._rows.facts[row].tolist()
            span = Span(do.file.name, line + 1, column, line + 1, end_column)
            if kind == at.FILAMENT:
                feed, step = self._rows.values[row, 3:].tolist()
                length = printer.filament(step, unit)
                if length:
                    speed = feed * printer.pace * unit / MINUTE
                    event: canon.Event = canon.Extrude(span=span, length=length, feed=speed, limits=printer.limits)
                    found.append((int(before[row]), event))
            elif take_comment(do.file.lines[line].partition(";")[2], printer):
                found.append((int(before[row]), canon.SectionStart(span=span, section=printer.section)))
        return found

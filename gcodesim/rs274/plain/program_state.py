"""What parameters and O-words of a program have become, into the tables of the kernels and back.

Both lanes keep their own form. It goes over only when something has changed: counters of the grammar's lane tell,
and marks that the kernels set.
"""

from __future__ import annotations

import numpy as np

from gcodesim.diagnostics.finding import Caller
from gcodesim.diagnostics.span_table import Origin
from gcodesim.rs274.control import Control
from gcodesim.rs274.flow import FlowControl
from gcodesim.rs274.frame import Frame, Label
from gcodesim.rs274.parameters import DEBUG_ON
from gcodesim.rs274.plain import layout_kernels as at
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.program_text import KINDS, FlowTable, ProgramText
from gcodesim.rs274.predefined import PREDEFINED
from gcodesim.rs274.program_file import ProgramFile

_HASH_BITS = 0xFFFFFF
_MOST_NAMES_USED = at.MOST_NAMES - at.MOST_NAMES // 4
_MOST_CHAINS_USED = at.MOST_CHAINS // 2
_KINDS = {f"_{letter}": at.POSITION_NAME + axis for axis, letter in enumerate("xyzabc")} | {
    "_feed": at.FEED_NAME,
    "_value": at.VALUE_NAME,
    "_value_returned": at.VALUE_RETURNED_NAME,
    "_call_level": at.CALL_LEVEL_NAME,
}
_NUMBER_OF = {word: number for number, word in KINDS.items()}


class ProgramState:
    """Text, memory and tables of one run. `is_full` when a table has no room: then the kernels cannot go on."""

    def __init__(self, control: Control, flow: FlowControl, modes: Column, numbers: Column) -> None:
        self.text = ProgramText(flow.frames[0].file)
        self.is_full = False
        self._control, self._flow = control, flow
        self._modes, self._numbers = modes, numbers
        self.memory = np.zeros(at.MEMORY)
        self.tables = np.zeros(at.FLOW_ROWS, dtype=np.int64)
        self._rows: Column = self.tables[at.FLOW_ROWS :].reshape(0, at.FLOW)
        self._flows = FlowTable()
        self._names: dict[str, int] = {}
        self._chains: dict[Origin, int] = {}
        self._origins: dict[int, Origin] = {}
        self._seen = (-1, -1)
        self._subs_seen = (0, 0)
        modes[at.FLOWS] = -1 if control.dialect.flow_words else 0
        modes[at.IS_EXTENDED] = control.dialect.named_parameters
        modes[at.EPOCH] = 1
        for name in PREDEFINED:
            self.tables[at.NAMES + at.A_NAME * self._name(name) + 2] = _KINDS.get(name, at.UNKNOWN)

    # -- the text

    def add_files(self) -> bool:
        """Bring in the files of the frames; whether the arrays are others now."""
        added = [self.text.add(frame.file) for frame in self._flow.frames[1:]]
        if not any(added):
            return False
        if self._modes[at.FLOWS] >= 0:
            self.find_flows()
        return True

    def find_flows(self) -> None:
        """Make the rows of the O-words; the tables are others afterwards."""
        new = self._flows.extended(self.text, self._flow)
        self.tables = np.concatenate([self.tables, new.ravel()])
        self._rows = self.tables[at.FLOW_ROWS :].reshape(-1, at.FLOW)
        self._modes[at.FLOWS] = len(self._rows)
        self._subs_seen = (0, 0)
        self._seen = (-1, -1)
        self._flow.touched = set(self._flow.labels)

    # -- into the tables

    def write(self) -> None:
        """Everything that has changed since `take_over`."""
        flow, parameters, modes = self._flow, self._control.parameters, self._modes
        subs = (len(flow.subs), len(self.text.files))
        if subs != self._subs_seen and modes[at.FLOWS] >= 0:
            self._subs_seen = subs
            self._flows.name_subroutines(self._rows, self.text, flow)
        seen = (flow.changes, parameters.changes)
        if seen != self._seen:
            if seen[0] != self._seen[0]:
                self._write_flow()
            self._write_parameters()
            self._seen = seen
        frame = flow.frame
        modes[at.FAILED] = flow.failed
        modes[at.END] = self.text.end_of(frame.file)
        row = at.FRAMES + at.FRAME * modes[at.LEVEL]
        self.tables[row + at.RETURNS] = len(flow.frames) > 1 and not (frame.by_m98 or frame.restores)

    def _write_flow(self) -> None:
        flow, modes, tables = self._flow, self._modes, self.tables
        if modes[at.CHAINS_USED] > _MOST_CHAINS_USED:
            tables[at.CHAINS : at.CHAINS + 2 * at.MOST_CHAINS] = 0
            modes[at.CHAINS_USED] = 0
            self._chains.clear()
            self._origins.clear()
        modes[at.LEVEL] = len(flow.frames) - 1
        modes[at.TAKEN : at.ARRIVED + 1] = flow.taken, flow.breaking, flow.continuing, flow.arrived
        modes[at.HAS_RETURNED], self._numbers[at.RETURNED] = self._control.value_returned, self._control.returned
        modes[at.LOOP] = -1 if flow.loop is None else self.text.base_of(flow.loop[0]) + flow.loop[1]
        for level, frame in enumerate(flow.frames):
            file = frame.file
            modes[at.EPOCH] += 1
            row = at.FRAMES + at.FRAME * level
            tables[row : row + at.FRAME_END + 1] = (
                self.text.base_of(file) + frame.at, self._flows.scope(file.name, frame.name),
                self.chain((file.name, frame.callers)), level > 0 and not (frame.by_m98 or frame.restores),
                -1, modes[at.EPOCH], self.text.end_of(file),
            )  # fmt: skip
            if frame.arguments:
                kept = at.KEPT + at.OF_CALL * level
                self.memory[kept : kept + at.OF_CALL] = frame.arguments
            if level > 0 and not frame.by_m98:
                self._write_names(frame.named, level - 1)
        for key in flow.touched:
            group, label = self._flows.groups.get(key), flow.labels[key]
            if group is not None:
                self._rows[group, at.OPENED_BY : at.LEFT + 1] = (
                    _NUMBER_OF[label.kind],
                    self.text.bases[key[0]] + label.index,
                    -1 if label.left is None else label.left,
                )
        flow.touched.clear()

    def _write_parameters(self) -> None:
        parameters, memory = self._control.parameters, self.memory
        memory[: at.LAST_NUMBER + 1] = 0.0
        memory[DEBUG_ON] = 1.0
        for number, value in parameters.numbers.items():
            if 0 < number <= at.LAST_NUMBER:
                memory[number] = value
        level = int(self._modes[at.LEVEL])
        self._modes[at.EPOCH] += 1
        self.tables[at.FRAMES + at.FRAME * level + at.FRAME_EPOCH] = self._modes[at.EPOCH]
        self._write_names(parameters.locals, level)
        row = at.STAMPS + at.MOST_LEVELS * at.MOST_NAMES
        self.tables[row : row + at.MOST_NAMES] = 0
        self._write_names(parameters.globals, at.MOST_LEVELS)

    def _write_names(self, values: dict[str, float], row: int) -> None:
        epoch = 1 if row == at.MOST_LEVELS else self.tables[at.FRAMES + at.FRAME * row + at.FRAME_EPOCH]
        for name, value in values.items():
            place = at.MOST_NAMES * row + self._name(name)
            self.memory[at.NAMED_VALUES + place] = value
            self.tables[at.STAMPS + place] = epoch

    def _name(self, name: str) -> int:
        """The number of a name, as `parameter_kernels.find_name` gives it."""
        known = self._names.get(name)
        if known is not None:
            return known
        self._read_names()
        tables, modes = self.tables, self._modes
        chars, used = name.encode(), int(modes[at.LETTERS_USED])
        if name in self._names:
            return self._names[name]
        if modes[at.NAMES_USED] >= _MOST_NAMES_USED or used + len(chars) > at.MOST_LETTERS:
            self.is_full = True
            return 0
        number = 0
        for char in chars:
            number = (number * 31 + char) & _HASH_BITS
        number %= at.MOST_NAMES
        while tables[at.NAMES + at.A_NAME * number + 1]:
            number = (number + 1) % at.MOST_NAMES
        row = at.NAMES + at.A_NAME * number
        tables[row : row + at.A_NAME] = used, len(chars), at.GLOBAL if name.startswith("_") else at.LOCAL
        tables[at.LETTERS + used : at.LETTERS + used + len(chars)] = list(chars)
        modes[at.LETTERS_USED] += len(chars)
        modes[at.NAMES_USED] += 1
        self._names[name] = number
        return number

    def _read_names(self) -> None:
        """Learn the names that the kernels have numbered."""
        if len(self._names) == self._modes[at.NAMES_USED]:
            return
        names = self.tables[at.NAMES : at.LETTERS].reshape(at.MOST_NAMES, at.A_NAME)
        for number in np.flatnonzero(names[:, 1]).tolist():
            begin, length, _ = names[number].tolist()
            letters = self.tables[at.LETTERS + begin : at.LETTERS + begin + length]
            self._names[bytes(letters.astype(np.uint8)).decode()] = number

    # -- chains of callers

    def chain(self, origin: Origin) -> int:
        """The number of a file under a chain of callers."""
        known = self._chains.get(origin)
        if known is not None:
            return known
        number = len(self._chains) * 7 % at.MOST_CHAINS
        while self.tables[at.CHAINS + 2 * number]:
            number = (number + 1) % at.MOST_CHAINS
        self.tables[at.CHAINS + 2 * number : at.CHAINS + 2 * number + 2] = -1, len(self._chains)
        self._modes[at.CHAINS_USED] += 1
        self._chains[origin], self._origins[number] = number, origin
        return number

    def origin(self, chain: int) -> Origin:
        """File and callers of a number."""
        known = self._origins.get(chain)
        if known is None:
            above, row = self.tables[at.CHAINS + 2 * chain : at.CHAINS + 2 * chain + 2].tolist()
            file, callers = self.origin(above - 1)
            line = self._flows.line_of(row)[1]
            caller = Caller(file, line + 1, self._flows.shown(row))
            known = self._origins[chain] = (self._flows.callee(row, self._flow)[0].name, (*callers, caller))
            self._chains.setdefault(known, chain)
        return known

    def placed(self, chain: int) -> tuple[Origin, int]:
        """File and callers of a number, and what to take from the index of a line there to get its number."""
        origin = self.origin(chain)
        return origin, self.text.bases[origin[0]] - 1

    # -- and back

    def take_over(self) -> tuple[ProgramFile, int]:
        """What the kernels changed. Returns the file and index of the line executed last."""
        modes, flow = self._modes, self._flow
        parameters = self._control.parameters
        low, level = int(modes[at.LOWEST]), int(modes[at.LEVEL])
        flowed, named, called, changed = modes[at.FLOWED : at.CHANGED + 1].tolist()
        if changed:
            numbers = self.tables[at.CHANGES : at.CHANGES + changed]
            parameters.numbers.update(zip(numbers.tolist(), self.memory[numbers].tolist(), strict=True))
            self.tables[at.IS_CHANGED + numbers] = 0
        if called:
            parameters.numbers.update(enumerate(self.memory[1 : at.OF_CALL + 1].tolist(), 1))
        if flowed:
            self._take_over_flow(low, level)
        flow.frame.at = int(modes[at.NEXT]) - self.text.base_of(flow.frame.file)
        if named or called:
            for each in range(low, level):
                flow.frames[each + 1].named = self._read_values(each)
            parameters.locals = self._read_values(level)
        if named:
            parameters.globals = self._read_values(at.MOST_LEVELS)
        self._seen = (flow.changes, parameters.changes)
        return self.text.file_of(int(modes[at.LAST]))

    def _take_over_flow(self, low: int, level: int) -> None:
        modes, flow, control, text = self._modes, self._flow, self._control, self.text
        flow.taken, flow.breaking, flow.continuing, flow.arrived = map(bool, modes[at.TAKEN : at.ARRIVED + 1].tolist())
        if modes[at.LOOP] >= 0:
            flow.loop = text.file_of(int(modes[at.LOOP]))
        rows = self._rows
        for group in np.flatnonzero(rows[:, at.TOUCHED]).tolist():
            key = self._flows.key_of(group, int(rows[group, at.FLOW_SCOPE]))
            opened_by, opened_at, left, _ = rows[group, at.OPENED_BY : at.TOUCHED + 1].tolist()
            flow.labels[key] = Label(KINDS[opened_by], opened_at - text.bases[key[0]], None if left < 0 else left)
            rows[group, at.TOUCHED] = 0
        control.returned, control.value_returned = float(self._numbers[at.RETURNED]), bool(modes[at.HAS_RETURNED])
        del flow.frames[low + 1 :]
        for each in range(low + 1, level + 1):
            row = at.FRAMES + at.FRAME * each
            above = row - at.FRAME
            flow.frames[-1].at = int(self.tables[above + at.AT]) - text.base_of(flow.frames[-1].file)
            called_by = int(self.tables[row + at.FIRST])
            file, first = self._flows.callee(called_by, flow)
            kept = at.KEPT + at.OF_CALL * each
            flow.frames.append(
                Frame(
                    file,
                    first,
                    name=self._flows.labels[called_by],
                    first=first,
                    arguments=tuple(self.memory[kept : kept + at.OF_CALL].tolist()),
                    callers=self.origin(int(self.tables[row + at.CHAIN]))[1],
                )
            )
        control.sub_level = level

    def _read_values(self, row: int) -> dict[str, float]:
        """The named parameters of a level, or the global ones."""
        self._read_names()
        epoch = 1 if row == at.MOST_LEVELS else self.tables[at.FRAMES + at.FRAME * row + at.FRAME_EPOCH]
        stamps = self.tables[at.STAMPS + at.MOST_NAMES * row : at.STAMPS + at.MOST_NAMES * (row + 1)]
        values = self.memory[at.NAMED_VALUES + at.MOST_NAMES * row :]
        return {name: float(values[number]) for name, number in self._names.items() if stamps[number] == epoch}

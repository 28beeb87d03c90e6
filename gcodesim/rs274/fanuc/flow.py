"""GOTO, loops, M98 and M99, macro calls: where a Fanuc program goes on."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

from gcodesim.diagnostics import Caller, SourceText, Span
from gcodesim.frozen import frozen
from gcodesim.rs274.block import Flow
from gcodesim.rs274.fanuc import external
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fanuc.expressions import number_of
from gcodesim.rs274.fanuc.program import MOST_LOOPS, FanucFile, FanucProgram
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.flow import FlowControl, Stopped
from gcodesim.rs274.frame import Frame
from gcodesim.rs274.machine_codes import end_program
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.reader import Reader

MOST_LEVELS = 10
MOST_MACRO_LEVELS = 5
_SUFFIXES = ("", ".nc", ".NC", ".ngc", ".txt", ".tap", ".cnc")
_NO_PART = FanucProgram(None, 0, 0)


@frozen
class ModalCall:
    """A macro that G66 or G66.1 calls again and again."""

    number: int
    rounds: int
    arguments: dict[int, float]
    every_block: bool


@dataclass(slots=True)
class FanucFrame(Frame):
    """`part` is the running program. `calls` are the modal macros in force here, shared with programs called by M98."""

    part: FanucProgram = _NO_PART
    macro: bool = False
    macro_arguments: dict[int, float] = field(default_factory=dict)
    outer: dict[int, float] = field(default_factory=dict)  # the caller's #1 to #33
    begun: set[int] = field(default_factory=set)  # lines of DO that were passed
    calls: list[ModalCall] = field(default_factory=list)
    jumps_in: dict[int, Span] = field(default_factory=dict)  # the GOTO that led behind a line of DO

    @property
    def calls_at_moves(self) -> bool:
        return bool(self.calls)

    def resume(self, file: ProgramFile) -> None:
        Frame.resume(self, file)
        assert isinstance(file, FanucFile)
        self.part = file.part_at(self.part.first)

    def situation(self) -> tuple[object, ...]:
        own = (self.part, self.macro, dict(self.macro_arguments), dict(self.outer), set(self.begun), list(self.calls))
        return (*Frame.situation(self), *own)


class FanucFlow(FlowControl):
    """The stack of running programs and macros."""

    control: FanucControl

    def __init__(self, control: FanucControl, main: FanucFile, reader: Reader, folders: tuple[Path, ...]) -> None:
        super().__init__(control, main, reader, folders)
        self.frames = [FanucFrame(main, main.first, part=main.parts[0])]

    @property
    def running(self) -> FanucFrame:
        frame = self.frame
        assert isinstance(frame, FanucFrame)
        return frame

    @property
    def _lines(self) -> FanucFile:
        file = self.frame.file
        assert isinstance(file, FanucFile)
        return file

    # -- jumps and loops

    def execute(self, flow: Flow, index: int) -> None:
        """A statement that stands alone: GOTO, DO, END, or the O of the running program."""
        if flow.keyword == "program":
            return
        if flow.keyword in external.KEYWORDS:
            external.execute(flow, self.control)
            return
        if flow.keyword == "goto":
            if not flow.operands or self._holds(flow):
                self.go_to(self._whole(number_of(flow.label, self.control.parameters), "GOTO"), index)
            return
        number = round(number_of(flow.label, self.control.parameters))
        if not 1 <= number <= MOST_LOOPS:
            message = f"{flow.keyword.upper()}{number}: loops are numbered 1, 2 and 3"
            raise Fault("GS130", message, at=flow.place, hint="the same number may be used again after its END")
        loops = self._lines.loops(self.running.part)
        if index in loops.wrong:
            raise Stopped("GS130", loops.wrong[index], hint="each DO needs its END, and loops may only nest")
        if index not in (loops.starts if flow.keyword == "end" else loops.ends):
            message = f"{flow.keyword.upper()}{number} is taken apart by a `/`, so that it belongs to no loop"
            raise Stopped("GS130", message, hint="a `/` stands before a block or before a word")
        if flow.keyword == "end":
            start = loops.starts[index]
            if start not in self.running.begun:
                message = f"END{number} is reached without the DO{number} of line {start + 1}"
                hint, span = "a GOTO may leave a loop, but not enter it", self.running.jumps_in.get(start)
                if span is not None:
                    message = f"this leads into the loop of line {start + 1}, whose END{number} needs its DO{number}"
                raise Fault("GS130", message, at=flow.place, hint=hint, span=span)
            self._back_to(start)
            return
        self.running.begun.add(index)
        if flow.operands and not self._holds(flow):
            self.frame.at = loops.ends[index] + 1

    def _holds(self, flow: Flow) -> bool:
        return number_of(flow.operands[0], self.control.parameters) != 0.0

    @staticmethod
    def _whole(value: float, who: str) -> int:
        number = round(value)
        if abs(value - number) > 1e-4 or number < 0:
            raise Fault("GS106", f"{who} {value:g}: it must be a whole number")
        return number

    def go_to(self, number: int, index: int) -> None:
        """Go on at block N`number` of the running program."""
        target = self._lines.sequence(number, index)
        if target is None:
            where = f"in {self._lines.shown(part)}" if (part := self.running.part.number) else "in this program"
            hint = f"put N{number} before the block that is meant"
            raise Stopped("GS130", f"there is no block N{number} {where}", hint=hint)
        for start, end in self._lines.loops(self.running.part).ends.items():
            if start < target <= end and not start <= index <= end:
                self.running.jumps_in[start] = self.control.span
        if target <= index:
            self._back_to(target)
        else:
            self.frame.at = target

    # -- subprograms

    def call_program(self, number: int, rounds: int, index: int) -> None:
        """M98."""
        if rounds <= 0:
            return
        calls = self.running.calls
        file, part = self._find_program(number)
        if self.was_read(file, part.first):
            return
        self._push(file, part, number, rounds, index).calls = calls

    def repeats_of(self, word: float, rounds: int | None) -> tuple[int, int]:
        """Program and rounds of M98 P L; P of five digits and more is rounds and the four digits of the program."""
        number = self._whole(word, "P")
        if rounds is not None:
            return number, rounds
        if number > 9999 and self._lines.program(number) is None and number not in self._lines.names:
            return number % 10000, number // 10000
        return number, 1

    def end_of_program(self, block: int | None = None) -> None:
        """M99: the next round, or back to the caller, there to N`block`."""
        frame = self.running
        if len(self.frames) == 1:
            if block is not None:
                self.go_to(block, frame.at - 1)
            else:
                end_program(self.control, shuttle=False)  # a control would start again from the top
            return
        frame.rounds -= 1
        if frame.rounds > 0 and not self.failed:
            self._back_to(frame.first)
            if frame.macro:
                self.control.parameters.local = dict(frame.macro_arguments)
            return
        self.frames.pop()
        self.control.sub_level = len(self.frames) - 1
        if frame.macro:
            self.control.parameters.local = frame.outer
        if block is not None:
            self.go_to(block, self.frame.at - 1)

    # -- macros

    def call_macro(self, number: int, rounds: int, arguments: dict[int, float], index: int) -> None:
        """G65: variables of its own, modal calls of its caller."""
        self._push_macro(number, rounds, arguments, index, self.running.calls)

    def begin_modal(self, modal: ModalCall) -> None:
        """G66 and G66.1; the program has to be there already."""
        self._find_program(modal.number)
        if len(self.running.calls) >= MOST_MACRO_LEVELS:
            raise Fault("GS132", f"more than {MOST_MACRO_LEVELS} modal macros at once", hint="end them with G67")
        self.running.calls.append(modal)

    def end_modal(self) -> None:
        """G67."""
        if self.running.calls:
            self.running.calls.pop()

    def call_modal(self, index: int, arguments: dict[int, float] | None = None) -> None:
        """Call the last modal macro; moves inside it call the one before."""
        *others, modal = self.running.calls
        if arguments is not None:
            modal = replace(modal, arguments={**modal.arguments, **arguments})
        self._push_macro(modal.number, modal.rounds, modal.arguments, index, others)

    def _push_macro(
        self, number: int, rounds: int, arguments: dict[int, float], index: int, calls: list[ModalCall]
    ) -> None:
        if rounds <= 0:
            return
        if sum(isinstance(frame, FanucFrame) and frame.macro for frame in self.frames) >= MOST_MACRO_LEVELS:
            raise Stopped("GS132", f"macros are called more than {MOST_MACRO_LEVELS} deep")
        file, part = self._find_program(number)
        if self.was_read(file, part.first):
            return
        frame = self._push(file, part, number, rounds, index)
        frame.calls = calls
        frame.macro, frame.macro_arguments = True, arguments
        frame.outer = self.control.parameters.local
        self.control.parameters.local = dict(arguments)

    def _push(self, file: FanucFile, part: FanucProgram, number: int, rounds: int, index: int) -> FanucFrame:
        if len(self.frames) > MOST_LEVELS:
            hint = "a program that calls itself needs an IF that ends it"
            raise Stopped("GS132", f"programs are called more than {MOST_LEVELS} deep", hint=hint)
        name = self._lines.names.get(number)
        caller = Caller(self.frame.file.name, index + 1, f"O{number}" if name is None else f"<{name}>")
        frame = FanucFrame(
            file,
            part.first,
            name=str(number),
            first=part.first,
            rounds=rounds,
            callers=(*self.frame.callers, caller),
            part=part,
        )
        self.frames.append(frame)
        self.control.sub_level = len(self.frames) - 1
        self.changes += 1
        return frame

    def _find_program(self, number: int) -> tuple[FanucFile, FanucProgram]:
        """In the running file, in the main one, or in a file of its name."""
        main = self.frames[0].file
        for file in (self._lines, main, self._file_of_number(number)):
            part = file.program(number) if isinstance(file, FanucFile) else None
            if part is not None:
                assert isinstance(file, FanucFile)
                return file, part
        shown = self._lines.shown(number)
        hint = f"begin it with a line {shown}, or put it as {shown.strip('<>')}.nc beside the program"
        behind = main.behind(number) if isinstance(main, FanucFile) else None
        if behind is not None:
            hint = f"it stands in line {behind + 1}, behind the % that ends the file: move that % to the end"
        raise Stopped("GS131", f"there is no program {shown}", hint=hint)

    def _file_of_number(self, number: int) -> FanucFile | None:
        name = self._lines.names.get(number)
        names = [f"{head}{digits}" for head in ("O", "o", "") for digits in (f"{number:04d}", str(number))]
        if name is not None:
            names = [] if set(name) & set("/\\:\0") or name.startswith(".") else [name]
        for folder in self.folders:
            for name in dict.fromkeys(name + suffix for name in names for suffix in _SUFFIXES):
                known = self.files.get(name)
                if isinstance(known, FanucFile):
                    return known
                path = folder / name
                try:
                    if path.is_file() and self._is_within(path):
                        file = FanucFile(SourceText.read(path), self.reader)
                        self.files[name] = file
                        return file
                except OSError:
                    continue
        return None

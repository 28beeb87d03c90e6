"""Running a printer's program line by line."""

from __future__ import annotations

import re
from collections.abc import Generator, Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Final, cast

from gcodesim import canon
from gcodesim.canon.batch import MoveBatch
from gcodesim.canon.printing import MotionLimits
from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.diagnostics.text import LONG
from gcodesim.rs274.control import Control
from gcodesim.rs274.executor import MOST_NOTES, Executor, Feedback
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.flow import FlowControl
from gcodesim.rs274.lanes import WORTH_COMPILING, Lane, Lanes, LongLanes
from gcodesim.rs274.marlin.codes import CODES
from gcodesim.rs274.marlin.comments import take_comment
from gcodesim.rs274.marlin.duet.commands import Interpreter, code_of, command_of, filled
from gcodesim.rs274.marlin.duet.frame import BlockFrame, ModesOfCaller
from gcodesim.rs274.marlin.duet.macro_call import MacroCall, call_of, files_of, given_by, is_call
from gcodesim.rs274.marlin.duet.object_model import ObjectModel
from gcodesim.rs274.marlin.duet.own_codes import codes_in, own_code
from gcodesim.rs274.marlin.duet.syntax import Value
from gcodesim.rs274.marlin.duet.tool_change import ChangeStep, steps_of
from gcodesim.rs274.marlin.halted_print import HaltedPrint
from gcodesim.rs274.marlin.limits import first_limits, first_retraction
from gcodesim.rs274.marlin.line import MarlinLine, line_of
from gcodesim.rs274.marlin.machine_moves import MACHINE_MOVES, home
from gcodesim.rs274.marlin.macros import MACROS
from gcodesim.rs274.marlin.moves import MOVES, SYSTEMS, change_unit, choose_system, here
from gcodesim.rs274.marlin.printer import Printer
from gcodesim.rs274.marlin.printer_file import PrinterFile
from gcodesim.rs274.marlin.said import remember
from gcodesim.rs274.other_machines import foreign_of
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.run import Run
from gcodesim.rs274.settings import MappedAction
from gcodesim.rs274.state import Vector
from gcodesim.rs274.tool_table import ToolEntry
from gcodesim.rs274.watch import Watches
from gcodesim.rs274.watch.filament import FallingFilament

_KNOWN_G: Final = frozenset((12, 26, 27, 29, 31, 32, 33, 34, 35, 39, 42, 60, 61, 76, 80, 150, 380, 383, 384, 392, 425))
"""G codes that are read and not simulated: of levelling, cleaning, parking and the like; 39, 150 and 380 to 392, also
with a point behind, are Bambu's. All others move, so that what follows would be wrong."""

_OWN_G: Final = 600
"""G codes from here on are a maker's or user's own, as macros are: G2814 of Bambu, G999 in a script that changes
nozzles. No firmware's own code is as high."""

_MOVES: Final = MOVES | MACHINE_MOVES
_GOES: Final = frozenset(("G0", "G1", "G2", "G3", "G28", "G30", "G53"))
"""Those that move the head."""
_SETTINGS: Final = frozenset(("G10", "G20", "G21"))
"""Those among the moves that set something."""
_SHOWN: Final = ("M0", "M1")
"""Waits whose text a display shows."""

_META: Final = frozenset(("VAR", "GLOBAL", "SET", "IF", "ELIF", "ELSE", "WHILE", "BREAK", "CONTINUE", "ABORT", "SKIP"))
"""Commands of RepRapFirmware that say which lines are done, and with what (docs.duet3d.com, GCode meta commands)."""

_CHANGE_POINT: Final = 2
"""Number of the place at which a T found the head (RepRapFirmware, ToolChangeRestorePointNumber)."""

_NO_NOZZLE: Final = 255
"""T255, T1000 and the like are no nozzles: with them Bambu's start code unloads filament, or ends a change."""


class PrinterExecutor(Executor):
    """One execution of a run of a printer's program: nothing turns, so that no rule of mills applies."""

    is_quick = False

    def __init__(self, run: Run) -> None:
        super().__init__(run)
        self.settings = self.control.settings = replace(run.settings, loaded_tool=0)
        self.watches = Watches((FallingFilament,))
        if (retraction := first_retraction(run.source)) is not None:
            length, feed = retraction
            self.printer.retraction, self.printer.recovery = (length, feed, 0.0), (0.0, feed)
        self.e_follows_distance = self.dialect.name == "marlin"
        self.counts_minutes = self.dialect.name == "reprapfirmware"
        self.diameters: dict[int, float] = {}
        tools = self.control.tools
        self.first_number = 1 if tools and 0 not in tools else 0
        self._limited = bool(run.settings.limits)
        self.homes_first = run.settings.unplaced
        self._mounted = -1
        self.first_origin = (0.0, 0.0, 0.0)

    def _own_lanes(self) -> Lanes | None:
        size, choice = len(self.run.source.raw), self.run.settings.lane

        def open_lane(may_compile: bool) -> Lane | None:
            from gcodesim.rs274.marlin.lane import PrinterLane, is_ready  # imports numpy, and perhaps the compiler

            return PrinterLane(self) if may_compile or is_ready() else None

        return LongLanes(choice, size >= LONG, size >= WORTH_COMPILING, open_lane)

    def _parts(self, source: SourceText) -> tuple[ProgramFile, Control, FlowControl]:
        file, control = PrinterFile(source, self.reader), Control(self.settings, self.dialect)
        flow = FlowControl(control, file, self.reader, self.folders)
        limits, self.source_of_limits = first_limits(self.dialect.name, source, self.settings.limits)
        self.printer = Printer(limits=limits)
        self.meta: Interpreter | None = None
        if file.has_expressions:
            self.meta = Interpreter(control, flow, ObjectModel(control, self.printer))
            flow.frames = [self.meta.frame_of(file)]
        return file, control, flow

    def _initial_path_control(self) -> None:
        super()._initial_path_control()
        control = self.control
        x, y, z = (at * control.state.unit for at in control.state.origin[:3])
        self.first_origin = x, y, z
        control.out.append(canon.PlannerLimits(span=control.span, limits=self.printer.limits))
        loaded = self.run.settings.loaded_tool
        known = [number for number in (loaded, 0, min(control.tools, default=0)) if number in control.tools]
        if known:
            self.printer.tool = known[0] - self.first_number
            self._put_in(known[0])

    def _halted(self) -> HaltedPrint:
        return HaltedPrint(control=self.control, file=self.file, frames=tuple(self.flow.frames), printer=self.printer)

    def _line(self, file: ProgramFile, index: int, text: str) -> None:
        control = self.control
        control.span = Span.of_line(file.name, index + 1, text, self.flow.frame.callers)
        control.block_number = self.blocks
        try:
            if self.meta is not None:
                if file is self.flow.frame.file and not self.meta.arrives(index, text):
                    return
                if (command := command_of(text)) is not None:
                    self.meta.execute(command, index)
                    self._watch(control.out)
                    return
                self.meta.index = index
                code = code_of(text)
                if is_call(code):
                    self._call_macro(code, index, self.meta)
                    return
                if self._own_codes and self._call_own_code(code, index, self.meta):
                    return
            if self.meta is None or "{" not in text:
                line = line_of(text, has_lists=self.meta is not None)
            else:
                line = self._filled(text, index, self.meta)
            if line.note and not line.name and not line.values and take_comment(line.note, self.printer):
                control.out.append(canon.SectionStart(span=control.span, section=self.printer.section))
            self._check_sum(line)
            if line.name or line.values:
                self._do(line)
                if self.meta is not None:
                    self.meta.machine.hear(line)
            self._watch(control.out)
        except Fault as fault:
            control.out.clear()
            self._fault(fault, file, index, text, None)
        except (OverflowError, RecursionError):
            self._fault(Fault("GS123", "a value is too large to be computed with"), file, index, text, None)
        if len(control.notes) > MOST_NOTES:
            self.hand_over_notes()

    def _filled(self, text: str, index: int, meta: Interpreter) -> MarlinLine:
        """A line with its expressions computed; words are where they stand in the program."""
        made = filled(text, meta, index)
        try:
            line = line_of(made.text, has_lists=True)
        except Fault as fault:
            fault.at = made.place(fault.at) if type(fault.at) is tuple else fault.at
            raise
        line.place = made.place(line.place)
        line.places = {letter: made.place(place) for letter, place in line.places.items()}
        line.stray = None if line.stray is None else made.place(line.stray)
        return line

    def step(self) -> Generator[canon.Event | MoveBatch, Feedback, None]:
        frame = self.flow.frame
        if self.meta is not None and frame.at >= len(frame.file.lines) and self.meta.ends() and self.leaves_macro():
            return
        yield from super().step()

    def _steps_in_lane(self) -> Generator[canon.Event | MoveBatch, Feedback, bool]:
        if self.meta is not None and not self.meta.is_outside:
            return False
        return (yield from super()._steps_in_lane())

    def _call_macro(self, code: str, index: int, meta: Interpreter) -> None:
        """M98: go on in the file that it names; told where there is none, as the printer does."""
        control = self.control
        meta.index = index
        call = call_of(code, meta)
        if call is None:
            control.skip("M98 R")
            return
        file = self._macro_file(call)
        if file is None:
            control.skip(f'M98 P"{call.path}"' if call.is_fixed else "M98", call.place)
            return
        if self.flow.was_read(file, 0):
            return
        self._enter_macro(file, call.given, index, meta)

    def _enter_macro(
        self,
        file: PrinterFile,
        given: Mapping[str, Value],
        index: int,
        meta: Interpreter,
        then: tuple[ChangeStep, ...] = (),
    ) -> None:
        control, printer = self.control, self.printer
        frame = meta.frame_of(file)
        frame.given, frame.then = given, then
        frame.modes = ModesOfCaller(control.state.unit, control.state.incremental, printer.e_relative, printer.feed)
        self.flow.enter(frame, file.name, index)

    def _macro_file(self, call: MacroCall) -> PrinterFile | None:
        """The file of a macro, which is beside the program; raises `Fault` where the name leads out of there."""
        ways = list(files_of(call.path))
        if not ways:
            hint = "the folder of the program is the card: `0:/macros/clean.g` is `macros/clean.g` beside the program"
            raise Fault("GS131", f"`{call.path}` is no file of the printer's card", at=call.place, hint=hint)
        return self._file_of(ways)

    def _file_of(self, ways: Iterable[str]) -> PrinterFile | None:
        """The first of these files that is there."""
        for way in ways:
            known = self.flow.files.get(way)
            if known is None and (source := self.flow.source_of(way)) is not None:
                known = self.flow.files[way] = PrinterFile(source, self.reader)
            if known is not None:
                return cast(PrinterFile, known)
        return None

    @cached_property
    def _own_codes(self) -> dict[str, str]:
        """The files of G and M codes that the user has made."""
        return codes_in(self.flow.folders)

    def _call_own_code(self, text: str, index: int, meta: Interpreter) -> bool:
        """Go on in the file of a code that the user has made; false where the line has no such code."""
        found = own_code(text)
        if found is None or (name := self._own_codes.get(found[0])) is None:
            return False
        file = self._file_of([name])
        if file is None:
            return False
        if not self.flow.was_read(file, 0):
            self._enter_macro(file, given_by(text, found[1], meta), index, meta)
        return True

    def leaves_macro(self) -> bool:
        """Go on behind the call of the macro that is running; false in the main program."""
        if len(self.flow.frames) == 1:
            return False
        left = cast(BlockFrame, self.flow.leave_file())
        modes = left.modes
        assert modes is not None
        change_unit(self, modes.unit)
        self.control.state.incremental, self.printer.e_relative = modes.incremental, modes.e_relative
        self.printer.feed = modes.feed
        if left.then:
            self._change(left.then, left.callers[-1].line - 1)
        return True

    def _startup_blocks(self, text: str) -> list[str]:
        """A line for each command, since a printer's line has one; each stands where it stands in the cell."""
        begins = [found.start() for found in re.finditer(r"[GMgm]|^\s*[^GMgm\s]", text)]
        ends = [*begins[1:], len(text)][: len(begins)]
        return [" " * begin + text[begin:end] for begin, end in zip(begins, ends, strict=True)]

    def _check_sum(self, line: MarlinLine) -> None:
        if line.checksum is not None and line.checksum[0] != line.checksum[1]:
            said, counted = line.checksum
            self.control.warn("GS017", f"the checksum is {said}; the line has {counted}", "a control asks for it again")

    def _do(self, line: MarlinLine) -> None:
        name = line.name
        if not name:
            letter = next(iter(line.values))
            raise Fault(
                "GS018",
                f"the line begins with {letter.upper()}, but with no command",
                at=line.places[letter],
                hint="a printer's control remembers no G code: write G1 in each line",
            )
        if line.is_macro:
            self._macro(line)
        elif name in _MOVES:
            if self.homes_first and name in _GOES:
                self._home_first(name)
            _MOVES[name](self, line)
        elif self._mapped(line):
            pass
        elif name in SYSTEMS and self.dialect.name == "reprapfirmware":
            choose_system(self, line)
        elif name in CODES:
            self._pass_over_text(line)
            CODES[name](self, line)
        elif name[0] == "T":
            self.choose_tool(int(name[1:].partition(".")[0]), line)
        elif name[0] == "G" and (number := int(name[1:].partition(".")[0])) not in _KNOWN_G:
            if number >= _OWN_G:
                self.skip(f"macro {name}", line)
                return
            raise Fault(
                "GS012",
                f"{name} is not simulated for printers, so the places after it would be wrong",
                at=line.place,
                hint="let the slicer write G0 to G3",
            )
        else:
            self.skip(name, line)
        if name not in _MOVES or name in _SETTINGS:
            remember(self.printer.said, line, self.printer.tool)

    def _home_first(self, name: str) -> None:
        """Home before the first move: printers do so, and where the work is at no place of its own, none is better."""
        self.homes_first = False
        if name != "G28":
            home(self, MarlinLine(name="G28"))

    def _pass_over_text(self, line: MarlinLine) -> None:
        """GS194: text where a code that is simulated has words; firmware reads on without it."""
        if line.stray is not None and line.name not in _SHOWN:
            self.control.warn(
                "GS194",
                f"{line.name} passes over `{line.text}`",
                "a value stands behind the letter that it belongs to",
                line.stray,
            )

    def _macro(self, line: MarlinLine) -> None:
        if self.dialect.name == "reprapfirmware" and line.name in _META:
            word = line.name.lower()
            hint = f"`{word}` is written in small letters"
            raise Fault("GS001", "this is no command in capital letters", at=line.place, hint=hint)
        if line.name in MACROS:
            MACROS[line.name](self, line)
        else:
            self.skip(f"macro {line.name}", line)

    def _mapped(self, line: MarlinLine) -> bool:
        """Whether the cell gives an M code a meaning, which is then carried out."""
        if line.name[0] != "M":
            return False
        p = line.get("p")
        codes = self.settings.m_codes
        action: MappedAction | None = codes.get(line.name)
        if p is not None and p.is_integer():
            action = codes.get(f"{line.name} P{int(p)}", action)
        if action is None:
            return False
        self.control.out.append(
            canon.Action(
                span=self.control.span,
                m=int(line.name[1:].partition(".")[0]),
                p=p,
                q=line.get("q"),
                target=action.target,
                verb=action.verb,
            )
        )
        return True

    def _of_other_control(self) -> Diagnostic | None:
        """None for printers: the file may be full of their words, and its fault is its own."""
        foreign = foreign_of(self.run.source)
        own = ("printer", "script") if self.dialect.name == "reprapfirmware" else ("printer",)  # `var x = 1`
        return None if foreign is None or foreign.kind in own else super()._of_other_control()

    # -- what commands do

    def skip(self, word: str, line: MarlinLine) -> None:
        """Count a command that is read and not simulated."""
        self.control.skip(word, line.place)

    def limit(self, limits: MotionLimits) -> None:
        """Put limits of the planner in force."""
        self._limited = True
        if limits != self.printer.limits:
            self.printer.limits = limits
            self.control.out.append(canon.PlannerLimits(span=self.control.span, limits=limits))

    def choose_tool(self, index: int, line: MarlinLine) -> None:
        """T: another nozzle; T0 is tool 0 of the cell, or its tool 1 where it counts from 1."""
        if index >= _NO_NOZZLE or (index < 0 and self.meta is None):
            self.skip(line.name, line)
            return
        number = index + self.first_number
        if index >= 0 and self.settings.has_cell and number not in self.control.tools:
            self.control.tool_entry(number, "t")
        if self.meta is None:
            self._take(index)
            return
        which = line.get("p")
        old = -1 if self.printer.chosen is None else self.printer.chosen
        steps = steps_of(old, index, None if which is None else int(which))
        if steps:
            self.printer.points[_CHANGE_POINT], self.printer.coming = here(self), index
        self._change(steps, self.meta.index)

    def _change(self, steps: tuple[ChangeStep, ...], index: int) -> None:
        """Do the rest of a change of tools that line `index` asks for, up to the next macro."""
        assert self.meta is not None
        for k, step in enumerate(steps):
            if step.macros:
                file = self._file_of(way for name in step.macros for way in files_of(name))
                if file is not None and not self.flow.was_read(file, 0):
                    self._enter_macro(file, {}, index, self.meta, steps[k + 1 :])
                    return
            else:
                frame = self.flow.frame
                self.control.span = Span.of_line(frame.file.name, index + 1, frame.file.lines[index], frame.callers)
                self._take(step.tool)
        self.printer.coming = None

    def _take(self, index: int) -> None:
        """Nozzle `index` is in use; after -1 none is, though the last one stays in the head."""
        self.printer.chosen = index
        if index < 0:
            return
        self.printer.tool = index
        number = index + self.first_number
        if number != self._mounted:
            self._put_in(number)

    def _put_in(self, number: int) -> None:
        control = self.control
        control.spindle_tool = control.tools.get(number, ToolEntry(number=number))
        control.state.tool = self._mounted = number
        control.out.append(canon.ToolNumber(span=control.span, tool=number))
        offset = self._offset_in_force()
        if offset != control.state.tool_offset:
            axes = control.axes()
            control.state.tool_offset = offset
            control.stay_at(axes)
            control.say_tool_offset()

    def _offset_in_force(self) -> Vector:
        """The offset of the nozzle in use, along each axis the program's where the cell, too, knows nozzles apart.

        A cell whose nozzles are all at one place does not say where in the head each is. Then M218 says it, and beads
        are laid where they are programmed. Where the cell says it, they go astray by what M218 says otherwise.
        """
        control = self.control
        own: Vector = control.from_si(control.spindle_tool.offset)
        if self.printer.tool not in self.printer.offsets:
            return own
        first: Vector = control.from_si(control.tools.get(self.first_number, ToolEntry(number=0)).offset)
        said = self.printer.offset_of(self.printer.tool)
        knows = not self.settings.has_cell
        ruled = [at - by if knows or at != mine else mine for at, by, mine in zip(first, said, own, strict=False)]
        return (*ruled, *own[len(ruled) :])  # type: ignore[return-value]

    def finish(self) -> None:
        control = self.control
        if not self._limited and control.finished and self.run.failed is None:
            limits = self.printer.limits
            self.run.findings.add(
                Diagnostic(
                    code="GS210",
                    span=Span(self.file.name),
                    message=f"limits of the planner are {self.source_of_limits}: {limits.printing * 1e3:g} mm/s² "
                    "while printing",
                    hint="M201, M203, M204 and M205 in the program say what the printer has, or `firmware` in the cell",
                )
            )
        control.span = Span(self.file.name)  # lines behind the end are no fault here
        super().finish()

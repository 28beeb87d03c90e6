"""One execution of a program: line by line, block by block, with every fault collected."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final

from gcodesim import canon
from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import Diagnostic, Severity, SourceText, Span
from gcodesim.rs274 import notes, tool_point
from gcodesim.rs274.allowance import Allowance
from gcodesim.rs274.assignments import assign, declare, evaluated
from gcodesim.rs274.block import Block
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects import DIALECTS, Dialect
from gcodesim.rs274.dialects.foreign import FOREIGN
from gcodesim.rs274.dialects.linuxcnc import STOPPING
from gcodesim.rs274.endless import Endless
from gcodesim.rs274.entry.halted import Halted
from gcodesim.rs274.execute import execute, execute_move, is_plain_move
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.flow import FlowControl, Stopped
from gcodesim.rs274.lanes import Lanes, PlainLanes
from gcodesim.rs274.length_words import length_words
from gcodesim.rs274.machine_codes import heard, load_first_tool
from gcodesim.rs274.not_simulated import MAY_MISS, not_simulated
from gcodesim.rs274.odd_numbers import odd_numbers
from gcodesim.rs274.other_machines import Foreign, foreign_of, lathe_of
from gcodesim.rs274.parameters import KEPT
from gcodesim.rs274.presets import preset, unused_presets
from gcodesim.rs274.probing import tripped
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.program_source import why_unreadable
from gcodesim.rs274.reader import Reader
from gcodesim.rs274.recovery import Recovery
from gcodesim.rs274.told import Told
from gcodesim.rs274.watch import Watches
from gcodesim.rs274.watch.structure import structure_findings, unclosed_findings
from gcodesim.rs274.words import Words, place_of, read_words

if TYPE_CHECKING:
    from gcodesim.rs274.run import Run

Feedback = canon.Answer | canon.Axes | None
_MOST_OF_CONTOUR: Final = 1000  # blocks
MOST_NOTES: Final = 1000
"""Warnings kept until they are folded."""


class Executor:
    """One execution of a run."""

    is_quick: ClassVar[bool] = True
    """Whether all that programs are mostly made of may come thousands of lines at a time."""

    def __init__(self, run: Run) -> None:
        settings = run.settings
        self.run = run
        self.settings = settings
        self.dialect: Dialect = DIALECTS[settings.dialect]
        self.reader = Reader(self.dialect)
        self.file, self.control, self.flow = self._parts(run.source)
        if settings.tool_length == "auto" and settings.auto_length is not None:
            words = length_words(run.source, h0_cancels=self.dialect.h0_cancels)
            if settings.loaded_tool:  # Z was touched off with it, and G49 takes nothing of that away
                self.control.auto_length = b"3" not in words
            else:
                self.control.auto_length, self.control.length_cancelled = not words, words == {b"9"}
        self.control.frames = self.flow.frames
        self.control.contours = self._contour
        self.recovery = Recovery(self.control)
        self.watches = Watches()
        self.blocks = 0
        self.given_up = False  # the file is in another language
        self._broken_off = False
        self.probes_meet = True  # what is taken for granted while nobody says where probes trip
        self.told = Told()
        self.lanes = self._own_lanes()
        lines = len(run.source.lines)
        self.allowance = Allowance(settings, lines=lines, is_quick=self.is_quick)
        self.endless = Endless(self.control, self.flow, lines=lines, limit=self.allowance.most_blocks)

    def _own_lanes(self) -> Lanes | None:
        """The compiled lane that knows this language, if there is one."""
        return PlainLanes(self.run.source, self.settings, self.control, self.flow, self._longest_plain_line)

    @property
    def _longest_plain_line(self) -> int:
        """The most characters of a line that is certainly not too long; the compiled lane leaves longer ones."""
        return self.dialect.longest_line

    @property
    def folders(self) -> tuple[Path, ...]:
        """Folders in which subroutine files may be: the given ones, and that of the program."""
        beside = self.run.source.folder
        return (*self.settings.subroutines, *(() if beside is None else (beside,)))

    def _parts(self, source: SourceText) -> tuple[ProgramFile, Control, FlowControl]:
        """The program, the control that runs it and its flow control, for this dialect."""
        file = ProgramFile(source, self.reader)
        control = Control(self.settings, self.dialect)
        return file, control, FlowControl(control, file, self.reader, self.folders)

    def events(self) -> Generator[canon.Event | MoveBatch, Feedback, None]:
        yield from self.begin()
        while not self.over:
            yield from self.step()
        self.finish()

    @property
    def over(self) -> bool:
        """Whether nothing is left to be executed."""
        return self.control.finished or self._broken_off

    def begin(self) -> Iterator[canon.Event]:
        """What is said before the first line."""
        control = self.control
        control.span = Span(self.file.name)
        for fault in preset(control.parameters, self.settings.presets):
            self._report(Diagnostic(code=fault.code, message=fault.message, span=control.span, hint=fault.hint), None)
        if any(number in KEPT for number in self.settings.presets):
            control.restore_systems()
        self._initial_path_control()
        control.say_system()
        if control.state.point_control:
            tool_point.say(control)
        load_first_tool(control)
        self._start_up()
        self.watches.events(control.out)
        yield from control.out
        control.out.clear()
        self._refuse_binary()
        self._tell_of_lathe()

    def step(self) -> Generator[canon.Event | MoveBatch, Feedback, None]:
        """Execute the next line, or a run of lines in the compiled lane."""
        control, out = self.control, self.control.out
        frame = self.flow.frame
        index = frame.at
        if index >= len(frame.file.lines):
            self._end_of_lines()
            self._broken_off = True
            return
        if (yield from self._steps_in_lane()):
            return
        if index + 1 == self.settings.until and frame.file is self.file:
            self.run.halted = self._halted()
            self._broken_off = True
            return
        frame.at = index + 1
        text = frame.file.lines[index]
        closing = self.file.has_percent or self.recovery.ended
        if closing and frame.file is self.file and text.strip() == "%":
            control.span = Span.of_line(frame.file.name, index + 1, text, frame.callers)
            out.append(canon.EndOfFile(span=control.span))
            control.finished = True
            self._watch(out)
        elif text:
            self._line(frame.file, index, text)
        if out:
            self.allowance.spend(len(out))
            if self.run.failed is None:
                yield from self._told(index)
            else:
                for event in out:
                    if type(event) is canon.ProbeMove:
                        tripped(control, event, None, meets=self.probes_meet)
            out.clear()
        self.blocks += 1
        self._broken_off = self._broken_off or self._exhausted(frame.file, index)

    def _halted(self) -> Halted:
        return Halted(control=self.control, file=self.file, frames=tuple(self.flow.frames))

    def _told(self, index: int) -> Generator[canon.Event, Feedback, None]:
        """The events of line `index`, and what the caller answers to those that ask."""
        for event in self.control.out:
            if type(event) is canon.ProbeMove or type(event) is canon.Input:
                asked = time.monotonic()
                self._show_sources()
                reply = yield event
                if reply is not None:
                    self.endless.forget()
                self.allowance.forgive(time.monotonic() - asked)
                if not self._hear(event, reply, index):
                    break
            else:
                yield event

    def _steps_in_lane(self) -> Generator[canon.Event | MoveBatch, Feedback, bool]:
        """Execute lines in the compiled lane, if it is open and understands the next one; whether it did."""
        looking = self.endless.is_looking(self.blocks)
        alone = self.control.state.strayed is not None or self.flow.reads_on or self.recovery.may_settle
        lanes = None if alone or looking else self.lanes
        if lanes is None or not (lane := lanes.lane_at(self.blocks)):
            return False
        done, batch, last = lane.run(self.blocks, self._until_look())
        self.blocks += done
        self.allowance.spend(0 if batch is None else len(batch))
        if batch is not None and self.run.failed is not None:
            if self.recovery.certain:
                self.watches.moves(batch)
            else:
                self._watch_in_doubt(batch.events())
        elif batch is not None:
            if len(batch) < lane.worth_a_batch:
                events = list(batch.events())
                self.watches.events(events)
                yield from events
            else:
                self.watches.moves(batch)
                yield batch
        self._broken_off = self._broken_off or (done > 0 and self._exhausted(*last))
        return done > 0

    # -- answers of the caller

    def _hear(self, event: canon.ProbeMove | canon.Input, reply: Feedback, index: int) -> bool:
        """Store the answer to `event` of line `index`; false if a probe that failed ends the program there."""
        if type(event) is canon.ProbeMove:
            assert not isinstance(reply, canon.Heard)
            fault = tripped(self.control, event, reply, meets=self.probes_meet)
            if fault is not None:
                finding = Diagnostic(code=fault.code, message=fault.message, span=event.span, hint=fault.hint)
                self._report(finding, index + 1)
            return fault is None
        heard(self.control, reply if isinstance(reply, canon.Heard) else None)
        return True

    # -- one line

    def _line(self, file: ProgramFile, index: int, text: str) -> None:
        control = self.control
        block: Block | None = None
        control.span = Span.of_line(file.name, index + 1, text, self.flow.frame.callers)
        try:
            block = file.block(index)
            if block.deleted and self.settings.block_delete:
                self.control.skip("/")
                return
            control.block_number = self.blocks
            if not block.plain:
                if block.odd is None:
                    block.odd = tuple(odd_numbers(block))
                for message, hint, place in block.odd:
                    control.warn("GS197", message, hint, place)
            self._block(block, index)
            if len(control.notes) > MOST_NOTES:
                self.hand_over_notes()
        except Fault as fault:
            self._fault(fault, file, index, text, block)
        except (OverflowError, RecursionError):
            too_large = Fault("GS123", "a value is too large to be computed with")
            self._fault(too_large, file, index, text, block)

    def _block(self, block: Block, index: int) -> None:
        if block.plain:
            self._execute(self._words(block), index)
        else:
            self._settings_and_words(block, index)

    def _settings_and_words(self, block: Block, index: int) -> None:
        control = self.control
        if block.flow is not None:
            self.flow.execute(block.flow, index)
            notes.execute_all(block.comments, control)
            control.parameters.commit()
            return
        declare(block, control)
        words = self._words(block)
        settings = evaluated(block, control.parameters)
        try:
            assign(settings, control.parameters)
            notes.execute_all(block.comments, control)
        except Fault as fault:
            if fault.at is None and settings:
                fault.at = settings[-1][2] if len(settings) == 1 else None
            control.parameters.roll_back()
            raise
        if block.words:
            self._execute(words, index)
        else:
            control.parameters.commit()

    def _words(self, block: Block) -> Words:
        control = self.control
        words = read_words(block, self.dialect, control.parameters, self.settings.m_codes, self.settings.has_cell)
        if control.state.diameter and "x" in words.values:
            words.values["x"] *= 0.5  # G7: X is a diameter, whatever uses it
        return words

    def _contour(self, number: int) -> Iterator[Words]:
        """The blocks of subroutine O`number`, which holds the contour of a cycle, as they come when it is called."""
        flow, control = self.flow, self.control
        depth, left = len(flow.frames), _MOST_OF_CONTOUR
        flow.enter_contour(number, flow.frame.at - 1)
        try:
            while len(flow.frames) > depth:
                frame, index = flow.frame, flow.frame.at
                if index >= len(frame.file.lines):
                    raise Fault("GS130", f"the contour O{number} has no `endsub`", at="q")
                frame.at = index + 1
                left -= 1
                if left < 0:
                    message = f"the contour O{number} has more than {_MOST_OF_CONTOUR} blocks"
                    raise Fault("GS106", message, hint="does a loop in it come to its end?")
                block = frame.file.block(index)
                if block.deleted and self.settings.block_delete:
                    continue
                if block.flow is not None:
                    flow.execute(block.flow, index)
                    continue
                words = self._words(block)
                assign(evaluated(block, control.parameters), control.parameters)
                if block.words:
                    yield words
        except Fault as fault:
            here = flow.frame
            if len(flow.frames) > depth:
                fault.message += f" (line {here.at} of {here.file.name}, in the contour)"
                fault.at = "q"
            while len(flow.frames) > depth:
                flow.leave()
            raise

    def _execute(self, words: Words, index: int) -> None:
        control = self.control
        if self._is_plain(words):
            try:
                execute_move(words, control)
            except (Fault, OverflowError):
                control.parameters.roll_back()
                raise
            control.parameters.commit()
            if self.run.failed is not None:
                self.recovery.settled(words)
            self._watch(control.out)
            return
        before = control.state.copy()
        tool, notes_so_far = control.spindle_tool, len(control.notes)
        try:
            if {98, 99} & set(words.m_codes):
                self._program_call(words, index)
            else:
                self._obey(words)
        except (Fault, OverflowError):
            control.state.restore(before)
            control.spindle_tool = tool
            control.parameters.roll_back()
            control.out.clear()
            control.finished = False
            del control.notes[notes_so_far:]
            raise
        control.parameters.commit()
        if self.run.failed is None:
            self.watches.block(words, control)
            return
        recovery = self.recovery
        recovery.settled(words)
        if not recovery.flow:
            self.watches.block_in_doubt(words, control, place=recovery.place, spindle=recovery.spindle)

    def _watch(self, events: Iterable[canon.Event]) -> None:
        """Show the rules events of a plain move, or of no block at all."""
        if self.run.failed is None:
            self.watches.events(events)
        else:
            self._watch_in_doubt(events)

    def _watch_in_doubt(self, events: Iterable[canon.Event]) -> None:
        recovery = self.recovery
        if not recovery.flow:
            self.watches.events_in_doubt(events, place=recovery.place, spindle=recovery.spindle)

    def _is_plain(self, words: Words) -> bool:
        return is_plain_move(words, self.control)

    def _obey(self, words: Words) -> None:
        execute(words, self.control)

    def _program_call(self, words: Words, index: int) -> None:
        """M98 and M99, which take the place of an O-word; M99 of the main program is one code among others."""
        code = words.m[STOPPING]
        in_main = len(self.flow.frames) == 1
        if code == 99 and in_main:
            self._obey(words)
            return
        if words.block.words[0][0] != "m" or words.m_codes[0] != code:
            raise Fault("GS013", f"M{code} must be the first word of its block", at=f"m{code}", hint="write it first")
        others = bool(set(words.values) - {"p", "l"} or words.g or len(words.m_codes) > 1)
        if code == 99:
            if others or words.values:
                raise Fault("GS008", "nothing else can stand in a block with the M99 of a subprogram", at="m99")
            self.flow.end_of_program()
            return
        if others:
            hint = "put it into a block of its own"
            self.control.warn("GS194", "the rest of a block with M98 is not executed", hint)
        if "p" not in words.values:
            raise Fault("GS105", "M98 needs the word P", at="m98", hint="P is the number of the program: M98 P1000")
        number = words.whole("p", "M98")
        rounds = words.whole("l", "M98")
        assert number is not None
        self.flow.call_program(number, 1 if rounds is None else rounds, index)

    # -- findings

    def _fault(self, fault: Fault, file: ProgramFile, index: int, text: str, block: Block | None) -> None:
        place = place_of(block, fault.at) if block else (fault.at if isinstance(fault.at, tuple) else None)
        span = fault.span or self.control.span
        if place is not None and fault.span is None:
            span = Span(file.name, index + 1, place[0] + 1, index + 1, max(place[1], place[0] + 1) + 1, span.callers)
        finding = Diagnostic(
            code=fault.code,
            message=fault.message,
            span=span,
            hint=fault.hint,
            value=fault.value,
            limit=fault.limit,
            unit=fault.unit,
        )
        stopped = index
        if isinstance(fault, Stopped):
            stopped = index if fault.index is None else fault.index
        if not self.recovery.is_consequence(fault, block):
            self._report(finding, stopped + 1)
        self.watches.doubt(self.recovery.after(fault, block, text))

    def _report(self, finding: Diagnostic, line: int | None) -> None:
        if finding.level >= Severity.ERROR and self.run.failed is None and (other := self._of_other_control()):
            finding = other  # the whole file is in another language: nothing else is worth reporting
            self.control.finished = self.given_up = True
        self.run.findings.add(finding, key=self.told.key_of_fault(finding))
        if finding.level >= Severity.ERROR and self.run.failed is None:
            self.run.failed = finding
            self.run.failed_line = line
            self.flow.failed = True

    def _of_other_control(self) -> Diagnostic | None:
        """What to report in place of the first error of a program for another kind of control."""
        foreign = foreign_of(self.run.source)
        return None if foreign is None else self._foreign("GS016", foreign, *FOREIGN[foreign.kind])

    def _refuse_binary(self) -> None:
        reason = why_unreadable(self.run.source)
        if reason:
            hint = "let the slicer write the file again, or write text: its settings of the printer have a switch"
            message = f"this binary G-code cannot be read: {reason}"
            self._report(Diagnostic(code="GS024", message=message, span=Span(self.file.name), hint=hint), None)
            self.control.finished = self.given_up = True

    def _tell_of_lathe(self) -> None:
        lathe = self.control.dialect.lathe
        foreign = lathe_of(self.run.source, lathe)
        if lathe is None or foreign is None or self.control.settings.turns:
            return
        finding = self._foreign(lathe.code, foreign, lathe.message, lathe.hint)
        if lathe.refused:
            self._report(finding, foreign.line)
            self.control.finished = self.given_up = True
        else:
            self.run.findings.add(finding)

    def _foreign(self, code: str, foreign: Foreign, message: str, hint: str) -> Diagnostic:
        begin = foreign.column
        span = Span(self.run.source.name, foreign.line, begin, foreign.line, begin + len(foreign.word))
        return Diagnostic(code=code, message=message.format(word=foreign.word), span=span, hint=hint)

    def hand_over_notes(self) -> None:
        """Turn warnings of blocks into findings."""
        for note in self.control.notes:
            self.run.findings.add(note, key=self.told.key_of_note(note))
        self.control.notes.clear()

    def _end_of_lines(self) -> None:
        frame = self.flow.frame
        last = len(frame.file.lines)
        while last > 1 and not frame.file.lines[last - 1].strip():
            last -= 1
        text = frame.file.source.line(last)
        span = Span.of_line(frame.file.name, last, text, frame.callers) if text else Span(frame.file.name)
        if not self.dialect.needs_end and len(self.flow.frames) == 1:
            self.control.finished = True
            self._watch([canon.EndOfFile(span=span)])
            return
        if frame.file is self.file and not self.settings.has_cell and self.file.is_subroutine:
            self._read_subroutine()
            return
        if self.recovery.ended:  # the end may be in a line that could not be read
            self.control.finished = True
            return
        if not any(line.strip() for line in frame.file.lines):
            message, hint = "the file is empty", "a program ends with M2 or M30"
        elif len(self.flow.frames) > 1:
            message, hint = "the file ends inside a subroutine", "close it with `endsub` or M99"
        elif self.file.has_percent:
            message, hint = "the program is opened by % and never closed", "end it with %, M2 or M30"
        else:
            message, hint = "the program has no end", "end it with M2 or M30"
        self._report(Diagnostic(code="GS010", message=message, span=span, hint=hint), len(frame.file.lines))

    def _read_subroutine(self) -> None:
        """A file that other programs call has no end of its own: without a caller its lines are read, not executed."""
        self.control.finished = True
        for index, text in enumerate(self.file.lines):
            self.control.span = Span.of_line(self.file.name, index + 1, text)
            try:
                self.file.block(index)
            except Fault as fault:
                self._fault(fault, self.file, index, text, None)

    def _exhausted(self, file: ProgramFile, index: int) -> bool:
        """Whether the budget of blocks or time is used up after a line of `file`; reported once."""
        if self.run.failed is None and self.endless.is_looking(self.blocks) and self.endless.repeats():
            if self._lets_probes_miss():
                return False
            period = self.endless.period
            used = self.allowance.no_end(
                f"the program never ends: after {self.blocks} blocks all is as it was {period} blocks before"
            )
        else:
            found = self.allowance.exceeded(self.blocks, self.told.faults)
            if found is None:
                return False
            used = found
        line, callers, loop = index, self.flow.frame.callers, self.endless.loop
        if loop is not None:
            file, line, callers = loop
        span = Span.of_line(file.name, line + 1, file.lines[line], callers)
        self._report(
            Diagnostic(
                code=used.code,
                message=used.message,
                span=span,
                hint=self.endless.hint(used.option) if used.option else "",
                limit=float(used.limit),
                unit=used.unit or None,
            ),
            index + 1,
        )
        return True

    def _lets_probes_miss(self) -> bool:
        """Take probes that need not trip for missing from now on, if they keep the program from its end."""
        if not self.probes_meet or self.control.not_simulated.keys().isdisjoint(MAY_MISS):
            return False
        self.probes_meet = False
        self.endless.forget()
        return True

    def _until_look(self) -> int:
        """How many blocks may be executed at once."""
        most = self.allowance.most_blocks
        return max(min(most, self.endless.next_look(self.blocks, most)) - self.blocks, 0)

    def finish(self) -> None:
        """Say what only shows at the end."""
        run, control = self.run, self.control
        recovery = self.recovery
        # faults elsewhere say nothing about O-words
        reached = control.finished and not (recovery.flow or self.given_up)
        finished = reached and not (recovery.frame or recovery.modes or recovery.parameters)
        self.hand_over_notes()
        run.findings.extend(self.watches.findings(finished=finished))
        if reached:
            run.findings.extend(structure_findings(self.file, control.span))
            run.findings.extend(unclosed_findings(self.file))
        if self.settings.presets:
            others = (file.source for file in self.flow.files.values())
            run.findings.extend(unused_presets(run.source, others, self.settings.presets))
        run.not_simulated = dict(control.not_simulated)
        run.findings.extend(not_simulated(control.not_simulated, control.dialect, probes_meet=self.probes_meet))
        run.parameters = {n: v for n, v in sorted(control.parameters.numbers.items()) if v}
        run.kept = tuple(sorted({*control.parameters.kept(), *self.settings.parameters}))
        self._show_sources()
        run.blocks = self.blocks

    def _show_sources(self) -> None:
        """The files that have been read so far."""
        self.run.sources.update({name: file.source for name, file in self.flow.files.items()})

    def _initial_path_control(self) -> None:
        """The path mode that is in force before the program's own."""
        block = self.reader.read(0, self.settings.path_control)
        words = read_words(block, DIALECTS["linuxcnc"], self.control.parameters, {}, False)
        from gcodesim.rs274.modes import path_control

        path_control(words, self.control)

    def _start_up(self) -> None:
        """Execute what is in force before the program; no line of the program says so."""
        if self.settings.startup is None:
            return
        out, before = self.control.out, len(self.control.out)
        file = self.file.of(self.settings.startup)
        for index, text in enumerate(file.lines):
            for block in self._startup_blocks(text):
                self._line(file, index, block)
        out[before:] = [replace(event, span=Span(self.file.name)) for event in out[before:]]

    def _startup_blocks(self, text: str) -> list[str]:
        """The blocks of a line of words that are in force before the program."""
        return [text] if text else []

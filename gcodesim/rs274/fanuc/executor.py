"""Running a Fanuc program: statements, macro calls and blocks of words."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.diagnostics.text import LONG
from gcodesim.rs274.block import Block
from gcodesim.rs274.dialects.linuxcnc import CANCEL, MOTION, STOPPING
from gcodesim.rs274.executor import Executor
from gcodesim.rs274.fanuc import corners
from gcodesim.rs274.fanuc import variables as numbers
from gcodesim.rs274.fanuc.arguments import arguments_of
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fanuc.execute import execute
from gcodesim.rs274.fanuc.expressions import number_of, value_of
from gcodesim.rs274.fanuc.flow import FanucFlow, ModalCall
from gcodesim.rs274.fanuc.increments import in_increments, rounded
from gcodesim.rs274.fanuc.program import FanucFile, sequence_of
from gcodesim.rs274.fanuc.vectors import BY_VECTOR
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.flow import Stopped
from gcodesim.rs274.lanes import LONG_IN_CELL, WORTH_COMPILING, Lane, Lanes, LongLanes
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.tool_point import CENTRE_POINT
from gcodesim.rs274.words import AXIS_LETTERS, Words, read_words

_MACRO_CODES = frozenset((65.0, 66.0, 66.1))
_LINE_LETTERS = frozenset("xyzabcf")
_ARC_LETTERS = _LINE_LETTERS | frozenset("ijkr")
_PLAIN_LINES, _PLAIN_ARCS = frozenset((0, 10)), frozenset((20, 30))
_NO_SCALE, _NO_MIRROR = (1.0, 1.0, 1.0), (None, None, None)


class FanucExecutor(Executor):
    """Executes blocks with Fanuc's meaning."""

    is_quick = False
    file_class: ClassVar[type[FanucFile]] = FanucFile
    file: FanucFile
    control: FanucControl
    flow: FanucFlow

    def _own_lanes(self) -> Lanes | None:
        source = self.run.source
        pays = len(source.raw) >= (LONG_IN_CELL if self.settings.has_cell else LONG)

        def open_lane(may_compile: bool) -> Lane | None:
            from gcodesim.rs274.fanuc.lane import FanucLane, is_ready  # imports numpy, and perhaps the compiler

            return FanucLane(self) if may_compile or is_ready() else None

        return LongLanes(self.settings.lane, pays, len(source.raw) >= WORTH_COMPILING, open_lane)

    def _parts(self, source: SourceText) -> tuple[FanucFile, FanucControl, FanucFlow]:
        file = self.file_class(source, self.reader)
        control = FanucControl(self.settings, self.dialect)
        return file, control, FanucFlow(control, file, self.reader, self.folders)

    def _line(self, file: ProgramFile, index: int, text: str) -> None:
        if index >= self.flow.running.part.end:
            self._end_of_part()
            self.control.finished = True
            return
        super()._line(file, index, text)
        if (number := sequence_of(text)) is not None:
            self.control.sequence = number

    def _end_of_part(self) -> None:
        """The program runs into the next one of its file, or into the end of it."""
        part = self.flow.running.part
        following = next(
            (other for other in self.file.parts if other.number is not None and other.first >= part.end), None
        )
        if following is None or following.number is None or len(self.flow.frames) > 1:
            self._end_of_lines()
            return
        file, last = self.file, part.end - 1
        while last > part.first and not file.lines[last].strip():
            last -= 1
        line = following.first + 1
        span = Span.of_line(file.name, last + 1, file.lines[last])
        hint = f"end it with M30 before line {line}, where {file.shown(following.number)} begins"
        self._report(Diagnostic(code="GS010", message="the program has no end", span=span, hint=hint), last + 1)

    def _block(self, block: Block, index: int) -> None:
        if block.slash is not None:
            block = self._up_to_slash(block, block.slash)
        if block.flow is not None or block.settings:
            self._statement(block, index)
            return
        if block.words:
            self._words_of(block if block.plain else self._resolved(block), index)

    def _up_to_slash(self, block: Block, slash: int) -> Block:
        """With the switch on, what stands behind a slash inside the block is passed over."""
        place = (slash, len(block.text.rstrip()))
        if not self.settings.block_delete:
            message = "many controls pass over what stands behind a slash inside a block, even with the switch off"
            hint = "put it into a block of its own that begins with the slash"
            self.control.warn("GS194", message, hint, place)
            return block
        self.control.skip("/", place)
        count = sum(at < slash for at, _ in block.places)
        return replace(block, words=block.words[:count], _places=block.places[:count])

    # -- statements

    def _statement(self, block: Block, index: int) -> None:
        """GOTO, IF, WHILE, DO, END, and `#i=`: one to a block and nothing beside it."""
        flow, parameters = block.flow, self.control.parameters
        then = flow is not None and flow.keyword == "then"
        if flow is not None and flow.keyword == "program" and block.words and block.places[0] < flow.place:
            number = f"{flow.label:g}" if isinstance(flow.label, float) else ""
            hint = f"is it the letter O? Write the digit 0: 0{number}"
            raise Fault("GS001", "a program number must stand first in its line", at=flow.place, hint=hint)
        alone = len(block.settings) == (1 if flow is None or then else 0)
        if block.words and not (flow is not None and flow.keyword == "program"):
            raise Fault("GS008", "a macro statement stands alone in its block", at=block.places[0])
        if not alone:
            raise Fault("GS008", "one macro statement to a block", hint="put the second into a block of its own")
        try:
            if then:
                assert flow is not None
                if number_of(flow.operands[0], parameters) != 0.0:
                    self._assign(block)
            elif flow is not None:
                self.flow.execute(flow, index)
            else:
                self._assign(block)
        except Fault as fault:
            parameters.roll_back()
            if fault.at is None and flow is not None and (flow.keyword == "goto" or not isinstance(fault, Stopped)):
                fault.at = flow.place
            raise
        parameters.commit()
        if flow is not None and flow.keyword == "program" and block.words:
            self._words_of(self._resolved(block), index)

    def _assign(self, block: Block) -> None:
        setting, parameters = block.settings[0], self.control.parameters
        try:
            number = parameters.index(number_of(setting.parameter, parameters))
            value = value_of(setting.value, parameters)
            text = block.notes[0].text.strip() if block.notes else ""
            if number == numbers.ALARM:
                raise Fault("GS190", f"the program raises alarm {3000 + round(value or 0.0)}: {text}")
            if number == numbers.STOP:
                self.control.out.append(canon.Message(span=self.control.span, text=text))
                self.control.out.append(canon.Stop(span=self.control.span))
                return
            parameters.write(number, value)
        except Fault as fault:
            fault.at = fault.at or setting.place
            raise

    # -- blocks of words

    def _resolved(self, block: Block) -> Block:
        """The block with numbers for expressions; a word with a vacant variable is no word."""
        words, places = [], []
        for (letter, node), place in zip(block.words, block.places, strict=True):
            try:
                value = value_of(node, self.control.parameters)
            except Fault as fault:
                fault.at = place
                raise
            if value is not None:
                words.append((letter, value))
                places.append(place)
        return Block(block.line, block.text, words, notes=block.notes, _places=places)

    def _words_of(self, block: Block, index: int) -> None:
        if self.control.writing:
            self.control.writing = not any(word == ("g", 11.0) for word in block.words)
            return
        calls = self.flow.running.calls
        codes = [value for letter, value in block.words if letter == "g"]
        macro = next((code for code in codes if code in _MACRO_CODES), None)
        if macro is not None:
            self._call_macro(block, index, macro)
            return
        if 67.0 in codes:
            self.flow.end_modal()
            calls = ()  # type: ignore[assignment]
        elif calls and calls[-1].every_block and not _only_calls(block):
            self.flow.call_modal(index, _arguments(block, 0, whole=True))
            return
        block = self._without_superseded(block)
        if self.control.in_increments:
            block = in_increments(block, self.control)
        block = rounded(block, self.control)
        words = read_words(block, self.dialect, self.control.parameters, self.settings.m_codes, self.settings.has_cell)
        self._execute(words, index)
        moved = any(isinstance(event, canon.Move) for event in self.control.out)
        if calls and moved and not self.control.finished and not calls[-1].every_block:
            self.flow.call_modal(index)

    def _without_superseded(self, block: Block) -> Block:
        """Of two G codes of one group the last counts, as on the control; the reader is told."""
        seen: dict[int, int] = {}
        dropped = []
        for position, (letter, value) in enumerate(block.words):
            if letter != "g":
                continue
            group = self.dialect.g_groups.get(round(value * 10.0))  # type: ignore[operator]
            if group is not None:
                if group in seen:
                    dropped.append(seen[group])
                seen[group] = position
        if not dropped:
            return block
        for at in dropped:
            group = self.dialect.g_groups[round(block.words[at][1] * 10.0)]  # type: ignore[operator]
            first, last = (f"G{block.words[position][1]:g}" for position in (at, seen[group]))
            message = f"{first} is passed over: {last} behind it is of the same group"
            self.control.warn("GS104", message, f"drop {first}", block.places[at])
        kept = [at for at in range(len(block.words)) if at not in dropped]
        places = block.places
        words = [block.words[at] for at in kept]
        return Block(block.line, block.text, words, _places=[places[at] for at in kept])  # type: ignore[arg-type]

    def _execute(self, words: Words, index: int) -> None:
        corners.check_follows(words, self.control)
        super()._execute(words, index)

    def _fault(self, fault: Fault, file: ProgramFile, index: int, text: str, block: Block | None) -> None:
        state = self.control.state
        if state.corner is not None:  # nobody knows what would have followed
            state.current, state.corner = state.corner.move.end, None
        super()._fault(fault, file, index, text, block)

    def _is_plain(self, words: Words) -> bool:
        """Whether the block is a straight move or an arc and nothing else."""
        g, state = words.g, self.control.state
        if state.polar is not None or state.corner is not None:
            return False
        if state.length_mode == BY_VECTOR or (state.length_mode in CENTRE_POINT and not state.point_control):
            return False
        motion = g.get(MOTION, state.motion)
        if words.m or len(g) > (MOTION in g) or CANCEL in g or state.side:
            return False
        letters = words.values.keys()
        if motion in _PLAIN_LINES:
            fits = letters <= _LINE_LETTERS
        elif motion in _PLAIN_ARCS:
            fits = letters <= _ARC_LETTERS
        else:
            return False
        return fits and state.scale == _NO_SCALE and state.mirror == _NO_MIRROR and not AXIS_LETTERS.isdisjoint(letters)

    def _obey(self, words: Words) -> None:
        execute(words, self.control, _points(words.block))
        self.control.state.last_m = next(reversed(words.m_codes), self.control.state.last_m)

    def _program_call(self, words: Words, index: int) -> None:
        """M98 and M99, after everything else in the block."""
        code = words.m.pop(STOPPING)
        words.m_codes.remove(code)
        values = words.values
        number = values.pop("p", None)
        rounds = words.whole("l", "M98")
        values.pop("l", None)
        if code == 98 and number is None:
            raise Fault("GS105", "M98 needs the word P", at="m98", hint="P is the number of the program: M98 P1000")
        if values or words.g or words.m:
            self._obey(words)
        if code == 99:
            self.flow.end_of_program(None if number is None else round(number))
            return
        assert number is not None
        self.flow.call_program(*self.flow.repeats_of(number, rounds), index)

    # -- macros

    def _call_macro(self, block: Block, index: int, code: float) -> None:
        """G65, G66, G66.1: everything after the code is an argument, but for P and L."""
        name = f"G{code:g}"
        at = next(i for i, (letter, value) in enumerate(block.words) if letter == "g" and value == code)
        words, places = block.words, block.places
        if at:
            before = Block(block.line, block.text, words[:at], _places=places[:at])
            self._execute(read_words(before, self.dialect, self.control.parameters, {}, False), index)
        given = dict(words[at + 1 :])
        if self.control.state.corner is not None:
            corners.check_follows(Words(block), self.control)
        if "p" not in given:
            raise Fault("GS105", f"{name} needs the word P", at=places[at], hint="P is the number of the program")
        number, rounds = given["p"], given.get("l", 1.0)
        arguments = _arguments(block, at + 1, whole=False)
        if code == 65.0:
            self.flow.call_macro(round(number), round(rounds), arguments, index)  # type: ignore[arg-type]
        else:
            self.flow.begin_modal(
                ModalCall(
                    number=round(number),  # type: ignore[arg-type]
                    rounds=round(rounds),  # type: ignore[arg-type]
                    arguments=arguments,
                    every_block=code == 66.1,
                )
            )


def _arguments(block: Block, first: int, *, whole: bool) -> dict[int, float]:
    chosen = [
        (word, place)
        for word, place in zip(block.words[first:], block.places[first:], strict=True)
        if whole or word[0] not in "pl"
    ]
    return arguments_of([w for w, _ in chosen], [p for _, p in chosen], whole=whole)  # type: ignore[misc]


def _only_calls(block: Block) -> bool:
    """Blocks that end or call programs are no arguments of G66.1."""
    return any(letter == "m" and value in (98.0, 99.0, 2.0, 30.0) for letter, value in block.words)


def _points(block: Block) -> dict[str, bool]:
    """For each letter whether its number was written with a point, or computed."""
    return {
        letter: any(char in block.text[first:last] for char in ".#[")
        for (letter, _), (first, last) in zip(block.words, block.places, strict=True)
    }

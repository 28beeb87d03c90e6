"""O-words, M98 and M99: where the program goes on."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from pathlib import Path

from gcodesim.diagnostics import Caller, SourceText
from gcodesim.rs274.block import KEYWORDS, Expression, Flow, Name
from gcodesim.rs274.control import Control
from gcodesim.rs274.expressions import checked, loose
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.frame import Frame, Label
from gcodesim.rs274.parameters import MOST_ARGUMENTS, NO_ARGUMENTS
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.reader import Reader
from gcodesim.rs274.saved import bring_back
from gcodesim.rs274.words import read_words

MOST_LEVELS = 10
_NEEDS_ONE = frozenset(("if", "elseif", "while", "repeat"))
_MAY_HAVE_ONE = frozenset(("return", "endsub"))
LOCAL_WORDS = frozenset(KEYWORDS) - {"sub", "endsub", "call", "return"}  # their labels belong to one subroutine


class Stopped(Fault):
    """A fault after which a control has no next line; `index` is the line that it was reading."""

    def __init__(self, code: str, message: str, *, index: int | None = None, hint: str = "") -> None:
        super().__init__(code, message, hint=hint)
        self.index = index


class FlowControl:
    """The stack of running subroutines, their labels, and the jumps between lines."""

    def __init__(self, control: Control, main: ProgramFile, reader: Reader, folders: tuple[Path, ...]) -> None:
        self.control = control
        self.reader = reader
        self.folders = folders
        self.files: dict[str, ProgramFile] = {main.name: main}
        self.frames: list[Frame] = [Frame(main, main.first)]
        self.subs: dict[str, tuple[ProgramFile, int]] = {}
        self.programs: dict[str, tuple[ProgramFile, int]] = {}
        self.labels: dict[tuple[str, str, str], Label] = {}
        self.touched: set[tuple[str, str, str]] = set()  # labels opened since the compiled lane took them over
        self.changes = 0
        """Counts the O-words and calls, for those who keep a copy of what they change."""
        self.loop: tuple[ProgramFile, int] | None = None  # the line last jumped back to
        self.entered: set[tuple[str, int]] = set()  # subroutines that were called since the first fault
        self.failed = False  # whether the program is only read on for its further faults
        self.taken = True  # whether a branch of the `if` at hand was taken
        self.breaking = False
        self.continuing = False
        self.arrived = False  # the line at hand was reached by leaving a branch

    @property
    def frame(self) -> Frame:
        return self.frames[-1]

    @property
    def reads_on(self) -> bool:
        """Whether the rest of a program with calls is only read for further faults, each subroutine once."""
        return self.failed and self._has_calls

    @cached_property
    def _has_calls(self) -> bool:
        return any(flow.keyword == "call" for flow in self.frames[0].file.flows)

    # -- O-words

    def execute(self, flow: Flow, index: int) -> None:
        """Execute the O-word of the current line, and set where to go on."""
        self.changes += 1
        arrived, self.arrived = self.arrived, False
        label = self._label(flow.label)
        self._check_operands(flow)
        if not flow.keyword:
            self._program_number(label, index)
            return
        _COMMANDS[flow.keyword](self, label, flow, index, arrived)

    def _label(self, node: Expression) -> str:
        if isinstance(node, Name):
            return node.name
        value = checked(node, self.control.parameters)
        if abs(value - round(value)) > 1e-4 or value < 0:
            raise Fault("GS008", f"O{value:g} is no label: the number must be whole")
        return str(round(value))

    def _check_operands(self, flow: Flow) -> None:
        count = len(flow.operands)
        if flow.keyword in _NEEDS_ONE and count != 1:
            raise Fault(
                "GS008", f"`{flow.keyword}` needs one expression in brackets", hint=f"o1 {flow.keyword} [#1 LT 10]"
            )
        if flow.keyword == "call":
            if count > MOST_ARGUMENTS:
                raise Fault(
                    "GS133", f"{count} arguments; a call takes {MOST_ARGUMENTS}", value=count, limit=MOST_ARGUMENTS
                )
        elif flow.keyword not in _NEEDS_ONE and count > (flow.keyword in _MAY_HAVE_ONE):
            raise Fault("GS008", f"`{flow.keyword}` takes no expression")

    def _key(self, label: str) -> tuple[str, str, str]:
        return (self.frame.file.name, self.frame.name, label)

    def _open(self, label: str, kind: str, index: int) -> Label:
        key = self._key(label)
        known = self.labels.get(key)
        if known is not None and known.index != index:
            raise Fault(
                "GS130",
                f"the label {show(label)} is used twice: it opened `{known.kind}` in line {known.index + 1}",
                hint="give each if, while, do and repeat its own label",
            )
        if known is None:
            known = self.labels[key] = Label(kind, index)
        self.touched.add(key)
        return known

    def _opened(self, label: str, keyword: str, *kinds: str) -> Label:
        known = self.labels.get(self._key(label))
        if known is None or known.kind not in kinds:
            wanted = " or ".join(f"`{kind}`" for kind in kinds)
            raise Fault(
                "GS130",
                f"`{keyword}` {show(label)} has no {wanted} before it",
                hint="labels must be the same and must nest",
            )
        return known

    def _skip_to(self, label: str, index: int, *keywords: str) -> None:
        """Go on at the next O-word of `label`, which should have one of `keywords`; lines in between are not read."""
        found = self.frame.file.find_flow(index, label, LOCAL_WORDS)
        self._pass_over(self.frame.file, index, None if found is None else found.at)
        if found is None:
            last = len(self.frame.file.lines) - 1
            wanted = " or ".join(f"`{k}`" for k in keywords)
            raise Stopped("GS130", f"{show(label)} is never closed: no {wanted} follows", index=last)
        self.frame.at = found.at
        self.arrived = True

    def _pass_over(self, file: ProgramFile, after: int, before: int | None, *, defining: bool = False) -> None:
        """Raise `Stopped` at the first line between two that is broken even for a control that skips it."""
        found = file.skipped.first(
            after,
            len(file.lines) if before is None else before,
            defining=defining,
            call=lambda index: self._broken_call(file, index),
        )
        if found is not None:
            index, fault = found
            message = f"line {index + 1}, which is passed over, cannot be read: {fault.message}"
            raise Stopped(fault.code, message, index=index, hint=fault.hint)

    def _broken_call(self, file: ProgramFile, index: int) -> Fault | None:
        """What is wrong with the words of a line with M98, which are computed even if the line is skipped."""
        control = self.control
        try:
            block = file.block(index)
            if block.deleted and control.settings.block_delete:
                return None
            words = read_words(block, control.dialect, control.parameters, control.settings.m_codes, False)
            if "p" not in words.values:
                return Fault("GS105", "M98 needs the word P")
            words.whole("p", "M98")
        except Fault as fault:
            return fault
        return None

    def _back_to(self, index: int) -> None:
        """Go on at an earlier line; after a fault once through the text is enough, and what counts may be in doubt."""
        if self.failed:
            return
        self.frame.at = index
        self.loop = (self.frame.file, index)

    def _test(self, flow: Flow) -> float:
        return loose(flow.operands[0], self.control.parameters)

    # branches

    def _if(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del arrived
        holds = self._test(flow) != 0.0
        self._open(label, "if", index)
        self._branch(label, index, taken=holds)

    def _branch(self, label: str, index: int, *, taken: bool) -> None:
        self.taken = taken
        if not taken:
            self._skip_to(label, index, "elseif", "else", "endif")

    def _elseif(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del arrived
        holds = self._test(flow) != 0.0  # computed in any case, so that a fault in it is one
        self._opened(label, "elseif", "if")
        if self.taken:
            self._skip_to(label, index, "endif")
        else:
            self._branch(label, index, taken=holds)

    def _else(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del flow
        self._opened(label, "else", "if")
        if self.taken:
            self._skip_to(label, index, "endif")
        self.taken = self.taken or arrived

    def _endif(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del flow, index, arrived
        self._opened(label, "endif", "if")
        self.taken = True  # this very line would not run if an outer branch had not been taken

    # loops; a skip stops at every O-word of its label, which then acts as on a control that is skipping

    def _while(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        holds = self._test(flow) != 0.0
        known = self.labels.get(self._key(label))
        if known is not None and known.kind == "do":
            broken, self.breaking = self.breaking, False
            if not broken and holds:
                self._back_to(known.index)
            return
        self._open(label, "while", index)
        if not holds:
            self._skip_to(label, index, "endwhile")

    def _endwhile(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del flow, index
        self._end_of_loop(self._opened(label, "endwhile", "while"), arrived)

    def _end_of_loop(self, known: Label, arrived: bool) -> None:
        continues = self.continuing
        if arrived:
            self.continuing = False
        if not arrived or continues:
            self._back_to(known.index)

    def _do(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del flow, arrived
        self._open(label, "do", index)

    def _repeat(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del arrived
        value = self._test(flow)
        count = round(value) if math.isfinite(value) else 0
        known = self._open(label, "repeat", index)
        rounds = count if known.left is None else known.left
        self.labels[self._key(label)] = replace(known, left=rounds - 1 if rounds > 0 else None)
        if rounds <= 0:
            self._skip_to(label, index, "endrepeat")

    def _endrepeat(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del flow, index
        self._end_of_loop(self._opened(label, "endrepeat", "repeat"), arrived)

    def _leave_repeat(self, label: str, index: int, arrived: bool) -> None:
        """A `break` or `continue` of a `repeat`, which is refused, must not keep reading in a loop that has ended."""
        known = self.labels.get(self._key(label))
        if arrived and known is not None and known.kind == "repeat":
            self._skip_to(label, index, "endrepeat")

    def _break(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del flow
        self._leave_repeat(label, index, arrived)
        known = self._opened(label, "break", "while", "do")
        # as on the control, only the `while` that closes a `do` takes this back: after a `break` out of a
        # `while` … `endwhile`, or one passed over when such a loop ends, the next `do` runs once
        self.breaking = True
        self._skip_to(label, index, "while" if known.kind == "do" else "endwhile")

    def _continue(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del flow
        self._leave_repeat(label, index, arrived)
        known = self._opened(label, "continue", "while", "do")
        if not arrived:
            self.continuing = True
        self._skip_to(label, index, "while" if known.kind == "do" else "endwhile")

    # subroutines

    def _sub(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del flow, arrived
        frame = self.frame
        if frame.by_m98:
            raise Fault("GS130", f"the subroutine {show(label)} begins inside a program called by M98")
        if len(self.frames) > 1:
            # as on the control, only the main program defines: one inside another is executed in passing
            if label != self.frame.name:
                message = f"the subroutine {show(label)} stands inside {show(self.frame.name)}, which was called"
                hint = "its lines are executed in passing; LinuxCNC 2.10 refuses them: define it in the main program"
                self.control.warn("GS130", message, hint)
            return
        known = self.subs.get(label)
        if known is not None:
            if known == (frame.file, index):
                message = f"the program runs into the subroutine {show(label)} once more"
                hint = "define subroutines where the program passes once, or after its end"
            else:
                message = f"the subroutine {show(label)} is defined twice"
                hint = f"the first time in {known[0].name}, line {known[1] + 1}"
            raise Fault("GS130", message, hint=hint)
        self.subs[label] = (frame.file, index)
        for inner in frame.file.flows:
            if inner.at > index:
                if inner.keyword in ("return", "endsub") and inner.label == label:
                    self._pass_over(frame.file, index, inner.at, defining=True)
                    self._return_while_defining(frame.file, inner.at)
                if inner.keyword == "endsub" and inner.label == label:
                    frame.at = inner.at + 1
                    return
                if inner.keyword in ("sub", ""):
                    self._pass_over(frame.file, index, inner.at, defining=True)
                    raise Stopped(
                        "GS130",
                        f"a subroutine inside the subroutine {show(label)}",
                        index=inner.at,
                        hint="close the first one",
                    )
        self._pass_over(frame.file, index, None, defining=True)
        last = len(frame.file.lines) - 1
        raise Stopped("GS130", f"the subroutine {show(label)} is never closed: no `endsub` follows", index=last)

    def _return_while_defining(self, file: ProgramFile, index: int) -> None:
        """As on the control, the value of a `return` or `endsub` is computed where its subroutine is defined, too."""
        control = self.control
        try:
            flow = file.block(index).flow
            operands = () if flow is None else flow.operands
            value = loose(operands[0], control.parameters) if operands else 0.0
        except Fault as fault:
            if fault.code in ("GS008", "GS120"):  # more text follows it, or a name has no value yet
                return
            message = f"line {index + 1} cannot be computed where its subroutine is defined: {fault.message}"
            raise Stopped(fault.code, message, index=index, hint=fault.hint) from None
        control.returned, control.value_returned = value, bool(operands)

    def _endsub(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del index, arrived
        if len(self.frames) == 1 or self.frame.by_m98:  # as on the control, the label is not checked
            raise Fault("GS130", f"`endsub` {show(label)} has no `sub` before it")
        self._return(flow)

    def _return_word(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del index, arrived
        if len(self.frames) == 1 or self.frame.by_m98:
            raise Fault("GS130", f"`return` {show(label)} outside a subroutine")
        self._return(flow)

    def _return(self, flow: Flow) -> None:
        control = self.control
        value = loose(flow.operands[0], control.parameters) if flow.operands else None
        self.leave()
        control.returned = value or 0.0
        control.value_returned = value is not None

    def _leave(self, frame: Frame) -> None:
        self.control.sub_level = len(self.frames) - 1
        self.control.frames = self.frames
        if frame.restores and frame.saved is not None:
            bring_back(self.control, frame.saved, frame.saved_g92)

    def _call(self, label: str, flow: Flow, index: int, arrived: bool) -> None:
        del arrived
        control = self.control
        arguments = [loose(node, control.parameters) for node in flow.operands]
        file, first = self._find(label, index, by_m98=False)
        if self.was_read(file, first):
            return
        self._enter_with_own_parameters(file, first, label, index)
        control.parameters.set_first((*arguments, *NO_ARGUMENTS[len(arguments) :]))
        control.returned, control.value_returned = 0.0, False

    def enter_contour(self, number: int, index: int) -> None:
        """Go into the subroutine with the contour of a cycle, as a call without arguments from line `index`."""
        file, first = self._find(str(number), index, by_m98=False)
        self._enter_with_own_parameters(file, first, str(number), index)

    def _enter_with_own_parameters(self, file: ProgramFile, first: int, label: str, index: int) -> None:
        """Go into a subroutine; the caller's parameters are kept until it is left."""
        self._enter(file, first, label, index)
        frame, parameters = self.frame, self.control.parameters
        frame.arguments, frame.named = parameters.first(), parameters.locals
        parameters.locals = {}

    def leave(self) -> None:
        """Leave the running subroutine, and give its caller its parameters back."""
        frame = self.frames.pop()
        self.control.parameters.set_first(frame.arguments)
        self.control.parameters.locals = frame.named
        self._leave(frame)

    def was_read(self, file: ProgramFile, first: int) -> bool:
        """Whether a subroutine need not be called: after a fault each is read once, for its own faults."""
        if not self.failed:
            return False
        where = (file.name, first)
        known = where in self.entered
        self.entered.add(where)
        return known

    def _enter(self, file: ProgramFile, first: int, label: str, index: int) -> None:
        self.enter(Frame(file, first, name=label, first=first), show(label), index)

    def enter(self, frame: Frame, name: str, index: int) -> None:
        """Go into what line `index` calls by `name`."""
        if len(self.frames) >= MOST_LEVELS:
            raise Stopped(
                "GS132",
                f"subroutines are called more than {MOST_LEVELS - 1} deep",
                hint="a subroutine that calls itself needs an `if` that ends it",
                index=self.frames[0].at - 1,  # a control falls back to the main program here
            )
        caller = Caller(self.frame.file.name, index + 1, name)
        frame.callers = (*self.frame.callers, caller)
        self.frames.append(frame)
        self.control.sub_level = len(self.frames) - 1
        self.control.frames = self.frames

    def leave_file(self) -> Frame:
        """Leave what was called, and go on behind the call."""
        frame = self.frames.pop()
        self._leave(frame)
        return frame

    def _find(self, label: str, index: int, *, by_m98: bool) -> tuple[ProgramFile, int]:
        """File and line index of a subroutine or program: known, in a file of its name, or further down.

        The control looks for both kinds at once and refuses the wrong one where it finds it.
        """
        known = (self.programs if by_m98 else self.subs).get(label)
        if known is not None:
            return known
        own = self._file_of(label)
        file, after = (self.frame.file, index) if own is None else (own, -1)
        found = file.find_flow(after, label, frozenset(("sub", "")))
        self._pass_over(file, after, None if found is None else found.at)
        if found is None:
            what = f"program O{label}" if by_m98 else f"subroutine {show(label)}"
            if own is not None:
                hint = f"it must begin with O{label}" if by_m98 else f"it must begin with {show(label)} sub"
                message = f"{own.name} holds no {what}"
            else:
                message = f"there is no {what}"
                hint = (
                    f"begin it with a line O{label}"
                    if by_m98
                    else self._near_sub(label)
                    or (f"define it with `{show(label)} sub`, or put {label}.ngc beside the program")
                )
            raise Stopped("GS131", message, index=len(file.lines) - 1, hint=hint)
        if by_m98 and found.keyword == "sub":
            hint = f"call it by `{show(label)} call`"
            raise Stopped("GS131", f"{show(label)} is no program for M98", index=found.at, hint=hint)
        if not by_m98 and found.keyword == "":
            raise Stopped(
                "GS131", f"O{label} is a program for M98, no subroutine", index=found.at, hint=f"M98 P{label}"
            )
        (self.programs if by_m98 else self.subs)[label] = (file, found.at)
        return file, found.at

    def _near_sub(self, label: str) -> str:
        from difflib import get_close_matches

        names = sorted({flow.label for flow in self.frame.file.flows if flow.keyword == "sub"})
        near = get_close_matches(label, names, n=1)
        return f"did you mean {show(near[0])}?" if near else ""

    def _file_of(self, label: str) -> ProgramFile | None:
        """The file `label`.ngc of a subroutine folder; names are letters, digits and a few signs, never a path."""
        if not label or any(char in label for char in "/\\:\0") or label.startswith("."):
            return None
        name = f"{label}.ngc"
        if name not in self.files:
            source = self.source_of(name)
            if source is None:
                return None
            self.files[name] = ProgramFile(source, self.reader)
        return self.files[name]

    def source_of(self, name: str) -> SourceText | None:
        """The text of file `name`, a path inside one of the folders; None where none of them has it."""
        for folder in self.folders:
            path = folder / name
            try:
                if path.is_file() and self._is_within(path):
                    return SourceText.read(path, name)
            except OSError:
                continue
        return None

    def _is_within(self, path: Path) -> bool:
        """Whether a file of a folder is in it or in another one of them, and not a link to somebody else's file."""
        real = Path(os.path.realpath(path))
        return any(real.is_relative_to(os.path.realpath(folder)) for folder in self.folders)

    # M98 and M99

    def _program_number(self, label: str, index: int) -> None:
        """A bare O1000: nothing to do; a program for M98 begins here."""
        del index
        if len(self.frames) > 1 and not self.frame.by_m98:
            raise Fault("GS130", f"O{label} begins a program for M98 inside an O-word subroutine")

    def call_program(self, number: int, rounds: int, index: int) -> None:
        """M98 P L."""
        self.changes += 1
        label = str(number)
        if rounds <= 0:  # as on the control, a level is entered without going anywhere
            message = "M98 with L0 calls nothing, but the next M99 comes back to here, as on the control"
            self.control.warn("GS194", message, hint="leave the block out")
            self._enter(self.frame.file, index + 1, label, index)
            self.frame.by_m98 = True
            return
        file, first = self._find(label, index, by_m98=True)
        if self.was_read(file, first):
            return
        self._enter(file, first + 1, label, index)
        self.frame.by_m98 = True
        self.frame.first = first
        self.frame.rounds = rounds

    def end_of_program(self) -> None:
        """M99 of a subprogram: the next round of an M98, or back to the caller."""
        self.changes += 1
        frame = self.frame
        if not frame.by_m98:
            raise Fault("GS130", "M99 inside an O-word subroutine", at="m99", hint="use `return` or `endsub`")
        frame.rounds -= 1
        if frame.rounds > 0 and not self.failed:
            self._back_to(frame.first + 1)
            return
        self.leave_file()


def show(label: str) -> str:
    """A label as written: o100, o<name>."""
    return f"o{label}" if label.isdigit() else f"o<{label}>"


_COMMANDS: dict[str, Callable[[FlowControl, str, Flow, int, bool], None]] = {
    "if": FlowControl._if,
    "elseif": FlowControl._elseif,
    "else": FlowControl._else,
    "endif": FlowControl._endif,
    "while": FlowControl._while,
    "endwhile": FlowControl._endwhile,
    "do": FlowControl._do,
    "repeat": FlowControl._repeat,
    "endrepeat": FlowControl._endrepeat,
    "break": FlowControl._break,
    "continue": FlowControl._continue,
    "sub": FlowControl._sub,
    "endsub": FlowControl._endsub,
    "return": FlowControl._return_word,
    "call": FlowControl._call,
}

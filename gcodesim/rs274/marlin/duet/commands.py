"""The commands that decide which lines are executed, and with what."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Final, NamedTuple, cast

from gcodesim import canon
from gcodesim.rs274.block import ColumnRange
from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.marlin.duet.blocks import IndentedBlocks, indent_of
from gcodesim.rs274.marlin.duet.frame import BlockFrame
from gcodesim.rs274.marlin.duet.object_model import ObjectModel
from gcodesim.rs274.marlin.duet.syntax import Node, Value, parsed
from gcodesim.rs274.marlin.duet.values import evaluate, number, shown, truth

if TYPE_CHECKING:
    from gcodesim.rs274.flow import FlowControl
    from gcodesim.rs274.marlin.printer_file import PrinterFile

_COMMAND = re.compile(r"[ \t]*(if|elif|else|while|break|continue|var|global|set|echo|abort|skip)(?=[ \t{\"(;]|$)")
_HAS_COMMAND = re.compile(rb"^[ \t]*(?:if|while|var|global|set|echo|abort)[ \t{\"(]", re.MULTILINE)
_TARGET = re.compile(r"[ \t]*(var|global)\.([A-Za-z][A-Za-z0-9_]*)[ \t]*")
_NAME = re.compile(r"[ \t]*([A-Za-z][A-Za-z0-9_]*)[ \t]*=(?!=)")
_WRITES = re.compile(r"[ \t]*>")
_END = re.compile(r"[ \t]*$")


class MetaCommand(NamedTuple):
    """A command, where it stands, and its line up to a comment."""

    name: str
    place: ColumnRange
    code: str


def has_commands(raw: bytes) -> bool:
    """Whether a program decides anything by itself."""
    return _HAS_COMMAND.search(raw) is not None


def code_of(text: str) -> str:
    """A line up to its comment; a semicolon in quotes begins none."""
    if ";" not in text:
        return text
    quoted = False
    for at, char in enumerate(text):
        if char == '"':
            quoted = not quoted
        elif char == ";" and not quoted:
            return text[:at]
    return text


def command_of(text: str) -> MetaCommand | None:
    """The command of a line; None for any other line."""
    found = _COMMAND.match(text)
    return None if found is None else MetaCommand(found[1], found.span(1), code_of(text))


class Interpreter:
    """Carries out the commands of a program and of the macros that it calls, and knows the values of its names."""

    def __init__(self, control: Control, flow: FlowControl, machine: ObjectModel) -> None:
        self.control = control
        self.flow = flow
        self.machine = machine
        self.index = 0
        self._globals: dict[str, Value] = {}

    def frame_of(self, file: PrinterFile) -> BlockFrame:
        """A file about to be executed."""
        return BlockFrame(file, file.first, blocks=IndentedBlocks(self._globals, counts=file.counts_rounds))

    @property
    def frame(self) -> BlockFrame:
        """The file that is executed."""
        return cast(BlockFrame, self.flow.frame)

    @property
    def blocks(self) -> IndentedBlocks:
        return self.frame.blocks

    @property
    def is_outside(self) -> bool:
        """Whether the line at hand is one of the main program, and no command decides about it."""
        return len(self.flow.frames) == 1 and (not self.frame.file.decides or self.blocks.is_outside)

    def execute(self, command: MetaCommand, index: int) -> None:
        """Carry out the command of line `index`; raises `Fault`."""
        self.index = index
        try:
            _COMMANDS[command.name](self, command)
        except Fault as fault:
            if fault.at is None:
                fault.at = (command.place[0], len(command.code.rstrip()))
            raise

    def arrives(self, index: int, text: str) -> bool:
        """Come to line `index`; false if it is passed over, or the program goes on elsewhere."""
        if not self.frame.file.decides:
            return True
        if not code_of(text).strip():
            return not self.blocks.is_passing_over
        return self._goes_on(self.blocks.arrive(indent_of(text), once=self.flow.failed))

    def ends(self) -> bool:
        """Come to the end of the file; false if a loop goes back from there."""
        return not self.frame.file.decides or self._goes_on(self.blocks.arrive(0, once=self.flow.failed))

    def _goes_on(self, back: int | None) -> bool:
        if back is not None and back >= 0:
            self.go_to(back)
        return back is None

    def go_to(self, index: int) -> None:
        """Go on at the line of a loop."""
        self.flow.frame.at = index
        self.flow.loop = self.flow.frame.file, index

    def expression(self, code: str, begin: int) -> tuple[Value, int]:
        """The value of the expression at an offset, and the offset behind it."""
        node, end = parsed(code, begin)
        return evaluate(node, self), end

    def only(self, code: str, begin: int) -> Node:
        """The expression that the rest of a line is."""
        node, end = parsed(code, begin)
        if _END.match(code, end) is None:
            raise Fault("GS006", f"`{code[end:].strip()[:20]}` stands behind the expression")
        return node

    # -- names

    def value(self, path: tuple[str | int, ...]) -> Value:
        """The value of a name; raises `Fault` where it has none here."""
        first = path[0]
        if path == ("pi",):
            return 3.141592653589793
        if path == ("iterations",):
            return self.blocks.rounds
        if path == ("line",):
            return self.index + 1
        if path == ("result",):
            return 0
        if first in ("var", "global", "param") and len(path) > 1:
            known = self._variables(str(first), str(path[1]))
            if known is None:
                raise Fault("GS120", f"{first}.{path[1]} has no value", hint=_GIVE[str(first)].format(path[1]))
            return _item(known[str(path[1])], path[2:], f"{first}.{path[1]}")
        return self.machine.value(path)

    def exists(self, path: tuple[str | int, ...]) -> bool:
        if path[0] in ("var", "global", "param") and len(path) == 2:
            return self._variables(str(path[0]), str(path[1])) is not None
        return self.machine.exists(path)

    def _variables(self, scope: str, name: str) -> Mapping[str, Value] | None:
        """The names of a scope among which `name` is; None where it has no value."""
        if scope != "param":
            return self.blocks.known(scope, name)
        return self.frame.given if name in self.frame.given else None


_GIVE: Final = {
    "var": "`var {} = …` comes first",
    "global": "`global {} = …` comes first",
    "param": 'the call gives it: M98 P"file.g" {}1',
}


def _item(value: Value, indices: tuple[str | int, ...], name: str) -> Value:
    for index in indices:
        if type(value) is not tuple or type(index) is not int or index >= len(value):
            raise Fault("GS123", f"{name} has no element [{index}]")
        value = value[index]
    return value


def _with_item(value: Value, indices: list[int], new: Value, name: str) -> Value:
    if not indices:
        return new
    _item(value, (indices[0],), name)
    assert type(value) is tuple
    at = indices[0]
    return (*value[:at], _with_item(value[at], indices[1:], new, name), *value[at + 1 :])


# -- commands


def _holds(do: Interpreter, command: MetaCommand, otherwise: Callable[[bool], None]) -> None:
    """Look at the condition and hand on whether it holds; a condition with a fault does not."""
    try:
        holds = truth(do.only(command.code, command.place[1]), do)
    except Fault:
        otherwise(False)
        raise
    otherwise(holds)


def _if(do: Interpreter, command: MetaCommand) -> None:
    _holds(do, command, do.blocks.choose)


def _elif(do: Interpreter, command: MetaCommand) -> None:
    if do.blocks.asks("elif"):
        _holds(do, command, do.blocks.choose)


def _else(do: Interpreter, command: MetaCommand) -> None:
    _nothing_behind(command)
    if do.blocks.asks("else"):
        do.blocks.otherwise()


def _while(do: Interpreter, command: MetaCommand) -> None:
    do.blocks.loop(do.index)
    _holds(do, command, do.blocks.leave_unless)


def _break(do: Interpreter, command: MetaCommand) -> None:
    _nothing_behind(command)
    do.blocks.leave_loop("break")


def _continue(do: Interpreter, command: MetaCommand) -> None:
    _nothing_behind(command)
    if do.flow.failed:
        do.blocks.leave_loop("continue")
    else:
        do.go_to(do.blocks.next_round())


def _nothing_behind(command: MetaCommand) -> None:
    rest = command.code[command.place[1] :].strip()
    if rest:
        raise Fault("GS006", f"`{rest[:20]}` stands behind `{command.name}`, which takes nothing")


def _define(do: Interpreter, command: MetaCommand) -> None:
    found = _NAME.match(command.code, command.place[1])
    if found is None:
        raise Fault("GS007", f"`{command.name}` takes a new name, `=` and a value", hint=f"{command.name} depth = 2.5")
    value = evaluate(do.only(command.code, found.end()), do)
    do.blocks.define(command.name, found[1], value)


def _set(do: Interpreter, command: MetaCommand) -> None:
    code = command.code
    found = _TARGET.match(code, command.place[1])
    if found is None:
        raise Fault("GS007", "`set` takes var.NAME or global.NAME, `=` and a value", hint="set var.depth = 2.5")
    scope, name, at = found[1], found[2], found.end()
    known = do.blocks.known(scope, name)
    if known is None:
        raise Fault("GS120", f"{scope}.{name} has no value", hint=f"`{scope} {name} = …` comes first")
    indices = []
    while code[at : at + 1] == "[":
        index, end = do.expression(code, at + 1)
        if type(index) is not int or index < 0 or code[end : end + 1] != "]":
            raise Fault("GS007", f"an index is a whole number from 0 on, not {shown(index)}")
        indices.append(index)
        at = end + 1 + len(code[end + 1 :]) - len(code[end + 1 :].lstrip())
    if code[at : at + 1] != "=":
        raise Fault("GS007", f"`=` is expected behind {scope}.{name}")
    value = evaluate(do.only(code, at + 1), do)
    known[name] = _with_item(known[name], indices, value, f"{scope}.{name}")


def _echo(do: Interpreter, command: MetaCommand) -> None:
    if _WRITES.match(command.code, command.place[1]):
        do.control.skip("echo >", command.place)
        return
    texts, at = [], command.place[1]
    while True:
        value, at = do.expression(command.code, at)
        texts.append(shown(value))
        rest = command.code[at:].lstrip()
        if not rest:
            break
        if rest[0] != ",":
            raise Fault("GS006", f"`{rest[:20]}` stands behind the expression")
        at = command.code.index(",", at) + 1
    do.control.out.append(canon.Print(span=do.control.span, text=" ".join(texts)))


def _abort(do: Interpreter, command: MetaCommand) -> None:
    rest = command.code[command.place[1] :].strip()
    text = shown(evaluate(do.only(command.code, command.place[1]), do)) if rest else ""
    raise Fault("GS190", f"the program asks to stop{f': {text}' if text else ''}")


def _nothing(do: Interpreter, command: MetaCommand) -> None:
    """`skip`, which only marks a line."""


_COMMANDS: Final[dict[str, Callable[[Interpreter, MetaCommand], None]]] = {
    "if": _if,
    "elif": _elif,
    "else": _else,
    "while": _while,
    "break": _break,
    "continue": _continue,
    "var": _define,
    "global": _define,
    "set": _set,
    "echo": _echo,
    "abort": _abort,
    "skip": _nothing,
}


# -- expressions in words


class Filled(NamedTuple):
    """A line with numbers in place of its `{…}`; `steps` say where its columns and those of the line part."""

    text: str
    steps: tuple[tuple[int, int], ...]

    def place(self, place: ColumnRange) -> ColumnRange:
        """Columns of the filled line as columns of the line itself."""
        return self._column(place[0], begins=True), self._column(place[1], begins=False)

    def _column(self, at: int, *, begins: bool) -> int:
        shift = 0
        for own, further in self.steps:
            if at > own or (at == own and not begins):
                shift = further
        return at + shift


def filled(text: str, do: Interpreter, index: int) -> Filled:
    """The line with the value of each `{…}` in its place; raises `Fault`."""
    do.index = index
    code = code_of(text)
    moves = code.lstrip()[:1] in ("G", "g")
    out, steps, at, length = [], [], 0, 0
    while True:
        begin = _brace(code, at)
        if begin < 0:
            break
        try:
            value, end = do.expression(code, begin)
        except Fault as fault:
            fault.at = fault.at or (begin, _behind(code, begin))
            raise
        written = value if type(value) is str and not moves else _digits(value)
        out += [code[at:begin], written]
        length += begin - at + len(written)
        at = end
        steps.append((length, at - length))
    return Filled("".join([*out, text[at:]]), tuple(steps))


def _digits(value: Value) -> str:
    made = number(int(value) if type(value) is bool else value)
    return f"{made:.12f}" if type(made) is float else str(made)


def _brace(code: str, at: int) -> int:
    """The next `{` that is not in quotes; -1 if there is none."""
    quoted = code[:at].count('"') % 2 == 1
    for place in range(at, len(code)):
        if code[place] == '"':
            quoted = not quoted
        elif code[place] == "{" and not quoted:
            return place
    return -1


def _behind(code: str, begin: int) -> int:
    end = code.find("}", begin)
    return len(code.rstrip()) if end < 0 else end + 1

"""Which lines are executed: blocks are told by how far their lines are indented, and know their own variables."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Final

from gcodesim.rs274.fault import Fault
from gcodesim.rs274.marlin.duet.syntax import Value

_TAB: Final = 4


class BranchState(Enum):
    """What the last command at the indentation of a block was."""

    PLAIN = auto()
    CHOSEN = auto()  # an `if` or `elif` whose lines are executed
    OPEN = auto()  # an `if` or `elif` that did not hold, as none before
    SETTLED = auto()  # an `elif` behind one that held
    LOOP = auto()


@dataclass(slots=True)
class _Indented:
    """A block; `loop` is the line of its `while`, which was executed `rounds` times before."""

    indent: int
    state: BranchState = BranchState.PLAIN
    loop: int = 0
    rounds: int = 0
    names: dict[str, Value] = field(default_factory=dict)


def indent_of(text: str) -> int:
    """How far a line is indented; a tab goes on to the next multiple of four."""
    count = 0
    for char in text:
        if char == "\t":
            count = (count + _TAB) // _TAB * _TAB
        elif char == " ":
            count += 1
        else:
            break
    return count


class IndentedBlocks:
    """The blocks of a file around the line at hand, the outermost first, and the variables of all files."""

    def __init__(self, shared: dict[str, Value], *, counts: bool) -> None:
        """`shared` are the variables of all files; `counts`: the file asks how often a loop was gone through."""
        self._counts = counts
        self._stack = [_Indented(0)]
        self._passed_over: int | None = None  # indentation of the command whose block is passed over
        self._skipped = BranchState.PLAIN  # of the command whose block was passed over just before the line at hand
        self.globals = shared

    @property
    def is_passing_over(self) -> bool:
        return self._passed_over is not None

    @property
    def is_outside(self) -> bool:
        """Whether no line is passed over or comes again before another command, so that moves need not be told."""
        return len(self._stack) == 1 and not self.is_passing_over and self._stack[0].state is not BranchState.LOOP

    def situation(self) -> tuple[object, ...]:
        """All that decides how the program goes on, as a copy."""
        blocks = tuple((b.indent, b.state, b.loop, dict(b.names)) for b in self._stack)
        rounds = tuple(b.rounds for b in self._stack) if self._counts else ()
        return blocks, rounds, self._passed_over, dict(self.globals)

    def arrive(self, indent: int, *, once: bool) -> int | None:
        """Come to a line; the index of the line to go back to, -1 if this one is passed over, None to execute it.

        `once`: no loop is gone through again, as a program with a fault is only read on.
        """
        self._skipped = BranchState.PLAIN
        if self._passed_over is not None:
            if indent > self._passed_over:
                return -1
            if indent == self._passed_over:
                self._skipped, self._stack[-1].state = self._stack[-1].state, BranchState.PLAIN
            self._passed_over = None
        while indent < self._stack[-1].indent:
            self._stack.pop()
            if self._stack[-1].state is BranchState.LOOP:
                if not once:
                    return self._stack[-1].loop
                self._stack[-1].state = BranchState.PLAIN
        if indent > self._stack[-1].indent:
            self._stack.append(_Indented(indent))
        return None

    def choose(self, holds: bool) -> None:
        """`if`."""
        self._stack[-1].state = BranchState.CHOSEN if holds else BranchState.OPEN
        self._pass_over_unless(holds)

    def asks(self, word: str) -> bool:
        """Whether an `elif` or `else` has to be looked at: no branch before it was taken. Raises `Fault`."""
        if self._skipped is BranchState.OPEN:
            return True
        if self._skipped is BranchState.SETTLED or self._stack[-1].state is BranchState.CHOSEN:
            self._stack[-1].state = BranchState.SETTLED if word == "elif" else BranchState.PLAIN
            self._pass_over_unless(False)
            return False
        raise Fault("GS130", f"`{word}` has no `if` before it", hint="it is indented as far as its `if`")

    def otherwise(self) -> None:
        """`else`, where no branch was taken."""
        self._stack[-1].state = BranchState.PLAIN

    def loop(self, index: int) -> None:
        """`while` in line `index`, before its condition is looked at."""
        block = self._stack[-1]
        if block.state is BranchState.LOOP and block.loop == index:
            block.rounds += 1
        else:
            block.state, block.loop, block.rounds = BranchState.LOOP, index, 0

    def leave_unless(self, holds: bool) -> None:
        """Go behind the loop whose `while` is at hand if its condition does not hold."""
        if not holds:
            self._stack[-1].state = BranchState.PLAIN
            self._pass_over_unless(False)

    def leave_loop(self, word: str) -> None:
        """`break`."""
        self._to_loop(word)
        self._stack[-1].state = BranchState.PLAIN
        self._pass_over_unless(False)

    def next_round(self) -> int:
        """`continue`: the line of the loop."""
        self._to_loop("continue")
        return self._stack[-1].loop

    @property
    def rounds(self) -> int:
        """How often the innermost loop was gone through before."""
        for block in reversed(self._stack):
            if block.state is BranchState.LOOP:
                return block.rounds
        raise Fault("GS120", "`iterations` has a value in a loop only")

    def _to_loop(self, word: str) -> None:
        if all(block.state is not BranchState.LOOP for block in self._stack[:-1]):
            raise Fault("GS130", f"`{word}` is not inside a loop")
        self._stack.pop()
        while self._stack[-1].state is not BranchState.LOOP:
            self._stack.pop()

    def _pass_over_unless(self, holds: bool) -> None:
        if not holds:
            self._passed_over = self._stack[-1].indent

    # -- variables

    def define(self, scope: str, name: str, value: Value) -> None:
        """`var` and `global`."""
        known = self.globals if scope == "global" else self._stack[-1].names
        if self.known(scope, name) is not None:
            raise Fault("GS130", f"{scope}.{name} exists already", hint=f"`set {scope}.{name} = …` changes it")
        known[name] = value

    def known(self, scope: str, name: str) -> dict[str, Value] | None:
        """The variables among which `name` is; None where it is not defined."""
        if scope == "global":
            return self.globals if name in self.globals else None
        return next((block.names for block in reversed(self._stack) if name in block.names), None)

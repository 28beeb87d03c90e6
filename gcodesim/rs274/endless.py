"""Whether a program that goes on and on will ever end.

A control does the same again when everything that it knows is as it was before at the same line. So now and then a
stretch of blocks is watched: what is known at one of them is kept and compared whenever that line comes again. What is
kept is replaced after 1, 2, 4, 8 … blocks (Brent 1980), so that a loop is found wherever in the stretch it begins.
"""

from __future__ import annotations

from typing import Any, Final, NamedTuple

from gcodesim.diagnostics import Caller
from gcodesim.rs274.control import Control
from gcodesim.rs274.flow import FlowControl
from gcodesim.rs274.program_file import ProgramFile

_LOOKS: Final = ((50_000, 2_000), (200_000, 20_000))
"""From which block on how many are watched, but not before each line had its turn twice; once more before the limit.

They all go through the grammar's lane.
"""
_MOST_NAMED: Final = 3

ProgramPlace = tuple[ProgramFile, int, tuple[Caller, ...]]


class Situation(NamedTuple):
    """Everything that decides what a control does next: where it is, its variables, and the rest."""

    where: tuple[object, ...]
    variables: dict[object, float]
    rest: tuple[object, ...]


class Endless:
    """Watches a run that may have no end."""

    def __init__(self, control: Control, flow: FlowControl, *, lines: int, limit: int) -> None:
        self._control, self._flow = control, flow
        last = min(_LOOKS[-1][1], max(limit // 2, 1))
        looks = [(max(first, 2 * lines), count) for first, count in _LOOKS]
        self._stretches = [(first, first + count) for first, count in looks if first + count < limit - last]
        self._stretches.append((limit - last, limit))
        self._kept: Situation | None = None
        self._again: Situation | None = None  # what was known when the line of `_kept` came again
        self._count, self._next = 0, 1
        self._loops: dict[tuple[int, int], ProgramPlace] = {}  # by depth of calls and line
        self.period = 0  # blocks after which everything is as it was; 0 while that is not known

    def is_looking(self, blocks: int) -> bool:
        """Whether the block at hand, of which there were `blocks`, belongs to a stretch that is watched."""
        return any(first <= blocks < end for first, end in self._stretches)

    def next_look(self, blocks: int, limit: int) -> int:
        """The first block of the next stretch, or `limit`."""
        return min((first for first, _ in self._stretches if first > blocks), default=limit)

    def forget(self) -> None:
        """Somebody outside has answered the program: what comes next does not depend on it alone."""
        self._kept = self._again = None
        self._count, self._next = 0, 1

    def repeats(self) -> bool:
        """Look after a block of a watched stretch; true once it is certain that there is no end."""
        loop = self._flow.loop
        if loop is not None:
            self._loops[(len(self._flow.frames), loop[1])] = (*loop, self._flow.frame.callers)
        self._count += 1
        kept = self._kept
        if kept is not None and _where(self._flow) == kept.where:
            now = _situation(self._control, self._flow)
            if now == kept:
                self.period = self._count - self._next // 2
                return True
            self._again = now
        if self._count >= self._next:
            self._next *= 2
            self._kept = _situation(self._control, self._flow)
            self._loops.clear()
        return False

    @property
    def loop(self) -> ProgramPlace | None:
        """The outermost line that the watched blocks jumped back to, and who called it."""
        if self._loops:
            return self._loops[min(self._loops)]
        loop = self._flow.loop
        return None if loop is None else (*loop, self._flow.frame.callers)

    @property
    def changes(self) -> str:
        """What differs from one round to the next, as far as was seen."""
        if self._kept is None or self._again is None:
            return ""
        before, after = self._kept.variables, self._again.variables
        names = [name for name in after if before.get(name) != after[name]]
        if not names:
            return "" if self._kept.rest == self._again.rest else "positions or modes"
        shown = [f"{_shown(name)} (now {after[name]:g})" for name in names[:_MOST_NAMED]]
        return ", ".join(shown) + (" and others" if len(names) > _MOST_NAMED else "")

    def hint(self, option: str) -> str:
        """What is known of a program that goes on and on; `option` of the command line would let it."""
        is_loop = self.loop is not None
        if self.period:
            return "nothing in the loop that begins here changes any more" if is_loop else "nothing changes any more"
        what = "the loop that begins here" if is_loop else "it"
        if changes := self.changes:
            return f"{what} still changes {changes}, so it may end; {option} allows more"
        return f"{what} may have no end; {option} allows more"


def _where(flow: FlowControl) -> tuple[object, ...]:
    frame = flow.frame
    return len(flow.frames), id(frame.file), frame.at


def _situation(control: Control, flow: FlowControl) -> Situation:
    frames = tuple(frame.situation() for frame in flow.frames)
    labels = tuple((key, label.left) for key, label in flow.labels.items())
    turns = (flow.taken, flow.breaking, flow.continuing, flow.arrived)
    rest: tuple[Any, ...] = (frames, labels, turns, control.situation())
    return Situation(_where(flow), control.parameters.everything(), rest)


def _shown(name: object) -> str:
    return f"#{name}" if isinstance(name, int) else f"#<{name}>"

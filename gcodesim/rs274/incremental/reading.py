"""A program under an editor's hands: its findings, and what the control knows at a line."""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from gcodesim import canon
from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import Diagnostic, Findings, SourceText
from gcodesim.frozen import frozen
from gcodesim.rs274.block import Block
from gcodesim.rs274.incremental.change import TextChange, change_between
from gcodesim.rs274.incremental.merging import NotMergeableError, carry_over
from gcodesim.rs274.incremental.snapshot import copied, is_same
from gcodesim.rs274.other_machines import foreign_of
from gcodesim.rs274.run import executor_of
from gcodesim.rs274.settings import Settings

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.executor import Executor

EVERY: Final = 250
"""Blocks between two copies of the run at first; their distance grows where a program executes very many."""

_MOST_COPIES: Final = 400
_ENDLESS: Final = "GS134"


@dataclass(slots=True)
class _Copy:
    """The run as it stood before block number `blocks`."""

    blocks: int
    executor: Executor


@frozen
class LineMoment:
    """What the control knows before and after a line is executed for the first time, and what it then says."""

    before: Control
    after: Control
    events: tuple[canon.Event, ...]


class LiveReading:
    """The latest text of a program, read as far as `lines_read` tells; `go_on` reads further until it `is_done`.

    `findings` are those of `lint` once it is done; before, findings of lines that were not reached yet are those of
    the text before. `work` counts the blocks that were executed since the last change.
    """

    def __init__(self, source: SourceText, settings: Settings, *, every: int = EVERY) -> None:
        self.settings = replace(settings, lane="grammar")
        self.work = 0
        self._first_every = every
        self._provisional: list[Diagnostic] = []  # findings of the text before
        self._begin(source)

    def _begin(self, source: SourceText) -> None:
        self.source = source
        self.every = self._first_every
        # for each line of the main program, the numbers of the first and last block that read it
        self.first: dict[int, int] = {}
        self.last: dict[int, int] = {}
        self.copies: list[_Copy] = []
        self.end: Executor | None = None
        self.is_done = False
        self._goes_on = False
        self._resumed = False
        self._earlier: LiveReading | None = None  # of the text before, while this one may meet it
        self._change: TextChange | None = None
        self._run = executor_of(source, self.settings)
        self._watch_reads(self._run)
        self.start = copied(self._run, self._run.file)
        _drain(self._run.begin())
        # what depends on the whole text, and not on lines as they are reached
        self.of_whole_text = foreign_of(source), list(self._run.run.findings)
        self._keep()

    @property
    def executor(self) -> Executor:
        """The run, as far as it got."""
        return self._run

    # -- reading

    def go_on(self, blocks: int) -> bool:
        """Execute at most `blocks` more; whether all is read."""
        for _ in range(blocks):
            if self.is_done:
                break
            self._step()
        return self.is_done

    def finish(self) -> Findings:
        """Read to the end."""
        while not self.go_on(1_000_000):
            pass
        return self._run.run.findings

    def _step(self) -> None:
        run = self._run
        if run.over and self._resumed and any(one.code == _ENDLESS for one in run.run.findings):
            self._begin(self.source)  # after how many blocks it is noticed depends on all of them
            return
        if run.over:
            self._end()
            return
        frame = run.flow.frame
        if frame.file is run.file:
            self.first.setdefault(frame.at, run.blocks)
            self.last[frame.at] = run.blocks
        self._goes_on = True
        _drain(run.step())
        self._goes_on = False
        self.work += 1
        if run.blocks % self.every == 0 and not run.over:
            if self._has_met_earlier():
                return
            self._keep()

    def _end(self) -> None:
        """The program is at its end: keep how it came there, and let it say what shows only now."""
        self.end = copied(self._run, self._run.file)
        self._run.finish()
        self.is_done = True
        self._earlier = self._change = None

    def _watch_reads(self, run: Executor) -> None:
        """Note which block reads a line first, also where a cycle reads the lines of its contour ahead."""
        file, read, first, last = run.file, run.file.block, self.first, self.last

        def block(index: int) -> Block:
            if self._goes_on:  # and not only answers a question about an earlier line
                first.setdefault(index, self._run.blocks)
                last[index] = max(self._run.blocks, last.get(index, 0))
            return read(index)

        file.block = block  # type: ignore[method-assign]

    def _keep(self) -> None:
        """Keep a copy of the run as it stands."""
        run = self._run
        run.hand_over_notes()
        self.copies.append(_Copy(run.blocks, copied(run, run.file)))
        if len(self.copies) > _MOST_COPIES:
            self.every *= 2
            self.copies = [one for one in self.copies if one.blocks % self.every == 0]

    # -- changes

    def update(self, source: SourceText, settings: Settings | None = None) -> None:
        """Take a new text: what stands before the change stays read."""
        settings = self.settings if settings is None else replace(settings, lane="grammar")
        before = copy(self)
        change = change_between(self._run.file, source) if settings == self.settings else None
        self.settings, self.work = settings, 0
        if change is not None and not change:
            return
        self._begin(source)
        if change is None or self.of_whole_text != before.of_whole_text or not is_same(self.start, before.start):
            self._provisional = list(before.findings)
            return
        self._provisional = [_shifted(one, change) for one in before.findings]
        self._resume(before, change)
        if before.is_done and not change.shift:
            self._earlier, self._change = before, change

    def _resume(self, before: LiveReading, change: TextChange) -> None:
        """Go on from the last copy that has seen nothing of what changed."""
        bound = min((block for line, block in before.first.items() if line >= change.depends_on), default=None)
        usable = [one for one in before.copies if bound is None or one.blocks <= bound]
        if len(usable) < 2:
            return
        file = self._run.file
        self.copies = [_Copy(one.blocks, copied(one.executor, file)) for one in usable[-1:]]
        self.copies = [*usable[:-1], *self.copies]
        self.every = before.every
        last = self.copies[-1]
        for line, block in before.first.items():
            if block < last.blocks:
                self.first[line], self.last[line] = block, before.last[line]
        self._resumed = True
        self._run = copied(last.executor, file)
        self._run.run.source = self.source

    def _has_met_earlier(self) -> bool:
        """Whether the run stands as the one of the text before did at this line, so that the rest is known."""
        earlier, change, run = self._earlier, self._change, self._run
        if earlier is None or change is None or run.flow.frame.at <= change.last:
            return False
        then = next((one for one in earlier.copies if one.blocks == run.blocks), None)
        changed = range(change.first, change.last + 1)
        if any(earlier.last.get(line, -1) >= run.blocks for line in changed):
            return False  # a loop comes to them again
        if then is None or earlier.end is None or not is_same(run, then.executor):
            return False
        run.hand_over_notes()
        end = copied(earlier.end, run.file)
        end.run.source = self.source
        behind = [one for one in earlier.copies if one.blocks >= run.blocks]
        base = copied(then.executor, then.executor.file)
        try:
            carry_over(end, run, base, changed)
        except NotMergeableError:
            return False
        for one in behind:
            carry_over(one.executor, run, base, changed)
        self.copies += behind
        for line, block in earlier.first.items():
            if block >= run.blocks:
                self.first.setdefault(line, block)
            if earlier.last[line] >= run.blocks:
                self.last[line] = earlier.last[line]
        self._run = end
        self._end()
        return True

    # -- questions

    @property
    def findings(self) -> list[Diagnostic]:
        """All that is known; of lines that were not reached yet, what the text before had."""
        found = list(self._run.run.findings)
        if self.is_done:
            return found
        reached = self._reached
        own = {(one.code, one.message, one.span) for one in found}
        later = [one for one in self._provisional if one.span.line > reached and one.span.file == self.source.name]
        return sorted([*found, *(one for one in later if (one.code, one.message, one.span) not in own)], key=_order)

    @property
    def _reached(self) -> int:
        """The line, from 1, up to which the program is read."""
        return self._run.flow.frames[0].at

    def moment(self, line: int) -> LineMoment | None:
        """What happens when the line with index `line` is executed first; None while, or where, it is not."""
        block = self.first.get(line)
        if block is None:
            return None
        nearest = next((one for one in reversed(self.copies) if one.blocks <= block), None)
        if nearest is None:
            return None
        run = copied(nearest.executor, self._run.file)
        while run.blocks < block and not run.over:
            _drain(run.step())
            self.work += 1
        if run.over:
            return None
        before = copied(run, run.file).control
        events = tuple(event for event in run.step() if not isinstance(event, MoveBatch))
        self.work += 1
        return LineMoment(before=before, after=run.control, events=events)


def _order(finding: Diagnostic) -> tuple[str, int, int, str, str]:
    return finding.order


def _drain(events: Iterable[object]) -> None:
    for _ in events:
        pass


def _shifted(finding: Diagnostic, change: TextChange) -> Diagnostic:
    """A finding of the text before, where its line stands now."""
    span = finding.span
    if not change.shift or span.line <= change.first or not span.line:
        return finding
    moved = replace(span, line=span.line + change.shift, end_line=span.end_line + change.shift)
    return replace(finding, span=moved)

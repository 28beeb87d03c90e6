"""Running a program: its events one by one, and what was found."""

from __future__ import annotations

from collections.abc import Generator

from gcodesim import canon
from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import Diagnostic, Findings, SourceText, Span
from gcodesim.family import object_at
from gcodesim.rs274.dialects import DIALECTS, Dialect
from gcodesim.rs274.entry.halted import Halted
from gcodesim.rs274.executor import Executor, Feedback
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.program_source import as_text
from gcodesim.rs274.settings import Settings


class Run:
    """A program about to run: iterate it for its events.

    A run is a conversation: `send` a `canon.Touched` for each `canon.ProbeMove`
    (or just the trip point [m, rad]) and a `canon.Heard` for each
    `canon.Input`, which comes with `Settings.answered` only. Without a reply a
    probe trips at the end of its move. After the first error no more events
    come, but the rest of the program is still read, so that `findings` holds
    everything.
    """

    def __init__(self, source: SourceText, settings: Settings) -> None:
        self.source = source = as_text(source)
        self.settings = settings
        self.findings = Findings()
        self.failed: Diagnostic | None = None
        self.failed_line: int | None = None  # where a control would stand; a finding may name an earlier line
        self.halted: Halted | None = None  # where `Settings.until` ended it
        self.sources: dict[str, SourceText] = {source.name: source}
        self.not_simulated: dict[str, tuple[int, Span]] = {}
        self.parameters: dict[int, float] = dict(settings.parameters)
        self.kept: tuple[int, ...] = ()  # numbers of those that a control keeps from run to run
        self.blocks = 0

    def __iter__(self) -> Generator[canon.Event, Feedback, None]:
        """The events one by one."""
        stream = self.stream()
        reply: Feedback = None
        while True:
            try:
                item = stream.send(reply)
            except StopIteration:
                return
            reply = None
            if type(item) is MoveBatch:
                yield from item.events()
            else:
                reply = yield item  # type: ignore[misc]

    def stream(self) -> Generator[canon.Event | MoveBatch, Feedback, None]:
        """The events, where runs of plain moves may come as one batch each: for long programs."""
        return _executor_of(DIALECTS[self.settings.dialect])(self).events()


def interpret(source: SourceText, settings: Settings | None = None) -> Run:
    """A `Run` of the program; nothing happens before it is iterated."""
    return Run(source, settings or Settings())


def lint(source: SourceText, settings: Settings | None = None) -> Findings:
    """All findings of the program."""
    run = interpret(source, settings)
    for _ in run.stream():
        pass
    return run.findings


def file_of(source: SourceText, settings: Settings | None = None) -> ProgramFile:
    """The lines of a program as the control of the settings' dialect reads them; nothing is executed."""
    return executor_of(source, settings or Settings()).file


def executor_of(source: SourceText, settings: Settings) -> Executor:
    """One execution of a program that somebody else takes step by step."""
    return _executor_of(DIALECTS[settings.dialect])(Run(source, settings))


def _executor_of(dialect: Dialect) -> type[Executor]:
    """The class that runs programs of the dialect: that of RS274, or one of its own."""
    if not dialect.executor:
        return Executor
    own: type[Executor] = object_at(dialect.executor)
    return own

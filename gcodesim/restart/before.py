"""What is there when a program is taken up in the middle: the lines before are run for the shape of the stock alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gcodesim import canon
from gcodesim.cell import LoadedCell
from gcodesim.diagnostics import Diagnostic, Severity, SourceText, Span
from gcodesim.files.code_digest import code_digest
from gcodesim.files.output_folder import SETUP_NAME, STOCK_SUFFIXES, overwriting, overwriting_text
from gcodesim.files.whole_file import write_whole
from gcodesim.frozen import frozen
from gcodesim.jobs.job import Job, Options
from gcodesim.restart.program import MARK, restart_of
from gcodesim.rs274 import Settings
from gcodesim.rs274.entry.remaining import up_to
from gcodesim.setups.memory import forget, key_of, recall, remember
from gcodesim.simulation import prepare, run

if TYPE_CHECKING:
    from gcodesim.executor import Progress

FOLDER: Final = "before"
"""The folder, beside the files of the run, with the stocks as the lines before have left them."""


@frozen(eq=False)
class TakenUp:
    """`program` and `options` with which `simulation.prepare` goes on, and all texts by name.

    The program is None where one of the `findings` is in the way.
    """

    program: SourceText | None
    options: Options
    findings: Sequence[Diagnostic]
    sources: Mapping[str, SourceText]
    was_known: bool = False


def take_up(
    program: SourceText,
    loaded: LoadedCell,
    line: int,
    options: Options,
    out: Path,
    *,
    said: str = "",
    progress: Callable[[Progress], None] | None = None,
) -> TakenUp:
    """Run `program` up to `line` as far as its files in `out` do not know that already, and make the rest of it.

    `said` is what the command line says of reading. OSError if a file cannot be written, `RunInterrupted` as `run`.
    """
    if len(getattr(loaded.cell, "channels", ())) > 1 and options.channels:
        span = Span.of_line(program.name, line, program.line(line))
        several = Diagnostic(code="GS148", span=span, message="several programs at once run from their beginning only")
        return TakenUp(program=None, options=options, findings=[several], sources={program.name: program})

    def ending(settings: Settings) -> Settings:
        return replace(options.settings(settings), until=line)

    first = replace(options, world=None, settings=ending, only="shape")
    folder, before = out / FOLDER, up_to(program, line)
    job = prepare(before, loaded, first)
    key = key_of(before, loaded, first, said, code_digest())
    known = job.legs is not None and job.legs.ended and recall(folder, key) is not None
    if job.plan is not None and job.reading is not None and job.reading.failed is None and not known:
        lost = [] if options.force else overwriting(folder, [SETUP_NAME], (), Span(program.name))
        if lost:
            return _ended(program, job, options, lost)
        forget(folder)
        results, execution = run(job, folder, progress)
        if execution is None:
            return _ended(program, job, options, results.findings)
        remember(folder, key, job, results.findings, ())
    if job.plan is None or job.reading is None or job.reading.failed is not None:
        return _ended(program, job, options, [one for one in job.findings if one.level >= Severity.ERROR])
    made = restart_of(program, line, job.reading, job.plan.path, job.events)
    made = replace(made, findings=[*made.findings, *_lost(job, line, program)])
    if made.program is None:
        return _ended(program, job, options, made.findings)
    if not options.force and (lost := overwriting_text(out / made.program.name, MARK.encode(), Span(program.name))):
        return _ended(program, job, options, lost)
    write_whole(out / made.program.name, made.program.raw)
    left = {name: folder / f"{name}{STOCK_SUFFIXES[1]}" for name in loaded.cell.stocks} if loaded.cell else {}
    own = replace(made.program, folder=program.folder)
    return TakenUp(
        program=own,
        options=replace(
            options,
            from_line=line,
            left=left,
            findings=(*options.findings, *made.findings),
            sources={**options.sources, program.name: program},
        ),
        findings=made.findings,
        sources={program.name: program, own.name: own},
        was_known=known,
    )


def _ended(program: SourceText, job: Job, options: Options, findings: Sequence[Diagnostic]) -> TakenUp:
    return TakenUp(program=None, options=options, findings=findings, sources={**job.sources, program.name: program})


def _lost(job: Job, line: int, program: SourceText) -> list[Diagnostic]:
    """GS149 for what the lines before have made of the cell besides its stocks."""
    assert job.shop is not None
    kinds = []
    if job.shop.moves_parts and any(isinstance(event, canon.Action) for event in job.events):
        kinds.append("parts stand where the cell has them, not where grippers and belts have brought them")
    if job.shop.coated:
        kinds.append("films of the lines before are not there")
    span = Span.of_line(program.name, line, program.line(line))
    return [Diagnostic(code="GS149", span=span, message=text, hint="run the whole program") for text in kinds]

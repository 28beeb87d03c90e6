"""A case that is a job: its set-ups run one after the other, and their facts are those of one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.diagnostics.show import as_json
from gcodesim.files.repository import top_of
from gcodesim.regress.case import Case
from gcodesim.regress.facts import Facts, facts_of_run
from gcodesim.regress.outcome import Judging, Outcome, options_of
from gcodesim.regress.places import files_read, relocated
from gcodesim.setups.results import setups_as_json
from gcodesim.setups.running import How, SetupRun, run_setups
from gcodesim.setups.setup_file import JobFile, read_job_file

_NO_OWN: dict[str, Any] = {"stocks": {}, "tools": [], "joints": [], "not_simulated": []}
"""What the results of a job have under its set-ups only."""


def job_outcome(case: Case, source: SourceText, how: Judging) -> Outcome:
    """Run the set-ups of a job without files; the stocks are handed on through a folder that is deleted."""
    from gcodesim.world import WorldUnavailable

    allowed = (top_of(case.program.parent), top_of(how.root), *how.allowed(case))
    job = read_job_file(source, case.program, allowed)
    done: list[SetupRun] = []
    faults: list[Diagnostic] = []
    if job.setups is not None:
        only_check = case.options.mode == "check"
        given = How(
            options=options_of(case, how),
            only_check=only_check,
            allow_paths=allowed,
            allow_code=how.allow_code,
            read=case.read,
        )
        try:
            for one in run_setups(job, given):
                done.append(one)
        except WorldUnavailable as reason:
            faults.append(Diagnostic(code="GS612", span=Span(source.name), message=str(reason)))
    return _outcome(job, done, faults, how)


def _outcome(job: JobFile, done: list[SetupRun], faults: list[Diagnostic], how: Judging) -> Outcome:
    own = {job.source.name: job.path}
    files = [own | _files(one) for one in done]
    # each set-up may have files of the same names
    findings = [
        relocated(finding, known, how.root) for one, known in zip(done, files, strict=True) for finding in one.findings
    ]
    suppressed = [
        (relocated(finding, known, how.root), reason)
        for one, known in zip(done, files, strict=True)
        for finding, reason in one.suppressed
    ]
    if job.setups is None:
        findings = list(job.findings)
    parts = {one.setup.name: facts_of_run(one.job, one.made) for one in done if one.job is not None and one.made}
    results = {**_NO_OWN, **setups_as_json(done), "findings": [as_json(finding) for finding in findings]}
    facts = Facts(
        name=job.source.name,
        steps=tuple(step for part in parts.values() for step in part.steps or ()),
        results=results if done and not faults else {"findings": results["findings"]},
        surfaces={f"{name}/{stock}": one for name, part in parts.items() for stock, one in part.surfaces.items()},
        sources={name: text for part in parts.values() for name, text in part.sources.items()},
    )
    if done and done[0].made is not None and not done[0].made.stocks:
        facts = replace(facts, surfaces={})  # of a check
    readings = [each.reading for one in done if one.job for each in one.job.all if each.reading is not None]
    cells = [one.loaded.cell for one in done if one.loaded.cell is not None]
    return Outcome(
        facts=facts,
        findings=findings,
        suppressed=suppressed,
        programs={name: text for known in reversed(readings) for name, text in known.sources.items()},
        files=own | {f"{k}/{name}": path for k, known in enumerate(files) for name, path in known.items()},
        until=tuple(entry.until for cell in cells for entry in cell.suppress if entry.until is not None),
        faults=faults,
    )


def _files(one: SetupRun) -> dict[str, Any]:
    readings = [] if one.job is None else [each.reading for each in one.job.all if each.reading is not None]
    folders = list(dict.fromkeys(folder for known in readings for folder in known.settings.subroutines))
    return files_read(one.setup.program, one.sources, folders, one.loaded)

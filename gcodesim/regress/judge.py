"""One case: run it, compare it with what was accepted and expected, and say what that means."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from gcodesim.cell.loader import read_cell
from gcodesim.cell.settings import matches
from gcodesim.cell.verdict import suppressed_findings
from gcodesim.declarations.reading import suggestion
from gcodesim.diagnostics import Diagnostic, Severity, SourceText, Span
from gcodesim.diagnostics.show import as_json
from gcodesim.jobs.job import Job
from gcodesim.regress import show
from gcodesim.regress.case import Case, shown_path
from gcodesim.regress.case_file import ExpectedValue
from gcodesim.regress.changes import SAME, Change, Comparison, FindingChange, MoveChange
from gcodesim.regress.compare import is_number, paths_of, value_at
from gcodesim.regress.expectation import Wanted, expectations
from gcodesim.regress.facts import Facts, compare, facts_of_run
from gcodesim.regress.golden import GoldenError, read_golden
from gcodesim.regress.motion import steps_of
from gcodesim.regress.outcome import Judging, Outcome, nothing_ran, options_of, settings_of
from gcodesim.regress.places import files_read, relocated
from gcodesim.regress.setups import job_outcome
from gcodesim.regress.tolerance import Tolerance, quantity_of
from gcodesim.regress.verdicts import NOTHING_ACCEPTED, CaseVerdict, FindingState, JudgedFinding
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.setups.naming import is_job_file
from gcodesim.simulation import check, prepare, run
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.cell import LoadedCell

_MOST_MOVES: Final = 20
"""Differences of motion that become findings of their own; one more finding says how many others there are."""


def judge(case: Case, how: Judging) -> tuple[CaseVerdict, Outcome]:
    """The verdict on a case, and the run behind it."""
    outcome = run_case(case, how)
    golden, problem = _golden(case, how)
    comparison = None if golden is None else _against(golden, outcome.facts, case)
    wanted, faults = _wanted(case, outcome)
    taken, unmet = _expected(wanted, outcome.findings)
    if comparison is not None:
        comparison = _without_expected(comparison, [as_json(finding) for finding in taken])
    fail_on = case.options.fail_on or how.fail_on
    found: list[JudgedFinding] = []
    for finding in outcome.findings:
        state, reason = _state(finding, taken, comparison, fail_on)
        found.append(JudgedFinding(finding=finding, state=state, reason=reason))
    found += [
        JudgedFinding(finding=finding, state="suppressed", reason=reason) for finding, reason in outcome.suppressed
    ]
    ours = [*outcome.faults, *faults, *unmet, *_values(case, outcome.facts.results), *problem]
    if comparison is not None:
        ours += differences(comparison, outcome.facts)
    elif not problem:
        ours.append(_nothing_accepted(case))
    found += [JudgedFinding(finding=one, state="counts" if _is_severe(one, fail_on) else "told") for one in ours]
    placed = (replace(one, finding=relocated(one.finding, outcome.files, how.root)) for one in found)
    shown = sorted(placed, key=lambda one: one.finding.order)
    failed = any(one.state == "counts" for one in shown)
    verdict = CaseVerdict(
        name=case.name,
        file=case.file,
        program=shown_path(case.program, how.root),
        cell=None if case.cell is None else shown_path(case.cell, how.root),
        status="failed" if failed else "passed",
        found=tuple(shown),
        # differences within tolerance are not part of a verdict
        comparison=SAME if comparison is not None and comparison.same else comparison,
        results=outcome.facts.results if "time" in outcome.facts.results else None,
    )
    return verdict, outcome


def run_case(case: Case, how: Judging) -> Outcome:
    """Run, check or lint the program of a case."""
    alone = case.options.mode == "lint"
    try:
        program = case.read(case.program)
        cell = None if alone or case.cell is None else case.read(case.cell)
    except OSError as error:
        name = shown_path(Path(error.filename or case.program), how.root)
        message = f"{name} cannot be read: {error.strerror or error}"
        fault = Diagnostic(code="GS612", span=Span(case.file), message=message, hint="look at its name and its rights")
        return nothing_ran(case, SourceText(case.program.name, b""), fault)
    if case.options.dialect is not None and case.options.dialect not in DIALECTS:
        hint = suggestion(case.options.dialect, list(DIALECTS))
        span = case.spans.get(("options", "dialect"), Span(case.file))
        fault = Diagnostic(code="GS612", span=span, message=f"there is no dialect `{case.options.dialect}`", hint=hint)
        return nothing_ran(case, program, fault)
    if case.options.mode == "lint":
        return _lint(case, program)
    if is_job_file(case.program):
        return job_outcome(case, program, how)
    assert case.cell is not None and cell is not None
    return _simulate(case, program, read_cell(cell, case.cell, how.allowed(case), allow_code=how.allow_code), how)


def _lint(case: Case, program: SourceText) -> Outcome:
    settings = Settings(tool_table=assumed_tools(program))
    reading = interpret(program, settings_of(case, settings))
    steps = tuple(steps_of(reading))
    findings = list(reading.findings)
    results = {"findings": [as_json(finding) for finding in findings]}
    return Outcome(
        facts=Facts(name=program.name, steps=steps, results=results, sources=reading.sources),
        findings=findings,
        suppressed=[],
        programs=reading.sources,
        files=files_read(case.program, reading.sources, reading.settings.subroutines, None),
        faults=[],
    )


def _simulate(case: Case, program: SourceText, loaded: LoadedCell, how: Judging) -> Outcome:
    from gcodesim.world import WorldUnavailable

    channels = {name: case.read(path) for name, path in case.channels.items()}
    job = prepare(program, loaded, replace(options_of(case, how), channels=channels))
    faults: list[Diagnostic] = []
    try:
        results = check(job) if case.options.mode == "check" else run(job)[0]
    except WorldUnavailable as reason:
        faults.append(Diagnostic(code="GS612", span=Span(program.name), message=str(reason)))
        results = check(job)
    facts = facts_of_run(job, results)
    if case.options.mode == "check" or faults:
        facts = replace(facts, surfaces={})
    readings = [each.reading for each in job.all if each.reading is not None]
    subroutines = list(dict.fromkeys(folder for known in readings for folder in known.settings.subroutines))
    programs = {name: source for known in reversed(readings) for name, source in known.sources.items()}
    sources = {name: source for each in reversed(job.all) for name, source in each.sources.items()}
    return Outcome(
        facts=facts,
        findings=list(results.findings),
        suppressed=_suppressed(job),
        programs=programs or job.sources,
        files={path.name: path for path in case.channels.values()}
        | files_read(case.program, sources, subroutines, loaded),
        until=() if job.cell is None else tuple(entry.until for entry in job.cell.suppress if entry.until is not None),
        faults=faults,
    )


def _suppressed(job: Job) -> list[tuple[Diagnostic, str]]:
    pairs = [
        pair
        for each in job.all
        for pair in suppressed_findings(each.findings, job.cell, each.program, job.options.today)
    ]
    return [(finding, entry.reason) for finding, entry in pairs]


# ---- what was accepted


def _golden(case: Case, how: Judging) -> tuple[Facts | None, list[Diagnostic]]:
    """The accepted facts; None if there are none or they cannot be read, which is then reported."""
    if not case.golden.is_file():
        return None, []
    name = shown_path(case.golden, how.root)
    try:
        return read_golden(SourceText.read(case.golden, name), "accepted results"), []
    except GoldenError as error:
        message = f"accepted results cannot be read: {error}"
        hint = "take it from the version control, or `gcodesim accept` the case anew"
        return None, [Diagnostic(code="GS609", span=Span(name), message=message, hint=hint)]


def _against(golden: Facts, facts: Facts, case: Case) -> Comparison:
    return compare(golden, facts, case.tolerances)


def _nothing_accepted(case: Case) -> Diagnostic:
    return Diagnostic(
        code=NOTHING_ACCEPTED,
        span=Span(case.file),
        message="nothing was accepted yet: motion, times and shape are not compared",
        hint="`gcodesim accept` takes this run",
    )


def _without_expected(comparison: Comparison, expected: Sequence[Mapping[str, Any]]) -> Comparison:
    """The comparison without new findings that somebody expects in writing."""
    kept = tuple(change for change in comparison.findings if change.kind != "new" or change.new not in expected)
    return replace(comparison, findings=kept)


def _state(
    finding: Diagnostic, taken: Sequence[Diagnostic], comparison: Comparison | None, fail_on: str
) -> tuple[FindingState, str]:
    """The effect of a finding of the run on the verdict, and why."""
    if any(finding is one for one in taken):
        return "expected", ""
    severe = _is_severe(finding, fail_on)
    if comparison is None or fail_on == "never":
        return ("counts" if severe else "told"), ""
    mine = as_json(finding)
    if any(change.kind == "new" and change.new == mine for change in comparison.findings):
        return "counts", "new since the results were accepted"
    return ("accepted" if severe else "told"), ""


def _is_severe(finding: Diagnostic, fail_on: str) -> bool:
    return fail_on != "never" and finding.level >= Severity[fail_on.upper()]


def differences(comparison: Comparison, facts: Facts) -> list[Diagnostic]:
    """A GS6xx finding for each difference of `facts` from what was accepted, in the names of the run's files."""
    first = next((_span(move, facts) for move in comparison.moves), Span(facts.name))
    return [
        *_of_moves(comparison, facts),
        *(_of_change(change, first) for change in comparison.changes),
        *(
            Diagnostic(
                code="GS605",
                span=first,
                message=show.surface_text(surface),
                value=surface.deviation_mm * MM,
                limit=surface.allowed_mm * MM,
                unit="m",
            )
            for surface in comparison.surfaces
        ),
        # a new one counts by itself
        *(_of_finding(change, facts) for change in comparison.findings if change.kind != "new"),
    ]


def _span(move: MoveChange, facts: Facts) -> Span:
    place = move.near
    if place is None or not place.line:
        return Span(facts.name)
    return Span.of_line(place.file, place.line, facts.text(place.file, place.line))


def _of_moves(comparison: Comparison, facts: Facts) -> Iterator[Diagnostic]:
    for move in comparison.moves[:_MOST_MOVES]:
        yield Diagnostic(code="GS603", span=_span(move, facts), message=show.move_message(move), count=move.count)
    more = len(comparison.moves) - _MOST_MOVES
    if more > 0:
        message = f"{more} further differences of motion from what was accepted"
        yield Diagnostic(code="GS603", span=Span(facts.name), message=message, count=more)


def _of_change(change: Change, span: Span) -> Diagnostic:
    return Diagnostic(code="GS604", span=span, message=show.change_text(change))


def _of_finding(change: FindingChange, facts: Facts) -> Diagnostic:
    one = change.shown
    line = one["line"] if change.kind != "gone" and one["file"] in facts.sources else 0
    span = Span.of_line(one["file"], line, facts.text(one["file"], line)) if line else Span(facts.name)
    return Diagnostic(code="GS606", span=span, message=f"finding {show.finding_text(change)}")


# ---- what is expected


def _wanted(case: Case, outcome: Outcome) -> tuple[list[Wanted], list[Diagnostic]]:
    """Expected findings of the test file and of comments in the program and its subprograms."""
    wanted, faults = [], []
    for source in outcome.programs.values():
        found, problems = expectations(source)
        wanted += found
        faults += problems
    for i, finding in enumerate(case.expect.findings):
        span = case.spans.get(("expect", "findings", i), Span(case.file))
        wanted.append(Wanted(finding=finding, span=span, home=case.program.name))
    return wanted, faults


def _expected(wanted: Sequence[Wanted], findings: Sequence[Diagnostic]) -> tuple[list[Diagnostic], list[Diagnostic]]:
    """The findings that were expected, and a GS601 for each expectation that is not met."""
    taken: list[Diagnostic] = []
    unmet: list[Diagnostic] = []
    for want in wanted:
        fitting = [finding for finding in findings if _fits(want, finding)]
        taken += [finding for finding in fitting if not any(finding is one for one in taken)]
        if not fitting:
            unmet.append(_unmet(want, findings))
    return taken, unmet


def _fits(want: Wanted, finding: Diagnostic) -> bool:
    said, span = want.finding, finding.span
    file = said.file or (want.home if said.line is not None else None)
    return (
        matches(said.code, finding.code)
        and (file is None or file == span.file)
        and said.line in (None, span.line)
        and said.severity in (None, finding.level.word)
        and (said.message is None or said.message in finding.message)
        and said.count in (None, finding.count)
    )


def _unmet(want: Wanted, findings: Sequence[Diagnostic]) -> Diagnostic:
    said = want.finding
    what = f"{said.severity + ' ' if said.severity else ''}{said.code}"
    where = f" in line {said.line}" if said.line is not None else ""
    count = f", {said.count} times" if said.count is not None else ""
    part = f' with "{said.message}"' if said.message is not None else ""
    alike = [one for one in findings if matches(said.code, one.code)]
    hint = ""
    if alike:
        one = alike[0]
        hint = f"{one.code} came in line {one.span.line} of {one.span.file}, {one.count} times: {one.message}"
    elif said.line is not None:
        there = [one for one in findings if one.span.line == said.line and one.span.file == (said.file or want.home)]
        hint = f"line {said.line} has {there[0].code}: {there[0].message}" if there else ""
    message = f"{what} is expected{where}{count}{part}, and did not come"
    return Diagnostic(code="GS601", span=want.span, message=message, hint=hint)


def _values(case: Case, results: Mapping[str, Any]) -> Iterator[Diagnostic]:
    """A finding for each value that is not as the test file says, and for the status."""
    expect = case.expect
    if expect.status is not None and results.get("status") != expect.status:
        span = case.spans.get(("expect", "status"), Span(case.file))
        message = f"status is `{results.get('status')}`; `{expect.status}` is expected"
        yield Diagnostic(code="GS602", span=span, message=message)
    for path, expected in expect.values.items():
        span = case.spans.get(("expect", "values", path), Span(case.file))
        try:
            value = value_at(results, path)
        except KeyError:
            known = suggestion(path, paths_of(results))
            message = f"there is no `{path}` in the results"
            yield Diagnostic(code="GS611", span=span, message=message, hint=known)
            continue
        if isinstance(value, (Mapping, list)):
            inside = paths_of({path: value})
            hint = f"it holds `{'`, `'.join(inside[:6])}`{' …' if len(inside) > 6 else ''}" if inside else ""
            yield Diagnostic(code="GS611", span=span, message=f"`{path}` is no value, but a group of some", hint=hint)
            continue
        problem = _off(path, value, expected, case.tolerances[quantity_of(path)])
        if problem is not None:
            yield replace(problem, span=span)


def _off(path: str, value: Any, expected: ExpectedValue, default: Tolerance) -> Diagnostic | None:
    """What is wrong with a value; None if it is as expected."""
    told = f"{path} is {show.value_text(value)}"
    wanted, tolerance = expected.value, expected.tolerance or default
    if not is_number(value):
        if wanted is not None and str(value) == str(wanted):
            return None
        return Diagnostic(code="GS602", span=Span(""), message=f"{told}; {_bounds(expected, tolerance)} is expected")
    number = float(value)
    good = (
        (wanted is None or (isinstance(wanted, float) and tolerance.allows(wanted, number)))
        and (expected.least is None or number >= expected.least)
        and (expected.most is None or number <= expected.most)
    )
    if good:
        return None
    limit = next((v for v in (wanted, expected.most, expected.least) if isinstance(v, float)), None)
    message = f"{told}; {_bounds(expected, tolerance)} is expected"
    return Diagnostic(code="GS602", span=Span(""), message=message, value=number, limit=limit)


def _bounds(expected: ExpectedValue, tolerance: Tolerance) -> str:
    if isinstance(expected.value, float):
        return f"{show.number(expected.value)} ± {show.number(tolerance.limit(expected.value))}"
    if expected.value is not None:
        return f"`{expected.value}`"
    least = f"at least {show.number(expected.least)}" if expected.least is not None else ""
    most = f"at most {show.number(expected.most)}" if expected.most is not None else ""
    return " and ".join(part for part in (least, most) if part)

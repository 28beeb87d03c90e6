"""JSON Schemas of everything that gcodesim prints and writes as JSON. They describe this version to the last key."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, get_args

from gcodesim.declarations.kind import Json, document
from gcodesim.formats.calculator_schemas import optimise, process
from gcodesim.formats.canon_schema import canon
from gcodesim.formats.finding_schema import finding
from gcodesim.formats.json_schema import (
    array,
    choice,
    nullable,
    number,
    of_dataclass,
    optional,
    record,
    ref,
    table,
    text,
    truth,
    whole,
)
from gcodesim.formats.results_schema import results


def _comparison(definitions: dict[str, Json]) -> Json:
    """`gcodesim.regress.show.as_json` of a comparison."""
    from gcodesim.regress.changes import Comparison

    of_dataclass(Comparison, definitions)
    own = definitions.pop("Comparison")
    return record(
        "what changed beyond tolerance",
        same=truth("whether nothing did"),
        quantities=array("names of all that differs", text("such as `Z`, `moves`, `time.total_s`")),
        broken_tolerances=array("names of the tolerances that are broken", text("`gcodesim list tolerances`")),
        **own["properties"],
    )


def _diff() -> Json:
    definitions: dict[str, Json] = {}
    definitions["comparison"] = _comparison(definitions)
    folders = record(
        "two folders",
        same=truth("whether nothing differs"),
        programs=table("comparisons by the name in both folders", ref("comparison", "what changed")),
        only_old=array("names that the old folder alone has", text("a name")),
        only_new=array("names that the new folder alone has", text("a name")),
    )
    root = {"anyOf": [{"$ref": "#/$defs/comparison"}, folders]}
    return document("gcodesim diff --format json", root, definitions)


def _test() -> Json:
    from gcodesim.regress.verdicts import CaseStatus, FindingState

    definitions: dict[str, Json] = {"finding": finding(), "results": results()}
    definitions["comparison"] = _comparison(definitions)
    said = record(
        "a finding and what it does to the verdict",
        state=choice("`counts` makes the case fail; `docs/output-formats.md` has all", *get_args(FindingState)),
        reason=text("why it is suppressed, or why it counts; may be empty"),
        **finding()["properties"],
    )
    definitions["said"] = said
    root = record(
        "the verdict of a test run",
        schema=choice("name of this form", "gcodesim-test/1"),
        failed=truth("whether something failed"),
        counts=record("cases", passed=whole("passed"), failed=whole("failed"), not_run=whole("left out after -x")),
        cases=array(
            "each case by name",
            record(
                "a program in a cell",
                name=text("unique in the suite"),
                file=text("the test file, or the program where there is none"),
                program=text("path from the folder of the run"),
                cell=nullable(text("path from the folder of the run; null: the program alone")),
                status=choice("the outcome", *get_args(CaseStatus)),
                quantities=array("names of all that differs from what was accepted", text("a quantity")),
                findings=array("all findings", ref("said", "a finding")),
                comparison=nullable(ref("comparison", "against what was accepted; null: nothing was")),
                results=nullable(ref("results", "null: nothing ran")),
            ),
        ),
        findings=array("what is wrong with test files", ref("said", "a finding")),
        gone_from_baseline=array("entries of the baseline that no finding needed", text("an entry")),
    )
    return document("gcodesim test --format json", root, definitions)


def _mutants() -> Json:
    from gcodesim.regress.mutants import SCHEMA, Fate

    fates = {
        "seen": "changes with which their case fails",
        "not_seen": "changes with which it passes, although something differs",
        "no_effect": "changes after which nothing differs",
    }
    assert tuple(fates) == get_args(Fate)
    return document(
        "gcodesim test --mutate N --format json",
        record(
            "what a suite would not see",
            schema=choice("name of this form", SCHEMA),
            seed=whole("the same seed draws the same changes"),
            counts=record("changes by what became of them", **{name: whole(what) for name, what in fates.items()}),
            mutants=array(
                "each change, in the order drawn",
                record(
                    "one change of one file of a case",
                    case=text("the case"),
                    file=text("the program or cell that is changed, from the folder of the run"),
                    operator=text("the kind of change"),
                    change=text("what is changed"),
                    fate=choice("its fate", *fates),
                    quantities=array("names of all that differs", text("a quantity")),
                ),
            ),
        ),
    )


def _baseline() -> Json:
    entry = record(
        "a known finding",
        file=text("path from the folder of the run"),
        code=text("its code"),
        line=text("the words of its line"),
        message=text("what it says, with # for numbers"),
        count=optional(whole("how many of it; 1 when absent", least=1)),
    )
    return document(
        "gcodesim baseline",
        record(
            "findings that fail nothing",
            schema=choice("name of this form", "gcodesim-baseline/1"),
            findings=array("sorted, one a line", entry),
        ),
    )


def _info() -> Json:
    seconds = nullable(number("null: it is about no time"))
    text_by_name = table("as the log has them", text("a value, as text"))
    root = record(
        "what a log is, and what is missing of it",
        schema=choice("name of this form", "gcodesim-info/1"),
        file=text("name of the file that was read"),
        verdict=text("the first line of the text"),
        complete=truth("whether the file is whole, nothing in it is damaged, and the run came to its end"),
        state=choice("how the run ended", "finished", "failed", "interrupted", "running", "unknown"),
        problem=nullable(text("what is wrong with the file")),
        missing=array("what is missing from a complete log, in words", text("a part")),
        damage=array(
            "what is there but cannot be read",
            record(
                "a record that is damaged",
                what=text("`chunk`, the name of an attachment, or `record`"),
                byte=whole("where in the file"),
                from_s=seconds,
                to_s=seconds,
                problem=text("what is wrong with it"),
            ),
        ),
        stopped_at=nullable(
            record(
                "where a run stopped before its end",
                file=text("the file"),
                line=whole("the line"),
                text=text("its words"),
            )
        ),
        duration_s=number("last moment in the log"),
        bytes=whole("size of the file"),
        chunks=whole("how many"),
        written_by=text("library of the writer"),
        run=text_by_name,
        result=text_by_name,
        findings=array(
            "findings in the log, by time",
            record(
                "a finding",
                time_s=number("simulated time"),
                code=text("its code"),
                severity=choice("how bad it is in this cell", "error", "warning", "note"),
                file=text("the file"),
                line=whole("0: the file as a whole"),
                message=text("one line"),
            ),
        ),
        attachments=array("files inside", record("a file", name=text("its name"), bytes=whole("its size"))),
        topics=array(
            "channels",
            record(
                "a topic",
                name=text("its name"),
                schema=text("of its messages"),
                count=whole("how many messages"),
                rate_Hz=number("per second of the log"),
            ),
        ),
    )
    return document("gcodesim info --format json", root, None)


def _findings() -> Json:
    root = record("findings of programs or cells", findings=array("by place", ref("finding", "a finding")))
    return document("gcodesim lint and cell validate --format json", root, {"finding": finding()})


def _cell() -> Json:
    from gcodesim.cell.schema import cell_schema

    return cell_schema()


def _test_file() -> Json:
    from gcodesim.regress.case_file import case_schema

    return case_schema()


def _job_file() -> Json:
    from gcodesim.setups.setup_file import job_schema

    return job_schema()


def _setups() -> Json:
    sums = {"time": "times of all, added up", "distance": "ways of all, added up"}
    root = record(
        "the set-ups of a job",
        schema=choice("name of this form", "gcodesim-setups/1"),
        status=choice("the worst of all", "ok", "findings", "failed"),
        **{name: table(what, number("as in the results of a run")) for name, what in sums.items()},
        setups=table("each set-up by its name, in the order of the job", ref("results", "its `results.json`")),
    )
    return document("setups.json, gcodesim run and check of a job", root, {"finding": finding(), "results": results()})


def _study() -> Json:
    from gcodesim.sweep.study_file import study_schema

    return study_schema()


def _settings() -> Json:
    from gcodesim.formatting.style_file import settings_schema

    return settings_schema()


def _sweep() -> Json:
    extremes = record(
        "a figure over all runs that came to their end",
        least=number("its least value"),
        least_run=whole("the first run that has it"),
        most=number("its greatest value"),
        most_run=whole("the first run that has it"),
    )
    hashed = record("a file that was read", name=text("its name"), sha256=text("hash of its bytes"))
    root = record(
        "a sweep",
        schema=choice("name of this form", "gcodesim-sweep/1"),
        study=hashed,
        total=whole("runs of the study"),
        done=whole("of these, those that are done"),
        failed=whole("runs beyond a limit, with a finding at or above --fail-on, or that stopped early"),
        failing=array("the first of these, by number", whole("a run, from 0")),
        codes=table("runs with an error or a warning, by its code", whole("how many", least=1)),
        figures=table("figures by the name of their column", extremes),
        findings=array("for each limit the run that is farthest beyond it", ref("finding", "a finding")),
    )
    root["properties"]["best"] = nullable(whole("of a search: the best run; null if none is within all limits"))
    return document("sweep.json, gcodesim sweep --format json", root, {"finding": finding()})


SCHEMAS: Final[dict[str, Callable[[], Json]]] = {
    "results": lambda: document(
        "results.json, gcodesim run and check --format json", results(), {"finding": finding()}
    ),
    "setups": _setups,
    "findings": _findings,
    "test": _test,
    "mutants": _mutants,
    "diff": _diff,
    "canon": lambda: document("gcodesim canon --format json", canon(finding()), None),
    "process": process,
    "optimise": optimise,
    "baseline": _baseline,
    "info": _info,
    "cell": _cell,
    "test-file": _test_file,
    "job-file": _job_file,
    "study": _study,
    "settings": _settings,
    "sweep": _sweep,
}
"""Schemas by name, as `gcodesim schema NAME` prints them."""


def schema_of(name: str) -> dict[str, Any]:
    """The schema `name`; KeyError when there is none."""
    return SCHEMAS[name]()

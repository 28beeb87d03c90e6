"""The facts of a run that are compared: motion, results, surfaces; from a run, accepted results, a folder or a log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Any, Final

from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.regress.changes import Change, Comparison, SurfaceChange
from gcodesim.regress.compare import change_of, compare_results, entry_name, is_number, value_at
from gcodesim.regress.findings import compare_findings
from gcodesim.regress.motion import MotionStep, steps_of
from gcodesim.regress.moves import compare_motion
from gcodesim.regress.surfaces import Coarse, coarse_of, compare_coarse, compare_stocks
from gcodesim.regress.tolerance import DEFAULTS, Tolerances
from gcodesim.rs274 import interpret

if TYPE_CHECKING:
    from gcodesim.jobs.job import Job
    from gcodesim.jobs.results import Results
    from gcodesim.material.stock import Stock

_TOTALS: Final = ("time.total_s", "distance.feed_mm")
_OF_STOCK: Final = ("removed_mm3", "deposited_mm3")
_ROUNDING: Final = 1e-6  # by how much accepted results, which have seven digits, may be off


@frozen(eq=False)
class Facts:
    """One side of a comparison.

    `steps` is None when the motion is not known, `results` (as in `results.json`) is empty when nothing ran; it may
    hold findings alone, or the status of a run that did not come to its results. `surfaces` are whole stocks or coarse
    ones; `sources` the programs, as far as they are there. `is_alone`: a program without a cell, so that its positions
    do not compare with those of a run.
    """

    name: str
    steps: tuple[MotionStep, ...] | None = None
    results: Mapping[str, Any] = field(default_factory=dict)
    surfaces: Mapping[str, Coarse | Stock] = field(default_factory=dict)
    sources: Mapping[str, SourceText] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    is_alone: bool = False

    def text(self, file: str, line: int) -> str:
        """A line of the program, empty when it is not known."""
        source = self.sources.get(file)
        return "" if source is None else source.line(line)


def facts_of_run(job: Job, results: Results) -> Facts:
    """The facts of a job that has run."""
    stocks = {} if job.shop is None else {name: placed.stock for name, placed in job.shop.stocks.items()}
    readings = [(each.program, each.reading) for each in job.all if each.reading is not None]
    return Facts(
        name=job.program.name,
        # read once more: a job keeps its moves as arrays, not as events; several programs one after the other
        steps=tuple(step for text, known in readings for step in steps_of(interpret(text, known.settings)))
        if readings
        else None,
        results=results.as_json(),
        surfaces=stocks,
        sources={name: source for each in reversed(job.all) for name, source in each.sources.items()},
    )


def coarse(facts: Facts) -> Mapping[str, Coarse]:
    """The surfaces of `facts`, coarse."""
    return {name: one if isinstance(one, Coarse) else coarse_of(one) for name, one in facts.surfaces.items()}


def compare(old: Facts, new: Facts, tolerances: Tolerances = DEFAULTS) -> Comparison:
    """Everything that differs beyond tolerance, as far as both sides know it."""
    remarks = [*old.remarks, *(remark for remark in new.remarks if remark not in old.remarks)]
    motion = None
    if old.steps is not None and new.steps is not None:
        motion = compare_motion(old.steps, new.steps, tolerances, old_text=old.text, new_text=new.text)
    elif old.steps is not None or new.steps is not None:
        remarks.append(f"moves are not compared: those of {new.name if new.steps is None else old.name} are not known")
    lines = None if motion is None else motion.lines
    # nobody knows what an interrupted run would have found
    known = "findings" in old.results and "findings" in new.results
    findings = compare_findings(
        old.results["findings"] if known else (),
        new.results["findings"] if known else (),
        tolerances,
        None if lines is None else lambda file, line: lines.get((file, line)),
    )
    counting = tuple(change for change in findings if change.shown["severity"] != "note")
    # remarks are not differences, but nothing is left unsaid
    remarks += [
        f"{change.kind} note {change.shown['code']}: {change.shown['message']}"
        for change in findings
        if change not in counting
    ]
    ran = "time" in old.results and "time" in new.results
    # if one side did not get to its results, at least that is compared
    both = (old.results, new.results) if ran else (_status(old.results), _status(new.results))
    return Comparison(
        moves=() if motion is None else motion.changes,
        changes=tuple(compare_results(*both, tolerances)),
        surfaces=tuple(_surfaces(old, new, tolerances)),
        findings=counting,
        totals=tuple(_totals(old.results, new.results, tolerances)) if ran else (),
        remarks=(*remarks, *_differing_inputs(old.results, new.results)),
    )


def _status(results: Mapping[str, Any]) -> Mapping[str, Any]:
    return {"status": results["status"]} if "status" in results else {}


def _surfaces(old: Facts, new: Facts, tolerances: Tolerances) -> list[SurfaceChange]:
    allowed = tolerances["surface"].absolute
    changes = []
    for name in old.surfaces:
        if name not in new.surfaces:
            continue
        a, b = old.surfaces[name], new.surfaces[name]
        if isinstance(a, Coarse) or isinstance(b, Coarse):
            a, b = (one if isinstance(one, Coarse) else coarse_of(one) for one in (a, b))
            changes.append(compare_coarse(name, a, b, allowed))
        else:
            changes.append(compare_stocks(name, a, b, allowed))
    return [change for change in changes if change is not None]


def _totals(old: Mapping[str, Any], new: Mapping[str, Any], tolerances: Tolerances) -> list[Change]:
    """Time, distance, volumes of stocks and the greatest force of each tool, where they differ at all."""
    paths = [*_TOTALS]
    paths += [f"stocks.{name}.{what}" for name in old.get("stocks", {}) for what in _OF_STOCK]
    paths += [f"tools.{entry_name(tool, i)}.max_force_N" for i, tool in enumerate(old.get("tools", ()))]
    changes = []
    for path in paths:
        try:
            a, b = value_at(old, path), value_at(new, path)
        except KeyError:
            continue
        if is_number(a) and is_number(b) and abs(a - b) > _ROUNDING * max(abs(a), abs(b)):
            changes.append(change_of(path, a, b, tolerances))
    return changes


def _differing_inputs(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """What else was not the same, for those who look for the reason."""
    told = []
    for key, what in (("gcodesim", "versions of gcodesim"), ("world", "worlds"), ("seed", "seeds")):
        a, b = old.get("inputs", {}).get(key), new.get("inputs", {}).get(key)
        if a is not None and b is not None and a != b:
            told.append(f"the {what} differ: {a}, {b}")
    return told

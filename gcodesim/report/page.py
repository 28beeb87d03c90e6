"""One HTML file that shows a run, or two side by side, without a network."""

from __future__ import annotations

import base64
import html
import json
import zlib
from collections.abc import Sequence
from dataclasses import asdict
from importlib.resources import files
from typing import Any, Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.diagnostics.plain import excerpt_of, one_line, plain_tree
from gcodesim.diagnostics.show import as_json
from gcodesim.frozen import frozen
from gcodesim.log.event import settled
from gcodesim.numbers import clean
from gcodesim.playback import Recording
from gcodesim.playback.columns import own_fields
from gcodesim.playback.quantities import Chart, charts_of, extremes
from gcodesim.report.libraries import chart_library, scene_library
from gcodesim.report.modes import modes_of
from gcodesim.report.pack import Pack
from gcodesim.report.replay import replay_of, ticks
from gcodesim.report.times import end_of, slowest, time_report
from gcodesim.units import MM, MM_PER_MINUTE, RPM

CHARTS: Final = ("force", "power", "feed", "error", "removal", "joints", "speed", "effort")
SCRIPTS: Final = ("data.js", "scene.js", "looking.js", "painting.js", "charts.js", "panels.js", "bar.js", "main.js")
_SLOTS: Final = 3000  # time slots for which a chart shows least and greatest values, shared by its curves
_LEAST_SLOTS: Final = 600
_SLOWEST: Final = 40


@frozen
class SetupRow:
    """A set-up of a job in the table of all: what the others were left with, and whether this run is in the page."""

    name: str
    status: str
    time_s: float
    removed_mm3: float
    remaining_mm3: float
    deviation_mm: tuple[float, float] | None
    errors: int
    warnings: int


@frozen
class Difference:
    """A difference between two runs, as lines of text; `old` and `new` are its file and line."""

    kind: str
    lines: tuple[str, ...]
    old: tuple[str, int] | None = None
    new: tuple[str, int] | None = None


def write_page(
    recordings: Sequence[Recording],
    names: Sequence[str] = (),
    title: str | None = None,
    compared: tuple[str, Sequence[Difference]] | None = None,
    setups: Sequence[SetupRow] = (),
) -> str:
    """The page of one run, or of two to compare; `names` tell the two apart (default: A and B).

    With `setups` the runs are those of a job, as many as have logs, with the `names` of their set-ups; the page shows
    one after the other. `compared` is the result of a comparison in one line, and all differences: a list whose
    entries link to lines. The same logs give the same text, with the same versions of the libraries
    whose scripts are inside. LibraryMissingError when one of those is not
    installed.
    """
    if not recordings or (len(recordings) > 2 and not setups):
        raise ValueError("a page shows one run or two")
    pack = Pack()
    given = list(names) or (["A", "B"] if len(recordings) == 2 else [""])
    runs = [run_data(recording, name, pack) for recording, name in zip(recordings, given, strict=True)]
    heading = title or " / ".join(dict.fromkeys(recording.name for recording in recordings))
    content: dict[str, Any] = {"runs": runs, "tick_s": 1e-4}
    if compared is not None:
        content["compared"] = {"summary": compared[0], "differences": [asdict(one) for one in compared[1]]}
    if setups:
        content["setups"] = [asdict(one) for one in setups]
    index = json.dumps(plain_tree(clean(content)), ensure_ascii=False, allow_nan=False)
    charts = chart_library()
    return _asset("page.html").format(
        title=html.escape(one_line(heading)),
        style=charts.style + _asset("page.css"),
        scene_library=_script(scene_library()),
        chart_library=_script(charts.script),
        index=base64.b64encode(zlib.compress(index.encode(), 9)).decode("ascii"),
        blob=pack.base64(),
        scripts=_script("\n".join(_asset(name) for name in SCRIPTS)),
    )


def _asset(name: str) -> str:
    return (files("gcodesim") / "data" / "report" / name).read_text(encoding="utf-8")


def _script(text: str) -> str:
    """A script in a form that may be inside a page: anything that would end its element is written in another way."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def run_data(recording: Recording, name: str, pack: Pack) -> dict[str, Any]:
    """Everything that a page shows of one run; arrays go into `pack`. Times are in 0.1 ms."""
    results, timeline, run = recording.results, recording.timeline, recording.run
    sources = recording.sources
    ran = list(timeline.files())
    known = [file for file in sources if file not in ran]
    names = ran + known
    value = {
        "name": name,
        "program": recording.name,
        "cell": run.get("cell", ""),
        "world": run.get("world", ""),
        "version": run.get("gcodesim", ""),
        "status": results.get("status", "failed"),
        "stopped_at": results.get("stopped_at"),
        "complete": recording.log.complete,
        "end": int(ticks([end_of(recording)])[0]),
        "files": [
            {
                "name": file,
                "text": pack.text("\n".join(map(excerpt_of, sources[file].lines)) if file in sources else ""),
            }
            for file in names
        ],
        "blocks": {
            "t": pack.integers(ticks(timeline.t_ns)),
            "line": pack.integers(timeline.line),
            "modal": pack.integers(timeline.modal),
        },
        "modals": [
            {
                "file": names.index(modal.file) if modal.file in names else -1,
                "motion": modal.motion,
                "tool": modal.tool,
                "tool_name": modal.tool_name,
                "wcs": modal.wcs,
                "feed": round(modal.feed / MM_PER_MINUTE, 3),
                "spindle": round(modal.spindle / RPM, 2),
            }
            for modal in timeline.modals
        ],
        "modes": [_modes(recording).get(file, []) for file in names],
        "replay": replay_of(recording, pack),
        "charts": [
            _chart(chart, pack) for chart in charts_of(recording, (*CHARTS, *own_fields(recording))) if chart.speaks
        ],
        "times": _times(recording),
        "results": {
            key: results.get(key)
            for key in (
                *("time", "distance", "stocks", "tools", "operations", "joints", "not_simulated", "inputs", "target"),
            )
        },
    }
    # only now, after everything was read, is it known what cannot be read
    return {**value, "findings": _findings(recording), "damaged": bool(recording.log.damage)}


def _modes(recording: Recording) -> dict[str, list[tuple[int, list[str]]]]:
    return modes_of({name: source.lines for name, source in recording.sources.items()})


def _findings(recording: Recording) -> list[dict[str, Any]]:
    """Findings with their moment: that of the event in the log, else the start of their line."""
    timeline = recording.timeline
    files = [modal.file for modal in timeline.modals]
    first: dict[tuple[str, int], int] = {}
    for t_ns, line, modal in zip(timeline.t_ns.tolist(), timeline.line.tolist(), timeline.modal.tolist(), strict=True):
        first.setdefault((files[modal], line), t_ns)
    listed = recording.results.get("findings")
    if listed is None:  # a run that did not get to its results
        listed = [
            {
                "code": event.code,
                "severity": event.severity,
                "message": event.message,
                "file": event.file,
                "line": event.line,
                "time_s": event.t_ns * 1e-9,
            }
            for event in settled(recording.events)
            if event.is_finding
        ]
    found = []
    for finding in [*listed, *map(as_json, recording.findings)]:
        seconds, place = finding.get("time_s"), (finding.get("file"), finding.get("line"))
        t_ns = round(seconds * 1e9) if seconds is not None else first.get(place)
        shown = {key: finding.get(key) for key in ("code", "severity", "message", "hint", "file", "line", "count")}
        found.append({**shown, "t": None if t_ns is None else int(ticks([t_ns])[0])})
    return found


def _chart(chart: Chart, pack: Pack) -> dict[str, Any]:
    """Curves over one list of times: all samples where they are few, else what each curve has as extremes."""
    t_ns = chart.curves[0].t_ns
    slots = max(_SLOTS // len(chart.curves), _LEAST_SLOTS)
    if len(t_ns) > 2 * slots * len(chart.curves):
        kept = distinct(np.concatenate([extremes(t_ns, curve.values, slots) for curve in chart.curves]))
    else:
        kept = np.arange(len(t_ns))
    return {
        "what": chart.what,
        "title": chart.title,
        "unit": chart.unit,
        "t": pack.integers(ticks(t_ns[kept])),
        "values": pack.numbers(np.stack([curve.values[kept] for curve in chart.curves], axis=1)),
        "curves": [{"label": curve.label, "faint": curve.faint} for curve in chart.curves],
    }


def _times(recording: Recording) -> dict[str, Any]:
    report = time_report(recording)
    value = report.as_json()
    value["lines"] = [
        {
            "file": line.file,
            "line": line.line,
            "text": line.text,
            "count": line.count,
            "time_s": line.seconds,
            "removed_mm3": line.removed / (MM * MM * MM),
            "max_force_N": line.force,
        }
        for line in slowest(report.lines, _SLOWEST)
    ]
    value["line_count"] = len(report.lines)
    return value

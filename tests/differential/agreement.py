"""Whether gcodesim and LinuxCNC make the same of a program."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
from linuxcnc import CORPUS, Verdict

from gcodesim import canon
from gcodesim.canon.listing import listing
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, ToolTable, interpret
from gcodesim.rs274.run import Run

sys.path.insert(0, str(Path(__file__).parents[1] / "programs"))

from corpus import compare

_MOST_BLOCKS = 50_000
_TOLERANCE = 1e-4  # mm
_SHORT_OF_END = 0.254e-3  # [m]


def settings() -> Settings:
    """The setup of the corpus."""
    table, problems = ToolTable.read(SourceText.read(CORPUS / "tools.tbl"))
    assert not problems
    return Settings(tool_table=table, subroutines=(CORPUS / "subs",), max_blocks=_MOST_BLOCKS)


def _comparable(events: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Without what the two listings show each in its own way.

    A negative dwell, which ends at once, is no event here; an empty PRINT is lost by `oracle.py`; of splines the
    preview, which gives their points, loses A, B and C; the unit of a probe's feed.
    """
    out = []
    for event in events:
        if event["kind"] == "probe":  # whether it moves X, Y or Z depends on where the last one stopped
            event = {**event, "feed_unit": "mm/min"}
        if (event["kind"] == "dwell" and event["seconds"] <= 0) or (event["kind"] == "print" and not event["text"]):
            continue
        if event["kind"] == "spline" and event["end"] is not None:
            event = {**event, "end": event["end"][:3]}
        out.append(event)
    return out


def differences(program: bytes, verdict: Verdict, ours: Settings) -> list[str]:
    """How gcodesim differs from LinuxCNC's `verdict`: acceptance, guilty line, events to 0.0001 mm; empty if not."""
    run = interpret(SourceText("program.ngc", program), ours)
    events = _as_probed(run)
    failed = run.failed
    if verdict.status == "endless":
        return [] if failed is not None and failed.code == "GS134" else ["LinuxCNC does not end"]
    if failed is not None and failed.code == "GS134":
        return [f"no end within {_MOST_BLOCKS} blocks; LinuxCNC: {verdict.status}"]
    if verdict.status == "error":
        if failed is None:
            return [f"accepted; LinuxCNC: {verdict.message} in `{verdict.text.strip()}`"]
        return _same_line(run, verdict) or _same_beginning(verdict.events, listing(events, None)["events"])
    if failed is not None:
        return [f"refused by {failed.code} {failed.message} in line {failed.span.line}; LinuxCNC accepts"]
    theirs, mine = _comparable(verdict.events), _comparable(listing(events, None)["events"])
    if verdict.complaint:  # the preview went another way, so no points of splines are known
        theirs, mine = _without_curves(theirs), _without_curves(mine)
    return compare().compare({"status": "ok", "events": theirs}, {"status": "ok", "events": mine}, "all", _TOLERANCE)


def _as_probed(run: Run) -> list[canon.Event]:
    """The events of a run in which a probe stops where the standalone interpreter makes it stop: short of its end."""
    stream = iter(run)
    events: list[canon.Event] = []
    here = np.zeros(6)
    reply: canon.Axes | None = None
    while True:
        try:
            event = stream.send(reply)
        except StopIteration:
            return events
        events.append(event)
        reply = None
        end = getattr(event, "end", None)
        if end is None or isinstance(event, canon.Tap):
            continue
        way = np.array(end) - here
        length = float(np.linalg.norm(way[:3]))
        if isinstance(event, canon.Probe) and length > 0.0:
            stop = np.array(end)
            stop[:3] -= way[:3] / length * _SHORT_OF_END
            reply = tuple(stop.tolist())
        here = np.array(end if reply is None else reply)


def _without_curves(events: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Of splines only what both ways into LinuxCNC tell."""
    return [{"kind": "message", "text": "a spline"} if event["kind"] == "spline" else event for event in events]


def _same_line(run: Run, verdict: Verdict) -> list[str]:
    """LinuxCNC gives the text of the line, not its number."""
    assert run.failed is not None
    if verdict.message.startswith("File ended") and run.failed.code in ("GS010", "GS130", "GS131"):
        return []  # beyond the last line
    if "restore_settings failed" in verdict.message:
        return [] if "saved modes cannot come back" in run.failed.message else [f"LinuxCNC: {verdict.message}"]
    places = (run.failed_line or 0, run.failed.span.line)  # a control that unwinds calls shows the place of the cause
    sources = run.sources.values()
    texts = [source.lines[n - 1] for n in places for source in sources if 0 < n <= len(source.lines)]
    guilty = _squeezed(verdict.text)
    cut = len(verdict.text) > 250  # LinuxCNC keeps no more of a line
    if any(_squeezed(text) == guilty or (cut and _squeezed(text).startswith(guilty)) for text in texts):
        return []
    return [
        f"refused in line {places[0]} `{texts[0].strip() if texts else ''}` ({run.failed.code} {run.failed.message}); "
        f"LinuxCNC: {verdict.message} in `{verdict.text.strip()}`"
    ]


def _squeezed(text: str) -> str:
    return re.sub(r"\s", "", text)


def _same_beginning(theirs: list[dict[str, Any]], ours: list[dict[str, Any]]) -> list[str]:
    """Before the guilty block both did the same; within it LinuxCNC may have done a part already."""
    want = compare().canonical(_comparable(theirs), "all", _TOLERANCE)
    got = compare().canonical(_comparable(ours), "all", _TOLERANCE)
    for event in want:  # of a spline in a program that fails only the number of control points is known
        if event["kind"] == "spline":
            event.pop("end", None)
            event.pop("samples", None)
    return compare().compare(
        {"status": "ok", "events": want[: len(got)]}, {"status": "ok", "events": got}, "all", _TOLERANCE
    )


def without_guilty_line(program: bytes, verdict: Verdict) -> bytes | None:
    """The program without the first line that reads as the guilty one; None when there is none."""
    guilty = _squeezed(verdict.text)
    lines = program.decode("latin-1").split("\n")
    at = next((index for index, line in enumerate(lines) if guilty and _squeezed(line) == guilty), None)
    return None if at is None else "\n".join([*lines[:at], *lines[at + 1 :]]).encode("latin-1")

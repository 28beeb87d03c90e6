"""Whether gcodesim and LinuxCNC make the same of a program."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from linuxcnc import CORPUS, Verdict

from gcodesim import canon
from gcodesim.canon.listing import listing
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, ToolTable, interpret
from gcodesim.rs274.control import Control
from gcodesim.rs274.parameters import PROBE
from gcodesim.rs274.probing import tripped
from gcodesim.rs274.run import Run

sys.path.insert(0, str(Path(__file__).parents[1] / "programs"))

from corpus import compare

_MOST_BLOCKS = 50_000
_TOLERANCE = 1e-4  # mm
_SHORT_OF_END = 0.254e-3  # [m]
_TRUE_CHANGE_OF_UNIT = Control.change_unit


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
        if event["kind"] == "spline" and event.get("end") is not None:
            event = {**event, "end": event["end"][:3]}
        out.append(event)
    return out


@dataclass(frozen=True, slots=True)
class Comparison:
    """What gcodesim makes of a program beside LinuxCNC: how it differs, the run, its events in the normal form."""

    differences: list[str]
    run: Run
    events: list[dict[str, Any]]

    @property
    def before(self) -> list[dict[str, Any]]:
        """The events of gcodesim up to the first that differs."""
        match = re.match(r"event (\d+) ", self.differences[0]) if self.differences else None
        return self.events if match is None else self.events[: int(match[1]) + 1]

    @property
    def refused_line(self) -> str:
        """The text of the line that gcodesim refuses."""
        failed = self.run.failed
        return "" if failed is None else self.run.sources[failed.span.file].line(failed.span.line)

    @property
    def shown(self) -> tuple[dict[str, Any], dict[str, Any]] | None:
        """The first event that differs, as LinuxCNC and as gcodesim have it."""
        found = [
            json.loads(part) for part in re.findall(r"^  (?:expected|actual) +(\{.*\})$", self.differences[0], re.M)
        ]
        return (found[0], found[1]) if len(found) == 2 else None


def differences(program: bytes, verdict: Verdict, ours: Settings) -> list[str]:
    """How gcodesim differs from LinuxCNC's `verdict`: acceptance, guilty line, events to 0.0001 mm; empty if not."""
    return compared(program, verdict, ours).differences


def compared(program: bytes, verdict: Verdict, ours: Settings) -> Comparison:
    """`program` run by gcodesim beside LinuxCNC's `verdict`."""
    run = interpret(SourceText("program.ngc", program), ours)
    printed = listing(_as_standalone(run), None)["events"]
    found = _differences(run, printed, verdict)
    return Comparison(found, run, compare().canonical(_comparable(printed), "all", _TOLERANCE) if found else [])


def _differences(run: Run, printed: list[dict[str, Any]], verdict: Verdict) -> list[str]:
    failed = run.failed
    if verdict.status == "endless":
        return [] if failed is not None and failed.code == "GS134" else ["LinuxCNC does not end"]
    if failed is not None and failed.code == "GS134":
        return [f"no end within {_MOST_BLOCKS} blocks; LinuxCNC: {verdict.status}"]
    if verdict.status == "error":
        if failed is None:
            return [f"accepted; LinuxCNC: {verdict.message} in `{verdict.text.strip()}`"]
        return _same_line(run, verdict) or _same_beginning(verdict.events, printed)
    if failed is not None:
        return [f"refused by {failed.code} {failed.message} in line {failed.span.line}; LinuxCNC accepts"]
    theirs, mine = _comparable(verdict.events), _comparable(printed)
    if verdict.complaint:  # the preview went another way, so no points of splines are known
        theirs, mine = _without_curves(theirs), _without_curves(mine)
    return compare().compare({"status": "ok", "events": theirs}, {"status": "ok", "events": mine}, "all", _TOLERANCE)


def _as_standalone(run: Run) -> list[canon.Event]:
    """The events of a run on the machine that the standalone interpreter makes up.

    A probe stops short of its end, and yet the end is what is stored. Asked for the tool offset after a change of
    unit, it answers with the same numbers.
    """
    with (
        mock.patch("gcodesim.rs274.executor.tripped", _tripped),
        mock.patch.object(Control, "change_unit", _change_unit),
    ):
        return _as_probed(run)


def _tripped(control: Control, event: canon.ProbeMove, reply: canon.Axes | None, *, meets: bool = True) -> None:
    tripped(control, event, None, meets=meets)
    stored = {PROBE + axis: control.parameters.get(PROBE + axis) for axis in range(9)}
    tripped(control, event, reply, meets=meets)
    control.parameters.numbers |= stored


def _change_unit(control: Control, unit: float) -> None:
    offset = control.state.tool_offset
    _TRUE_CHANGE_OF_UNIT(control, unit)
    control.state.tool_offset = offset


def _as_probed(run: Run) -> list[canon.Event]:
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
        if isinstance(event, canon.ProbeMove) and length > 0.0:
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

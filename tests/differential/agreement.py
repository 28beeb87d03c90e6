"""Whether gcodesim and LinuxCNC make the same of a program."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from linuxcnc import CORPUS, Verdict

from gcodesim.canon.listing import listing
from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, ToolTable, interpret
from gcodesim.rs274.run import Run

sys.path.insert(0, str(Path(__file__).parents[1] / "programs"))

from corpus import compare

_MOST_BLOCKS = 50_000
_TOLERANCE = 1e-4  # mm


def settings() -> Settings:
    """The setup of the corpus."""
    table, problems = ToolTable.read(SourceText.read(CORPUS / "tools.tbl"))
    assert not problems
    return Settings(tool_table=table, subroutines=(CORPUS / "subs",), max_blocks=_MOST_BLOCKS)


def _comparable(events: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Without what the two listings show each in its own way.

    A negative dwell, which ends at once, is no event here; an empty PRINT is lost by `oracle.py`; of splines the
    preview, which gives their points, loses A, B and C.
    """
    out = []
    for event in events:
        if (event["kind"] == "dwell" and event["seconds"] <= 0) or (event["kind"] == "print" and not event["text"]):
            continue
        if event["kind"] == "spline" and event["end"] is not None:
            event = {**event, "end": event["end"][:3]}
        out.append(event)
    return out


def differences(program: bytes, verdict: Verdict, ours: Settings) -> list[str]:
    """How gcodesim differs from LinuxCNC's `verdict`: acceptance, guilty line, events to 0.0001 mm; empty if not."""
    run = interpret(SourceText("program.ngc", program), ours)
    events = list(run)
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
    if verdict.complaint:
        return [f"the two ways into LinuxCNC disagree: {verdict.complaint}"]
    expected = {"status": "ok", "events": _comparable(verdict.events)}
    mine = {"status": "ok", "events": _comparable(listing(events, None)["events"])}
    return compare().compare(expected, mine, "all", _TOLERANCE)


def _same_line(run: Run, verdict: Verdict) -> list[str]:
    """LinuxCNC gives the text of the line, not its number."""
    assert run.failed is not None
    number = run.failed_line or 0
    texts = [source.lines[number - 1] for source in run.sources.values() if 0 < number <= len(source.lines)]
    guilty = _squeezed(verdict.text)
    cut = len(verdict.text) > 250  # LinuxCNC keeps no more of a line
    if any(_squeezed(text) == guilty or (cut and _squeezed(text).startswith(guilty)) for text in texts):
        return []
    return [
        f"refused in line {number} `{texts[0].strip() if texts else ''}` ({run.failed.code} {run.failed.message}); "
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

"""`gcodesim info LOG`: what a log is, what it was made from, and whether it is complete."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.nearest import no_such
from gcodesim.cli.options import add_format
from gcodesim.cli.outline import may_be

if TYPE_CHECKING:
    from gcodesim.log.summary import LogSummary, TopicSummary

MOST_FINDINGS = 20
"""Findings that are shown; JSON has all."""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "info",
        help="what a log is, what it was made from, whether it is complete",
        description="Say what a log holds: program, cell, duration, findings, topics, attached files; "
        "and whether it is whole, was cut off or is damaged, and then what is missing.",
    )
    parser.add_argument(
        "log",
        type=Path,
        metavar="LOG",
        help="a run.mcap, the folder of a run, or the run.mcap.part of one that was killed",
    )
    add_format(parser)
    parser.add_argument(
        "--fail-on",
        choices=("incomplete", "never"),
        default="never",
        help="exit with status 1 when the log is not whole: cut off, damaged, or of a run that was interrupted "
        "(default: never)",
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="do not read the whole file for its checksum, only the index and what is shown: damage elsewhere stays "
        "unseen",
    )
    parser.add_argument(
        "--extract",
        type=Path,
        metavar="DIR",
        help="also write the attached files there: program, cell, layout.json for the viewer",
    )
    layout = parser.add_argument(
        "--layout",
        metavar="KIND",
        nargs="?",
        const="",
        help="print the viewer's layout and nothing else: the one that the log carries, or one for milling, robot or "
        "process work",
    )
    may_be(layout, _layouts)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.output import print_json
    from gcodesim.files.output_folder import LOG_NAME
    from gcodesim.log.logfile import LogFile, LogReadError
    from gcodesim.log.summary import summary
    from gcodesim.playback.stored_results import final_findings

    if arguments.log.is_dir():
        arguments.log /= LOG_NAME
    try:
        if arguments.layout is not None:
            print(_layout(arguments.log, arguments.layout), end="")
            return OK
        facts = summary(arguments.log, check=not arguments.quick)
        if facts.findings and "results.json" in facts.attachments:  # these have final numbers
            log = LogFile.open(facts.path, lenient=True)
            facts = replace(facts, findings=final_findings(log, facts.findings))
    except FileNotFoundError:
        raise UsageError(f"log {arguments.log} is not there") from None
    except (LogReadError, OSError) as error:
        raise UsageError(f"log {arguments.log} cannot be read: {error}") from None
    # valid even if nobody reads the output to its end
    arguments.status = FINDINGS if arguments.fail_on == "incomplete" and not facts.complete else OK
    if arguments.format == "json":
        print_json(_as_json(facts))
    else:
        _print(facts)
    if arguments.extract is not None:
        _extract(arguments.log, arguments.extract, said=arguments.format != "json")
    return int(arguments.status)


def _layouts() -> list[str]:
    from gcodesim.log.layout import KINDS

    return list(KINDS)


def _print(facts: LogSummary) -> None:
    from gcodesim.cli.output import print_table
    from gcodesim.units import MM3

    counts = ", ".join(f"{n} {name}{'' if n == 1 else 's'}" for name, n in _findings_by_severity(facts).items() if n)
    print(f"{facts.path}: {facts.verdict}{f', with {counts}' if counts else ''}")
    if facts.problem:
        print(f"  {facts.problem}")
    run, rows = facts.run, list[tuple[str, str]]()
    rows += [(name, run[name]) for name in ("program", "cell", "world") if name in run]
    rows += [("written by", facts.library)]
    rows += [("duration", _duration(facts.duration_ns))]
    step, period = (_number(run.get(name)) for name in ("step_ns", "log_period_ns"))
    if step is not None and period is not None:
        rows += [("steps", f"{step * 1e-6:g} ms; every {period * 1e-6:g} ms in the log")]
    if "blocks" in facts.result:
        rows += [("blocks", facts.result["blocks"])]
    removed = _number(facts.result.get("removed_m3"))
    if removed is not None:
        rows += [("added" if removed < 0.0 else "removed", f"{abs(removed / MM3):.1f} mm³")]
    rows += _peaks(facts.result)
    rows += [("file", f"{_bytes(facts.size)} in {facts.chunks} chunk{'' if facts.chunks == 1 else 's'}")]
    rows += [("attached", ", ".join(f"{name} ({_bytes(size)})" for name, size in facts.attachments.items()) or "none")]
    rows += [("missing", text) for text in facts.missing]
    width = max(len(name) for name, _ in rows)
    for name, text in rows:
        print(f"  {name.ljust(width)}  {text}")
    shown = sorted(facts.findings, key=lambda f: ("error", "warning", "note").index(f.severity))[:MOST_FINDINGS]
    if shown:
        print()
    for finding in sorted(shown, key=lambda f: f.t_ns):
        place = f"{finding.file}:{finding.line}" if finding.line else finding.file
        at = f"{finding.t_ns * 1e-9:.3f} s"
        print(f"  {at.rjust(10)}  {finding.severity} {finding.code} {place}: {finding.message}")
    if len(facts.findings) > len(shown):
        print(f"  … and {len(facts.findings) - len(shown)} more; `--format json` has all")
    print()
    print_table(
        [
            ["topic", "schema", "messages", "rate"],
            *(
                [name, schema, str(count), f"{rate:.3g}/s" if count > 1 else "once"]
                for name, schema, count, rate in _topic_rows(facts.topics)
            ),
        ],
        names=2,
    )


def _peaks(result: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """The greatest force, torque, power … of the run, as its results have them."""
    from gcodesim.playback.columns import shown_as

    for name, text in result.items():
        value = _number(text)
        if name.startswith("max_") and value:
            title, unit, divisor = shown_as(name.removeprefix("max_"))
            yield f"greatest {title}", f"{value / divisor:.4g} {unit}".strip()


def _number(text: str | None) -> float | None:
    """The number in a record of the log; None if there is none, or if the record was edited."""
    try:
        value = float(text or "")
    except ValueError:
        return None
    return value if isfinite(value) else None


def _topic_rows(topics: Sequence[TopicSummary]) -> Iterator[tuple[str, str, int, float]]:
    """Name, schema, messages and rate; numbered topics, such as tiles, are in one row."""
    for (stem, schema), group in groupby(topics, lambda topic: (topic.name.rstrip("0123456789"), topic.schema)):
        one = list(group)
        first, last = one[0].name, one[-1].name[len(stem) :]
        name = first if len(one) == 1 else f"{first} … {last}"
        yield name, schema, sum(topic.count for topic in one), sum(topic.rate for topic in one)


def _as_json(facts: LogSummary) -> dict[str, Any]:
    from gcodesim.numbers import clean

    place = facts.stopped_at
    value: dict[str, Any] = clean(
        {
            "schema": "gcodesim-info/1",
            "file": facts.path.name,
            "verdict": facts.verdict,
            "complete": facts.complete,
            "state": facts.state,
            "problem": facts.problem or None,
            "missing": facts.missing,
            "damage": [
                {
                    "what": damage.what,
                    "byte": damage.offset,
                    "from_s": None if damage.first_ns is None else damage.first_ns * 1e-9,
                    "to_s": None if damage.last_ns is None else damage.last_ns * 1e-9,
                    "problem": damage.reason,
                }
                for damage in facts.damage
            ],
            "stopped_at": {"file": place.file, "line": place.line, "text": place.text}
            if place is not None and not (facts.complete and facts.state == "finished")
            else None,
            "duration_s": facts.duration_ns * 1e-9,
            "bytes": facts.size,
            "chunks": facts.chunks,
            "written_by": facts.library,
            "run": facts.run,
            "result": facts.result,
            "findings": [
                {
                    "time_s": finding.t_ns * 1e-9,
                    "code": finding.code,
                    "severity": finding.severity,
                    "file": finding.file,
                    "line": finding.line,
                    "message": finding.message,
                }
                for finding in facts.findings
            ],
            "attachments": [{"name": name, "bytes": size} for name, size in facts.attachments.items()],
            "topics": [
                {"name": topic.name, "schema": topic.schema, "count": topic.count, "rate_Hz": topic.rate}
                for topic in facts.topics
            ],
        }
    )
    return value


def _findings_by_severity(facts: LogSummary) -> dict[str, int]:
    return {
        severity: sum(finding.severity == severity for finding in facts.findings)
        for severity in ("error", "warning", "note")
    }


def _duration(t_ns: int) -> str:
    """`1 h 4 min 12.252 s`."""
    minutes, rest = divmod(t_ns, 60_000_000_000)
    hours, minutes = divmod(minutes, 60)
    parts = [f"{hours} h"] if hours else []
    parts += [f"{minutes} min"] if hours or minutes else []
    return " ".join([*parts, f"{rest * 1e-9:.3f} s"])


def _bytes(size: int) -> str:
    for unit, factor in (("MB", 1e6), ("kB", 1e3)):
        if size >= factor:
            return f"{size / factor:.3g} {unit}"
    return f"{size} B"


def _layout(path: Path, kind: str) -> str:
    """The layout that the log carries, or one of `kind` for its contents."""
    from gcodesim.log.layout import KINDS, layout, view_of
    from gcodesim.log.logfile import LogFile, LogReadError
    from gcodesim.log.reader import decoded, process_fields_of

    if kind and kind not in KINDS:
        raise UsageError(no_such("layout", kind, KINDS))
    log = LogFile.open(path, lenient=True)
    try:
        own = log.attachment("layout.json")
    except KeyError:
        raise LogReadError("it carries no layout") from None
    if not kind:
        return own.decode()
    joints = next((state.joints for _, state in decoded(log, "/joint_states")), ())
    last = next((program for _, program in decoded(log, "/program", backwards=True)), None)
    outputs = [] if last is None else [output.name for output in last.outputs]
    return layout(kind, [joint.name for joint in joints], outputs, view_of(own), process_fields_of(log)).decode()


def _extract(log: Path, folder: Path, *, said: bool) -> None:
    """Write every attachment of `log` into `folder`; an existing file is kept, and is an error."""
    from gcodesim.cli.output import note
    from gcodesim.files.whole_file import write_whole
    from gcodesim.log.logfile import LogFile

    opened = LogFile.open(log, lenient=True)
    # a name may come from anywhere, so only its last part is used
    files = {Path(name).name: name for name in opened.attachments}
    present = [name for name in files if os.path.lexists(folder / name)]
    if present:
        raise UsageError(f"{folder / present[0]} is there already; nothing was written")
    contents = {own: opened.attached(name) for own, name in files.items()}
    whole = {own: data for own, data in contents.items() if data is not None}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for own, data in whole.items():
            write_whole(folder / own, data)
    except OSError as error:
        raise UsageError(f"{folder} cannot be written: {error.strerror}") from None
    if said:
        print(f"\nwrote {', '.join(whole) or 'nothing'} into {folder}")
    for own in contents:
        if own not in whole:
            note(f"gcodesim: {own} is damaged in the log and was not written")

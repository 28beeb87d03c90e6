"""A program for another control, with the proof that both controls are told the same."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import zip_longest
from typing import Any, Final

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, Severity, SourceText, Span
from gcodesim.frozen import frozen
from gcodesim.post.gcode_program import PRINTERS, GcodeLine, GcodeWriter, NotTranslatedError
from gcodesim.rs274 import Settings, ToolTable, interpret
from gcodesim.rs274.assumed import assumed_tools

_BESIDE: Final = re.compile(r"\bG\s*0*4[12](?![\d.])|(?<=[\d.\s])G\s*0*4[12](?![\d.])", re.IGNORECASE)
_COMMENT: Final = re.compile(r"\([^)]*\)|;.*$")
_LENGTH, _APART = 0.1, 1e-4  # [m] of tools that nobody knows, and how they differ
_CLOSE: Final = 1e-9  # [m, rad] that the last digit of a word may make
_CLOSE_OF: Final = {
    "fanuc": 7.5e-7,
    "fanuc_lathe": 7.5e-7,
    "fanuc_lathe_b": 7.5e-7,
}  # half an increment in each of two directions, and more
_OF_TIME: Final = 700.0  # [s/m] a dwell has as many digits in s as a way in mm
_NEAR: Final = 1e-6  # share of a feed or speed
_SILENT: Final = (
    canon.ToolSelect, canon.WorkSystem, canon.PlannerLimits, canon.SectionStart, canon.Override, canon.Message,
    canon.Print, canon.Log, canon.EndOfFile, canon.PalletShuttle, canon.PathMode, canon.End, canon.OptionalStop,
)  # fmt: skip


@frozen
class Translation:
    """The text for the other control, or None where it cannot be, and what there is to say."""

    text: str | None
    findings: tuple[Diagnostic, ...]


def translated(program: SourceText, settings: Settings, dialect: str) -> Translation:
    """`program`, read with `settings`, for the control of `dialect`.

    Loops, calls, parameters and cycles are unrolled. The new text is read by the reader of that dialect, and does the
    same: moves, feeds, tools, spindle, coolant, dwells, outputs; else there is none, and a finding says where.
    Without a tool table in the `settings` every tool has a length of its own, and none may be compensated for.
    """
    known = bool(settings.tool_table)
    if not known:
        printer = settings.dialect in PRINTERS
        settings = replace(settings, tool_table=assumed_tools(program) if printer else _lengths_of_their_own(program))
    run = interpret(program, settings)
    events = list(run)
    errors = [finding for finding in run.findings if finding.level >= Severity.ERROR]
    if errors:
        return Translation(text=None, findings=tuple(errors))
    if not known and (beside := _compensated(run.sources)) is not None:
        return Translation(text=None, findings=(_refused("the diameter of the tool is not known, and counts", beside),))
    by_hand: list[Diagnostic] = []
    if dialect == "grbl":
        events, by_hand = _without_first_tool(events)
    writer = GcodeWriter(dialect, settings, program.name)
    try:
        lines = list(writer.lines(iter(events)))
    except NotTranslatedError as reason:
        return Translation(text=None, findings=(_refused(f"{dialect} cannot say {reason}", reason.span),))
    text = "".join(f"{line.text}\n" for line in lines)
    fault = _fault(events, lines, text, replace(settings, dialect=dialect))
    if fault is not None:
        return Translation(text=None, findings=(fault,))
    return Translation(text=text, findings=(*by_hand, *writer.findings))


def _lengths_of_their_own(program: SourceText) -> ToolTable:
    """All tools that a program names, each with another length, so that G43 tells which."""
    return ToolTable(
        {
            number: replace(entry, offset=(0.0, 0.0, _LENGTH + number * _APART, *entry.offset[3:]))
            for number, entry in assumed_tools(program).items()
        }
    )


def _compensated(sources: Mapping[str, SourceText]) -> Span | None:
    """The first line that compensates for the radius of a tool by its number."""
    for name, source in sources.items():
        for number, line in enumerate(source.lines, start=1):
            if _BESIDE.search(_COMMENT.sub("", line)):
                return Span.of_line(name, number, line)
    return None


def _without_first_tool(events: list[canon.Event]) -> tuple[list[canon.Event], list[Diagnostic]]:
    """The events without a tool change before anything moves: on a control without M6 that is done by hand."""
    for number, event in enumerate(events):
        if isinstance(event, canon.Move):
            break
        if isinstance(event, canon.ToolChange):
            told = Diagnostic(
                code="GS802",
                span=event.span,
                message=f"not posted: the first tool, T{event.tool}",
                hint="put it in by hand; the control has no M6",
            )
            return [*events[:number], *events[number + 1 :]], [told]
    return events, []


def _refused(message: str, span: Span) -> Diagnostic:
    return Diagnostic(
        code="GS801", span=span, message=f"not posted: {message}", hint="choose another control, or change this line"
    )


def _fault(events: list[canon.Event], lines: list[GcodeLine], text: str, settings: Settings) -> Diagnostic | None:
    """What the other control would not do, or do otherwise."""
    run = interpret(SourceText("posted", text.encode()), settings)
    again = list(run)
    for finding in run.findings:
        if finding.level >= Severity.ERROR:
            span = lines[finding.span.line - 1].span if 0 < finding.span.line <= len(lines) else Span("")
            return _refused(f"{settings.dialect} cannot say this: {finding.message}", span)
    close = _CLOSE_OF.get(settings.dialect, _CLOSE)
    for before, after in zip_longest(_acts(events), _acts(again)):
        if before is None or after is None or not _alike(before[0], after[0], close):
            span = (before or after)[1]
            return _refused(f"{settings.dialect} would do something else here", span)
    return None


def _acts(events: Iterable[canon.Event]) -> Iterator[tuple[tuple[Any, ...], Span]]:
    """What a machine is made to do, with its place; states only where they change."""
    held: dict[str, tuple[Any, ...]] = {
        "Spindle": ("Spindle", "off", 0.0, "rad/s", 0.0),
        "Coolant": ("Coolant", False, False),
        "ToolOffset": ("ToolOffset", *(0.0,) * 6),
    }
    at: canon.Point | None = None
    for event in events:
        if isinstance(event, _SILENT):
            continue
        if isinstance(event, canon.SplineFeed):
            for point in event.points:
                if point != at:
                    yield ("LinearFeed", *point, *event.end[3:], event.feed, event.feed_unit), event.span
                at = point
            continue
        if isinstance(event, canon.Move):
            at = event.end[:3]
        act = _act(event)
        if act[0] in held:
            if held[act[0]] == act:
                continue
            held[act[0]] = act
        yield act, event.span


def _act(event: canon.Event) -> tuple[Any, ...]:
    name = type(event).__name__
    if isinstance(event, canon.Rapid):
        return (name, *event.end, event.home)
    if isinstance(event, canon.LinearFeed):
        thread = () if event.pitch is None else (event.pitch,)
        feed = () if event.pitch is not None else (event.feed, event.feed_unit)
        return (name, *event.end, *feed, *thread, *((event.extrude,) if event.extrude else ()))
    if isinstance(event, canon.ArcFeed):
        shape = (*event.center, *event.normal, event.sweep, event.turns)
        return (name, *event.end, *shape, event.feed, event.feed_unit, event.extrude)
    if isinstance(event, canon.Spindle):
        if event.direction == "off":
            return (name, "off", 0.0, "rad/s", 0.0)
        return (name, event.direction, event.speed, event.unit, event.max_speed or 0.0)
    if isinstance(event, canon.Extrude):
        return (name, event.length, event.feed, event.by_firmware)
    flat: list[Any] = [name]
    for field in type(event).__dataclass_fields__:
        if field not in ("span", "block", "word"):
            value = getattr(event, field)
            flat += value if isinstance(value, tuple) else [value]
    return tuple(flat)


def _alike(before: tuple[Any, ...], after: tuple[Any, ...], close: float) -> bool:
    """Whether two acts are one, up to `close` [m, rad], or what that makes of an arc's sweep."""
    if len(before) != len(after) or before[0] != after[0]:
        return False
    if before[0] == "ArcFeed":
        reach = max(math.dist(before[1:4], before[7:10]), close)
        sweep = 7 + 6
        if abs(before[sweep] - after[sweep]) > 4.0 * close / reach + _NEAR * abs(before[sweep]):
            return False
        before, after = (*before[:sweep], *before[sweep + 1 :]), (*after[:sweep], *after[sweep + 1 :])
    if before[0] == "Dwell":
        close *= _OF_TIME
    for one, other in zip(before, after, strict=True):
        numbers = isinstance(one, float | int) and isinstance(other, float | int)
        if not (abs(one - other) <= close + _NEAR * abs(one) * (abs(one) < 1e9) if numbers else one == other):
            return False
    return True

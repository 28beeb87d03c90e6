"""Differences as people and programs read them: text, JSON, Markdown for a pull request."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any, Final

from gcodesim.diagnostics.plain import one_line
from gcodesim.frozen import frozen
from gcodesim.numbers import clean
from gcodesim.regress.changes import (
    Change,
    ChangedLine,
    Comparison,
    FieldChange,
    FindingChange,
    MoveChange,
    SurfaceChange,
)

NO_DIFFERENCE: Final = "no difference in motion or result"
_MOST_OF_A_TEXT: Final = 200  # entries under a title on a screen
_MOST_OF_A_PAGE: Final = 100  # entries of a kind in Markdown: sites take 65,000 characters for a comment


@frozen
class Entry:
    """One difference as lines of text, and its place on either side, if it has one there."""

    lines: tuple[str, ...]
    old: ChangedLine | None = None
    new: ChangedLine | None = None


def number(value: float) -> str:
    """Seven digits at most, without an exponent where people would have to decode it."""
    text = f"{value:.7g}"
    return f"{value:.0f}" if "e+" in text else text


def signed(value: float) -> str:
    return f"{'+' if value >= 0.0 else '−'}{number(abs(float(f'{value:.4g}')))}"


def value_text(value: Any) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return number(float(value)).replace("-", "−")
    return str(value)


def allowance(tolerance: str, allowed: float | None, unit: str) -> str:
    """``tolerance `volume` allows 0.5 mm³``; empty if nothing is allowed."""
    if not tolerance or allowed is None:
        return ""
    return f"tolerance `{tolerance}` allows {number(float(f'{allowed:.3g}'))}{unit}"


def change_text(change: Change) -> str:
    """`stocks.stock.removed_mm3: 656.5 → 687.9 mm³ (+31.4; tolerance `volume` allows 0.657 mm³)`."""
    unit = f" {change.unit}" if change.unit else ""
    if isinstance(change.old or change.new, Mapping):
        return f"{change.quantity} {'came' if change.old is None else 'went'}"
    if change.delta is None:
        return f"{change.quantity}: {value_text(change.old)} → {value_text(change.new)}"
    limit = allowance(change.tolerance, change.allowed, unit)
    if change.allowed is not None and abs(change.delta) <= change.allowed:
        limit = f"within tolerance `{change.tolerance}`"
    return (
        f"{change.quantity}: {value_text(change.old)} → {value_text(change.new)}{unit} "
        f"({signed(change.delta)}{f'; {limit}' if limit else ''})"
    )


def field_text(field: FieldChange) -> str:
    unit = f" {field.unit}" if field.unit else ""
    if field.name in ("arc", "way"):
        assert isinstance(field.new, float)
        return f"{field.name} runs {number(field.new)} mm beside ({allowance(field.tolerance, field.allowed, unit)})"
    if field.delta is None:
        return f"{field.name} {value_text(field.old)} → {value_text(field.new)}{unit}"
    limit = allowance(field.tolerance, field.allowed, unit)
    return (
        f"{field.name} {value_text(field.old)} → {value_text(field.new)}{unit} "
        f"({signed(field.delta)}{f'; {limit}' if limit else ''})"
    )


def _line(place: ChangedLine) -> str:
    return f"{place}{f': {place.text}' if place.text else ''}"


def _steps(count: int) -> str:
    return f"{count} step{'' if count == 1 else 's'}"


def _until(move: MoveChange) -> str:
    """How far a folded change extends."""
    if move.count == 1:
        return ""
    last = move.last_new or move.last_old
    return f" and {_steps(move.count - 1)} more to line {last.line}" if last is not None else ""


def move_message(move: MoveChange) -> str:
    """One line to be shown beside the place: what happened to which step."""
    if move.kind == "changed":
        fields = ", ".join(field_text(field) for field in move.fields)
        return f"{move.what}{_until(move)} changed: {fields}"
    return _came_or_went(move)


def _move_lines(move: MoveChange) -> Iterator[str]:
    if move.kind == "changed":
        assert move.old is not None and move.new is not None
        yield f"− {_line(move.old)}"
        yield f"+ {_line(move.new)}"
        if move.count > 1:
            yield f" {_until(move)}, in the same way"
        yield from (f"    {field_text(field)}" for field in move.fields)
        return
    place, sign = (move.new, "+") if move.kind == "inserted" else (move.old, "−")
    assert place is not None
    yield f"{sign} {_line(place)}"
    yield f"    {_came_or_went(move)}"


def _came_or_went(move: MoveChange) -> str:
    """`line and 2 steps more to line 9 inserted, 34.6 mm of way`."""
    way = f", {number(move.way_mm)} mm of way" if move.way_mm else ""
    return f"{_named(move)}{_until(move)} {move.kind}{way}"


def _named(move: MoveChange) -> str:
    return f"{move.what} ({move.detail})" if move.detail else move.what


def surface_text(surface: SurfaceChange) -> str:
    old, new = (("no material" if h is None else f"Z{number(h)}") for h in (surface.old_mm, surface.new_mm))
    kind = "" if surface.exact else " on the coarse surface"
    return (
        f"surface of {surface.stock}: {number(surface.deviation_mm)} mm off at X{number(surface.x_mm)} "
        f"Y{number(surface.y_mm)} of its own axes{kind}, {old} → {new}, over {number(surface.area_mm2)} mm² "
        f"({allowance('surface', surface.allowed_mm, ' mm')})"
    )


def finding_text(change: FindingChange) -> str:
    one = change.shown
    place = f"{one['file']}:{one['line']}" if one["line"] else one["file"]
    text = f"{change.kind} {place}: {one['severity']} {one['code']}: {one['message']}"
    if change.kind == "changed" and change.old is not None:
        text += f" (was: {change.old['message']}{_times(change.old)})"
    return text + _times(one)


def _times(finding: dict[str, Any]) -> str:
    return f" ({finding['count']} times)" if finding.get("count", 1) > 1 else ""


def comparison_lines(comparison: Comparison) -> list[str]:
    """Text for people."""
    lines: list[str] = []
    for title, entries in sections(comparison):
        lines.append(f"{title}:")
        lines += [f"  {line}" for entry in entries[:_MOST_OF_A_TEXT] for line in entry.lines]
        if len(entries) > _MOST_OF_A_TEXT:
            lines.append(f"  … and {len(entries) - _MOST_OF_A_TEXT} more; `--format json` has all")
    return [*lines, *(f"note: {remark}" for remark in comparison.remarks)]


def sections(comparison: Comparison) -> Iterator[tuple[str, list[Entry]]]:
    """All differences under their titles, none of them empty: in all, motion, results, surface, findings."""
    if comparison.totals and not comparison.same:
        yield "in all", [Entry(lines=(change_text(change),)) for change in comparison.totals]
    if comparison.moves:
        yield "motion", [Entry(lines=tuple(_move_lines(m)), old=m.old, new=m.new) for m in comparison.moves]
    told = {change.quantity for change in comparison.totals}
    changes = [change for change in comparison.changes if change.quantity not in told]
    if changes:
        yield "results", [Entry(lines=(change_text(change),)) for change in changes]
    if comparison.surfaces:
        yield "surface", [Entry(lines=(surface_text(surface),)) for surface in comparison.surfaces]
    if comparison.findings:
        yield "findings", [_finding_entry(change) for change in comparison.findings]


def _finding_entry(change: FindingChange) -> Entry:
    old, new = (
        None if one is None else ChangedLine(file=one["file"], line=one["line"]) for one in (change.old, change.new)
    )
    return Entry(lines=(finding_text(change),), old=old, new=new)


def summary(comparison: Comparison) -> str:
    """The last line: how many differences, and which tolerances they break."""
    if comparison.same:
        return NO_DIFFERENCE
    count = comparison.count
    broken = broken_tolerances(comparison)
    told = f"; broken tolerances: {', '.join(broken)}" if broken else ""
    return f"{count} difference{'' if count == 1 else 's'} beyond tolerance{told}"


def broken_tolerances(comparison: Comparison) -> tuple[str, ...]:
    """Names of the tolerances that are broken, each once."""
    names = [field.tolerance for move in comparison.moves for field in move.fields]
    names += [change.tolerance for change in comparison.changes]
    names += ["surface"] * bool(comparison.surfaces)
    return tuple(name for name in dict.fromkeys(names) if name)


def as_json(comparison: Comparison) -> dict[str, Any]:
    """All of it, with `same` and the names of the quantities that differ."""
    value: dict[str, Any] = clean(
        {
            "same": comparison.same,
            "quantities": list(comparison.quantities),
            "broken_tolerances": list(broken_tolerances(comparison)),
            **asdict(comparison),
        }
    )
    return value


def as_markdown(comparison: Comparison, title: str) -> str:
    """A comment for a pull request."""
    lines = [f"### {_escaped(title)}", "", _escaped(summary(comparison)) + "."]
    rows = [
        *comparison.totals,
        *(c for c in comparison.changes if c.quantity not in {t.quantity for t in comparison.totals}),
    ]
    if rows and not comparison.same:
        lines += ["", "| quantity | old | new | difference | allowed |", "|---|---:|---:|---:|---:|"]
        lines += [_row(change) for change in rows]
    if comparison.moves:
        lines += ["", "**Motion**", "", "```diff", *_diff_lines(comparison.moves[:_MOST_OF_A_PAGE]), "```"]
        lines += _rest(comparison.moves)
    if comparison.surfaces:
        lines += ["", *(f"- {_escaped(surface_text(surface))}" for surface in comparison.surfaces)]
    if comparison.findings:
        shown = comparison.findings[:_MOST_OF_A_PAGE]
        lines += ["", "**Findings**", "", *(f"- {_escaped(finding_text(change))}" for change in shown)]
        lines += _rest(comparison.findings)
    lines += ["", *(f"_{_escaped(remark)}_" for remark in comparison.remarks)] if comparison.remarks else []
    return "\n".join(lines) + "\n"


def _rest(entries: Sequence[object]) -> list[str]:
    more = len(entries) - _MOST_OF_A_PAGE
    return ["", f"… and {more} more"] if more > 0 else []


def _row(change: Change) -> str:
    unit = f" {change.unit}" if change.unit else ""
    difference = "" if change.delta is None else f"{signed(change.delta)}{unit}"
    allowed = "" if change.allowed is None else f"{number(float(f'{change.allowed:.3g}'))}{unit}"
    mark = "**" if change.allowed is None or (change.delta is not None and abs(change.delta) > change.allowed) else ""
    old, new = ("there" if isinstance(v, Mapping) else value_text(v) for v in (change.old, change.new))
    cells = (
        f"`{change.quantity}`",
        old,
        new,
        f"{mark}{difference}{mark}",
        allowed,
    )
    return f"| {' | '.join(_escaped(cell) for cell in cells)} |".replace("****", "")


def _escaped(text: str) -> str:
    return one_line(text).replace("|", "\\|").replace("<", "&lt;").replace("](", "]\\(")


def _diff_lines(moves: Sequence[MoveChange]) -> Iterator[str]:
    """In the form that web sites colour as a diff."""
    for move in moves:
        if move.old is not None:
            yield f"- {_line(move.old)}"
        if move.new is not None:
            yield f"+ {_line(move.new)}"
        fields = ", ".join(field_text(field) for field in move.fields)
        yield f"  {f'{fields}{_until(move)}' if fields else _came_or_went(move)}".replace("```", "'''")


def totals(results: Mapping[str, Any]) -> list[str]:
    """The numbers that people ask for first: time, removed and deposited volume, greatest force."""
    if "time" not in results:
        return []
    parts = [f"{number(round(results['time']['total_s'], 3))} s"]
    for name, stock in results["stocks"].items():
        for what in ("removed", "deposited"):
            if stock[f"{what}_mm3"]:
                parts.append(f"{number(round(stock[f'{what}_mm3'], 3))} mm³ {what} of {name}")
    force = max((tool["max_force_N"] for tool in results["tools"]), default=0.0)
    return [*parts, f"at most {number(round(force, 3))} N"] if force else parts

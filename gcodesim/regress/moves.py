"""Compares two motions: which steps were inserted, removed or changed, and by how much."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final, TypeVar

from gcodesim.canon import AXIS_LETTERS
from gcodesim.frozen import frozen
from gcodesim.regress.align import GAP, Pair, align
from gcodesim.regress.changes import ChangedLine, FieldChange, MoveChange
from gcodesim.regress.motion import MOVES, MotionStep
from gcodesim.regress.tolerance import DEFAULTS, QUANTITIES, Tolerances

LineText = Callable[[str, int], str]
_V = TypeVar("_V")

_GRID: Final = 1e-4  # mm; positions of one key are equal after rounding to it
_PARTS: Final = tuple(i / 16 for i in range(17))
_UNLIKE: Final = 3.0 * GAP

# names and tolerances of words and numbers of steps: (kind or "", field) → name, tolerance
_NAMES: Final[Mapping[tuple[str, str], tuple[str, str]]] = {
    ("", "feed"): ("feed", "feed"),
    ("", "pitch"): ("pitch", "feed"),
    ("spindle", "speed"): ("spindle speed", "spindle"),
    ("spindle", "max_rpm"): ("spindle speed limit", "spindle"),
    ("spindle", "dir"): ("spindle", ""),
    ("dwell", "seconds"): ("dwell", "dwell"),
    ("arc", "ccw"): ("arc direction", ""),
    ("path_mode", "mode"): ("path mode", ""),
    ("path_mode", "tolerance"): ("path tolerance", "position"),
    ("path_mode", "naive"): ("path tolerance Q", "position"),
    ("orient", "angle"): ("spindle angle", "angle"),
    ("tool_change", "tool"): ("tool", ""),
    ("tool_select", "tool"): ("selected tool", ""),
    ("tool_number", "tool"): ("tool number", ""),
}


@frozen
class MotionComparison:
    """What differs, and `lines`: (file, line) of the old program → line of the new one, as steps were paired."""

    changes: tuple[MoveChange, ...]
    lines: Mapping[tuple[str, int], int]


def compare_motion(
    old: Sequence[MotionStep],
    new: Sequence[MotionStep],
    tolerances: Tolerances = DEFAULTS,
    *,
    old_text: LineText | None = None,
    new_text: LineText | None = None,
) -> MotionComparison:
    """Steps that were inserted, removed or changed; the `texts` give program lines for the places.

    A move that was cut into several, or several joined into one, is not a difference if the path is the same and
    there is no exact stop in between.
    """
    pairs = align(
        old,
        new,
        same=lambda a, b: _same(a, b, tolerances),
        keys=(_exactly, _target, _displacement),
        unlikeness=lambda a, b: _unlikeness(a, b, tolerances),
    )
    texts = (old_text or _no_text, new_text or _no_text)
    near: dict[int, int] = {}
    last = None
    for a, b in pairs:
        last = b if b is not None else last
        if a is not None and last is not None:
            near[a] = last
    hunks = _hunks(pairs, old, new, tolerances)
    changes = [
        (number, change)
        for number, hunk in enumerate(hunks)
        for change in _changes(hunk, old, new, tolerances, texts, near)
    ]
    lines: dict[tuple[str, int], int] = {}
    for a, b in pairs:
        if a is not None and b is not None:
            lines.setdefault((old[a].file, old[a].line), new[b].line)
    return MotionComparison(changes=_folded(changes), lines=lines)


def _no_text(_file: str, _line: int) -> str:
    return ""


def _rounded(values: Sequence[float]) -> tuple[int, ...]:
    return tuple(round(v / _GRID) for v in values)


def _exactly(step: MotionStep) -> Hashable:
    through = tuple(_rounded(point) for point in step.through)
    return (step.kind, step.words, step.numbers, None if step.end is None else _rounded(step.end), through)


def _target(step: MotionStep) -> Hashable:
    return (step.kind, step.words if step.end is None else _rounded(step.end))


def _displacement(step: MotionStep) -> Hashable:
    if step.end is None:
        return (step.kind, step.words)
    return (step.kind, _rounded([e - s for e, s in zip(step.end, step.start, strict=True)]))


def _unlikeness(a: MotionStep, b: MotionStep, tolerances: Tolerances) -> float:
    """Called for each cell of a table, so it only counts differences, without describing them."""
    if a.kind != b.kind:
        if a.kind not in MOVES or b.kind not in MOVES or a.end is None or b.end is None:
            return _UNLIKE
        return 0.6 if math.dist(a.end, b.end) < tolerances["position"].absolute + _GRID else 0.95
    fields = 0
    if a.end is not None and b.end is not None:
        near = tolerances["position"].absolute + _GRID
        fields = sum(abs(p - q) > near for p, q in zip(a.end, b.end, strict=True))
        fields += not fields and a.through != b.through
    if a.words != b.words:
        fields += max(1, len(set(a.words) ^ set(b.words)) // 2)
    if a.numbers != b.numbers:
        fields += max(1, len(set(a.numbers) ^ set(b.numbers)) // 2)
    return 0.0 if not fields else 0.2 + 0.6 * min(1.0, fields / 6.0)


def _same(a: MotionStep, b: MotionStep, tolerances: Tolerances) -> bool:
    if a.end == b.end and a.kind == b.kind and a.numbers == b.numbers and a.words == b.words and not a.through:
        return True
    return not differing(a, b, tolerances)


def differing(a: MotionStep, b: MotionStep, tolerances: Tolerances) -> list[FieldChange]:
    """The fields in which two steps differ beyond tolerance."""
    if a.kind != b.kind:
        return [FieldChange(name="move", old=_called(a.kind), new=_called(b.kind)), *_ends(a, b, tolerances)]
    found = [
        FieldChange(name=_name(a.kind, field)[0], old=_direction(field, x), new=_direction(field, y))
        for field, x, y in _both(a.words, b.words)
        if x != y
    ]
    for field, x, y in _both(a.numbers, b.numbers):
        name, tolerance = _name(a.kind, field)
        if x is None or y is None or not tolerances[tolerance].allows(x, y):
            found.append(
                FieldChange(
                    name=name,
                    old=x,
                    new=y,
                    unit=_unit(a, field, tolerance),
                    allowed=None if x is None else tolerances[tolerance].limit(x),
                    tolerance=tolerance,
                )
            )
    return [*_ends(a, b, tolerances), *_ways(a, b, tolerances, shaped=not found), *found]


def _both(a: Sequence[tuple[str, _V]], b: Sequence[tuple[str, _V]]) -> Iterator[tuple[str, _V | None, _V | None]]:
    left, right = dict(a), dict(b)
    for name in [*left, *(name for name in right if name not in left)]:
        yield name, left.get(name), right.get(name)


def _ends(a: MotionStep, b: MotionStep, tolerances: Tolerances) -> list[FieldChange]:
    """Ends that differ: in the program's own coordinates where those differ, else in the machine's."""
    if a.end is None or b.end is None:
        return []
    off = [
        i
        for i, (x, y) in enumerate(zip(a.end, b.end, strict=True))
        if not tolerances["position" if i < 3 else "angle"].allows(x, y)
    ]
    if not off:
        return []
    own_a, own_b = a.system.to_program(a.end), b.system.to_program(b.end)
    own = [i for i in range(6) if not tolerances["position" if i < 3 else "angle"].allows(own_a[i], own_b[i])]
    from_a, from_b, prefix = (own_a, own_b, "") if own else (a.end, b.end, "machine ")
    return [_axis(prefix + AXIS_LETTERS[i], i, from_a[i], from_b[i], tolerances) for i in own or off]


def _axis(name: str, axis: int, old: float, new: float, tolerances: Tolerances) -> FieldChange:
    tolerance = "position" if axis < 3 else "angle"
    return FieldChange(
        name=name,
        old=_plain(old),
        new=_plain(new),
        unit=QUANTITIES[tolerance].unit,
        allowed=tolerances[tolerance].limit(old),
        tolerance=tolerance,
    )


def _ways(a: MotionStep, b: MotionStep, tolerances: Tolerances, *, shaped: bool) -> list[FieldChange]:
    """A different path to the same end: how far apart the middles are. Where ends or words differ, they say enough."""
    if not shaped or len(a.through) != len(b.through) or _ends(a, b, tolerances):
        return []
    apart = max((math.dist(p, q) for p, q in zip(a.through, b.through, strict=True)), default=0.0)
    if tolerances["position"].allows(0.0, apart):
        return []
    return [
        FieldChange(
            name="arc" if a.arc is not None else "way",
            old=0.0,
            new=_plain(apart),
            unit="mm",
            allowed=tolerances["position"].limit(0.0),
            tolerance="position",
        )
    ]


def _plain(value: float) -> float:
    return round(value, 6) + 0.0


def _name(kind: str, field: str) -> tuple[str, str]:
    """The name of a field in messages, and its tolerance."""
    if (kind, field) in _NAMES:
        return _NAMES[kind, field]
    if ("", field) in _NAMES:
        return _NAMES["", field]
    if field in AXIS_LETTERS:
        return f"{_called(kind)} {field}", "position" if field in "XYZ" else "angle"
    return f"{_called(kind)} {field}".replace("_", " "), "word"


def _called(kind: str) -> str:
    return kind.replace("_", " ")


def _direction(field: str, value: str | None) -> str | None:
    if field == "ccw" and value is not None:
        return "counterclockwise" if value == "yes" else "clockwise"
    return value


def _unit(step: MotionStep, field: str, tolerance: str) -> str:
    if field == "feed":
        return dict(step.words).get("feed_unit", "mm/min")
    return "mm/rev" if field == "pitch" else QUANTITIES[tolerance].unit


def _hunks(
    pairs: Sequence[Pair], old: Sequence[MotionStep], new: Sequence[MotionStep], tolerances: Tolerances
) -> list[list[Pair]]:
    """Runs of pairs that are not equal, without those that only divide a path differently."""
    hunks: list[list[Pair]] = []
    run: list[Pair] = []
    for a, b in pairs:
        if a is not None and b is not None and _same(old[a], new[b], tolerances):
            # the last part of a divided line ends where the whole line ended, so it was paired as equal
            if (
                run
                and not _is_division(run, old, new, tolerances)
                and not _is_division([*run, (a, b)], old, new, tolerances)
            ):
                hunks.append(run)
            run = []
        else:
            run.append((a, b))
    return [*hunks, run] if run and not _is_division(run, old, new, tolerances) else hunks


def _is_division(
    run: Sequence[Pair], old: Sequence[MotionStep], new: Sequence[MotionStep], tolerances: Tolerances
) -> bool:
    before = [old[a] for a, _ in run if a is not None]
    after = [new[b] for _, b in run if b is not None]
    return len(before) != len(after) and _same_way(before, after, tolerances)


def _changes(
    hunk: Sequence[Pair],
    old: Sequence[MotionStep],
    new: Sequence[MotionStep],
    tolerances: Tolerances,
    texts: tuple[LineText, LineText],
    near: Mapping[int, int],
) -> Iterator[MoveChange]:
    for a, b in hunk:
        left = None if a is None else _place(old[a], texts[0])
        right = None if b is None else _place(new[b], texts[1])
        step = old[a] if a is not None else new[b or 0]
        beside = near.get(a) if b is None and a is not None else None
        yield MoveChange(
            kind="removed" if b is None else "inserted" if a is None else "changed",
            what=_called(step.kind),
            detail="" if a is not None and b is not None else _detail(step),
            old=left,
            new=right,
            near=right if beside is None else _place(new[beside], texts[1]),
            fields=() if a is None or b is None else tuple(differing(old[a], new[b], tolerances)),
            way_mm=0.0 if a is not None and b is not None else _plain(step.length),
        )


def _detail(step: MotionStep) -> str:
    """The content of a step that is not a move: `cw, 8000 rpm`."""
    if step.end is not None:
        return ""
    told = []
    for field, word in step.words:
        if word not in ("none", "no") and field != "unit":
            told.append(field if word == "yes" else f"{field} {word}" if word.isdecimal() else word)
    for field, value in step.numbers:
        if value or field not in AXIS_LETTERS:
            unit = _unit(step, field, _name(step.kind, field)[1])
            name = "" if field in ("speed", "seconds") else f"{field} "
            told.append(f"{name}{value:g} {unit}".strip())
    return ", ".join(told)


def _place(step: MotionStep, text: LineText) -> ChangedLine:
    return ChangedLine(file=step.file, line=step.line, text=" ".join(text(step.file, step.line).split()))


def _same_way(a: Sequence[MotionStep], b: Sequence[MotionStep], tolerances: Tolerances) -> bool:
    """Whether two runs of cuts (or of rapids) follow the same path in the same manner, however they are divided."""
    if not a or not b or any(step.kind not in ("line", "arc") or step.stops for step in (*a, *b)):
        return False
    if len({dict(step.words).get("feed_unit") for step in (*a, *b)}) > 1:
        return False
    feeds = [dict(step.numbers).get("feed", math.nan) for step in (*a, *b)]
    if not all(tolerances["feed"].allows(feeds[0], feed) for feed in feeds):
        return False
    if any(s.start[3:] != (s.end or s.start)[3:] for s in (*a, *b)):
        return False
    p, q = _sampled(a), _sampled(b)
    return all(tolerances["position"].allows(0.0, math.dist(x, y)) for x, y in zip(p, q, strict=True))


def _sampled(steps: Sequence[MotionStep]) -> list[tuple[float, float, float]]:
    """Points at equal parts of the length of a run of moves; the length itself is one more entry."""
    lengths = [step.length for step in steps]
    total = sum(lengths)
    points = []
    for part in _PARTS:
        left = part * total
        for step, length in zip(steps, lengths, strict=True):
            if left <= length or step is steps[-1]:
                points.append(step.point(min(1.0, left / length) if length else 1.0))
                break
            left -= length
    return [*points, (total, 0.0, 0.0)]


def _folded(changes: Sequence[tuple[int, MoveChange]]) -> tuple[MoveChange, ...]:
    """Neighbours that change in the same way, as one entry with a count; insertions and removals per hunk only."""
    folded: list[MoveChange] = []
    hunk = -1
    for number, change in changes:
        if folded and _alike(folded[-1], change) and (change.kind == "changed" or number == hunk):
            last = folded[-1]
            folded[-1] = replace(
                last,
                count=last.count + 1,
                last_old=change.old,
                last_new=change.new,
                way_mm=_plain(last.way_mm + change.way_mm),
            )
        else:
            folded.append(change)
        hunk = number
    return tuple(folded)


def _alike(a: MoveChange, b: MoveChange) -> bool:
    if a.kind != b.kind or len(a.fields) != len(b.fields):
        return False
    if a.kind != "changed":
        return (a.what in MOVES) == (b.what in MOVES)
    return all(_way_of(x) == _way_of(y) for x, y in zip(a.fields, b.fields, strict=True))


def _way_of(field: FieldChange) -> tuple[object, ...]:
    delta = field.delta
    return (field.name, field.old, field.new) if delta is None else (field.name, round(delta, 4))

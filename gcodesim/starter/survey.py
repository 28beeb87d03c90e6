"""What a program does, as far as a first cell needs it: its language, where it cuts, how its tools are used."""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from gcodesim import canon
from gcodesim.arithmetic.elementary import atan2, cos, sin
from gcodesim.arithmetic.matrices import dot, norms
from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.length_words import length_words
from gcodesim.rs274.other_machines import Foreign, foreign_of, lathe_of
from gcodesim.units import MM

_DIALECTS: Final = ("linuxcnc", "fanuc", "grbl")  # the first of those that understand most is taken

_TRIED: Final = 100_000  # bytes that are read to choose the dialect, unless there is an error behind them
_LOOPS: Final = 50_000  # blocks after which a text of that size is taken for an endless loop
_ENDLESS: Final = ("GS134",)
_UNKNOWN_WORDS: Final = frozenset(("GS001", "GS004", "GS006", "GS007", "GS008", "GS012", "GS013"))
_PIECES: Final = 16  # chords in place of an arc
_TINY: Final = 1e-7  # m
_MACHINE = re.compile(r"(?<![A-Za-z0-9])G0*(?:28|30|53)(?![0-9.])", re.IGNORECASE)
_HOMING = re.compile(r"(?<![A-Za-z0-9])G0*(?:28|30)(?![0-9.])", re.IGNORECASE)
_TOUCH_OFF = re.compile(r"(?<![A-Za-z])L0*20(?![0-9.])", re.IGNORECASE)
_SETS = re.compile(r"G0*10(?![0-9.])", re.IGNORECASE)
_ZERO = re.compile(r"L0*2(?![0-9.])", re.IGNORECASE)
_OF_SYSTEM = re.compile(r"P0*([1-9])", re.IGNORECASE)
_NOTE = re.compile(r"\([^)]*\)?|;.*")
_AXIS_WORD = re.compile(r"(?<![A-Za-z#<])[XYZxyz]\s*[-+]?\s*[0-9.#\[]")
_O_NUMBER = re.compile(r"(?:O[0-9]{3,8}|:[0-9]{4})(?![0-9])", re.IGNORECASE)
_FANUC_FLOW = re.compile(
    r"\bIF\s*\[.{0,250}?GOTO|\bWHILE\s*\[.{0,250}?\bDO\s*[123]|(?<![A-Za-z])G65\s*P|M98\s*P", re.IGNORECASE
)
_LIKE_GRBL = re.compile(r"\bgrbl\b|laser|lightburn", re.IGNORECASE)  # most lasers have it or behave as it does
_LIKE_MARLIN = re.compile(r"\bG0*4\s*S\s*[0-9.]+", re.IGNORECASE)
_NAMES_MARLIN = re.compile(r"\bmarlin\b|\bfabtotum\b", re.IGNORECASE)
_HOLES: Final = frozenset(f"G{number}" for number in (73, 74, 76, *range(81, 90)))

Bounds = tuple[Array, Array]


@dataclass(slots=True)
class ToolUse:
    """How a tool is used: metres fed sideways and straight down, and whether canned cycles made holes with it."""

    number: int
    sideways: float = 0.0
    down: float = 0.0
    cycles: bool = False

    @property
    def makes_holes(self) -> bool:
        return self.sideways < _TINY and (self.cycles or self.down > 0.0)


@dataclass(slots=True)
class _Moves:
    """Moves in one work system, seen from its zero [m]: both ends of feeds, ends of rapids with the tool, of probes.

    `early` are the ends of rapids before anything is fed: there can be no material.
    """

    feeds: array[float] = field(default_factory=lambda: array("d"))
    risen: bytearray = field(default_factory=bytearray)  # whether the tool went up before the feed: it is on its way
    rapids: array[float] = field(default_factory=lambda: array("d"))
    probes: array[float] = field(default_factory=lambda: array("d"))
    early: array[float] = field(default_factory=lambda: array("d"))


@frozen
class Reach:
    """Where the program goes in a work system [m]: the box of all moves, and that of the material cut, when it is told.

    `cut` is flat in Z if nothing is cut in depth, `fed` is the box of all feeds, whatever the height. `plunges` (n, 3)
    are x, y and tool number of the places at which a rapid ends below its top, where there can be no material; `early`
    (n, 3) are the ends of rapids before the first feed.
    """

    all: Bounds
    cut: Bounds | None
    fed: Bounds | None
    plunges: Array
    early: Array


@frozen
class Survey:
    """What a program does.

    `foreign` says for what else it is and why there is no cell; `machine` is the box of G53 moves [m]. `own` has the
    zeros [m] of work systems that the program sets itself in coordinates of the machine, `lift` is the longest tool
    offset that it sets by words, `called` are the tools that come into the spindle. `from_zero`: the first move counts
    from where the machine stands. `spins`: the spindle is switched on with a speed. `measured`: lengths of tools are
    put in force, or nothing is said of them.
    """

    dialect: str
    why: str
    foreign: str
    failed: Diagnostic | None
    systems: dict[int, Reach]
    machine: Bounds | None
    own: Mapping[int, tuple[float, float, float]]
    lift: float
    called: tuple[int, ...]
    uses: dict[int, ToolUse]
    changes: bool
    rotary: str
    from_zero: bool
    lathe: bool
    spins: bool
    measured: bool


def _why_no_cell(foreign: Foreign) -> str:
    """For which other control a program is, by which word, and what follows."""
    place = f"(`{foreign.word}`, line {foreign.line})"
    unread = {"Klartext": "Heidenhain's Klartext", "Okuma": "an Okuma OSP", "Sinumerik": "a Sinumerik"}.get(
        foreign.kind
    )
    if unread is not None:
        return f"{unread} {place}; no dialect of gcodesim reads it"
    if foreign.kind == "script":
        return f"an interpreter of scripts {place}; let that make its own, as `tplang part.tpl > part.nc` of CAMotics"
    remedy = "write one with `dialect: fanuc_lathe`, `machine: lathe_xz`"
    return f"a lathe {place}; its cell cannot be guessed, {remedy}"


def survey(program: SourceText, startup: SourceText | None = None) -> Survey:
    """Read the program with every tool that it may name, its work systems at machine zero, `startup` in force."""
    seen = _survey(program, startup, _dialect_of(program, _TRIED))
    if seen.failed is None or len(program.raw) <= _TRIED:
        return seen
    told = _dialect_of(program, len(program.raw))  # what the beginning does not show
    return seen if told[0] == seen.dialect else _survey(program, startup, told)


def _survey(program: SourceText, startup: SourceText | None, told: tuple[str, str, bool]) -> Survey:
    dialect, why, ends = told
    foreign = foreign_of(program)
    turns = DIALECTS[dialect].lathe
    lathe = lathe_of(program, turns)
    if turns is not None and turns.refused and lathe is not None:
        foreign = lathe
    tools = assumed_tools(program)
    most = None if ends else _LOOPS
    settings = Settings(dialect=dialect, tool_table=tools, has_cell=True, max_blocks=most, startup=startup)
    run = interpret(program, settings)
    walk = _Walk(program)
    for item in run.stream():
        for event in item.events() if type(item) is MoveBatch else (item,):
            walk.take(event)  # type: ignore[arg-type]
    return Survey(
        dialect=dialect,
        why=why,
        foreign="" if foreign is None else _why_no_cell(foreign),
        failed=run.failed,
        systems={index: reach for index, moves in sorted(walk.systems.items()) if (reach := _reach(moves)) is not None},
        machine=_box(np.array(walk.machine).reshape(-1, 3)) if walk.machine else None,
        own=dict(sorted(walk.own.items())),
        lift=walk.lift,
        called=tuple(sorted(walk.called)),
        uses=dict(sorted(walk.uses.items())),
        changes=walk.changes,
        rotary="".join(sorted(walk.rotary)),
        from_zero=_starts_anywhere(program),
        lathe=lathe is not None,
        spins=walk.spins,
        measured=length_words(program, h0_cancels=DIALECTS[dialect].h0_cancels) != {b"9"},
    )


def _dialect_of(program: SourceText, tried: int) -> tuple[str, str, bool]:
    """The dialect that understands most of the first `tried` bytes, why it was chosen, and whether they come to an end.

    A loop that waits for what a machine does, such as a probe, may have none here.
    """
    said, reason = _told_dialect(program)
    head = program
    if len(program.raw) > tried:
        head = SourceText(program.name, program.raw[: program.raw.rfind(b"\n", 0, tried) + 1])
    # kinds of faults, as one that comes in every line says no more than once; words that a control does not know first
    faults: dict[str, tuple[int, int]] = {}
    endless = set()
    for dialect in dict.fromkeys((said, *_DIALECTS) if said else _DIALECTS):
        settings = Settings(dialect=dialect, tool_table=assumed_tools(head), has_cell=True, max_blocks=_LOOPS)
        run = interpret(head, settings)
        for _ in run.stream():
            pass
        errors = [
            f for f in run.findings if f.level >= Severity.ERROR and not (f.code == "GS010" and head is not program)
        ]
        if any(f.code in _ENDLESS for f in errors):
            endless.add(dialect)
        kinds = {(f.code, f.message): _is_of_words(f, head) for f in errors}
        unknown = sum(kinds.values())
        faults[dialect] = (unknown, len(kinds) - unknown)
        if not errors:
            break
    best = min(faults, key=lambda name: faults[name])
    if best == said:
        return best, reason, best not in endless
    why = "no other dialect understands more of it" if any(faults[best]) else "it understands every line"
    return best, why, best not in endless


def _is_of_words(fault: Diagnostic, program: SourceText) -> bool:
    """Whether words of `program` are unknown; a `)` without its `(` is a slip in a comment, in every dialect."""
    place = fault.span
    stray = place.line > 0 and program.line(place.line)[place.column - 1 : place.end_column - 1] == ")"
    return fault.code in _UNKNOWN_WORDS and not stray


def _told_dialect(program: SourceText) -> tuple[str, str]:
    """What the text itself says: a program number, statements of macros, a name in a comment."""
    for number in range(1, min(len(program.lines), 400) + 1):
        text = program.line(number)
        words = _NOTE.sub(" ", text).strip()
        if _O_NUMBER.match(words) and "sub" not in words.lower() and "call" not in words.lower():
            return "fanuc", f"program number in line {number}"
        if _FANUC_FLOW.search(words):
            return "fanuc", f"`{words[:24]}` in line {number}"
        if found := _LIKE_MARLIN.search(words):
            return "marlin", f"`{found[0]}` in line {number}: only such firmware waits for seconds in S"
        if words != text.strip() and _NAMES_MARLIN.search(text):
            return "marlin", f"line {number} names its firmware"
        if words != text.strip() and (named := _LIKE_GRBL.search(text)):
            return "grbl", f"line {number} names {'it' if named[0].lower() == 'grbl' else 'a laser'}"
    has_change = re.search(rb"[mM][ \t]*0*6(?![0-9])|[gG][ \t]*4[123](?![0-9.])|[gG]8[1-9]|#", program.raw)
    has_end = re.search(rb"[mM][ \t]*0*(?:2|30)(?![0-9])", program.raw)
    if has_change is None and has_end is None:
        return "grbl", "no tool change, no cycle, no end"
    return "", ""


def _starts_anywhere(program: SourceText) -> bool:
    """Whether the first move counts from where the machine stands: G91 or G92 before any absolute place."""
    for number in range(1, min(len(program.lines), 400) + 1):
        words = _NOTE.sub(" ", program.line(number)).upper()
        codes = set(re.findall(r"(?<![A-Z0-9])G0*(9[0-2])(?![0-9.])", words))
        if _MACHINE.search(words):
            continue
        if "92" in codes and _AXIS_WORD.search(words):
            return True
        if "91" in codes:
            relative = True
            for further in range(number, min(len(program.lines), number + 50) + 1):
                text = _NOTE.sub(" ", program.line(further)).upper()
                if _MACHINE.search(text):
                    relative = False
                    break
                if _AXIS_WORD.search(text):
                    break
                if further > number and re.search(r"G90(?![0-9.])", text):
                    relative = False
                    break
            return relative
        if _AXIS_WORD.search(words):
            return False
    return False


def _zeros_set(text: str) -> Iterator[int]:
    """Numbers of the work systems whose zeros blocks with G10 L2 set."""
    for line in text.splitlines():
        if _SETS.search(line):
            words = _NOTE.sub("", line)
            if _SETS.search(words) and _ZERO.search(words) and (system := _OF_SYSTEM.search(words)):
                yield int(system[1])


class _Walk:
    """Goes through the events of a program."""

    def __init__(self, program: SourceText) -> None:
        self._program = program
        self._system = 1
        self._offset: tuple[float, ...] = (0.0,) * 6  # the zero from which the places of the system count
        self._tool = 0
        self._at: tuple[float, ...] | None = None
        self._risen = True
        self.systems: dict[int, _Moves] = {}
        self._zeros: dict[int, tuple[float, ...]] = {}
        self._set = set(_zeros_set(program.text))  # by G10 L2, perhaps to zero
        self.own: dict[int, tuple[float, float, float]] = {}
        self.lift = 0.0
        self.called: set[int] = set()
        self.machine: list[tuple[float, float, float]] = []
        self.uses: dict[int, ToolUse] = {}
        self.changes = self.spins = False
        self.rotary: set[str] = set()
        self._lines: dict[int, str] = {}
        self._fed: set[tuple[int, int]] = set()  # places that a feed has been to, in 10 um

    def take(self, event: canon.Event) -> None:
        if isinstance(event, canon.Move):
            self._move(event)
        elif isinstance(event, canon.WorkSystem):
            old = self._offset
            self._system, self._offset = event.index, self._zero_of(event)
            if self._at is not None:
                self._at = tuple(a + o - n for a, o, n in zip(self._at, old, self._offset, strict=False))
        elif isinstance(event, canon.ToolOffset):
            self.lift = max(self.lift, event.offset[2])
        elif isinstance(event, canon.Spindle):
            self.spins = self.spins or (event.direction != "off" and event.speed > 0.0)
        elif isinstance(event, canon.ToolChange | canon.ToolNumber):
            self._tool, self.changes = event.tool, self.changes or event.tool > 0
            self.called |= {event.tool} - {0}

    def _zero_of(self, event: canon.WorkSystem) -> tuple[float, ...]:
        """The zero of a system: where the program puts it before it moves there, else where the cell will.

        What it sets later, by G10 or by touching off (L20), moves its places seen from that zero.
        """
        if event.index not in self._zeros or event.index not in self.systems:
            touched_off = _TOUCH_OFF.search(self._text(event.span.line)) is not None
            if not touched_off or event.index not in self._zeros:
                self._zeros[event.index] = (0.0,) * 6 if touched_off else event.offset
            x, y, z = self._zeros[event.index][:3]
            if any((x, y, z)) or event.index in self._set:
                self.own[event.index] = (x, y, z)
        return self._zeros[event.index]

    def _move(self, event: canon.Move) -> None:
        end = tuple(e - o for e, o in zip(event.end, self._offset, strict=True))
        self.rotary |= {letter for letter, value in zip("ABC", event.end[3:], strict=True) if abs(value) > 1e-9}
        if self._is_of_machine(event):
            if not _HOMING.search(self._text(event.span.line)):
                self.machine.append(event.end[:3])
            self._at, self._risen = end[:3], True
            return
        start = self._at or (*end[:2], max(end[2], 0.0))  # its start is unknown: most likely above
        moves = self.systems.setdefault(self._system, _Moves())
        sideways, rise = math.hypot(end[0] - start[0], end[1] - start[1]), end[2] - start[2]
        if isinstance(event, canon.Rapid):
            if not moves.feeds and event.word not in _HOLES:
                moves.early.extend(end[:3])
            if event.word in _HOLES or _place(end) in self._fed:
                moves.rapids.extend((*end[:2], max(end[2], start[2]), self._tool))  # down into an existing cut
            else:
                moves.rapids.extend((*end[:3], self._tool))
            if abs(rise) > _TINY:
                self._risen = rise > 0.0
        elif isinstance(event, canon.ProbeMove):
            moves.probes.extend(end[:3])
        else:
            self._fed.add(_place(end))
            if sideways < _TINY and abs(rise) > _TINY and not isinstance(event, canon.ArcFeed):
                self._risen = rise > 0.0
            self._feed(event, start, end[:3], moves, sideways, rise)
        self._at = end[:3]

    def _feed(
        self,
        event: canon.Move,
        start: tuple[float, ...],
        end: tuple[float, ...],
        moves: _Moves,
        sideways: float,
        rise: float,
    ) -> None:
        use = self.uses.setdefault(self._tool, ToolUse(self._tool))
        use.cycles = use.cycles or event.word in _HOLES
        arc = isinstance(event, canon.ArcFeed)
        if not (self._risen and abs(rise) < _TINY):
            use.sideways += sideways if not arc else max(sideways, _TINY * 10)
            use.down += max(-rise, 0.0)
        before = start
        for point in _points(event, start, end, self._offset) if isinstance(event, canon.ArcFeed) else (end,):
            moves.feeds.extend((*before, *point))
            moves.risen.append(self._risen and abs(rise) < _TINY)
            before = point

    def _is_of_machine(self, event: canon.Move) -> bool:
        if event.span.file != self._program.name:
            return False
        return _MACHINE.search(self._text(event.span.line)) is not None

    def _text(self, line: int) -> str:
        if line not in self._lines:
            self._lines = {line: _NOTE.sub(" ", self._program.line(line))}
        return self._lines[line]


def _place(point: tuple[float, ...]) -> tuple[int, int]:
    return round(point[0] * 1e5), round(point[1] * 1e5)


def _points(
    arc: canon.ArcFeed, start: tuple[float, ...], end: tuple[float, ...], offset: tuple[float, ...]
) -> Iterator[tuple[float, ...]]:
    """Points along an arc, its end last, and between them those that reach farthest along each axis [m]."""
    normal = np.array(arc.normal)
    begin = np.array(start)
    lift = dot(normal, np.array(end) - begin)
    center = np.array(arc.center) - np.array(offset[:3])
    center = center + normal * dot(normal, begin - center)
    spoke = begin - center
    across = np.cross(normal, spoke)
    share = {k / _PIECES for k in range(1, _PIECES)}
    for ahead, aside in zip(spoke.tolist(), across.tolist(), strict=True):
        first = atan2(aside, ahead) / math.pi  # half turns to an extreme of this axis, and to each one after it
        low, high = sorted((0.0, max(-2.0, min(2.0, arc.sweep / math.pi))))  # further turns reach no farther
        share |= {(first + n) * math.pi / arc.sweep for n in range(math.ceil(low - first), math.ceil(high - first))}
    for part in sorted(part for part in share if 0.0 < part < 1.0):
        angle = arc.sweep * part
        point = center + spoke * cos(angle) + across * sin(angle) + normal * (lift * part)
        yield tuple(point.tolist())
    yield end


def _reach(moves: _Moves) -> Reach | None:
    feeds = np.array(moves.feeds).reshape(-1, 2, 3)
    rapids = np.array(moves.rapids).reshape(-1, 4)
    cloud = np.concatenate([feeds[:, 1], rapids[:, :3], np.array(moves.probes).reshape(-1, 3)])
    if not len(cloud):
        return None
    risen = np.frombuffer(bytes(moves.risen), dtype=np.uint8).astype(bool)
    cut = _cut(feeds[~risen])
    deep = rapids[rapids[:, 2] < (cut[1][2] - 10 * _TINY if cut is not None else -np.inf)]
    fed = _box(feeds.reshape(-1, 3)) if len(feeds) else None
    early = np.array(moves.early).reshape(-1, 3)
    return Reach(all=_box(cloud), cut=cut, fed=fed, plunges=deep[:, [0, 1, 3]], early=early)


def _cut(feeds: Array) -> Bounds | None:
    """The box of all feeds under the top of the material."""
    if not len(feeds):
        return None
    top = _top(feeds)
    under = feeds[feeds[:, :, 2].min(axis=1) < top + _TINY]
    if not len(under):
        return None
    low, high = _box(under.reshape(-1, 3))
    high[2] = max(top, low[2])
    return low, high


def _top(feeds: Array) -> float:
    """Height of the material: Z0 where most is cut below it, else the highest level of feeds sideways."""
    way = norms(feeds[:, 1, :2] - feeds[:, 0, :2])
    level = feeds[:, :, 2].max(axis=1)
    lowest = float(feeds[:, :, 2].min())
    sideways = way > _TINY
    below, above = float(way[level < _TINY].sum()), float(way[level >= _TINY].sum())
    if lowest < -_TINY and below >= above and sideways.any():
        return 0.0
    if sideways.any():
        return float(level[sideways].max())
    return min(0.0, float(level.max())) if lowest < -_TINY else float(level.max()) - 2.0 * MM


def _box(points: Array) -> Bounds:
    return points.min(axis=0), points.max(axis=0)

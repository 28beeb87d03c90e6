"""A first cell for a lathe's program: dialect, bar, chuck and tools from its moves and comments at tool calls."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final

from gcodesim import canon
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.frozen import frozen
from gcodesim.kinematics.models import MODELS
from gcodesim.rs274 import Settings, ToolEntry, ToolTable, interpret
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.fanuc.lathe_system_b import is_in_system_b
from gcodesim.rs274.other_machines import lathe_of
from gcodesim.units import INCH, MM, RPM

_MODEL: Final = "lathe_xz"
_MOST_TOOLS: Final = 99
_BESIDE: Final = 1.0 * MM  # of the bar on each face and side: what is turned is at least that much thinner
_GRIP: Final = 25.0 * MM
_CLEAR: Final = 1.7 * MM  # of the face, by which rapids pass it: two nose radii nearer where the tip is compensated
_FREE: Final = 5.0 * MM  # between the lowest cut and the jaws
_AXIS: Final = 0.5 * MM  # radius below which a tool is on the axis
_SPEED: Final = 4000.0
_WIDTH: Final = 3.0 * MM

_KINDS: Final = (
    ("threading_tool", re.compile(r"THREAD|GEWINDE", re.IGNORECASE)),
    ("parting_tool", re.compile(r"PART(?:ING)? ?-?OFF|CUT ?-?OFF|PARTING|ABSTECH", re.IGNORECASE)),
    ("grooving_tool", re.compile(r"GROOV|EINSTECH", re.IGNORECASE)),
    ("boring_tool", re.compile(r"\bBOR(?:E|ING)\b|\bI\.?D\.?\b|AUSDREH", re.IGNORECASE)),
    ("drill", re.compile(r"DRILL|BOHR", re.IGNORECASE)),
)
# lists of tools in Haas programs: `(T02 = 35* Finish Turning Tool, Tool Nose Radius: .0157, Tool Tip: 3)`
_TOLD: Final = re.compile(r"\bT[0O]?([0-9]{1,2})\s*=\s*(.*)", re.IGNORECASE)
_NOSE: Final = re.compile(r"(?:NOSE|TIP) RADIUS\s*[:=]?\s*([0-9]*\.?[0-9]+)\s*(MM|IN|\")?", re.IGNORECASE)
_TIP: Final = re.compile(r"\bTIP\s*[:=]\s*([1-9])\b", re.IGNORECASE)
# where the nose lies, as Fanuc and Haas count, which see X the other way round than LinuxCNC
_TIPS: Final = {1: 4, 2: 3, 3: 2, 4: 1, 5: 5, 6: 8, 7: 7, 8: 6, 9: 9}
_ANGLE: Final = re.compile(r"\b([1-9][0-9])\s*(?:\*|°|DEG)", re.IGNORECASE)
_INSERT: Final = re.compile(r"\b([CDSTVRW][A-Z]{3}\s?\d{6})\b", re.IGNORECASE)
_OF_MACHINE: Final = re.compile(r"^[^(;\n]*\bG0*53\b(?!\.[1-9])", re.IGNORECASE | re.MULTILINE)
_INCH: Final = re.compile(r"\bG0*20\b(?!\.[1-9])", re.IGNORECASE)
_NOTE: Final = re.compile(r"\(([^()]*)\)|;(.*)")


@dataclass(slots=True)
class _Use:
    """What a tool does; lengths [m], radii. `comment` stands at its first call, or in a list of tools, in `line`.

    `inward` is how many times it left a cut along Z towards the axis, less those away from it; `innermost` the least
    radius at which it was below Z0; `passed` the least to which a rapid took it below Z0 before the program cuts.
    """

    line: int = 0
    comment: str = ""
    inch: bool = False
    feeds: list[tuple[float, float, float, float]] = field(default_factory=list)  # radius, z at begin and end
    threads: list[tuple[float, float, float, float]] = field(default_factory=list)  # the same of passes with a pitch

    entries: list[tuple[float, float]] = field(default_factory=list)  # where rapids straight in end, before the face

    inward: int = 0
    innermost: float = math.inf
    passed: float = math.inf

    @property
    def kind(self) -> str:
        """The type of the tool."""
        if self.threads:
            return "threading_tool"
        told = next((kind for kind, word in _KINDS if word.search(self.comment)), None)
        if told is not None:
            return told
        drills = self.feeds and all(max(abs(a), abs(b)) < _AXIS for a, _, b, _ in self.feeds)
        return "drill" if drills else "boring_tool" if self.inward > 0 else "turning_tool"


@frozen
class LatheCell:
    """What a lathe's program says about its cell; lengths [m]."""

    program: str
    dialect: str
    why: str
    counts_from_home: bool
    failed: int
    uses: dict[int, _Use]
    fastest: float
    first: int

    @staticmethod
    def of(program: SourceText) -> LatheCell | None:
        """From the moves of a program; None if it is for no lathe, or feeds nothing."""
        known = _dialect_of(program)
        if known is None:
            return None
        dialect, why = known
        table = ToolTable({number: ToolEntry(number=number) for number in range(1, _MOST_TOOLS + 1)})
        settings = Settings(dialect=dialect, tool_table=table, has_cell=True, turns=True)
        run = interpret(program, settings)
        uses, fastest, first = _uses(iter(run), program)
        _take_list(uses, program)
        error = next((f.span.line for f in run.findings if f.level >= Severity.ERROR), 0)
        if not any(use.feeds or use.threads for use in uses.values()):
            return None
        return LatheCell(
            program=program.name,
            dialect=dialect,
            why=why,
            counts_from_home=dialect.startswith("fanuc_lathe") or _OF_MACHINE.search(program.text) is not None,
            failed=error,
            uses=uses,
            fastest=fastest,
            first=first,
        )

    @property
    def _feeds(self) -> list[tuple[float, float, float, float]]:
        """Radius and z at begin and end of all feeds; threads begin and end beside the work, and count if all are."""
        feeds = [feed for use in self.uses.values() for feed in use.feeds]
        return feeds or [each for use in self.uses.values() for each in use.threads]

    @property
    def _radius(self) -> float:
        """Of the bar: a little thicker than what is turned along Z below the face, thinner than where rapids go."""
        turned = [max(a, b) for a, z, b, w in self._feeds if z != w and min(z, w) < 0.0]
        feeds = [max(a, b) for a, _, b, _ in self._feeds]
        thick = math.ceil(2.0 * max(turned or feeds) / MM) * 0.5 * MM + 0.5 * _BESIDE
        outside = (use.passed for use in self.uses.values() if use.kind not in ("boring_tool", "drill"))
        passed = min(outside, default=math.inf)
        thin = math.floor(2.0 * passed / MM) * 0.5 * MM if math.isfinite(passed) else math.inf
        return min(thick, thin) if thin > 0.0 else thick

    @property
    def _bore(self) -> float:
        """Radius of the hole that the bar has: one in which a tool works that no drill made room for, else 0."""
        kinds = {use.kind for use in self.uses.values()}
        if "drill" in kinds:
            return 0.0
        inside = min((use.innermost for use in self.uses.values() if use.kind == "boring_tool"), default=0.0)
        return max(0.0, math.floor(2.0 * inside / MM) * 0.5 * MM - 0.5 * _BESIDE) if math.isfinite(inside) else 0.0

    @property
    def _span(self) -> tuple[float, float]:
        """Lower end and face of the bar."""
        low = min(min(z, w) for _, z, _, w in self._feeds)
        radial = [(a, z, b) for a, z, b, w in self._feeds if z == w and z > low]
        faced = [z for a, z, b in radial if min(a, b) < _AXIS and (a, z, b) not in self._approaches]
        face = max([0.0, *faced])
        free = [z for use in self.uses.values() for r, z in use.entries if r < self._radius]  # before the face
        top = max(face, min([face + (_BESIDE if faced else 0.0), *(z - _CLEAR for z in free if z > face)]))
        return math.floor((low - _FREE - _GRIP) / MM) * MM, top

    @property
    def _approaches(self) -> set[tuple[float, float, float]]:
        """Radial feeds (radius at begin, z, radius at end) that come to the axis before the bar: what is fed next goes

        along the axis to it, where no turning tool could go on in the bar.
        """
        found = set()
        for use in self.uses.values():
            for (a, z, b, w), (c, y, d, v) in pairwise(use.feeds):
                if z == w == y > v and b == c and max(b, d) < _AXIS and use.kind != "drill":
                    found.add((a, z, b))
        return found

    def text(self) -> bytes:
        """The cell file."""
        low, top = self._span
        diameter = 2.0 * self._radius
        lines = [
            f"# A cell for {self.program}, made from its moves, words and comments: look at every line.",
            "gcodesim: 1",
            *_machine(self.counts_from_home),
            f"dialect: {self.dialect:<10} # {self.why}",
        ]
        if self.failed:
            lines.append(f"# line {self.failed} of the program has an error, so a run stops there: see `gcodesim lint`")
        if self.first:
            lines.append(f"loaded_tool: {self.first}    # the program calls no tool: this one is there from the start")
        lines += [
            "",
            "# the bar, guessed: a little thicker and longer than what is turned; Z0 is part zero",
            "stock:",
            f"  cylinder: [{_mm(diameter)} mm, {_mm(top - low)} mm]",
            f"  xyz: [0, 0, {_mm(low)}]",
            *(
                [f"  bore: {_mm(2.0 * self._bore)} mm    # a tool goes in there, and nothing drills"]
                if self._bore
                else []
            ),
            f"  chuck: {{diameter: {_mm(diameter + 60.0 * MM)} mm, grip: {_mm(_GRIP)} mm}}",
            "  # material: 42crmo4    # `gcodesim list materials`; with it there are forces and power",
            "",
            "tools:",
            *(f"  {number}: {_tool(use)}" for number, use in sorted(self.uses.items())),
            "",
            f"limits: {{spindle_speed: {_rpm(self.fastest)} rpm}}    # {self._speed_told()}",
        ]
        return ("\n".join(lines) + "\n").encode()

    def _speed_told(self) -> str:
        return "the fastest that the program asks for" if self.fastest else "a guess"

    @property
    def needs(self) -> list[tuple[str, str]]:
        """Rows of name and text: dialect, tools, bar."""
        low, top = self._span
        tools = [
            f"T{number} {use.kind.replace('_', ' ')}" + (f" ({use.comment}, line {use.line})" if use.comment else "")
            for number, use in sorted(self.uses.items())
        ]
        bar = f"a bar of {_mm(2.0 * self._radius)} mm from Z{_mm(low)} to Z{_mm(top)} mm (a guess by what is turned)"
        rows = [("" if place else "tools", text) for place, text in enumerate(tools)]
        return [("dialect", f"{self.dialect} ({self.why})"), *rows, ("stock", bar)]

    @property
    def guesses(self) -> list[str]:
        """What is guessed, since the program does not tell."""
        return ["the bar and its chuck", "the material", "the inserts and sizes of the tools"]


def _machine(counts_from_home: bool) -> list[str]:
    """The machine; its axes count from where the turret rests, as they do on most lathes."""
    if not counts_from_home:
        return ["machine: lathe_xz"]
    x, z = MODELS[_MODEL].home
    return [
        "machine:",
        f"  model: {_MODEL}",
        f"  nose: {{X: {_mm(-x)} mm, Z: {_mm(-z)} mm}}    # of the spindle: the axes count from where the turret rests",
    ]


def _dialect_of(program: SourceText) -> tuple[str, str] | None:
    """Which control's lathe a program is for, and what shows it; None if it is for none."""
    for name, dialect in (("fanuc", "fanuc_lathe"), ("linuxcnc", "linuxcnc")):
        found = lathe_of(program, DIALECTS[name].lathe)
        if found is not None:
            own = f"{dialect}_b" if name == "fanuc" and is_in_system_b(program) else dialect
            return own, f"`{found.word}` in line {found.line}"
    return None


def _uses(events: Iterator[canon.Event], program: SourceText) -> tuple[dict[int, _Use], float, int]:
    """What each tool does, the fastest that the spindle is asked for [rad/s], and the tool where none is called."""
    uses: dict[int, _Use] = {}
    number, fastest, faced, fed = 0, 0.0, False, False
    at: tuple[float, float] | None = None
    before: tuple[float, float] | None = None
    for event in events:
        if isinstance(event, canon.ToolChange | canon.ToolNumber):
            number = event.tool
            if number and number not in uses:
                uses[number] = _Use(line=event.span.line, comment=_comment(program, event.span.line))
        elif isinstance(event, canon.Spindle):
            said = [event.max_speed or 0.0, event.speed if event.unit != "m/s" else 0.0]
            fastest = max(fastest, *said)
        elif isinstance(event, canon.Move):
            here = (float(event.end[0]), float(event.end[2]))
            if at is not None and isinstance(event, canon.LinearFeed | canon.ArcFeed):
                use = uses.setdefault(number, _Use())
                passes = use.feeds if getattr(event, "pitch", None) is None else use.threads
                passes.append((at[0], at[1], *here))
                faced = faced or (at[1] == here[1] and min(at[0], here[0]) < _AXIS)
                fed = True
            elif number in uses and not fed and here[1] < 0.0:
                uses[number].passed = min(uses[number].passed, here[0])
            if at is not None and isinstance(event, canon.Rapid) and at[1] == here[1] and here[0] < at[0] and not faced:
                uses.setdefault(number, _Use()).entries.append(here)
            if at is not None and number in uses:
                _note_inside(uses[number], at, here, before)
            at, before = here, at
    loose = uses.pop(0, None)
    first = 0
    if loose is not None:
        first = 1 if not uses else 0
        taken = uses.setdefault(1 if first else min(uses), _Use())
        taken.feeds.extend(loose.feeds)
        taken.threads.extend(loose.threads)
    return uses, fastest, first


_RadiusAndZ = tuple[float, float]


def _note_inside(use: _Use, begin: _RadiusAndZ, end: _RadiusAndZ, before: _RadiusAndZ | None) -> None:
    """Take down how far inside a move goes, and which way it leaves the move along Z that came before it."""
    if end[1] < 0.0:
        use.innermost = min(use.innermost, end[0], begin[0] if begin[1] < 0.0 else math.inf)
    if before is not None and before[1] > begin[1] and begin[1] < 0.0 and before[0] == begin[0] != end[0]:
        use.inward += 1 if end[0] < begin[0] else -1


def _take_list(uses: dict[int, _Use], program: SourceText) -> None:
    """Give tools what a list of tools in comments says about them."""
    inch = _INCH.search(_NOTE.sub(" ", program.text)) is not None
    for number, text in enumerate(program.lines, start=1):
        for note in _NOTE.finditer(text):
            found = _TOLD.match((note[1] or note[2] or "").strip())
            use = uses.get(int(found[1])) if found else None
            if found and use is not None:
                use.line, use.comment, use.inch = number, found[2].strip(), inch


def _comment(program: SourceText, line: int) -> str:
    """The comment of a line, or, where it has none, of the line before."""
    for number in (line, line - 1):
        if found := _NOTE.search(program.line(number)):
            said = (found[1] or found[2] or "").strip()
            return said if any(letter.isalnum() for letter in said) else ""
    return ""


def _tool(use: _Use) -> str:
    """A tool as a mapping of YAML."""
    keys = [f"type: {use.kind}"]
    insert = _INSERT.search(use.comment)
    if insert and use.kind in ("turning_tool", "boring_tool"):
        keys.append(f"insert: {insert[1].replace(' ', '').upper()}")
    elif use.kind in ("turning_tool", "boring_tool"):
        keys += _nose(use)
    if use.kind in ("grooving_tool", "parting_tool"):
        keys.append(f"width: {_mm(_width(use.comment))} mm")
    if use.kind == "drill":
        keys.append("diameter: 10 mm")
    note = use.comment.replace("\n", " ") or "guessed"
    return f"{{{', '.join(keys)}}}    # {note}"


def _nose(use: _Use) -> list[str]:
    """What the comment of a turning tool says about its tip."""
    keys = []
    if (radius := _NOSE.search(use.comment)) and float(radius[1]):
        unit = {"MM": MM, "": INCH if use.inch else MM}.get((radius[2] or "").upper(), INCH)
        keys.append(f"nose_radius: {_mm(float(radius[1]) * unit)} mm")
    if angle := _ANGLE.search(use.comment):
        keys.append(f"tip_angle: {angle[1]} deg")
    tip, usual = _TIP.search(use.comment), 2 if use.kind == "turning_tool" else 3
    if tip and _TIPS[int(tip[1])] != usual:
        keys.append(f"orientation: {_TIPS[int(tip[1])]}")
    return keys


def _width(comment: str) -> float:
    """The width of a blade by its comment, else a usual one."""
    found = re.search(r"([0-9]+(?:\.[0-9]+)?) ?MM", comment, re.IGNORECASE)
    return float(found[1]) * MM if found else _WIDTH


def _rpm(speed: float) -> str:
    return f"{speed / RPM if speed else _SPEED:.0f}"


def _mm(length: float) -> str:
    return f"{round(length / MM, 3) + 0.0:g}"

"""Steps as lines of text that people read in a diff, and back.

    line X10 Y20 Z-1 F400          a move to a place of the program; words as in the move before are left out
    +3 arc X30 ccw c(20,20,-1) sweep=180
    spindle dir:cw unit:rpm max_rpm:none speed=8000

A step is one program line below the step before it; `+3` means three lines below, `@sub.ngc:7` another place. So a line
that is inserted does not shift the others. Lengths are mm, angles deg, feeds per minute.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Final
from urllib.parse import quote, unquote

from gcodesim.canon import AXIS_LETTERS
from gcodesim.regress.motion import MOVES, NO_AXES, ArcMove, Axes, MotionStep, Point, System, arc_point

_PLACES: Final = 6
_FED: Final = ("line", "arc", "spline", "probe")
_HEAD = re.compile(
    r"(?:\+(?P<down>-?[0-9]+) |@(?P<file>(?s:.*)):(?P<line>[0-9]+) )?(?P<kind>[a-z_0-9]+)(?: (?P<rest>.*))?"
)
_NUMBER: Final = r"-?[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?"
_AXIS = re.compile(rf"([XYZABCF])({_NUMBER})")
_POINT = re.compile(rf"(?P<name>[a-z0-9]+)\((?P<values>{_NUMBER}(?:,{_NUMBER})*)\)")
_VALUE = re.compile(rf"(?P<name>[a-zA-Z_0-9]+)=(?P<value>{_NUMBER})")
_WORD = re.compile(r"(?P<name>[a-zA-Z_0-9]+):(?P<value>.*)")
_PLAIN: Final = "".join(chr(code) for code in range(33, 127) if code != ord("%"))


class StepTextError(ValueError):
    """A line that is not a step; the text says which."""


def _number(value: float) -> str:
    rounded = round(value, _PLACES) + 0.0
    return str(int(rounded)) if rounded.is_integer() else repr(rounded)


def _tuple(name: str, values: Sequence[float]) -> str:
    return f"{name}({','.join(_number(v) for v in values)})"


def _system_text(system: System) -> str:
    parts = [_tuple("offset", system.offset)]
    if any(system.g92):
        parts.append(_tuple("g92", system.g92))
    if system.rotation:
        parts.append(f"rotation={_number(system.rotation)}")
    if system.axes is not None:
        parts.append("".join(_tuple("axes" if row is system.axes[0] else "", row) for row in system.axes))
    return " ".join(["system", *parts])


def lines_of(steps: Iterable[MotionStep]) -> list[str]:
    """One line for each step, and one for each change of the work system."""
    lines: list[str] = []
    system = System()
    last: dict[str, str] = {}
    file, line = None, 0
    for step in steps:
        if step.system != system:
            system = step.system
            lines.append(_system_text(system))
            last = {name: text for name, text in last.items() if name not in AXIS_LETTERS}
        down = step.line - line
        place = f"@{step.file}:{step.line} " if step.file != file else "" if down == 1 else f"+{down} "
        file, line = step.file, step.line
        lines.append(" ".join([place + step.kind, *_parts(step, last)]))
    return lines


def _parts(step: MotionStep, last: dict[str, str]) -> Iterator[str]:
    words, numbers = dict(step.words), dict(step.numbers)
    if step.end is not None:
        texts = dict(zip(AXIS_LETTERS, map(_number, step.system.to_program(step.end)), strict=True))
        if "feed" in numbers:
            texts["F"] = _number(numbers.pop("feed"))
        if "feed_unit" in words:
            texts["feed_unit"] = words.pop("feed_unit")
        for name, text in texts.items():
            if last.get(name) != text:
                yield f"{name}:{text}" if name == "feed_unit" else f"{name}{text}"
        last |= texts
    if step.arc is not None:
        yield "ccw" if words.pop("ccw") == "yes" else "cw"
        yield _tuple("c", step.system.to_program(step.arc.center))
        yield f"sweep={_number(step.arc.sweep)}"
        normal = _tuple("n", step.arc.normal)
        if last.get("n") != normal:
            yield normal
        last["n"] = normal
    elif step.through:
        yield from (_tuple(f"p{i}", step.system.to_program(point)) for i, point in enumerate(step.through))
    yield from (f"{name}:{quote(value, safe=_PLAIN)}" for name, value in words.items())  # without blanks
    yield from (f"{name}={_number(value)}" for name, value in numbers.items())


def steps_from(lines: Iterable[str]) -> list[MotionStep]:
    """The steps of lines that `lines_of` made; StepTextError for others."""
    reader = _Reader()
    return [step for text in lines if (step := reader.read(text)) is not None]


class _Reader:
    def __init__(self) -> None:
        self.system = System()
        self.position: Axes = NO_AXES
        self.file, self.line = "", 0
        self.own: dict[str, float] = {}
        self.unit: str | None = None
        self.normal: Point = (0.0, 0.0, 1.0)
        self.stops = False

    def read(self, text: str) -> MotionStep | None:
        head = _HEAD.fullmatch(text)
        if head is None:
            raise StepTextError(f"`{text}` is no step")
        kind, rest = head["kind"], (head["rest"] or "").split()
        try:
            if kind == "system":
                self._system(rest)
                return None
            if head["file"] is not None:
                self.file, self.line = head["file"], int(head["line"])
            else:
                self.line += 1 if head["down"] is None else int(head["down"])
            return self._step(kind, rest)
        except (KeyError, ValueError, TypeError) as error:
            raise StepTextError(f"`{text}` is no step: {error}") from error

    def _system(self, parts: Sequence[str]) -> None:
        fields = dict(map(_named, parts))
        rotation = fields.get("rotation", (0.0,))[0]
        self.system = System(offset=_six(fields["offset"]), g92=_six(fields.get("g92", NO_AXES)), rotation=rotation)
        self.own = {name: value for name, value in self.own.items() if name not in AXIS_LETTERS}

    def _step(self, kind: str, parts: Sequence[str]) -> MotionStep:
        words: list[tuple[str, str]] = []
        numbers: list[tuple[str, float]] = []
        points: dict[str, tuple[float, ...]] = {}
        ccw: bool | None = None
        for part in parts:
            if kind in MOVES and (axis := _AXIS.fullmatch(part)):
                self.own[axis[1]] = float(axis[2])
            elif part in ("cw", "ccw"):
                ccw = part == "ccw"
            elif match := _POINT.fullmatch(part):
                points[match["name"]] = tuple(float(v) for v in match["values"].split(","))
            elif match := _VALUE.fullmatch(part):
                numbers.append((match["name"], float(match["value"])))
            elif match := _WORD.fullmatch(part):
                words.append((match["name"], unquote(match["value"])))
            else:
                raise ValueError(part)
        if kind not in MOVES:
            if kind == "path_mode":
                self.stops = ("mode", "exact_stop") in words
            return self._made(kind, words, numbers)
        return self._move(kind, dict(words), dict(numbers), points, ccw)

    def _move(
        self,
        kind: str,
        words: dict[str, str],
        numbers: dict[str, float],
        points: dict[str, tuple[float, ...]],
        ccw: bool | None,
    ) -> MotionStep:
        start = self.position
        self.position = end = _six(self.system.to_machine([self.own[letter] for letter in AXIS_LETTERS]))
        self.unit = words.pop("feed_unit", self.unit)
        if kind in _FED and "pitch" not in numbers:
            numbers = {"feed": self.own["F"], **numbers}
            words = {**words, "feed_unit": self.unit or ""}
        arc = None
        through: tuple[Point, ...] = tuple(
            _three(self.system.to_machine(points[name])) for name in sorted(points) if name[0] == "p"
        )
        if kind == "arc":
            self.normal = _three(points.get("n", self.normal))
            center = _three(self.system.to_machine(points["c"]))
            arc = ArcMove(center=center, normal=self.normal, sweep=numbers.pop("sweep"))
            through = (arc_point(arc, start, end, 0.5),)
            words = {"ccw": "yes" if ccw else "no", **words}
        return self._made(kind, list(words.items()), list(numbers.items()), start, end, arc, through)

    def _made(
        self,
        kind: str,
        words: list[tuple[str, str]],
        numbers: list[tuple[str, float]],
        start: Axes | None = None,
        end: Axes | None = None,
        arc: ArcMove | None = None,
        through: tuple[Point, ...] = (),
    ) -> MotionStep:
        return MotionStep(
            kind=kind,
            file=self.file,
            line=self.line,
            words=tuple(words),
            numbers=tuple(numbers),
            start=start or self.position,
            end=end,
            arc=arc,
            through=through,
            stops=self.stops,
            system=self.system,
        )


def _named(part: str) -> tuple[str, tuple[float, ...]]:
    if match := _POINT.fullmatch(part):
        return match["name"], tuple(float(v) for v in match["values"].split(","))
    if match := _VALUE.fullmatch(part):
        return match["name"], (float(match["value"]),)
    raise ValueError(part)


def _six(values: Sequence[float]) -> Axes:
    x, y, z, a, b, c = values
    return x, y, z, a, b, c


def _three(values: Sequence[float]) -> Point:
    x, y, z = values
    return x, y, z

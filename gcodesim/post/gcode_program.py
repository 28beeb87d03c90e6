"""A G-code program in the language of another control: every block as it is executed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final

from gcodesim import canon
from gcodesim.canon.systems import name_of_system
from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.frozen import frozen
from gcodesim.post.language import plain
from gcodesim.rs274.dialects.systems import first_of_system
from gcodesim.units import DEG, MINUTE, MM, RPM

if TYPE_CHECKING:
    from gcodesim.rs274 import Settings

_LETTERS: Final = "XYZABC"
_CENTRES: Final = "IJK"
_PLANES: Final = ("G19", "G18", "G17")
_UPRIGHT: Final = 1.0 - 1e-9
_DIGITS: Final = 6  # of mm and degrees
_DIGITS_OF: Final = {"fanuc": 3, "fanuc_lathe": 3, "fanuc_lathe_b": 3}  # the increments of the control
_FEED_DIGITS: Final = 9
PRINTERS: Final = ("marlin", "klipper", "reprapfirmware")
"""Dialects of printers: one code a line, filament, no tool lengths."""
_WITH_POINT: Final = ("fanuc", "fanuc_lathe", "fanuc_lathe_b")  # a number without a point counts increments there
_WITH_TURNS: Final = ("linuxcnc", "rs274")
_WITH_MODES: Final = ("linuxcnc", "rs274")
_FEEDS: Final = {"m/s": "G94", "rad/s": "G94", "m/rev": "G95", "rad/rev": "G95"}
_PROBES: Final = {(True, True): "G38.2", (True, False): "G38.3", (False, True): "G38.4", (False, False): "G38.5"}


class CannotSayError(ValueError):
    """The language has no words for an event; the text says which."""


@frozen
class GcodeLine:
    """One line of the new program, and the place in the old one that asks for it."""

    text: str
    span: Span


class GcodeWriter:
    """Says events in a dialect. What a control only takes as advice and this one has no word for is in `findings`."""

    def __init__(self, dialect: str, settings: Settings, name: str) -> None:
        self.dialect, self.settings, self.name = dialect, settings, name
        self.findings: list[Diagnostic] = []
        self._at: list[float | None] = [*settings.start]
        self._held: dict[str, str] = {}
        self._system = 1
        self._tool = settings.loaded_tool
        self._length: canon.Axes = (0.0,) * 6
        self._digits = _DIGITS_OF.get(dialect, _DIGITS)
        self._point = dialect in _WITH_POINT

    def lines(self, events: Iterator[canon.Event]) -> Iterator[GcodeLine]:
        """The new program. CannotSayError, with its `span` beside it, where there are no words."""
        nowhere = Span(self.name)
        for text in self._head():
            yield GcodeLine(text=text, span=nowhere)
        for event in events:
            writer = _WRITERS.get(type(event))
            if event.span.line == 0:
                self._begin(event)
                continue
            if writer is None:
                continue
            try:
                for text in writer(self, event):
                    yield GcodeLine(text=text, span=event.span)
            except CannotSayError as error:
                raise NotTranslatedError(str(error), event.span) from None
        if self._point:
            yield GcodeLine(text="%", span=nowhere)

    def _begin(self, event: canon.Event) -> None:
        """What holds before the program begins."""
        if isinstance(event, canon.ToolOffset):
            self._length = event.offset
        elif isinstance(event, canon.WorkSystem):
            self._system = event.index
        elif isinstance(event, canon.ToolNumber):
            self._tool = event.tool

    def _head(self) -> Iterator[str]:
        said = f"{self.name} for {self.dialect}, by gcodesim: every block as it is executed"
        remark = plain(said).replace("(", "").replace(")", "")
        if self.dialect in PRINTERS:
            yield f"; {remark}"
            yield from ("G21", "G90", "M83")
            return
        if self._point:
            yield from ("%", "O0001")
        yield f"({remark})"
        yield from ("G21 G90 G94 G17",) if self.dialect != "fanuc_lathe" else ("G21",)

    # ---- moves

    def _rapid(self, event: canon.Rapid) -> Iterator[str]:
        if event.home:
            yield from self._home(event)
            return
        yield self._words("G0", event.end)

    def _home(self, event: canon.Rapid) -> Iterator[str]:
        """To a place that only the control knows."""
        if self.dialect not in PRINTERS:
            raise CannotSayError(f"{event.home} goes to a place that only the control knows")
        moved = [_LETTERS[k] for k in range(3) if event.end[k] != self._at[k]]
        self._at = list(event.end)
        letters = [] if len(moved) in (0, 3) else moved
        yield " ".join([event.home, *letters])

    def _line(self, event: canon.LinearFeed) -> Iterator[str]:
        if event.pitch is not None:
            if self.dialect not in ("linuxcnc",):
                raise CannotSayError("a thread by G33 has other words there")
            yield f"{self._words('G33', event.end)} K{self._number(event.pitch / MM)}"
            return
        yield from self._feed_mode(event.feed_unit)
        text = self._words("G1", event.end, allow_none=bool(event.extrude))
        yield f"{text}{self._extruded(event.extrude)} {self._feed(event)}"

    def _arc(self, event: canon.ArcFeed) -> Iterator[str]:
        axis = max(range(3), key=lambda k: abs(event.normal[k]))
        if abs(event.normal[axis]) < _UPRIGHT:
            raise CannotSayError("an arc about an axis that leans")
        if self.dialect in PRINTERS and axis != 2:
            raise CannotSayError("an arc that does not lie in XY")
        yield from self._feed_mode(event.feed_unit)
        if self.dialect not in PRINTERS:
            yield from self._changed("plane", _PLANES[axis])
        if event.turns > 1 and self.dialect not in _WITH_TURNS:
            raise CannotSayError(f"an arc of {event.turns} turns; one block has at most one")
        sweep = event.sweep * math.copysign(1.0, event.normal[axis])
        inside = [k for k in range(3) if k != axis]
        start = [self._at[k] for k in range(3)]
        if None in start:
            raise CannotSayError("an arc from a place that only the control knows")
        centre = [f"{_CENTRES[k]}{self._number((event.center[k] - (start[k] or 0.0)) / MM)}" for k in inside]
        ends = self._ends(event.end, always=inside)
        turns = f" P{event.turns}" if event.turns > 1 else ""
        word = "G3" if sweep > 0.0 else "G2"
        yield f"{word} {ends} {' '.join(centre)}{turns}{self._extruded(event.extrude)} {self._feed(event)}"

    def _spline(self, event: canon.SplineFeed) -> Iterator[str]:
        """As lines through points that stay within 2 µm of it."""
        yield from self._feed_mode(event.feed_unit)
        for point in event.points:
            end = (*point, *event.end[3:])
            if any(a != b for a, b in zip(end, self._at, strict=True)):
                yield f"{self._words('G1', end)} {self._feed(event)}"

    def _probe(self, event: canon.ProbeMove) -> Iterator[str]:
        if self.dialect not in ("linuxcnc", "rs274", "grbl"):
            raise CannotSayError("probing has other words there")
        yield from self._feed_mode(event.feed_unit)
        yield f"{self._words(_PROBES[event.towards, event.must_trip], event.end)} {self._feed(event)}"

    def _tap(self, event: canon.Tap) -> Iterator[str]:
        if self.dialect != "linuxcnc":
            raise CannotSayError("rigid tapping has other words there")
        back = list(self._at)
        yield f"{self._words('G33.1', event.end)} K{self._number(event.pitch / MM)}"
        self._at = back

    def _words(self, word: str, end: canon.Axes, *, allow_none: bool = False) -> str:
        moved = [k for k in range(6) if self._at[k] is None or end[k] != self._at[k]]
        ends = self._ends(end, always=moved or ([] if allow_none else [0]))
        return f"{word} {ends}".rstrip()

    def _ends(self, end: canon.Axes, *, always: list[int]) -> str:
        shift = self._shift
        moved = [k for k in range(6) if k in always or end[k] != self._at[k]]
        self._at = list(end)
        return " ".join(f"{_LETTERS[k]}{self._number((end[k] - shift[k]) / (MM if k < 3 else DEG))}" for k in moved)

    @property
    def _shift(self) -> list[float]:
        """Where the work system in force is, as the control knows it before the program [m, rad]."""
        first = first_of_system(self._system)
        stored = [self.settings.parameters.get(first + k, 0.0) for k in range(6)]
        if self.settings.parameters.get(first + 9, 0.0) or self._system in self.settings.leans:
            raise CannotSayError(f"{name_of_system(self._system)} is turned")
        return [value * (MM if k < 3 else DEG) for k, value in enumerate(stored)]

    def _feed_mode(self, unit: canon.FeedUnit) -> Iterator[str]:
        if self.dialect in PRINTERS:
            if _FEEDS[unit] != "G94":
                raise CannotSayError("a feed per revolution")
            return
        self._held.setdefault("feed", "G94")
        yield from self._changed("feed", _FEEDS[unit])

    def _feed(self, event: Any) -> str:
        turns = event.feed_unit.startswith("rad")
        per = 1.0 if event.feed_unit.endswith("rev") else MINUTE
        return f"F{self._number(event.feed * per / (DEG if turns else MM), _FEED_DIGITS)}"

    def _extruded(self, extrude: float) -> str:
        if not extrude:
            return ""
        if self.dialect not in PRINTERS:
            raise CannotSayError("filament")
        return f" E{self._number(extrude / MM)}"

    # ---- what happens between moves

    def _dwell(self, event: canon.Dwell) -> Iterator[str]:
        word = "X" if self._point else "S" if self.dialect in PRINTERS else "P"
        yield f"G4 {word}{self._number(event.seconds)}"

    def _filament(self, event: canon.Extrude) -> Iterator[str]:
        if self.dialect not in PRINTERS:
            raise CannotSayError("filament")
        if event.by_firmware:
            yield "G10" if event.length < 0.0 else "G11"
            return
        yield f"G1 E{self._number(event.length / MM)} F{self._number(event.feed * MINUTE / MM, _FEED_DIGITS)}"

    def _change(self, event: canon.ToolChange) -> Iterator[str]:
        self._tool = event.tool
        yield f"T{event.tool}" if self.dialect in PRINTERS else f"T{event.tool} M6"

    def _called(self, event: canon.ToolNumber) -> Iterator[str]:
        self._tool = event.tool
        if self.dialect in PRINTERS:
            yield f"T{event.tool - 1}"  # the first nozzle is T0
            return
        if self.dialect != "linuxcnc":
            raise CannotSayError("M61")
        yield f"M61 Q{event.tool}"

    def _offset(self, event: canon.ToolOffset) -> Iterator[str]:
        # the axes stay where they are, so the controlled point is elsewhere from now on
        self._at = [
            None if at is None else at + before - after
            for at, before, after in zip(self._at, self._length, event.offset, strict=True)
        ]
        self._length = event.offset
        if self.dialect in PRINTERS:
            return
        if not any(event.offset):
            yield from self._changed("length", "G49") if self._held.get("length") else ()
            return
        if self.dialect == "grbl" and not any((*event.offset[:2], *event.offset[3:])):
            yield from self._changed("length", f"G43.1 Z{self._number(event.offset[2] / MM)}")
            return
        if self.dialect == "grbl":
            raise CannotSayError("a tool length beside Z")
        fitting = [
            number
            for number, entry in self.settings.tool_table.items()
            if all(abs(a - b) < 1e-12 for a, b in zip(entry.offset[:6], event.offset, strict=True))
        ]
        if fitting:
            yield from self._changed("length", f"G43 H{self._tool if self._tool in fitting else fitting[0]}")
            return
        if self.dialect != "linuxcnc":
            raise CannotSayError("a tool length that no tool has")
        words = [f"{_LETTERS[k]}{self._number(v / (MM if k < 3 else DEG))}" for k, v in enumerate(event.offset)]
        yield from self._changed("length", f"G43.1 {' '.join(words)}")

    def _turning(self, event: canon.Spindle) -> Iterator[str]:
        if event.direction == "off":
            if self._held.get("spindle", "M5") != "M5":
                yield from self._changed("spindle", "M5")
            return
        turn = "M3" if event.direction == "cw" else "M4"
        if event.unit == "m/s":
            if self.dialect not in ("linuxcnc", "fanuc", "fanuc_lathe", "fanuc_lathe_b"):
                raise CannotSayError("G96, a cutting speed")
            cap = "" if event.max_speed is None else f"{self._number(event.max_speed / RPM)}"
            if self.dialect == "linuxcnc":
                words = f"G96 {f'D{cap} ' if cap else ''}S{self._number(event.speed * MINUTE)} {turn}"
            else:
                if cap:
                    yield from self._changed("cap", f"G50 S{cap}" if self.dialect == "fanuc_lathe" else f"G92 S{cap}")
                words = f"G96 S{self._number(event.speed * MINUTE)} {turn}"
        else:
            back = "G97 " if self._held.get("spindle", "").startswith("G96") else ""
            words = f"{back}S{self._number(event.speed / RPM)} {turn}"
        yield from self._changed("spindle", words)

    def _coolant(self, event: canon.Coolant) -> Iterator[str]:
        before = self._held.get("coolant", "M9")
        wanted = " ".join(["M7"] * event.mist + ["M8"] * event.flood) or "M9"
        if wanted == before:
            return
        self._held["coolant"] = wanted
        if before != "M9" and not set(before.split()) <= set(wanted.split()):
            yield "M9"
        for word in wanted.split():
            if word != "M9" and (word not in before.split() or not set(before.split()) <= set(wanted.split())):
                yield word

    def _output(self, event: canon.Output) -> Iterator[str]:
        if self.dialect != "linuxcnc":
            raise CannotSayError("an output, M62 to M68")
        if event.type == "analog":
            yield f"{'M67' if event.with_motion else 'M68'} E{event.index} Q{self._number(event.value)}"
            return
        code = (62 if event.with_motion else 64) + (0 if event.value else 1)
        yield f"M{code} P{event.index}"

    def _input(self, event: canon.Input) -> Iterator[str]:
        raise CannotSayError("an input, M66: what follows may depend on it")

    def _acts(self, event: canon.Action) -> Iterator[str]:
        words = [f"{letter}{self._number(v)}" for letter, v in (("P", event.p), ("Q", event.q)) if v is not None]
        yield " ".join([f"M{event.m}", *words])

    def _orient(self, event: canon.Orient) -> Iterator[str]:
        if self.dialect != "linuxcnc":
            raise CannotSayError("an angle of the spindle, M19")
        yield f"M19 R{self._number(event.angle / DEG)} P{event.direction}"

    def _system_of(self, event: canon.WorkSystem) -> Iterator[str]:
        if event.axes is not None:
            raise CannotSayError("a work system that leans")
        if event.index == self._system:
            return
        if self.dialect in PRINTERS:
            raise CannotSayError(f"the work system {name_of_system(event.index)}")
        self._system = event.index
        yield name_of_system(event.index)

    def _mode(self, event: canon.PathMode) -> Iterator[str]:
        if self.dialect in _WITH_MODES:
            words = {"exact_path": "G61", "exact_stop": "G61.1", "blend": "G64"}[event.mode]
            if event.mode == "blend":
                words += "".join(
                    f" {letter}{self._number(v / MM)}"
                    for letter, v in (("P", event.tolerance), ("Q", event.naive))
                    if v and self.dialect == "linuxcnc"
                )
            yield from self._changed("mode", words)
        elif self.dialect == "fanuc":
            yield from self._changed("mode", "G64" if event.mode == "blend" else "G61")
            if event.tolerance:
                self._left("the tolerance of G64 P", event.span)
        elif event.mode == "blend" and event.tolerance:
            self._left("the tolerance of G64 P", event.span)

    def _control(self, event: canon.PointControl) -> Iterator[str]:
        raise CannotSayError("control of the tool's tip (G43.4, M428): post it by the axes of its machine")

    def _override(self, event: canon.Override) -> Iterator[str]:
        self._left("which overrides are allowed, M48 to M53", event.span)
        return iter(())

    def _message(self, event: canon.Message | canon.Print | canon.Log) -> Iterator[str]:
        text = plain(event.text).replace("(", "").replace(")", "")
        if self.dialect in PRINTERS:
            yield f"; {text}"
        elif self.dialect == "linuxcnc":
            kind = {canon.Message: "MSG", canon.Print: "PRINT", canon.Log: "LOG"}[type(event)]
            yield f"({kind}, {text})"
        else:
            yield f"({text})"

    def _stop(self, event: canon.Stop) -> Iterator[str]:
        yield "M0"

    def _may_stop(self, event: canon.OptionalStop) -> Iterator[str]:
        yield "M1"

    def _end(self, event: canon.End) -> Iterator[str]:
        if self.dialect not in PRINTERS:
            yield "M30" if self._point else "M2"

    # ---- spelling

    def _changed(self, what: str, words: str) -> Iterator[str]:
        if self._held.get(what) != words:
            self._held[what] = words
            yield words

    def _left(self, what: str, span: Span) -> None:
        if what in self._held:
            return
        self._held[what] = what
        self.findings.append(
            Diagnostic(
                code="GS802",
                severity=Severity.WARNING,
                span=span,
                message=f"not posted: {what}, from here on",
                hint=f"{self.dialect} has no word for it; set it on the control",
            )
        )

    def _number(self, value: float, digits: int | None = None) -> str:
        text = f"{value:.{self._digits if digits is None else digits}f}".rstrip("0")
        text = "0." if text == "-0." else text
        return text if self._point else text.rstrip(".")


class NotTranslatedError(CannotSayError):
    """As CannotSayError, with the place in the program."""

    def __init__(self, text: str, span: Span) -> None:
        super().__init__(text)
        self.span = span


_WRITERS: Final[Mapping[type[canon.Event], Callable[[GcodeWriter, Any], Iterator[str]]]] = {
    canon.Rapid: GcodeWriter._rapid,
    canon.LinearFeed: GcodeWriter._line,
    canon.ArcFeed: GcodeWriter._arc,
    canon.SplineFeed: GcodeWriter._spline,
    canon.ProbeMove: GcodeWriter._probe,
    canon.Tap: GcodeWriter._tap,
    canon.Dwell: GcodeWriter._dwell,
    canon.Extrude: GcodeWriter._filament,
    canon.ToolChange: GcodeWriter._change,
    canon.ToolNumber: GcodeWriter._called,
    canon.ToolOffset: GcodeWriter._offset,
    canon.Spindle: GcodeWriter._turning,
    canon.Coolant: GcodeWriter._coolant,
    canon.Output: GcodeWriter._output,
    canon.Input: GcodeWriter._input,
    canon.Action: GcodeWriter._acts,
    canon.Orient: GcodeWriter._orient,
    canon.WorkSystem: GcodeWriter._system_of,
    canon.PathMode: GcodeWriter._mode,
    canon.PointControl: GcodeWriter._control,
    canon.Override: GcodeWriter._override,
    canon.Message: GcodeWriter._message,
    canon.Print: GcodeWriter._message,
    canon.Log: GcodeWriter._message,
    canon.Stop: GcodeWriter._stop,
    canon.OptionalStop: GcodeWriter._may_stop,
    canon.End: GcodeWriter._end,
}

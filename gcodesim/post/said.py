"""What happens between moves, in the words of a robot's control."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.planning.marks import is_mark
from gcodesim.post.moves import Remark, RobotCall, RobotHalt, RobotStep, RobotSwitch, RobotWait
from gcodesim.units import RPM

if TYPE_CHECKING:
    from gcodesim.post.from_plan import Wish
    from gcodesim.post.language import RobotLanguage
    from gcodesim.post.meeting import ControlMeetings

_STATES: Final = (
    canon.ToolSelect, canon.ToolOffset, canon.WorkSystem, canon.PathMode, canon.PlannerLimits, canon.PointControl,
    canon.Override, canon.SectionStart, canon.End, canon.EndOfFile, canon.OptionalStop, canon.PalletShuttle,
    canon.ToolAwaited, canon.ToolReturned,  # of tools that several use: the stop at a tool change, or its program, does
)  # fmt: skip
_OUTPUTS: Final = {62: (1.0, True), 63: (0.0, True), 64: (1.0, False), 65: (0.0, False)}
SIGNALS: Final = ("spindle", "reverse", "speed", "flood", "mist")
"""Names of what has no number in a program."""


class Said:
    """Turns events into steps, with signals and calls as the user has named them; what cannot be said is in
    `findings`."""

    def __init__(self, language: RobotLanguage, wish: Wish, meetings: ControlMeetings) -> None:
        self._language, self._signals, self._tool_change = language, wish.signals, wish.tool_change
        self._meetings = meetings
        self.findings: list[Diagnostic] = []
        self.used: set[str] = set()
        self._unsaid: set[str] = set()
        self._has_tool = False

    def steps(self, event: canon.Event) -> Iterator[RobotStep]:
        """The steps of one event."""
        span = event.span
        if isinstance(event, canon.Dwell):
            if event.seconds > 0.0:
                yield RobotWait(span=span, seconds=event.seconds)
        elif isinstance(event, canon.Output):
            letter = "P" if event.type == "digital" else "E"
            yield from self._switch(
                span, f"{letter}{event.index}", event.type == "digital", event.value, event.with_motion
            )
        elif isinstance(event, canon.Spindle):
            yield from self._spindle(event)
        elif isinstance(event, canon.Coolant):
            yield from self._switch(span, "flood", True, float(event.flood), False, matters=event.flood)
            yield from self._switch(span, "mist", True, float(event.mist), False, matters=event.mist)
        elif isinstance(event, canon.Action):
            yield from self._action(event)
        elif isinstance(event, (canon.ToolChange, canon.ToolNumber)):
            yield from self._change(event)
        elif isinstance(event, canon.Stop):
            yield RobotHalt(span=span, text="stop of the program")
        elif isinstance(event, (canon.Message, canon.Print, canon.Log)):
            yield Remark(span=span, text=event.text)
        elif not isinstance(event, _STATES):
            self._not_said(span, type(event).__name__, "")

    def _action(self, event: canon.Action) -> Iterator[RobotStep]:
        """An M-code of the cell; where that is an output of the program, by its number."""
        if is_mark(event) and event.verb in self._meetings.partners and f"M{event.m}" not in self._signals:
            if missing := self._meetings.unwired(event.verb):
                self._not_said(
                    event.span,
                    f"how this control hears that `{missing[0]}` has come; it stops at such marks",
                    f"name the lines between them: --meet {self._meetings.channel}/{missing[0]}=OUTPUT:INPUT",
                )
            yield from self._meetings.meet(event.span, event.verb)
            return
        if event.m in _OUTPUTS and event.p is not None:
            value, with_motion = _OUTPUTS[event.m]
            yield from self._switch(event.span, f"P{event.p:g}", True, value, with_motion)
            return
        yield from self._switch(event.span, f"M{event.m}", True, 1.0, False)

    def _change(self, event: canon.ToolChange | canon.ToolNumber) -> Iterator[RobotStep]:
        """The control's own program for it, or a stop for all but the first tool. M61 only says which is there."""
        if self._tool_change and isinstance(event, canon.ToolChange):
            yield RobotCall(span=event.span, name=self._tool_change, argument=event.tool)
        elif self._has_tool:
            yield RobotHalt(span=event.span, text=f"tool T{event.tool}")
        self._has_tool = True

    def _spindle(self, event: canon.Spindle) -> Iterator[RobotStep]:
        on = event.direction != "off"
        turning = event.speed if event.unit == "rad/s" else 0.0
        if on:
            yield from self._switch(
                event.span, "reverse", True, float(event.direction == "ccw"), False, matters=event.direction == "ccw"
            )
            yield from self._switch(event.span, "speed", False, turning / RPM, False)
        yield from self._switch(event.span, "spindle", True, float(on), False, matters=on)

    def _switch(
        self, span: Span, name: str, digital: bool, value: float, with_motion: bool, *, matters: bool = True
    ) -> Iterator[RobotStep]:
        """Set what the program calls `name`; a finding where the control has no output for it, if it `matters`."""
        own = self._signals.get(name, "")
        if not own and name[0] in "PE" and name[1:].isdigit():
            own = self._language.signal(digital, int(name[1:]))
        if not own:
            if matters or name in self._unsaid:
                self._not_said(span, name, f"name its output: --signal {name}=…")
            return
        self.used.add(name)
        signal, _, fixed = own.partition(":")
        yield RobotSwitch(
            span=span, signal=signal, digital=digital, value=float(fixed or value), with_motion=with_motion
        )

    def _not_said(self, span: Span, what: str, hint: str) -> None:
        if what in self._unsaid:
            return
        self._unsaid.add(what)
        self.findings.append(
            Diagnostic(
                code="GS802",
                severity=Severity.WARNING,
                span=span,
                message=f"not posted: {_IN_WORDS.get(what, what)}, from here on",
                hint=hint or "do it by hand on the control, or leave it out of the program",
            )
        )


_IN_WORDS: Final = {
    "spindle": "the spindle",
    "reverse": "the sense of the spindle, M4",
    "speed": "the speed of the spindle",
    "flood": "coolant, M8",
    "mist": "coolant, M7",
    "Orient": "the angle of the spindle, M19",
    "Extrude": "filament",
    "Tap": "tapping",
}

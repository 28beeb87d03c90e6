"""G33, G33.1 and G76: moves that keep step with the spindle."""

from __future__ import annotations

import math

from gcodesim import canon
from gcodesim.arithmetic.scalars import power, tan
from gcodesim.rs274.control import Control
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector
from gcodesim.rs274.words import Words

_MOST_PASSES = 10_000


def _check_spindle(words: Words, control: Control, who: str) -> None:
    state = control.state
    at = who.lower() if who.lower() in words.names else None
    if state.side and (state.comp_radius > 0.0 or who == "G76"):
        raise Fault("GS150", f"{who} is refused while cutter compensation is on", at=at, hint="say G40 first")
    if not state.turning:
        raise Fault("GS108", f"{who} needs a turning spindle", at=at, hint=_thread_hint(words) or "say S and M3 before")


def _thread_hint(words: Words) -> str:
    """A block without K, such as `G33.0 Z3`, is most likely a slip for a rapid move."""
    if "k" in words.values:
        return ""
    for letter in "zxy":
        if letter in words.values:
            return f"G33 cuts a thread; was `G0 {letter.upper()}{words.values[letter]:g}` meant?"
    return ""


def _pitch(words: Words, who: str) -> float:
    if "f" in words.values:
        raise Fault("GS175", f"{who} takes no F: its feed follows from K and the spindle", at="f", hint="drop F")
    if "k" not in words.values:
        at = who.lower() if who.lower() in words.names else None
        raise Fault("GS175", f"{who} needs the word K, the travel per turn", at=at, hint=_thread_hint(words))
    return words.values["k"]


def thread(words: Words, control: Control, code: int) -> None:
    """G33: one synchronous move; K is the travel per turn along the move."""
    del code
    pitch = _pitch(words, "G33")
    _check_spindle(words, control, "G33")
    end = end_point(words, control)
    control.line(end, "G33", pitch * control.state.unit)


def rigid_tap(words: Words, control: Control, code: int) -> None:
    """G33.1: synchronous to the end and back."""
    del code
    pitch = _pitch(words, "G33.1")
    _check_spindle(words, control, "G33.1")
    end = end_point(words, control)
    control.out.append(
        canon.Tap(
            span=control.span,
            end=control.si_axes(control.tip(end)),
            block=control.block_number,
            word="G33.1",
            pitch=pitch * control.state.unit,
        )
    )


def thread_cycle(words: Words, control: Control, code: int) -> None:
    """G76: a thread cut in passes along Z; the drive line is the start position in X."""
    del code
    state = control.state
    for letter, what in (("p", "pitch"), ("i", "offset of the thread peak"), ("j", "first cut"), ("k", "full depth")):
        words.need(letter, "GS175", "G76", f"it is the {what}")
    for letter in "abcuvw":
        if letter in words.values:
            raise Fault("GS175", f"G76 takes no {letter.upper()} word", at=letter)
    values = words.values
    pitch, peak, first_cut, depth = values["p"], *(values[x] * (0.5 if state.diameter else 1.0) for x in "ijk")
    if peak == 0.0:
        raise Fault("GS175", "I of G76 must not be 0: its sign tells an inside thread from an outside one", at="i")
    if first_cut <= 0.0:
        raise Fault("GS175", "J of G76 must be positive", at="j")
    if depth <= first_cut:
        raise Fault("GS175", f"the thread K{depth:g} is not deeper than the first cut J{first_cut:g}", at="k")
    degression = max(values.get("r", 1.0), 1.0)
    taper = max(values.get("e", 0.0), 0.0)
    taper_kind = words.whole("l", "G76") or 0
    angle = 0.0 if values.get("q") == -1.0 else values.get("q", 0.0)
    springs = words.whole("h", "G76") or 0
    end = end_point(words, control)
    start = state.current
    _check_spindle(words, control, "G76")
    _Passes(control, start, (end[0], end[2]), pitch, peak, depth, taper, taper_kind).cut(
        first_cut, degression, angle, springs
    )


class _Passes:
    """The passes of one G76; all lengths in program units.

    `outward` is the sign of X away from the work: +1 for an outside thread.
    """

    def __init__(
        self,
        control: Control,
        start: Vector,
        end: tuple[float, float],
        pitch: float,
        peak: float,
        depth: float,
        taper: float,
        taper_kind: int,
    ) -> None:
        self.control = control
        self.start = start
        self.end_x, self.end_z = end
        self.pitch = pitch
        self.outward = -1.0 if peak > 0.0 else 1.0
        self.peak = abs(peak)
        self.depth = depth
        taper = abs(taper)
        self.taper = taper if start[2] >= self.end_z else -taper
        self.taper_pitch = pitch * math.hypot(taper, depth) / taper if taper else pitch
        self.entry, self.exit = bool(taper and taper_kind & 1), bool(taper and taper_kind & 2)

    def cut(self, first_cut: float, degression: float, angle: float, springs: int) -> None:
        """All passes; the tool ends beside the end of the thread."""
        slope = tan(math.radians(angle))
        if self.end_z > self.start[2]:
            slope = -slope
        depth, number = first_cut, 1
        while depth < self.depth:
            self._pass(depth, slope)
            number += 1
            if number > _MOST_PASSES:
                raise Fault("GS175", f"G76 would need more than {_MOST_PASSES} passes", at="j")
            depth = first_cut * power(number, 1.0 / degression)
        for _ in range(springs + 1):
            self._pass(self.depth, slope)
        self._rapid(self.end_x, self.end_z)

    def _pass(self, depth: float, slope: float) -> None:
        """One pass, `depth` below the peak, moved along the thread by the flank."""
        control = self.control
        cut = self.start[0] - self.outward * (self.peak + depth)
        clear = cut + self.outward * (self.peak + self.depth)
        begin = self.start[2] - depth * slope
        end = self.end_z + (self.depth - depth) * slope
        lifted = cut + self.outward * self.depth
        self._rapid(clear, begin)
        if not self.entry:
            self._rapid(cut, begin)
        control.say_overrides(feed=False)
        if self.entry:
            self._thread(lifted, begin, self.taper_pitch)
            self._thread(cut, begin - self.taper, self.taper_pitch)
        if self.exit:
            self._thread(cut, end + self.taper, self.pitch)
            self._thread(lifted, end, self.taper_pitch)
        else:
            self._thread(cut, end, self.pitch)
        self._rapid(clear, end)
        control.say_overrides(feed=True)  # as on the control, whatever M49 and M50 said before

    def _rapid(self, x: float, z: float) -> None:
        now = self.control.state.current
        self.control.rapid((x, now[1], z, *now[3:]), "G76")

    def _thread(self, x: float, z: float, pitch: float) -> None:
        now = self.control.state.current
        self.control.line((x, now[1], z, *now[3:]), "G76", pitch * self.control.state.unit)

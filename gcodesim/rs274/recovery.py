"""Going on after a fault: what the faulty block would have done, as far as certain, and what follows from it."""

from __future__ import annotations

import re

from gcodesim.rs274.block import Block, Name
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects.linuxcnc import CENTRE, DISTANCE, FEED_MODE, MOTION, NON_MODAL, PLANE, SYSTEM, UNITS
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.reader import prepare, read_plain
from gcodesim.rs274.words import Words, read_words

_HARMLESS = (MOTION, PLANE, DISTANCE, CENTRE, FEED_MODE, UNITS, SYSTEM)
_FLOW = re.compile(r"\s*+(?:/[1-9]?)?\s*+(?:n[\d.\s]*+)?(?:o|while|if\s*+\[|goto|do\s*+[1-9]|end\s*+[1-9])")
_PLAIN_WORD = re.compile(r"(?<![A-Za-z#<\[])([A-Za-z])[ \t]*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?![0-9.\[])")

# codes of faults that may only follow from an unknown position, feed, spindle or parameter
_BY_POSITION = frozenset(("GS110", "GS111", "GS112", "GS140", "GS151", "GS152", "GS153", "GS180"))
_BY_FEED = frozenset(("GS107",))
_BY_SPINDLE = frozenset(("GS108", "GS175"))
_BY_PARAMETER = frozenset(("GS120", "GS121", "GS123"))
_BY_MODE = frozenset(("GS101", "GS104", "GS150", "GS170", "GS191"))
_BY_FLOW = frozenset(("GS130", "GS132"))
_NOT_FOUND = "GS131"
_AXES = frozenset("xyzabcuvw")
_MOST_WORDS = 100  # characters of a line that are read; a longer line is not a block


class Recovery:
    """Keeps track of what is in doubt since the first fault."""

    def __init__(self, control: Control) -> None:
        self.control = control
        self.axes: set[str] = set()  # letters of the axes whose position nobody knows
        self.feed = False
        self.spindle = False
        self.parameters = False
        self.modes = False
        self.flow = False

    @property
    def may_settle(self) -> bool:
        """Whether something is in doubt that a block may make certain again."""
        return bool(self.axes) or self.feed or self.spindle

    def is_consequence(self, fault: Fault, block: Block | None) -> bool:
        """Whether `fault` may come from an earlier skipped block alone."""
        code = fault.code
        if code == _NOT_FOUND:
            return self.parameters and block is not None and _is_computed(block)
        return (
            (bool(self.axes) and code in _BY_POSITION)
            or (self.feed and code in _BY_FEED)
            or (self.spindle and code in _BY_SPINDLE)
            or (self.parameters and code in _BY_PARAMETER)
            or (self.modes and code in _BY_MODE)
            or (self.flow and code in _BY_FLOW)
        )

    def after(self, fault: Fault, block: Block | None, text: str) -> None:
        """Carry out what is certain of the faulty block, and remember what is not."""
        squeezed = re.sub(r"\([^)]*\)?|;.*", "", text).lower()
        self._doubt(squeezed, block)
        words = self._salvage(block, text)
        if words is not None:
            self._carry_over(words)

    def settled(self, words: Words) -> None:
        """A block was executed after a fault: what it says without regard to what was before is certain again."""
        if not self.may_settle:
            return
        control = self.control
        if "f" in words.values:
            self.feed = False
        if words.values.get("s") and control.state.spindle:
            self.spindle = False
        if not control.state.incremental and words.g.get(NON_MODAL) in (None, 530) and 0 <= control.state.motion <= 30:
            self.axes -= words.values.keys()

    def _doubt(self, text: str, block: Block | None) -> None:
        if (block is not None and block.flow is not None) or _FLOW.match(text):
            self.flow = self.parameters = self.modes = True
            self.axes |= _AXES
        self.axes |= _AXES if "@" in text or "^" in text else _AXES & set(text)
        if "#" in text:
            self.parameters = True
        if re.search(r"f(?!\s*[\d.])", text):
            self.feed = True
        if re.search(r"m\s*0*[345]\b", text) or re.search(r"s(?!\s*[\d.])", text):
            self.spindle = True
        if re.search(r"g(?!\s*[\d.])", text):
            self.modes = True

    def _salvage(self, block: Block | None, text: str) -> Words | None:
        """The words of a line that can be read for sure, the first of each letter but G."""
        control = self.control
        try:
            clean = re.sub(r"\([^)]*\)?|;.*", "", text)
            prepare(clean)
        except Fault:
            return None
        found = []
        seen = set()
        for letter, number in _PLAIN_WORD.findall(clean):
            low = letter.lower()
            if low in "no" or (low != "g" and low in seen):
                continue
            seen.add(low)
            found.append(f"{letter}{number}")
            if len(found) > _MOST_WORDS:
                return None
        while found:
            plain = read_plain(block.line if block else 0, " ".join(found))
            if plain is None:
                return None
            try:
                return read_words(plain, control.dialect, control.parameters, {}, False)
            except Fault as again:
                if isinstance(again.at, tuple):
                    at = plain.places.index(again.at) if again.at in plain.places else len(found) - 1
                    del found[at]
                else:
                    return None
        return None

    def _carry_over(self, words: Words) -> None:
        """Set feed, speed, modes and the end point without any event."""
        control = self.control
        state = control.state
        from gcodesim.rs274 import machine_codes, modes, offsets

        kept = len(control.out)
        try:
            modes.feed_mode(words, control)
            modes.feed_rate(words, control)
            machine_codes.spindle_speed(words, control)
            if words.m.get(7) in (3, 4, 5):
                state.spindle = {3: 1, 4: -1, 5: 0}[words.m[7]]
            modes.plane(words, control)
            modes.units(words, control)
            offsets.work_system(words, control)
            modes.distance(words, control)
            motion = words.g.get(MOTION)
            if motion is not None and motion not in (52, 53):
                state.motion = motion
            moves = 0 <= motion <= 30 if motion is not None else 0 <= state.motion <= 30 and 0 not in words.g
            if moves and not state.side:
                state.current = end_point(words, control)
                if not state.incremental:
                    self.axes -= words.values.keys()
        except (Fault, OverflowError):
            pass
        del control.out[kept:]
        control.parameters.commit()


def _is_computed(block: Block) -> bool:
    """Whether what is called has to be computed."""
    if block.flow is not None:
        return not isinstance(block.flow.label, float | Name)
    return any(not isinstance(value, float) for _, value in block.words)

"""Going on after a fault: what the faulty block would have done, as far as certain, and what follows from it."""

from __future__ import annotations

import re

from gcodesim.rs274.block import Block, Name
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects.linuxcnc import (
    CENTRE,
    DISTANCE,
    FEED_MODE,
    MOTION,
    NON_MODAL,
    PLANE,
    SPINDLE,
    SYSTEM,
    UNITS,
)
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.reader import prepare, read_plain
from gcodesim.rs274.watch.doubt import Doubt, codes_in
from gcodesim.rs274.words import Words, read_words

_HARMLESS = (MOTION, PLANE, DISTANCE, CENTRE, FEED_MODE, UNITS, SYSTEM)
_FLOW = re.compile(r"\s*+(?:/[1-9]?)?\s*+(?:n[\d.\s]*+)?(?:o|while|if\s*+\[|goto|do\s*+[1-9]|end\s*+[1-9])")
# a word with a number behind which another word begins, not a letter that stands where a digit was meant (`Y1O`)
_PLAIN_WORD = re.compile(
    r"(?<![A-Za-z#<\[])([A-Za-z])[ \t]*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))"
    r"(?![0-9.\[Oo]|[A-Za-z](?![ \t]*[-+]?(?:[0-9#\[]|\.[0-9])))"
)

# codes of faults that may only follow from an unknown position, feed, spindle or parameter
_BY_POSITION = frozenset(("GS110", "GS111", "GS112", "GS140", "GS151", "GS152", "GS153", "GS180"))
_BY_FEED = frozenset(("GS107",))
_BY_SPINDLE = frozenset(("GS108", "GS175"))
_BY_PARAMETER = frozenset(("GS120", "GS121", "GS123"))
_BY_MODE = frozenset(("GS101", "GS104", "GS150", "GS170", "GS191"))
_BY_FLOW = frozenset(("GS130", "GS132"))
_NOT_FOUND = "GS131"
_NOT_SIMULATED = "GS915"  # of a code that may have been a motion
# codes by which the program's zero, or the meaning of a coordinate, changes, and which are not carried over
_OF_FRAME = frozenset(
    f"g{code}"
    for code in (7, 8, 10, 15, 16, 50, 50.1, 51, 51.1, 52, 54.1, 54.2, 68, 68.2, 69, 92, 92.1, 92.2, 92.3, 154)
)
_UNREAD_END = re.compile(r"m(?:[^a-z0-9]*(?:0?2|30|99)(?![0-9])|$)")
_LETTER_O = re.compile(r"g0?o[0-3]?(?![0-9])")  # GO X5: a motion, whichever
_BY_PLACE = frozenset((920, 100))  # codes that set an offset by where the tool stands
_NAMED = re.compile(r"#<([^>]*)>")
_AXES = frozenset("xyzabcuvw")
_MOST_WORDS = 100  # characters of a line that are read; a longer line is not a block


class Recovery:
    """Keeps track of what is in doubt since the first fault."""

    def __init__(self, control: Control) -> None:
        self.control = control
        self.axes: set[str] = set()  # letters of the axes whose position nobody knows
        self.feed = False
        self.spindle = False
        self.speed = False  # what S is
        self.ended = False  # whether the program has come to its end before
        self.parameters = False
        self.modes = False
        self.motion = False  # only which motion is in force
        self.flow = False
        self.frame = False  # where the program's zero lies, or what an offset is
        self.named: set[str] = set()  # parameters that a faulty line names
        self.letters: set[str] = set()  # all that stand in faulty lines

    @property
    def place(self) -> bool:
        """Whether nobody knows where the moves lead."""
        return self.frame or self.modes or self.parameters or not self.axes.isdisjoint("xyz")

    @property
    def certain(self) -> bool:
        """Whether all is as if there had been no fault."""
        return not (self.place or self.axes or self.spindle or self.flow)

    @property
    def may_settle(self) -> bool:
        """Whether something is in doubt that a block may make certain again."""
        return bool(self.axes) or self.feed or self.spindle or self.motion

    def is_consequence(self, fault: Fault, block: Block | None) -> bool:
        """Whether `fault` may come from an earlier skipped block alone."""
        code = fault.code
        if code == _NOT_FOUND:
            return self.parameters and block is not None and _is_computed(block)
        if fault.lacks and not self.flow and self.letters.isdisjoint(fault.lacks):
            return (self.modes or self.motion) and not _says_its_motion(block)
        return (
            (code in _BY_POSITION and (self.modes or not self.axes.isdisjoint("xyz")))
            or (self.feed and code in _BY_FEED)
            or (self.spindle and code in _BY_SPINDLE)
            or (self.parameters and code in _BY_PARAMETER and not self._names_another(fault))
            or ((self.modes or self.motion) and code in _BY_MODE and not _says_its_motion(block))
            or (self.flow and code in _BY_FLOW)
        )

    def _names_another(self, fault: Fault) -> bool:
        """Whether a fault is about a named parameter that no faulty line names."""
        names = _NAMED.findall(fault.message.lower())
        return bool(names) and not self.flow and self.named.isdisjoint(map(_squeezed, names))

    def after(self, fault: Fault, block: Block | None, text: str) -> Doubt:
        """Carry out what is certain of the faulty block, and remember what is not; that is returned."""
        squeezed = re.sub(r"\([^)]*\)?|;.*", "", text).lower()
        self._doubt(squeezed, block)
        words = self._salvage(block, text)
        if words is not None:
            self._carry_over(words)
        bare = _NAMED.sub("", _squeezed(squeezed))
        self._doubt_unread(bare, _PLAIN_WORD.findall(squeezed), words)
        codes = codes_in(bare)
        self.motion = self.motion or fault.code == _NOT_SIMULATED
        self.frame = self.frame or not codes.isdisjoint(_OF_FRAME)
        return Doubt(
            spindle=self.spindle,
            any_code=self.modes,
            letters=frozenset(bare),
            codes=codes,
            unit=self.control.state.unit,
        )

    def settled(self, words: Words) -> None:
        """A block was executed after a fault: what it says without regard to what was before is certain again."""
        if not self.may_settle:
            return
        control = self.control
        if words.g.get(NON_MODAL) in _BY_PLACE and not self.axes.isdisjoint(words.values):
            self.frame = True
        if "f" in words.values:
            self.feed = False
        self.motion = self.motion and MOTION not in words.g
        self.speed = self.speed and not words.values.get("s")
        if not self.speed and (words.m.get(SPINDLE) in (3, 4, 5) or (words.values.get("s") and control.state.spindle)):
            self.spindle = False
        if not control.state.incremental and words.g.get(NON_MODAL) in (None, 530) and 0 <= control.state.motion <= 30:
            self.axes -= words.values.keys()

    def _doubt(self, text: str, block: Block | None) -> None:
        if (block is not None and block.flow is not None) or _FLOW.match(text):
            self.flow = self.parameters = self.modes = True
            self.axes |= _AXES
        self.letters |= set(text)
        self.axes |= _AXES if "@" in text or "^" in text else _AXES & set(text)
        if "#" in text:
            self.parameters = True
            self.named |= {_squeezed(name) for name in _NAMED.findall(text)}
        if re.search(r"m\s*0*[345](?![0-9])", text):
            self.spindle = True

    def _doubt_unread(self, bare: str, written: list[tuple[str, str]], words: Words | None) -> None:
        """Doubt what words of the line may have said that could not be read; `written` are those with a number."""
        read = set() if words is None else words.values.keys()
        codes = [] if words is None else words.m_codes
        letters = [letter for letter, _ in written]
        self.feed = self.feed or ("f" in bare and "f" not in read)
        if "s" in bare and "s" not in read:
            self.speed = self.spindle = True
        if bare.count("m") > letters.count("m"):
            self.spindle = True
            self.ended = self.ended or _UNREAD_END.search(bare) is not None
        self.ended = self.ended or not {2, 30, 99}.isdisjoint(codes)
        slips = len(_LETTER_O.findall(bare))
        self.motion = self.motion or slips > 0
        if bare.count("g") > letters.count("g") + slips:
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
            if words.m.get(SPINDLE) in (3, 4, 5):
                state.spindle = {3: 1, 4: -1, 5: 0}[words.m[SPINDLE]]
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


def _squeezed(text: str) -> str:
    """`text` without blanks, which mean nothing."""
    return re.sub(r"\s+", "", text)


def _says_its_motion(block: Block | None) -> bool:
    """Whether a block has a motion code of its own, so that no unknown mode decides what its words are."""
    return block is not None and any(letter == "g" and value in (0.0, 1.0, 2.0, 3.0) for letter, value in block.words)


def _is_computed(block: Block) -> bool:
    """Whether what is called has to be computed."""
    if block.flow is not None:
        return not isinstance(block.flow.label, float | Name)
    return any(not isinstance(value, float) for _, value in block.words)

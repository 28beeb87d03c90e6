"""Fanuc's lathes, G-code system A: X is a diameter, U and W are steps, T0101 is a tool with its offset.

Each block is turned into blocks of the milling control, whose X is a radius: G99 and G98 into G95 and G94, G32 into
G33, the turning cycles G70 to G76, G90, G92 and G94 into their moves. As in the operator's manual of the 0i-TF; cycles
in one block, with D, as in that of the series 10 and 11 and in Haas' lathe operator's manual.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from gcodesim.rs274.block import Block, Word
from gcodesim.rs274.ends import start_point
from gcodesim.rs274.fanuc import face_plane, lathe_cycles
from gcodesim.rs274.fanuc.executor import FanucExecutor
from gcodesim.rs274.fanuc.face_plane import FacePlane
from gcodesim.rs274.fanuc.halted_lathe import HaltedLathe
from gcodesim.rs274.fanuc.program import FanucFile
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.roughing import ContourMove, Point
from gcodesim.units import INCH, MM

_CYCLES = frozenset((90.0, 92.0, 94.0))
_MULTIPLE = frozenset((70.0, 71.0, 72.0, 73.0, 74.0, 75.0, 76.0))
_MOTIONS = frozenset((0.0, 1.0, 2.0, 3.0, 32.0, 33.0, 34.0))
_FEED_MODES = {98.0: 94.0, 99.0: 95.0}
_SPINDLE_MODES = frozenset((96.0, 97.0))
_ONE_SHOT = frozenset((4.0, 10.0, 65.0, 66.0))
_INCREMENT = {MM: 1e-3, INCH: 1e-4}  # IS-B


class FanucLatheFile(FanucFile):
    """A program of a lathe."""

    contour_cycles = frozenset((70.0, 71.0, 72.0, 73.0))


class FanucLatheExecutor(FanucExecutor):
    """Executes blocks of a lathe by those of the milling control."""

    file_class = FanucLatheFile

    cycle: float | None = None  # G90, G92 or G94 in force
    cycle_words: dict[str, float]
    prepared: dict[float, dict[str, float]]  # first lines of G71 to G76
    fastest: float | None = None  # G50 S
    started: bool = False
    face: FacePlane | None = None  # between G12.1 and G13.1

    def in_system_a(self, block: Block) -> Block:
        """A block as code system A writes it: as it is."""
        return block

    def _own_lanes(self) -> None:
        return None  # its words mean something else

    def _halted(self) -> HaltedLathe:
        return HaltedLathe(
            control=self.control,
            file=self.file,
            frames=tuple(self.flow.frames),
            simple_cycle=self.cycle,
            prepared=frozenset(self.prepared) if self.started else frozenset(),
            in_face_plane=self.face is not None,
        )

    def _words_of(self, block: Block, index: int) -> None:
        if not self.started:
            self.started, self.prepared, self.cycle_words = True, {}, {}
            self.control.state.plane = 180
            self.control.state.feed_mode = 950  # G99, as parameter FPM (3402.4) of the 0i-TF has it when it is new
            self.control.auto_length = False  # T0101 names its offset
        block = self.in_system_a(block)
        given = [(letter, float(value)) for letter, value in block.words if isinstance(value, (int, float))]
        codes = [value for letter, value in given if letter == "g"]
        switch = next((code for code in codes if code in face_plane.ON | face_plane.OFF), None)
        if switch is not None and not self.control.writing:
            self._switch_face(switch in face_plane.ON, given)
            return
        if self.face is not None:
            self._on_face(block, index, given)
            return
        if self.control.writing or not _ONE_SHOT.isdisjoint(codes):
            super()._words_of(block, index)
            return
        values = {letter: value for letter, value in given if letter not in "gmn"}
        if "t" in values:
            self._tool(block, index, values.pop("t"))
        words = [(letter, value) for letter, value in given if letter != "t"]
        multiple = next((code for code in codes if code in _MULTIPLE), None)
        if 50.0 in codes:
            self._coordinates(block, index, words, values)
        elif multiple is not None:
            self._multiple(block, index, multiple, values)
        elif 28.0 in codes or 30.0 in codes:
            self._home(block, index, words, values)
        else:
            self._moves(block, index, words, codes, values)

    def _switch_face(self, on: bool, given: list[tuple[str, float]]) -> None:
        """G12.1 and G13.1, each in a block of its own; what is in force already stays."""
        if rest := next(((letter, value) for letter, value in given if letter not in "gn"), None):
            name = "G12.1" if on else "G13.1"
            raise Fault("GS106", f"{name} stands in a block of its own", at=rest[0], hint="put the rest into the next")
        if on and self.face is None:
            self.face, self.cycle = FacePlane.begin(self.control), None
        elif not on and self.face is not None:
            self.face.end(self.control)
            self.face = None

    def _on_face(self, block: Block, index: int, given: list[tuple[str, float]]) -> None:
        """A block of a contour of X and C, whose moves become those of the axes."""
        assert self.face is not None
        if not {("g", 65.0), ("g", 66.0)}.isdisjoint(given):
            super()._words_of(block, index)
            return
        words = face_plane.in_plane(given, self.control)
        before = len(self.control.out)
        self.say(block, index, [("g", _FEED_MODES.get(v, v)) if letter == "g" else (letter, v) for letter, v in words])
        self.control.out[before:] = list(self.face.moves(self.control.out[before:]))

    # -- words

    def here(self) -> tuple[float, float]:
        """Z and X (as a radius) of the programmed point."""
        point = start_point(self.control)
        return point[2], point[0]

    def end_of(self, values: dict[str, float], here: tuple[float, float]) -> tuple[float, float]:
        """Z and X (as a radius) to which words lead."""
        z, x = here
        x = 0.5 * values["x"] if "x" in values else x + 0.5 * values.get("u", 0.0)
        z = values["z"] if "z" in values else z + values.get("w", 0.0)
        return z, x

    def say(self, block: Block, index: int, words: Sequence[tuple[str, float]]) -> None:
        """Execute words as a block of the milling control, in place of `block`."""
        first = block.places[0] if block.places else (0, len(block.text))
        made = Block(
            block.line, block.text, [Word(*word) for word in words], _places=[_place(block, w, first) for w in words]
        )
        out = self.control.out
        before, out[:] = list(out), []  # a block of its own: what the compensation holds back comes after what is out
        try:
            super()._words_of(made, index)
        finally:
            out[:0] = before

    def move(self, block: Block, index: int, rapid: bool, z: float, x: float, feed: float | None = None) -> None:
        words = [("g", 0.0 if rapid else 1.0), ("x", x), ("z", z)]
        self.say(block, index, [*words, ("f", feed)] if feed is not None and not rapid else words)

    # -- blocks

    def _tool(self, block: Block, index: int, number: float) -> None:
        tool, offset = divmod(round(number), 100)
        if number < 100:
            tool, offset = round(number), round(number)
        if tool != self.control.spindle_tool.number:
            self.say(block, index, [("t", float(tool)), ("m", 6.0)])
        self.say(block, index, [("g", 43.0), ("h", float(offset))] if offset else [("g", 49.0)])
        self.control.state.radius_number = offset  # the nose belongs to the same offset

    def _coordinates(self, block: Block, index: int, words: list[tuple[str, float]], values: dict[str, float]) -> None:
        """G50: the greatest speed of the spindle, or where the tool is said to be."""
        if "s" in values:
            self.fastest = values["s"]
            self.control.state.surface_speed_cap = self.fastest
        if not {"x", "z", "u", "w"}.isdisjoint(values):
            z, x = self.end_of(values, self.here())
            self.say(block, index, [("g", 92.0), ("x", x), ("z", z)])
        rest = [w for w in words if w not in (("g", 50.0),) and w[0] not in "xzuwsn"]
        if rest:
            self.say(block, index, rest)

    def _home(self, block: Block, index: int, words: list[tuple[str, float]], values: dict[str, float]) -> None:
        z, x = self.end_of(values, self.here())
        axes = [("x", x)] if not {"x", "u"}.isdisjoint(values) else []
        axes += [("z", z)] if not {"z", "w"}.isdisjoint(values) else []
        self.say(block, index, [*(w for w in words if w[0] not in "xzuw"), *axes])

    def _moves(
        self, block: Block, index: int, words: list[tuple[str, float]], codes: list[float], values: dict[str, float]
    ) -> None:
        own = next((code for code in codes if code in _CYCLES), None)
        if own is not None:
            self.cycle, self.cycle_words = own, {}
        elif not _MOTIONS.isdisjoint(codes):
            self.cycle = None
        plain = [("g", _FEED_MODES.get(v, v)) if letter == "g" else (letter, v) for letter, v in words]
        has_axes = not {"x", "z", "u", "w"}.isdisjoint(values)
        if self.cycle is not None:
            rest = [w for w in plain if w[0] in "gms" and not (w[0] == "g" and w[1] in _CYCLES and w[1] == own)]
            if rest:
                self.say(block, index, rest)
            if has_axes:
                for letter, other in (("x", "u"), ("u", "x"), ("z", "w"), ("w", "z")):
                    if letter in values:
                        self.cycle_words.pop(other, None)
                self.cycle_words |= {k: v for k, v in values.items() if k in "xzuwrf"}
                lathe_cycles.single(self, block, index, self.cycle, self.cycle_words)
            return
        z, x = self.end_of(values, self.here())
        plain = [w for w in plain if w[0] not in "xzuw"]
        if has_axes:
            if not {"x", "u"}.isdisjoint(values):
                plain.append(("x", x))
            if not {"z", "w"}.isdisjoint(values):
                plain.append(("z", z))
        if 32.0 in codes or 33.0 in codes or (self.control.state.motion == 330 and has_axes and not codes):
            self.pitch = values.get("f", getattr(self, "pitch", 0.0))
            plain = [("g", 33.0) if w == ("g", 32.0) else w for w in plain if w[0] != "f"]
            plain.append(("k", self.pitch))
        self.say(block, index, plain)
        if self.fastest is not None and not _SPINDLE_MODES.isdisjoint(codes):
            self.control.state.surface_speed_cap = self.fastest
            if 96.0 in codes and "s" in values:
                self.say(block, index, [("s", values["s"])])

    # -- multiple cycles

    def _multiple(self, block: Block, index: int, code: float, values: dict[str, float]) -> None:
        feed = values.get("f")
        if "s" in values:
            self.say(block, index, [("s", values["s"])])
        if code == 70.0:
            if feed is not None:  # as Haas has it; words F of the contour come after it
                self.say(block, index, [("f", feed)])
            self._finish_contour(block, index, values)
            return
        is_first = "p" not in values if code < 74.0 else {"x", "z", "u", "w"}.isdisjoint(values)
        if is_first:
            self.prepared[code] = {**values, **self._fine(block, values)}
            return
        values = values | self._fine(block, values)
        if feed is not None:
            self.say(block, index, [("f", feed)])
        first = self.prepared.get(code, {})
        if (both := lathe_cycles.in_one_block(code, values)) is not None:
            first, values = both
            for letter in sorted({"i", "k"} & values.keys() if code < 73.0 else ()):
                where = next(p for (own, _), p in zip(block.words, block.places, strict=True) if own == letter)
                self.control.skip(f"G{code:g} {letter.upper()}", where)  # a pass of its own for what is left
        if code < 74.0:
            contour, last, pockets = self._moves_of_contour(block, index, values)
            lathe_cycles.rough(self, block, index, code, first, values, contour, pockets=pockets)
            self.flow.frame.at = last + 1
        elif code == 76.0:
            lathe_cycles.thread(self, block, index, first, values)
        else:
            lathe_cycles.pecks(self, block, index, code, first, values)

    def _fine(self, block: Block, values: dict[str, float]) -> dict[str, float]:
        """P, Q and D without a point count in least increments, where they are lengths."""
        increment = _INCREMENT[self.control.state.unit]
        found = {}
        for (letter, value), (first, last) in zip(block.words, block.places, strict=True):
            if letter in "pqd" and not any(char in block.text[first:last] for char in ".#["):
                found[f"{letter}_fine"] = increment * float(value)  # type: ignore[arg-type]
            elif letter in "pqd":
                found[f"{letter}_fine"] = values[letter]
        return found

    def _lines(self, block: Block, index: int, values: dict[str, float]) -> tuple[int, int]:
        found = []
        for letter, what in (("p", "first"), ("q", "last")):
            number = values.get(letter)
            line = None if number is None else self.file.sequence(round(number), index)
            if line is None:
                said = f"{letter.upper()}{number:g}" if number is not None else f"no {letter.upper()}"
                raise Fault("GS105", f"there is no {what} block of the contour: {said}", at=letter)
            found.append(line)
        if found[1] < found[0]:
            raise Fault("GS106", "the last block of the contour stands before the first", at="q")
        return found[0], found[1]

    def _finish_contour(self, block: Block, index: int, values: dict[str, float]) -> None:
        first, last = self._lines(block, index, values)
        z, x = self.here()
        for line in range(first, last + 1):
            read = self.file.block(line)
            if read.words:
                if {("m", 2.0), ("m", 30.0), ("m", 99.0)} & set(read.words):
                    raise Fault("GS106", f"line {line + 1} ends the program inside the contour", at="q")
                self._words_of(read if read.plain else self._resolved(read), line)
        self.move(block, index, True, z, x)

    def _moves_of_contour(
        self, block: Block, index: int, values: dict[str, float]
    ) -> tuple[list[ContourMove], int, bool]:
        """The moves of a contour in (z, x), its last line, and whether its first block moves both axes."""
        first, last = self._lines(block, index, values)
        here, motion, both = self.here(), 0.0, False
        moves: list[ContourMove] = []
        for line in range(first, last + 1):
            read = self.file.block(line)
            if not read.words:
                continue
            read = self.in_system_a(read if read.plain else self._resolved(read))
            words = {letter: float(v) for letter, v in read.words if letter not in "gmn"}  # type: ignore[arg-type]
            motion = next((float(v) for g, v in read.words if g == "g" and v in _MOTIONS), motion)
            if {"x", "z", "u", "w"}.isdisjoint(words):
                continue
            end = self.end_of(words, here)
            if line == first:
                both = end[0] != here[0] and end[1] != here[1]
            if motion in (2.0, 3.0):
                sense = 1 if motion == 3.0 else -1
                moves.append(ContourMove(end, centre=_centre(here, end, words, sense), sense=sense))
            else:
                moves.append(ContourMove(end, rapid=motion == 0.0))
            here = end
        if len(moves) < 2:
            raise Fault("GS106", "the contour has fewer than two moves", at="p")
        return moves, last, both


def _centre(start: Point, end: Point, words: dict[str, float], sense: int) -> Point:
    """The centre (z, x) of an arc by K and I, or by R."""
    if "r" not in words:
        return start[0] + words.get("k", 0.0), start[1] + words.get("i", 0.0)
    (z0, x0), (z1, x1), radius = start, end, words["r"]
    half = 0.5 * math.hypot(z1 - z0, x1 - x0)
    if half == 0.0 or half > abs(radius) * (1.0 + 1e-3):
        raise Fault("GS106", f"no arc of radius R{radius:g} joins these points", at="r")
    height = math.sqrt(max(radius * radius - half * half, 0.0)) * (1.0 if radius > 0.0 else -1.0) * sense
    return (
        0.5 * (z0 + z1) - height * (x1 - x0) / (2.0 * half),
        0.5 * (x0 + x1) + height * (z1 - z0) / (2.0 * half),
    )


def _place(block: Block, word: tuple[str, float], first: tuple[int, int]) -> tuple[int, int]:
    for (letter, _), place in zip(block.words, block.places, strict=True):
        if letter == word[0]:
            return place
    return first

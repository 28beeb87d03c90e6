"""A tool path as the text of a program."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.frames import Array
from gcodesim.motion.tool_path import ARC, BLEND, EXACT_PATH, EXACT_STOP, HOME, RAPID
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.units import DEG, MM, RPM

if TYPE_CHECKING:
    from gcodesim.motion.tool_path import ToolPath, ToolState

_LETTERS: Final = "XYZABC"
_CENTRES: Final = "IJK"
_PLANES: Final = {2: "G17", 1: "G18", 0: "G19"}
_MODES: Final = {EXACT_STOP: "G61.1", EXACT_PATH: "G61", BLEND: "G64"}
_WITH_TURNS: Final = ("linuxcnc", "rs274")  # P of an arc counts turns; G61 and G64 are as in LinuxCNC
_OF_LATHES: Final = ("fanuc_lathe", "fanuc_lathe_b")
_OF_MACHINES: Final = ("fanuc", "grbl", *_WITH_TURNS)  # the others, of printers, take one code a line, and no end
_DECIMALS: Final = 6  # of mm and degrees
_UPRIGHT: Final = 1.0 - 1e-9  # share of an arc's normal along an axis


def gcode_of(path: ToolPath, dialect: str = "linuxcnc", switch: tuple[str, str] | None = None) -> str:
    """The text of a program that makes the moves of `path`, in mm, in the axes in which the path is given.

    `dialect` is a name of `DIALECTS`. `switch` are the words before which the process tool begins and ends to work, as
    ("M62 P1", "M63 P1"). ValueError where the language cannot say it: an unknown dialect, an arc about an axis that
    leans, several turns of an arc, the language of a lathe, a path with the tool on and no `switch`.
    """
    if dialect not in DIALECTS:
        raise ValueError(f"there is no dialect `{dialect}`; there are {', '.join(DIALECTS)}")
    if dialect in _OF_LATHES:
        raise ValueError(f"`{dialect}` is the language of lathes, which follow no path in space")
    if path.active.any() and switch is None:
        raise ValueError('the process tool is switched on in this path: give the words, as switch=("M62 P1", "M63 P1")')
    return "".join(f"{line}\n" for line in _Writer(path, dialect, switch).lines())


class _Writer:
    """What the control knows so far: a word that holds already is not written again."""

    def __init__(self, path: ToolPath, dialect: str, switch: tuple[str, str] | None) -> None:
        self._path, self._dialect, self._switch = path, dialect, switch
        self._point = dialect == "fanuc"  # a number without a point counts increments there
        self._at: Array = np.zeros(6)
        self._held: dict[str, str] = {"plane": "G17", "mode": "", "tool": "", "spindle": "M5", "coolant": "M9"}
        self._on = False

    def lines(self) -> Iterator[str]:
        path = self._path
        if self._dialect == "fanuc":
            yield from ("%", "O0001")
        yield from ("G21 G90 G94 G17",) if self._dialect in _OF_MACHINES else ("G21", "G90")
        for row in range(len(path)):
            yield from self._state(path.state_of(row))
            yield from self._switched(bool(path.active[row]))
            yield from self._changed("mode", self._mode(row))
            if not np.array_equal(self._at, path.start[row]):
                yield self._line("G0", path.start[row])
                self._at = path.start[row]
            yield self._move(row)
            self._at = path.end[row]
        yield from self._switched(False)
        if self._held["spindle"] != "M5":
            yield "M5"
        if self._dialect in _OF_MACHINES:
            yield "M30" if self._dialect == "fanuc" else "M2"
        if self._dialect == "fanuc":
            yield "%"

    def _state(self, state: ToolState) -> Iterator[str]:
        if state.tool or self._held["tool"]:
            yield from self._changed("tool", f"T{state.tool}{' M6' if self._dialect in _OF_MACHINES else ''}")
        turning = "M3" if state.spindle > 0.0 else "M4"
        speed = f"S{self._number(abs(state.spindle) / RPM)} {turning}"
        yield from self._changed("spindle", speed if state.spindle else "M5")
        yield from self._changed("coolant", "M8" if state.flood else "M7" if state.mist else "M9")

    def _changed(self, what: str, words: str) -> Iterator[str]:
        if words and self._held[what] != words:
            self._held[what] = words
            yield words

    def _switched(self, on: bool) -> Iterator[str]:
        if on != self._on:
            assert self._switch is not None
            self._on = on
            yield self._switch[0 if on else 1]

    def _mode(self, row: int) -> str:
        if self._dialect not in _WITH_TURNS:
            return ""
        mode, tolerance = int(self._path.mode[row]), float(self._path.tolerance[row])
        words = _MODES[mode]
        return f"{words} P{self._number(tolerance / MM)}" if mode == BLEND and tolerance > 0.0 else words

    def _move(self, row: int) -> str:
        path = self._path
        if path.kind[row] == HOME:
            return "G28"
        if path.kind[row] == RAPID:
            return self._line("G0", path.end[row])
        rotary = bool(path.rotary_feed[row])
        feed = f"F{self._number(float(path.feed[row]) * 60.0 / (DEG if rotary else MM))}"
        if path.kind[row] == ARC:
            return f"{self._arc(row)} {feed}"
        return f"{self._line('G1', path.end[row])} {feed}"

    def _arc(self, row: int) -> str:
        path = self._path
        axis = int(np.argmax(np.abs(path.normal[row])))
        if abs(path.normal[row, axis]) < _UPRIGHT:
            raise ValueError(f"move {row + 1} is an arc about an axis that leans; a program cannot say that")
        sweep = float(path.sweep[row] * np.sign(path.normal[row, axis]))
        plane = _PLANES[axis]
        words = [] if self._held["plane"] == plane else [plane]
        self._held["plane"] = plane
        inside = [k for k in range(3) if k != axis]
        centre = (path.center[row] - path.start[row, :3])[inside]
        ends = [f"{_LETTERS[k]}{self._number(float(path.end[row, k]) / MM)}" for k in inside]
        if path.end[row, axis] != path.start[row, axis]:
            ends.append(f"{_LETTERS[axis]}{self._number(float(path.end[row, axis]) / MM)}")
        words += ["G3" if sweep > 0.0 else "G2", *ends]
        words += [f"{_CENTRES[k]}{self._number(float(c) / MM)}" for k, c in zip(inside, centre, strict=True)]
        turns = math.ceil(abs(sweep) / (2.0 * math.pi) - 1e-9)
        if turns > 1:
            if self._dialect not in _WITH_TURNS:
                raise ValueError(
                    f"move {row + 1} is an arc of {turns} turns; an arc of {self._dialect} has at most one"
                )
            words.append(f"P{turns}")
        return " ".join(words)

    def _line(self, word: str, end: Array) -> str:
        moved = [k for k in range(6) if end[k] != self._at[k]] or [0]
        return " ".join(
            [word, *(f"{_LETTERS[k]}{self._number(float(end[k]) / (MM if k < 3 else DEG))}" for k in moved)]
        )

    def _number(self, value: float) -> str:
        text = f"{value:.{_DECIMALS}f}".rstrip("0")
        text = "0." if text == "-0." else text
        return text if self._point else text.rstrip(".")

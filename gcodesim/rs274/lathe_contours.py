"""LinuxCNC's G70, G71 and G72: cycles along a contour that stands in a subroutine.

`G71 Q100 X22 Z2 D0.4 I1.5 R0.5`: from X22 Z2 cuts of I, each ended by an escape R, D beside the contour of O100.
`G70 Q100 X22 Z2 D0 E0 P1`: along the contour itself, in P passes from D beside it to E.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from gcodesim.rs274.arcs import arc
from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.roughing import ContourMove, Point, beside, chords, passes
from gcodesim.rs274.words import Words

_UNITS = {700: "inches are G20", 710: "millimetres are G21"}
_MOTIONS = {0: 0, 10: 0, 20: -1, 30: 1}


def contour_cycle(words: Words, control: Control, code: int) -> None:
    """Execute G70, G71.n or G72.n; `control.contours` gives the blocks of the subroutine."""
    state, values, who = control.state, words.values, f"G{code // 10}"
    if "q" not in words.values:
        at = who.lower() if who.lower() in words.names else None
        if code in _UNITS and {"x", "z"}.isdisjoint(words.values):  # on other controls they choose the unit
            raise Fault("GS915", f"{who} is not simulated without Q: a cycle of lathes ({_UNITS[code]})", at=at)
        raise Fault("GS105", f"{who} needs the word Q, the number of the subroutine with the contour", at=at)
    number = words.values["q"]
    if state.plane != 180:
        raise Fault("GS106", f"{who} works in the XZ plane only", hint="say G18 before")
    depth, escape, aside = values.get("i", 1.0), values.get("r", 0.5), values.get("d", 0.0)
    if depth <= 0.0:
        raise Fault("GS106", f"the depth I{depth:g} of {who} must be more than 0", at="i")
    x, z = values.get("x", state.current[0]), values.get("z", state.current[2])
    incremental, absolute = state.incremental, state.centre_absolute
    if incremental:
        x, z = (now + values.get(letter, 0.0) for now, letter in ((state.current[0], "x"), (state.current[2], "z")))
    _go(control, words, z, x, rapid=True)
    moves = _contour(control, round(number), (z, x), who)
    start = (z, x)
    state.incremental, state.centre_absolute = False, False
    try:
        if code == 700:
            _finish(words, control, start, moves, aside)
        else:
            shift = (values.get("w", 0.0), values.get("u", 0.0) * (0.5 if state.diameter else 1.0))
            _rough(words, control, code, start, moves, (depth, escape, aside), shift)
    finally:
        state.incremental, state.centre_absolute = incremental, absolute


def _contour(control: Control, number: int, start: Point, who: str) -> list[ContourMove]:
    state = control.state
    here, motion = start, 0
    moves: list[ContourMove] = []
    for words in control.contours(number):
        values = words.values
        motion = words.g.get(1, motion)
        end = (
            values.get("z", 0.0 if state.incremental else here[0]) + (here[0] if state.incremental else 0.0),
            values.get("x", 0.0 if state.incremental else here[1]) + (here[1] if state.incremental else 0.0),
        )
        if {"x", "z"}.isdisjoint(values):
            continue
        if motion not in _MOTIONS:
            raise Fault("GS106", f"the contour of {who} has a block that is no G0 to G3")
        sense = _MOTIONS[motion]
        if not sense:
            moves.append(ContourMove(end, rapid=motion == 0))
        else:
            moves.append(ContourMove(end, centre=_centre(control, here, end, values, sense), sense=sense))
        here = end
    if len(moves) < 2:
        raise Fault("GS106", f"O{number} holds no contour for {who}: it has fewer than two moves", at="q")
    return moves


def _centre(control: Control, start: Point, end: Point, values: dict[str, float], sense: int) -> Point:
    if "r" in values:
        half = 0.5 * math.hypot(end[0] - start[0], end[1] - start[1])
        radius = values["r"]
        if half == 0.0 or half > abs(radius) * (1.0 + 1e-3):
            raise Fault("GS106", f"no arc of radius R{radius:g} joins these points")
        high = math.sqrt(max(radius * radius - half * half, 0.0)) * (1.0 if radius > 0.0 else -1.0) * sense
        return (
            0.5 * (start[0] + end[0]) - high * (end[1] - start[1]) / (2.0 * half),
            0.5 * (start[1] + end[1]) + high * (end[0] - start[0]) / (2.0 * half),
        )
    if control.state.centre_absolute:
        return values.get("k", start[0]), values.get("i", start[1])
    return start[0] + values.get("k", 0.0), start[1] + values.get("i", 0.0)


def _rough(
    words: Words,
    control: Control,
    code: int,
    start: Point,
    moves: Sequence[ContourMove],
    sizes: tuple[float, float, float],
    shift: Point,
) -> None:
    depth, escape, aside = sizes
    points = [(z + shift[0], x + shift[1]) for z, x in chords(start, moves)[1:]]
    swap = code // 10 == 72
    inside = not swap and points[-1][1] < points[0][1] and start[1] <= points[-1][1] + 1e-9

    def turned(point: Point) -> Point:
        z, x = point
        return (x, z) if swap else (z, -x if inside else x)

    around = beside([turned(p) for p in points], aside)
    for rapid, a, b in passes(around, turned(start), depth, escape, pockets=code % 10 != 1):
        z, x = (b, a) if swap else (a, -b if inside else b)
        _go(control, words, z, x, rapid=rapid)
    _go(control, words, *start, rapid=True)
    if code % 10 != 1:
        for number, (a, b) in enumerate(around):
            z, x = (b, a) if swap else (a, -b if inside else b)
            _go(control, words, z, x, rapid=number == 0)
        _go(control, words, *start, rapid=True)


def _finish(words: Words, control: Control, start: Point, moves: Sequence[ContourMove], first: float) -> None:
    last = words.values.get("e", 0.0)
    count = words.whole("p", "G70") or 1
    for k in range(count):
        off = first if count == 1 else first + (last - first) * k / (count - 1)
        if off:
            for number, (z, x) in enumerate(beside(chords(start, moves)[1:], off)):
                _go(control, words, z, x, rapid=number == 0)
        else:
            _follow(words, control, moves)
        if k < count - 1:
            _go(control, words, *start, rapid=True)


def _follow(words: Words, control: Control, moves: Sequence[ContourMove]) -> None:
    for number, move in enumerate(moves):
        if not move.sense:
            _go(control, words, *move.end, rapid=move.rapid or number == 0)
            continue
        now = control.state.current
        block = Words(words.block)
        block.values = {
            "x": move.end[1],
            "z": move.end[0],
            "i": move.centre[1] - now[0],
            "k": move.centre[0] - now[2],
        }
        arc(block, control, 30 if move.sense > 0 else 20)


def _go(control: Control, words: Words, z: float, x: float, *, rapid: bool) -> None:
    del words
    now = control.state.current
    end = (x, now[1], z, *now[3:])
    if rapid:
        control.rapid(end)
    else:
        control.line(end)

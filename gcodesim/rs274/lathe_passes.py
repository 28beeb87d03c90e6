"""The passes of LinuxCNC's roughing cycles G71 and G72, as its interpreter makes them.

The tool goes along the outline. Where that falls, from the start of the cycle or into a pocket, it stops at even
depths, cuts straight ahead to where the outline rises again, escapes by 45 degrees and comes back. The depths count
from the start, or from the edge of the first pocket if only pockets are cut.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from gcodesim.frozen import frozen
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.lathe_outline import CLOSE, OutlinePart, Point, at_level, rising_and_falling

ALL, NO_POCKETS, NO_ROUGHING = 0, 1, 2
"""The subtypes: G71 cuts all, G71.1 bridges the pockets, G71.2 cuts only them."""

_MOST: Final = 50_000


@frozen(kw_only=False)
class RoughingPasses:
    """Depth of a pass, the escape at its end [mm], and the subtype."""

    depth: float
    escape: float
    kind: int

    def along(self, start: Point, outline: Sequence[OutlinePart]) -> list[OutlinePart]:
        """All moves from `start` on, with passes, to the end of `outline`, and out to the level of `start`."""
        last = outline[-1].end
        entry = OutlinePart(start, outline[0].begin, rapid=True)
        way = [entry, *outline]
        if last[1] < start[1] - CLOSE:
            way.append(OutlinePart(last, (last[0], start[1])))
        rest = rising_and_falling(way)
        moves: list[OutlinePart] = []
        if self.kind == NO_ROUGHING:
            moves.append(rest.pop(0))
        initial, falling, level = True, False, start[1]
        highest = None if self.kind == NO_ROUGHING else start[1]
        while rest:
            part = rest.pop(0)
            if part.end[1] >= part.begin[1] - CLOSE:
                initial = falling = False
                if self.kind == NO_POCKETS and part is not entry:
                    moves.append(OutlinePart(part.begin, part.begin))
                moves.append(OutlinePart(part.begin, part.end) if part is entry else part)
                continue
            if not falling:
                highest = part.begin[1] if highest is None and not initial else highest
                falling, level = True, self._first_level(part.begin[1], highest)
            if self.kind == NO_POCKETS and not initial:
                self._bridge(part, part.begin[1], rest, moves)
            elif self.kind == NO_ROUGHING and initial:
                moves.append(part)
            else:
                level = self._rough(part, level, rest, moves)
        return _whole(moves)

    def _first_level(self, begin: float, highest: float | None) -> float:
        """The highest level of the passes that is not above `begin`; they are even depths below `highest`."""
        if highest is None:
            return begin
        return highest - max(math.ceil((highest - begin - CLOSE) / self.depth), 0) * self.depth

    def _rough(self, part: OutlinePart, level: float, rest: Sequence[OutlinePart], moves: list[OutlinePart]) -> float:
        """Along a falling part, with a pass at each level; the next level."""
        while level > part.end[1] + CLOSE:
            if len(moves) > _MOST:
                raise Fault("GS106", f"more than {_MOST} moves: the depth I{self.depth:g} is too small", at="i")
            begin = at_level(part, level)
            _go(part.part(part.begin, begin), moves)
            part = part.part(begin, part.end)
            end = _meeting(rest, level)
            if end is not None:
                out = min(self.escape, 0.5 * (end[0] - begin[0]))
                away, back = (end[0] - out, level + out), (begin[0] + out, level + out)
                moves += [
                    OutlinePart(begin, end),
                    OutlinePart(end, away, rapid=True),
                    OutlinePart(away, back, rapid=True),
                    OutlinePart(back, begin, rapid=part.rapid),
                ]
            level -= self.depth
        _go(part, moves)
        return level

    def _bridge(self, part: OutlinePart, level: float, rest: list[OutlinePart], moves: list[OutlinePart]) -> None:
        """Straight over a pocket, to where the outline rises again."""
        end = _meeting(rest, level)
        if end is None:
            moves.append(part)
            return
        while rest[0].end[1] < level - CLOSE:
            rest.pop(0)
        over = rest.pop(0)
        moves.append(OutlinePart(part.begin, end))
        left = over.part(end, over.end)
        if not left.length_is_zero:
            moves.append(left)


def _go(part: OutlinePart, moves: list[OutlinePart]) -> None:
    if not (part.sense and part.length_is_zero):
        moves.append(part)


def _whole(moves: Sequence[OutlinePart]) -> list[OutlinePart]:
    """With arcs in one piece that were divided only at the bottom of a pocket."""
    whole: list[OutlinePart] = []
    for move in moves:
        last = whole[-1] if whole else move
        same = (last.sense, last.centre, last.end) == (move.sense, move.centre, move.begin)
        if same and move.sense and last.end[1] < last.begin[1]:
            whole[-1] = last.part(last.begin, move.end)
        else:
            whole.append(move)
    return whole


def _meeting(rest: Sequence[OutlinePart], level: float) -> Point | None:
    """Where the outline first rises to `level`."""
    rising = (part for part in rest if part.end[1] >= level - CLOSE)
    part = next(rising, None)
    return None if part is None else at_level(part, level)

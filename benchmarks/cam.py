"""Programs as CAM systems and people write them, of any length, for the benchmarks of reading."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import islice
from typing import Final

from benchmarks import job

HEAD: Final = ("G21 G90 G17 G40 G49 G94 G64 P0.01", "T1 M6", "G43 H1", "S8000 M3", "F1500")


def raster(lines: int) -> Iterator[str]:
    """A finishing raster of short chords."""
    yield from islice(job.lines(lines), 1, lines)
    yield "M2"


def raster_with_expressions(lines: int) -> Iterator[str]:
    """The same with an expression in every 500th line."""
    yield "#1=0.25"
    for number, line in enumerate(raster(lines - 1)):
        letter = line[-1:].isdigit() and "Z" in line and number % 500 == 0
        yield f"{line} F[1500 + #1 * {number % 7}]" if letter else line


def arcs(lines: int) -> Iterator[str]:
    """Half circles in a row, to and fro."""
    yield from (*HEAD, "G0 X0 Y0 Z-1")
    for number in range(lines):
        if number % 400 == 0:
            yield "G0 X0 Y0"
        yield f"G{2 + number % 2} X{2.0 * (number % 400 + 1):.4f} Y0.0000 I1.0000 J0.0000"
    yield "M2"


def five_axes(lines: int) -> Iterator[str]:
    """Simultaneous moves of X Y Z B C."""
    yield from HEAD
    for number in range(lines):
        t = 0.01 * number
        yield (
            f"G1 X{50 * math.cos(t):.4f} Y{50 * math.sin(t):.4f} Z{-5 + 2 * math.sin(3 * t):.4f} "
            f"B{20 * math.sin(t):.4f} C{math.degrees(t) % 360:.4f}"
        )
    yield "M2"


def compensation(lines: int) -> Iterator[str]:
    """A wavy outline on the left of the path, around and around."""
    yield from (*HEAD, "G0 X103 Y-30 Z5", "G1 Z-1", "G41.1 D6 G1 Y-15", "X103 Y0")
    for number in range(1, lines):
        t = 0.02 * number
        r = 103 + 3 * math.sin(7 * t)
        yield f"X{r * math.cos(t):.4f} Y{r * math.sin(t):.4f}"
    yield from ("G40 G1 X200 Y-200", "M2")


def drilling(lines: int) -> Iterator[str]:
    """Holes in rows of a hundred."""
    yield from (*HEAD, "G0 Z10", "G98 G81 X0 Y0 Z-5 R2 F200")
    for number in range(1, lines):
        yield f"X{5 * (number % 100)} Y{5 * (number // 100)}"
    yield from ("G80", "M2")


def calls(rounds: int) -> Iterator[str]:
    """A loop that calls a subroutine which calls another one twice."""
    yield from ("F500", "o<inner> sub", "G1 X#1 Y#2", "G0 Z[#1+1]", "o<inner> endsub")
    yield from ("o<outer> sub", "o<inner> call [#1] [#2]", "o<inner> call [#1+1] [#2]", "o<outer> endsub")
    yield from ("#9=0", f"o1 while [#9 LT {rounds}]", "o<outer> call [#9] [2]", "#9=[#9+1]", "o1 endwhile", "M2")


def macros(rounds: int) -> Iterator[str]:
    """A loop of assignments and branches, full of expressions, with one move a round."""
    yield from ("F500", "#1=0", f"o1 while [#1 LT {rounds}]", "#2=[10*cos[#1*3.6]+sqrt[#1]]")
    yield from ("#3=[10*sin[#1*3.6]-abs[#2]/2]", "#<r>=[#2*#2+#3*#3]", "o2 if [#<r> GT 50]", "#4=[atan[#3]/[#2]]")
    yield from ("o2 else", "#4=[#<r> MOD 7]", "o2 endif", "G1 X#2 Y#3 Z[#4/100] A[exp[#1/10000]]", "#1=[#1+1]")
    yield from ("o1 endwhile", "M2")


PROGRAMS: Final[dict[str, Callable[[int], Iterator[str]]]] = {
    "raster": raster,
    "arcs": arcs,
    "five axes": five_axes,
    "compensation": compensation,
    "drilling": drilling,
    "calls": calls,
    "macros": macros,
}


def text(program: Iterator[str]) -> bytes:
    """A program as a file holds it."""
    return ("\n".join(program) + "\n").encode()

"""Write the generated programs of this folder: `python programs/make_programs.py [FOLDER]`.

Each function yields the lines of one program, in the style of a CAM post of
the kind named in its comment. Programs that are not listed here were written
by hand.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

Lines = Iterator[str]


def word(letter: str, value: float, digits: int = 3) -> str:
    """A word as posts write it: fixed point, no trailing zeros, never -0."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return letter + ("0" if text in ("-0", "") else text)


def at(digits: int = 3, **words: float) -> str:
    """`X1.5 Y2` of `x=1.5, y=2`."""
    return " ".join(word(letter.upper(), value, digits) for letter, value in words.items())


# --- bracket: face, pocket, bores, drill pattern; four tools ------------------


def bracket() -> Lines:
    """A plate 120 x 80 x 25 mm, zero at the front left of its top."""
    yield "%"
    yield "(bracket: face, pocket, two bores, four holes)"
    yield "(stock 120 x 80 x 25, zero top front left, AlMgSi1)"
    yield "(T1 end mill 32, T2 end mill 10, T3 drill 6, T4 end mill 8)"
    yield "G21 G90 G17 G40 G49 G80 G94"
    yield "G54 G64 P0.02"
    yield from _tool(1, "face", 6000)
    yield "G0 X-20 Y12"
    yield "G0 Z5"
    yield "G1 Z-1 F800"
    yield "F1500"
    for row in range(4):
        y = 12.0 + 18.0 * row
        if row:
            yield f"G1 {at(y=y)}"
        yield f"G1 X{140 if row % 2 == 0 else -20}"
    yield "G0 Z50"
    yield from _tool(2, "pocket 60 x 36, 8 deep", 9000)
    yield "G0 X60 Y40"
    yield "G0 Z2"
    for level in range(1, 5):
        z = -1.0 - 2.0 * level
        yield f"(level {level})"
        if level == 1:
            yield "G1 Z-1 F600"
        yield "G1 X68 Y40 F900"
        yield f"G3 X68 Y40 I-8 J0 {at(z=z)} F700"
        yield "G3 X68 Y40 I-8 J0 F1200"
        yield "G1 X73 F1200"
        yield "G1 X47"
        for half_y in (4.5, 9.0, 13.0):
            half_x = half_y + 12.0
            yield f"G1 {at(x=60 - half_x, y=40 - half_y)}"
            yield f"G1 {at(x=60 + half_x)}"
            yield f"G1 {at(y=40 + half_y)}"
            yield f"G1 {at(x=60 - half_x)}"
            yield f"G1 {at(y=40 - half_y)}"
        yield "G1 X60 Y40"
    yield "G0 Z50"
    yield from _tool(4, "bores 16, through", 9500)
    for x in (16.0, 104.0):
        yield f"G0 {at(x=x + 4.0, y=40.0)}"
        yield "G0 Z1"
        yield "G1 Z-1 F500"
        yield f"G3 {at(x=x + 4.0)} Y40 Z-26 I-4 J0 P10 F700"
        yield f"G3 {at(x=x + 4.0)} Y40 I-4 J0 F900"
        yield f"G1 {at(x=x)}"
        yield "G0 Z20"
    yield "G0 Z50"
    yield from _tool(3, "holes 6, through, pecking", 4200)
    yield "G98 G83 X10 Y10 Z-28 R1 Q5 F420"
    yield "X110"
    yield "Y70"
    yield "X10"
    yield "G80"
    yield "G0 Z50"
    yield "M9"
    yield "M5"
    yield "G49"
    yield "M30"
    yield "%"


def _tool(number: int, what: str, speed: int) -> Lines:
    yield f"({what})"
    yield f"T{number} M6"
    yield f"S{speed} M3"
    yield f"G0 G43 H{number} Z50"
    yield "M8"


# --- engraving: a single-line font --------------------------------------------

# strokes on a 4 x 6 grid, by us
_GLYPHS: dict[str, list[list[tuple[float, float]]]] = {
    "G": [[(4, 5), (3, 6), (1, 6), (0, 5), (0, 1), (1, 0), (3, 0), (4, 1), (4, 3), (2.5, 3)]],
    "C": [[(4, 5), (3, 6), (1, 6), (0, 5), (0, 1), (1, 0), (3, 0), (4, 1)]],
    "O": [[(1, 0), (0, 1), (0, 5), (1, 6), (3, 6), (4, 5), (4, 1), (3, 0), (1, 0)]],
    "D": [[(0, 0), (0, 6), (2.5, 6), (4, 4.5), (4, 1.5), (2.5, 0), (0, 0)]],
    "E": [[(4, 6), (0, 6), (0, 0), (4, 0)], [(0, 3), (3, 3)]],
    "S": [[(4, 5), (3, 6), (1, 6), (0, 5), (0, 4), (1, 3), (3, 3), (4, 2), (4, 1), (3, 0), (1, 0), (0, 1)]],
    "I": [[(2, 0), (2, 6)], [(1, 0), (3, 0)], [(1, 6), (3, 6)]],
    "M": [[(0, 0), (0, 6), (2, 3), (4, 6), (4, 0)]],
    "2": [[(0, 5), (1, 6), (3, 6), (4, 5), (4, 4), (0, 0), (4, 0)]],
    "7": [[(0, 6), (4, 6), (1.5, 0)]],
    "4": [[(3, 0), (3, 6), (0, 2), (4, 2)]],
    "-": [[(1, 3), (3, 3)]],
}


def engraving() -> Lines:
    """Two lines of text in a name plate 120 x 50 x 8 mm, inside a frame with round corners."""
    yield "(engraving: name plate, ball end mill 2 mm)"
    yield "G21 G90 G17 G94 G64 P0.01"
    yield "T1 M6"
    yield "G43 H1"
    yield "S18000 M3"
    yield "G0 Z5"
    for text, x0, y0, scale in (("GCODESIM", 10.0, 26.0, 2.4), ("42-7", 40.0, 10.0, 1.8)):
        yield f"({text})"
        for index, letter in enumerate(text):
            left = x0 + index * 5.2 * scale
            for stroke in _GLYPHS[letter]:
                points = [(left + scale * u, y0 + scale * v) for u, v in stroke]
                yield f"G0 {at(x=points[0][0], y=points[0][1])}"
                yield "G0 Z1"
                yield "G1 Z-0.3 F200"
                yield f"G1 {at(x=points[1][0], y=points[1][1])} F900"
                for x, y in points[2:]:
                    yield f"G1 {at(x=x, y=y)}"
                yield "G0 Z2"
    yield "(frame)"
    yield "G0 X9 Y4"
    yield "G0 Z1"
    yield "G1 Z-0.5 F200"
    yield "G1 X111 F1200"
    yield "G3 X116 Y9 I0 J5"
    yield "G1 Y41"
    yield "G3 X111 Y46 I-5 J0"
    yield "G1 X9"
    yield "G3 X4 Y41 I0 J-5"
    yield "G1 Y9"
    yield "G3 X9 Y4 I5 J0"
    yield "G0 Z50"
    yield "M5"
    yield "M2"


# --- finishing: a raster over a curved surface --------------------------------


def _dune(x: float, y: float) -> float:
    """Height of the finished surface [mm] at x, y [mm]."""
    ripple = 0.8 * math.sin(0.11 * x + 0.03 * y) * math.cos(0.07 * y)
    hill = 3.0 * math.exp(-((x - 55.0) ** 2 + (y - 35.0) ** 2) / 700.0)
    return -5.5 + ripple + hill


def finishing() -> Lines:
    """Rows of 110 mm in 0.7 mm chords, 0.5 mm apart, ball end mill 8 mm; 22,000 blocks."""
    radius = 4.0
    yield "%"
    yield "(finishing: raster over a curved surface, ball end mill 8 mm)"
    yield "G21 G90 G17 G40 G94"
    yield "G64 P0.005"
    yield "T1 M6"
    yield "G43 H1"
    yield "S16000 M3"
    yield "G0 Z10"
    number = 0
    for row in range(139):
        y = 0.5 + 0.5 * row
        steps = [0.7 * i for i in range(158)]
        for i, x in enumerate(steps if row % 2 == 0 else reversed(steps)):
            # tip of a ball that touches the surface: the centre lies one radius along the normal
            slope_x = (_dune(x + 1e-3, y) - _dune(x - 1e-3, y)) / 2e-3
            slope_y = (_dune(x, y + 1e-3) - _dune(x, y - 1e-3)) / 2e-3
            length = math.sqrt(1.0 + slope_x**2 + slope_y**2)
            tip_x, tip_y = x - radius * slope_x / length, y - radius * slope_y / length
            tip_z = _dune(x, y) + radius / length - radius
            number += 10
            if row == 0 and i == 0:
                yield f"N{number} G0 {at(x=tip_x, y=tip_y)}"
                yield "G0 Z1"
                yield f"G1 {at(z=tip_z)} F500"
                yield "F2400"
            else:
                yield f"N{number} G1 {at(x=tip_x, y=tip_y, z=tip_z)}"
    yield "G0 Z20"
    yield "M5"
    yield "M30"
    yield "%"


# --- wall: a printed rectangle with round corners -----------------------------


def wall() -> Lines:
    """Eight layers, 3 mm each; M10 and M11 switch the extruder (see the cell's m_codes)."""
    yield "(wall: closed loop 160 x 90 mm with corners of 20 mm radius, bead 6 x 3 mm)"
    yield "G21 G90 G17 G94 G64 P0.2"
    yield "T1 M6"
    yield "G43 H1"
    yield "G0 Z40"
    for layer in range(1, 9):
        z = 3.0 * layer
        yield f"(layer {layer})"
        yield "G0 X20 Y0"
        yield f"G0 {at(z=z)}"
        yield "M10"
        yield "G1 X140 F3000"
        yield "G3 X160 Y20 I0 J20"
        yield "G1 Y70"
        yield "G3 X140 Y90 I-20 J0"
        yield "G1 X20"
        yield "G3 X0 Y70 I0 J-20"
        yield "G1 Y20"
        yield "G3 X20 Y0 I20 J0"
        yield "M11"
    yield "G0 Z60"
    yield "M2"


# --- flange: printed by a pump, then milled -------------------------------------


def flange() -> Lines:
    """A block 58 x 44 x 15 mm of five layers, each a zigzag across the one before; then faced, cut round and bored."""
    bead, height, size = 5.357, 3.0, (58.0, 44.0)  # 5.357: section of a bead of 6 x 3 mm over its height
    yield "(flange: printed in five layers of 3 mm, then milled to 50 x 36 x 13 mm with a bore of 20 mm)"
    yield "(T1 extruder, bead 6 x 3 mm, M10 and M11 switch its pump; T2 end mill 10)"
    yield "G21 G90 G17 G94 G64 P0.3"
    yield "T1 M6"
    yield "G43 H1"
    yield "G0 Z40"
    for layer in range(1, 6):
        along = layer % 2  # 1: beads along X
        length, across = (size[0], size[1]) if along else (size[1], size[0])
        beads = math.floor((across - bead) / bead) + 1
        first = -0.5 * bead * (beads - 1)
        end = 0.5 * (length - bead)
        yield f"(layer {layer})"
        for k in range(beads):
            side, start = first + bead * k, -end if k % 2 == 0 else end
            ends = ({"x": start, "y": side}, {"x": -start, "y": side})
            if not along:
                ends = ({"x": side, "y": start}, {"x": side, "y": -start})
            if k == 0:
                yield f"G0 {at(**ends[0])}"
                yield f"G0 {at(z=height * layer)}"
                yield "M10"
                yield "F3000"
            else:
                yield f"G1 {at(**ends[0])}"
            yield f"G1 {at(**ends[1])}"
        yield "M11"
    yield "G0 Z40"
    yield "T2 M6"
    yield "G43 H2"
    yield "S12000 M3"
    yield "(top)"
    yield "G0 X-40 Y-20"
    yield "G0 Z13"
    yield "F1800"
    for row in range(6):
        yield f"G1 {at(y=-20.0 + 8.0 * row)}"
        yield f"G1 X{40 if row % 2 == 0 else -40}"
    yield "G0 Z30"
    yield "(outside)"
    for z in (9.0, 5.0, 1.0):
        yield "G0 X-40 Y-23"
        yield f"G0 {at(z=z)}"
        yield "G1 X30"
        yield "G1 Y23"
        yield "G1 X-30"
        yield "G1 Y-40"
        yield "G0 Z30"
    yield "(bore)"
    yield "G0 X0 Y0"
    yield "G0 Z16"
    yield "G1 Z13 F600"
    yield "G1 X5"
    yield "G3 X5 Y0 Z1 I-5 J0 P6"
    yield "G3 X5 Y0 I-5 J0"
    yield "G1 X0"
    yield "G0 Z40"
    yield "M5"
    yield "M2"


# --- clip: a print as a slicer writes it -----------------------------------------

_SECTION, _FILAMENT = (0.45 - 0.2) * 0.2 + 0.25 * math.pi * 0.2 * 0.2, 0.25 * math.pi * 1.75 * 1.75  # mm²


def clip() -> Lines:
    """A frame 30 x 20 mm, 2 mm high: ten layers of two walls and one of infill between them; lines 0.45 x 0.2 mm."""
    yield "; clip: frame 30 x 20 x 2 mm, layers of 0.2 mm, lines of 0.45 mm"
    yield "M201 X1000 Y1000 Z200 E5000"
    yield "M203 X200 Y200 Z12 E120"
    yield "M204 P1000 R1000 T1000"
    yield "M205 X8 Y8 Z0.4 E1.5"
    yield "M140 S60"
    yield "M104 S210"
    yield "G28 ; home all axes"
    yield "M190 S60"
    yield "M109 S210"
    yield "G21"
    yield "G90"
    yield "M83"
    yield "M107"
    for layer in range(1, 11):
        z = 0.2 * layer
        yield ";LAYER_CHANGE"
        yield f";Z:{z:g}"
        yield ";HEIGHT:0.2"
        yield f"G1 {at(z=z)} F720"
        if layer == 2:
            yield "M106 S255"
        for what, feed, inset in (
            ("Perimeter", 2400, 0.675),
            ("External perimeter", 1500, 0.225),
            ("Perimeter", 2400, 3.325),
            ("External perimeter", 1500, 3.775),
        ):
            yield f";TYPE:{what}"
            yield ";WIDTH:0.45"
            yield from _loop(inset, feed if layer > 1 else 1200)
        yield ";TYPE:Internal infill"
        for k in range(5):
            yield from _loop(1.125 + 0.4375 * k, 3000 if layer > 1 else 1200)
    yield "M107"
    yield "G1 Z20 F720"
    yield "M104 S0"
    yield "M140 S0"
    yield "M84"


def _loop(inset: float, feed: float) -> Lines:
    """A closed rectangle `inset` from the outside; it begins with a retraction and a way to its corner."""
    left, right, front, back = inset, 30.0 - inset, inset, 20.0 - inset
    yield "G1 E-0.8 F2100"
    yield f"G1 {at(x=left, y=front)} F9000"
    yield "G1 E0.8 F2100"
    yield f"G1 F{feed:g}"
    for x, y, way in (
        (right, front, right - left),
        (right, back, back - front),
        (left, back, right - left),
        (left, front, back - front),
    ):
        yield f"G1 {at(x=x, y=y)} {word('E', way * _SECTION / _FILAMENT, 5)}"


# --- dome: a ball mill that leans, by tool centre point control -----------------


def dome() -> Lines:
    """A dome of radius 20 mm, zero in its centre, on a trunnion A C: a spiral down from near the top."""
    radius, ball, turns, steps = 20.0, 3.0, 4, 24
    yield "%"
    yield "O4340 (dome: ball end mill of 6 mm leaning outwards, the tip is programmed)"
    yield "G21 G17 G90 G40 G49 G80 G94"
    yield "G54"
    yield "T1 M6"
    yield "S12000 M3"
    yield "G0 Z100."
    yield "G0 X0. Y0. A0. C90."
    yield "G43.4 H1"
    yield "G0 Z40."
    for k in range(turns * steps + 1):
        polar, azimuth = math.radians(10.0 + 50.0 * k / (turns * steps)), math.radians(360.0 / steps * k)
        lean = 0.6 * polar
        normal = _direction(polar, azimuth)
        axis = _direction(lean, azimuth)
        x, y, z = ((radius + ball) * n - ball * a for n, a in zip(normal, axis, strict=True))
        place = at(4, x=x, y=y, z=z, a=math.degrees(lean), c=90.0 - math.degrees(azimuth))
        yield f"{'G0' if k == 0 else 'G1'} {_pointed(place)}" + (" F600." if k == 1 else "")
    yield "G0 Z60."
    yield "G49"
    yield "G91 G28 Z0."
    yield "G90 G0 A0. C0."
    yield "M5"
    yield "M30"
    yield "%"


def _direction(polar: float, azimuth: float) -> tuple[float, float, float]:
    """The unit vector at these angles [rad] from Z and from X."""
    return math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth), math.cos(polar)


def _pointed(words: str) -> str:
    """Words for a control that reads whole numbers as increments: each with a point."""
    return " ".join(word if "." in word else f"{word}." for word in words.split())


PROGRAMS: dict[str, Callable[[], Lines]] = {
    "bracket.nc": bracket,
    "dome.nc": dome,
    "engraving.ngc": engraving,
    "finishing.nc": finishing,
    "wall.nc": wall,
    "flange.nc": flange,
    "clip.gcode": clip,
}


# --- targets: the parts that programs written by hand are to become ------------

Ring = list[tuple[float, float]]


def pocket_target() -> Lines:
    """A block 40 x 30 x 10 mm with a pocket 24 x 14 x 4 mm, its corners round by 3 mm, as an STL file."""
    size, bottom = (40.0, 30.0), -10.0
    yield "solid pocket"
    inner, corner_of = _rounded((8.0, 8.0), (32.0, 22.0), 3.0)
    yield from _plate_with_pocket(size, inner, corner_of, 0.0, -4.0, bottom, (20.0, 15.0))
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = _corners(size)
    yield from _facet((ax, ay, bottom), (cx, cy, bottom), (bx, by, bottom))
    yield from _facet((ax, ay, bottom), (dx, dy, bottom), (cx, cy, bottom))
    yield "endsolid pocket"


def flip_target() -> Lines:
    """A block 60 x 40 x 20 mm with a pocket from each side and a hole of 6 mm from floor to floor, as an STL file."""
    size, middle, floors = (60.0, 40.0), (24.0, 18.0), (-5.0, -14.0)
    circle = [
        (middle[0] + 3.0 * math.cos(math.radians(3.6 * k)), middle[1] + 3.0 * math.sin(math.radians(3.6 * k)))
        for k in range(100)
    ]
    yield "solid flip"
    top, of_top = _rounded((12.0, 8.0), (44.0, 28.0), 3.0)
    yield from _plate_with_pocket(size, top, of_top, 0.0, floors[0], -20.0, circle)
    low, of_low = _rounded((16.0, 10.0), (36.0, 32.0), 3.0)
    yield from _turned_over(_plate_with_pocket(size, low, of_low, -20.0, floors[1], None, circle))
    for (ax, ay), (bx, by) in zip(circle, circle[1:] + circle[:1], strict=True):
        yield from _facet((ax, ay, floors[0]), (bx, by, floors[0]), (bx, by, floors[1]))
        yield from _facet((ax, ay, floors[0]), (bx, by, floors[1]), (ax, ay, floors[1]))
    yield "endsolid flip"


def _corners(size: tuple[float, float]) -> Ring:
    return [(size[0], size[1]), (0.0, size[1]), (0.0, 0.0), (size[0], 0.0)]


def _rounded(low: tuple[float, float], high: tuple[float, float], radius: float) -> tuple[Ring, list[int]]:
    """A rectangle with round corners, 25 points each, and of which corner each point is."""
    ring: Ring = []
    corner_of: list[int] = []
    for corner, (x, y) in enumerate([(high[0], high[1]), (low[0], high[1]), (low[0], low[1]), (high[0], low[1])]):
        x, y = (value + (radius if value == least else -radius) for value, least in ((x, low[0]), (y, low[1])))
        for k in range(25):
            angle = math.radians(90.0 * corner + 3.75 * k)
            ring.append((x + radius * math.cos(angle), y + radius * math.sin(angle)))
            corner_of.append(corner)
    return ring, corner_of


def _plate_with_pocket(
    size: tuple[float, float],
    inner: Ring,
    corner_of: list[int],
    top: float,
    floor: float,
    bottom: float | None,
    middle: tuple[float, float] | Ring,
) -> Lines:
    """Face, walls and floor of a pocket in a plate, and its sides down to `bottom` unless that is None.

    `middle` is a point of the floor, or the rim of a hole in it with as many points as `inner`.
    """
    outer = _corners(size)
    rim = middle if isinstance(middle, list) else [middle] * len(inner)
    for k, ((ax, ay), (bx, by)) in enumerate(zip(inner, inner[1:] + inner[:1], strict=True)):
        (cx, cy), (dx, dy) = outer[corner_of[k]], outer[corner_of[(k + 1) % len(inner)]]
        yield from _facet((ax, ay, top), (cx, cy, top), (bx, by, top))
        if (cx, cy) != (dx, dy):
            yield from _facet((cx, cy, top), (dx, dy, top), (bx, by, top))
            if bottom is not None:
                yield from _facet((dx, dy, top), (cx, cy, top), (cx, cy, bottom))
                yield from _facet((dx, dy, top), (cx, cy, bottom), (dx, dy, bottom))
        yield from _facet((ax, ay, top), (bx, by, top), (bx, by, floor))
        yield from _facet((ax, ay, top), (bx, by, floor), (ax, ay, floor))
        (ex, ey), (fx, fy) = rim[k], rim[(k + 1) % len(rim)]
        yield from _facet((ex, ey, floor), (ax, ay, floor), (bx, by, floor))
        if (ex, ey) != (fx, fy):
            yield from _facet((ex, ey, floor), (bx, by, floor), (fx, fy, floor))


def _turned_over(facets: Lines) -> Lines:
    """The same triangles with their outsides inside."""
    vertices: list[str] = []
    for line in facets:
        if line.startswith("vertex"):
            vertices.append(line)
            continue
        if line == "endloop":
            yield from reversed(vertices)
            vertices.clear()
        yield line


def _facet(*corners: tuple[float, float, float]) -> Lines:
    """A triangle of an STL file; readers find its normal themselves."""
    yield "facet normal 0 0 0"
    yield "outer loop"
    for x, y, z in corners:
        yield f"vertex {x:.4f} {y:.4f} {z:.4f}"
    yield "endloop"
    yield "endfacet"


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    for name, lines in PROGRAMS.items():
        (folder / name).write_text("\n".join(lines()) + "\n", encoding="ascii")
    if len(sys.argv) == 1:
        cells = Path(__file__).parent.parent / "cells"
        for name, lines in (("pocket_target.stl", pocket_target), ("flip_target.stl", flip_target)):
            (cells / name).write_text("\n".join(lines()) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()

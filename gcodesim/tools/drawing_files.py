"""Lines and arcs of DXF and SVG files as strokes, in metres with y upwards."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from math import dist, sqrt
from typing import Final

from gcodesim.kinematics.xml_lines import LinedElement, XmlError, parse_xml
from gcodesim.solids.turned import Point
from gcodesim.tools.outline_file import DrawingError, Stroke, StrokeArc, bulged, turned_about
from gcodesim.units import DEG, INCH, MM

_DXF_UNITS: Final = {0: MM, 1: INCH, 4: MM, 5: 10.0 * MM, 6: 1.0, 13: 1e-6}  # $INSUNITS of DXF
_SVG_UNITS: Final = {"mm": MM, "cm": 10.0 * MM, "in": INCH, "px": INCH / 96.0, "": INCH / 96.0, "pt": INCH / 72.0}
_CHORDS: Final = 32  # of a Bézier curve
_NUMBER: Final = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_WORD: Final = re.compile(rf"[A-Za-z]|{_NUMBER.pattern}")
_QUIET: Final = frozenset(("POINT", "TEXT", "MTEXT", "DIMENSION", "SEQEND", "VERTEX", "VIEWPORT", "HATCH"))

Group = tuple[int, str]


def strokes_of(name: str, raw: bytes) -> list[Stroke]:
    """The strokes of a drawing by the suffix of its name; DrawingError if it cannot be read or shows something else."""
    if name.lower().endswith(".svg"):
        return _svg(raw)
    if name.lower().endswith(".dxf"):
        return _dxf(raw)
    raise DrawingError("a drawing is a .dxf or .svg file")


# ---- DXF (Autodesk, DXF reference: groups of a code and a value, each on a line of its own)


def _dxf(raw: bytes) -> list[Stroke]:
    if raw.startswith(b"AutoCAD Binary DXF"):
        raise DrawingError("it is a binary DXF; save it as ASCII DXF")
    lines = raw.decode("utf-8", "replace").splitlines()
    try:
        groups = [(int(code), value.strip()) for code, value in zip(lines[::2], lines[1::2], strict=False)]
    except ValueError:
        raise DrawingError("it is no DXF: codes and values come by turns, a line each") from None
    scale = _dxf_scale(groups)
    strokes: list[Stroke] = []
    try:
        for kind, body in _entities(groups):
            strokes += _entity(kind, body, scale)
    except (KeyError, ValueError):
        raise DrawingError("an entity lacks a coordinate") from None
    return strokes


def _dxf_scale(groups: Sequence[Group]) -> float:
    for (code, value), (_, unit) in itertools.pairwise(groups):
        if code == 9 and value == "$INSUNITS":
            number = int(float(unit))
            if number not in _DXF_UNITS:
                raise DrawingError(f"its unit ($INSUNITS {number}) is not known; save it in mm or inches")
            return _DXF_UNITS[number]
    return MM


def _entities(groups: Sequence[Group]) -> Iterator[tuple[str, list[Group]]]:
    """Kind and groups of the entities of the section ENTITIES; vertices of a POLYLINE come with it."""
    inside, section, kind, body = False, False, "", list[Group]()
    for code, value in groups:
        if code == 0:
            if kind == "POLYLINE" and value == "VERTEX":
                body.append((code, value))
                continue
            if inside and kind:
                yield kind, body
            section, kind, body = value == "SECTION", value if inside else "", []
            inside = inside and value != "ENDSEC"
            kind = kind if inside else ""
        elif code == 2 and section:
            inside, section = value == "ENTITIES", False
        elif kind:
            body.append((code, value))


def _entity(kind: str, body: Sequence[Group], scale: float) -> list[Stroke]:
    own = dict(body[::-1])  # of a repeated code the first counts
    if own.get(67) == "1" or own.get(8, "").lower() == "defpoints":
        return []

    def at(x: int) -> Point:
        return float(own[x]) * scale, float(own[x + 10]) * scale

    if kind == "LINE":
        return [Stroke(at(10), at(11))]
    if kind == "ARC":
        return turned_about(at(10), float(own[40]) * scale, float(own[50]) * DEG, float(own[51]) * DEG)
    if kind == "CIRCLE":
        return turned_about(at(10), float(own[40]) * scale, 0.0, 0.0)
    if kind in ("LWPOLYLINE", "POLYLINE"):
        return _polyline(kind, body, scale)
    if kind in _QUIET:
        return []
    raise DrawingError(f"it has {kind}; lines, arcs and polylines are read: explode or convert it")


def _polyline(kind: str, body: Sequence[Group], scale: float) -> list[Stroke]:
    points: list[list[float]] = []
    begun = kind == "LWPOLYLINE"
    closed = False
    for code, value in body:
        if code == 0:
            begun = True
        elif code == 70 and not points:
            closed = bool(int(value) & 1)
        elif begun and code == 10:
            points.append([float(value) * scale, 0.0, 0.0])
        elif begun and code == 20 and points:
            points[-1][1] = float(value) * scale
        elif begun and code == 42 and points:
            points[-1][2] = float(value)
    ends = [*points[1:], *(points[:1] if closed else [])]
    return [bulged((a[0], a[1]), (b[0], b[1]), a[2]) for a, b in zip(points, ends, strict=False)]


# ---- SVG (W3C, SVG 1.1; y points down there)


def _svg(raw: bytes) -> list[Stroke]:
    try:
        root = parse_xml(raw)
    except XmlError as error:
        raise DrawingError(f"line {error.line}: {error}") from None
    scale = _svg_scale(root)
    strokes: list[Stroke] = []
    for element in root.iter():
        tag = str(element.tag).rpartition("}")[2].rpartition(":")[2]
        if tag in ("path", "line", "polyline", "polygon", "g", "svg") and element.get("transform"):
            raise DrawingError(f"<{tag}> has a transform; apply it before the file is saved")
        if tag == "path":
            strokes += _Pen(scale).draw(element.get("d", ""))
        elif tag in ("polyline", "polygon"):
            points = "M" + element.get("points", "") + ("Z" if tag == "polygon" else "")
            strokes += _Pen(scale).draw(points)
        elif tag == "line":
            x1, y1, x2, y2 = (_length(element.get(key, "0")) for key in ("x1", "y1", "x2", "y2"))
            strokes += _Pen(scale).draw(f"M{x1},{y1}L{x2},{y2}")
        elif tag in ("circle", "ellipse", "rect", "use", "image"):
            raise DrawingError(f"it has <{tag}>; lines and paths are read: convert it to a path")
    return strokes


def _length(text: str) -> float:
    found = _NUMBER.match(text.strip())
    if found is None:
        raise DrawingError(f"`{text[:20]}` is no number")
    return float(found[0])


def _svg_scale(root: LinedElement) -> float:
    """Metres of a user unit: by width and viewBox, else a 96th of an inch."""
    width, box = root.get("width", ""), (root.get("viewBox") or "").replace(",", " ").split()
    if len(box) != 4 or not width or width.strip().endswith("%"):
        return _SVG_UNITS[""]
    unit = width.strip().lstrip("+-.0123456789eE")
    if unit not in _SVG_UNITS or not float(box[2]) > 0.0:
        raise DrawingError(f"its width `{width[:20]}` has no unit that is known")
    return _length(width) * _SVG_UNITS[unit] / float(box[2])


class _Pen:
    """Draws the data of a path."""

    def __init__(self, scale: float) -> None:
        self._scale = scale
        self._at = self._begin = (0.0, 0.0)
        self._strokes: list[Stroke] = []

    def draw(self, data: str) -> list[Stroke]:
        words = _WORD.findall(data)
        letter, k = "", 0
        counts = {"M": 2, "L": 2, "H": 1, "V": 1, "A": 7, "Z": 0, "C": 6, "Q": 4}
        while k < len(words):
            if words[k].isalpha():
                letter, k = words[k], k + 1
            elif letter in ("z", "Z", ""):
                raise DrawingError("the data of a path begin with a number")
            count = counts.get(letter.upper())
            if count is None:
                raise DrawingError(f"a path has `{letter}`; M, L, H, V, A, C, Q and Z are read")
            numbers = words[k : k + count]
            if len(numbers) < count or any(word.isalpha() for word in numbers):
                raise DrawingError(f"the data of a path lack numbers behind `{letter}`")
            k += count
            self._go(letter, [float(number) for number in numbers])
            letter = {"M": "L", "m": "l"}.get(letter, letter)
        return self._strokes

    def _go(self, letter: str, numbers: list[float]) -> None:
        upper, (x0, y0) = letter.upper(), self._at
        dx, dy = (0.0, 0.0) if letter == upper else (x0, y0)
        if upper == "Z":
            self._line(self._begin)
        elif upper == "M":
            self._at = self._begin = (numbers[0] + dx, numbers[1] + dy)
        elif upper == "H":
            self._line((numbers[0] + dx, y0))
        elif upper == "V":
            self._line((x0, numbers[0] + dy))
        elif upper == "L":
            self._line((numbers[0] + dx, numbers[1] + dy))
        elif upper == "A":
            self._arc(numbers[:5], (numbers[5] + dx, numbers[6] + dy))
        else:
            knots = [self._at, *((x + dx, y + dy) for x, y in zip(numbers[::2], numbers[1::2], strict=True))]
            for step in range(1, _CHORDS + 1):
                self._line(_bezier(knots, step / _CHORDS))

    def _line(self, end: Point) -> None:
        if end != self._at:
            self._strokes.append(Stroke(self._up(self._at), self._up(end)))
        self._at = end

    def _arc(self, form: Sequence[float], end: Point) -> None:
        """SVG 1.1, appendix F.6: centre from the ends, for a circle."""
        rx, ry, _, large, sweep = form
        if abs(rx - ry) > 1e-6 * max(abs(rx), abs(ry)):
            raise DrawingError("a path has an elliptical arc; circular ones are read")
        (ax, ay), (bx, by) = self._up(self._at), self._up(end)
        chord = dist((ax, ay), (bx, by))
        radius = max(abs(rx) * self._scale, 0.5 * chord)
        if chord > 0.0:
            aside = sqrt(max(radius * radius - 0.25 * chord * chord, 0.0)) / chord
            ccw = sweep == 0.0  # y points down
            side = aside if (large == 0.0) == ccw else -aside
            centre = (0.5 * (ax + bx) - side * (by - ay), 0.5 * (ay + by) + side * (bx - ax))
            self._strokes.append(Stroke((ax, ay), (bx, by), StrokeArc(centre, ccw)))
        self._at = end

    def _up(self, point: Point) -> Point:
        return point[0] * self._scale, -point[1] * self._scale


def _bezier(knots: Sequence[Point], t: float) -> Point:
    """De Casteljau."""
    while len(knots) > 1:
        knots = [(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])) for a, b in itertools.pairwise(knots)]
    return knots[0]

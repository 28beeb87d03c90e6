"""Tools and stock out of a program's words and comments, as CAM systems write them; a guess, never a reading.

Known forms: `(T1 D=6. CR=0. - ZMIN=-2. - flat end mill)` of Fusion posts,
`(T1 | 6mm end mill | D6)` and alike, `(STOCK 100 x 60 x 20)`,
`(X= 100.000, Y= 60.000, Z= 20.000)` of VCarve.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from gcodesim.diagnostics import SourceText

Triple = tuple[float, float, float]

_COMMENT = re.compile(r"\(([^)]*)\)|;(.*)$")
_NUMBER = r"([0-9]+\.?[0-9]*|\.[0-9]+)"
_TOOL_WORD = re.compile(r"(?<![A-Za-z0-9#<])[Tt]\s*([0-9]{1,5})(?![0-9.])")
_TOOL_COMMENT = re.compile(r"\b(?:T|TOOL\s*#?)\s*([0-9]{1,5})\b", re.IGNORECASE)
_DIAMETERS: Final = (
    re.compile(rf"(?:\bD(?:IA(?:METER)?)?\.?\s*[=:]?\s*|[ØøΦ]\s*){_NUMBER}", re.IGNORECASE),
    re.compile(rf"{_NUMBER}\s*(?:mm|in|\")", re.IGNORECASE),
    re.compile(rf"(?:mill|drill)\s+{_NUMBER}", re.IGNORECASE),
)
_CORNER = re.compile(rf"\bCR\s*[=:]\s*{_NUMBER}", re.IGNORECASE)
_POINT = re.compile(rf"\b(?:TAPER|ANGLE|POINT)\s*[=:]\s*{_NUMBER}", re.IGNORECASE)
_BY = r"\s*(?:mm|in)?\s*[x×*,]\s*"
_STOCK_SIZE = re.compile(rf"{_NUMBER}{_BY}{_NUMBER}{_BY}{_NUMBER}", re.IGNORECASE)
_SIDES = re.compile(rf"X\s*=\s*{_NUMBER}\s*,?\s*Y\s*=\s*{_NUMBER}\s*,?\s*Z\s*=\s*{_NUMBER}", re.IGNORECASE)
_COORDINATE = re.compile(r"(?<![A-Za-z#<])([XYZxyz])\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))")
_INCH = re.compile(r"[Gg]0*20(?![0-9.])")
_SKIPPED = re.compile(r"[Gg]0*(?:28|30|53|92|10)(?![0-9])")  # their numbers are no points of the part
_KINDS: Final = (
    ("ball", "ball_end_mill"),
    ("bull", "bull_nose_end_mill"),
    ("drill", "drill"),
    ("bore", "drill"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ScannedTool:
    """A tool that the program names; lengths in the program's unit, angle in degrees."""

    number: int
    line: int
    type: str = "flat_end_mill"
    diameter: float | None = None
    corner_radius: float | None = None
    point_angle: float | None = None
    comment: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scan:
    """What was found; lengths in the program's unit. `lower` and `upper` are the least and greatest X, Y, Z words."""

    inch: bool
    tools: tuple[ScannedTool, ...]
    stock: Triple | None
    stock_line: int
    lower: Triple | None
    upper: Triple | None


def scan(program: SourceText) -> Scan:
    """Tools in the order of their numbers, stock size and extent."""
    called: dict[int, ScannedTool] = {}
    told: dict[int, ScannedTool] = {}
    stock, stock_line, inch = None, 0, False
    extent: dict[str, list[float]] = {"X": [], "Y": [], "Z": []}
    for number, text in enumerate(program.lines, start=1):
        comments = " ".join(a or b for a, b in _COMMENT.findall(text)).strip()
        comments = "".join(c if c.isprintable() else " " for c in comments)
        words = _COMMENT.sub(" ", text)
        inch = inch or _INCH.search(words) is not None
        for match in _TOOL_WORD.finditer(words):
            tool = int(match[1])
            if tool:
                called.setdefault(tool, ScannedTool(number=tool, line=number))
        if comments:
            for tool_told in _tools_of(comments, number):
                told.setdefault(tool_told.number, tool_told)
            if stock is None and (size := _stock_of(comments)) is not None:
                stock, stock_line = size, number
        if not _SKIPPED.search(words):
            for letter, value in _COORDINATE.findall(words):
                extent[letter.upper()].append(float(value))
    numbers = sorted(called) or sorted(told)
    lower, upper = _box(extent)
    return Scan(
        inch=inch,
        tools=tuple(told[n] if n in told else called[n] for n in numbers),
        stock=stock,
        stock_line=stock_line,
        lower=lower,
        upper=upper,
    )


def _tools_of(comment: str, line: int) -> list[ScannedTool]:
    """What a comment says about each `T` in it, up to the next one."""
    found = [match for match in _TOOL_COMMENT.finditer(comment) if int(match[1])]
    ends = [match.start() for match in found[1:]] + [len(comment)]
    return [
        _tool_of(int(match[1]), comment[match.end() : end], comment[match.start() : end].strip(" ,;"), line)
        for match, end in zip(found, ends, strict=False)
    ]


def _tool_of(number: int, text: str, comment: str, line: int) -> ScannedTool:
    kind = next((name for word, name in _KINDS if word in text.lower()), "flat_end_mill")
    diameter = next((float(match[1]) for pattern in _DIAMETERS if (match := pattern.search(text))), None)
    corner, point = _CORNER.search(text), _POINT.search(text)
    radius = None if corner is None else float(corner[1])
    if kind == "flat_end_mill" and radius and diameter:
        kind = "ball_end_mill" if radius >= 0.5 * diameter else "bull_nose_end_mill"
    return ScannedTool(
        number=number,
        line=line,
        type=kind,
        diameter=diameter or None,
        corner_radius=radius if kind == "bull_nose_end_mill" else None,
        point_angle=float(point[1]) if point is not None and kind == "drill" else None,
        comment=comment,
    )


def _stock_of(comment: str) -> Triple | None:
    words = comment.lower()
    match = _SIDES.search(comment)
    if match is None and any(word in words for word in ("stock", "material", "blank", "block")):
        match = _STOCK_SIZE.search(comment)
    if match is None:
        return None
    size = float(match[1]), float(match[2]), float(match[3])
    return size if min(size) > 0.0 else None


def _box(extent: dict[str, list[float]]) -> tuple[Triple | None, Triple | None]:
    """Box around the points; its top is Z0, where most programs have it. None when it would be flat."""
    if not all(extent.values()):
        return None, None
    low = (min(extent["X"]), min(extent["Y"]), min(extent["Z"]))
    high = (max(extent["X"]), max(extent["Y"]), 0.0 if low[2] < 0.0 else max(extent["Z"]))
    if any(b - a < 1e-3 for a, b in zip(low, high, strict=True)):
        return None, None
    return low, high

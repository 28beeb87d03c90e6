"""Tools and stock from a program's words and comments, as CAM systems write them; always only a guess.

Known forms: `(T1 D=6. CR=0. - ZMIN=-2. - flat end mill)` of Fusion posts,
`(T1 | 6mm end mill | D6)`, `( T2 | 1/4 DRILL )` and alike, `(TOOL/MILL,6.35, 0.00, …)` of Carbide Create,
`(Change tool bit to drill size 0.8mm)` beside the call; `(STOCK 100 x 60 x 20)`,
`(X= 100.000, Y= 60.000, Z= 20.000)` of VCarve, `(STOCK DX=100. DY=60. DZ=20.)`, also an axis a comment,
`(STOCK/BLOCK, 100., 60., 20., 0., 0., 20.)` of Carbide Create, whose last three say where zero is in it,
`(stockMin: …)` with `(stockMax: …)`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Final

from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.starter.named_tool import NamedTool, named_tool
from gcodesim.units import INCH, MM

Triple = tuple[float, float, float]

_COMMENT = re.compile(r"\(([^)]*)\)?|;(.*)$")
_NUMBER = r"([0-9]+\.?[0-9]*|\.[0-9]+)"
_SIGNED = r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))"
_MM_COMMA = r"\s*(?:mm|in|\")?\s*,\s*"
_OFFSET_WORD = re.compile(r"(?<![A-Za-z#<])[DHdh]\s*([0-9]{1,5})(?![0-9.])")
_TOOL_WORD = re.compile(r"(?<![A-Za-z#<])[Tt]\s*([0-9]{1,5})(?![0-9.])")
_TOOL_COMMENT = re.compile(r"\b(?:T|TOOL\s*#?)\s*([0-9]{1,5})\b", re.IGNORECASE)
_UNIT = r"\s*(mm\b|in\b|inch\b|\"|'')?"
_FRACTION = re.compile(r"(?<![0-9./])([0-9]{1,2})\s*/\s*(2|4|8|16|32|64)(?![0-9.])")  # of an inch
_STYLE = (
    "(?:flat|ball|bull|nose|corner|chamfer|spot|center|centre|twist|stub|jobber|carbide|hss|rough|roughing|finish|"
    "finishing|end|face)"
)
_DIAMETERS: Final = (
    re.compile(rf"(?:(?<![A-Za-z])D(?:IA(?:METER)?)?\.?\s*[=:]?\s*|[ØøΦ]\s*){_NUMBER}{_UNIT}", re.IGNORECASE),
    re.compile(rf"TOOL/MILL\s*,\s*{_NUMBER}()", re.IGNORECASE),
    re.compile(rf"(?<![0-9.]){_NUMBER}\s*(mm|in|\")", re.IGNORECASE),
    re.compile(
        rf"(?<![A-Za-z0-9.-])([0-9]+\.[0-9]*|\.[0-9]+)()\s+(?:{_STYLE}\s+)*(?:(?:end)?mill|drill|reamer)\b",
        re.IGNORECASE,
    ),
    # `DRILL 03-0018` is its place in a shelf, `CHAMFER MILL 90 DEG` an angle
    re.compile(rf"(?:mill|drill)\s+{_NUMBER}()(?![0-9.-]|\s*-?\s*(?:deg|°))", re.IGNORECASE),
    re.compile(rf"^\s*:\s*{_NUMBER}()\s*$"),
)
_OF_A_TOOL = re.compile(r"mill|drill|bit|tool|cutter|ball|fr[aäe]s|frez|bohr|broca|foret|\bdia", re.IGNORECASE)
_NEAR: Final = (0, 1, 2, 3, 4, 5, -1, -2, -3, -4)  # lines from the call in which a comment may speak of its tool
_BEFORE_A_PLACE = re.compile(
    r"\b(?:below|above|beneath|under|over|than|to|at|by|depth|down|height|clearance|length|long|step(?:over|down)?)\b"
    r"[\s:=of-]*\Z",
    re.IGNORECASE,
)
_BEHIND_A_PLACE = re.compile(
    r"\s*(?:mm\b|in\b)?\s*(?:deep|long|high|thick|depth|below|above|step|clearance)\b", re.IGNORECASE
)
_CORNER = re.compile(rf"\bCR\s*[=:]\s*{_NUMBER}", re.IGNORECASE)
_POINT = re.compile(rf"\b(?:TAPER|ANGLE|POINT)\s*[=:]\s*{_NUMBER}", re.IGNORECASE)
_BY = r"\s*(?:mm|in)?\s*[x×*,]\s*"
_STOCK_SIZE = re.compile(rf"{_NUMBER}{_BY}{_NUMBER}{_BY}{_NUMBER}", re.IGNORECASE)
_SIDES = re.compile(rf"X\s*=\s*{_NUMBER}\s*,?\s*Y\s*=\s*{_NUMBER}\s*,?\s*Z\s*=\s*{_NUMBER}", re.IGNORECASE)
_SIDE = re.compile(rf"(?<![A-Z])D([XYZ])\s*[:=]?\s*{_NUMBER}", re.IGNORECASE)
_BLOCK = re.compile(
    rf"STOCK/BLOCK\s*,\s*{_NUMBER}{_BY}{_NUMBER}{_BY}{_NUMBER}" + rf"\s*,\s*{_SIGNED}" * 3, re.IGNORECASE
)
_CORNERS: Final = tuple(
    re.compile(rf"STOCK{word}\s*:\s*{_SIGNED}{_MM_COMMA}{_SIGNED}{_MM_COMMA}{_SIGNED}", re.IGNORECASE)
    for word in ("MIN", "MAX")
)
_INCH = re.compile(r"[Gg]0*20(?![0-9.])")
_SAYS_UNIT = re.compile(r"(?<![A-Z0-9])G0*(?:20|21|70|71)(?![0-9.])", re.IGNORECASE)
_SIZE_IN_INCHES = re.compile(
    rf"(?:(?<![0-9./])[0-9]{{1,2}}\s*/\s*(?:2|4|8|16|32|64)|{_NUMBER})\s*(?:in\b|inch\b|\")", re.IGNORECASE
)
_SIZE_IN_MM = re.compile(rf"{_NUMBER}\s*mm\b", re.IGNORECASE)
_CONES: Final = ("v_bit", "chamfer_mill", "engraver", "countersink")
_DEGREES = re.compile(rf"{_NUMBER}\s*(?:-\s*)?(?:deg\b|degrees?\b|°)", re.IGNORECASE)
_KINDS: Final = (
    *((word, "v_bit") for word in ("v bit", "v-bit", "vbit", "v-groove", "v groove", "v-carv", "v carv")),
    (r"(?:deg|°)[ -]?v\b", "v_bit"),
    *((word, "chamfer_mill") for word in ("chamfer", "fasen")),
    *((word, "countersink") for word in ("countersink", "counter sink")),
    ("engrav", "engraver"),
    ("spot", "spot_drill"),
    ("ball", "ball_end_mill"),
    ("bull", "bull_nose_end_mill"),
    *((word, "face_mill") for word in ("face mill", "facemill", "shell mill")),
    *(
        (word, "drill")
        for word in ("drill", "jobber", "bore", "bohr", "broca", "foret", "taladr", "tap(?!er)", "reamer")
    ),
)


@frozen
class ScannedTool:
    """A tool that the program names; lengths in the program's unit, angle in degrees. `other`: it is no cutter."""

    number: int
    line: int
    type: str = "flat_end_mill"
    diameter: float | None = None
    corner_radius: float | None = None
    point_angle: float | None = None
    angle: float | None = None
    comment: str = ""
    other: NamedTool | None = None

    @property
    def is_known(self) -> bool:
        """Whether the program says enough of it."""
        return self.diameter is not None or self.other is not None


@frozen
class Scan:
    """What was found; lengths in the program's unit. `corners` are the least and greatest corner of the stock.

    `offsets` are numbers of H and D words that belong to no tool, with the tool called before them, 0 for none.
    `unit_is_guessed`: the program says neither G20 nor G21, but sizes of its tools in inches.
    """

    inch: bool
    tools: tuple[ScannedTool, ...]
    offsets: Mapping[int, int]
    stock: Triple | None
    corners: tuple[Triple, Triple] | None
    stock_line: int
    unit_is_guessed: bool = False


def scan(program: SourceText) -> Scan:
    """Tools in the order of their numbers, called ones before those that are only mentioned; stock."""
    notes, words = _split(program)
    guessed = _speaks_of_inches(notes, words)
    inch = guessed or any(_INCH.search(text) for text in words)
    called: dict[int, ScannedTool] = {}
    offsets: dict[int, int] = {}
    last = 0
    told: dict[int, ScannedTool] = {}
    stock, stock_line = None, 0
    corners: list[Triple] = []
    sides: dict[str, float] = {}
    for number, (note, text) in enumerate(zip(notes, words, strict=True), start=1):
        for match in _TOOL_WORD.finditer(text):
            last = tool = int(match[1])
            if tool and (tool not in called or not called[tool].is_known):
                found = _near(tool, number, notes, words, inch)
                if tool not in called or found.is_known:
                    called[tool] = found  # at a later call, what stands beside that one
        for match in _OFFSET_WORD.finditer(text):
            if int(match[1]):
                offsets.setdefault(int(match[1]), last)
        if not note:
            continue
        for tool_told in _tools_of(note, number, inch):
            told.setdefault(tool_told.number, tool_told)
        if stock is None and (size := _stock_of(note, sides)) is not None:
            stock, stock_line = size, number
        if not corners and (block := _BLOCK.search(note)) is not None:
            sizes, zero = ([float(value) for value in block.groups()[part : part + 3]] for part in (0, 3))
            corners = [_triple(-z for z in zero), _triple(size - z for size, z in zip(sizes, zero, strict=True))]
            stock_line = number
        if len(corners) < len(_CORNERS) and (corner := _CORNERS[len(corners)].search(note)) is not None:
            corners.append((float(corner[1]), float(corner[2]), float(corner[3])))
            stock_line = number
    if len(called | told) < 2 and (only := _only(notes, inch)) is not None:
        number = next(iter(called | told), only.number)
        known = called.get(number) or told.get(number)
        if known is None or not known.is_known:
            told[number] = replace(only, number=number)
    numbers = sorted(called) or sorted(told)
    whole = len(corners) == 2 and all(a < b for a, b in zip(*corners, strict=True))
    return Scan(
        inch=inch,
        tools=tuple(_better(called.get(n), told.get(n)) for n in numbers),
        offsets={number: tool for number, tool in sorted(offsets.items()) if number not in numbers},
        stock=stock,
        corners=(corners[0], corners[1]) if whole else None,
        stock_line=stock_line,
        unit_is_guessed=guessed,
    )


def _triple(values: Iterable[float]) -> Triple:
    x, y, z = values
    return x, y, z


def _speaks_of_inches(notes: list[str], words: list[str]) -> bool:
    """Whether a program that leaves its unit to the machine tells sizes of tools in inches, and none in mm."""
    if any(_SAYS_UNIT.search(text) for text in words) or any(_SIZE_IN_MM.search(note) for note in notes):
        return False
    return any(_OF_A_TOOL.search(note) and _SIZE_IN_INCHES.search(note) for note in notes)


def _split(program: SourceText) -> tuple[list[str], list[str]]:
    """Comments and words of each line."""
    notes, words = [], []
    for text in program.lines:
        note = " ".join(a or b for a, b in _COMMENT.findall(text)).strip()
        notes.append("".join(c if c.isprintable() else " " for c in note))
        words.append(_COMMENT.sub(" ", text))
    return notes, words


def _better(called: ScannedTool | None, told: ScannedTool | None) -> ScannedTool:
    """A list of tools overrides comments beside the call."""
    if told is None or (called is not None and not told.is_known):
        assert called is not None
        return called
    return told


def _near(tool: int, line: int, notes: list[str], words: list[str], inch: bool) -> ScannedTool:
    """A called tool with what comments beside the call say of its size."""
    for step in _NEAR:
        at = line + step
        if not 1 <= at <= len(notes) or not notes[at - 1] or (step and _TOOL_WORD.search(words[at - 1])):
            continue
        note = notes[at - 1]
        others = {int(match[1]) for match in _TOOL_COMMENT.finditer(note)} - {tool}
        if others or (step and not _OF_A_TOOL.search(note)):
            continue
        found = _tool_of(tool, note, note.strip(" ,;"), at, inch)
        if found.is_known:
            return found
    return ScannedTool(number=tool, line=line)


def _only(notes: list[str], inch: bool) -> ScannedTool | None:
    """The tool of a program that calls none: the first comment that gives the size of one."""
    for number, note in enumerate(notes, start=1):
        if note and _OF_A_TOOL.search(note):
            found = _tool_of(1, note, note.strip(" ,;"), number, inch)
            if found.diameter is not None:
                return found
    return None


def _tools_of(comment: str, line: int, inch: bool) -> list[ScannedTool]:
    """What a comment says about each `T` in it, up to the next one."""
    found = [match for match in _TOOL_COMMENT.finditer(comment) if int(match[1])]
    ends = [match.start() for match in found[1:]] + [len(comment)]
    return [
        _tool_of(int(match[1]), comment[match.end() : end], comment[match.start() : end].strip(" ,;"), line, inch)
        for match, end in zip(found, ends, strict=False)
    ]


def _tool_of(number: int, text: str, comment: str, line: int, inch: bool) -> ScannedTool:
    kind = next((name for word, name in _KINDS if re.search(word, text.lower())), "flat_end_mill")
    if (other := named_tool(text)) is not None:
        return ScannedTool(number=number, line=line, type=other.kind, comment=comment, other=other)
    diameter = _diameter_of(text, inch)
    corner, point = _CORNER.search(text), _POINT.search(text)
    radius = None if corner is None else float(corner[1])
    if kind == "flat_end_mill" and radius and diameter:
        kind = "ball_end_mill" if radius >= 0.5 * diameter else "bull_nose_end_mill"
    if kind == "bull_nose_end_mill" and not radius:
        kind = "flat_end_mill"
    angle = _angle_of(text) if kind in _CONES else None
    if kind == "v_bit" and angle is None:
        kind = "chamfer_mill"  # whose usual angle a cell need not say
    return ScannedTool(
        number=number,
        line=line,
        type=kind,
        diameter=diameter or None,
        corner_radius=radius if kind == "bull_nose_end_mill" else None,
        point_angle=float(point[1]) if point is not None and kind in ("drill", "spot_drill") else None,
        angle=angle,
        comment=comment,
    )


def tool_in_words(number: int, text: str, inch: bool) -> ScannedTool:
    """What a description says about a tool; lengths in inches if asked, else mm."""
    return _tool_of(number, text, text.strip(), 0, inch)


def _angle_of(text: str) -> float | None:
    """The included angle of a cone [deg]; posts give half of it as its taper."""
    if taper := _POINT.search(text):
        half = float(taper[1])
        return 2.0 * half if "taper" in taper[0].lower() and half < 90.0 else half
    degrees = _DEGREES.search(text)
    angle = None if degrees is None else float(degrees[1])
    return angle if angle is not None and 1.0 <= angle < 180.0 else None


def _diameter_of(text: str, inch: bool) -> float | None:
    """A diameter in the program's unit."""
    own = INCH if inch else MM
    if fraction := _FRACTION.search(text):
        below = float(fraction[2])
        return float(fraction[1]) / below * INCH / own if below else None
    for pattern in _DIAMETERS:
        match = next((m for m in pattern.finditer(text) if not _is_of_a_place(text, m)), None)
        if match:
            unit = {"": own, "mm": MM}.get((match[2] or "").lower(), INCH)
            return float(match[1]) * unit / own if unit != own else float(match[1])
    return None


def _is_of_a_place(text: str, match: re.Match[str]) -> bool:
    """Whether a length is one of where the tool goes, not of the tool: `does not go below 12 mm`, `5 mm deep`."""
    return bool(_BEFORE_A_PLACE.search(text, 0, match.start()) or _BEHIND_A_PLACE.match(text, match.end()))


def _stock_of(comment: str, sides: dict[str, float]) -> Triple | None:
    """The sizes that a comment says, or completes: `sides` are those that comments have said singly."""
    words = comment.lower()
    if "stock" in words:
        sides.update((axis.upper(), float(value)) for axis, value in _SIDE.findall(comment))
    if len(sides) == 3 and min(sides.values()) > 0.0:
        return sides["X"], sides["Y"], sides["Z"]
    match = _SIDES.search(comment)
    if match is None and any(word in words for word in ("stock", "material", "blank", "block")):
        match = _STOCK_SIZE.search(comment)
    if match is None:
        return None
    size = float(match[1]), float(match[2]), float(match[3])
    return size if min(size) > 0.0 else None

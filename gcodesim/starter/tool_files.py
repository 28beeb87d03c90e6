"""Tools from the files of LinuxCNC, Fusion, FreeCAD and CAMotics: tool tables, libraries, tool bits, projects.

Every tool of a file is read, read with something approximated, or refused with a reason; none becomes a cylinder
in silence. What comes out are keys of a cell.
"""

from __future__ import annotations

import json
import math
import re
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path, PurePosixPath
from typing import Any, Final

from gcodesim.arithmetic.elementary import atan2
from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.rs274 import ToolTable
from gcodesim.rs274.tool_table import ToolEntry
from gcodesim.starter.fusion_turning import TURNING, turning_tool
from gcodesim.starter.scan import tool_in_words
from gcodesim.starter.tool_keys import LEFT_OUT, Json, ReadTool, ToolKeys, number_of, whole_of
from gcodesim.starter.tool_sections import fusion_holder, fusion_shank, plain_shank
from gcodesim.tools.lathe_tool import angles_of_edges
from gcodesim.tools.turning_tool import GREATEST_LEAD, LEAST_LEAD
from gcodesim.units import DEG, INCH, MM

LARGEST: Final = 64 * 1024 * 1024
"""Bytes of the largest library that is read."""


EMPTY: Final = f"{LEFT_OUT}T0 is the empty spindle, no tool"


class ToolFileError(Exception):
    """A file that holds no tools in a known form; the text says why."""


@frozen
class ToolFile:
    """What a file says: its tools, and other lines of a cell, such as the stock."""

    what: str
    tools: tuple[ReadTool, ...]
    stock: str = ""


def read_tools(path: Path, *, inch: bool = False) -> ToolFile:
    """The tools of a file, told by its ending and content; OSError, or ToolFileError: no tools in a known form."""
    data = path.read_bytes()
    if len(data) > LARGEST:
        raise ToolFileError(f"{path} is larger than a tool library")
    if path.suffix.lower() in (".tbl", ".tool"):
        return _linuxcnc(path, data, inch)
    if data[:2] == b"PK":
        return _fusion(_json(_unpacked(path, data), path))
    found = _json(data, path)
    if isinstance(found.get("data"), list):
        return _fusion(found)
    if path.suffix.lower() == ".fctl" or (isinstance(found.get("tools"), list) and "version" in found):
        return _freecad_library(found, path)
    if "shape" in found and "parameter" in found:
        return ToolFile(what="tool bit of FreeCAD", tools=(_freecad(1, found),))
    if isinstance(found.get("tools"), dict):
        return _camotics(found)
    raise ToolFileError(f"{path} is no tool table, library of Fusion or FreeCAD, or project of CAMotics")


def _json(data: bytes, path: Path) -> Json:
    try:
        found = json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        reason = "is not in UTF-8" if isinstance(error, UnicodeDecodeError) else "is no JSON"
        raise ToolFileError(f"{path} {reason}") from None
    if not isinstance(found, dict):
        raise ToolFileError(f"{path} holds no tools: a mapping is expected")
    return found


def _unpacked(path: Path, data: bytes) -> bytes:
    try:
        with zipfile.ZipFile(BytesIO(data)) as archive:
            names = [name for name in archive.namelist() if name.endswith(".json")]
            if not names or archive.getinfo(names[0]).file_size > LARGEST:
                raise ToolFileError(f"{path} holds no library of tools")
            return archive.read(names[0])
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, zipfile.zlib.error) as error:  # type: ignore[attr-defined]
        raise ToolFileError(f"{path} cannot be unpacked: {error}") from None


def _flag(number: int | None, name: str) -> ReadTool | None:
    """The refusal of a number that no tool of a cell has."""
    if number is None:
        return ReadTool(number=0, name=name, notes=("refused: it has no number",))
    if number == 0:
        return ReadTool(number=0, name=name, notes=(EMPTY,))
    if not 1 <= number <= 99_999:
        return ReadTool(number=number, name=name, notes=("refused: its number is not within 1 to 99999",))
    return None


_DOWN_CUT: Final = re.compile(r"down[ -]?cut|left[ -]?hand(?:ed)? (?:helix|spiral)", re.IGNORECASE)
_COMPRESSION: Final = re.compile("compression", re.IGNORECASE)

_NEEDS: Final = {
    "bull_nose_end_mill": ("diameter", "corner_radius"),
    "corner_rounding_mill": ("corner_radius", "tip_diameter"),
    "dovetail_mill": ("diameter", "flute_length"),
    "engraver": ("diameter",),
    "saw": ("diameter", "flute_length"),
    "t_slot_mill": ("diameter", "flute_length"),
    "tap": ("diameter", "pitch"),
    "taper_ball_end_mill": ("diameter", "tip_diameter", "taper"),
    "v_bit": ("diameter", "angle"),
}


_HELIX: Final = 30.0
"""Degrees of a helix of which only the sense is known: the usual one."""


def _made(keys: ToolKeys, number: int, name: str) -> ReadTool:
    _edges_in_words(keys, name)
    return keys.tool(number, name, _NEEDS.get(keys.found["type"], ("diameter",)))


def _edges_in_words(keys: ToolKeys, name: str) -> None:
    """What the name of a mill says of the sense of its edges, which no file has a number for."""
    if not keys.found["type"].endswith("_mill") or "helix" in keys.found:
        return
    if _DOWN_CUT.search(name):
        keys.angle("helix", -_HELIX)
        keys.notes.append(f"approximated: its edges press chips down, and a helix of -{_HELIX:g} deg is assumed")
    elif _COMPRESSION.search(name):
        keys.notes.append("approximated: `up_cut` is not told, the height up to which compression edges lift chips")


# --- LinuxCNC

# kinds of which a line with a diameter and a length does not say enough
_SHAPED: Final = re.compile(
    r"form[ -]?(?:tool|cutter|mill)|profile|ogee|mou?lding|\bcove\b|round ?over|dovetail|t-?slot|key ?(?:seat|cutter)|"
    r"thread ?mill|lollipop|corner round|drag ?knife",
    re.IGNORECASE,
)
_TOOL_WORD: Final = re.compile(r"(?<![A-Za-z])[Tt]\s*[0-9]")
_MILL: Final = re.compile("mill|compression|(?:up|down)[ -]?cut", re.IGNORECASE)
_PROBE: Final = re.compile(r"\bprobe\b|\btaster\b", re.IGNORECASE)


def _linuxcnc(path: Path, data: bytes, inch: bool) -> ToolFile:
    table, findings = ToolTable.read(SourceText(str(path), data), inch=inch)
    unit, si = ("in", INCH) if inch else ("mm", MM)
    tools = []
    for number, entry in table.items():
        if refusal := _flag(number, entry.comment):
            tools.append(refusal)
            continue
        if shaped := _SHAPED.search(entry.comment):
            what = shaped[0].lower()
            why = f"refused: a table has no sizes of a {what}; write it as a `profile_mill`, or by its type"
            tools.append(ReadTool(number=number, name=entry.comment, notes=(why,)))
            continue
        told = tool_in_words(number, entry.comment, inch)
        if _PROBE.search(entry.comment):
            told = replace(told, type="probe")
        named = told.type != "flat_end_mill" or _MILL.search(entry.comment) is not None
        if _turns(entry) and not named:
            tools.append(_lathe_tip(entry, unit, si))
            continue
        if entry.offset[0] and not entry.diameter and told.diameter is None:
            why = "refused: by its X offset it is a lathe's, and the line does not say its edges (I, J, Q)"
            tools.append(ReadTool(number=number, name=entry.comment, notes=(why,)))
            continue
        keys = ToolKeys(told.type, entry.comment, unit)
        keys.length("diameter", entry.diameter / si if entry.diameter > 0.0 else told.diameter)
        keys.length("corner_radius", told.corner_radius)
        keys.angle("point_angle", told.point_angle)
        keys.angle("angle", told.angle)
        keys.length("length", entry.offset[2] / si)
        if not named:
            keys.notes.append("approximated: a table does not say what kind of tool it is; a flat end mill is assumed")
        else:
            spoken = told.type.replace("_", " ")
            keys.notes.append(f"approximated: the comment speaks of a{'n' if spoken[0] in 'aeiou' else ''} {spoken}")
        if told.diameter is not None and entry.diameter > 0.0 and abs(told.diameter * si - entry.diameter) > 0.02 * MM:
            keys.notes.append(
                f"differs: D is {entry.diameter / si:g} {unit}, the comment says {told.diameter:g} {unit}"
            )
        tools.append(_made(keys, number, entry.comment))
    source = SourceText(str(path), data)
    prose = [f.span.line for f in findings if not _TOOL_WORD.search(source.line(f.span.line).partition(";")[0])]
    lost = [
        ReadTool(number=0, name=f"line {f.span.line}", notes=(f"refused: {f.message}",))
        for f in findings
        if f.span.line not in prose
    ]
    if prose:
        name = f"line{'' if len(prose) == 1 else 's'} {', '.join(map(str, prose))}"
        lost.append(ReadTool(number=0, name=name, notes=(f"{LEFT_OUT}no T word, so no tool",)))
    return ToolFile(what="tool table of LinuxCNC", tools=(*tools, *lost))


def _turns(entry: ToolEntry) -> bool:
    """Whether a line describes a tip of a lathe: where its nose is, or its edges."""
    return 1 <= entry.orientation <= 9 or entry.front_angle != entry.back_angle


def _lathe_tip(entry: ToolEntry, unit: str, si: float) -> ReadTool:
    """A turning tool by nose and edges; D is twice the radius of its nose (LinuxCNC, tool table of lathes)."""
    keys = ToolKeys("turning_tool", entry.comment, unit)
    orientation = entry.orientation if 1 <= entry.orientation <= 9 else 9
    keys.found["orientation"] = str(orientation)
    keys.length("nose_radius", 0.5 * entry.diameter / si)
    lead, tip = angles_of_edges(entry.front_angle, entry.back_angle, orientation)
    if entry.front_angle == entry.back_angle:
        keys.notes.append("approximated: it does not say its edges (I, J); a slim tip is assumed")
    elif not 0.0 < tip < 180.0 * DEG:
        keys.notes.append("differs: its edges (I, J) enclose no tip; a slim one is assumed")
    elif lead is not None and not LEAST_LEAD <= lead <= GREATEST_LEAD:
        keys.notes.append(
            f"differs: its edges (I, J) do not lie behind a nose of Q{orientation}; a slim tip is assumed"
        )
    else:
        keys.angle("tip_angle", tip / DEG)
        if lead is not None:
            keys.angle("lead_angle", lead / DEG)
    if any(entry.offset):
        keys.notes.append("not used: its offsets; the cell takes them with `tool_table`")
    return keys.tool(entry.number, entry.comment, ())


# --- Fusion

_FUSION: Final = {
    "flat end mill": "flat_end_mill",
    "ball end mill": "ball_end_mill",
    "bull nose end mill": "bull_nose_end_mill",
    "face mill": "face_mill",
    "chamfer mill": "chamfer_mill",
    "tapered mill": "taper",
    "dovetail mill": "dovetail_mill",
    "lollipop mill": "lollipop_mill",
    "slot mill": "t_slot_mill",
    "radius mill": "corner_rounding_mill",
    "thread mill": "thread_mill",
    "drill": "drill",
    "spot drill": "spot_drill",
    "center drill": "spot_drill",
    "counter sink": "countersink",
    "reamer": "reamer",
    "tap right hand": "tap",
    "tap left hand": "tap",
    "boring bar": "boring_bar",
    "probe": "probe",
}
_FUSION_READ: Final = frozenset(
    ("DC", "DCX", "LCF", "LB", "NOF", "RE", "SIG", "TA", "TP", "tip-diameter", "shoulder-diameter", "OAL", "SFDM",
     "shoulder-length", "assemblyGaugeLength", "HAND", "CSP", "LF", "NT", "thread-profile-angle")
)  # fmt: skip


def _fusion(library: Json) -> ToolFile:
    tools = [_fusion_tool(entry) for entry in library["data"] if isinstance(entry, dict)]
    return ToolFile(what="library of Fusion", tools=tuple(tool for tool in tools if tool is not None))


def _fusion_tool(entry: Json) -> ReadTool | None:
    word = str(entry.get("type", "")).strip().lower()
    if word in ("holder", "tool block"):
        return None
    post, geometry = _mapping(entry.get("post-process")), _mapping(entry.get("geometry"))
    name = str(entry.get("description") or entry.get("product-id") or word)
    number = whole_of(post.get("number"))
    if refusal := _flag(number, name):
        return refusal
    assert number is not None
    unit = "in" if str(entry.get("unit", "")).startswith("inch") else "mm"
    if word in TURNING:
        keys = ToolKeys(TURNING[word], name, unit)
        return turning_tool(number, name, keys, geometry, _mapping(entry.get("holder")))
    if word not in _FUSION:
        has_outline = word == "form mill" or word.startswith("circle segment")
        way = "; `profile_mill` takes its outline" if has_outline else ""
        return ReadTool(number=number, name=name, notes=(f"refused: gcodesim knows no `{word}`{way}",))

    def value(key: str) -> float | None:
        return number_of(geometry.get(key))

    kind = _FUSION[word]
    taper, corner, tip = value("TA"), value("RE"), value("tip-diameter")
    if kind == "taper":
        kind = "taper_ball_end_mill" if corner and taper else "engraver"
    keys = ToolKeys(kind, name, unit)
    keys.length("diameter", value("DC"))
    if kind == "face_mill":
        keys.length("diameter", value("DCX") or value("DC"))
        if taper is not None:
            keys.angle("lead_angle", taper)
    keys.count("flutes", geometry.get("NOF"))
    keys.length("flute_length", value("LCF"))
    keys.length("length", value("LB") or value("LF"))
    if kind == "bull_nose_end_mill":
        keys.length("corner_radius", corner)
    elif kind == "corner_rounding_mill":
        keys.length("corner_radius", corner)
        keys.length("tip_diameter", tip or value("DC"))
        keys.found.pop("diameter", None)
    elif kind == "taper_ball_end_mill":
        # its DC is the ball at the tip
        keys.length("tip_diameter", value("DC"))
        keys.angle("taper", taper)
        keys.length("diameter", value("SFDM") or value("shoulder-diameter"))
    elif kind in ("chamfer_mill", "engraver"):
        keys.angle("angle", None if taper is None else 2.0 * taper)
        keys.length("tip_diameter", tip)
    elif kind == "dovetail_mill":
        keys.angle("angle", None if taper is None else 90.0 - taper)
    elif kind == "countersink":
        keys.angle("angle", value("SIG") or (None if taper is None else 2.0 * taper))
        keys.length("tip_diameter", tip)
    elif kind in ("drill", "spot_drill"):
        keys.angle("point_angle", value("SIG"))
    elif kind in ("tap", "thread_mill"):
        keys.length("pitch", value("TP"))
    if kind in ("lollipop_mill", "thread_mill", "tap", "probe"):
        keys.found.pop("flute_length", None)
    if kind == "probe":
        keys.found.pop("flutes", None)
    if word in ("center drill", "slot mill"):
        keys.notes.append(f"approximated: a {word} is taken for a {kind.replace('_', ' ')}")
    if word.startswith("tap left"):
        keys.notes.append("approximated: a left-hand tap is taken for a right-hand one")
    fusion_shank(entry, geometry, keys)
    fusion_holder(entry, keys)
    ignored = sorted(set(geometry) - _FUSION_READ)
    if ignored:
        keys.notes.append(f"not used: {', '.join(f'`{key}`' for key in ignored)}")
    return _made(keys, number, name)


def _mapping(value: Any) -> Json:
    return value if isinstance(value, dict) else {}


# --- FreeCAD

_FREECAD: Final = {
    "endmill": "flat_end_mill",
    "ballend": "ball_end_mill",
    "bullnose": "bull_nose_end_mill",
    "torus": "bull_nose_end_mill",
    "chamfer": "chamfer_mill",
    "v-bit": "v_bit",
    "vbit": "v_bit",
    "dovetail": "dovetail_mill",
    "drill": "drill",
    "slittingsaw": "saw",
    "thread-mill": "thread_mill",
    "threadmill": "thread_mill",
    "tap": "tap",
    "reamer": "reamer",
    "probe": "probe",
    **dict.fromkeys(("iso_shape_c", "iso_shape_d", "iso_shape_s", "iso_shape_t", "isoshape"), "turning_tool"),
}

_FREECAD_UNITS: Final = {
    "": 1.0,
    "mm": 1.0,
    "cm": 10.0,
    "m": 1000.0,
    "um": 1e-3,
    "\N{MICRO SIGN}m": 1e-3,
    "\N{GREEK SMALL LETTER MU}m": 1e-3,
    '"': INCH / MM,
    "in": INCH / MM,
    "thou": 1e-3 * INCH / MM,
    "mil": 1e-3 * INCH / MM,
    "\N{DEGREE SIGN}": 1.0,
    "deg": 1.0,
}
_FREECAD_VALUE: Final = re.compile(r"\s*([+-]?[0-9][0-9.,]*|[.,][0-9]+)\s*(?:/\s*([0-9]+))?\s*(\S*)\s*")


def _freecad_value(value: Any) -> float | None:
    """A length in mm or an angle in degrees, as FreeCAD shows it in any language: `6.35 mm`, `3,17 mm`, `1/4"`.

    Of dots and commas the last is that of the decimals.
    """
    if not isinstance(value, str):
        return number_of(value)
    match = _FREECAD_VALUE.fullmatch(value)
    if match is None or match[3] not in _FREECAD_UNITS:
        return None
    digits = match[1]
    last = max(digits.rfind("."), digits.rfind(","))
    whole = digits if last < 0 else digits[:last].replace(".", "").replace(",", "") + "." + digits[last + 1 :]
    number = number_of(whole if whole[-1:] != "." else whole[:-1])
    parts = int(match[2] or 1)
    return None if number is None or parts == 0 else number / parts * _FREECAD_UNITS[match[3]]


def _freecad_library(library: Json, path: Path) -> ToolFile:
    tools = []
    for entry in library.get("tools") or ():
        if not isinstance(entry, dict):
            continue
        number, place = whole_of(entry.get("nr")), str(entry.get("path", ""))
        name = PurePosixPath(place.replace("\\", "/")).name
        if refusal := _flag(number, name):
            tools.append(refusal)
            continue
        assert number is not None
        found = next((at for at in _places(path, name) if at.is_file()), None)
        if not name or found is None:
            tools.append(ReadTool(number=number, name=name, notes=(f"refused: `{name}` is not beside the library",)))
            continue
        try:
            tools.append(_freecad(number, _json(found.read_bytes(), found)))
        except (OSError, ToolFileError) as error:
            tools.append(ReadTool(number=number, name=name, notes=(f"refused: {error}",)))
    return ToolFile(what="library of FreeCAD", tools=tuple(tools))


def _places(library: Path, name: str) -> Iterator[Path]:
    """Where a tool bit of a library may be: beside it, or in FreeCAD's folder `Bit` beside its `Library`."""
    yield library.parent / name
    yield library.parent / "Bit" / name
    yield library.parent.parent / "Bit" / name


def _freecad(number: int, bit: Json) -> ReadTool:
    name = str(bit.get("name", ""))
    shape = PurePosixPath(str(bit.get("shape", "")).replace("\\", "/")).stem.lower()
    if shape not in _FREECAD:
        return ReadTool(number=number, name=name, notes=(f"refused: gcodesim knows no tool of the shape `{shape}`",))
    parameters = {**_mapping(bit.get("attribute")), **_mapping(bit.get("parameter"))}
    kind = _FREECAD[shape]
    keys = ToolKeys(kind, name, "mm")
    used = {"Diameter", "Length", "ShankDiameter", "Flutes", "Material", "Chipload", "SpindleDirection", "ToolBitID"}

    def value(key: str) -> float | None:
        used.add(key)
        return _freecad_value(parameters.get(key))

    if kind == "turning_tool":
        keys.length("nose_radius", value("TipRadius"))
        keys.angle("tip_angle", value("TipAngle"))
        keys.length("edge", value("EdgeLength"))
        keys.notes.append("approximated: it does not say how it is held; its front edge stands square to the feed")
        return keys.tool(number, name, ("tip_angle",))
    keys.length("diameter", value("Diameter"))
    keys.count("flutes", parameters.get("Flutes"))
    keys.length("length", value("Length"))
    if kind not in ("probe", "v_bit", "thread_mill", "saw", "drill"):
        keys.length("flute_length", value("CuttingEdgeHeight") or value("CuttingEdgeLength"))
    angle = value("CuttingEdgeAngle")
    if kind in ("chamfer_mill", "v_bit"):
        tip = value("TipDiameter")
        flat = value("FlatRadius")
        keys.angle("angle", angle)
        keys.length("tip_diameter", tip or (None if flat is None else 2.0 * flat))
        value("FlatHeight")
        value("CuttingEdgeHeight")
    elif kind == "dovetail_mill":
        keys.angle("angle", angle or value("CuttingAngle"))
        keys.length("neck_diameter", value("NeckDiameter"))
        if "flute_length" not in keys.found:
            keys.length("flute_length", value("DovetailHeight"))
        value("NeckHeight")
    elif kind == "bull_nose_end_mill":
        flat = value("FlatRadius")
        diameter = value("Diameter")
        beyond = None if flat is None or diameter is None else 0.5 * diameter - flat
        keys.length("corner_radius", value("CornerRadius") or value("TorusRadius") or beyond)
    elif kind == "drill":
        keys.angle("point_angle", value("TipAngle"))
    elif kind == "saw":
        keys.length("flute_length", value("BladeThickness"))
        keys.length("neck_diameter", value("ShankDiameter"))
    elif kind == "thread_mill":
        keys.angle("angle", value("cuttingAngle"))
        keys.length("crest", value("Crest"))
        keys.length("neck_diameter", value("NeckDiameter"))
    elif kind == "tap":
        keys.length("pitch", value("Pitch"))
    if kind == "probe":
        keys.found.pop("flutes", None)
    if "neck_diameter" not in keys.found:
        plain_shank(value("ShankDiameter"), keys)
    ignored = sorted(set(parameters) - used)
    if ignored:
        keys.notes.append(f"not used: {', '.join(f'`{key}`' for key in ignored)}")
    return _made(keys, number, name)


# --- CAMotics


def _camotics(project: Json) -> ToolFile:
    tools = []
    for key, entry in project["tools"].items():
        if not isinstance(entry, dict):
            continue
        number = whole_of(entry.get("number", key))
        name = str(entry.get("description") or "")
        refusal = _flag(number, name)
        if refusal is None:
            assert number is not None
            refusal = _camotics_tool(number, name, entry, project)
        tools.append(refusal)
    return ToolFile(what="project of CAMotics", tools=tuple(tools), stock=_camotics_stock(project))


def _camotics_tool(number: int, name: str, entry: Json, project: Json) -> ReadTool:
    shape = str(entry.get("shape", "cylindrical")).lower()
    units = str(entry.get("units", project.get("units", "metric"))).lower()
    unit = "in" if units in ("imperial", "inch") else "mm"
    diameter, length = number_of(entry.get("diameter")), number_of(entry.get("length"))
    tip = number_of(entry.get("snub_diameter"))
    if shape == "cylindrical":
        keys = ToolKeys("flat_end_mill", name, unit)
    elif shape == "ballnose":
        keys = ToolKeys("ball_end_mill", name, unit)
    elif shape in ("conical", "snubnose"):
        keys = ToolKeys("v_bit", name, unit)
        if diameter and length:
            half = atan2(0.5 * (diameter - (tip or 0.0 if shape == "snubnose" else 0.0)), length)
            keys.angle("angle", math.degrees(2.0 * half))
        if shape == "snubnose":
            keys.length("tip_diameter", tip)
    elif shape == "spheroid" and diameter and length and abs(length - diameter) < 1e-6 * diameter:
        keys = ToolKeys("lollipop_mill", name, unit)
        keys.notes.append("approximated: a ball on a neck of half its diameter")
    else:
        return ReadTool(number=number, name=name, notes=(f"refused: gcodesim knows no tool of the shape `{shape}`",))
    keys.length("diameter", diameter)
    if shape in ("cylindrical", "ballnose"):
        keys.length("flute_length", length)
        if diameter and length:
            keys.length("length", max(length, 4.0 * diameter))
            keys.notes.append("approximated: it does not say how long the tool is; 4 diameters, or the edges")
    return _made(keys, number, name)


def _camotics_stock(project: Json) -> str:
    workpiece = _mapping(project.get("workpiece"))
    bounds = _mapping(workpiece.get("bounds"))
    corners = [bounds.get("min"), bounds.get("max")]
    if workpiece.get("automatic") or not all(isinstance(c, list) and len(c) == 3 for c in corners):
        return ""
    values = [[number_of(part) for part in corner or ()] for corner in corners]
    if any(part is None for corner in values for part in corner):
        return ""
    low, high = (f"[{', '.join(f'{part:g}' for part in corner)} mm]" for corner in values)
    return f"stock: {{min: {low}, max: {high}, in: G54}}\n"

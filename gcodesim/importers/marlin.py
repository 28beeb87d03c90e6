"""Marlin's Configuration.h as a cell. Facts: Marlin 2.1, `Configuration.h`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar, Final

from gcodesim.importers.axes import ImportedAxis
from gcodesim.importers.c_conditions import CConditions
from gcodesim.importers.importer import (
    FoundSetting,
    FoundSettings,
    Imported,
    Importer,
    NoSettingsError,
    heading,
    number_in,
    read_text,
    written,
)
from gcodesim.importers.printer import four, printer_lines

_DEFINE: Final = re.compile(r"\s*#define\s+([A-Za-z_]\w*)(?:\s+(.*))?$")
_ROUND: Final = ("DELTA", "SCARA", "MORGAN_SCARA", "MP_SCARA", "TPARA", "POLAR", "POLARGRAPH", "AXEL_TPARA")
_WORD: Final = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
_SUM: Final = re.compile(r"\s*([-+*/()]|[0-9.]+)")
_KIND_OF_NUMBER: Final = re.compile(r"(?<=[0-9.])[fFlL]\b")  # of C: 82.0f
_DEEPEST: Final = 20  # names that stand for each other

_REASONS: Final = (
    ("DEFAULT_EJERK", "corners go by junction deviation, not by jerk", False),
    ("DEFAULT_XJERK", "corners go by junction deviation, not by jerk", False),
    ("DEFAULT_YJERK", "corners go by junction deviation, not by jerk", False),
    ("DEFAULT_ZJERK", "corners go by junction deviation, not by jerk", False),
    ("JUNCTION_DEVIATION", "corners go by classic jerk", False),
    ("S_CURVE_ACCELERATION", "speeds change with a steady acceleration", True),
    ("LIN_ADVANCE", "filament is not squeezed", True),
    ("TEMP", "heat is not simulated", False),
    ("HEATER", "heat is not simulated", False),
    ("BANG", "heat is not simulated", False),
    ("PID", "heat is not simulated", False),
)


class Marlin(Importer):
    """`import marlin Configuration.h`."""

    kind: ClassVar[str] = "marlin"
    says: ClassVar[str] = "a Configuration.h: bed, travel, speeds, accelerations, nozzles, filament"

    def read(self, path: Path, folder: Path) -> Imported:
        settings = FoundSettings(_settings(path))
        values = {setting.name: setting.value for setting in settings.all}
        if "DEFAULT_MAX_FEEDRATE" not in values:
            raise NoSettingsError(f"{path} does not define DEFAULT_MAX_FEEDRATE: it is no Configuration.h of Marlin")
        speeds = _list(settings, "DEFAULT_MAX_FEEDRATE", values)
        changes = _list(settings, "DEFAULT_MAX_ACCELERATION", values)
        axes = {letter: _axis(settings, letter, index, speeds, changes, values) for index, letter in enumerate("XYZ")}
        for name in _ROUND:
            if (found := settings.last(name)) is not None:
                settings.leave(found, "the joints are not simulated: axes move as a program sees them", matters=True)
        count = int(_number(settings, "EXTRUDERS", values) or 1)
        filament = _number(settings, "DEFAULT_NOMINAL_FILAMENT_DIA", values)
        nozzle = _number(settings, "NOZZLE_SIZE", values) or 0.4
        nozzles = dict.fromkeys(range(max(1, min(count, 16))), (nozzle, filament))
        printer = printer_lines("marlin", axes, nozzles, _limits(settings, speeds, changes, values))
        lines = [*heading(path, "the configuration of Marlin"), *printer]
        taken, left = settings.finished(_REASONS)
        return Imported(what="Configuration.h of Marlin", lines=tuple(lines), taken=taken, left=left)


def _limits(
    settings: FoundSettings, speeds: list[float], changes: list[float], values: Mapping[str, str]
) -> dict[str, str]:
    """Corners go by junction deviation, unless there is none or `CLASSIC_JERK` is defined."""

    def one(key: str, name: str, unit: str) -> dict[str, str]:
        value = _number(settings, name, values)
        return {key: f"{written(value)} {unit}"} if value else {}

    found = {
        **({"speed": four(speeds[:4], "mm/s")} if len(speeds) >= 4 else {}),
        **({"acceleration": four(changes[:4], "mm/s^2")} if len(changes) >= 4 else {}),
        **one("printing", "DEFAULT_ACCELERATION", "mm/s^2"),
        **one("travel", "DEFAULT_TRAVEL_ACCELERATION", "mm/s^2"),
        **one("retracting", "DEFAULT_RETRACT_ACCELERATION", "mm/s^2"),
    }
    classic = settings.last("CLASSIC_JERK") is not None
    deviation = {} if classic else one("junction_deviation", "JUNCTION_DEVIATION_MM", "mm")
    if deviation:
        return found | deviation
    jerks = [_number(settings, f"DEFAULT_{letter}JERK", values) for letter in "XYZE"]
    known = [value for value in jerks if value is not None]
    return found | ({"jerk": four(known, "mm/s")} if len(known) == 4 else {})


def _settings(path: Path) -> list[FoundSetting]:
    """Definitions that hold, in their order."""
    found = []
    defined: dict[str, str] = {}
    conditions = CConditions()
    inside = False  # of a comment over several lines
    for number, raw in enumerate(read_text(path).splitlines(), start=1):
        line, inside = _without_comments(raw, inside)
        if conditions.take(line, defined) and (match := _DEFINE.match(line)):
            setting = FoundSetting(match[1], (match[2] or "").strip(), path.name, number)
            defined[setting.name] = setting.value
            found.append(setting)
    return found


def _without_comments(line: str, inside: bool) -> tuple[str, bool]:
    kept = ""
    while line:
        if inside:
            _, end, line = line.partition("*/")
            inside = not end
            continue
        at = min((place for mark in ("//", "/*") if (place := line.find(mark)) >= 0), default=-1)
        if at < 0 or line.startswith("//", at):
            return kept + (line if at < 0 else line[:at]), False
        kept, line, inside = kept + line[:at], line[at + 2 :], True
    return kept, inside


def _axis(
    settings: FoundSettings,
    letter: str,
    index: int,
    speeds: list[float],
    changes: list[float],
    values: Mapping[str, str],
) -> ImportedAxis:
    size = _number(settings, f"{letter}_BED_SIZE", values)
    low = _number(settings, f"{letter}_MIN_POS", values) or 0.0
    high = _number(settings, f"{letter}_MAX_POS", values)
    if high is None:
        high = size
    if high is None or high <= low:
        raise NoSettingsError(f"{letter}_MAX_POS is not there, or not above {letter}_MIN_POS")
    if len(speeds) <= index:
        raise NoSettingsError(f"DEFAULT_MAX_FEEDRATE has no value for {letter}")
    change = changes[index] if len(changes) > index else None
    return ImportedAxis(letter=letter, lower=low, upper=high, speed=speeds[index], acceleration=change)


def _list(settings: FoundSettings, name: str, values: Mapping[str, str]) -> list[float]:
    text = settings.text(name).strip("{} ")
    return [value for part in text.split(",") if (value := _value(part, values)) is not None]


def _number(settings: FoundSettings, name: str, values: Mapping[str, str]) -> float | None:
    found = settings.last(name)
    if found is None:
        return None
    value = _value(found.value, values)
    if value is None:
        settings.leave(found, "it cannot be computed here", matters=True)
    return value


def _value(text: str, values: Mapping[str, str]) -> float | None:
    """A sum of numbers and names, such as `(X_BED_SIZE / 2) - 10`."""
    for _ in range(_DEEPEST):
        if not _WORD.search(text):
            break
        text = _WORD.sub(lambda word: f"({values.get(word[0], '?')})", text)
        if len(text) > 500:
            return None
    text = _KIND_OF_NUMBER.sub("", text)
    tokens = _SUM.findall(text)
    if "".join(tokens) != re.sub(r"\s", "", text):
        return None
    value = _sum(tokens)
    return value if not tokens else None


def _sum(tokens: list[str]) -> float | None:
    value = _product(tokens)
    while value is not None and tokens and tokens[0] in "+-":
        sign = tokens.pop(0)
        other = _product(tokens)
        value = None if other is None else value + other if sign == "+" else value - other
    return value


def _product(tokens: list[str]) -> float | None:
    value = _factor(tokens)
    while value is not None and tokens and tokens[0] in "*/":
        sign = tokens.pop(0)
        other = _factor(tokens)
        if other is None or (sign == "/" and other == 0.0):
            return None
        value = value * other if sign == "*" else value / other
    return value


def _factor(tokens: list[str]) -> float | None:
    if not tokens:
        return None
    token = tokens.pop(0)
    if token == "-":
        other = _factor(tokens)
        return None if other is None else -other
    if token == "(":
        value = _sum(tokens)
        return value if tokens and tokens.pop(0) == ")" else None
    return number_in(token)

"""The settings that grbl lists at `$$` as a cell, with the offsets of `$#`. Facts: grbl 1.1, `settings.md`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar, Final

from gcodesim.cell.startup import modal_words
from gcodesim.importers.axes import ImportedAxis, machine_lines, zero_lines
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
from gcodesim.rs274.grbl import GRBL_LIMITS
from gcodesim.units import INCH, MM

# senders put a time, an arrow or a name before what the control said: `$$ < $0=10`, `[12:04:11] $0=10`, `Recv: $0=10`
_LINE: Final = re.compile(r"(?:[^(;]*[<>:\]]|)\s*\$(\d+)\s*=\s*([^\s(;]+)")
_SAVED: Final = re.compile(r"\"\$(\d+)\"\s*:\s*\"?([^\s\",}]+)")  # as senders save it, in JSON
_STARTUP: Final = re.compile(r"\s*\$(N[01])\s*=\s*(\S.*?)\s*$")
_OFFSET: Final = re.compile(r"\s*\[(G5[4-9]|G28|G30|G92|TLO|PRB):([^\]]*)\]")
_LETTERS: Final = "XYZABC"
_TRAVEL, _SPEED, _ACCELERATION = 130, 110, 120
_PULL_OFF, _DIRECTIONS, _MODE, _FASTEST, _INCHES, _HOMING = "$27", "$23", "$32", "$30", "$13", "$22"
_AT_HOME: Final = 8  # bit of $22 of grblHAL: machine zero is where the axes are after homing (known by memory)
_IS_LASER, _IS_LATHE = 1, 2  # $32; the second is grblHAL's (known by memory)

_REASONS: Final = (
    ("$100", "steps of the motor", False),
    ("$101", "steps of the motor", False),
    ("$102", "steps of the motor", False),
    ("$103", "steps of the motor", False),
    ("$12", "arcs are exact", False),
    ("$20", "limits are always checked", False),
    ("$21", "limit switches", False),
    ("$24", "homing", False),
    ("$25", "homing", False),
    ("$26", "homing", False),
    ("$31", "a cell has no least speed of a spindle", True),
    ("$10", "reports", False),
)
_EXACT: Final = ("$10", "$11", "$12")


class Grbl(Importer):
    """`import grbl settings.txt`."""

    kind: ClassVar[str] = "grbl"
    says: ClassVar[str] = "the list of settings of `$$`, with that of `$#` behind it: travel, speeds, spindle, laser"

    def read(self, path: Path, folder: Path) -> Imported:
        settings = FoundSettings(list(_settings(path)))
        if not any(setting.name == f"${_SPEED}" for setting in settings.all):
            raise NoSettingsError(f"{path} has no ${_SPEED}: it is no list of the settings of grbl from 0.9 on")
        axes = dict(_axes(settings))
        if not axes:
            raise NoSettingsError(f"{path} gives no axis a speed and a travel")
        lines = [*heading(path, "the settings of a grbl control"), "dialect: grbl", *machine_lines(axes)]
        lines += _offsets(settings) or list(zero_lines(axes))
        lines += _corners(settings)
        lines += _startup(settings)
        lines += _spindle(settings)
        taken, left = settings.finished(_reasons(settings))
        return Imported(what="list of settings of grbl", lines=tuple(lines), taken=taken, left=left)


def _settings(path: Path) -> Iterator[FoundSetting]:
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        if saved := _SAVED.findall(line):
            yield from (FoundSetting(f"${name}", value, path.name, number) for name, value in saved)
        elif found := _LINE.match(line) or _STARTUP.match(line):
            yield FoundSetting(f"${found[1]}", found[2], path.name, number)
        elif offset := _OFFSET.match(line):
            yield FoundSetting(offset[1], offset[2], path.name, number)
        elif line.strip() and not re.match(r"\s*(ok|Grbl|>|\[MSG|\[HLP|\[VER|\[OPT|<|\$[$#IN]|;|\()", line):
            yield FoundSetting(line.strip(), "", path.name, number)


def _axes(settings: FoundSettings) -> Iterator[tuple[str, ImportedAxis]]:
    """Everything lies on the negative side of machine zero, which is where the switches of axes that home upwards are;
    or machine zero is where the axes are after homing."""
    towards = int(settings.number(_DIRECTIONS) or 0)
    pull = settings.number(_PULL_OFF) or 0.0
    at_home = bool(int(settings.number(_HOMING) or 0) & _AT_HOME)
    for index, letter in enumerate(_LETTERS):
        speed, travel = settings.number(f"${_SPEED + index}"), settings.number(f"${_TRAVEL + index}")
        change = settings.number(f"${_ACCELERATION + index}")
        if not speed or not travel:
            for name in (_SPEED + index, _ACCELERATION + index, _TRAVEL + index):
                if (found := settings.last(f"${name}")) is not None:
                    settings.leave(found, f"axis {letter} has no speed or no travel: the cell has none", matters=True)
            continue
        back = bool(towards >> index & 1)
        low = 0.0 if at_home and back else -abs(travel)
        home = 0.0 if at_home else low + pull if back else -pull
        yield (
            letter,
            ImportedAxis(
                letter=letter,
                lower=low,
                upper=low + abs(travel),
                speed=speed / 60.0,
                acceleration=change or None,
                home=min(low + abs(travel), max(low, home)),
            ),
        )


def _offsets(settings: FoundSettings) -> list[str]:
    """Work systems as `$#` lists them: in the units of reports."""
    unit = INCH / MM if settings.number(_INCHES) else 1.0
    systems = []
    for number in range(4, 10):
        found = settings.last(f"G5{number}")
        if found is None:
            continue
        values = [number_in(part) for part in found.value.split(",")]
        if len(values) < 3 or None in values:
            settings.leave(found, "no three numbers", matters=True)
            continue
        systems.append(f"G5{number}: {{xyz: [{', '.join(written(v * unit) for v in values[:3] if v is not None)} mm]}}")
    return [f"work_offsets: {{{', '.join(systems)}}}"] if systems else []


def _corners(settings: FoundSettings) -> list[str]:
    """By how much corners may seem to be missed (`$11`): nothing where it is as grbl is delivered."""
    deviation = settings.number("$11")
    if not deviation or deviation * MM == GRBL_LIMITS.deviation:
        return []
    return [f"firmware: {{junction_deviation: {written(deviation)} mm}}"]


def _startup(settings: FoundSettings) -> list[str]:
    """The blocks that the control runs when it starts (`$N`)."""
    found: list[str] = []
    for name in ("$N0", "$N1"):
        if (setting := settings.last(name)) is None:
            continue
        words, others = modal_words(setting.value)
        found += [words] if words else []
        if others:
            why = f"these words move something or are no modes: write them into the program: {others}"
            settings.leave(setting, why, matters=True)
    return [f"startup: {' '.join(found)}"] if found else []


def _spindle(settings: FoundSettings) -> list[str]:
    fastest = settings.number(_FASTEST)
    mode = settings.last(_MODE)
    if mode is not None and settings.number(_MODE) == _IS_LATHE:
        settings.leave(mode, "a lathe: say `lathe: true` under `machine`, and which way its axes point", matters=True)
    elif settings.number(_MODE) == _IS_LASER:
        return [f"laser_mode: {written(fastest or 1000.0)}"]
    return [f"limits: {{spindle_speed: {written(fastest)} rpm}}"] if fastest else []


def _reasons(settings: FoundSettings) -> list[tuple[str, str, bool]]:
    """The reasons by whole names: $10 is not $100."""
    whole = {setting.name for setting in settings.all}
    exact = [entry for entry in _REASONS if entry[0] in whole and entry[0] in _EXACT]
    return [entry for entry in _REASONS if entry[0] not in _EXACT] + exact

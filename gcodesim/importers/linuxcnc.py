"""An INI of LinuxCNC as a cell. Facts: LinuxCNC, `docs/src/config/ini-config.adoc`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar, Final

from gcodesim.cell.startup import modal_words
from gcodesim.diagnostics import SourceText
from gcodesim.importers.axes import ImportedAxis, machine_lines, zero_lines
from gcodesim.importers.importer import (
    FoundSetting,
    FoundSettings,
    Imported,
    Importer,
    NoSettingsError,
    heading,
    number_in,
    quoted,
    read_text,
    relative,
    written,
)
from gcodesim.importers.ini_file import read_linuxcnc_ini
from gcodesim.rs274.parameters import FIRST_SYSTEM, read_parameters
from gcodesim.units import INCH, MM

_LETTERS: Final = "XYZABC"
_LINEAR: Final = "XYZ"
_SYSTEMS: Final = 9  # G54 to G59.3
_FAR: Final = 1e5  # mm or deg beyond which a limit is none
_UNITS: Final = re.compile(r"G2[01](?![0-9.])", re.IGNORECASE)
_INCHES: Final = ("inch", "in", "imperial", "25.4")
_SPEED: Final = 1.0  # unit/s where nothing says a speed: the default of the control
_TRAVEL: Final = 1000.0  # mm to either side where a linear axis has no limits
_PLAIN: Final = ("trivkins", "corexykins")
_NAMED: Final = {
    "5axiskins": ("pivot-length",),
    "maxkins": ("pivot-length",),
    "xyzac-trt-kins": ("x-rot-point", "y-rot-point", "z-rot-point", "y-offset", "z-offset", "conventional-directions"),
    "xyzbc-trt-kins": ("x-rot-point", "y-rot-point", "z-rot-point", "x-offset", "z-offset", "conventional-directions"),
}
_OF_INI: Final = re.compile(r"\[(\w+)\]\(?(\w+)\)?")
_SETP: Final = re.compile(r"^\s*setp\s+([\w.-]+)\s*[ =]\s*(\S+)", re.MULTILINE)

_REASONS: Final = (
    ("[RS274NGC]REMAP", "a remapped code: say what it does under `m_codes`, or leave it out of programs", True),
    ("[RS274NGC]ON_ABORT", "what the control does after a stop", False),
    ("[RS274NGC]USER_M_PATH", "programs for M100 to M199: say what they do under `m_codes`", True),
    ("[RS274NGC]", "the reader of programs has no such setting", False),
    ("[DISPLAY]", "the user interface", False),
    ("[EMC]", "about the control itself", False),
    ("[FILTER]", "files that are no programs", False),
    ("[TASK]", "how the control runs", False),
    ("[EMCMOT]", "how the control runs", False),
    ("[HAL", "wiring of the control", False),
    ("[EMCIO]TOOL_CHANGE", "where tools are changed: `magazine` says where they wait", True),
    ("[EMCIO]DB_PROGRAM", "tools come from a program: write them under `tools`", True),
    ("[EMCIO]RANDOM_TOOLCHANGER", "pockets are not swapped", True),
    ("[EMCIO]", "tool changer", False),
    ("[TRAJ]", "a cell has no such key", False),
    ("[SPINDLE", "spindle control", False),
    ("[JOINT_", "motor, encoder, homing of one joint", False),
    ("[AXIS_", "a cell has no such key", False),
    ("#INCLUDE", "the file is not there", True),
)
_MATTERS: Final = ("BACKLASH", "COMP_FILE", "OFFSET_AV_RATIO", "LOCKING_INDEXER", "LOCKING_INDEXER_JOINT")


class LinuxCnc(Importer):
    """`import linuxcnc machine.ini`."""

    kind: ClassVar[str] = "linuxcnc"
    says: ClassVar[str] = "an INI: axes, limits, speeds, kinematics, tool table, parameters, subroutines"

    def read(self, path: Path, folder: Path) -> Imported:
        settings = FoundSettings(read_linuxcnc_ini(path))
        if not any(setting.name.upper().startswith(("[TRAJ]", "[AXIS_", "[KINS]")) for setting in settings.all):
            raise NoSettingsError(f"{path} has no [TRAJ], [KINS] or [AXIS_…]: it is no INI of LinuxCNC")
        machine = _Machine(settings, path)
        lines = [*heading(path, "the INI of a LinuxCNC machine"), *machine.lines(folder)]
        for setting in settings.all:
            part = setting.name.partition("]")[2].upper()
            if part in _MATTERS and number_in(setting.value) not in (0.0, None):
                settings.leave(setting, "the machine in the cell has none", matters=True)
        taken, left = settings.finished(_REASONS)
        return Imported(what="INI of LinuxCNC", lines=tuple(lines), taken=taken, left=left)


@dataclass(slots=True)
class _Machine:
    """What the settings say of the machine."""

    settings: FoundSettings
    path: Path
    unit: float = 1.0  # mm in a unit of length
    axes: dict[str, ImportedAxis] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def lines(self, folder: Path) -> Iterator[str]:
        """Its lines in a cell."""
        inches = self.settings.text("[TRAJ]LINEAR_UNITS", "mm").lower() in _INCHES
        self.unit = INCH / MM if inches else 1.0
        name, words = self._kinematics()
        order = self._coordinates(words)
        for number, letter in enumerate(order):
            self._joint(letter, number)
        if not self.axes:
            raise NoSettingsError(f"{self.path} moves none of the axes {', '.join(_LETTERS)}")
        lathe = self.settings.text("[DISPLAY]LATHE").lower() in ("1", "yes", "true")
        keys = ["lathe: true"] if lathe else []
        keys += list(self._named(name, words))
        for note in self.notes:
            yield f"# {note}"
        yield from machine_lines(self.axes, tuple(keys))
        if depth := self.settings.number("[TRAJ]ARC_BLEND_OPTIMIZATION_DEPTH"):
            yield f"look_ahead: {max(int(depth), 2)}"
        yield from self._parameter_file(folder, lathe)
        yield from self._subroutines(folder)
        yield from self._startup(inches)
        yield from self._spindle()
        yield from self._tools(folder, inches)

    def _kinematics(self) -> tuple[str, dict[str, str]]:
        """The name of the module and its words, as coordinates=xyyz."""
        text = self.settings.text("[KINS]KINEMATICS", "trivkins").split()
        self.settings.values("[KINS]JOINTS")
        words = dict(word.lower().split("=", 1) for word in text[1:] if "=" in word)
        return (text or ["trivkins"])[0], words

    def _coordinates(self, words: dict[str, str]) -> list[str]:
        """The letter of each joint, in their order."""
        told = re.sub(r"[\s\"']", "", self.settings.text("[TRAJ]COORDINATES")).upper()
        own = words.get("coordinates", "").upper()
        return list(own or told or "XYZABCUVW"[: int(self.settings.number("[KINS]JOINTS") or 3)])

    def _joint(self, letter: str, number: int) -> None:
        """Take what the joint says of its axis, and the axis of itself, the narrower of both."""
        read = [f"[JOINT_{number}]", f"[AXIS_{letter}]"]
        if letter not in _LETTERS:
            for setting in self.settings.all:
                if setting.name.upper().startswith((f"[AXIS_{letter}]", f"[JOINT_{number}]")):
                    self.settings.leave(setting, f"a cell has no axis {letter}", matters=True)
            return
        linear = letter in _LINEAR
        unit = self.unit if linear else 1.0
        plain = self._is_plain()
        places = read if plain else read[1:]
        if not plain:
            for setting in self.settings.all:
                if setting.name.upper().startswith(read[0]):
                    self.settings.leave(setting, "joints behind kinematics are not simulated", matters=True)

        def narrowest(name: str, pick: Callable[[list[float]], float]) -> float | None:
            values = [self.settings.number(f"{place}{name}") for place in places]
            there = [value * unit for value in values if value is not None]
            return pick(there) if there else None

        kind = "LINEAR" if linear else "ANGULAR"
        caps = [
            self.settings.number(f"[TRAJ]MAX_{kind}_VELOCITY"),
            self.settings.number(f"[TRAJ]MAX_{kind}_ACCELERATION"),
        ]
        speed = narrowest("MAX_VELOCITY", min) or _SPEED * unit
        change = narrowest("MAX_ACCELERATION", min)
        if caps[0]:
            speed = min(speed, caps[0] * unit)
        if caps[1]:
            change = caps[1] * unit if change is None else min(change, caps[1] * unit)
        soft = self.settings.text("[TRAJ]PLANNER_TYPE") == "1"
        jerk = narrowest("MAX_JERK", min) if soft else None
        axis = ImportedAxis(
            letter=letter,
            lower=narrowest("MIN_LIMIT", max),
            upper=narrowest("MAX_LIMIT", min),
            speed=speed,
            acceleration=change or None,
            jerk=jerk or None,
            home=self._home(number, unit) if plain else None,
        )
        self._known(axis, letter)

    def _is_plain(self) -> bool:
        """Whether joints are axes."""
        return (self.settings.text("[KINS]KINEMATICS", "trivkins").split() or ["trivkins"])[0] in (*_PLAIN, *_NAMED)

    def _home(self, number: int, unit: float) -> float | None:
        home = self.settings.number(f"[JOINT_{number}]HOME")
        return None if home is None else home * unit

    def _known(self, axis: ImportedAxis, letter: str) -> None:
        """Keep an axis, or join it with one of the same letter; limits that are none are taken as such."""
        wrapped = self.settings.text(f"[AXIS_{letter}]WRAPPED_ROTARY").lower() in ("1", "yes", "true")
        far = axis.lower is None or axis.upper is None or axis.lower <= -_FAR or axis.upper >= _FAR
        if axis.turns and (wrapped or far):
            axis.lower = axis.upper = None
        elif far:
            axis.lower = -_TRAVEL if axis.lower is None or axis.lower <= -_FAR else axis.lower
            axis.upper = _TRAVEL if axis.upper is None or axis.upper >= _FAR else axis.upper
            axis.remark = "guessed where there is no limit"
        if axis.lower is not None and axis.upper is not None:
            if axis.lower == axis.upper:
                self._locked(letter)
                return
            if axis.lower > axis.upper:
                raise NoSettingsError(f"axis {letter} has limits from {written(axis.lower)} to {written(axis.upper)}")
            if axis.home is not None and not axis.lower <= axis.home <= axis.upper:
                axis.remark = f"its home, {written(axis.home)}, is outside of its limits"
                axis.home = None
        first = self.axes.get(letter)
        if first is None:
            self.axes[letter] = axis
            return
        first.remark = "two joints move it together"
        first.speed = min(first.speed, axis.speed)
        if first.lower is not None and axis.lower is not None:
            first.lower = max(first.lower, axis.lower)
        if first.upper is not None and axis.upper is not None:
            first.upper = min(first.upper, axis.upper)
        if first.acceleration is not None and axis.acceleration is not None:
            first.acceleration = min(first.acceleration, axis.acceleration)

    def _locked(self, letter: str) -> None:
        """An axis whose limits are one place: the machine has it wired, and does not move it."""
        for setting in self.settings.values(f"[AXIS_{letter}]MIN_LIMIT"):
            self.settings.leave(setting, f"axis {letter} has no room to move: the cell has none", matters=True)

    def _named(self, name: str, words: dict[str, str]) -> Iterator[str]:
        """The key `kinematics` of modules that a cell knows; others are told."""
        found = self.settings.last("[KINS]KINEMATICS")
        if name not in _NAMED:
            if name not in _PLAIN and found is not None:
                self.settings.leave(
                    found, "these kinematics are not known: axes move as a program sees them", matters=True
                )
                self.notes.append(f"the joints of {name} are not simulated: axes move as a program sees them")
            elif name == "corexykins":
                self.notes.append(
                    "X and Y are moved by two belts together: their motors may be slower in one direction"
                )
            return
        wanted = {"5axiskins": "BC", "maxkins": "BC"}.get(name, name[3:5].upper())
        if missing := [letter for letter in wanted if letter not in self.axes]:
            assert found is not None
            self.settings.leave(found, f"axis {missing[0]} of these kinematics is not there", matters=True)
            return
        keys = [f"type: {name}", *self._parameters(name)]
        if name == "maxkins" and len(keys) == 1 and found is not None:
            self.settings.leave(
                found, "no HAL file sets its pivot-length: axes move as a program sees them", matters=True
            )
            return
        if words.get("sparm") == "identityfirst":
            keys.append("identity_first: true")
        yield f"kinematics: {{{', '.join(keys)}}}"

    def _parameters(self, name: str) -> Iterator[str]:
        """What HAL files set of the module's pins."""
        told: dict[str, str] = {}
        for setting in [*self.settings.values("[HAL]HALFILE"), *self.settings.values("[HAL]HALCMD")]:
            file = self.path.parent / setting.value
            command = setting.name.upper().endswith("HALCMD")
            text = setting.value if command else read_text(file) if file.is_file() else ""
            self.settings.leave(setting, "wiring of the control; what it sets of the kinematics was read")
            told |= {found[1]: found[2] for found in _SETP.finditer(text)}
        for pin in _NAMED[name]:
            value = next((v for key, v in told.items() if key.endswith((f".{pin}", f".{pin.upper()}"))), None)
            if value is None:
                continue
            if (named := _OF_INI.fullmatch(value)) is not None:
                value = self.settings.text(f"[{named[1]}]{named[2]}")
            key = pin.replace("-", "_")
            if pin == "conventional-directions":
                yield f"{key}: {'true' if value in ('1', 'TRUE', 'true') else 'false'}"
            elif (number := number_in(value)) is not None:
                yield f"{key}: {written(number * self.unit)} mm"

    def _file(self, name: str, folder: Path) -> str:
        """A file that a setting names, seen from the cell; empty, and told, where it is not there or not below it."""
        setting = self.settings.last(name)
        if setting is None:
            return ""
        file = self.path.parent / setting.value
        seen = relative(file, folder) if file.is_file() else None
        if seen is None:
            why = "it is not in the folder of the cell" if file.is_file() else "the file is not there"
            self.settings.leave(setting, why, matters=file.is_file())
        return seen or ""

    def _parameter_file(self, folder: Path, lathe: bool) -> Iterator[str]:
        """The file itself; of one in inches, which a cell does not read, the work systems."""
        name = "[RS274NGC]PARAMETER_FILE"
        seen = self._file(name, folder)
        if seen and self.unit == 1.0:
            yield f"parameters: {quoted(seen)}"
            return
        systems = self._work_systems(self.path.parent / self.settings.text(name)) if seen else []
        if seen and (found := self.settings.last(name)) is not None:
            why = "it is in inches: the places of its work systems were taken, other parameters were not"
            self.settings.leave(found, why, matters=True)
        if systems:
            yield f"work_offsets: {{{', '.join(systems)}}}"
        elif not lathe:
            yield from zero_lines(self.axes)

    def _work_systems(self, file: Path) -> list[str]:
        """G54 to G59.3 where they are not at machine zero; what turns them is not taken."""
        values, _ = read_parameters(SourceText.read(file))
        systems = []
        for index in range(_SYSTEMS):
            places = [values.get(FIRST_SYSTEM + 20 * index + axis, 0.0) * self.unit for axis in range(3)]
            if any(places):
                name = f"G{54 + index}" if index < 6 else f"G59.{index - 5}"
                systems.append(f"{name}: {{xyz: [{', '.join(written(place) for place in places)} mm]}}")
        return systems

    def _subroutines(self, folder: Path) -> Iterator[str]:
        found = []
        for name in ("[RS274NGC]SUBROUTINE_PATH", "[DISPLAY]PROGRAM_PREFIX"):
            setting = self.settings.last(name)
            if setting is None:
                continue
            parts = [self.path.parent / part for part in setting.value.split(":") if part]
            seen = [relative(part, folder) for part in parts if part.is_dir()]
            below = [part for part in seen if part]
            found += [part for part in below if part not in found]
            if len(below) < len(parts):
                self.settings.leave(setting, "not all of these folders are there, below the cell", matters=True)
        if found:
            yield f"subroutines: [{', '.join(quoted(part) for part in found)}]"

    def _startup(self, inches: bool) -> Iterator[str]:
        """What is in force before each program: inches on a machine in inches, then the codes that the file gives."""
        setting = self.settings.last("[RS274NGC]RS274NGC_STARTUP_CODE")
        words, others = modal_words("" if setting is None else setting.value)
        if inches and not _UNITS.search(words):
            words = f"G20 {words}".strip()
        if words:
            yield f"startup: {words}"
        if setting is not None and others:
            why = f"these codes before each program move something or are no modes: write them into it: {others}"
            self.settings.leave(setting, why, matters=True)

    def _spindle(self) -> Iterator[str]:
        speeds = [
            self.settings.number(name)
            for name in ("[SPINDLE_0]MAX_FORWARD_VELOCITY", "[SPINDLE_0]MAX_VELOCITY", "[DISPLAY]MAX_SPINDLE_0_SPEED")
        ]
        there = [speed for speed in speeds if speed]
        if there:
            yield f"limits: {{spindle_speed: {written(min(there))} rpm}}"

    def _tools(self, folder: Path, inches: bool) -> Iterator[str]:
        setting = self.settings.last("[EMCIO]TOOL_TABLE")
        if setting is None:
            return
        file = self.path.parent / setting.value
        if not file.is_file():
            self.settings.leave(setting, "the file is not there", matters=True)
            return
        from gcodesim.starter.tool_files import read_tools

        if (seen := relative(file, folder)) and not inches:
            yield f"tool_table: {quoted(seen)}"
        if inches:
            self.settings.leave(
                setting, "it is in inches: lengths and diameters were taken, offsets were not", matters=True
            )
        found = read_tools(file, inch=inches)
        lines, known = [], set()
        for tool in found.tools:
            if tool.keys and tool.number not in known:
                known.add(tool.number)
                kept = {key: value for key, value in tool.keys.items() if key != "length" or not _stubby(tool.keys)}
                keys = ", ".join(f"{key}: {value}" for key, value in kept.items())
                remark = "" if kept == tool.keys else f"  # {tool.keys['length']} is too short for a body"
                lines.append(f"  {tool.number}: {{{keys}}}{remark}")
            elif tool.refused:
                why = next(iter(tool.notes), "refused")
                self.settings.leave(FoundSetting(f"tool T{tool.number}", tool.name, file.name, 0), why)
                self.settings.all.append(FoundSetting(f"tool T{tool.number}", tool.name, file.name, 0))
        if lines:
            yield "tools:  # of the tool table, which does not say what kind of tool each is"
            yield from lines


def _stubby(keys: Mapping[str, str]) -> bool:
    """Whether a tool is not even as long as it is thick: then its length in the table is not that of its body."""
    length, thick = (number_in(keys.get(name, "0").partition(" ")[0]) for name in ("length", "diameter"))
    return length is not None and thick is not None and length <= thick

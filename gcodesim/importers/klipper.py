"""A printer.cfg of Klipper as a cell. Facts: Klipper, `docs/Config_Reference.md`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar, Final

from gcodesim.importers.axes import ImportedAxis
from gcodesim.importers.importer import FoundSettings, Imported, Importer, NoSettingsError, heading, written
from gcodesim.importers.ini_file import read_klipper_config
from gcodesim.importers.printer import four, printer_lines

_CARTESIAN: Final = ("cartesian", "generic_cartesian", "corexy", "corexz", "hybrid_corexy", "hybrid_corexz", "none")
_ROUND: Final = ("delta", "rotary_delta", "polar", "deltesian", "winch")
_MOST_NOZZLES: Final = 16
_FAR: Final = 1e5  # mm beyond which a limit is none, as that of a belt that carries parts away
_TRAVEL: Final = 1000.0  # mm in its place
_OF_FILAMENT: Final = 1e6  # mm/s² that limit nothing

_REASONS: Final = (
    ("[gcode_macro", "a macro: a program that calls it has to say what it does", True),
    ("[delayed_gcode", "a macro", True),
    ("[homing_override", "homing", False),
    ("[include", "the file is not there", True),
    ("[printer]MAX_ACCEL_TO_DECEL", "short zigzags are not slowed down: they take longer on the printer", True),
    ("[printer]MINIMUM_CRUISE_RATIO", "short zigzags are not slowed down: they take longer on the printer", True),
    ("[extruder]PRESSURE_ADVANCE", "filament is not squeezed: SET_PRESSURE_ADVANCE is not simulated", True),
    ("[extruder]MAX_EXTRUDE", "the extruder has the limits that Klipper has by itself", True),
    ("[input_shaper", "vibrations are not simulated", False),
    ("[bed_mesh", "the bed is flat", False),
    ("[heater", "heat is not simulated", False),
    ("[extruder", "motor, heater and sensor of the extruder", False),
    ("[stepper", "motor and endstop", False),
    ("[carriage", "motor and endstop", False),
    ("[dual_carriage", "a second carriage: the cell has one", True),
    ("[extra_carriage", "motor and endstop", False),
    ("[fan", "heat is not simulated", False),
    ("[mcu", "electronics", False),
    ("[tmc", "electronics", False),
)


class Klipper(Importer):
    """`import klipper printer.cfg`."""

    kind: ClassVar[str] = "klipper"
    says: ClassVar[str] = "a printer.cfg: travel, speeds, accelerations, nozzles, filament"

    def read(self, path: Path, folder: Path) -> Imported:
        settings = FoundSettings(read_klipper_config(path))
        kinematics = settings.text("[printer]kinematics").lower()
        if not kinematics:
            raise NoSettingsError(f"{path} has no [printer] with kinematics: it is no configuration of Klipper")
        axes = _axes(settings, kinematics)
        if kinematics not in _CARTESIAN and (found := settings.last("[printer]kinematics")) is not None:
            settings.leave(found, "the carriages are not simulated: axes move as a program sees them", matters=True)
        nozzles: dict[int, tuple[float, float | None]] = {}
        for number in range(_MOST_NOZZLES):
            section = f"[extruder{number or ''}]"
            nozzle = settings.number(f"{section}nozzle_diameter")
            filament = settings.number(f"{section}filament_diameter")
            if nozzle:
                nozzles[number] = (nozzle, filament)
        printer = printer_lines("klipper", axes, nozzles, _limits(settings, axes))
        lines = [*heading(path, "the configuration of Klipper"), *printer]
        taken, left = settings.finished(_REASONS)
        return Imported(what="configuration of Klipper", lines=tuple(lines), taken=taken, left=left)


def _axes(settings: FoundSettings, kinematics: str) -> dict[str, ImportedAxis]:
    speed, change = settings.number("[printer]max_velocity"), settings.number("[printer]max_accel")
    if not speed or not change:
        raise NoSettingsError("[printer] needs max_velocity and max_accel")
    z_speed = settings.number("[printer]max_z_velocity") or speed
    z_change = settings.number("[printer]max_z_accel") or change
    axes: dict[str, ImportedAxis] = {}
    for letter in "XYZ":
        low, high = _travel(settings, letter, kinematics)
        axes[letter] = ImportedAxis(
            letter=letter,
            lower=low,
            upper=high,
            speed=min(speed, z_speed) if letter == "Z" else speed,
            acceleration=min(change, z_change) if letter == "Z" else change,
        )
    return axes


def _limits(settings: FoundSettings, axes: Mapping[str, ImportedAxis]) -> dict[str, str]:
    """Filament is as fast as the head beside it; moves that extrude and others have one acceleration."""
    speeds, changes = [axes[c].speed for c in "XYZ"], [axes[c].acceleration or 0.0 for c in "XYZ"]
    corner = settings.number("[printer]square_corner_velocity")
    all_moves = f"{written(max(changes))} mm/s^2"
    return {
        "speed": four([*speeds, max(speeds)], "mm/s"),
        "acceleration": four([*changes, _OF_FILAMENT], "mm/s^2"),
        **dict.fromkeys(("printing", "travel", "retracting"), all_moves),
        **({} if not corner else {"corner_speed": f"{written(corner)} mm/s"}),
    }


def _travel(settings: FoundSettings, letter: str, kinematics: str) -> tuple[float, float]:
    """Least and greatest place [mm]; of a delta, the circle that it prints on."""
    if kinematics in _ROUND:
        radius = settings.number("[printer]print_radius") or settings.number("[printer]delta_radius") or 100.0
        top = settings.number("[stepper_a]position_endstop") or 2.0 * radius
        least = settings.number("[printer]minimum_z_position") or 0.0
        return (least, top) if letter == "Z" else (-radius, radius)
    section = _carriage(settings, letter)
    low = settings.number(f"{section}position_min") or 0.0
    high = settings.number(f"{section}position_max")
    if high is None or high <= low:
        raise NoSettingsError(f"{section} has no position_max above {low:g}")
    if high > _FAR and (found := settings.last(f"{section}position_max")) is not None:
        settings.leave(found, f"so far moves nothing: the cell has {_TRAVEL:g} mm", matters=True)
        high = low + _TRAVEL
    return low, high


def _carriage(settings: FoundSettings, letter: str) -> str:
    """The section that says how far a carriage goes: of `generic_cartesian` the first with this axis."""
    for setting in settings.all:
        section, _, name = setting.name.partition("]")
        if section.startswith("[carriage ") and name.lower() == "axis" and setting.value.lower() == letter.lower():
            settings.take(setting)
            return f"{section}]"
    return f"[stepper_{letter.lower()}]"

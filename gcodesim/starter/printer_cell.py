"""A first cell for a printer's program: bed, nozzle, filament and axes from its moves and its slicer's comments."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.canon import Event, ToolNumber
from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.frozen import frozen
from gcodesim.motion.build import build_tool_path
from gcodesim.motion.tool_path import ZERO, ToolPath
from gcodesim.rs274 import Run, Settings, ToolEntry, ToolTable, interpret
from gcodesim.rs274.other_machines import foreign_of
from gcodesim.units import MM

Array = NDArray[np.float64]

_WIDE: Final = 2.0  # times the height: beads of clay and concrete, whose nozzles no slicer tells
_MOST_NOZZLES: Final = 16
_MARGIN: Final = 10.0 * MM  # of the bed around what is printed
_TRAVEL: Final = 20.0 * MM  # of the axes around what is moved
_BED: Final = 2.0 * MM  # thickness
_COLUMNS: Final = 2_000_000
_FINEST: Final = 0.1 * MM
_NOZZLE: Final = 0.4  # mm, the usual one
_FILAMENT: Final = 1.75  # mm
_WIDTHS: Final = ("extrusion_width", "line_width", "outer_wall_line_width", "extrusion_width_mm")
_CHANGES: Final = (
    ("filament_load_time", "filament_unload_time"),
    ("machine_load_filament_time", "machine_unload_filament_time", "machine_tool_change_time"),
)
"""What a change of filament takes [s], as PrusaSlicer and as Bambu Studio and OrcaSlicer name its parts."""
_NOZZLES: Final = ("nozzle_diameter", "nozzle_diameter_mm_0", "nozzle_dia_1")

_KLIPPER = re.compile(
    rb"^[ \t]*(?i:SET_VELOCITY_LIMIT|EXCLUDE_OBJECT\w*|START_PRINT|PRINT_START|SET_PRESSURE_ADVANCE|_\w+)\b"
    rb"|^;[ \t]*gcode_flavor = klipper|^;FLAVOR:Klipper",
    re.MULTILINE,
)
_REPRAP = re.compile(
    rb"^[ \t]*M(?:566|98 )|^[ \t]*(?:var|global)[ \t]+[A-Za-z]\w*[ \t]*=|^[ \t]*set[ \t]+(?:var|global)\."
    rb"|^;[ \t]*gcode_flavor = reprapfirmware\b",
    re.MULTILINE,
)
_CURAS_REPRAP = re.compile(rb"^;FLAVOR:RepRap", re.MULTILINE)
_SPRINTER = re.compile(
    rb"^;[ \t]*gcode_flavor = reprap\b"
    rb"|^;FLAVOR:RepRap(?=[^\x00]{0,400}?Cura_SteamEngine (?:[012]|1[0-9])\.)",
    re.MULTILINE,
)
"""What slicers called RepRap is Marlin's forerunner Sprinter: Slic3r and its like, whose `reprapfirmware` is the other
one (`s_keys_map_GCodeFlavor` of PrintConfig.cpp), and Cura before 3 (`EGCodeFlavor::REPRAP` of its settings.h)."""
_MARLIN = re.compile(rb"^;[ \t]*gcode_flavor = marlin\w*|^;FLAVOR:Marlin", re.MULTILINE)
_REPRAP_OR_BUDDY = re.compile(rb"^[ \t]*M(?:572|593)\b", re.MULTILINE)  # newer firmware of Marlin's kind has them, too
_SLICER = re.compile(
    rb"PrusaSlicer|OrcaSlicer|SuperSlicer|BambuStudio|Slic3r|Cura_SteamEngine|ideaMaker|Simplify3D|KISSlicer"
    rb"|Kiri:Moto|IceSL"
)
_E_MODE = re.compile(rb"^[ \t]*(?:N[0-9]+[ \t]*)?M8[23]\b", re.MULTILINE | re.IGNORECASE)
_STEPS: Final = "M83"
_EXTRUDES = re.compile(rb"^[ \t]*G0?1\b[^;\r\n]*[ \t]E-?[0-9.]", re.MULTILINE)
_BEAD = re.compile(rb"^[ \t]*G0?1[ \t][^;(\r\n]*Y-?[0-9.][^;(\r\n]*[ \t]E[0-9.]", re.MULTILINE)  # no lathe has Y


def is_print(program: SourceText) -> bool:
    """Whether a program is one for a printer: its heaters say so, its slicer, or beads in the plane."""
    foreign = foreign_of(program)
    if foreign is not None and foreign.kind != "script":  # `var x = 1` is a line of RepRapFirmware, too
        return foreign.kind == "printer"
    raw = program.raw
    return bool(_BEAD.search(raw) or (_EXTRUDES.search(raw) and (_SLICER.search(raw) or _KLIPPER.search(raw))))


@frozen
class PrinterCell:
    """What a print says about its printer; lengths [m]."""

    program: str
    dialect: str
    why: str
    failed: int
    path: ToolPath
    chosen: frozenset[int]
    settings: dict[str, str]
    counts_steps: bool
    """E words are steps, though the program does not say so: its start macro does."""

    @staticmethod
    def of(program: SourceText) -> PrinterCell:
        """From the moves of a program, up to its first error."""
        dialect, why = _dialect_of(program.raw)
        table = ToolTable({number: ToolEntry(number=number) for number in range(_MOST_NOZZLES)})
        settings = Settings(dialect=dialect, tool_table=table, has_cell=True)
        run, path, chosen = _reading(program, settings)
        counts_steps = False
        if not _E_MODE.search(program.raw) and any(f.code == "GS178" for f in run.findings):
            steps = _reading(program, replace(settings, startup=SourceText("startup", f"{_STEPS}\n".encode())))
            counts_steps = all(f.code != "GS178" for f in steps[0].findings)
            run, path, chosen = steps if counts_steps else (run, path, chosen)
        error = next((f.span.line for f in run.findings if f.level >= Severity.ERROR), 0)
        return PrinterCell(
            program=program.name,
            dialect=dialect,
            why=why,
            failed=error,
            path=path,
            chosen=frozenset(chosen),
            settings=_settings(program.raw),
            counts_steps=counts_steps,
        )

    @property
    def lays(self) -> bool:
        """Whether anything is laid."""
        return bool(self.laying.any())

    @property
    def laying(self) -> NDArray[np.bool_]:
        """The moves (n,) that lay something."""
        path = self.path
        moving = (path.start[:, :3] != path.end[:, :3]).any(axis=1)
        found: NDArray[np.bool_] = (path.extrude > 0.0) & moving
        return found

    def text(self) -> bytes:
        """The cell file."""
        height, width = self._size("height"), self._size("width")
        low, high = self._bed(max(width, height))
        all_low, all_high = self._box(np.ones(len(self.path), dtype=bool))
        area = float(np.prod(high[:2] - low[:2]))
        grain = max(_FINEST, 0.5 * height, float(np.sqrt(area / _COLUMNS)), min(width / 3.0, 0.5 * MM))
        lines = [
            f"# A cell for {self.program}, made from its moves, words and comments: look at every line.",
            "gcodesim: 1",
            f"dialect: {self.dialect:<10} # {self.why}",
        ]
        if self.counts_steps:
            lines.append(
                f"startup: {_STEPS}       # E words fall, so they are steps; a macro of the printer will say so"
            )
        if self.failed:
            lines.append(f"# line {self.failed} of the program has an error, so a run stops there: see `gcodesim lint`")
        lines += ["", "machine:  # the axes are fast, so that only the limits of the firmware count", "  axes:"]
        for k, letter in enumerate("XYZ"):
            least = min(all_low[k], low[k], 0.0) - _TRAVEL
            most = max(all_high[k], high[k], 0.0) + (_TRAVEL if k < 2 else 5.0 * _TRAVEL)
            lines.append(
                f"    {letter}: {{travel: [{_mm(least)}, {_mm(most)}], speed: 1000 mm/s, acceleration: 50 m/s^2}}"
            )
        corners = (f"{_mm(low[0])}, {_mm(low[1])}, {_mm(low[2])}", f"{_mm(high[0])}, {_mm(high[1])}, {_mm(high[2])}")
        lines += [
            "work_offsets: {G54: {xyz: [0, 0, 0]}}",
            "",
            f"# the bed{self._bed_told()}; what is laid beside it is not kept",
            f"stock: {{min: [{corners[0]}], max: [{corners[1]}], in: G54, resolution: {_mm(grain)}}}",
            "",
            "tools:",
        ]
        said = "as the comments say" if self._told("width") else "guessed"
        for number in self._nozzles():
            sizes = f"bead_width: {_mm(width)}, bead_height: {_mm(height)}"
            filament = f"filament_diameter: {self._filament(number):g}"
            lines.append(f"  {number}: {{type: extruder, {sizes}, {filament}, length: 40}}  # {said}")
        if self._change_time > 0.0 and len(self._nozzles()) > 1:
            lines += ["", f"magazine: {{change_time: {self._change_time:g} s}}  # of the filament, as the slicer says"]
        return ("\n".join(lines) + "\n").encode()

    @property
    def needs(self) -> list[tuple[str, str]]:
        """Rows of name and text: dialect, nozzles, bed, travel."""
        width, height = self._size("width"), self._size("height")
        low, high = self._bed(max(width, height))
        least, most = self._box(np.ones(len(self.path), dtype=bool))
        bed = f"{_mm(high[0] - low[0])} x {_mm(high[1] - low[1])} mm{self._bed_told()}"
        told = "" if self._told("width") else ", a guess"
        nozzles = [f"T{n}: an extruder, bead {_mm(width)} x {_mm(height)} mm{told}" for n in self._nozzles()]
        travel = ", ".join(f"{letter} {_mm(a)} to {_mm(b)} mm" for letter, a, b in zip("XYZ", least, most, strict=True))
        return [
            ("dialect", f"{self.dialect} ({self.why})"),
            *(("" if place else "tools", text) for place, text in enumerate(nozzles)),
            ("stock", f"a bed of {bed}"),
            ("travel", travel),
        ]

    @property
    def guesses(self) -> list[str]:
        """What is guessed, since the program does not tell."""
        guessed = [] if self._bed_shape() else ["the bed"]
        return guessed + ([] if self._told("width") else ["the width of beads"])

    def _box(self, rows: NDArray[np.bool_]) -> tuple[Array, Array]:
        points = np.concatenate([self.path.start[rows, :3], self.path.end[rows, :3]])
        return points.min(axis=0), points.max(axis=0)

    def _nozzles(self) -> list[int]:
        """Those that lay something, those that are only chosen, cleaned or primed, and T0, from which words count."""
        laying = distinct(self.path.state[self.laying]).tolist()
        return sorted({0}.union(self.chosen, (self.path.states[state].tool for state in laying)))

    def _bed(self, bead: float) -> tuple[Array, Array]:
        """Corners (3,) of the bed, whose top is Z0: as the slicer says, and at least around what is laid."""
        low, high = self._box(self.laying)
        low, high = np.floor((low - bead) / MM) * MM, np.ceil((high + bead) / MM) * MM
        corners = re.findall(r"(-?[0-9.]+)x(-?[0-9.]+)", self._bed_shape())
        if corners:
            points = np.array(corners, dtype=float) * MM
            low[:2], high[:2] = np.minimum(low[:2], points.min(axis=0)), np.maximum(high[:2], points.max(axis=0))
        else:
            low[:2], high[:2] = low[:2] - _MARGIN, high[:2] + _MARGIN
        low[2], high[2] = -_BED, 0.0
        return low, high

    def _bed_shape(self) -> str:
        return self.settings.get("bed_shape") or self.settings.get("printable_area", "")

    def _bed_told(self) -> str:
        return ", as the slicer says" if self._bed_shape() else ", guessed: a margin around what is laid"

    def _sections(self, of: str) -> tuple[Array, Array]:
        """The sizes [m] that comments name, and the filament that goes with each."""
        rows = np.flatnonzero(self.laying)
        sizes = np.array([getattr(s.section, of) if s.section is not None else 0.0 for s in self.path.states])
        values, weights = sizes[self.path.state[rows]], self.path.extrude[rows]
        return values[values > 0.0], weights[values > 0.0]

    def _told(self, of: str) -> bool:
        return bool(len(self._sections(of)[0]))

    def _size(self, of: str) -> float:
        """Width or height of the usual bead [m]: by comments, else by settings, else as printers are usually set."""
        values, weights = self._sections(of)
        if len(values):
            order = np.argsort(values, kind="stable")
            passed = np.cumsum(weights[order])
            return float(values[order][np.searchsorted(passed, 0.5 * passed[-1])])
        names = ("layer_height",) if of == "height" else _WIDTHS
        for name in names:
            if (number := _number(self.settings.get(name, ""))) > 0.0:
                return number * MM
        if of == "width":
            usual, height = 1.125 * (self._first(_NOZZLES) or _NOZZLE) * MM, self._size("height")
            return usual if usual >= height else _WIDE * height
        steps = np.diff(distinct(np.round(self.path.end[self.laying, 2] / MM, 4)))
        return float(np.median(steps)) * MM if len(steps) else 0.2 * MM

    def _first(self, names: Iterable[str]) -> float:
        """The first number that settings have under one of `names`; 0 if none has."""
        return next((number for name in names if (number := _number(self.settings.get(name, ""))) > 0.0), 0.0)

    @property
    def _change_time(self) -> float:
        """How long a change of filament takes [s]."""
        return max(sum(_number(self.settings.get(name, "")) for name in names) for names in _CHANGES)

    def _filament(self, number: int) -> float:
        """Diameter [mm] of the filament of a nozzle."""
        listed = self.settings.get("filament_diameter") or self.settings.get("filamentdiameters", "")
        told = re.split(r"[,;|]", listed)
        own = self._first((f"filament_diameter_#{number + 1}", f"filament_diameter_mm_{number}", "fiber_dia_mm"))
        return own or _number(told[number if number < len(told) else 0]) or _FILAMENT


def _reading(program: SourceText, settings: Settings) -> tuple[Run, ToolPath, set[int]]:
    """The program as it is read, its moves, and the tools that its lines choose."""
    run = interpret(program, settings)
    chosen: set[int] = set()
    path = build_tool_path(_choices(run.stream(), chosen), ZERO)
    return run, path, chosen


def _choices(events: Iterable[Event | MoveBatch], chosen: set[int]) -> Iterator[Event | MoveBatch]:
    """The events as they are; tools that lines of the program choose are put into `chosen`."""
    for event in events:
        if isinstance(event, ToolNumber) and event.span.line:
            chosen.add(event.tool)
        yield event


def _dialect_of(raw: bytes) -> tuple[str, str]:
    for name, pattern in (
        ("klipper", _KLIPPER),
        ("reprapfirmware", _REPRAP),
        ("marlin", _SPRINTER),
        ("reprapfirmware", _CURAS_REPRAP),
        ("marlin", _MARLIN),
        ("reprapfirmware", _REPRAP_OR_BUDDY),
    ):
        if match := pattern.search(raw):
            word = match[0].strip().decode("utf-8", "replace")
            return name, f"`{word}` in line {raw.count(b'%c' % 10, 0, match.start()) + 1}"
    return "marlin", "nothing in it is of another firmware"


def _settings(raw: bytes) -> dict[str, str]:
    """What slicers write as comments: `; name = value` (PrusaSlicer and its like), `;name: value`, `;  name,value`.

    The first one counts: a file may list the settings of each object after those of the first.
    """
    found: dict[str, str] = {}
    for name, value in re.findall(
        rb"^;[ \t]*([A-Za-z_ ]+?(?:#?[0-9]+)?)[ \t]*[=:,][ \t]*([^\r\n]*)", raw, re.MULTILINE
    ):
        found.setdefault(name.decode().strip().lower().replace(" ", "_"), value.decode("utf-8", "replace").strip())
    return found


def _number(text: str) -> float:
    """The number at the beginning of a text; 0 if there is none, or if it is a share of something else."""
    match = re.match(r"[0-9]*\.?[0-9]+(?![0-9.]*%)", text)
    return float(match[0]) if match else 0.0


def _mm(length: float) -> str:
    return f"{round(length / MM, 3) + 0.0:g}"

"""The cell: everything in it and every setting of a run, frozen, in SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Final

from gcodesim.cell.channel import Channel
from gcodesim.cell.device import DEVICES, Device
from gcodesim.cell.externals import External
from gcodesim.cell.film import NO_FILM, FilmSpec
from gcodesim.cell.machine import MachineKind, MachineTool
from gcodesim.cell.material import MaterialKind
from gcodesim.cell.own_code import CodeFile
from gcodesim.cell.packages import PackageFolder
from gcodesim.cell.part import PARTS, PartSpec
from gcodesim.cell.placing import MACHINE, Carried, Place, names_of
from gcodesim.cell.robot import Robot, RobotKind
from gcodesim.cell.sensors import SENSOR_MAP, MountedSensor
from gcodesim.cell.settings import (
    CODE_PATTERNS,
    Limits,
    LogSettings,
    Magazine,
    SeverityKind,
    Simulation,
    SpindleTimes,
    Suppression,
    Units,
    matches,
)
from gcodesim.cell.stock import Fixture, FixtureKind, StockKind, StockSpec, Target, ZoneShape
from gcodesim.cell.tooling import TOOL, TOOL_NUMBERS
from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.file_kind import FileValue
from gcodesim.declarations.files import InputFile
from gcodesim.declarations.form_version import form_version
from gcodesim.declarations.keys import inline, key
from gcodesim.declarations.map_of import MapOf, NameRule
from gcodesim.declarations.reading import Default, Path
from gcodesim.declarations.record import Record
from gcodesim.diagnostics import Findings, Severity, SourceText, Span
from gcodesim.frames import Pose
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.processes.materials import Material
    from gcodesim.tools.tool import Tool

MAIN: Final = "main"

_ANY_NAME: Final = NameRule(what="name", pattern=".+", canonical=lambda text: text.strip() or None)
_CHANNELS: Final = MapOf(
    names_of("channel"),
    Record(Channel, "the channel"),
    "channels by name, such as `main: {robot: arm, work_offsets: {G54: {in: table}}}`",
    lenient=True,
)
_FRAMES: Final = MapOf(
    names_of("frame"),
    Record(Place, "the frame"),
    "frames by name, such as `table: {in: world, xyz: [650, 0, 400]}`",
    lenient=True,
)
_ROBOTS: Final = MapOf(
    names_of("robot"), RobotKind(), "robots by name, such as `arm: {model: kuka_kr10_r1100_2}`", lenient=True
)
_EXTERNALS: Final = MapOf(
    names_of("external"),
    Record(External, "external axes"),
    "external axes by name, such as `rail: {carries: arm, axes: {U: {travel: [0, 3 m], speed: 1 m/s}}}`",
    lenient=True,
)
_TOOLS: Final = MapOf(
    TOOL_NUMBERS, TOOL, "tools by number, such as `1: {type: flat_end_mill, diameter: 10 mm}`", lenient=True
)
_ZONES: Final = MapOf(
    names_of("zone"),
    Record(ZoneShape, "the zone"),
    "zones by name, such as `handover: {box: [300, 300, 200], in: table}`",
    lenient=True,
)
_MATERIALS: Final = MapOf(
    _ANY_NAME, MaterialKind(), "materials by name, such as `beech: {kc11: 26 N/mm^2, mc: 0.3}`", lenient=True
)
_PACKAGES: Final = MapOf(_ANY_NAME, PackageFolder(), "folders by package name, such as `my_robot: ../my_robot`")
_CHECKS: Final = MapOf(CODE_PATTERNS, SeverityKind(), "severities by code, such as `GS9xx: error`")
_MAGAZINE: Final = Record(Magazine, "the magazine")
_SIMULATION: Final = Record(Simulation, "`simulation`")


@frozen
class Cell:
    """A cell as a YAML file describes it.

    Fields declared by `key` are keys of the file; those below are derived. `frames` gives X_W of every frame that
    stands still (`world`, those of `frames:`, `machine`, `<robot>/base`), `carried` the link of those that do not. In
    `robots` and `machine` the bases are resolved. Places of stock and target, which may depend on work offsets, are
    found by `placement.place`.
    """

    gcodesim: int = form_version("gcodesim", quiet=False)
    units: Units = key(Record(Units, "`units`"), "units of plain numbers", default=Units(), quiet=True)
    placed_frames: Mapping[str, Place] = key(
        _FRAMES, "frames, in the world or on a link", name="frames", default={}, quiet=True
    )
    machine: MachineTool | None = key(MachineKind(), "a machine tool", default=None)
    robots: Mapping[str, Robot] = key(_ROBOTS, "robots", default={}, quiet=True)
    externals: Mapping[str, External] = key(
        _EXTERNALS, "axes that carry a robot or the work, moved by its program", default={}, quiet=True
    )
    channels: Mapping[str, Channel] = key(
        _CHANNELS, "one program each; that of a run is for `main`, or else for the first", default={}, quiet=True
    )
    only_channel: Channel | None = inline(Channel, always=False)
    tools: Mapping[int, Tool] = key(_TOOLS, "tools by number", default={}, quiet=True)
    magazine: Magazine = key(
        _MAGAZINE, "where tools wait, and how long a change takes", default=Magazine(place=Place())
    )
    stocks: Mapping[str, StockSpec] = key(StockKind(), "material to work on", name="stock", default={}, quiet=True)
    materials: Mapping[str, Material] = key(_MATERIALS, "custom materials", default={}, quiet=True)
    target: Target | None = key(
        Record(Target, "the target"),
        "the part as it is meant to become; a run compares with it what is left of the stock",
        default=None,
    )
    fixtures: Mapping[str, Fixture] = key(FixtureKind(), "bodies that must not be touched", default={}, quiet=True)
    parts: Mapping[str, PartSpec] = key(PARTS, "rigid things that are carried", default={}, quiet=True)
    devices: Mapping[str, Device] = key(
        DEVICES, "clamps, doors, feeders, conveyors that words switch", default={}, quiet=True
    )
    zones: Mapping[str, ZoneShape] = key(
        _ZONES, "spaces in which only one machine may be at a time", default={}, quiet=True
    )
    sensors: Mapping[str, MountedSensor] = key(
        SENSOR_MAP, "what sees and feels, at rest or on a link", default={}, quiet=True
    )
    spindle: SpindleTimes = key(
        Record(SpindleTimes, "the spindle"), "how long the spindle takes", default=SpindleTimes(), quiet=True
    )
    limits: Limits = key(Record(Limits, "`limits`"), "limits of spindle and process", default=Limits(), quiet=True)
    checks: Mapping[str, Severity] = key(_CHECKS, "severities that differ in this cell", default={}, quiet=True)
    suppress: tuple[Suppression, ...] = key(
        ListOf(Record(Suppression, "the entry")), "findings that somebody has looked at", default=(), quiet=True
    )
    packages: Mapping[str, FileValue] = key(_PACKAGES, "folders for package:// names", default={}, quiet=True)
    code: tuple[FileValue, ...] = key(
        ListOf(CodeFile("a Python file"), single=True),
        "Python files that add tools, processes and more; only `--allow-code` runs them",
        default=(),
        quiet=True,
    )
    simulation: Simulation = key(_SIMULATION, "world, time step and seed", default=Simulation())
    log: LogSettings = key(Record(LogSettings, "`log`"), "how densely the run is recorded", default=LogSettings())
    name: str = ""
    frames: Mapping[str, Pose] = field(default_factory=dict, compare=False)
    carried: Mapping[str, Carried] = field(default_factory=dict, compare=False)
    spans: Mapping[Path, Span] = field(default_factory=dict, compare=False, repr=False)
    defaults_used: tuple[Default, ...] = field(default=(), compare=False, repr=False)

    def span(self, *path: str | int) -> Span:
        """The place of `path` in the file, such as ``span("tools", 7, "diameter")``; else of what is around it."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.spans:
                return self.spans[path[:length]]
        return Span(self.name)

    def severity(self, code: str) -> Severity | None:
        """What `checks` says for a code; the most specific pattern counts. None: as in the catalogue."""
        found = [pattern for pattern in self.checks if matches(pattern, code)]
        return self.checks[max(found, key=lambda p: len(p.rstrip("x")))] if found else None

    def material(self, stock: StockSpec) -> Material | None:
        """The material of a stock: one of `materials`, else of the library; None if it names none."""
        if stock.material is None:
            return None
        from gcodesim.processes.materials import LIBRARY

        return self.materials.get(stock.material) or LIBRARY[stock.material]

    def machine_of(self, channel: str = MAIN) -> MachineTool | Robot:
        """What the channel's program moves."""
        name = self.channels[channel].robot
        if name is None or name == MACHINE:
            assert self.machine is not None
            return self.machine
        return self.robots[name]

    @property
    def coats(self) -> Mapping[str, FilmSpec]:
        """What is asked of the film on each body that a spray gun of this cell may coat, by `stock/plate` and such."""
        from gcodesim.tools.spray_gun import SprayGun

        if not any(isinstance(tool, SprayGun) for tool in self.tools.values()):
            return {}
        stocks = {f"stock/{name}": stock.film or NO_FILM for name, stock in self.stocks.items()}
        parts = {f"part/{name}": part.film or NO_FILM for name, part in self.parts.items()}
        fixtures = {f"fixture/{name}": each.film for name, each in self.fixtures.items() if each.film is not None}
        return {**stocks, **parts, **fixtures}

    @property
    def platforms(self) -> dict[str, Pose]:
        """X_WC of all that external axes carry, with these at zero, by the names of the links: `arm/positioner`."""
        found = {link: X for robot in self.robots.values() for link, X in robot.platforms.items()}
        return found if self.machine is None else found | self.machine.platforms

    @property
    def link_names(self) -> tuple[str, ...]:
        """All links of its robots and its machine, by their names in the log: `arm/flange`, `machine/table`."""
        movers = ([(MACHINE, self.machine)] if self.machine is not None else []) + [*self.robots.items()]
        return tuple(f"{name}/{link}" for name, mover in movers for link in mover.link_names)

    def channel_span(self, channel: str, *path: str | int) -> Span:
        """The place of a key of a channel: under `channels`, or at top level in a cell with one robot."""
        nested = ("channels", channel, *path)
        return self.span(*nested) if nested[:2] in self.spans else self.span(*path)


@frozen
class LoadedCell:
    """The result of reading a cell.

    `cell` is None when a finding is an error; `files` are all inputs with hashes, the cell first. A cell that was
    `made` from the program is no file: a run writes it into its folder.
    """

    cell: Cell | None
    findings: Findings
    sources: Mapping[str, SourceText]
    files: tuple[InputFile, ...]
    path: FilePath
    made: bool = False

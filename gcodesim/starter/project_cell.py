"""A cell for a project of CAMotics: machine and dialect as its programs suggest them, stock and tools as it says."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from gcodesim.declarations.units import find
from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.rs274 import read_program
from gcodesim.starter.first_cell import FirstCell, FirstTool, NoCellError
from gcodesim.starter.scan import ScannedTool
from gcodesim.starter.tool_files import ToolFile, ToolFileError, read_tools
from gcodesim.starter.tool_keys import ReadTool
from gcodesim.units import INCH, MM

SUFFIX: Final = ".camotics"
_SCRIPT: Final = ".tpl"
_ENDS: Final = ("M2", "M02", "M30", "%")


@frozen
class Project:
    """A project: its `programs`, which lie beside or below it, and what it says of tools, stock and `cell` [m]."""

    name: str
    programs: tuple[Path, ...]
    told: ToolFile
    corners: tuple[tuple[float, float, float], tuple[float, float, float]] | None
    cell: float | None


def read_project(path: Path) -> Project:
    """The project at `path`; OSError, or NoCellError: it names no program that can be read here."""
    try:
        told = read_tools(path)
        content: dict[str, Any] = json.loads(path.read_bytes().decode("utf-8-sig"))
    except ToolFileError as reason:
        raise NoCellError(str(reason)) from None
    programs = []
    for entry in content.get("files", ()):
        name = entry.get("filename", "") if isinstance(entry, dict) else str(entry)
        program = path.parent / name
        if not program.resolve().is_relative_to(path.parent.resolve()):
            raise NoCellError(f"{path.name} names `{name}`, which is outside of its folder")
        if program.suffix.lower() == _SCRIPT:
            made = f"run `tplang {name} > {program.stem}.nc` of CAMotics"
            raise NoCellError(f"{name} is a script that makes G-code: {made}, and name that file in {path.name}")
        if not program.is_file():
            raise NoCellError(f"{path.name} names `{name}`, which is not there")
        programs.append(program)
    if not programs:
        raise NoCellError(f"{path.name} names no program")
    return Project(
        name=path.name,
        programs=tuple(programs),
        told=told,
        corners=_corners(content),
        cell=_resolution(content),
    )


def cell_of_project(project: Project) -> bytes:
    """The cell in which all programs of a project run; NoCellError for a program that no dialect can read."""
    first = FirstCell.of(_joined(project))
    unit = INCH if first.found.inch else MM
    corners = first.found.corners
    if project.corners is not None:
        (x, y, z), (a, b, c) = project.corners
        corners = ((x / unit, y / unit, z / unit), (a / unit, b / unit, c / unit))
    own = [tool for tool in project.told.tools if tool.keys]
    known = {tool.number for tool in own}
    called = [tool for tool in first.tools if tool.scanned.line or tool.scanned.number in first.seen.called]
    guessed = [tool for tool in called if tool.scanned.number not in known]
    tools = [*(_measured(tool) for tool in own), *guessed]
    made = replace(first, found=replace(first.found, corners=corners), tools=tools)
    return _CellOfProject(
        program=made.program,
        found=made.found,
        seen=made.seen,
        tools=made.tools,
        beam=None,  # CAMotics knows mills alone
        project=project,
        own=tuple(own),
    ).text()


@frozen
class _CellOfProject(FirstCell):
    """`own` are the tools that the project says; further ones of `tools` are guesses from the program."""

    project: Project
    own: tuple[ReadTool, ...]

    def stock(self) -> list[str]:
        size = "" if self.project.cell is None else f", resolution: {self.project.cell / MM:g} mm"
        lines = FirstCell.stock(self)  # not `super`: a class with slots is made anew
        source = "# size and resolution as the project has them; put in the material"
        if self.project.corners is None:
            source = lines[0]
        return [source, *(line.replace(", material:", f"{size}, material:") for line in lines[1:])]

    def tools_lines(self) -> list[str]:
        refused = [f"# T{tool.number}: {tool.notes[0]}" for tool in self.project.told.tools if not tool.keys]
        lines = [f"# from {self.project.name}, a {self.project.told.what}", *refused, "tools:"]
        for tool in self.own:
            lines += [f"  # {note}" for note in tool.notes]
            lines.append(f"  {tool.number}: {{{', '.join(f'{key}: {value}' for key, value in tool.keys.items())}}}")
        numbers = {tool.number for tool in self.own}
        rest = [tool for tool in self.tools if tool.scanned.number not in numbers]
        return [*lines, *(replace(self, tools=rest).guesses() if rest else [])]

    def guesses(self) -> list[str]:
        """Lines of tools that the program calls and the project does not have."""
        return FirstCell.tools_lines(self)[1:]


def _measured(tool: ReadTool) -> FirstTool:
    diameter = tool.keys.get("diameter", "6 mm").split()
    unit = find(diameter[1], "length")
    scanned = ScannedTool(number=tool.number, line=0, type=tool.keys["type"])
    return FirstTool(
        scanned=scanned, diameter=float(diameter[0]) * (MM if unit is None else unit.factor), guessed=False
    )


def _joined(project: Project) -> SourceText:
    """All programs as one, without the ends between them, to see what they ask of a machine."""
    texts = [read_program(program) for program in project.programs]
    if len(texts) == 1:
        return texts[0]
    lines = [line for text in texts for line in text.lines if line.strip().upper() not in _ENDS]
    return SourceText(texts[0].name, "\n".join([*lines, ""]).encode())


def _corners(content: dict[str, Any]) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
    workpiece = content.get("workpiece")
    bounds = workpiece.get("bounds") if isinstance(workpiece, dict) and not workpiece.get("automatic") else None
    if not isinstance(bounds, dict):
        return None
    both = []
    for name in ("min", "max"):
        corner = bounds.get(name)
        if not isinstance(corner, list) or len(corner) != 3 or not all(isinstance(v, int | float) for v in corner):
            return None
        both.append((corner[0] * MM, corner[1] * MM, corner[2] * MM))
    return (both[0], both[1]) if all(a < b for a, b in zip(*both, strict=True)) else None


def _resolution(content: dict[str, Any]) -> float | None:
    value = content.get("resolution")
    return float(value) * MM if isinstance(value, int | float) and value > 0 else None

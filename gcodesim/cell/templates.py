"""What `gcodesim init` writes: a first program with its cell, or a cell for a program that is there."""

from __future__ import annotations

from importlib.resources import files
from typing import Final

from gcodesim.cell.program_scan import Scan, ScannedTool, scan
from gcodesim.diagnostics import SourceText

PROGRAM: Final = "part.nc"
CELL: Final = "cell.yaml"


def start_files() -> dict[str, bytes]:
    """Contents of a first program and its cell by file name; they run as they are."""
    folder = files("gcodesim") / "data" / "init"
    return {name: (folder / name).read_bytes() for name in (PROGRAM, CELL)}


def cell_for(program: SourceText) -> bytes:
    """A cell for `program`: machine, stock and tools as far as its words and comments tell, the rest to fill in."""
    found = scan(program)
    unit = "in" if found.inch else "mm"
    lines = [
        f"# A cell for {program.name}, made from its words and comments: look at every line.",
        "# `gcodesim cell validate cell.yaml` says what is still missing.",
        "gcodesim: 1",
        *(["units: {length: in}"] if found.inch else []),
        "machine: gantry_xyz",
        "",
        *_stock_lines(found),
        "",
        "tools:" if found.tools else "# no T word was found, so nothing acts:\n# tools:",
    ]
    for tool in found.tools:
        lines += _tool_lines(tool, unit)
    if not found.tools:
        lines.append("#   1: {type: flat_end_mill, diameter: 6 mm}")
    return ("\n".join(lines) + "\n").encode()


def _stock_lines(found: Scan) -> list[str]:
    if found.stock is not None:
        size = ", ".join(f"{side:g}" for side in found.stock)
        return [
            f"# size from line {found.stock_line}; zero and material are guesses",
            f"stock: {{box: [{size}], zero: top-front-left, material: al6082_t6}}",
        ]
    if found.lower is None or found.upper is None:
        return ["# stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6}"]
    low = ", ".join(f"{v:g}" for v in found.lower)
    high = ", ".join(f"{v:g}" for v in found.upper)
    return [
        "# from the least and greatest X, Y, Z of the program, top at Z0: put in the real size and material",
        f"stock: {{min: [{low}], max: [{high}], material: al6082_t6}}",
    ]


def _tool_lines(tool: ScannedTool, unit: str) -> list[str]:
    asked = "" if tool.diameter is not None else "; fill in its diameter"
    source = f"line {tool.line}: {tool.comment}{asked}" if tool.comment else f"called in line {tool.line}{asked}"
    values = [f"type: {tool.type}"]
    values.append(f"diameter: {tool.diameter:g} {unit}" if tool.diameter is not None else "diameter: ")
    if tool.corner_radius:
        values.append(f"corner_radius: {tool.corner_radius:g} {unit}")
    if tool.point_angle is not None:
        values.append(f"point_angle: {tool.point_angle:g} deg")
    return [f"  # {source}", f"  {tool.number}: {{{', '.join(values)}}}"]

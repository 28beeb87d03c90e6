"""The reference job: a finishing raster of short chords, and the cells that it runs in."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

BLOCKS = 20_000
"""Feed blocks of the job, about 606 s of machine time."""

CHORD = 1.0  # mm
STEP_OVER = 0.3  # mm
ROWS_OF_LAYER = 200
CHORDS_OF_ROW = 100

_STOCK = "stock: {{box: [100, 60, 20], {place}, material: al6082_t6, resolution: 0.25}}\n"
_TOOLS = "tools: {1: {type: ball_end_mill, diameter: 6, flutes: 2, length: 60}}\n"
_STEPS = "simulation: {rate: 250 Hz}\nlog: {period: 20 ms}\n"

CELLS = {
    "gantry": "gcodesim: 1\nmachine: gantry_xyz\n" + _STOCK.format(place="zero: top-front-left") + _TOOLS + _STEPS,
    "kr10": (
        "gcodesim: 1\nframes: {table: {in: world, xyz: [520, -30, 250]}}\n"
        "robots: {arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}\n"
        "work_offsets: {G54: {in: table, xyz: [0, 0, 20]}}\n"
        "orientation: {tool_axis: -Z of G54, spin: free}\n"
        + _STOCK.format(place="in: table, zero: bottom-front-left")
        + _TOOLS
        + _STEPS
    ),
}


def depth(x: float, y: float) -> float:
    """Height of the tool tip over the block's top at x, y; all in mm."""
    return -4.0 + 1.3 * math.sin(x / 9.0) * math.cos(y / 11.0) + 0.6 * math.sin((x + y) / 5.0)


def lines(blocks: int = BLOCKS) -> Iterator[str]:
    """The program, line by line: rows to and fro; when the surface is done, the same again 1 mm deeper."""
    yield from ("%", "(reference job: finishing raster)", "G21 G90 G17 G40 G94 G64 P0.005")
    yield from ("T1 M6", "G43 H1", "S18000 M3", "G0 Z5")
    done = 0
    for row in range(-(-blocks // CHORDS_OF_ROW)):
        layer, line = divmod(row, ROWS_OF_LAYER)
        y = (line + 0.5) * STEP_OVER
        places = [i * CHORD for i in range(CHORDS_OF_ROW + 1)]
        if row % 2:
            places.reverse()
        heights = [depth(x, y) - layer for x in places]
        if line == 0:
            if row:
                yield "G0 Z5"
            yield f"G0 X{places[0]:.0f}. Y{y:.3f}"
            yield f"G1 Z{heights[0]:.4f} F600"
            yield "F2000"
        else:
            yield f"G1 Y{y:.3f} Z{heights[0]:.4f}"
        for x, z in zip(places[1:], heights[1:], strict=True):
            yield f"G1 X{x:.0f}. Z{z:.4f}"
            done += 1
            if done == blocks:
                break
    yield from ("G0 Z5", "M5", "M2", "%")


def moves(blocks: int = BLOCKS) -> Iterator[str]:
    """The program without its tool, which needs no cell."""
    return (line for line in lines(blocks) if line not in ("T1 M6", "G43 H1"))


def write(folder: Path, cell: str, blocks: int = BLOCKS) -> tuple[Path, Path]:
    """Program and cell as files in `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    program, place = folder / "reference.nc", folder / f"{cell}.yaml"
    program.write_text("\n".join(lines(blocks)) + "\n")
    place.write_text(CELLS[cell])
    return program, place

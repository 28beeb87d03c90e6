"""Two programs at once in one cell, beside the slower of them alone: whole processes, kinematic.

    python -m benchmarks.channels [LAYERS [CASE ...]]

A case is a cell of two machines and a program for each. Both run together, then each by itself, where the other machine
stands still and waits are gone; the ratio is processor time of both over that of the slower one.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from benchmarks.reference import run

GOAL = 2.3
_START = "G21 G90 G17 G94 G64 P0.02\nT{tool} M6\nG43 H{tool}\nS9000 M3\n"
_END = "M5\nM2\n"
_MILLS = (
    "tools:\n  1: {type: flat_end_mill, diameter: 10, flutes: 3, length: 60}\n"
    "  2: {type: flat_end_mill, diameter: 8, flutes: 3, length: 60}\n"
)
_ARMS = (
    "frames: {table: {in: world, xyz: [770, 0, 300]}}\nrobots:\n  left: {model: kuka_kr10_r1100_2}\n"
    "  right: {model: kuka_kr10_r1100_2, base: {in: world, xyz: [1540, 0, 0], rpy: [0, 0, 180]}}\n"
)
_BLOCK = (
    "stock:\n  block: {box: [400, 60, 40], in: table, zero: top-front-left, xyz: [-200, -30, 0],"
    " material: al6082_t6, resolution: 0.5}\n"
)


class Case(NamedTuple):
    """What stands in the cell, machine and work of both channels, and the lines of both programs."""

    cell: str
    machines: tuple[str, str]
    work: tuple[str, str]
    programs: tuple[str, str]


def raster(tool: int, x: tuple[float, float], layers: int, *, between: str = "", deep: float = 1.0) -> str:
    """A program that mills rows across the block from `x[0]` to `x[1]`; `between` stands after each layer."""
    lines = [_START.format(tool=tool), f"G0 X{x[0]} Y-40 Z30\n", "M200\n"]
    count = 8
    for layer in range(layers):
        lines.append(f"G0 X{x[0]} Y-40 Z10\nG1 Z{-deep * (layer % 8 + 1):.3f} F1200\n")
        for row in range(count):
            at = x[0] + (x[1] - x[0]) * row / (count - 1)
            lines.append(f"G1 X{at:.3f}\nG1 Y{40 if row % 2 == 0 else -40} F1500\n")
        lines.append(f"G0 Z30\n{between}")
    return "".join(lines) + "G0 Z60\nM201\n" + _END


def through_each_other(layers: int) -> Case:
    """Both mill rows between the same places at the same time."""
    cell = _ARMS + _MILLS + _BLOCK
    programs = raster(1, (-40, 40), layers), raster(2, (40, -40), layers)
    return Case(cell, ("left", "right"), ("table", "table"), programs)


def in_turn(layers: int) -> Case:
    """One mills a layer while the other waits beside the block."""
    lines = _START + "G0 X{x} Y-40 Z30\nM200\n"
    left, right = [lines.format(tool=1, x=-150)], [lines.format(tool=2, x=150)]
    for layer in range(layers):
        for mine, other, side in ((left, right, -1), (right, left, 1)):
            z = -0.5 * (layer % 8 + 1)
            mine.append(f"G0 X{30 * side} Y-40 Z10\nG1 Z{z:.3f} F1200\n")
            mine += [f"G1 X{(30 - 10 * row) * side}\nG1 Y{40 if row % 2 == 0 else -40} F1500\n" for row in range(7)]
            mine.append(f"G0 Z30\nG0 X{150 * side}\nM202\n")
            other.append("M202\n")
    programs = "".join(left) + "M201\n" + _END, "".join(right) + "M201\n" + _END
    return Case(_ARMS + _MILLS + _BLOCK, ("left", "right"), ("table", "table"), programs)


def halves(layers: int) -> Case:
    """Each mills its half of the block."""
    programs = raster(1, (-180, -90), layers), raster(2, (180, 90), layers)
    return Case(_ARMS + _MILLS + _BLOCK, ("left", "right"), ("table", "table"), programs)


def airspace(layers: int) -> Case:
    """Both go to and fro over the same place and cut nothing."""
    programs = tuple(
        _START.format(tool=tool)
        + f"G0 X{-side * 40} Y-40 Z150\nM200\n"
        + "".join(f"G1 X{40 * side} Y{40 - row} F3000\nG1 X{-40 * side} Y{-40 + row}\n" for row in range(8 * layers))
        + "M201\n"
        + _END
        for tool, side in ((1, 1), (2, -1))
    )
    return Case(_ARMS + _MILLS, ("left", "right"), ("table", "table"), (programs[0], programs[1]))


def beside(layers: int) -> Case:
    """Both go to and fro over the same places, a hand's breadth from each other, and cut nothing."""
    programs = tuple(
        _START.format(tool=tool)
        + f"G0 X{-side * 40} Y{-side * 130} Z150\nM200\n"
        + "".join(
            f"G1 X{40 * side} Y{-side * (130 - row % 16)} F3000\nG1 X{-40 * side} Y{-side * (130 - row % 16)}\n"
            for row in range(8 * layers)
        )
        + "M201\n"
        + _END
        for tool, side in ((1, 1), (2, -1))
    )
    return Case(_ARMS + _MILLS, ("left", "right"), ("table", "table"), (programs[0], programs[1]))


def _on_disc(radius: float, angle: float) -> str:
    """X and Y of a point [mm] at an angle [deg]."""
    return f"X{radius * math.cos(math.radians(angle)):.3f} Y{radius * math.sin(math.radians(angle)):.3f}"


def positioner(layers: int) -> Case:
    """One arm turns a table and mills, the other mills on it while it stands."""
    cell = (
        _ARMS.replace("770", "850").replace("1540", "1700")
        + "externals:\n  turned:\n    robot: left\n    base: {in: world, xyz: [850, 0, 280]}\n"
        "    axes: {C: {travel: unlimited, speed: 60 deg/s, acceleration: 120 deg/s^2}}\n"
        + _MILLS
        + "stock:\n  disc: {cylinder: [240, 30], in: turned, zero: top-center, material: al6082_t6, resolution: 0.5}\n"
    )
    programs = []
    for tool, side in ((1, 180.0), (2, 0.0)):
        lines = [_START.format(tool=tool), f"G0 {_on_disc(135, side)} Z60{' C0' if tool == 1 else ''}\n"]
        for layer in range(layers):
            turned = 90.0 * layer
            lines.append(f"G0 {_on_disc(135, side - turned)} Z60 C{turned:.0f}\nM200\n" if tool == 1 else "M200\n")
            for row in range(4):
                at = side - turned + 3.0 * row
                lines.append(f"G0 {_on_disc(135, at)} Z2\nG1 Z-2 F900\nG1 {_on_disc(70, at)}\nG0 Z20\n")
            lines.append(f"G0 {_on_disc(135, side - turned)} Z60\nM201\n")
        programs.append("".join(lines) + _END)
    return Case(cell, ("left", "right"), ("turned", "turned"), (programs[0], programs[1]))


def mill_and_loader(layers: int) -> Case:
    """A gantry mills while an arm beside it goes between two places; they meet after each layer."""
    cell = (
        "machine: gantry_xyz\nframes: {table: {in: world, xyz: [300, 300, -250]},"
        " store: {in: world, xyz: [1700, 300, -100]}}\n"
        "robots:\n  loader: {model: kuka_kr10_r1100_2, base: {in: world, xyz: [1150, 300, -300]}}\n"
        + _MILLS
        + "stock: {block: {box: [200, 60, 40], in: table, zero: top-front-left, xyz: [-100, -30, 0],"
        " material: al6082_t6, resolution: 0.5}}\n"
    )
    mill = raster(1, (-80, 80), layers, between="M202\n")
    load = _START.format(tool=2) + "G0 X0 Y-200 Z100\nM200\n"
    for _ in range(layers):
        load += "".join(f"G0 X{100 - 20 * k} Y-200 Z100\nG1 X100 Y200 Z60 F6000\n" for k in range(6)) + "M202\n"
    return Case(cell, ("machine", "loader"), ("table", "store"), (mill, load + "M201\n" + _END))


def of_two_lengths(layers: int) -> Case:
    """Halves of one block, one of them with a quarter of the layers."""
    programs = raster(1, (-180, -90), layers), raster(2, (180, 90), max(layers // 4, 1))
    return Case(_ARMS + _MILLS + _BLOCK, ("left", "right"), ("table", "table"), programs)


CASES: dict[str, Callable[[int], Case]] = {
    "through_each_other": through_each_other,
    "in_turn": in_turn,
    "halves": halves,
    "airspace": airspace,
    "beside": beside,
    "positioner": positioner,
    "mill_and_loader": mill_and_loader,
    "of_two_lengths": of_two_lengths,
}


def cell_of(case: Case, chosen: tuple[int, ...]) -> str:
    """The cell with the channels of some of the machines; one alone waits for nobody."""
    marks = ", m_codes: {M200: {wait: start}, M201: {wait: end}, M202: {wait: turn}}" if len(chosen) > 1 else ""
    lines = "gcodesim: 1\n" + case.cell + "channels:\n"
    for number, channel in zip(chosen, ("main", "other"), strict=False):
        machine, work = case.machines[number], case.work[number]
        lines += f"  {channel}: {{robot: {machine}, work_offsets: {{G54: {{in: {work}}}}}{marks}}}\n"
    return lines


def spent(folder: Path, case: Case, chosen: tuple[int, ...]) -> float:
    """Processor time [s] of a run with some of the programs."""
    cell = folder / "cell.yaml"
    cell.write_text(cell_of(case, chosen))
    names = [folder / f"{case.machines[number]}.nc" for number in chosen]
    for name, number in zip(names, chosen, strict=True):
        lines = case.programs[number].splitlines(keepends=True)
        name.write_text("".join(line for line in lines if len(chosen) > 1 or not line.startswith("M20")))
    order = [
        "gcodesim",
        "run",
        str(names[0]),
        "--cell",
        str(cell),
        "--world",
        "kinematic",
        "--out",
        str(folder / "out"),
    ]
    return run([*order, *(f"--channel=other={name}" for name in names[1:])])[1]


def main(layers: int = 12, *names: str) -> None:
    run(["gcodesim", "warm-up"])  # so that no compiling is timed
    for name in names or CASES:
        case = CASES[name](layers)
        with tempfile.TemporaryDirectory() as folder:
            both, *alone = (spent(Path(folder), case, chosen) for chosen in ((0, 1), (0,), (1,)))
        print(
            f"{name:20} {both:7.2f} s together, {alone[0]:6.2f} and {alone[1]:6.2f} s alone:"
            f" {both / max(alone):5.2f} x the slower   goal {GOAL} x",
            flush=True,
        )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]), *sys.argv[2:])

"""Reading, planning and timing of blocks of 1 mm with leaning vectors on an arm.

    python -m benchmarks.planning [BLOCKS]

Once around a part of the circle about the foot of a UR10e, where one spin of the tool does, and once nearly twice
around it, where the tool has to turn along the path. `planning` is `plan_path`: joints, caps and the law of time.
"""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs import legs
from gcodesim.simulation import Options, prepare

_RADIUS, _SWAY, _LEAN = 600.0, 50.0, math.radians(15.0)
_CELL = (
    "gcodesim: 1\ndialect: fanuc\nrobots:\n  arm: {model: ur10e, stiffness: rigid}\n"
    "work_offsets: {G54: {in: world, xyz: [0, 0, 150]}}\n"
    "tools:\n  1: {type: ball_end_mill, diameter: 8, flutes: 2, length: 60}\n"
)


def program(blocks: int, turns: float) -> str:
    """A wave around the foot of the arm, with the tool leaning to and fro across it."""
    lines = ["%", "O1", "G21 G90 G49 G94 G54", "T1 M6", "S12000 M3", "G43.5 H1"]
    for k in range(blocks + 1):
        around, wave = 2.0 * math.pi * turns * k / blocks, 2.0 * math.pi * k / 200.0
        c, s = math.cos(around), math.sin(around)
        radius, lean = _RADIUS + _SWAY * math.sin(wave), _LEAN * math.cos(wave)
        at = f"X{radius * c:.4f} Y{radius * s:.4f}"
        along = f"I{math.sin(lean) * c:.6f} J{math.sin(lean) * s:.6f} K{math.cos(lean):.6f}"
        if k == 0:
            lines.append(f"G0 {at} Z20. {along}")
        lines.append(f"G1 {at} Z0. {along}" + (" F3000." if k == 0 else ""))
    return "\n".join([*lines, "G0 Z60.", "G49", "M5", "M30", "%"]) + "\n"


def spent(text: str) -> tuple[float, float]:
    """Processor time [s] of all until the plan is checked, and of planning."""
    loaded = read_cell(SourceText("cell.yaml", _CELL.encode()), Path("cell.yaml"))
    plan_path, planning = legs.plan_path, [0.0]

    def timed(*given: object, **named: object) -> object:
        begin = time.process_time()
        found = plan_path(*given, **named)  # type: ignore[arg-type]
        planning[0] += time.process_time() - begin
        return found

    legs.plan_path = timed  # type: ignore[assignment]
    begin = time.process_time()
    try:
        prepare(SourceText("program.nc", text.encode()), loaded, Options(world="kinematic"))
    finally:
        legs.plan_path = plan_path
    return time.process_time() - begin, planning[0]


def main(blocks: int = 100_000) -> None:
    for name, turns, goal in (("one spin", 0.18, 2.0), ("spin along the path", 1.8, 6.0)):
        spent(program(2000, turns))  # so that no compiling is timed
        whole, planning = spent(program(blocks, turns))
        print(
            f"{name:20} planning {planning:6.2f} s   goal {goal:.0f} s for 100,000 blocks;"
            f" with reading and checks {whole:6.2f} s",
            flush=True,
        )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))

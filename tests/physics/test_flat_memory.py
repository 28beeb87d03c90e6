"""A run keeps what it will tell, and nothing else: memory over a thousand grips and a thousand tool changes."""

from __future__ import annotations

import gc
import tracemalloc
from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.executor import Progress
from gcodesim.jobs.job import Options
from gcodesim.simulation import prepare, run

CELL = """
gcodesim: 1
machine: gantry_xyz
frames: {table: {in: world, xyz: [400, 300, -400]}}
work_offsets: {G54: {in: table}}
parts: {box: {box: [40, 40, 40], zero: bottom-center, in: table, xyz: [-50, 0, 0], mass: 1 kg}}
tools:
  1: {type: flat_end_mill, diameter: 12, flutes: 3, length: 60}
  2: {type: suction_gripper, length: 60, cups: [{at: [0, 0], diameter: 40}], vacuum: 60 kPa, mass: 0.5 kg}
m_codes: {M62 P1: {gripper: close}, M63 P1: {gripper: open}}
"""
GRIP = "G0 X{}\nZ40\nM62 P1\nZ60\nX{}\nG1 Z40 F12000\nM63 P1\nG0 Z60\n"
PROGRAMS = {
    # 500 rounds, what stays of each [bytes]: two stays of the part with their poses for each of two grips; nothing
    "grips": (GRIP.format(-50, 50) + GRIP.format(50, -50), 2 * 1500.0),
    "tool changes": ("T1 M6\nG43 H1\nG0 X20\nT2 M6\nG43 H2\nG0 X-20\n", 250.0),
}


@pytest.mark.slow
@pytest.mark.parametrize("what", PROGRAMS)
def test_a_thousand_times_the_same_keeps_nothing_of_the_past(what: str, tmp_path: Path) -> None:
    body, kept = PROGRAMS[what]
    text = f"G21 G90\nT2 M6\nG43 H2\nG0 X-50 Y0 Z60\no1 repeat [500]\n{body}o1 endrepeat\nM2\n"
    loaded = read_cell(SourceText("cell.yaml", CELL.encode()), Path("cell.yaml"))
    job = prepare(SourceText("p.nc", text.encode()), loaded, Options(world="kinematic"))
    held: list[int] = []
    log = tracemalloc.Filter(False, "*/gcodesim/log/*")  # its few chunks wait for another thread and for the disk

    def progress(now: Progress) -> None:
        if now.step * 40 // now.steps > len(held):
            gc.collect()
            held.append(sum(trace.size for trace in tracemalloc.take_snapshot().filter_traces([log]).traces))

    tracemalloc.start(1)
    try:
        results, _ = run(job, tmp_path, progress)
    finally:
        tracemalloc.stop()

    assert results.status == "ok"
    rounds = 0.4 * 500.0
    growth = (sum(held[24:36]) - sum(held[8:20])) / 12.0  # means, since columns wait for the log now and then
    assert growth < rounds * kept

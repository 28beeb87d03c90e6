"""Where a run is cut into windows must not show: forces, volumes and stock are the same however often one looks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.executor import pacing
from tests.physics.runs import Ran, run_texts

# arcs, corners and feeds of which a step takes one chord, and of which it takes many
PROGRAM = """G21 G90 G17 G94 G64 P0.05
T1 M6
G43 H1
S8000 M3
G0 X-8 Y5 Z5
G0 Z-1
G1 X10 F9000
G2 X26 Y21 I0 J16
G3 X41 Y30 R15 F6000
G1 X20 Y22 Z-2 F1200
G1 X5 Y26
G0 Z5
M5
M2
"""

TAIL = """
work_offsets: {{G54: {{in: table}}}}
stock: {{min: [0, 0, -10], max: [50, 40, 0], in: table, material: al6082_t6, resolution: 0.5}}
tools:
  1: {{type: ball_end_mill, diameter: 8, length: 60}}
log: {{period: {period} ms}}
"""

CELLS = {
    "gantry": "gcodesim: 1\nmachine: gantry_xyz\nframes:\n  table: {{in: world, xyz: [400, 300, -200]}}" + TAIL,
    "arm": """gcodesim: 1
robots:
  arm:
    model: kuka_kr10_r1100_2
    home: [0, -90, 90, 0, 90, 0]
frames:
  table: {{in: world, xyz: [550, 0, 300]}}
orientation: {{tool_axis: -Z of G54, spin: free}}"""
    + TAIL,
    "turning table": """gcodesim: 1
machine:
  axes:
    X: {{travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}}
    Y: {{travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}}
    Z: {{travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}}
    C: {{travel: unlimited, speed: 360 deg/s, acceleration: 1800 deg/s^2, at: [0, 0, 0]}}
"""
    + TAIL.replace("in: table}}}}", "xyz: [-20, -15, -50]}}}}").replace("in: table", "in: G54"),
}
TURNING = """G21 G90
G0 Z30
T1 M6
G43 H1
S8000 M3
G0 X0 Y0 Z5
G1 Z-1 C20 F3000
G1 X12 C700 F20000
G1 X-3 C300
G0 Z5
M2
"""


def look(ran: Ran, out: Path) -> tuple[np.ndarray, bytes]:
    """Greatest force, volume and time in the cut of every row; the stock, all of it."""
    rows = ran.execution.rows
    (placed,) = ran.shop.stocks.values()
    placed.stock.save(out / "all.stock")
    seen = np.column_stack([rows[name] for name in ("force", "removed", "engaged")])
    return seen, (out / "all.stock").read_bytes()


@pytest.mark.parametrize("cell", CELLS)
def test_windows_do_not_show(cell: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = TURNING if cell == "turning table" else PROGRAM
    first, stock = look(run_texts(program, CELLS[cell].format(period=20), tmp_path / "first"), tmp_path)
    assert (first.max(axis=0) > 0.0).all()
    for period, most, logged in ((20, 7, True), (4, 333, True), (100, pacing.MOST_STEPS, True), (20, 41, False)):
        monkeypatch.setattr(pacing, "MOST_STEPS", most)
        out = tmp_path / f"{period}-{most}" if logged else None
        again, left = look(run_texts(program, CELLS[cell].format(period=period), out), tmp_path)
        scale = np.abs(first).max(axis=0)
        assert (np.abs(again - first) <= 1e-12 * scale).all()
        assert left == stock


LATHE = """gcodesim: 1
machine: lathe_xyzc
stock:
  cylinder: [40 mm, 60 mm]
  xyz: [0, 0, -59]
  material: al6082_t6
  resolution: 1 mm
  chuck: {{diameter: 90 mm, grip: 20 mm}}
tools:
  1:
    {{type: flat_end_mill, diameter: 12, flutes: 4, length: 45, driven: true,
      tcp: {{xyz: [-75, 0, 0], rpy: [0, -90, 0]}}}}
  2: {{type: flat_end_mill, diameter: 5, flutes: 2, flute_length: 25, length: 50, driven: true}}
log: {{period: {period} ms}}
"""
ACROSS = """G21 G18 G8 G90 G94
T1 M6 G43
G97 S4000 M3
G0 X30 Z14
O100 sub
  G0 Z14 C#1
  X17
  G1 Z-7 F1200
  G0 X30
O100 endsub
O100 call [0]
O100 call [60]
G0 X60 Z60
T2 M6 G43
S6000 M3
G0 C0
G0 X9 Z2
G1 Z-4 F100
G0 Z2
M2
"""


def test_nor_where_a_tool_looks_at_the_stock_for_many_steps_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One leans, and one stands on work that turns in some steps of a window, so that they end within rows."""
    first, stock = look(run_texts(ACROSS, LATHE.format(period=20), tmp_path / "first"), tmp_path)
    assert (first.max(axis=0) > 0.0).all()
    for period, beats, logged in ((12, 16, True), (36, 3, True), (300, 16, True), (20, 16, False), (20, 1, False)):
        monkeypatch.setattr(pacing, "MOST_STEPS", beats * pacing.BEAT)
        out = tmp_path / f"{period}-{beats}" if logged else None
        again, left = look(run_texts(ACROSS, LATHE.format(period=period), out), tmp_path)
        assert np.array_equal(again, first) and left == stock

"""Windows of steps: where they are cut shows in no number, and their pieces make one unbroken way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.executor.pacing import LONGEST_CHORD, Pacing
from gcodesim.executor.tasks import RowColumns
from gcodesim.executor.window import StepWindow, first_carry, window_of
from gcodesim.motion.tool_path import ARC
from gcodesim.planning.plan import Plan
from gcodesim.simulation import Options, prepare

CELL = """gcodesim: 1
machine: gantry_xyz
tools:
  1: {type: flat_end_mill, diameter: 10}
  2: {type: flat_end_mill, diameter: 6, length: 70}
"""
PROGRAM = """G21 G90 G17 G94 G64 P0.05
T1 M6
G0 X10 Y10
G1 X20 F3000
G2 X30 Y20 I0 J10
G1 Y40
T2 M6
G1 X60 F1200
M2
"""
MS = 1_000_000


@pytest.fixture(scope="module")
def plan() -> Plan:
    loaded = read_cell(SourceText("cell.yaml", CELL.encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.nc", PROGRAM.encode()), loaded, Options(world="kinematic"))
    assert job.plan is not None
    return job.plan


def windows(plan: Plan, most: int, dt_ns: int = 8 * MS) -> list[StepWindow]:
    rows, pacing = RowColumns.of(plan.path), Pacing(dt_ns=dt_ns)
    count = int(-(-plan.trajectory.duration_ns // dt_ns))
    carry = first_carry(plan, rows)
    return [window_of(plan, rows, np.arange(k, min(k + most, count) + 1), pacing, carry) for k in range(0, count, most)]


def test_the_pieces_follow_each_other_but_for_a_change_of_tool(plan: Plan) -> None:
    (whole,) = windows(plan, 100_000)

    gaps = np.abs(whole.piece_start[1:] - whole.piece_end[:-1]).max(axis=1)
    same = whole.tool[whole.piece_step[1:]] == whole.tool[whole.piece_step[:-1]]
    assert gaps[same].max() < 1e-12  # also where another length of tool comes into force
    assert (np.diff(whole.piece_step) >= 0).all() and set(whole.piece_step) == set(range(len(whole)))
    assert {1, 2} <= set(whole.tool.tolist())


def test_pieces_in_a_feed_are_short_and_each_lies_in_one_row(plan: Plan) -> None:
    (whole,) = windows(plan, 100_000)
    rows = RowColumns.of(plan.path)

    feed = ~rows.rapid[whole.piece_row]
    length = np.linalg.norm(whole.piece_end - whole.piece_start, axis=1)
    assert length[feed].max() < 1.2 * LONGEST_CHORD  # the speed is that of the middle of a step
    share = whole.piece_share
    assert ((share[:, 0] <= share[:, 1]) & (share[:, 0] >= 0.0) & (share[:, 1] <= 1.0)).all()


def test_lines_are_not_divided_within_steps_that_are_stretches_of_path(plan: Plan) -> None:
    rows = RowColumns.of(plan.path)
    count = int(-(-plan.trajectory.duration_ns // (8 * MS)))
    ticks = np.append(np.arange(0, count, 4), count)
    window = window_of(plan, rows, ticks, Pacing(dt_ns=8 * MS), first_carry(plan, rows))

    length = np.linalg.norm(window.piece_end - window.piece_start, axis=1)
    on_arc = plan.path.kind[window.piece_row] == ARC
    assert 1.2e-3 < length[~on_arc & ~rows.rapid[window.piece_row]].max() < 1.7e-3  # 50 mm/s for 32 ms
    assert length[on_arc].max() < 1.6 * LONGEST_CHORD  # the speed is that of the middle of a step
    place = np.cumsum(length[~rows.rapid[window.piece_row]])[-1]
    assert place == pytest.approx(0.01 + 1.5 * np.pi * 0.01 + 0.02 + 0.03, abs=1e-4)  # the corners are cut short


@pytest.mark.parametrize("most", [7, 64])
def test_where_windows_begin_shows_in_no_number(plan: Plan, most: int) -> None:
    (whole,) = windows(plan, 100_000)
    cut = windows(plan, most)

    for name in ("row", "tool", "q", "tip", "tip_before", "piece_start", "piece_end", "piece_share", "piece_row"):
        joined = np.concatenate([getattr(window, name) for window in cut])
        assert np.array_equal(joined, getattr(whole, name)), name

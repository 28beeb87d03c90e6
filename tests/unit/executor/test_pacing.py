"""Steps as stretches of path: fewer of them, and the numbers of a run in which every tick of the clock is a step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.executor import pacing
from gcodesim.executor.pacing import Pacing
from gcodesim.jobs.job import Job
from gcodesim.jobs.pace import log_period_ns, pacing_of
from gcodesim.simulation import Options, prepare
from tests.physics.runs import Ran, run_texts

TICK = 4_000_000
PROGRAM = """G21 G90 G17 G94 G64 P0.05
T1 M6
G43 H1
S8000 M3
G0 X-8 Y5 Z5
G0 Z-1
G1 X30 F600
G2 X46 Y21 I0 J16 F300
G3 X41 Y30 R15
G4 P0.5
G1 X20 Y22 Z-2 F120
G1 X5 Y26
G0 Z5
G0 X20 Y35
G1 Z-3 F60
G0 Z5
M5
M2
"""
CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [50, 40, 10], zero: top-front-left, material: al6082_t6, resolution: 0.5}
tools:
  1: {type: ball_end_mill, diameter: 8, length: 60}
"""
CLOCK = CELL + "simulation: {rate: 250 Hz}\n"


def job_of(cell: str, program: str = PROGRAM, **options: object) -> Job:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.nc", program.encode()), loaded, Options(world="kinematic", **options))  # type: ignore[arg-type]
    assert job.plan is not None and job.legs is not None
    job.legs.stock_up()
    return job


def test_steps_end_with_rows_and_go_no_farther_than_asked() -> None:
    job = job_of(CELL)
    plan = job.plan
    assert plan is not None
    rapid = np.isin(plan.path.kind, (0, 3))
    steps = -(-plan.trajectory.duration_ns // TICK)
    for period in (0, 5, 7):
        own = Pacing(dt_ns=TICK, reach=0.5e-3, pace=period)
        whole = np.unique(np.concatenate(list(own.windows(plan, rapid, 0, steps, 1 << 31))))

        assert whole[0] == 0 and whole[-1] == steps and len(whole) < 0.7 * steps
        assert np.isin(plan.trajectory.row_ns[0] // TICK, whole).all()
        if period:
            assert np.isin(np.arange(0, steps, period), whole).all()
        ends = plan.trajectory.sample((whole * TICK).astype(float) * 1e-9)
        way = np.linalg.norm(np.diff(ends.position[:, :3], axis=0), axis=1)
        middle = plan.trajectory.sample(0.5 * (ends.time[1:] + ends.time[:-1]))
        assert way[~rapid[middle.row] & (np.diff(whole) > 1)].max() < 0.5e-3 * 1.001


def test_where_no_force_is_asked_a_step_is_as_much_of_a_row_as_it_may_reach() -> None:
    job = job_of(CELL, only="shape")
    plan = job.plan
    assert plan is not None
    rapid = np.isin(plan.path.kind, (0, 3))
    steps = -(-plan.trajectory.duration_ns // TICK)
    pacings = (Pacing(dt_ns=TICK, reach=2e-3, at_one_rate=at_one_rate) for at_one_rate in (False, True))
    few, many = (np.concatenate([*each.windows(plan, rapid, 0, steps, 1 << 31)]) for each in pacings)
    assert pacing_of(job) == Pacing(dt_ns=TICK, reach=2e-3, at_one_rate=False)
    assert few[0] == 0 and few[-1] == steps and len(few) < 0.9 * len(many)
    assert np.isin(plan.trajectory.row_ns[0] // TICK, few).all()
    ends = plan.trajectory.sample((few * TICK).astype(float) * 1e-9)
    way = np.linalg.norm(np.diff(ends.position[:, :3], axis=0), axis=1)
    middle = plan.trajectory.sample(0.5 * (ends.time[1:] + ends.time[:-1]))
    assert 1.5e-3 < way[~rapid[middle.row] & (np.diff(few) > 1)].max() < 2e-3 * 1.001


@pytest.mark.parametrize("most", [3, 50, 1 << 31])
def test_windows_end_when_asked_and_follow_each_other(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    job = job_of(CELL)
    plan = job.plan
    assert plan is not None
    rapid = np.isin(plan.path.kind, (0, 3))
    steps = -(-plan.trajectory.duration_ns // TICK)
    own = Pacing(dt_ns=TICK, reach=0.5e-3, pace=5)
    monkeypatch.setattr(pacing, "MOST_STEPS", 1 << 31)
    (whole,) = own.windows(plan, rapid, 0, steps, 1 << 31)
    monkeypatch.setattr(pacing, "MOST_STEPS", 40)
    parts = list(own.windows(plan, rapid, 0, steps, most))

    for part in parts:
        wanted = (part[0] // most + 1) * most
        assert len(part) <= 41 and part[-2] < wanted
        ends = part[-1] >= wanted or len(part) == 41 or part[-1] == steps
        assert ends or part[-1] // own.beat != part[-2] // own.beat
    assert [part[0] for part in parts[1:]] == [part[-1] for part in parts[:-1]]
    assert np.array_equal(np.unique(np.concatenate(parts)), whole)


def seen(ran: Ran) -> dict[str, np.ndarray]:
    columns = ("force", "peak_force", "torque", "peak_torque", "removed")
    return {name: ran.execution.rows[name] for name in columns}


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Ran, Ran]:
    """The same program with steps along the path, and with ticks."""
    folder = tmp_path_factory.mktemp("paces")
    return run_texts(PROGRAM, CELL, folder / "path"), run_texts(PROGRAM, CLOCK, folder / "ticks")


def test_forces_and_volumes_are_those_of_ticks(both: tuple[Ran, Ran]) -> None:
    path, ticks = (seen(ran) for ran in both)

    assert path["removed"].sum() == pytest.approx(ticks["removed"].sum(), rel=1e-6)
    rows = ticks["removed"] > 0.005 * ticks["removed"].max()
    assert rows.sum() == 6
    for name in ("force", "peak_force", "torque", "peak_torque"):
        off = 0.08 if "peak" in name else 0.03  # looked for at other places; arcs are felt some cells late
        assert path[name][rows] == pytest.approx(ticks[name][rows], rel=off), name


def test_joints_are_those_of_ticks(both: tuple[Ran, Ran]) -> None:
    """Speeds, accelerations and efforts are of the last tick of a step, so that long steps smooth nothing."""
    path, ticks = (ran.execution.joints for ran in both)

    assert path.least == pytest.approx(ticks.least, abs=2e-4) and path.most == pytest.approx(ticks.most, abs=2e-4)
    assert path.speed == pytest.approx(ticks.speed, rel=0.02)
    assert path.acceleration == pytest.approx(ticks.acceleration, rel=0.02)
    assert path.effort == pytest.approx(ticks.effort, rel=0.02)


def test_an_interrupted_or_divided_run_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = run_texts(PROGRAM, CELL, None)
    monkeypatch.setattr(pacing, "MOST_STEPS", 13)
    divided = run_texts(PROGRAM, CELL, tmp_path / "out")  # with a log, which looks at the stock

    for name, values in seen(whole).items():
        assert seen(divided)[name] == pytest.approx(values, rel=1e-12, abs=1e-30), name
    assert divided.execution.steps == whole.execution.steps == whole.execution.planned


def test_how_often_the_log_looks_shows_in_no_number(tmp_path: Path) -> None:
    usual = run_texts(PROGRAM, CELL, None)
    for period in (4, 20, 36, 100):
        ran = run_texts(PROGRAM, CELL + f"log: {{period: {period} ms}}\n", tmp_path / str(period))
        for name, values in seen(usual).items():
            assert np.array_equal(seen(ran)[name], values), name
        assert ran.execution.steps == usual.execution.steps
        assert np.array_equal(ran.execution.joints.effort, usual.execution.joints.effort)


def test_the_log_looks_within_steps(tmp_path: Path) -> None:
    """What it says of motion is that of ticks; volumes grow evenly within steps, and no peak is lost."""
    period = "log: {period: 12 ms}\n"
    path, ticks = (run_texts(PROGRAM, cell + period, tmp_path / str(len(cell))) for cell in (CELL, CLOCK))
    assert pacing_of(path.job).period == 3
    assert np.array_equal(path.times("/motion"), ticks.times("/motion")) and len(path.times("/motion")) > 4000
    assert path.execution.steps == ticks.execution.steps
    for topic, field, allowed in (  # [m, m/s, m³]
        ("/tcp", "pose.position.x", 1e-9),
        ("/motion", "feed_m_s", 1e-6),
        ("/motion", "feed_command_m_s", 1e-9),
        ("/process", "removed_m3", 5e-10),
    ):
        one, other = path.column(topic, field), ticks.column(topic, field)
        assert one == pytest.approx(other, abs=allowed), (topic, field)
    for field, column in (("max_force_n", "force"), ("max_torque_nm", "torque")):
        one, other = path.column("/process", field), path.execution.rows[column]
        assert one.max() == pytest.approx(other.max(), rel=1e-6), field


BENDS = CELL.replace("length: 60", "length: 60, substrate: carbide")
ARM = """gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}
work_offsets: {G54: {in: world, xyz: [550, 0, 300]}}
stock: {box: [50, 40, 10], in: G54, zero: top-front-left, material: al6082_t6, resolution: 0.5}
tools: {1: {type: ball_end_mill, diameter: 8, length: 60}}
"""


def test_who_waits_for_ticks_gets_them() -> None:
    assert pacing_of(job_of(CELL)).reach == pytest.approx(0.5e-3)
    for cell in (CLOCK, BENDS, ARM):
        assert pacing_of(job_of(cell)).reach is None
    assert pacing_of(job_of(BENDS, only="shape")) == Pacing(dt_ns=TICK, reach=pytest.approx(2e-3), at_one_rate=False)
    bullet = prepare(job_of(CELL).program, job_of(CELL).loaded, Options(world="bullet"))
    assert pacing_of(bullet).reach is None


def test_a_long_program_is_logged_less_often_than_a_short_one() -> None:
    short, long = job_of(CELL), job_of(CELL, PROGRAM.replace("P0.5", "P1800"))
    assert log_period_ns(short) == 20_000_000
    assert log_period_ns(long) == 80_000_000 and log_period_ns(long) % TICK == 0
    assert log_period_ns(job_of(CLOCK, PROGRAM.replace("P0.5", "P1800"))) == 20_000_000


def test_a_log_may_look_seldom(both: tuple[Ran, Ran], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Windows in which it does not look at all are a part of what it says afterwards."""
    often, _ = both
    monkeypatch.setattr(pacing, "MOST_STEPS", 13)
    ran = run_texts(PROGRAM, CELL + "log: {period: 2 s}\n", tmp_path / "out")

    end = ran.execution.steps * TICK * 1e-9
    assert ran.times("/process") == pytest.approx(np.append(np.arange(0.0, end, 2.0), end))
    for field in ("removed_m3", "force_n", "power_w"):
        few, many = ran.column("/process", field)[:-1], often.column("/process", field)
        assert few == pytest.approx(many[: 100 * len(few) : 100], rel=1e-9, abs=1e-20), field
    peaks = often.column("/process", "max_force_n")[:, 0]
    wanted = [peaks[max(100 * k - 99, 0) : 100 * k + 1].max() for k in range(len(few))]
    assert ran.column("/process", "max_force_n")[:-1, 0] == pytest.approx(wanted, rel=1e-9)

"""Programs that ask something of the run: read, planned, checked and run leg by leg, and told as one run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.executor import Progress
from gcodesim.jobs.job import Job
from gcodesim.jobs.results import Results
from gcodesim.simulation import RunInterrupted, check, prepare, run
from tests.log_columns import read_columns

CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [60, 40, 20], zero: top-front-left, material: al6082_t6, resolution: 1}
tools:
  1: {type: flat_end_mill, diameter: 6, length: 60 mm}
  2: {type: ball_end_mill, diameter: 4, length: 60 mm}
simulation: {world: kinematic}
"""
HEAD = "G21 G90 G94\nT2 M6\nG43 H2\nG0 X30 Y20\nZ5\nF600\n"


def prepared(program: str, cell: str = CELL) -> Job:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    return prepare(SourceText("program.nc", program.encode()), loaded)


def ran(program: str, out: Path | None = None, cell: str = CELL) -> tuple[Job, Results]:
    job = prepared(program, cell)
    results, _ = run(job, out)
    return job, results


def codes(results: Results) -> list[tuple[str, int]]:
    return [(f.code, f.span.line) for f in results.findings if f.code not in ("GS725", "GS731")]


def parameters(job: Job) -> dict[int, float]:
    assert job.reading is not None
    return job.reading.parameters


def test_a_program_that_asks_nothing_is_one_leg() -> None:
    job = prepared(HEAD + "G1 Z2\nM2\n")
    plan = job.plan
    assert job.legs is not None and job.legs.onward() is None
    assert job.plan is plan


def test_steps_of_all_legs_are_whole_and_times_go_on() -> None:
    job = prepared(HEAD + "G38.2 Z-5\nG0 Z5\nX35\nG38.2 Z-5\nG0 Z5\nM2\n")
    results, execution = run(job)
    assert execution is not None and execution.steps == execution.planned
    plan = job.plan
    assert plan is not None
    trajectory, step = plan.trajectory, 4e-3
    assert execution.steps == int(np.ceil(trajectory.duration / step - 1e-9))
    assert results.times.total == pytest.approx(trajectory.duration, abs=1e-9)
    probes = [row for row in range(len(plan.path)) if plan.path.state_of(row).word == "G38.2"]
    begins = trajectory.row_start[[*probes, probes[0] + 1]] / step
    assert np.allclose(begins, np.rint(begins), atol=1e-6), "legs begin with a whole step"
    assert np.all(np.diff(trajectory.row_start) >= 0.0) and np.all(trajectory.row_end >= trajectory.row_start)
    ways = np.diff(trajectory.sample(np.arange(0.0, trajectory.duration, 1e-3)).position[:, :3], axis=0)
    assert np.linalg.norm(ways, axis=1).max() < 1e-3, "the tool never jumps"


def test_lines_and_distances_are_those_of_one_run() -> None:
    _, results = ran(HEAD + "G38.2 Z-5\nG0 Z5\nM2\n")
    lines = {int(line): row for line, row in zip(results.lines.line, results.lines.numbers, strict=True)}
    assert lines[7][1] == pytest.approx(5.0, abs=0.1) and lines[8][1] == pytest.approx(5.0, abs=0.1)
    assert sum(row[0] for row in lines.values()) == pytest.approx(results.times.total, abs=1e-4)
    assert results.feed_distance == pytest.approx(5e-3, abs=1e-4)


def test_a_loop_that_only_a_probe_ends() -> None:
    """A step down a millimetre at a time: G38.3 fails until the surface is within reach."""
    program = HEAD + (
        "o1 do\n#1=[#<_z>]\nG38.3 Z[#1-0.8]\nG91 G0 Z0\nG90\no1 while [#5070 EQ 0]\n#31=#5063\nG0 Z5\nM2\n"
    )
    job, results = ran(program)
    assert results.status == "ok"
    assert [p.tripped for p in results.probings] == [False] * 6 + [True]
    assert parameters(job)[31] == pytest.approx(0.0, abs=1e-4)


def test_a_grid_of_probes_measures_a_step_that_the_program_has_cut() -> None:
    """As smartprobe.ngc does it: two nested loops, a probe at each place, heights kept in numbered parameters."""
    program = """G21 G90 G94
T1 M6
G43 H1
S6000 M3
G0 X-5 Y18
Z-4
G1 X30 F900
G0 Z10
M5
T2 M6
G43 H2
F900
#100=10
#10=200
o100 while [#100 LE 50]
  #101=6
  o200 while [#101 LE 30]
    G0 X#100 Y#101
    G0 Z2
    G38.2 Z-8
    #[#10]=#5063
    #10=[#10+1]
    G0 Z2
    #101=[#101+12]
  o200 endwhile
  #100=[#100+20]
o100 endwhile
G0 Z20
M2
"""
    job, results = ran(program)
    assert results.status == "ok", codes(results)
    heights = [parameters(job).get(number, 0.0) for number in range(200, 209)]
    assert heights == pytest.approx([0.0, -4.0, 0.0, 0.0, -4.0, 0.0, 0.0, 0.0, 0.0], abs=1e-4)
    assert len(results.probings) == 9


def test_a_probe_without_contact_stops_the_program_there(tmp_path: Path) -> None:
    _, results = ran(HEAD + "G38.2 Z1\nG0 X50\nM2\n", tmp_path)
    assert results.status == "failed" and results.stopped_at is not None
    assert (results.stopped_at.line, codes(results)) == (7, [("GS138", 7)])
    assert results.feed_distance == pytest.approx(4e-3), "the move itself was made"
    events = read_columns(tmp_path / "run.mcap", "/event", ["code"])["code"]
    assert "probe" in events and "GS138" in events


def test_a_probe_that_begins_in_contact_is_refused() -> None:
    _, results = ran(HEAD + "G38.2 Z-5\nG38.2 Z-8\nM2\n")
    assert ("GS139", 8) in codes(results) and results.status == "failed"
    _, results = ran(HEAD + "G38.4 Z8\nM2\n")
    assert codes(results) == [("GS139", 7)]


def test_a_fault_behind_a_probe_ends_the_run_at_its_block() -> None:
    _, results = ran(HEAD + "G38.2 Z-5\nG0 Z5\nG2 X1 Y1\nG0 X50\nM2\n")
    assert results.stopped_at is not None and results.stopped_at.line == 9
    assert results.status == "failed"
    assert results.rapid_distance > 0.0 and len(results.probings) == 1


def test_limits_of_later_legs_are_told_with_their_times() -> None:
    job = prepared(HEAD + "G38.2 Z-5\nG0 Z5\nG0 X5000\nM2\n")
    results = check(job)
    found = next(f for f in results.findings if f.code == "GS201")
    assert found.span.line == 9 and job.plan is not None
    trajectory = job.plan.trajectory
    assert found.time is not None and found.limit is not None
    assert trajectory.row_start[-1] < found.time < trajectory.row_end[-1]
    place = trajectory.sample(np.array([found.time]))
    assert job.plan.joints(place)[0, 0] == pytest.approx(found.limit, abs=1e-6)


def test_a_check_meets_the_stock_as_it_came_and_says_so() -> None:
    program = HEAD.replace("T2", "T1").replace("H2", "H1") + (
        "S6000 M3\nG1 X35 Z-2\nG1 X30\nG0 Z5\nM5\nT2 M6\nG43 H2\nG0 Z5\nG38.2 Z-5\n#31=#5063\nG0 Z5\nM2\n"
    )
    job = prepared(program)
    results = check(job)
    assert ("GS919", 15) in codes(results)
    assert parameters(job).get(31, 0.0) == pytest.approx(0.0, abs=1e-4)
    job, results = ran(program)
    assert "GS919" not in {code for code, _ in codes(results)}
    assert parameters(job)[31] == pytest.approx(-2.0, abs=1e-4)


def test_the_log_is_one_run_and_shows_the_trips(tmp_path: Path) -> None:
    _, results = ran(HEAD + "G38.2 Z-5\nG0 Z5\nX35\nG38.3 Z2\nG0 Z5\nM2\n", tmp_path)
    columns = read_columns(tmp_path / "run.mcap", "/event", ["code", "message", "line"])
    told = [
        (int(line), text)
        for code, text, line in zip(*(columns[k] for k in ("code", "message", "line")), strict=True)
        if code == "probe"
    ]
    assert [line for line, _ in told] == [7, 10]
    assert told[0][1].startswith("G38.2 tripped on stock, tip at X600.000 Y400.000 Z-160.000")
    assert "did not trip" in told[1][1]
    lines = read_columns(tmp_path / "run.mcap", "/program", ["line"])["line"]
    assert [line for line in lines.tolist() if line >= 7] == [7, 8, 9, 10, 11, 12, 12]
    times = read_columns(tmp_path / "run.mcap", "/tcp", [])["t_ns"]
    assert np.all(np.diff(times[:-1]) == 20_000_000)
    value = results.as_json()
    assert [entry["touched"] for entry in value["probings"]] == ["stock", None]


def test_a_program_may_begin_with_its_probe() -> None:
    cell = CELL + "loaded_tool: 2\n"
    job, results = ran("G21 G90 G94\nF3000\nG38.2 Z-500\nM2\n", cell=cell)
    assert results.status == "failed" and ("GS138", 3) in codes(results)
    assert job.plan is not None and len(job.plan.path) == 1


def test_the_same_bytes_each_time(tmp_path: Path) -> None:
    program = HEAD + "G38.2 Z-5\nG0 Z5\nX35\nG38.2 Z-5\nG0 Z5\nM2\n"
    for name in ("a", "b"):
        ran(program, tmp_path / name)
    for file in ("run.mcap", "results.json", "lines.csv"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_an_interrupt_in_a_later_leg_is_told_as_ever(tmp_path: Path) -> None:
    job = prepared(HEAD + "G38.2 Z-5\nG0 Z5\nX35\nG4 P3\nG38.2 Z-5\nG0 Z5\nM2\n")

    def stop(now: Progress) -> None:
        if job.probings and now.time > job.probings[0].time + 0.5:
            raise KeyboardInterrupt

    with pytest.raises(RunInterrupted) as stopped:
        run(job, tmp_path, stop)
    results = stopped.value.results
    assert results.status == "failed"
    assert results.stopped_at is not None and results.stopped_at.line == 10
    assert (tmp_path / "run.mcap").exists()

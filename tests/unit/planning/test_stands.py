"""An arm that drives to stands for its tool changes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gcodesim
from gcodesim.canon import ToolChange
from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Job
from gcodesim.jobs.results import Results
from gcodesim.playback.recording import Recording
from gcodesim.simulation import check, prepare

CELL = """gcodesim: 1
frames:
  table: {in: world, xyz: [600, -60, 150]}
  rack: {in: world, xyz: [250, 550, 200]}
robots:
  arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}
work_offsets: {G54: {in: table}}
orientation: {tool_axis: -Z of G54, spin: 0}
magazine:
  change_time: 1.5 s
  stands:
    1: {in: rack, xyz: [-150, 0, 200], rpy: [180, 0, 0], approach: 80, slide: [0, -120, 0]}
    2: {in: rack, xyz: [0, 0, 200], rpy: [180, 0, 0], approach: 80, slide: [0, -120, 0]}
tools:
  1: {type: flat_end_mill, diameter: 8, length: 80, holder: {diameter: 50, length: 60}}
  2: {type: camera, width: 16, height: 12, length: 80}
  3: {type: camera, width: 16, height: 12, length: 80}
simulation: {world: kinematic}
"""
PROGRAM = """G21 G90 G17
T1 M6
G0 X10 Y-10 Z40
G1 Z18 F1200
T2 M6
G1 Z30
T0 M6
M2
"""


def _job(cell: str = CELL, program: str = PROGRAM) -> Job:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    return prepare(SourceText("p.nc", program.encode()), loaded)


def _codes(cell: str = CELL, program: str = PROGRAM) -> list[tuple[str, int]]:
    notes = ("GS195", "GS725", "GS206", "GS231")
    return [(f.code, f.span.line) for f in check(_job(cell, program)).findings if f.code not in notes]


def test_the_flange_is_at_the_stand_when_the_tool_changes() -> None:
    job = _job()
    assert not [finding for finding in check(job).findings if finding.level.name != "NOTE"]
    plan, shop = job.plan, job.shop
    assert plan is not None and shop is not None
    changes = [timed for timed in plan.trajectory.events if isinstance(timed.event, ToolChange)]
    assert [timed.event.span.line for timed in changes] == [2, 5, 7]
    for timed, number in zip(changes, (1, 2, 2), strict=True):
        q = plan.joints(plan.trajectory.sample(np.array([timed.time + 0.7])))
        X_WF = shop.X_WB.matrix @ plan.kinematics.forward(q)[0]
        np.testing.assert_allclose(X_WF, shop.stand(number).matrix, atol=1e-9)
    assert plan.trajectory.duration == pytest.approx(check(job).times.total)
    assert check(job).times.tool_change == pytest.approx(4.5)


def test_joints_run_without_a_jump_and_tools_are_where_they_should_be() -> None:
    job = _job()
    check(job)
    plan = job.plan
    assert plan is not None
    times = np.arange(0.0, plan.trajectory.duration, 1e-3)
    samples = plan.trajectory.sample(times)
    speed = np.abs(np.diff(plan.joints(samples), axis=0)) / 1e-3
    assert (speed < 1.02 * plan.kinematics.joints.speed).all()
    tools = np.array([state.tool for state in plan.path.states])[plan.path.state[samples.row]]
    order = tools[np.flatnonzero(np.diff(tools, prepend=-1))].tolist()
    assert order == [0, 1, 0, 2, 0]


def test_a_loaded_tool_is_set_down_first_and_the_same_tool_needs_no_way() -> None:
    loaded = CELL.replace("tools:\n", "loaded_tool: 1\ntools:\n")
    job = _job(loaded, "G21 G90\nT1 M6\nG0 X10 Y0 Z40\nT2 M6\nM2\n")
    check(job)
    assert job.plan is not None
    tools = [job.plan.path.state_of(row).tool for row in range(len(job.plan.path))]
    assert tools == [1, 1, 1, 0, 0, 0, 2]


@pytest.mark.parametrize(
    ("cell", "program", "found"),
    [
        (CELL, "G21 G90\nT3 M6\nG0 X0 Y0 Z60\nM2\n", ("GS626", 2)),
        (CELL, "G21 G90\nM61 Q1\nM61 Q0\nG0 X0 Y0 Z60\nT1 M6\nM2\n", ("GS625", 5)),
        (CELL.replace("xyz: [0, 0, 200]", "xyz: [0, 900, 200]"), PROGRAM, ("GS232", 5)),
        (CELL + "fixtures: {post: {box: [60, 60, 900], in: world, xyz: [420, 260, 0]}}\n", PROGRAM, ("GS305", 2)),
        (CELL.replace("    2: {in", "    7: {in"), PROGRAM, ("GS712", 13)),
    ],
)
def test_what_cannot_be_is_a_finding(cell: str, program: str, found: tuple[str, int]) -> None:
    assert found in _codes(cell, program)


def test_a_stand_is_out_of_reach_by_as_much_as_it_is_too_far_and_told_when_its_tool_is_changed() -> None:
    """The wrist is 10 mm below joint 2, and 0.5 mm less or more from it than the stretched arm is long."""
    link = 560.0 + (515.0**2 + 25.0**2) ** 0.5
    for beyond in (-0.5, 0.5):
        across = 25.0 + (link**2 - 10.0**2) ** 0.5 + beyond
        place = f"xyz: [{across:.4f}, 0, 300], rpy: [180, 0, 0], approach: 1, slide: [-10, 0, 0]"
        there = f"    1: {{in: world, {place}}}\n"
        lines = [there if line.startswith("    1: {in") else line for line in CELL.splitlines(keepends=True)]
        job = _job("".join(lines), "G21 G90\nG0 X10 Y0 Z40\nT1 M6\nG0 X20\nM2\n")
        check(job)
        told = [f for f in job.findings if f.code == "GS232"]
        assert len(told) == (beyond > 0.0)
        for finding in told:
            assert finding.value is not None and finding.limit is not None and job.plan is not None
            assert finding.limit == pytest.approx(link * 1e-3, abs=1e-9)
            assert finding.value - finding.limit == pytest.approx(beyond * 1e-3, rel=1e-3)
            assert finding.span.line == 3
            assert finding.time == pytest.approx(job.plan.trajectory.row_end[0])


@pytest.mark.parametrize(
    ("way", "hits"),
    [
        ("G0 X-350 Y480 Z190\nG0 Y640", "T1 hits T2 in its stand"),
        ("G0 X-350 Y480 Z330\nG0 Y640", None),
    ],
)
def test_a_tool_in_its_stand_is_in_the_way(way: str, hits: str | None) -> None:
    """T2 hangs from Z250 down to Z170 in G54, where Y is 610."""
    found = check(_job(program=f"G21 G90\nT1 M6\nG0 X0 Y0 Z250\n{way}\nM2\n")).findings
    met = [(finding.message, finding.span.line) for finding in found if "in its stand" in finding.message]
    assert [line for _, line in met] == ([] if hits is None else [5])
    assert hits is None or any(hits in message for message, _ in met)


def test_only_an_arm_has_stands() -> None:
    cell = "gcodesim: 1\nmachine: gantry_xyz\nmagazine: {stands: {1: {xyz: [0, 0, 0]}}}\n"
    cell += "tools: {1: {type: flat_end_mill, diameter: 8}}\n"
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    assert [finding.code for finding in loaded.findings] == ["GS719"]


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_tools_are_seen_in_their_stands_and_on_the_flange(tmp_path: Path, world: str) -> None:
    (tmp_path / "cell.yaml").write_text(CELL.replace("kinematic", world))
    (tmp_path / "p.nc").write_text(PROGRAM)
    gcodesim.simulate(tmp_path / "p.nc", tmp_path / "cell.yaml", tmp_path / "out")
    shown = [{each.id for each in drawings} for _, drawings in Recording.open(tmp_path / "out").tools()]
    both = {"stand/T1", "stand/T2"}
    assert shown == [both, {"tool", "stand/T2"}, both, {"tool", "stand/T1"}, both]


PAIR = """gcodesim: 1
frames:
  rack: {in: world, xyz: [800, 500, 200]}
robots:
  left: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}
  right:
    model: kuka_kr10_r1100_2
    base: {in: world, xyz: [1600, 0, 0], rpy: [0, 0, 180]}
    home: [0, -90, 90, 0, 90, 0]
channels:
  left: {robot: left, work_offsets: {G54: {in: world, xyz: [550, -250, 250]}}, m_codes: {M200: {wait: m}}}
  right: {robot: right, work_offsets: {G54: {in: world, xyz: [1050, -250, 250]}}, m_codes: {M200: {wait: m}}}
magazine:
  change_time: 1.5 s
  stands:
    1: {in: rack, xyz: [-75, 0, 200], rpy: [180, 0, 0], approach: 80, slide: [0, -120, 0]}
    2: {in: rack, xyz: [75, 0, 200], rpy: [180, 0, 0], approach: 80, slide: [0, -120, 0]}
tools:
  1: {type: flat_end_mill, diameter: 8, length: 80}
  2: {type: flat_end_mill, diameter: 6, length: 80}
simulation: {world: kinematic}
"""
LEFT = "G21 G90\nT1 M6\nG0 X0 Y0 Z200\nG4 P1\nT2 M6\nG0 X0 Y0 Z200\nT0 M6\nG28\nM2\n"
RIGHT = "G21 G90\nG4 P1\nT1 M6\nG0 X0 Y0 Z200\nT0 M6\nG28\nM2\n"


def _pair(folder: Path, left: str, right: str) -> Results:
    for name, text in {"cell.yaml": PAIR, "left.nc": left, "right.nc": right}.items():
        (folder / name).write_text(text)
    others = {"right": folder / "right.nc"}
    return gcodesim.simulate(folder / "left.nc", folder / "cell.yaml", folder / "out", channels=others)


def test_an_arm_waits_for_a_tool_until_the_other_has_set_it_down_and_left(tmp_path: Path) -> None:
    results = _pair(tmp_path, LEFT, RIGHT)

    (wait,) = results.channels["right"]["waits"]
    assert (wait["mark"], wait["line"], wait["begin_s"]) == ("T1", 3, 1)
    assert not results.channels["left"]["waits"]
    seen = [[each.id for each in drawings] for _, drawings in Recording.open(tmp_path / "out").tools()]
    assert [len(ids) for ids in seen] == [2] * len(seen)  # two tools in all, each in one place
    assert ["tool", "tool"] in seen and ["tool", "stand/T2"] in seen and ["stand/T1", "stand/T2"] in seen


def test_programs_that_hold_what_the_other_needs_are_told_with_both_lines(tmp_path: Path) -> None:
    results = _pair(tmp_path, LEFT.replace("G4 P1", "M200"), RIGHT.replace("T0 M6", "M200"))

    (circle,) = [finding for finding in results.findings if finding.code == "GS620"]
    assert "`left` waits in line 4 of left.nc at `m` for `right`" in circle.message
    assert "`right` waits in line 3 of right.nc for T1, which `left` has" in circle.message
    assert circle.related is not None and circle.related.line == 3

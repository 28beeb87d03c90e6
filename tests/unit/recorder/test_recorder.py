"""What a run leaves in its log: states, outputs, limits, findings at their times, files."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

import gcodesim
from gcodesim.log.logfile import LogFile
from gcodesim.log.reader import read_messages
from gcodesim.recorder import instants
from tests.log_columns import read_columns

CELL = """gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {xyz: [400, 300, -300]}}
stock: {min: [0, 0, -20], max: [100, 60, 0], in: G54, material: al6082_t6, resolution: 1}
tools:
  1: {type: flat_end_mill, diameter: 10 mm, flutes: 3, length: 60 mm}
  2: {type: flat_end_mill, diameter: 6 mm, flutes: 3, length: 60 mm}
  3: {type: extruder, bead_width: 2 mm, bead_height: 1 mm}
magazine: {change_time: 2 s}
fixtures: {clamp: {min: [60, 0, -5], max: [80, 10, 8], in: G54}}
subroutines: [.]
limits: {spindle_power: 10 W}
m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}
simulation: {world: kinematic}
"""
PROGRAM = """G21 G90 G17 G94
T1 M6
G43 H1
S8000 M3
M8 M64 P1
G0 X5 Y5 Z5
G4 P0.5
M68 E2 Q3.5
M10
G1 Z-1 F300
M62 P3
G1 X20
M62 P4
G1 X70
M11 M65 P1
M0
M9
o<bore> call
T2 M6
G43 H2
G0 Z20
M2
"""
SUBPROGRAM = "o<bore> sub\nG1 Y20\no<bore> endsub\n"


@pytest.fixture(scope="module")
def log(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("recorder")
    (folder / "part.nc").write_text(PROGRAM)
    (folder / "bore.ngc").write_text(SUBPROGRAM)
    (folder / "cell.yaml").write_text(CELL)
    gcodesim.simulate(folder / "part.nc", folder / "cell.yaml", folder / "out")
    return folder / "out" / "run.mcap"


def shown(log, line, last=False):
    """The first or last `/program` message of a line of part.nc."""
    found = [m for _, m in read_messages(log, "/program") if m.line == line and m.file == "part.nc"]
    return found[-1 if last else 0]


def test_the_log_follows_the_table(log):
    path = Path(__file__).parents[2] / "data" / "log" / "check_log.py"
    spec = importlib.util.spec_from_file_location("recorder_check_log", path)
    checker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(checker)
    assert checker.check_log(str(log))[0] == []


def test_the_state_tells_why_the_machine_stands(log):
    states = {line: shown(log, line).state for line in (2, 3, 7, 8, 16, 17, 19, 20)}
    assert states == {
        2: "toolchange", 3: "running", 7: "paused", 8: "running",
        16: "paused", 17: "running", 19: "toolchange", 20: "running",
    }  # fmt: skip
    assert shown(log, 22, last=True).state == "finished"


def test_outputs_and_coolant_are_those_that_the_program_has_set(log):
    def outputs(line):
        return {o.name: o.verb or o.value for o in shown(log, line).outputs}

    assert outputs(2) == {}
    assert outputs(6) == {"digital 1": 1.0}
    assert outputs(10) == {"analog 2": 3.5, "digital 1": 1.0, "tool": "activate"}
    assert outputs(12)["digital 3"] == 1.0 and "digital 4" not in outputs(12)
    assert outputs(14)["digital 4"] == 1.0
    assert outputs(16)["tool"] == "deactivate" and outputs(16)["digital 1"] == 0.0
    assert shown(log, 6).flood and not shown(log, 6).mist and not shown(log, 20).flood


def test_findings_are_events_at_their_time(log):
    events = [(t, m) for t, m in read_messages(log, "/event") if m.code.startswith("GS")]
    lines = {m.line: t for t, m in read_messages(log, "/program") if m.file == "part.nc"}
    hit = next((t, m) for t, m in events if m.code == "GS301")
    # the cutter's edge, 5 mm before its tip, reaches the clamp 35 mm after X20 at 300 mm/min
    assert hit[0] * 1e-9 - lines[14] * 1e-9 == pytest.approx(35 / 5, abs=0.05)
    assert list(hit[1].bodies) == ["T1", "clamp"]
    assert hit[1].value == pytest.approx(9e-3)  # from the top of the clamp, at Z8, down to the tip at Z-1
    power = [(t, m) for t, m in events if m.code == "GS510"]
    assert len(power) == 2 and power[0][1].severity == power[1][1].severity == "error"  # its beginning, its greatest
    drawn = read_columns(log, "/process", ["power_w"])
    first = drawn["t_ns"][np.flatnonzero(drawn["power_w"] > 10.0)[0]]
    assert abs(power[0][0] - first) < 2e9  # within the window in which it came up
    assert power[1][1].value > 10.0  # W, while the message says kW


def test_every_finding_of_the_results_is_an_event_of_the_log(log):
    results = json.loads(LogFile.open(log).attachment("results.json"))
    said = {(m.code, m.file, m.line) for _, m in read_messages(log, "/event")}
    assert {(f["code"], f["file"], f["line"]) for f in results["findings"]} <= said


def test_tool_changes_are_events(log):
    changes = [(m.message, m.line) for _, m in read_messages(log, "/event") if m.code == "toolchange"]
    assert changes == [("T1", 2), ("T2", 19)]


def test_joints_have_limits_and_tell_how_much_of_them_is_used(log):
    record = LogFile.open(log).metadata["gcodesim.joints"]
    limits = {name: json.loads(text) for name, text in record.items()}
    assert list(limits) == ["machine/X", "machine/Y", "machine/Z"]
    assert limits["machine/X"]["kind"] == "prismatic" and limits["machine/X"]["lower"] == 0.0
    q = read_columns(log, "/joint_states", ["joints.position", "joints.velocity"])
    used = read_columns(log, "/motion", ["travel_used", "speed_used"])
    lower = np.array([limit["lower"] for limit in limits.values()])
    upper = np.array([limit["upper"] for limit in limits.values()])
    share = np.abs(q["joints.position"] - (lower + upper) / 2) / ((upper - lower) / 2)
    assert used["travel_used"] == pytest.approx(share.max(axis=1))
    speed = np.array([limit["speed"] for limit in limits.values()])
    assert used["speed_used"] == pytest.approx((np.abs(q["joints.velocity"]) / speed).max(axis=1))
    assert 0.9 < used["speed_used"].max() <= 1.0 + 1e-9  # rapids go as fast as the axes can


def test_the_log_says_where_the_joints_were_told_to_be(log):
    told = read_columns(log, "/motion", ["joints.command", "joints.command_shown"])
    is_at = read_columns(log, "/joint_states", ["joints.position"])["joints.position"]

    assert np.array_equal(told["joints.command"], is_at)  # the kinematic world follows exactly
    assert np.ptp(is_at[:, 0]) > 0.05
    assert told["joints.command_shown"] == pytest.approx(1e3 * is_at)


def test_the_cut_is_in_the_log_with_forces_in_axes_of_the_tool(log):
    names = ["axial_depth_m", "max_axial_depth_mm", "feed_force_n", "side_force_n", "axial_force_n", "force_n"]
    cut = read_columns(log, "/process", names)
    busy = cut["axial_depth_m"] > 0.0

    assert cut["axial_depth_m"].max() == pytest.approx(1e-3, rel=0.01)
    assert cut["max_axial_depth_mm"].max() == pytest.approx(1.0, rel=0.01)
    parts = np.stack([cut[f"{name}_force_n"] for name in ("feed", "side", "axial")])
    assert np.linalg.norm(parts, axis=0) == pytest.approx(cut["force_n"], abs=1e-9)
    assert busy.sum() > 100 and (parts[0][busy] < 0.0).mean() > 0.9  # the work holds the tool back


def test_the_log_carries_what_it_came_from(log):
    opened = LogFile.open(log)
    assert list(opened.attachments) == [
        "program.nc", "cell.yaml", "bore.ngc", "machine.urdf", "layout.json", "results.json",
    ]  # fmt: skip
    assert opened.attachment("program.nc").decode() == PROGRAM
    assert opened.attachment("bore.ngc").decode() == SUBPROGRAM


def test_what_a_stopped_program_would_have_hit_is_not_told(tmp_path):
    (tmp_path / "part.nc").write_text(PROGRAM.replace("G1 X70\n", "G1 X30\nG1 X[1/0]\nG1 X70\n").split("M0")[0])
    (tmp_path / "cell.yaml").write_text(CELL)
    gcodesim.simulate(tmp_path / "part.nc", tmp_path / "cell.yaml", tmp_path / "out")
    codes = [m.code for _, m in read_messages(tmp_path / "out" / "run.mcap", "/event")]
    assert "GS301" not in codes
    assert codes[-1] == "end"
    assert [m for _, m in read_messages(tmp_path / "out" / "run.mcap", "/program")][-1].state == "failed"


def test_how_many_windows_are_written_together_shows_nowhere(log, tmp_path, monkeypatch):
    monkeypatch.setattr(instants, "MOST_WINDOWS", 1)
    folder = log.parent.parent
    gcodesim.simulate(folder / "part.nc", folder / "cell.yaml", tmp_path)
    assert (tmp_path / "run.mcap").read_bytes() == log.read_bytes()


def test_the_speed_at_an_instant_does_not_depend_on_the_instants_before(log, tmp_path):
    """Most windows have no instant here; the tip goes on in them."""
    folder = log.parent.parent
    (tmp_path / "cell.yaml").write_text(CELL + "log: {period: 1 s}\n")
    for name in ("part.nc", "bore.ngc"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    gcodesim.simulate(tmp_path / "part.nc", tmp_path / "cell.yaml", tmp_path / "out")
    often, seldom = (read_columns(path, "/motion", ["feed_m_s"]) for path in (log, tmp_path / "out" / "run.mcap"))
    assert len(seldom["t_ns"]) > 10
    at = np.searchsorted(often["t_ns"], seldom["t_ns"])
    # the last is the state at the last instant, told again at the end
    assert seldom["feed_m_s"][:-1] == pytest.approx(often["feed_m_s"][at[:-1]], rel=1e-12, abs=1e-15)

"""Sensors of a cell in whole runs: when they read, what they see, and where it goes."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from gcodesim.cell.loader import read_cell
from gcodesim.cell.show import cell_as_json
from gcodesim.diagnostics import SourceText
from gcodesim.log.schema import decoder
from gcodesim.observation import eyes
from tests.physics.runs import Ran, run_texts

HEAD = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {in: machine, xyz: [500, 300, -300]}}
stock: {min: [0, 0, -10], max: [60, 40, 0], in: G54, material: al6082_t6, resolution: 0.5}
tools:
  1: {type: flat_end_mill, diameter: 10 mm, flutes: 3, length: 60 mm, mass: 2 kg}
  9: {type: camera, width: 60, height: 40, field_of_view: 60 deg, length: 100}
m_codes: {M110: {camera: shoot}}
simulation: {world: kinematic, seed: 5}
"""
ABOVE = "in: G54, xyz: [30, 20, 100], rpy: [180, 0, 0]"
PROGRAM = """G21 G90 G17 G54
T1 M6 G43 H1
S8000 M3
G0 X-250 Y20 Z5
M111
G0 X-10
G1 Z-3 F1200
X70
G0 Z50
X300
M111
M5
M30
"""


def run_with(sensors: str, program: str = PROGRAM, out: Path | None = None) -> Ran:
    return run_texts(program, f"{HEAD}sensors:\n{sensors}", out)


def messages(log: Path, topic: str) -> list:
    found = []
    with log.open("rb") as file:
        for schema, _, message in make_reader(file).iter_messages(topics=[topic]):
            found.append((message.log_time, decoder(schema.name, schema.data).FromString(message.data)))
    return found


def depths(message) -> np.ndarray:
    kind = {"32FC1": "<f4", "16UC1": "<u2"}[message.encoding]
    assert message.step == message.width * np.dtype(kind).itemsize
    return np.frombuffer(message.data, kind).reshape(message.height, message.width)


def test_a_depth_camera_sees_the_slot_once_it_is_cut(tmp_path: Path) -> None:
    sensor = f"  deep: {{type: depth_camera, {ABOVE}, width: 60, height: 40, trigger: M111, range: [50, 300 mm]}}\n"

    ran = run_with(sensor, out=tmp_path)

    first, before, after = messages(tmp_path / "run.mcap", "/camera/deep/depth")
    assert first[0] == 0 and (first[1].width, first[1].height) == (1, 1)  # nothing seen yet
    assert ran.results.sensors["deep"]["readings"] == 2
    uncut, cut = depths(before[1]), depths(after[1])
    f = 0.5 * 60 / np.tan(np.pi / 6)
    middle_row = 20  # Y runs up, rows run down; the slot is at Y 15 to 25, Z -3, under the lens at Z 100
    assert uncut[middle_row, 30] == pytest.approx(0.1, abs=1e-6)
    assert cut[middle_row, 30] == pytest.approx(0.103, abs=1e-6)
    slot = np.flatnonzero(np.abs(cut[:, 30] - 0.103) < 1e-4)
    assert len(slot) == pytest.approx(10.0 * f / 103.0, abs=1.0)
    assert before[1].frame_id == "camera/deep"


def test_depths_in_whole_millimetres(tmp_path: Path) -> None:
    sensor = (
        f"  deep: {{type: depth_camera, {ABOVE}, width: 60, height: 40, trigger: M111, encoding: 16UC1, save: true}}\n"
    )

    run_with(sensor, out=tmp_path)

    after = depths(messages(tmp_path / "run.mcap", "/camera/deep/depth")[-1][1])
    assert after[20, 30] == 103 and after.dtype == np.uint16
    assert sorted(path.name for path in tmp_path.glob("*.png")) == (
        [f"deep_000{k}{suffix}.png" for k in (1, 2) for suffix in ("", "_depth")]
    )


def test_pictures_and_their_calibration_are_in_the_log(tmp_path: Path) -> None:
    ran = run_with(
        f"  eye: {{type: camera, {ABOVE}, width: 60, height: 40, trigger: M111, save: true}}\n", out=tmp_path
    )

    (_, _), (t_ns, picture), (_, later) = messages(tmp_path / "run.mcap", "/camera/eye/image")
    calibration = messages(tmp_path / "run.mcap", "/camera/eye/calibration")[1][1]

    assert (picture.format, picture.frame_id) == ("png", "camera/eye")
    assert picture.data == (tmp_path / "eye_0001.png").read_bytes()
    assert picture.data != later.data
    assert (calibration.width, calibration.height) == (60, 40)
    assert list(calibration.K)[2] == 29.5
    frames = {frame.child_frame_id for _, m in messages(tmp_path / "run.mcap", "/tf_static") for frame in m.transforms}
    assert "camera/eye" in frames
    assert t_ns % ran.shop.cell.simulation.step_ns == 0
    assert not ran.bad


def test_reading_changes_no_number_and_does_not_depend_on_the_log(tmp_path: Path) -> None:
    sensors = (
        f"  eye: {{type: camera, {ABOVE}, width: 60, height: 40, period: 0.1 s, noise: 0.01}}\n"
        "  line: {type: line_scanner, in: machine/flange, xyz: [0, 50, 0], period: 0.13 s, noise: 20 um}\n"
    )
    without = run_texts(PROGRAM, HEAD)

    plain, logged = run_with(sensors), run_with(sensors, out=tmp_path)

    assert plain.results.sensors == logged.results.sensors
    assert plain.results.sensors["eye"]["readings"] > 20
    for name in ("stocks", "tools", "joints"):
        assert plain.results.as_json()[name] == without.results.as_json()[name]


def test_a_camera_in_the_magazine_sees_when_it_is_in_use(tmp_path: Path) -> None:
    program = PROGRAM.replace("M30", "T9 M6 G43 H9\nG0 X30 Y20 Z100\nM110\nM30").replace("M111\n", "M110\n")

    ran = run_with(f"  eye: {{type: camera, {ABOVE}, width: 60, height: 40}}\n", program, tmp_path)

    assert (ran.results.sensors["eye"]["readings"], ran.results.sensors["T9"]["readings"]) == (3, 1)
    assert messages(tmp_path / "run.mcap", "/camera/T9/image")[1][1].frame_id == "tool"


def test_a_profile_on_a_link_moves_with_it(tmp_path: Path) -> None:
    sensor = "  line: {type: line_scanner, in: machine/flange, period: 0.5 s, save: true, range: [1, 900 mm]}\n"
    program = "G21 G90 G54\nT1 M6 G43 H1\nG0 X30 Y60 Z50\nG1 Y-20 F2400\nM30\n"

    run_with(sensor + "", program.replace("T1 M6 G43 H1\n", ""), tmp_path)

    rows = list(csv.DictReader((tmp_path / "line_readings.csv").open()))
    on_top = [row for row in rows if abs(float(row["world_z_mm"]) + 300.0) < 0.01]
    assert {row["reading"] for row in on_top} > {"2"} or len({row["reading"] for row in on_top}) > 1
    places = {float(row["world_y_mm"]) for row in on_top}
    assert len(places) > 1 and all(300.0 <= y <= 340.0 for y in places)
    assert {float(row["y_mm"]) for row in rows} == {0.0}


def test_a_force_sensor_feels_the_weight_of_the_tool_and_the_cut(tmp_path: Path) -> None:
    ran = run_with("  force: {type: force_sensor, in: machine/flange}\n", out=tmp_path)

    felt = messages(tmp_path / "run.mcap", "/sensor/force/wrench")
    process = {t: np.array([w.force.x, w.force.y, w.force.z]) for t, w in messages(tmp_path / "run.mcap", "/wrench")}
    still = [np.array([w.force.x, w.force.y, w.force.z]) for t, w in felt if t > 0 and not process[t].any()]
    weight = np.array([0.0, 0.0, 2.0 * 9.80665])  # Z of the flange looks down
    assert min(np.abs(force - weight).max() for force in still) < 1e-9
    turn = np.diag([1.0, -1.0, -1.0])
    R = _flange_axes(ran)
    cutting = [(np.array([w.force.x, w.force.y, w.force.z]), process[t]) for t, w in felt if process[t].any()]
    steady = [(a, b) for a, b in cutting[5:-5]]
    assert steady and turn.shape == (3, 3)
    for force, own in steady:
        np.testing.assert_allclose(force, R.T @ own + weight, atol=0.5)


def _flange_axes(ran: Ran) -> np.ndarray:
    X = ran.shop.kinematics.forward(np.asarray(ran.shop.home, dtype=float)[None])[0]
    return ran.shop.X_WB.R @ X[:3, :3]


def test_an_output_that_rises_has_it_read() -> None:
    program = PROGRAM.replace("M111", "M64 P3", 1).replace("M111", "M65 P3\nM64 P3\nM64 P3")

    ran = run_with(f"  eye: {{type: camera, {ABOVE}, width: 8, height: 8, trigger: M64 P3}}\n", program)

    assert ran.results.sensors["eye"]["readings"] == 2


def test_a_sensor_that_never_reads_is_told() -> None:
    sensor = f"  eye: {{type: camera, {ABOVE}, width: 8, height: 8, trigger: M122}}\n"
    ran = run_with(sensor, PROGRAM.replace("M111\n", ""))

    told = [finding for finding in ran.results.findings if finding.code == "GS591"]
    assert [(finding.span.line, "`eye`" in finding.message) for finding in told] == [(12, True)]


def test_what_reads_too_often_is_told_and_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(eyes, "MOST_SIGHTS", 7)

    ran = run_with(f"  eye: {{type: camera, {ABOVE}, width: 8, height: 8, period: 10 ms}}\n")

    (told,) = [finding for finding in ran.results.findings if finding.code == "GS590"]
    assert ran.results.sensors["eye"]["readings"] == 7
    assert told.value is not None and told.value > 100


def test_old_files_of_a_sensor_are_removed_and_those_of_others_kept(tmp_path: Path) -> None:
    sensor = f"  eye: {{type: camera, {ABOVE}, width: 8, height: 8, period: 1 s, save: true}}\n"
    run_with(sensor, out=tmp_path)
    many = len(list(tmp_path.glob("eye_*.png")))

    run_with(sensor.replace("1 s", "3 s"), out=tmp_path)
    assert 0 < len(list(tmp_path.glob("eye_*.png"))) < many

    (tmp_path / "eye_0009.png").write_bytes(b"a picture of somebody else")
    cell = read_cell(SourceText("cell.yaml", f"{HEAD}sensors:\n{sensor}".encode()), Path("cell.yaml"))
    from gcodesim.simulation import prepare, run

    results, _ = run(prepare(SourceText("program.nc", PROGRAM.encode()), cell), tmp_path)
    assert "GS750" in {finding.code for finding in results.findings}
    assert (tmp_path / "eye_0009.png").read_bytes() == b"a picture of somebody else"


@pytest.mark.parametrize(
    ("sensor", "code", "says"),
    [
        ("{type: camera, width: 100000, height: 100000}", "GS710", "8192"),
        ("{type: depth_camera, width: 3000, height: 3000}", "GS720", "9000000 pixels"),
        ("{type: camera, period: 0}", "GS710", "period"),
        ("{type: camera, in: nowhere}", "GS712", "nowhere"),
        ("{type: camera, trigger: G1}", "GS711", "trigger"),
        ("{type: force_sensor, in: world}", "GS719", "flange"),
        ("{type: radar}", "GS711", "radar"),
        ("{type: camera, widht: 3}", "GS704", "widht"),
    ],
)
def test_sensors_that_cannot_be(sensor: str, code: str, says: str) -> None:
    loaded = read_cell(SourceText("cell.yaml", f"{HEAD}sensors:\n  s: {sensor}\n".encode()), Path("cell.yaml"))

    found = [(f.code, says in f.message + f.hint) for f in loaded.findings]

    assert (code, True) in found


def test_an_order_that_no_sensor_obeys_is_an_error() -> None:
    head = HEAD.replace("  9: {type: camera, width: 60, height: 40, field_of_view: 60 deg, length: 100}\n", "")
    loaded = read_cell(SourceText("cell.yaml", head.encode()), Path("cell.yaml"))

    assert [f.code for f in loaded.findings] == ["GS735"]


def test_a_cell_shows_its_sensors() -> None:
    cell = read_cell(
        SourceText("cell.yaml", f"{HEAD}sensors:\n  eye: {{type: camera, {ABOVE}, trigger: M62 P1}}\n".encode()),
        Path("cell.yaml"),
    ).cell
    assert cell is not None

    shown = cell_as_json(cell)

    eye = shown["cell"]["sensors"]["eye"]
    assert (eye["type"], eye["trigger"], eye["in"], eye["width"]) == ("camera", "M62 P1", "G54", 640)
    assert shown["places"]["sensor eye"]["xyz_mm"] == [530.0, 320.0, -200.0]

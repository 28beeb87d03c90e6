"""Whole runs with lasers, torches, jets and blasting guns: energy and volume balance, words that switch, misuse."""

from __future__ import annotations

import struct
import zlib
from math import cos, erf, pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from gcodesim.processes.melting import METALS, melting_energy
from tests.physics.runs import Ran, height_at, run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
frames: {{table: {{in: world, xyz: [400, 300, -400]}}}}
work_offsets: {{G54: {{in: table}}}}
stock: {{min: [0, 0, -6], max: [60, 40, 0], in: table, material: al6082_t6, resolution: 0.25}}
{more}
tools: {{1: {tool}}}
"""
TRACK = """G21 G90 G61
T1 M6
G43 H1
G0 X10 Y20 Z0
{on}
G1 X50 F{feed}
{off}
G0 Z20
M2
"""
LASER = "{type: laser, diameter: 1, power: 100 W, length: 60, specific_energy: 10 J/mm^3, absorptivity: 0.5}"
JET = "{type: jet, diameter: 2, removal_rate: 8 mm^3/s, length: 60}"
SWITCH = "m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}"
POWER = "signals: {power: {word: S, per: 1 W}}"


def go(
    tool: str, more: str, on: str, off: str, out: Path | None = None, *, feed: float = 240.0, track: str = TRACK
) -> Ran:
    return run_texts(track.format(on=on, off=off, feed=feed), CELL.format(tool=tool, more=more), out)


def test_the_balance_of_energy_of_a_laser() -> None:
    """0.5 · 80 W · 10 s / 10 J/mm³ = 40 mm³, all of it out of the stock; nothing is pushed."""
    ran = go(LASER, POWER, "S80 M3", "M5")
    (tool,) = ran.results.tools

    assert not ran.bad
    assert tool["beam_energy_J"] == pytest.approx(800.0, rel=2e-3)
    assert tool["landed_energy_J"] == pytest.approx(tool["beam_energy_J"], rel=1e-9)
    assert ran.stock.removed * 1e9 == pytest.approx(0.5 * tool["beam_energy_J"] / 10.0, rel=1e-6)
    assert ran.stock.initial - ran.stock.remaining == pytest.approx(ran.stock.removed, rel=1e-9)
    beside = sqrt(pi / 8) * 0.5 * erf(sqrt(2) * 0.25 / 0.5) / 0.25  # mean over the column beside the middle
    assert tool["max_fluence_J_m2"] * 1e-6 == pytest.approx(sqrt(2 / pi) * 80 / (0.5 * 4) * beside, rel=0.01)
    assert tool["max_force_N"] == 0.0


def test_the_dose_is_a_picture_an_array_and_a_result(tmp_path: Path) -> None:
    """Also of a laser that takes nothing: all that landed is in the map, white where most did."""
    ran = go(LASER.replace("specific_energy: 10 J/mm^3", "threshold: 1000 J/mm^2"), POWER, "S80 M3", "M5", tmp_path)
    dose = ran.stock.as_json()["doses"]["fluence"]
    values = np.load(tmp_path / "stock.fluence.npy")
    raw = (tmp_path / "stock.fluence.png").read_bytes()

    assert ran.stock.removed == 0.0
    assert values.shape == (160, 240) and dose["unit"] == "J/mm^2" and dose["total_unit"] == "J"
    assert dose["total"] == pytest.approx(ran.results.tools[0]["landed_energy_J"], rel=1e-6)
    assert values.sum() * 0.25 * 0.25 == pytest.approx(dose["total"], rel=1e-5)
    assert values.max() == pytest.approx(dose["greatest"], rel=1e-6)
    assert values[80, 120] > 20.0 and values[80, 20] == values[20, 120] == 0.0
    picture = png_points(raw)
    assert picture.max() == 255 and picture[160 - 1 - 80, 120] > 200 and picture[160 - 1 - 20, 120] == 0
    again = tmp_path / "again"
    go(LASER.replace("specific_energy: 10 J/mm^3", "threshold: 1000 J/mm^2"), POWER, "S80 M3", "M5", again)
    for name in ("stock.fluence.png", "stock.fluence.npy", "results.json"):
        assert (again / name).read_bytes() == (tmp_path / name).read_bytes()


def png_points(raw: bytes) -> np.ndarray:
    """The points of a grey picture of 8 bits whose rows have no filter; sums of its chunks are checked."""
    assert raw[:8] == b"\x89PNG\r\n\x1a\n"
    at, data, size = 8, b"", (0, 0)
    while at < len(raw):
        length, kind = struct.unpack(">I4s", raw[at : at + 8])
        content = raw[at + 8 : at + 8 + length]
        assert struct.unpack(">I", raw[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + content)
        if kind == b"IHDR":
            size = struct.unpack(">II", content[:8])
        data += content if kind == b"IDAT" else b""
        at += 12 + length
    rows = np.frombuffer(zlib.decompress(data), dtype=np.uint8).reshape(size[1], size[0] + 1)
    assert not rows[:, 0].any()
    return rows[:, 1:]


def test_metals_take_what_melts_them() -> None:
    """Aluminium: 2700 kg/m³ · (897 J/kgK · 640.3 K + 397 kJ/kg) = 2.62 J/mm³."""
    needed = melting_energy(METALS["aluminium"])
    ran = go("{type: laser, diameter: 2, power: 100 W, length: 60}", POWER, "S20 M3", "M5")

    assert needed * 1e-9 == pytest.approx(2.623, abs=0.001)
    assert ran.stock.removed == pytest.approx(ran.results.tools[0]["landed_energy_J"] / needed, rel=1e-6)


def test_a_jet_goes_as_deep_as_the_closed_form() -> None:
    """8 mm³/s / (2 mm · 4 mm/s) = 1 mm."""
    ran = go(JET, SWITCH, "M10", "M11")

    assert not ran.bad
    assert ran.stock.removed * 1e9 == pytest.approx(80.0, rel=2e-3)
    floor = [height_at(ran, 30e-3, y) for y in np.linspace(19.3e-3, 20.7e-3, 6)]
    assert np.mean(floor) * 1e3 == pytest.approx(-1.0, abs=0.06)


def test_abrasive_by_half_goes_half_as_deep() -> None:
    signals = f"{SWITCH}\nsignals: {{abrasive: {{word: M67 E1, per: 1 %}}}}"
    ran = go(JET, signals, "M67 E1 Q50\nM10", "M11")

    assert ran.stock.removed * 1e9 == pytest.approx(40.0, rel=2e-3)


def test_a_spray_of_sand_wears_what_it_strikes() -> None:
    tool = "{type: sand_blaster, diameter: 8, removal_rate: 2 mm^3/s, length: 200}"
    ran = go(tool, SWITCH, "M10", "M11")

    assert not ran.bad
    assert ran.stock.removed * 1e9 == pytest.approx(20.0, rel=5e-3)
    assert ran.results.tools[0]["max_wear_mm"] == pytest.approx(2 * 10 / 40 / 4 * sqrt(2 / pi), rel=0.03)


@pytest.mark.parametrize("word", ["M67 E0 Q{}", "M68 E0 Q{}"])
def test_the_words_of_linuxcnc_give_power(word: str) -> None:
    ran = go(LASER, "signals: {power: {word: M67 E0, per: 1 W}}", word.format(80), word.format(0))

    assert not ran.bad and not ran.results.not_simulated
    assert ran.results.tools[0]["beam_energy_J"] == pytest.approx(800.0, rel=2e-3)


GRBL = "laser_mode: 1000\ndialect: grbl\nloaded_tool: 1"
GRBL_TRACK = """G21 G90
G0 X10 Y20 Z0
{on}
G1 X50 F{feed}
G0 Y10
G1 X30
{off}
G0 Z20
M2
"""


@pytest.mark.parametrize(("word", "least", "most"), [("M3", 1.1, 1.3), ("M4", 0.99, 1.01)])
def test_the_laser_mode_of_grbl(word: str, least: float, most: float) -> None:
    """Power is S over `laser_mode`; G0 is dark though the laser is on; M4 gives all of the way the same."""
    ran = go(LASER, GRBL, f"S800 {word}", "M5", track=GRBL_TRACK, feed=6000)
    energy = {row["line"]: row for row in csv_lines(ran)}

    assert not ran.bad
    at_full_speed = 80.0 * 60e-3 / 0.1  # J: what 60 mm get at 100 mm/s
    assert least < ran.results.tools[0]["beam_energy_J"] / at_full_speed < most
    assert float(energy["5"]["beam_energy_J"]) < 0.02 * at_full_speed


def csv_lines(ran: Ran) -> list[dict[str, str]]:
    import csv

    return list(csv.DictReader(ran.results.lines_csv().splitlines()))


def test_a_beam_in_a_rapid_is_an_error_with_its_line() -> None:
    ran = go(LASER, POWER, "S80 M3", "")

    assert ("GS540", 8) in ran.misuse
    assert ("GS503", 9) in ran.misuse


def test_a_power_that_is_left_on_by_an_output_is_told() -> None:
    ran = go(LASER, "signals: {power: {word: M67 E0, per: 1 W}}", "M67 E0 Q80", "")

    assert ("GS504", 9) in ran.misuse


def test_a_beam_that_strikes_nothing_and_one_that_is_never_on() -> None:
    beside = TRACK.replace("Y20", "Y60")
    assert go(JET, SWITCH, "M10", "M11", track=beside).misuse == [("GS541", 6)]
    assert go(JET, SWITCH, "", "").misuse == [("GS542", 6)]


def test_out_of_focus_and_beyond_its_power() -> None:
    high = TRACK.replace("Z0", "Z4")
    assert go(JET, SWITCH, "M10", "M11", track=high).misuse == [("GS543", 6)]
    assert go(LASER, POWER, "S120 M3", "M5").misuse == [("GS544", 6)]


def test_without_gas() -> None:
    signals = "signals: {power: {word: S, per: 1 W}, gas: {word: M64 P1}}"
    assert go(LASER, signals, "S80 M3", "M5").misuse == [("GS545", 6)]
    assert not go(LASER, signals, "M64 P1\nS80 M3", "M5").bad


def test_a_material_without_data_gets_a_dose_and_a_note() -> None:
    cell = CELL.replace("al6082_t6", "plywood").format(
        tool=LASER.replace("specific_energy: 10 J/mm^3, ", ""), more=POWER
    )
    ran = run_texts(TRACK.format(on="S80 M3", off="M5", feed=240), cell)

    assert ran.stock.removed == 0.0
    assert "GS546" in [finding.code for finding in ran.results.findings]
    assert ran.results.tools[0]["max_fluence_J_m2"] > 1e6


def test_a_dwell_drills() -> None:
    """A beam that stands goes on: 2 s at 40 W of 80 absorbed take 8 mm³."""
    ran = go(LASER, POWER, "S80 M3\nG4 P2", "M5", feed=24000)

    assert ran.results.tools[0]["beam_energy_J"] > 160.0


def test_an_arm_leans_its_jet() -> None:
    """30 degrees beside the plumb line: the same volume goes."""
    cell = """
gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}
frames: {table: {in: world, xyz: [650, 0, 300]}, lean: {in: table, xyz: [30, 20, 0], rpy: [30, 0, 0]}}
work_offsets: {G54: {in: lean}}
orientation: {tool_axis: -Z of lean}
stock: {min: [0, 0, -6], max: [60, 40, 0], in: table, resolution: 0.25}
m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}
tools: {1: {type: jet, diameter: 2, removal_rate: 4 mm^3/s, length: 100}}
"""
    program = "G21 G90 G61\nT1 M6\nG43 H1\nG0 X-15 Y0 Z0\nM10\nG1 X15 F240\nM11\nG0 Z50\nM2\n"
    ran = run_texts(program, cell)

    assert [f.code for f in ran.bad if f.code.startswith("GS5")] == []
    assert ran.stock.removed * 1e9 == pytest.approx(4.0 * 7.5, rel=0.01)
    assert min(height_at(ran, 30e-3, y) for y in np.linspace(18e-3, 22e-3, 17)) > -2.2e-3 * cos(pi / 6)


ROUND = """G21 G90 G61
T1 M6
G43 H1
{on}
G0 X20 Y10 Z{z}
G1 X40 F600
G1 Y30
G1 X20
G1 Y{end}
G0 Z20
{off}
M2
"""
MILL = "{type: flat_end_mill, diameter: 3, length: 40}"


@pytest.mark.parametrize(("end", "lines"), [(10, [9]), (15, [])])
def test_a_mill_that_cuts_a_square_free_names_the_line(end: int, lines: list[int]) -> None:
    """17 x 17 x 6 mm fall out of the stock; a tab of 2 mm holds."""
    ran = run_texts(ROUND.format(on="S8000 M3", off="M5", z=-6.5, end=end), CELL.format(tool=MILL, more=""))
    told = [finding for finding in ran.results.findings if finding.code == "GS440"]
    fallen = ran.stock.as_json().get("fallen", [])

    assert [finding.span.line for finding in told] == [piece["line"] for piece in fallen] == lines
    volume = sum(piece["volume_mm3"] for piece in fallen)
    assert volume == pytest.approx(17 * 17 * 6 * len(lines), rel=0.03)
    assert ran.stock.remaining == pytest.approx(ran.stock.initial - ran.stock.removed, rel=1e-6)


@pytest.mark.parametrize(("z", "x", "told"), [(-30, 30, ["GS547"]), (-30, 55, []), (-250, 30, [])])
def test_a_jet_that_is_through_strikes_the_fixture_below(z: int, x: int, told: list[str]) -> None:
    """A block under the track; one beside it; one that is out of reach."""
    box = f"{{min: [{x}, 15, {z - 10}], max: [{x + 5}, 25, {z}], in: table}}"
    jet = JET.replace("8 mm^3/s", "200 mm^3/s")
    ran = go(jet, f"{SWITCH}\nfixtures: {{block: {box}}}", "M10", "M11")

    assert [finding.code for finding in ran.bad if finding.code.startswith("GS54")] == told
    assert not told or "block" in ran.bad[0].message

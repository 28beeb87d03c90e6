"""M66 waits for light barriers and proximity switches: as long as things take to get there, in both worlds."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.playback import Recording
from gcodesim.simulation import check, prepare
from tests.physics.runs import Ran, run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
frames: {table: {in: world, xyz: [400, 300, -400]}}
work_offsets: {G54: {in: table}}
stock: {box: [60, 20, 30], zero: bottom-center, in: table, xyz: [0, 200, 0], material: al6082_t6, resolution: 1}
devices:
  belt: {box: [400, 100, 20], zero: top-center, in: table, word: M64 P2, speed: 100 mm/s}
  door: {box: [10, 60, 60], zero: bottom-center, in: table, xyz: [0, -300, 0], word: M10/M11, travel: [0, 0, 250], travel_time: 2 s}
parts:
  box: {box: [40, 40, 40], zero: bottom-center, in: table, xyz: [-150, 0, 0], mass: 1 kg}
tools:
  1: {type: flat_end_mill, diameter: 12, flutes: 3, length: 60}
  2: {type: suction_gripper, length: 60, cups: [{at: [0, 0], diameter: 30}], vacuum: 60 kPa, mass: 0.5 kg}
m_codes: {M62 P1: {gripper: close}, M63 P1: {gripper: open}}
sensors:
  gate: {type: light_barrier, in: table, xyz: [50, -80, 20], beam: [0, 160, 0]}
  stop: {type: proximity_switch, in: table, xyz: [190, 0, 10], rpy: [0, -90, 0], range: 30 mm, normally_closed: true}
  low: {type: light_barrier, in: table, xyz: [-100, -300, 30], beam: [200, 0, 0]}
  slot: {type: light_barrier, in: table, xyz: [-50, 200, 26], beam: [100, 0, 0]}
inputs: {P4: {sensor: gate}, P5: {sensor: stop}, P6: {sensor: low}, P7: {sensor: slot}}
"""  # noqa: E501

TICK = 0.004
"""[s] of a step: what M66 may read late, once when the sensor is asked and once when it answers."""


def go(program: str, out: Path | None = None, world: str = "kinematic") -> Ran:
    return run_texts("G21 G90\n" + program + "M2\n", CELL, out, world=world)


def checked(program: str) -> object:
    loaded = read_cell(SourceText("cell.yaml", CELL.encode()), Path("cell.yaml"))
    return check(prepare(SourceText("p.nc", f"G21 G90\n{program}M2\n".encode()), loaded))


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_m66_waits_until_a_part_on_a_belt_breaks_the_beam(world: str, tmp_path: Path) -> None:
    """The front of the part has 180 mm to go at 100 mm/s, then 110 mm to within 30 mm of the switch."""
    program = "G0 Z110\nM64 P2\nM66 P4 L3 Q10\nM66 P5 L4 Q10\nM65 P2\nG0 Z120\n"

    ran = go(program, tmp_path, world)

    assert not ran.bad
    assert ran.results.times.dwell == pytest.approx(1.8 + 1.1, abs=4 * TICK)
    assert checked(program).times.dwell == ran.results.times.dwell  # type: ignore[attr-defined]
    x = Recording.open(tmp_path).frames().in_world("part/box")[-1, 0, 3]
    assert x == pytest.approx(0.4 + 0.16 - 0.02, abs=0.1 * 4 * TICK)
    state = Recording.open(tmp_path).results["sensors"]["gate"]
    assert (state["type"], state["readings"]) == ("light_barrier", 1)


def test_the_beam_sees_a_part_that_a_gripper_has_brought() -> None:
    """The part is set down in the beam; the belt stands still. `check` moves it as the run does."""
    program = (
        "T2 M6\nG43 H2\nG0 X-150 Y0 Z60\nM66 P4 L0\nZ40\nM62 P1\nZ60\nX50\nG1 Z40 F3000\nM63 P1\nG0 Z80\n"
        "M66 P4 L0\no100 if [#5399 EQ 1]\nG4 P3\no100 endif\n"
    )

    ran = go(program)

    assert not ran.bad
    assert ran.results.times.dwell > 3.0
    assert checked(program).times.dwell == ran.results.times.dwell  # type: ignore[attr-defined]


def test_a_door_opens_the_beam_and_links_tools_and_stock_break_one() -> None:
    door = go("G0 Z110\nM10\nM66 P6 L4 Q5\n")
    assert door.results.times.dwell == pytest.approx(2.0 * 30.0 / 250.0, abs=4 * TICK)  # its lower edge passes 30 mm

    ask = "M66 P7 L0\no{0} if [#5399 EQ 1]\nG4 P{1}\no{0} endif\n"
    slot = "T1 M6\nG43 H1\nS8000 M3\nG0 X-50 Y200 Z60\nG0 Z25\nG1 X50 F3000\nG0 Z60\nM5\n"
    stock = go(ask.format(100, 1) + slot + ask.format(101, 10) + "G0 X0 Y200\nG0 Z25.5\n" + ask.format(102, 100))
    assert stock.results.times.dwell == pytest.approx(1.0 + 100.0, abs=6 * TICK)  # stock; nothing; tool


def test_a_wait_in_vain_is_told_with_its_line_and_what_is_there() -> None:
    ran = go("G0 Z110\nM66 P4 L3 Q0.5\nM66 P6 L4 Q0.5\n")

    found = [(f.code, f.span.line, f.message) for f in ran.results.findings]
    assert [each[:2] for each in found] == [("GS592", 3), ("GS592", 4)]
    assert "nothing is in its beam" in found[0][2] and "`door` is in its beam" in found[1][2]


TWO = """
gcodesim: 1
robots:
  a: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}
  b: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], base: {xyz: [0, 3000, 0]}}
channels:
  first: {robot: a, inputs: {P4: {sensor: gate}}}
  second: {robot: b, program: second.nc}
sensors:
  gate: {type: light_barrier, in: world, xyz: [0, 5000, 20], beam: [0, 160, 0]}
simulation: {world: kinematic}
"""


@pytest.mark.parametrize(("question", "told"), [("M66 P4 L0\n", [("GS593", 2)]), ("G4 P1\n", [])])
def test_a_sensor_that_is_asked_while_another_program_runs_is_told(
    question: str, told: list[tuple[str, int]], tmp_path: Path
) -> None:
    (tmp_path / "second.nc").write_text("G4 P1\nM2\n")

    ran = run_texts(f"G21 G90\n{question}M2\n", TWO, folder=tmp_path)

    assert [(f.code, f.span.line) for f in ran.results.findings if f.code == "GS593"] == told
    assert not [f for f in ran.bad if f.code != "GS593"]


@pytest.mark.parametrize(
    ("wired", "code"), [("{sensor: gatw}", "GS712"), ("{sensor: eye}", "GS711"), ("{sensors: gate}", "GS706")]
)
def test_inputs_that_cannot_be_read(wired: str, code: str) -> None:
    text = CELL.replace("P4: {sensor: gate}", f"P4: {wired}")
    text = text.replace("\nsensors:\n", "\nsensors:\n  eye: {type: camera}\n")

    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))

    assert [f.code for f in loaded.findings] == [code]


def test_a_first_block_may_ask() -> None:
    ran = go("M66 P4 L0\nG0 Z110\n")

    assert not ran.bad

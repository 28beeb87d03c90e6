"""Grips against closed forms, in both worlds: a part follows, is lost where statics says so, and stays there."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from gcodesim.calculator import CALCULATORS
from gcodesim.diagnostics import Severity
from gcodesim.executor import part_run
from gcodesim.playback import Recording
from gcodesim.scene import CarriedParts
from gcodesim.world.protocol import STANDARD_GRAVITY
from tests.physics.runs import Ran, run_texts

WORLDS = ("kinematic", "bullet")
G = -STANDARD_GRAVITY[2]
CELL = """
gcodesim: 1
machine:
  axes:
    X: {{travel: [0, 1000 mm], speed: 1 m/s, acceleration: 5 m/s^2}}
    Y: {{travel: [0, 600 mm], speed: 1 m/s, acceleration: 5 m/s^2}}
    Z: {{travel: [-600 mm, 0], speed: 1 m/s, acceleration: 5 m/s^2}}
frames: {{table: {{in: world, xyz: [400, 300, -500]}}}}
work_offsets: {{G54: {{in: table}}}}
m_codes: {{M62 P1: {{gripper: close}}, M63 P1: {{gripper: open}}}}
loaded_tool: 1
tools:
  1: {tool}
parts:
  block: {{box: [40, 40, 60], zero: bottom-center, mass: 2 kg, in: table, xyz: [0, 0, {z}], friction: {friction}{more}}}
"""
CARRY = """G21 G90 G17 G94
G43 H1
G0 Z100
G0 X0 Y0
G1 Z{grip} F3000
M62 P1
G4 P0.1
G1 Z150 F60000
G1 X200
G1 Z{put} F6000
M63 P1
G4 P0.1
G0 Z150
M2
"""


def go(
    tool: str,
    out: Path | None = None,
    *,
    world: str = "kinematic",
    program: str = CARRY,
    grip: float = 40,
    put: float | None = None,
    z: float = 0.0,
    friction: float = 0.5,
    more: str = "",
) -> Ran:
    text = program.format(grip=grip, put=grip if put is None else put)
    return run_texts(text, CELL.format(tool=tool, z=z, friction=friction, more=more), out, world=world)


def fingers(force: float) -> str:
    return "{type: finger_gripper, stroke: 60, force: " + f"{force:.6f}" + " N, length: 120}"


def cups(vacuum: float) -> str:
    return "{type: suction_gripper, length: 100, vacuum: " + f"{vacuum:.6f}" + " kPa, cups: [{diameter: 30}]}"


def block(ran: Ran) -> dict:
    return ran.results.as_json()["parts"]["block"]


@pytest.mark.parametrize("world", WORLDS)
def test_a_strong_gripper_carries_the_part_and_sets_it_down(world: str, tmp_path: Path) -> None:
    ran = go(fingers(40), tmp_path, world=world, more=", goal: {in: table, xyz: [200, 0, 0]}")

    assert not ran.bad
    end = block(ran)
    assert (end["x_mm"], end["y_mm"], end["z_mm"]) == pytest.approx((600.0, 300.0, -500.0), abs=1e-4)
    assert end["pose_error_mm"] < 1e-4 and end["error_from"] == "goal"
    assert (end["held_by"], end["grips"], end["falls"]) == (None, 1, 0)
    (tool,) = ran.results.as_json()["tools"]
    assert tool["max_grip_needed_N"] == pytest.approx(2.0 * (G + 5.0) / (2 * 0.5), rel=1e-6)
    X = Recording.open(tmp_path).frames()
    part, tip = X.in_world("part/block"), X.in_world("tcp")
    carried = part[:, 2, 3] > -0.5 + 1e-4
    assert carried.any()
    assert np.ptp((part - tip)[carried][:, :3, 3], axis=0).max() < 1e-5  # it follows the tip


@pytest.mark.parametrize("world", WORLDS)
def test_a_weak_gripper_loses_the_part_at_the_line_that_lifts(world: str) -> None:
    ran = go(fingers(25), world=world)

    assert ran.misuse == [("GS560", 8)]
    assert "needs 29.6 N, has 25 N" in ran.bad[0].message
    assert ran.bad[0].value == pytest.approx(2.0 * (G + 5.0), rel=1e-6)
    end = block(ran)
    assert (end["x_mm"], end["z_mm"], end["falls"]) == pytest.approx((400.0, -500.0, 1), abs=1e-3)


@pytest.mark.parametrize("friction", [0.2, 0.4, 0.7])
def test_the_force_that_just_holds_is_that_of_coulomb(friction: float) -> None:
    force = 2.0 * (G + 5.0) / (2.0 * friction)

    assert not go(fingers(1.001 * force), friction=friction).bad
    assert go(fingers(0.999 * force), friction=friction).misuse == [("GS560", 8)]


def test_suction_holds_as_much_as_vacuum_times_area() -> None:
    """Lifting straight up takes F = dp A; there is so much friction that the way aside takes less."""
    program = CARRY.replace("G94", "G94 G61.1")
    area = np.pi / 4.0 * 0.030**2
    vacuum = 2.0 * (G + 5.0) / area * 1e-3
    program = program.replace("G1 X200\n", "")

    assert not go(cups(1.001 * vacuum), program=program, grip=60).bad
    found = go(cups(0.999 * vacuum), program=program, grip=60)
    assert found.misuse == [("GS560", 8)]
    assert found.bad[0].value == pytest.approx(2.0 * (G + 5.0), rel=1e-3)


def test_a_cup_beside_the_part_holds_nothing() -> None:
    assert go(cups(60), program=CARRY.replace("X0 Y0", "X10 Y0"), grip=60).misuse == [("GS561", 6)]


def test_closing_on_nothing_is_told() -> None:
    assert go(fingers(40), grip=80).misuse == [("GS561", 6)]


def test_a_part_wider_than_the_gripper_opens_is_told() -> None:
    ran = go("{type: finger_gripper, stroke: 30, force: 40 N, length: 120}")

    assert ran.misuse == [("GS309", 5), ("GS562", 6)]  # the fingers come down on it, and cannot close
    assert "40 mm wide" in ran.bad[1].message and "opens 30 mm" in ran.bad[1].message


@pytest.mark.parametrize("world", WORLDS)
def test_a_part_let_go_in_the_air_falls_and_lies_still(world: str, tmp_path: Path) -> None:
    ran = go(fingers(40), tmp_path, world=world, put=90)

    assert ran.misuse == [("GS564", 11)]
    assert ran.bad[0].value == pytest.approx(50.0, abs=0.01)
    end = block(ran)
    assert end["z_mm"] == pytest.approx(-500.0, abs=0.1)
    assert end["falls"] == 1
    z = Recording.open(tmp_path).frames().in_world("part/block")[:, 2, 3]
    assert (np.diff(z)[-6:] == 0.0).all()


def test_a_part_lies_on_another_one() -> None:
    more = "}\n  plinth: {box: [80, 80, 30], zero: bottom-center, in: table, xyz: [200, 0, 0]"
    ran = go(fingers(40), put=70, more=more)

    assert not ran.bad
    assert block(ran)["on"] == "plinth" and block(ran)["z_mm"] == pytest.approx(-470.0, abs=1e-6)


STACK = """, goal: {{in: table, xyz: [200, 0, 0]}}}}
  cap: {{box: [30, 30, 20], zero: bottom-center, mass: 0.5 kg, in: table, xyz: [0, 0, 60],
    goal: {{in: table, xyz: [200, 0, 60]}}"""


@pytest.mark.parametrize("world", WORLDS)
def test_what_lies_on_a_part_at_the_start_goes_with_it(world: str, tmp_path: Path) -> None:
    """A cap of 0.5 kg on a block of 2 kg: the fingers bear both, and both come to their goals."""
    ran = go(fingers(60), tmp_path, world=world, grip=30, more=STACK.format())

    parts = ran.results.as_json()["parts"]
    assert {name: part["pose_error_mm"] for name, part in parts.items()} == pytest.approx(
        {"block": 0.0, "cap": 0.0}, abs=1e-4
    )
    assert (parts["cap"]["on"], parts["cap"]["above_mm"]) == ("block", 0.0)
    (gripper,) = ran.results.as_json()["tools"]
    assert gripper["max_grip_needed_N"] == pytest.approx(2.5 * (G + 5.0) / (2 * 0.5), rel=1e-6)


BENCH = "fixtures: {bench: {box: [900, 500, 20], zero: top-center, in: table}}\n"


@pytest.mark.parametrize(("z", "above"), [(0.0, 0.0), (0.3, 0.3), (30.0, 30.0)])
def test_how_far_a_part_hangs_above_what_is_drawn_below_it(z: float, above: float) -> None:
    """Nothing is said to lie on a floor while a bench is drawn below it."""
    cell = CELL.format(tool=fingers(40), z=z, friction=0.5, more="") + BENCH
    part = run_texts("G21\nG0 Z100\nM2\n", cell).results.as_json()["parts"]["block"]

    assert part["on"] == "bench" and part["above_mm"] == pytest.approx(above, abs=1e-6)


def test_a_goal_in_the_air_is_no_floor() -> None:
    """The goal is 30 mm above the bench, where the part is let go: it falls onto the bench."""
    cell = CELL.format(tool=fingers(40), z=0, friction=0.5, more=", goal: {in: table, xyz: [200, 0, 30]}") + BENCH
    ran = run_texts(CARRY.format(grip=40, put=70), cell)

    assert ran.misuse == [("GS564", 11)]
    assert ran.bad[0].value == pytest.approx(30.0, abs=1e-6)
    assert block(ran)["on"] == "bench" and block(ran)["pose_error_mm"] == pytest.approx(30.0, abs=1e-6)


def test_the_end_with_a_part_in_hand_is_a_note() -> None:
    ran = go(fingers(40), program=CARRY.replace("M63 P1\n", ""))

    assert not ran.bad
    assert block(ran)["held_by"] == "machine T1"
    assert [f.code for f in ran.results.findings if f.level == Severity.NOTE and f.code == "GS566"] == ["GS566"]


@pytest.mark.parametrize("world", WORLDS)
def test_motors_feel_the_part(world: str) -> None:
    lift = "G21 G90 G61.1\nG43 H1\nG0 X0 Y0\nG0 Z40\nM62 P1\nG4 P0.1\nG0 Z150\nM2\n"
    effort = [
        max(joint["max_effort"] for joint in go(fingers(200), world=world, program=text).results.joints[2:])
        for text in (lift, lift.replace("M62 P1\n", ""))
    ]

    assert effort[0] - effort[1] == pytest.approx(2.0 * (G + 5.0), rel=0.02)


def test_the_same_run_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one", "two"):
        go(fingers(25), tmp_path / name, world="bullet")
    for file in ("run.mcap", "results.json", "lines.csv"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()
    assert json.loads((tmp_path / "one" / "results.json").read_text())["parts"]["block"]["falls"] == 1


def test_the_calculator_knows_the_laws_of_a_run() -> None:
    """Closed forms by hand: 25 N hold 1.69 kg at 5 m/s²; two cups of 40 mm at 60 kPa have 150.8 N."""
    fingers_of = CALCULATORS["grip.friction"](mass=2.0, friction=0.5, force=25.0, acceleration=5.0).compute()
    cups_of = CALCULATORS["grip.suction"](cups=2, cup_diameter=0.04, vacuum=60e3, mass=8.0, g=9.81).compute()

    assert fingers_of["needed_force"] == pytest.approx(2.0 * (G + 5.0))
    assert not fingers_of["holds"] and fingers_of["max_mass"] == pytest.approx(25.0 / (G + 5.0))
    assert cups_of["force_per_cup"] == pytest.approx(60e3 * np.pi * 0.02**2)
    assert cups_of["max_vertical_accel"] == pytest.approx(2 * 60e3 * np.pi * 0.02**2 / 8.0 - 9.81)
    aside = CALCULATORS["grip.suction"](cups=1, cup_diameter=0.04, vacuum=60e3, mass=1.0, tilt=np.pi / 2, friction=0.5)
    assert aside.compute()["needed_force"] == pytest.approx(G / 0.5)


def test_the_fingers_move_in_the_log(tmp_path: Path) -> None:
    go("{type: finger_gripper, stroke: 60, force: 40 N, length: 120, closing_time: 0.2 s}", tmp_path)
    drawings = list(Recording.open(tmp_path).drawings("/scene/tool"))
    places = {round(float(shape.p[0]) * 1e3, 3) for _, content in drawings for each in content for shape in each.shapes}

    assert {35.0, -35.0, 25.0, -25.0} <= places  # 10 mm thick, 60 mm apart, and closed on 40 mm
    assert len(places) > 8  # on the way


def _to_and_fro(grips: int) -> str:
    there = "G1 Z40 F30000\nM62 P1\nG1 Z60\nG1 X{to}\nG1 Z40\nM63 P1\nG1 Z60\n"
    ways = there.format(to=50) + there.format(to=0)
    return f"G21 G90\nG43 H1\nG0 X0 Y0 Z60\no1 repeat [{grips // 2}]\n{ways}o1 endrepeat\nM2\n"


def test_a_thousand_grips_do_not_drift_and_leave_nothing_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is kept of the past does not grow with the grips; the work of each is the same."""
    kept: dict[int, int] = {}
    rests: dict[int, int] = {}
    now = 0
    forget, rest = CarriedParts.forget, part_run.gap_below

    def counting(self: CarriedParts, step: int) -> None:
        forget(self, step)
        kept[now] = max(kept.get(now, 0), *(len(changes) for changes in self._changes.values()))

    def resting(*given: object) -> object:
        rests[now] = rests.get(now, 0) + 1
        return rest(*given)

    monkeypatch.setattr(CarriedParts, "forget", counting)
    monkeypatch.setattr(part_run, "gap_below", resting)
    for now in (40, 1000):
        ran = go(fingers(60), program=_to_and_fro(now))
        end = block(ran)
        assert not ran.bad and (end["grips"], end["falls"]) == (now, 0)
        assert (end["x_mm"], end["y_mm"], end["z_mm"]) == pytest.approx((400.0, 300.0, -500.0), abs=1e-9)

    assert kept[1000] <= kept[40] + 2
    assert rests[1000] - rests[40] == 960


@pytest.mark.slow
def test_a_thousand_grips_do_not_drift() -> None:
    """To and fro 500 times: the part is where it was, to the bit, and the same run has the same results."""
    cell = """
gcodesim: 1
machine: gantry_xyz
frames: {table: {in: world, xyz: [400, 300, -400]}}
work_offsets: {G54: {in: table}}
m_codes: {M62 P1: {gripper: close}, M63 P1: {gripper: open}}
loaded_tool: 1
tools: {1: {type: finger_gripper, stroke: 60, force: 60 N, friction: 0.5, length: 120}}
fixtures: {deck: {box: [600, 300, 20], zero: top-center, in: table}}
parts: {plate: {box: [40, 40, 50], zero: bottom-center, in: table, mass: 0.5 kg, goal: {in: table}}}
"""
    grip = "G1 Z30 F30000\nM62 P1\nG4 P0.02\nG1 Z60\nG1 X{}\nG1 Z30\nM63 P1\nG4 P0.02\nG1 Z90\n"
    start = "G21 G90 G17 G94\nG43 H1\nG0 X0 Y0 Z100\no1 repeat [500]\n"
    program = start + grip.format(70) + grip.format(0) + "o1 endrepeat\nM2\n"

    first, second = (run_texts(program, cell).results.as_json() for _ in range(2))

    end = first["parts"]["plate"]
    assert end["grips"] == 1000 and end["falls"] == 0
    assert [end["pose_error_mm"], end["pose_error_deg"]] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert first == second

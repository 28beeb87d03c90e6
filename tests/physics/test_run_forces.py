"""Forces of whole runs against closed forms, and motors that cannot hold them."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from gcodesim.kinematics import model_path
from gcodesim.units import MM
from tests.physics.runs import run_texts

DATA = Path(__file__).parents[1] / "data" / "physics"
CASES = {case["id"]: case for case in json.loads((DATA / "milling.json").read_text())["cases"]}


def test_a_slot_on_a_rigid_gantry_feels_the_closed_form(tmp_path: Path) -> None:
    """V-MIL-02 through language, planning, stock, process and log: mean forces, torque, power within 3 %."""
    case = CASES["V-MIL-02"]
    tool, cut, law = (case["inputs"][key] for key in ("tool", "cut", "material"))
    want = {name: quantity["value"] for name, quantity in case["expected"].items()}
    names = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
    units = {name: "N/mm^2" if name.endswith("c") else "N/mm" for name in names}
    material = ", ".join(f"{name}: {law[name]} {units[name]}" for name in names)
    ran = run_texts(
        f"""G21 G90 G17 G94 G61
T1 M6
G43 H1
S{cut["spindle_rpm"]} M3
G0 X-8 Y15 Z5
G0 Z-{cut["ap_mm"]}
G1 X25 F{cut["feed_mm_min"]}
G0 Z20
M5
M2
""",
        f"""
gcodesim: 1
machine: gantry_xyz
work_offsets: {{G54: {{in: world, xyz: [400, 300, -200]}}}}
stock: {{min: [0, 0, -10], max: [40, 30, 0], in: G54, material: own, resolution: 0.25}}
materials:
  own: {{{material}, source: V-MIL-02}}
tools:
  1: {{type: flat_end_mill, diameter: 10, flutes: {tool["teeth"]}, helix: {tool["helix_deg"]}, length: 60}}
log: {{period: 4 ms}}
""",
        tmp_path,
    )
    assert not ran.bad
    x = ran.column("/motion", "x_m")[:, 0]
    rows = (x > 8 * MM) & (x < 20 * MM) & (ran.column("/process", "force_n")[:, 0] > 0.0)
    force = ran.column("/wrench", "force.x", "force.y", "force.z")[rows].mean(axis=0)
    torque, power, removal = ran.column("/process", "torque_nm", "power_w", "removal_m3_s")[rows].mean(axis=0)
    assert rows.sum() > 100
    assert force[0] == pytest.approx(want["mean_Fx_N"], rel=0.03)
    assert force[1] == pytest.approx(want["mean_Fy_N"], rel=0.03)
    assert force[2] == pytest.approx(0.0, abs=1e-6)
    assert torque == pytest.approx(want["mean_torque_Nm"], rel=0.03)
    assert power == pytest.approx(want["mean_power_W"], rel=0.03)
    assert removal * 1e9 == pytest.approx(want["mrr_mm3_s"], rel=0.03)


CORNER = """G21 G90 G17 G94 G61
T1 M6
G43 H1
S8000 M3
G0 X10 Y10
G0 Z2
G1 Z-1 F400
G1 X30
G0 Z20
M5
M2
"""

CORNER_CELL = """gcodesim: 1
machine: gantry_xyz
stock: {{box: [60, 40, 12], zero: top-front-left, material: al6082_t6, resolution: 0.5}}
tools:
  1: {{type: flat_end_mill, diameter: 6 mm}}
log: {{period: 40 ms}}
simulation: {{world: kinematic, rate: {rate} Hz}}
"""


def test_a_plunge_that_meets_a_slot_has_no_more_torque_than_either(tmp_path: Path) -> None:
    """A step with the corner in it did both at once: at 125 Hz the greatest torque was 1.4 times that of 2 kHz."""
    (often,), (rare,) = (run_texts(CORNER, CORNER_CELL.format(rate=r), tmp_path).results.tools for r in (2000, 125))

    assert rare["max_torque_Nm"] == pytest.approx(often["max_torque_Nm"], rel=1e-3)
    assert rare["max_force_N"] == pytest.approx(often["max_force_N"], rel=1e-3)


HEAVY = """G21 G90 G17 G94 G61
T1 M6
G43 H1
S3000 M3
G0 X-8 Y10 Z5
G0 Z-2
G1 X-6 F600
G1 X12
G0 Z20
M5
M2
"""

WEAK_CELL = """
gcodesim: 1
robots:
  arm:
    urdf: weak.urdf
    home: [0, -90, 90, 0, 90, 0]
    stiffness: {stiffness}
    payload: {{mass: 3 kg, xyz: [0, 0, 60]}}
frames:
  table: {{in: world, xyz: [600, 0, 300]}}
work_offsets: {{G54: {{in: table}}}}
orientation: {{tool_axis: -Z of G54, spin: free}}
stock: {{min: [0, 0, -10], max: [24, 20, 0], in: table, material: seed_42crmo4, resolution: 0.5}}
tools:
  1: {{type: flat_end_mill, diameter: 10, flutes: 2, length: 60}}
"""

MATERIAL = "material: seed_42crmo4, "

SHIPPED = "[1.5e5, 1.4e5, 9e4, 3e4, 2.5e4, 1.5e4 N·m/rad]"


def with_efforts(folder: Path, efforts: np.ndarray) -> None:
    """Write `weak.urdf`: the shipped KR 10 with other effort limits [N·m]."""
    tree = ET.parse(model_path("kuka_kr10_r1100_2"))
    limits = [joint.find("limit") for joint in tree.getroot().iter("joint") if joint.get("type") == "revolute"]
    for limit, effort in zip(limits, efforts, strict=True):
        assert limit is not None
        limit.set("effort", f"{effort:.6g}")
    tree.write(folder / "weak.urdf")


@pytest.mark.parametrize("stiffness", [SHIPPED, "rigid"])
@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_motors_that_carry_the_arm_but_not_the_cut(world: str, stiffness: str, tmp_path: Path) -> None:
    """Limits between what the air cut and the cut ask for: saturation is found on the first line that cuts."""
    with_efforts(tmp_path, np.full(6, 1e6))
    cell = WEAK_CELL.format(stiffness=stiffness)
    air = run_texts(HEAVY, cell.replace(MATERIAL, ""), world=world, folder=tmp_path)
    cut = run_texts(HEAVY, cell, world=world, folder=tmp_path)
    free, held = air.execution.joints.effort, cut.execution.joints.effort
    weakest = int(np.argmax(held / free))
    assert held[weakest] > 1.2 * free[weakest]
    efforts = np.full(6, 1e6)
    efforts[weakest] = 0.5 * (free[weakest] + held[weakest])
    with_efforts(tmp_path, efforts)
    weak = run_texts(HEAVY, cell, world=world, folder=tmp_path)
    # moving gears may chatter, too, and motors lack torque for moments only, which is a note
    assert [found for found in weak.misuse if found[0] not in ("GS230", "GS518")] == []
    [told] = [finding for finding in weak.results.findings if finding.code == "GS230"]
    assert told.span.line == 8 and f"joint_{weakest + 1}" in told.message
    idle = run_texts(HEAVY, cell.replace(MATERIAL, ""), world=world, folder=tmp_path)
    assert not idle.bad


def shipped_efforts() -> np.ndarray:
    joints = ET.parse(model_path("kuka_kr10_r1100_2")).getroot().iter("joint")
    limits = [joint.find("limit") for joint in joints if joint.get("type") == "revolute"]
    return np.array([float(limit.get("effort", "0")) for limit in limits if limit is not None])


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_all_motors_scaled_down(world: str, tmp_path: Path) -> None:
    """Every limit scaled alike, a little above what the arm needs for itself."""
    cell = WEAK_CELL.format(stiffness=SHIPPED)
    with_efforts(tmp_path, shipped_efforts())
    free = run_texts(HEAVY, cell.replace(MATERIAL, ""), world=world, folder=tmp_path).execution.joints.effort
    share = 1.05 * float((free / shipped_efforts()).max())
    with_efforts(tmp_path, share * shipped_efforts())
    idle = run_texts(HEAVY, cell.replace(MATERIAL, ""), world=world, folder=tmp_path)
    assert not idle.bad
    weak = run_texts(HEAVY, cell, world=world, folder=tmp_path)
    lines = [f.span.line for f in weak.bad if f.code == "GS230"]
    assert lines
    assert set(lines) == {8}

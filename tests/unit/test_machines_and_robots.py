"""Machines, robots, places and tools, from the cell file to what is cut."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Job, Options
from gcodesim.jobs.results import Results
from gcodesim.simulation import check, prepare, run

SLOT = """G21 G90 G54
T1 M6
G43 H1
M3 S8000
G0 X20 Y10 Z5
G1 Z-2 F200
G1 X40 F600
G0 Z5
M5
M2
"""
TOOLS = """tools:
  1: {type: flat_end_mill, diameter: 6, flutes: 2, length: 60}
  2: {type: flat_end_mill, diameter: 6, flutes: 2, length: 90}
"""
STOCK = "stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 0.5}\n"
ON_TABLE = STOCK.replace("zero", "in: G54, zero")
MM3 = 1e-9


def slot(depth: float) -> float:
    """Volume [m³] of the slot at `depth` [mm]."""
    return (6.0 * 20.0 + 9.0 * math.pi) * depth * MM3


def job_of(folder: Path, cell: str, program: str = SLOT, world: str = "kinematic") -> Job:
    (folder / "c.yaml").write_text("gcodesim: 1\n" + cell, encoding="utf-8")
    return prepare(SourceText("p.nc", program.encode()), load_cell(folder / "c.yaml"), Options(world=world))


def run_of(folder: Path, cell: str, program: str = SLOT, world: str = "kinematic") -> tuple[Job, Results]:
    job = job_of(folder, cell, program, world)
    return job, run(job)[0]


def codes(results: Results) -> list[str]:
    return [finding.code for finding in results.findings]


def axes(x: str = "", y: str = "", more: str = "") -> str:
    return (
        f"machine: {{axes: {{X: {{travel: [-300, 300], speed: 10 m/min{x}}}, "
        f"Y: {{travel: [-300, 300], speed: 10 m/min{y}}}, Z: {{travel: [-400, 0], speed: 10 m/min}}{more}}}}}\n"
    )


def cut_range(job: Job) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest x, y [m] of the columns that were cut."""
    assert job.shop is not None
    stock = job.shop.stocks["stock"].stock
    cut = np.argwhere(stock.relief().tops < stock.z_range[1] - 1e-4)
    return stock.origin + cut.min(axis=0) * stock.spacing, stock.origin + (cut.max(axis=0) + 1) * stock.spacing


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize("sides", [("", ""), (", side: table", ""), (", side: table", ", side: table")])
def test_the_slot_is_where_the_program_says_whichever_side_moves(tmp_path, sides, world):
    job, results = run_of(tmp_path, axes(*sides) + TOOLS + STOCK, world=world)
    assert results.stocks["stock"].removed == pytest.approx(slot(2.0), abs=results.stocks["stock"].error_bound)
    low, high = cut_range(job)
    assert low == pytest.approx([17e-3, 7e-3], abs=1e-9) and high == pytest.approx([43e-3, 13e-3], abs=1e-9)


def test_a_rotary_axis_without_a_place_takes_time_only_and_says_so(tmp_path):
    program = SLOT.replace("G0 X20", "G0 A90 X20")
    _, results = run_of(tmp_path, axes(more=", A: {travel: unlimited, speed: 90 deg/s}") + TOOLS + STOCK, program)
    assert "GS911" in codes(results)
    assert results.stocks["stock"].removed == pytest.approx(slot(2.0), abs=results.stocks["stock"].error_bound)


@pytest.mark.parametrize(
    ("old", "new", "depth"),
    [
        ("G43 H1", "G43 H1", 2.0),
        ("G43 H1", "G43 H2", 0.0),
        ("G43 H1", "G43.1 Z59", 3.0),
        ("G43 H1\n", "", 2.0),
        ("G43 H1", "G10 L1 P1 Z58\nG43 H1", 4.0),
        ("G1 Z-2", "G92 Z6\nG1 Z-2", 3.0),
        ("T1 M6", "M61 Q1", 2.0),
    ],
)
def test_the_tip_is_off_by_active_offset_less_true_length(tmp_path, old, new, depth):
    _, results = run_of(tmp_path, "machine: gantry_xyz\n" + TOOLS + STOCK, SLOT.replace(old, new))
    cut = results.stocks["stock"]
    assert cut.removed == pytest.approx(slot(depth), abs=max(cut.error_bound, 1e-18))


def test_two_setups_turned_over(tmp_path):
    at = "machine: gantry_xyz\nwork_offsets: {G54: {xyz: [500, 400, -200]}}\n" + TOOLS
    first = job_of(tmp_path, at + STOCK)
    one = run(first, tmp_path / "out1")[0].stocks["stock"]
    turned = "stock: {from: out1, in: G54, rpy: [180, 0, 0], xyz: [0, 60, -20]}\n"
    through = SLOT.replace("Y10", "Y50").replace("Z-2", "Z-18.5")  # the same place from below
    job, results = run_of(tmp_path, at + turned, through)
    two = results.stocks["stock"]
    assert two.initial == pytest.approx(one.remaining, rel=1e-12)
    assert two.removed == pytest.approx(slot(18.0), abs=two.error_bound + one.error_bound)
    assert job.shop is not None
    stock = job.shop.stocks["stock"].stock
    assert stock.intervals_at(30e-3, -10e-3) == []  # no floor is left
    assert "GS920" not in codes(results)


def arm(x: float, more: str = "") -> str:
    robot = f"robots: {{arm: {{model: kuka_kr10_r1100_2, stiffness: rigid{more}}}}}\n"
    return robot + f"work_offsets: {{G54: {{xyz: [{x}, 0, 200]}}}}\n" + TOOLS + ON_TABLE


def test_out_of_reach_says_where_and_by_how_much(tmp_path):
    program = SLOT.replace("G1 X40 F600", "G1 X40 F600\nX200\nX250\nX300")
    results = check(job_of(tmp_path, arm(1000.0), program))
    (finding,) = [finding for finding in results.findings if finding.code == "GS202"]
    assert finding.span.line == 8
    assert "wrist centre distance from joint 2" in finding.message and "1075.6 mm" in finding.message
    assert "% of the block" in finding.message and "3 further blocks" in finding.message
    assert finding.hint is not None and "shifted" in finding.hint


def test_a_joint_limit_is_another_text(tmp_path):
    results = check(job_of(tmp_path, arm(100.0)))
    (finding,) = [finding for finding in results.findings if finding.code == "GS203"]
    assert "joint_3" in finding.message and "156.0 deg" in finding.message


def test_what_has_no_effect_is_said(tmp_path):
    cell = """robots: {arm: {model: kuka_kr10_r1100_2}, b: {model: ur10e}, c: {model: ur10e}}
channels:
  main: {robot: arm, work_offsets: {G54: {xyz: [550, 0, 200]}}}
  side: {robot: b}
"""
    findings = check(job_of(tmp_path, cell + TOOLS + ON_TABLE)).findings
    said = {finding.code: finding.message for finding in findings}
    assert "`side`" in said["GS910"] and "`c`" in said["GS909"]


def test_a_robot_whose_mesh_cannot_be_read_still_runs(tmp_path):
    (tmp_path / "b.dae").write_bytes(b"<x/>")
    links = "".join(
        f'<link name="{n}">{v}<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" '
        'iyz="0"/></inertial></link>'
        for n, v in (
            ("base", ""),
            ("a", '<visual><geometry><mesh filename="b.dae"/></geometry></visual>'),
            ("b", ""),
            ("c", ""),
            ("d", ""),
        )
    )
    limit = '<limit lower="{}" upper="{}" velocity="2" effort="500"/>'
    joints = "".join(
        f'<joint name="{n}" type="{kind}"><parent link="{p}"/><child link="{c}"/><origin xyz="{o}"/>'
        f'<axis xyz="0 0 1"/>{limit.format(low, high)}</joint>'
        for n, kind, p, c, o, low, high in (
            ("j1", "revolute", "base", "a", "0 0 0.4", -3, 3),
            ("j2", "revolute", "a", "b", "0.4 0 0", -3, 3),
            ("j3", "prismatic", "b", "c", "0.3 0 0", -0.3, 0),
            ("j4", "revolute", "c", "d", "0 0 0", -3, 3),
        )
    )
    end = (
        '<link name="flange"/><joint name="f" type="fixed"><parent link="d"/><child link="flange"/>'
        '<origin rpy="3.141592653589793 0 0"/></joint>'
    )
    (tmp_path / "r.urdf").write_text(f'<robot name="scara">{links}{joints}{end}</robot>')
    cell = "robots: {arm: {urdf: r.urdf, home: [10, 30, -10 mm, 0]}}\nwork_offsets: {G54: {xyz: [500, 0, 200]}}\n"
    job = job_of(tmp_path, cell + TOOLS + ON_TABLE)
    results, _ = run(job, tmp_path / "out")
    assert "GS770" in codes(results) and results.status == "ok"
    assert results.stocks["stock"].removed == pytest.approx(slot(2.0), abs=results.stocks["stock"].error_bound)


MODELS = {
    "kuka_kr10_r1100_2": (600, 200),
    "kuka_kr210_r2700_2": (1500, 600),
    "ur10e": (700, 300),
    "abb_irb1200_5_90": (450, 150),
    "abb_irb6700_200_260": (1500, 700),
    "fanuc_m20ia": (900, 300),
    "kuka_kr10_r1100_sixx": (600, 200),
}


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize("model", MODELS)
def test_every_arm_mills_what_the_program_says(tmp_path, model, world):
    x, z = MODELS[model]
    cell = f"robots: {{arm: {{model: {model}, stiffness: rigid}}}}\nwork_offsets: {{G54: {{xyz: [{x}, 0, {z}]}}}}\n"
    _, results = run_of(tmp_path, cell + TOOLS + ON_TABLE, world=world)
    cut = results.stocks["stock"]
    assert results.status == "ok"
    assert cut.removed == pytest.approx(slot(2.0), abs=cut.error_bound)


@pytest.mark.parametrize("table", ["", ", rpy: [0, 30, 0]", ", rpy: [0, 0, 30]"])
def test_an_arm_stands_where_the_program_says_on_a_turned_table(tmp_path, table):
    from gcodesim.log.reader import read_messages

    cell = (
        "robots: {arm: {model: kuka_kr10_r1100_2, stiffness: rigid}}\n"
        f"frames: {{table: {{xyz: [550, 0, 200]{table}}}}}\nwork_offsets: {{G54: {{in: table}}}}\n"
    )
    job = job_of(tmp_path, cell + TOOLS + ON_TABLE, SLOT.replace("M2", "G4 P0.5\nM2"))
    run(job, tmp_path / "out")
    last = [message for _, message in read_messages(tmp_path / "out" / "run.mcap", "/motion")][-1]
    assert [last.x_m, last.y_m, last.z_m] == pytest.approx([0.040, 0.010, 0.005], abs=1e-6)


def test_an_arm_without_masses_follows_its_command_in_bullet(tmp_path):
    places = (
        ("base", "0 0 0.4", "0 0 1"),
        ("l1", "0.03 0 0", "0 1 0"),
        ("l2", "0 0 0.5", "0 1 0"),
        ("l3", "0 0 0.04", "1 0 0"),
        ("l4", "0.5 0 0", "0 1 0"),
        ("l5", "0.08 0 0", "1 0 0"),
    )
    body = '<link name="base"/>' + "".join(
        f'<link name="l{i}"/><joint name="j{i}" type="revolute"><parent link="{parent}"/><child link="l{i}"/>'
        f'<origin xyz="{xyz}"/><axis xyz="{axis}"/><limit lower="-3" upper="3" velocity="3" effort="300"/></joint>'
        for i, (parent, xyz, axis) in enumerate(places, 1)
    )
    body += (
        '<link name="flange"/><joint name="f" type="fixed"><parent link="l6"/><child link="flange"/>'
        '<origin rpy="0 1.5707963267948966 0"/></joint>'
    )
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{body}</robot>')
    cell = "robots: {arm: {urdf: r.urdf, home: [0, 0, 0.3, 0, 0.5, 0]}}\nwork_offsets: {G54: {xyz: [500, 0, 200]}}\n"
    _, results = run_of(tmp_path, cell + TOOLS + ON_TABLE, world="bullet")
    assert "GS769" in codes(results)
    assert results.stocks["stock"].removed == pytest.approx(slot(2.0), abs=results.stocks["stock"].error_bound)

"""A load at the tip: what flange and motors feel of it, how far the arm yields, and what that does to a cut."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent
from typing import Any

import numpy as np
import pytest

import gcodesim
from gcodesim.session import MisuseError

CELL = """\
gcodesim: 1
robots:
  arm: {{model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], stiffness: {stiffness}}}
frames: {{table: {{in: world, xyz: [600, 0, 300]}}}}
stock: {{plate: {{box: [40, 20, 10], in: table, resolution: 0.1, zero: top-front-left, material: al6082_t6}}}}
work_offsets: {{G54: {{in: table}}}}
orientation: {{tool_axis: -Z of G54}}
tools: {{1: {{type: flat_end_mill, diameter: 6 mm, flutes: 2, length: 60 mm{load}}}}}
{more}
magazine: {{change_time: 0 s}}
simulation: {{world: {world}}}
"""
SLOT = """\
G21 G90 G54
T1 M6
G43 H1
M3 S8000
G0 X-8 Y10 Z5
G1 Z-1 F3000
M64 P1
G1 X20 F1200
M65 P1
G0 Z20
M2
"""
SOFT = "[2e5, 2e5, 2e5, 5e4, 5e4, 5e4 N·m/rad]"
LOAD = ", load: {force: [0, 0, -80 N]}"


def _cell(folder: Path, *, load: str = "", world: str = "kinematic", stiffness: str = SOFT, more: str = "") -> Path:
    path = folder / "cell.yaml"
    path.write_text(CELL.format(load=load, world=world, stiffness=stiffness, more=more))
    return path


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize("frame", ["world", "tool"])
def test_flange_and_motors_carry_it(tmp_path: Path, world: str, frame: str) -> None:
    """Statics: the flange answers with -F, and -M - p x F about itself; the motors with -J^T of the wrench."""
    F, M = np.array([30.0, -20.0, 40.0]), np.array([1.0, 2.0, -3.0])
    with gcodesim.open_cell(_cell(tmp_path, world=world, stiffness="rigid"), world=world) as cell:
        arm, tool = cell.robot(), cell.tool(1)
        tool.couple(arm)
        cell.step(0.5)
        free = arm.joint_state
        tool.apply_tcp_force(F, M, frame=frame)
        cell.step(0.5)
        loaded = arm.joint_state
        kinematics, shop = cell._shop.kinematics, cell._shop
        X_BF = kinematics.forward(loaded.position[None])[0]
        R = X_BF[:3, :3] if frame == "tool" else shop.X_WB.R.T
        p = X_BF[:3, :3] @ shop.tool(1).X_FT.p
        wrench = np.concatenate([R @ F, R @ M + np.cross(p, R @ F)])
        J = kinematics.jacobian(loaded.position[None])[0]

        assert loaded.reaction - free.reaction == pytest.approx(-wrench, abs=2e-2)
        assert loaded.effort - free.effort == pytest.approx(-J.T @ wrench, abs=5e-2)

        tool.apply_tcp_force([0.0, 0.0, 0.0])
        cell.step(0.5)
        assert arm.joint_state.reaction == pytest.approx(free.reaction, abs=1e-2)


def _run(cell: Path, program: str, out: Path) -> dict[str, Any]:
    path = cell.with_name("part.nc")
    path.write_text(dedent(program))
    gcodesim.simulate(path, cell, out=out)
    return json.loads((out / "results.json").read_text())


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_a_cut_is_deeper_by_what_the_arm_yields(tmp_path: Path, world: str) -> None:
    """A constant load bends the arm by C F; the slot is deeper by that, less what the cutting force changes.

    0.17 mm more of a depth of 1 mm is a sixth more of a force of 60 N, of which a part is against 80 N: at most 12 %.
    In bullet the load comes at once to gears that swing: they go farther at first, and the floor keeps the deepest.
    """
    found = {}
    for name, load in (("free", ""), ("loaded", LOAD)):
        (tmp_path / name).mkdir()
        cell = _cell(tmp_path / name, load=load, world=world)
        found[name] = _run(cell, SLOT, tmp_path / name / "out")
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        shop = cell._shop
        X = shop.placement.work_offsets[1]
        from gcodesim.kinematics import compliance, shift_jacobian

        arm, tool = cell.robot(), cell.tool(1)
        tool.couple(arm)
        cell.step(0.1)
        arm.move_to((shop.X_WB @ X).apply(np.array([10e-3, 10e-3, -1e-3])), [1.0, 0.0, 0.0, 0.0])
        q = arm.joint_state.position[None]
        J = shift_jacobian(shop.kinematics.jacobian(q), shop.kinematics.forward(q), shop.tool(1).X_FT.p)
        bent = compliance(J, shop.stiffness)[0, 2, 2] * 80.0
    volumes = [found[name]["stocks"]["plate"]["removed_mm3"] for name in ("free", "loaded")]

    assert 20e-6 < bent < 500e-6
    area = (20.0 * 6.0 + 0.5 * np.pi * 9.0) * 1e-6
    assert 1e-9 * (volumes[1] - volumes[0]) == pytest.approx(bent * area, rel=0.12 if world == "kinematic" else 0.2)


EXTRUDER = "2: {type: extruder, bead_width: 6 mm, bead_height: 3 mm, length: 60 mm}"


def _laid(folder: Path, world: str, *, load: float) -> tuple[float, float]:
    """Volume [mm³] of a bead that a script lays while it pulls at the tip, and how much of it found no room."""
    path = _cell(folder, world=world)
    path.write_text(path.read_text().replace("tools: {1", f"tools: {{{EXTRUDER}, 1"))
    bead = gcodesim.ToolPath.from_points(1e-3 * np.array([[5.0, 10.0, 3.0], [35.0, 10.0, 3.0]]), feed=0.02)
    with gcodesim.open_cell(path, world=world) as cell:
        arm, tool = cell.robot(), cell.tool(2)
        tool.couple(arm)
        arm.run(gcodesim.ToolPath.from_points(1e-3 * np.array([[5.0, 10.0, 20.0], [5.0, 10.0, 3.0]]), feed=0.05))
        tool.apply_tcp_force([0.0, 0.0, load])
        cell.step(0.5)
        tool.extrude(bead)
    (told,) = (each for each in cell.results.as_json()["tools"] if "crowded_out_mm3" in each)
    return 1e9 * cell.results.stocks["plate"].deposited, told["crowded_out_mm3"]


def test_what_nobody_feels_acts_where_a_load_puts_the_tip(tmp_path: Path) -> None:
    """A bead that is pressed into the plate loses what finds no room, in both worlds the same."""
    free, lost = _laid(tmp_path, "bullet", load=0.0)
    pressed = {world: _laid(tmp_path, world, load=-60.0) for world in ("kinematic", "bullet")}

    assert lost < 0.2 and 12.0 < pressed["bullet"][1] < 16.0
    assert pressed["bullet"][0] == pytest.approx(pressed["kinematic"][0], rel=2e-3)
    assert pressed["bullet"][1] == pytest.approx(pressed["kinematic"][1], rel=0.05)
    assert pressed["bullet"][0] == pytest.approx(free - pressed["bullet"][1], rel=1e-3)


def test_a_program_switches_and_scales_it(tmp_path: Path) -> None:
    """The greatest force beside a cut in air: 0, then the load, then half of it and what E1 says."""
    more = dedent("""\
        signals: {load: {word: M68 E0}, load_fx: {word: M68 E1, per: 1 N}}
        """)
    cell = _cell(tmp_path, load=LOAD, more=more)
    program = """\
        G21 G90 G54
        T1 M6
        G43 H1
        G0 X-8 Y10 Z25
        G1 X0 F3000
        M68 E0 Q1
        G1 X10
        M68 E0 Q0.5
        M68 E1 Q30
        G1 X20
        M2
        """
    _run(cell, program, tmp_path / "out")
    rows = {}
    lines = (tmp_path / "out" / "lines.csv").read_text().splitlines()
    names = lines[0].split(",")
    for line in lines[1:]:
        row = dict(zip(names, line.split(","), strict=True))
        rows[int(row["line"])] = float(row["max_force_N"])
    assert rows[5] == 0.0
    assert rows[7] == pytest.approx(80.0)
    assert rows[10] == pytest.approx(50.0)


def test_misuse_is_told(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        tool = cell.tool(1)
        with pytest.raises(MisuseError, match="no robot holds tool 1"):
            tool.apply_tcp_force([1.0, 0.0, 0.0])
        tool.couple(cell.robot())
        with pytest.raises(MisuseError, match="has 3 numbers"):
            tool.apply_tcp_force([1.0, 0.0])
        with pytest.raises(MisuseError, match="`world` or of the `tool`"):
            tool.apply_tcp_force([1.0, 0.0, 0.0], frame="part")  # type: ignore[arg-type]

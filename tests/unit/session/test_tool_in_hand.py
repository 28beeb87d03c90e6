"""Tools that a script switches: each acts as from a program, and what cannot be is told."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gcodesim
from gcodesim.session import MisuseError, OpenCell

CELL = """\
gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], stiffness: rigid}
frames: {table: {in: world, xyz: [600, 0, 300]}}
stock: {plate: {box: [40, 30, 10], in: table, resolution: 1, zero: top-front-left}}
work_offsets: {G54: {in: table}}
orientation: {tool_axis: -Z of G54}
parts: {crate: {box: [40, 40, 40], zero: bottom-center, in: table, xyz: [120, 0, 0], mass: 1 kg}}
tools:
  1: {type: flat_end_mill, diameter: 6, flutes: 3}
  2: {type: extruder, bead_width: 6, bead_height: 3}
  3: {type: laser, power: 500 W, diameter: 3, absorptivity: 0.8, specific_energy: 2 J/mm^3, length: 60}
  4: {type: spray_gun, cone: 30 deg, efficiency: 0.65, solids: 0.45, flow: 2.5 cm^3/s, distance: 100}
  5: {type: suction_gripper, length: 90, cups: [{at: [0, 0], diameter: 30}], vacuum: 60 kPa}
  6: {type: jet, diameter: 2, removal_rate: 8 mm^3/s, length: 60}
signals: {power: {word: S, per: 1 W}, beam: {word: M62 P4}}
magazine: {change_time: 0.1 s}
simulation: {world: kinematic}
"""


def opened(tmp_path: Path, cell: str = CELL) -> OpenCell:
    (tmp_path / "cell.yaml").write_text(cell)
    return gcodesim.open_cell(tmp_path / "cell.yaml")


def line(*points: tuple[float, float, float]) -> gcodesim.ToolPath:
    return gcodesim.ToolPath.from_points(1e-3 * np.array(points), feed=0.02)


def passed(cell: OpenCell, number: int, height: float) -> None:
    """There and back over the plate, on only on the way there."""
    tool, arm = cell.tool(number), cell.robot()
    tool.couple(arm)
    arm.run(line((5.0, 15.0, height + 20.0), (5.0, 15.0, height)))
    tool.activate()
    arm.run(line((5.0, 15.0, height), (35.0, 15.0, height)))
    tool.deactivate()
    arm.run(line((35.0, 15.0, height), (35.0, 15.0, height + 20.0)))


def passed_on(cell: OpenCell, number: int, y: float, height: float = 0.0) -> None:
    """Along the plate with the tool that is held, on for 30 mm."""
    tool, arm = cell.tool(number), cell.robot()
    arm.run(line((5.0, y, height + 20.0), (5.0, y, height)))
    tool.activate()
    arm.run(line((5.0, y, height), (35.0, y, height)))
    tool.deactivate()
    arm.run(line((35.0, y, height), (35.0, y, height + 20.0)))


def test_a_laser_takes_what_its_energy_takes_and_only_while_it_is_on(tmp_path: Path) -> None:
    """1.5 s and the ramps at 500 W, 80 % of it at 2 J/mm³, whatever words the cell has for programs."""
    with opened(tmp_path) as cell:
        passed(cell, 3, 0.0)

    assert 1e9 * cell.results.stocks["plate"].removed == pytest.approx(1.5 * 500.0 * 0.8 / 2.0, rel=0.1)
    assert {f.code for f in cell.findings} <= {"GS540", "GS725"}


def test_a_jet_and_a_gun_are_switched_as_well(tmp_path: Path) -> None:
    with opened(tmp_path) as cell:
        passed(cell, 6, 0.0)
        cell.tool(6).decouple()
        passed(cell, 4, 100.0)
    assert cell.results.stocks["plate"].removed > 10e-9
    assert cell.results.coating is not None
    assert cell.results.coating["sprayed_mm3"] == pytest.approx(2.5e3 * 1.55, rel=0.05)
    assert cell.results.coating["film_mm3"] > 0.0


def test_activating_holds_for_paths_that_do_not_switch(tmp_path: Path) -> None:
    with opened(tmp_path) as cell:
        passed(cell, 2, 3.0)
    assert cell.results.stocks["plate"].deposited == pytest.approx(
        30.0 * (3.0 * 3.0 + 9.0 * np.pi / 4.0) * 1e-9, rel=0.05
    )


def test_a_script_sets_power_and_flow_until_the_tool_is_put_back(tmp_path: Path) -> None:
    """200 W in place of 500 on the first pass, then 100 W; the gun sprays what it is told, the next laser its own."""
    with opened(tmp_path) as cell:
        tool, arm = cell.tool(3), cell.robot()
        assert tool.settings["power"] is None
        tool.couple(arm)
        tool.set("power", 200.0)
        passed_on(cell, 3, 5.0)
        tool.set("power", 100.0)
        assert tool.settings["power"] == 100.0
        passed_on(cell, 3, 15.0)
        tool.decouple()
        assert tool.settings["power"] is None
        tool.couple(arm)
        passed_on(cell, 3, 25.0)
        tool.decouple()
        cell.tool(4).couple(arm)
        cell.tool(4).set("flow", 1e-6)
        passed_on(cell, 4, 15.0, 100.0)
    laser, gun = (next(t for t in cell.results.tools if t["number"] == k) for k in (3, 4))

    assert laser["beam_energy_J"] == pytest.approx((200.0 + 100.0 + 500.0) * 1.52, rel=0.01)
    assert gun["sprayed_mm3"] == pytest.approx(1e3 * 1.52, rel=0.02)


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_a_gripper_takes_a_part_and_puts_it_down(world: str, tmp_path: Path) -> None:
    with opened(tmp_path, CELL.replace("world: kinematic", f"world: {world}")) as cell:
        tool, arm = cell.tool(5), cell.robot()
        tool.couple(arm)
        arm.run(line((120.0, 0.0, 80.0), (120.0, 0.0, 40.0)))
        tool.close()
        cell.step(0.1)
        arm.run(line((120.0, 0.0, 40.0), (120.0, 0.0, 90.0), (120.0, 100.0, 90.0), (120.0, 100.0, 40.0)))
        tool.open()
        cell.step(0.1)
        arm.run(line((120.0, 100.0, 40.0), (120.0, 100.0, 90.0)))

    assert [f.code for f in cell.findings if f.code.startswith("GS56")] == []
    crate = cell.results.parts["crate"]
    assert [crate[name] for name in ("x_mm", "y_mm", "z_mm")] == pytest.approx([720.0, 100.0, 300.0], abs=0.01)
    assert (crate["grips"], crate["falls"], crate["held_by"]) == (1, 0, None)


def _with(number: int, what: Callable[[Any], Any]) -> Callable[[OpenCell], Any]:
    def wrong(cell: OpenCell) -> None:
        tool = cell.tool(number)
        tool.couple(cell.robot())
        what(tool)

    return wrong


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        (lambda cell: cell.tool(2).activate(), "no robot holds tool 2; call `couple` first"),
        (lambda cell: cell.tool(5).close(), "no robot holds tool 5; call `couple` first"),
        (_with(1, lambda tool: tool.activate()), "a cutter takes `spin`"),
        (_with(5, lambda tool: tool.activate()), "a gripper has `close` and `open`"),
        (_with(3, lambda tool: tool.close()), "is no gripper"),
        (lambda cell: cell.tool(3).set("power", 1.0), "no robot holds tool 3; call `couple` first"),
        (_with(3, lambda tool: tool.set("flow", 1.0)), "has no setting `flow`; it has power"),
        (_with(1, lambda tool: tool.set("power", 1.0)), "has no setting `power`; it has none"),
        (_with(3, lambda tool: tool.set("power", -5.0)), "`power` of tool 3 cannot be -5 W; it can be 0 or more"),
        (_with(3, lambda tool: tool.set("power", float("nan"))), "`power` is a finite number; nan is given"),
        (_with(5, lambda tool: tool.set("beam", 1.0)), "has no setting `beam`"),
        (_with(6, lambda tool: tool.set("abrasive", 1.5)), "cannot be 1.5; it can be from 0 to 1"),
        (_with(1, lambda tool: tool.spin(float("inf"))), "finite number; inf is given"),
        (_with(5, lambda tool: tool.spin(100.0)), "does not turn; a gripper has `close` and `open`"),
        (_with(2, lambda tool: tool.spin(100.0)), r"tool 2 \(extruder\) does not turn$"),
        (_with(1, lambda tool: tool.apply_tcp_force([1.0, 2.0])), r"a force \[N\] has 3 numbers"),
        (lambda cell: cell.tool(1).couple("arm"), "is coupled to an arm of the cell"),
    ],
)
def test_wrong_use_is_told(wrong: Callable[[OpenCell], Any], text: str, tmp_path: Path) -> None:
    with opened(tmp_path) as cell, pytest.raises(MisuseError, match=text):
        wrong(cell)


@pytest.mark.parametrize(
    ("code", "use"),
    [
        ("GS561", lambda tool, arm, cell: (tool(5).couple(arm), tool(5).close(), cell.step(0.2))),
        ("GS520", lambda tool, arm, cell: (tool(2).couple(arm), tool(2).extrude(line((5, 15, 30), (35, 15, 30))))),
        ("GS542", lambda tool, arm, cell: (tool(3).couple(arm), arm.run(line((5, 15, 0), (35, 15, 0))))),
        ("GS501", lambda tool, arm, cell: (tool(1).couple(arm), arm.run(line((-9, 15, 5), (-9, 15, -2), (9, 15, -2))))),
    ],
)
def test_what_goes_wrong_on_the_way_is_a_finding_at_a_line_of_the_script(
    code: str, use: Callable[[Any, Any, OpenCell], Any], tmp_path: Path
) -> None:
    with opened(tmp_path) as cell:
        use(cell.tool, cell.robot(), cell)
    found = [f for f in cell.results.findings if f.code == code]
    assert found and found[0].span.file == Path(__file__).name and found[0].span.line > 1


def test_the_loaded_tool_is_in_hand_from_the_start_and_off(tmp_path: Path) -> None:
    """As in the spindle of a program; it was in nobody's hand."""
    (tmp_path / "cell.yaml").write_text(
        "gcodesim: 1\nmachine: gantry_xyz\nloaded_tool: 1\nwork_offsets: {G54: {xyz: [400, 300, -300]}}\n"
        "stock: {min: [-20, -20, -5], max: [80, 40, 0], in: G54, resolution: 1, material: al6082_t6}\n"
        "tools: {1: {type: laser, power: 500 W, diameter: 5, length: 60, specific_energy: 20 J/mm^3}}\n"
        "simulation: {world: kinematic}\n"
    )
    line = gcodesim.ToolPath.from_points(np.array([[0.0, 0.0, 0.0], [50e-3, 0.0, 0.0]]), feed=50e-3)

    def removed(*, on: bool) -> float:
        with gcodesim.open_cell(tmp_path / "cell.yaml") as cell:
            machine = cell.robot()
            assert machine.tool is cell.tool(1) and cell.tool(1).is_coupled
            assert machine.endeffector_pose[0][2] == pytest.approx(-60e-3)
            if on:
                cell.tool(1).activate()
            machine.run(line)
            cell.tool(1).decouple()
            cell.step(0.1)
            assert machine.tool is None
        return 1e9 * cell.results.stocks["stock"].removed

    assert removed(on=False) == 0.0
    assert removed(on=True) == pytest.approx(25.0, rel=0.05)  # 500 W for 1 s and what speeding up takes

"""In the replay one sees that a tool is on: spray, light, a jet, an arc, a strand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import gcodesim
from gcodesim.log.reader import read_messages
from gcodesim.recorder.plumes import Plumes

CELL = """gcodesim: 1
machine: gantry_xyz
work_offsets: {{G54: {{xyz: [400, 300, -300]}}}}
stock: {{min: [-20, -20, -5], max: [120, 40, 0], in: G54, resolution: 2, material: 42CrMo4}}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
loaded_tool: 1
tools:
  1: {{{tool}}}
simulation: {{world: {world}}}
"""
PROGRAM = "G21 G90\nG43 H1\nG0 X0 Y0 Z{z}\nM10\nG1 X60 F6000\nM11\nG1 X80 F1200\nM2\n"
TOOLS = {
    "spray_gun": ("type: spray_gun, efficiency: 0.6, flow: 2 cm^3/s, cone: 40 deg, distance: 100, length: 80", 100),
    "laser": ("type: laser, power: 500 W, diameter: 1, length: 60, specific_energy: 20 J/mm^3", 0),
    "plasma": ("type: plasma, power: 5 kW, diameter: 3, length: 60", 0),
    "jet": ("type: jet, removal_rate: 20 mm^3/s, diameter: 2, length: 60", 0),
    "sand_blaster": ("type: sand_blaster, removal_rate: 1 mm^3/s, diameter: 10, length: 160", 0),
    "extruder": ("type: extruder, bead_width: 6, bead_height: 3, length: 60", 3),
    "welding_torch": ("type: welding_torch, wire_speed: 6 m/min, length: 60", 0),
}


def drawn(tmp_path, program, cell):
    """Times [s] at which the tool is drawn, with the number of its shapes."""
    (tmp_path / "part.nc").write_text(program)
    (tmp_path / "cell.yaml").write_text(cell)
    results = gcodesim.simulate(tmp_path / "part.nc", tmp_path / "cell.yaml", tmp_path / "out")
    assert results.status in ("ok", "findings"), [f.message for f in results.findings]
    found = []
    for t_ns, update in read_messages(tmp_path / "out" / "run.mcap", "/scene/tool"):
        (entity,) = [each for each in update.entities if each.id == "tool"]
        found.append((t_ns * 1e-9, sum(len(getattr(entity, kind)) for kind in ("cubes", "spheres", "cylinders"))))
    return found


@pytest.mark.parametrize("kind", TOOLS)
@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_a_tool_shows_that_it_is_on(kind, world, tmp_path):
    if world == "bullet":
        pytest.importorskip("pybullet")
    tool, z = TOOLS[kind]
    found = drawn(tmp_path, PROGRAM.format(z=z), CELL.format(tool=tool, world=world))

    assert [count - found[0][1] for _, count in found] == [0, 1, 0]
    assert found[2][0] - found[1][0] == pytest.approx(0.6, abs=0.15)  # 60 mm at 100 mm/s, from and to rest


def test_a_tool_that_is_changed_soon_is_seen_to_go_off(tmp_path):
    """Both changes may come in one window of the run."""
    tool = TOOLS["jet"][0]
    cell = CELL.format(tool=tool, world="kinematic").replace("simulation", f"  2: {{{tool}}}\nsimulation")
    program = "G21 G90\nG43 H1\nG0 X0 Y0 Z0\nM10\nG1 X60 F6000\nM11\nG0 X80\n"
    program += "T2 M6\nG43 H2\nG0 X0\nM10\nG1 X60\nM11\nG0 X0\nM2\n"
    found = drawn(tmp_path, program, cell)

    assert [count - found[0][1] for _, count in found] == [0, 1, 0, 0, 1, 0]
    assert 0.1 < found[3][0] - found[2][0] < 0.4  # the rapid of 20 mm before the change


def test_a_print_shows_where_filament_comes_out(tmp_path):
    cell = "gcodesim: 1\nmachine: gantry_xyz\ndialect: marlin\n"
    cell += "stock: {box: [100, 60, 2], zero: top-front-left, resolution: 1}\n"
    cell += "tools: {0: {type: extruder, bead_width: 0.8, bead_height: 0.4}}\nsimulation: {world: kinematic}\n"
    program = "G28\nM83\nG1 Z0.4 F3000\nG1 X40 E5 F1200\nG1 X60\nG1 X90 E4\n"
    counts = [count for _, count in drawn(tmp_path, program, cell)]

    assert [count - counts[0] for count in counts] == [0, 1, 0, 1, 0]


def test_a_tool_that_goes_off_with_the_last_words_is_seen_to_go_off(tmp_path):
    """No step is left after them: the log shows it at its end."""
    cell = CELL.format(tool=TOOLS["laser"][0], world="kinematic")
    program = "G21 G90\nG43 H1\nG0 X0 Y0 Z0\nM10\nG1 X60 F6000\nM11\nM2\n"
    found = drawn(tmp_path, program, cell)
    assert [count - found[0][1] for _, count in found] == [0, 1, 0]

    still_on = drawn(tmp_path, program.replace("M11\n", ""), cell)
    assert [count - still_on[0][1] for _, count in still_on] == [0, 1]


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_cups_show_that_there_is_a_vacuum(world, tmp_path):
    if world == "bullet":
        pytest.importorskip("pybullet")
    tool = "type: suction_gripper, length: 80, cups: [{at: [-30, 0], diameter: 40}, {at: [30, 0], diameter: 40}]"
    cell = CELL.format(tool=tool, world=world).replace("material: 42CrMo4", "material: 42CrMo4", 1)
    cell = cell.replace("tool: activate", "gripper: close").replace("tool: deactivate", "gripper: open")
    cell = "\n".join(line for line in cell.splitlines() if not line.startswith("stock")) + "\n"
    cell += "parts: {sheet: {box: [200, 100, 4], in: G54, xyz: [0, 0, -4], mass: 0.4 kg}}\n"
    found = drawn(tmp_path, PROGRAM.format(z=0), cell)
    assert [count - found[0][1] for _, count in found] == [0, 2, 0]  # a collar for each cup


def test_another_change_of_tools_leaves_it_on(tmp_path):
    """The first channel draws all tools that wait, at each change of any channel; its own one goes on."""
    cell = """gcodesim: 1
robots:
  left: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], stiffness: rigid}
  right: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], stiffness: rigid,
          base: {in: world, xyz: [3000, 0, 0], rpy: [0, 0, 180]}}
stock: {plate: {box: [80, 60, 10], in: world, resolution: 1, xyz: [700, 0, 300]}}
channels:
  main: {robot: left, loaded_tool: 1, orientation: {tool_axis: -Z of world},
         work_offsets: {G54: {in: world, xyz: [700, 0, 320]}},
         m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}}
  right: {robot: right, loaded_tool: 2, program: right.nc, orientation: {tool_axis: -Z of world},
          work_offsets: {G54: {in: world, xyz: [2300, 0, 320]}}}
tools:
  1: {type: laser, power: 500 W, diameter: 1, length: 60, specific_energy: 20 J/mm^3}
  2: {type: flat_end_mill, diameter: 4, flutes: 2, length: 60}
  3: {type: flat_end_mill, diameter: 6, flutes: 2, length: 60}
magazine: {change_time: 0.2 s}
simulation: {world: kinematic}
"""
    (tmp_path / "right.nc").write_text("G21 G90\nG4 P7\nT3 M6\nG4 P1\nM2\n")
    program = "G21 G90\nG1 X0 Y0 Z20 F6000\nM10\nG1 X20 F300\nM11\nG4 P0.5\nM2\n"
    found = drawn(tmp_path, program, cell)
    assert [count - found[0][1] for _, count in found] == [0, 1, 1, 0]


def test_each_change_is_told_with_its_own_line(tmp_path):
    tool = TOOLS["jet"][0]
    cell = CELL.format(tool=tool, world="kinematic").replace("simulation", f"  2: {{{tool}}}\nsimulation")
    cell = cell.replace("loaded_tool: 1\n", "")
    drawn(tmp_path, "G21 G90\nT1 M6\nG43 H1\nG0 X0 Y0 Z9\nT2 M6\nG0 X9\nT1 M6\nG0 X0\nM2\n", cell)
    told = [each for _, each in read_messages(tmp_path / "out" / "run.mcap", "/event") if each.code == "toolchange"]
    assert [each.line for each in told] == [2, 5, 7]


class _Path:
    """Ten rows, of which every other one pushes filament."""

    extrude = np.array([0.0, 1.0] * 5)

    def __len__(self):
        return 10


def test_windows_may_be_cut_anywhere():
    path, shop = _Path(), SimpleNamespace(cell=SimpleNamespace(tools={}))
    t_ns = np.arange(100, dtype=np.int64) * 7_000_000
    rows, tools = np.arange(100) // 10, np.zeros(100, dtype=np.int64)

    def told(cuts):
        plumes = Plumes(shop, path, int(t_ns[-1]))
        plumes._has_any = True
        plumes._on = path.extrude > 0.0
        found = []
        for a, b in zip([0, *cuts], [*cuts, 100], strict=True):
            found += [(a + k, on) for k, on in plumes.changes(rows[a:b], tools[a:b], t_ns[a:b])]
        return found

    whole = told([])
    assert [on for _, on in whole] == [True, False] * 4 + [True]
    assert whole == told([1, 2, 33, 34, 71]) == told(range(1, 100))

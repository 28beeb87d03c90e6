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

    assert [count - counts[0] for count in counts] == [0, 1, 0, 1]


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

"""What a whole cell comes to: values in SI, places, defaults, files, and what loading costs."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from math import pi
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.cell.channel import MCode
from gcodesim.declarations import files
from gcodesim.declarations.mesh_shape import MeshShape
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.solids import Box, Cylinder
from gcodesim.units import DEG, MM, RPM
from tests.unit.cell.text import NOWHERE, codes, loaded, sound

FOLDER = NOWHERE.parent
CELLS = sorted((Path(__file__).parents[3] / "cells").glob("*.yaml"))


def test_the_shortest_cell_is_a_machine() -> None:
    cell = sound("machine: gantry_xyz")

    assert cell.machine is not None
    assert [(a.letter, a.lower, a.upper, a.speed, a.acceleration) for a in cell.machine.axes] == [
        ("X", 0.0, 1.2, 0.5, 3.0),
        ("Y", 0.0, 0.8, 0.5, 3.0),
        ("Z", -0.4, 0.0, 0.25, 2.0),
    ]
    assert cell.machine.home == (0.0, 0.0, 0.0)
    assert cell.simulation.step_ns == 4_000_000 and cell.log.period_ns == 20_000_000 and cell.simulation.seed == 1
    assert list(cell.channels) == ["main"] and cell.channels["main"].robot == "machine"
    assert not cell.stocks and not cell.tools


def test_a_cell_with_everything() -> None:
    result = load_cell(FOLDER / "everything.yaml")

    cell = result.cell
    assert cell is not None
    assert all(f.level <= Severity.NOTE for f in result.findings)
    arm = cell.robots["arm"]
    assert arm.home == pytest.approx((0, -pi / 2, pi / 2, 0, pi / 2, 0))
    assert arm.stiffness == (1.5e5, 1.4e5, 9e4, 3e4, 2.5e4, 1.5e4)
    np.testing.assert_allclose(cell.robots["feeder"].X_WB.p, [1.3, 0, 0])
    np.testing.assert_allclose(cell.frames["table"].R @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    channel = cell.channels["main"]
    assert channel.m_codes == {
        "M10": MCode(target="tool", verb="activate"),
        "M11": MCode(target="tool", verb="deactivate"),
        "M62 P1": MCode(target="tool", verb="activate"),
    }
    assert channel.path_control == "G64 P0.02" and channel.subroutines[0].path == FOLDER / "subs"
    assert sorted(cell.tools) == [1, 2]
    assert cell.tools[1].true_length == pytest.approx(0.11)
    plate = cell.stocks["plate"]
    assert plate.shape == Box(lower=(0.0, 0.0, 0.0), upper=(0.1, 0.06, 0.02)) and plate.resolution == pytest.approx(
        2e-4
    )
    material = cell.material(plate)
    assert material is not None and material.law.specific_force(1e-3) == pytest.approx(1700e6)
    assert cell.limits.spindle_power == 3000.0 and cell.limits.spindle_speed == pytest.approx(24000 * RPM)
    assert cell.severity("GS304") is Severity.WARNING and cell.severity("GS901") is Severity.ERROR
    assert cell.severity("GS305") is None
    assert cell.suppress[0].block == "G1 X30" and str(cell.suppress[0].until) == "2027-03-01"
    assert cell.magazine.placed and cell.magazine.change_time == 6.0
    vise = cell.fixtures["vise"].shape
    assert isinstance(vise, MeshShape) and vise.upper == pytest.approx((0.15, 0.08, 0.04))


def test_every_file_read_is_hashed() -> None:
    files = load_cell(FOLDER / "everything.yaml").files

    assert [f.name for f in files] == ["everything.yaml", "machine.var", "plate_finished.stl", "tool.tbl", "vise.stl"]
    for file in files:
        assert file.sha256 == SourceText.read(file.path).sha256


@pytest.mark.parametrize("path", CELLS, ids=lambda path: path.stem)
def test_the_cells_that_ship_give_nothing_above_a_note(path: Path) -> None:
    result = load_cell(path)

    assert result.cell is not None
    assert all(f.level <= Severity.NOTE for f in result.findings)


@pytest.mark.parametrize("spelling", ["1", "'1'", '"01"', "001"])
def test_tool_keys_are_canonical_integers(spelling: str) -> None:
    assert list(sound(f"machine: gantry_xyz\ntools: {{{spelling}: {{type: drill, diameter: 5}}}}").tools) == [1]


def test_texts_stay_texts() -> None:
    cell = sound(
        """
        machine: gantry_xyz
        tools:
          1: {type: drill, diameter: 5, name: on}
          2: {type: drill, diameter: 5, name: 2027-03-01}
          3: {type: drill, diameter: 5, name: 1e3}
          4: {type: drill, diameter: 5, name: 0o14}
        """
    )

    assert [tool.name for tool in cell.tools.values()] == ["on", "2027-03-01", "1e3", "0o14"]


def test_units_of_plain_numbers_hold_wherever_they_stand() -> None:
    cell = sound(
        """
        machine: gantry_xyz
        stock: {box: [4, 3, 10 mm]}
        frames: {a: {rpy: [0, 0, 1]}}
        units: {length: in, angle: rad}
        """
    )

    assert cell.stocks["stock"].shape == Box(lower=(0.0, 0.0, 0.0), upper=(0.004, 0.003, 0.01))
    assert cell.placed_frames["a"].rpy == (0.0, 0.0, 1.0)
    inches = sound("machine: gantry_xyz\nstock: {box: [4, 3, 1]}\nunits: {length: in}").stocks["stock"].shape
    assert isinstance(inches, Box) and inches.upper == pytest.approx((0.1016, 0.0762, 0.0254))


def test_zero_needs_no_unit() -> None:
    assert sound("machine: gantry_xyz\nmagazine: {change_time: 0}").magazine.change_time == 0.0


@pytest.mark.parametrize(
    ("zero", "lower"),
    [
        ("bottom-front-left", (0, 0, 0)),
        ("top-front-left", (0, 0, -20)),
        ("top-back-right", (-100, -60, -20)),
        ("left-top-front", (0, 0, -20)),
        ("top-center", (-50, -30, -20)),
        ("bottom-centre", (-50, -30, 0)),
        ("center", (-50, -30, -10)),
        ("top-front-center", (-50, 0, -20)),
    ],
)
def test_zero_is_a_point_of_the_box(zero: str, lower: tuple[float, ...]) -> None:
    shape = sound(f"machine: gantry_xyz\nstock: {{box: [100, 60, 20], zero: {zero}}}").stocks["stock"].shape

    assert isinstance(shape, Box)
    assert shape.lower == pytest.approx([v * MM for v in lower])
    assert shape.size == pytest.approx([0.1, 0.06, 0.02])


def test_stock_comes_in_many_shapes() -> None:
    cell = sound(
        """
        machine: gantry_xyz
        work_offsets: {G54: {xyz: [100, 100, -200]}}
        stock:
          a: {min: [0, 0, -15], max: [80, 50, 0], in: G54}
          b: {cylinder: {diameter: 80, height: 40}, zero: top-center}
          c: {cylinder: [80, 40]}
          d: {mesh: vise.obj, unit: m}
        """
    )

    shapes = {name: stock.shape for name, stock in cell.stocks.items()}
    assert shapes["a"] == Box(lower=(0.0, 0.0, -0.015), upper=(0.08, 0.05, 0.0))
    assert shapes["b"] == Cylinder(radius=0.04, bottom=-0.04, top=0.0)
    assert shapes["c"] == Cylinder(radius=0.04, bottom=0.0, top=0.04)
    assert isinstance(shapes["d"], MeshShape) and shapes["d"].upper == pytest.approx((0.15, 0.08, 0.04))
    assert cell.span("stock", "a", "min").line == 5


@pytest.mark.parametrize(("name", "size"), [("vise.stl", "150 x 80 x 40 mm"), ("vise.bin.stl", "150 x 80 x 40 mm")])
def test_a_mesh_without_a_unit_is_a_warning_with_its_size(name: str, size: str) -> None:
    found = list(loaded(f"machine: gantry_xyz\nfixtures: {{vise: {{mesh: {name}}}}}").findings)

    assert [f.code for f in found] == ["GS717"]
    assert size in found[0].message and found[0].level is Severity.WARNING


def test_a_mesh_a_hundred_times_too_large_is_a_warning() -> None:
    text = "machine: gantry_xyz\nstock: {box: [100, 60, 20]}\nfixtures: {vise: {mesh: vise.stl, unit: m}}"

    assert codes(text) == ["GS718"]
    assert codes(text.replace("unit: m}", "unit: mm}")) == []


def test_frames_follow_each_other() -> None:
    cell = sound(
        """
        machine: {model: gantry_xyz, base: {in: hall, xyz: [0, 0, 800]}}
        frames:
          c: {in: b, xyz: [10, 0, 0]}
          b: {in: a, xyz: [0, 20, 0], rpy: [0, 0, 90]}
          a: {in: machine, xyz: [1, 2, 3]}
          hall: {xyz: [5000, 0, 0]}
        """
    )

    np.testing.assert_allclose(cell.frames["c"].p, [5.001, 0.032, 0.803], atol=1e-15)
    assert cell.machine is not None
    np.testing.assert_allclose(cell.machine.X_WM.p, [5.0, 0, 0.8])


def test_an_own_machine_by_its_axes() -> None:
    cell = sound(
        """
        machine:
          rapids: independent
          axes:
            x: {travel: [100, 600 mm], speed: 30 m/min}
            Y: {travel: [-0.4, -0.1 m], speed: 0.5 m/s, acceleration: 2 m/s^2, effort: 4 kN, moving_mass: 50 kg}
            Z: {travel: [-300, 0], speed: 12 m/min, home: -20}
            A: {travel: [-120, 120], speed: 180 deg/s, at: [0, 20, -60], side: tool, effort: none}
            C: {travel: unlimited, speed: 30 rpm}
        """
    )

    machine = cell.machine
    assert machine is not None and machine.rapids == "independent"
    x, y, z, a, c = machine.axes
    assert (x.letter, x.home, x.acceleration, x.assumed_acceleration, x.side) == ("X", 0.1, 2.0, True, "tool")
    assert (y.lower, y.upper, y.home, y.effort, y.moving_mass) == (-0.4, -0.1, -0.1, 4000.0, 50.0)
    assert not y.assumed_acceleration and z.home == pytest.approx(-0.02)
    assert (a.side, a.at, a.speed) == ("tool", (0.0, 0.02, -0.06), pytest.approx(pi))
    assert (c.side, c.at, c.lower, c.speed) == ("table", None, -np.inf, pytest.approx(pi))
    joints = machine.chain.driven_joints
    assert sorted(joints.names) == ["A", "C", "X", "Y", "Z"]


def test_a_shipped_machine_takes_single_values() -> None:
    cell = sound(
        "machine: {model: gantry_xyz, axes: {Z: {travel: [-200, -10 mm], speed: 5 m/min}}, home: {X: 10, Y: 2 cm}}"
    )

    assert cell.machine is not None
    x, y, z = cell.machine.axes
    assert (x.home, y.home, z.home) == pytest.approx((0.01, 0.02, -0.01))
    assert (z.lower, z.upper, z.speed, z.acceleration) == pytest.approx((-0.2, -0.01, 5 / 60, 2.0))
    joints = cell.machine.chain.driven_joints
    assert joints.upper[joints.index("Z")] == pytest.approx(-0.01) and joints.upper[joints.index("X")] == 1.2


def test_a_robot_of_ones_own() -> None:
    result = loaded(
        """
        robots: {arm: {urdf: arm.urdf, home: [200, -30 deg], payload: 3 kg}}
        work_offsets: {G54: {in: arm/base, xyz: [1000, 0, 0]}}
        """
    )

    assert result.cell is not None
    arm = result.cell.robots["arm"]
    assert arm.home == pytest.approx((0.2, -30 * DEG)) and arm.stiffness is None
    assert arm.payload is not None and arm.payload.mass == 3.0
    assert "arm.urdf" in [f.name for f in result.files]
    resting = sound("robots: {arm: {urdf: arm.urdf}}").robots["arm"]
    assert resting.home == pytest.approx((0.1, 0.0))  # zero, or the end of the travel next to it


def test_a_configuration_names_at_most_one_of_each_pair() -> None:
    text = "robots: {arm: {model: ur10e, configuration: %s}}"

    assert sound(text % "[up, front]").robots["arm"].configuration == ("up", "front")
    assert sound(text % "flip").robots["arm"].configuration == ("flip",)
    assert sound("robots: {arm: {model: ur10e}}").robots["arm"].configuration is None
    assert codes(text % "[up, down]") == ["GS719"]
    assert codes(text % "[upward]") == ["GS711"]
    assert codes("robots: {arm: {urdf: arm.urdf, configuration: [up]}}")[-1] == "GS719"  # no closed form


def test_each_joint_has_the_unit_that_fits_it() -> None:
    cell = sound("robots: {arm: {urdf: arm.urdf, home: [200, -30], stiffness: [2e5 N/mm, 1e4 N·m/rad]}}")

    arm = cell.robots["arm"]
    assert arm.home == pytest.approx((0.2, -30 * DEG))  # a rail in mm, a joint in degrees
    assert arm.stiffness == pytest.approx((2e8, 1e4))


def test_rigid_switches_the_default_stiffness_off() -> None:
    text = "robots: {arm: {model: kuka_kr10_r1100_2%s}}"

    assert sound(text % "").robots["arm"].stiffness == (1.5e5, 1.4e5, 9e4, 3e4, 2.5e4, 1.5e4)
    assert sound(text % ", stiffness: rigid").robots["arm"].stiffness is None


@pytest.mark.parametrize("rate", [50, 100, 200, 250, 400, 500, 1000])
def test_rates_that_divide_the_log_period(rate: int) -> None:
    assert sound(f"machine: gantry_xyz\nsimulation: {{rate: {rate} Hz}}").simulation.step_ns * rate == 1_000_000_000


def test_a_rate_that_does_not_names_the_nearest() -> None:
    found = list(loaded("machine: gantry_xyz\nsimulation: {rate: 240 Hz}").findings)

    assert [f.code for f in found] == ["GS721"]
    assert "`200 Hz`" in found[0].hint and "`250 Hz`" in found[0].hint


@pytest.mark.parametrize("rate", ["1e-320", "1e-300", "1e308", "3e12"])
def test_a_rate_beyond_all_measure_is_a_finding(rate: str) -> None:
    found = list(loaded(f"machine: gantry_xyz\nsimulation: {{rate: {rate} Hz}}").findings)

    assert [f.code for f in found] == ["GS721"]


def test_files_may_lie_in_allowed_folders_only(tmp_path: Path) -> None:
    inside, outside = tmp_path / "cell", tmp_path / "meshes"
    inside.mkdir()
    outside.mkdir()
    (outside / "vise.stl").write_bytes((FOLDER / "vise.stl").read_bytes())
    (inside / "link.stl").symlink_to(outside / "vise.stl")
    cell = inside / "cell.yaml"
    text = "machine: gantry_xyz\nfixtures: {vise: {mesh: %s, unit: mm}}\n"

    for name in ("../meshes/vise.stl", "link.stl"):
        cell.write_text(text % name)
        assert [f.code for f in load_cell(cell).findings] == ["GS715"]
        assert load_cell(cell, [outside]).cell is not None
        cell.write_text(text % name + "packages: {m: ../meshes}\n")
        assert {f.code for f in load_cell(cell).findings} == {"GS715"}
        assert load_cell(cell, [outside]).cell is not None


@pytest.mark.parametrize("folder", ["../meshes", "/etc", "link", "below/../../meshes", "/"])
def test_a_cell_opens_no_folder_to_itself(tmp_path: Path, folder: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only who runs gcodesim opens folders; the finding says by which option."""
    inside, outside = tmp_path / "cell", tmp_path / "meshes"
    outside.mkdir()
    (inside / "below").mkdir(parents=True)
    (outside / "vise.stl").write_bytes((FOLDER / "vise.stl").read_bytes())
    (inside / "link").symlink_to(outside)
    cell = inside / "cell.yaml"
    text = "machine: gantry_xyz\nfixtures: {vise: {mesh: package://m/vise.stl, unit: mm}}\n"
    cell.write_text(text + f"packages: {{m: {folder}}}\n")
    (finding,) = (finding for finding in load_cell(cell).findings if finding.code == "GS715")
    assert "`m`" in finding.message and "--allow-path" in finding.hint
    if not folder.startswith("/"):
        assert load_cell(cell, [outside]).cell is not None
        monkeypatch.setenv("GCODESIM_ALLOW_PATH", f"/nowhere:{outside}")
        assert load_cell(cell).cell is not None
        monkeypatch.setenv("GCODESIM_ALLOW_PATH", "../meshes:.:link")  # of whoever is judged
        monkeypatch.chdir(inside)
        assert load_cell(cell).cell is None
    (inside / "below" / "vise.stl").write_bytes((FOLDER / "vise.stl").read_bytes())
    cell.write_text(text + "packages: {m: below}\n")
    assert load_cell(cell).cell is not None


_KINDS = {
    "mesh": "machine: gantry_xyz\nfixtures: {v: {mesh: %s, unit: mm}}\n",
    "stock": "machine: gantry_xyz\nstock: {mesh: %s, unit: mm, material: al6082_t6}\n",
    "from": "machine: gantry_xyz\nstock: {from: %s, material: al6082_t6}\n",
    "tools": "machine: gantry_xyz\ntool_table: %s\n",
    "parameters": "machine: gantry_xyz\nparameters: %s\n",
    "subroutines": "machine: gantry_xyz\nsubroutines: [%s]\n",
    "urdf": "robots: {arm: {urdf: %s}}\n",
}


@pytest.mark.parametrize("kind", _KINDS)
def test_files_that_are_none_neither_hang_nor_break_anything(
    tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "_LARGEST", 1000)
    inside = tmp_path / "cell"
    inside.mkdir()
    for name in ("pipe", "pipe.stl", "pipe.stock"):
        os.mkfifo(inside / name)
    for name, target in (("zero.stl", "/dev/zero"), ("secret", "/etc/passwd"), ("etc", "/etc"), ("loop", "loop")):
        (inside / name).symlink_to(target)
    for name in ("huge.stl", "huge.urdf", "huge"):
        with open(inside / name, "wb") as file:
            file.truncate(1001)
    with socket.socket(socket.AF_UNIX) as listening:
        monkeypatch.chdir(inside)
        listening.bind("door")
        links = '<link name="b"><visual><geometry><mesh filename="%s"/></geometry></visual></link>'
        joint = '<link name="c"/><joint name="j" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>'
        joint += '<limit lower="-1" upper="1" velocity="1" effort="1"/></joint>'
        for mesh in ("pipe.stl", "zero.stl", "etc/passwd", "door"):
            (inside / f"{mesh.replace('/', '_')}.robot").write_text(f'<robot name="a">{links % mesh}{joint}</robot>')
        for name in sorted(path.name for path in inside.iterdir()):
            if kind != "urdf" and name.endswith(".robot"):
                continue
            (inside / "cell.yaml").write_text(_KINDS[kind] % name)
            found = load_cell(inside / "cell.yaml")
            assert found.cell is None and {f.code for f in found.findings if f.level.word == "error"}, name


def test_defaults_are_listed() -> None:
    paths = {
        default.path for default in sound("machine: gantry_xyz\ntools: {1: {type: drill, diameter: 5}}").defaults_used
    }

    assert {("tools", 1, "point_angle"), ("tools", 1, "length"), ("machine", "rapids"), ("simulation", "rate")} <= paths
    assert ("tools", 1, "diameter") not in paths


def test_places_are_kept_for_later_findings() -> None:
    cell = sound("machine: gantry_xyz\nx-a: 1\ntools:\n  7: {type: drill, diameter: 5 mm}\n")

    assert (cell.span("tools", 7).line, cell.span("tools", 7).column) == (4, 3)
    assert cell.span("tools", 7, "diameter").column == 30
    assert cell.span("tools", 7, "length") == cell.span("tools", 7)  # a default: what is around it


def test_a_cell_that_is_not_there_is_no_finding(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        load_cell(tmp_path / "none.yaml")


def test_loading_imports_no_heavy_package() -> None:
    code = (
        "import sys; from gcodesim.cell import load_cell, place\n"
        f"for name in {[str(p) for p in CELLS]!r}: place(load_cell(name).cell)\n"
        "print(sorted({'numba', 'scipy', 'pybullet', 'trimesh', 'lark', 'rich'} & set(sys.modules)))"
    )

    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


@pytest.mark.parametrize("reason", ['""', '" "', "", '"\\n"'])
def test_a_suppression_says_why(reason: str) -> None:
    found = loaded(f"machine: gantry_xyz\nsuppress: [{{code: GS501, reason: {reason}}}]").findings
    assert {one.code for one in found} & {"GS705", "GS711"}

"""Settings of controls and robots become cells in which a program runs, and what is left out is listed."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.importers import IMPORTERS
from gcodesim.importers.importer import Imported, Importer, NoSettingsError
from gcodesim.jobs.job import Job
from gcodesim.kinematics.models import model_path
from gcodesim.simulation import check, prepare

MILL = """[EMC]
VERSION = 1.1
[DISPLAY]
DISPLAY = axis
[RS274NGC]
SUBROUTINE_PATH = subs:elsewhere
RS274NGC_STARTUP_CODE = G17 G20 G40 G64 P0.001 G90
REMAP = M400 modalgroup=10 ngc=clamp
REMAP = T prolog=x
[EMCIO]
TOOL_TABLE = mill.tbl
[HAL]
HALFILE = mill.hal
[TRAJ]
COORDINATES = X Y Y Z
LINEAR_UNITS = inch
MAX_LINEAR_VELOCITY = 5
#INCLUDE axes.inc
[KINS]
KINEMATICS = trivkins coordinates=xyyz kinstype=both
JOINTS = 4
[SPINDLE_0]
MAX_FORWARD_VELOCITY = 18000
"""
AXES = """[AXIS_X]
MIN_LIMIT = -10
MAX_LIMIT = 10
MAX_VELOCITY = 3
MAX_ACCELERATION = 30
[AXIS_Y]
MIN_LIMIT = -8
MAX_LIMIT = 8
MAX_VELOCITY = 3
[AXIS_Z]
MIN_LIMIT = -4
MAX_LIMIT = 1
MAX_VELOCITY = 9
[JOINT_0]
MAX_VELOCITY = 2
HOME = 1
BACKLASH = 0.002
[JOINT_1]
MIN_LIMIT = -7
MAX_LIMIT = 8
MAX_VELOCITY = 3
[JOINT_2]
MIN_LIMIT = -8
MAX_LIMIT = 6
MAX_VELOCITY = 2.5
[JOINT_3]
FERROR = 0.05
"""
TABLE = "T1 P1 Z+1.5 D+0.25 ;quarter inch end mill\nT2 P2 Z+0.1 D+0.5 ;stub\n"
TRUNNION = """[TRAJ]
COORDINATES = XYZAC
LINEAR_UNITS = mm
[KINS]
KINEMATICS = xyzac-trt-kins sparm=identityfirst
JOINTS = 5
[HAL]
HALFILE = trt.hal
HALCMD = setp xyzac-trt-kins.z-offset 20
[OFFSETS]
Y = 7.5
"""
GRBL = """$10=1 (status report, mask)
$11=0.010
$23=2
$27=1.000
$30=12000
$32={laser}
$100=80.000
$110=3000.000
$111=2400.000
$112=600.000
$120=200.000
$121=200.000
$122=50.000
$130=300.000
$131=180.000
$132=45.000
ok
{offsets}"""
KLIPPER = """[include parts/*.cfg]
[printer]
kinematics: {kinematics}
max_velocity: 300  # mm/s
max_accel: 4000
max_z_velocity: 15
square_corner_velocity: 8.0
minimum_cruise_ratio: 0.5
[stepper_x]
position_max: 235
[stepper_y]
position_max: 240
[stepper_z]
position_min: -2
position_max: 250
[gcode_macro START_PRINT]
gcode:
  G28
  G1 Z5
"""
MARLIN = """#define EXTRUDERS 2
#define DEFAULT_NOMINAL_FILAMENT_DIA 1.75 /* mm
 #define X_BED_SIZE 999 */
#define X_BED_SIZE 235 // mm
#define Y_BED_SIZE 235
#define Y_MIN_POS -5
#define X_MAX_POS (X_BED_SIZE + 10) / 2 - -3
#define Z_MAX_POS 250
#define DEFAULT_MAX_FEEDRATE          { 300, 280, 5, 25 }
#define DEFAULT_MAX_ACCELERATION      { 3000, 2500, 100, 10000 }
#define DEFAULT_ACCELERATION 1250
#define DEFAULT_TRAVEL_ACCELERATION 2000
//#define CLASSIC_JERK
#define TEMP_SENSOR_0 1
"""
PROGRAM = b"G21 G90\nT1 M6\nG0 X5 Z0\nG1 X10 F300\nG2 X10 Y5 I0 J2.5\nM2\n"
PRINT = b"G21\nG90\nM83\nG1 X20 Y20 Z0.2 F3000\nG1 X40 E1 F1200\n"


def imported(kind: str, path: Path) -> Imported:
    found = IMPORTERS[kind]().read(path, path.parent)
    named = {(left.setting.name, left.setting.line) for left in found.left}
    assert len(named) == len(found.left)
    assert all(left.why for left in found.left)
    return found


def run(found: Imported, folder: Path, program: bytes) -> Job:
    """The job of a program in the cell; it has no errors."""
    loaded = read_cell(SourceText("cell.yaml", found.text.encode()), folder / "cell.yaml")
    assert loaded.cell is not None, list(loaded.findings)
    job = prepare(SourceText("part.nc", program), loaded)
    results = check(job)
    assert not [finding for finding in results.findings if finding.level >= Severity.ERROR]
    return job


def left(found: Imported) -> dict[str, tuple[int, bool]]:
    return {one.setting.name: (one.setting.line, one.matters) for one in found.left}


@pytest.fixture
def mill(tmp_path: Path) -> Path:
    for name, text in (("mill.ini", MILL), ("axes.inc", AXES), ("mill.tbl", TABLE)):
        (tmp_path / name).write_text(text)
    (tmp_path / "subs").mkdir()
    return tmp_path / "mill.ini"


def test_an_ini_of_linuxcnc_becomes_a_machine(mill: Path) -> None:
    found = imported("linuxcnc", mill)
    job = run(found, mill.parent, PROGRAM.replace(b"Z0", b"Z-20"))

    assert job.shop is not None
    joints = job.shop.kinematics.joints
    by_name = {name: n for n, name in enumerate(joints.names)}
    mm = {name: (joints.lower[n] * 1e3, joints.upper[n] * 1e3, joints.speed[n] * 1e3) for name, n in by_name.items()}
    assert mm["X"] == pytest.approx((-254, 254, 2 * 25.4))  # the joint is slower than the axis
    assert mm["Y"] == pytest.approx((-7 * 25.4, 6 * 25.4, 2.5 * 25.4))  # two joints: the narrower of each
    assert mm["Z"] == pytest.approx((-101.6, 25.4, 5 * 25.4))  # the path is slower than the axis
    assert joints.acceleration[by_name["X"]] == pytest.approx(30 * 25.4e-3)
    assert job.shop.home[by_name["X"]] == pytest.approx(25.4e-3)
    cell = job.cell
    assert cell is not None
    assert cell.limits.spindle_speed == pytest.approx(18000 * 2 * 3.141592653589793 / 60)
    assert cell.tools[1].length == pytest.approx(1.5 * 25.4e-3)
    assert cell.tools[2].length != pytest.approx(0.1 * 25.4e-3)  # shorter than thick
    assert "startup: G17 G20 G40 G64 P0.001 G90" in found.text
    assert 'subroutines: ["subs"]' in found.text


def test_inches_of_an_ini_are_nowhere_read_as_millimetres(mill: Path) -> None:
    """A cell reads tool tables and parameters in mm; programs begin in inches."""
    mill.write_text(MILL.replace("SUBROUTINE_PATH", "PARAMETER_FILE = mill.var\nSUBROUTINE_PATH"))
    (mill.parent / "mill.var").write_text("5221 2\n5222 -1.5\n5223 -1\n5383 -2\n5400 3\n")
    found = imported("linuxcnc", mill)
    job = run(found, mill.parent, b"T1 M6\nG43 H1\nG0 X0 Y0\nM2\n")

    assert job.plan is not None
    assert job.plan.path.end[-1][:2].tolist() == pytest.approx([2 * 25.4e-3, -1.5 * 25.4e-3])
    assert "G59.3: {xyz: [0, 0, -50.8 mm]}" in found.text
    assert "parameters:" not in found.text and "tool_table:" not in found.text
    told = left(found)
    assert all(told[name][1] for name in ("[RS274NGC]PARAMETER_FILE", "[EMCIO]TOOL_TABLE"))


def test_an_axis_without_room_is_left_out(tmp_path: Path) -> None:
    axes = "".join(f"[AXIS_{a}]\nMIN_LIMIT=-300\nMAX_LIMIT=300\nMAX_VELOCITY=40\n" for a in "XYZ")
    (tmp_path / "m.ini").write_text(f"[TRAJ]\nCOORDINATES=XYZA\n{axes}[AXIS_A]\nMIN_LIMIT=0\nMAX_LIMIT=0\n")
    found = imported("linuxcnc", tmp_path / "m.ini")

    assert "A: {" not in found.text and left(found)["[AXIS_A]MIN_LIMIT"][1]
    run(found, tmp_path, PROGRAM.replace(b"T1 M6\n", b""))


def test_the_depth_of_the_queue_is_taken(tmp_path: Path) -> None:
    axes = "".join(f"[AXIS_{a}]\nMIN_LIMIT=-300\nMAX_LIMIT=300\nMAX_VELOCITY=40\n" for a in "XYZ")
    (tmp_path / "m.ini").write_text(f"[TRAJ]\nCOORDINATES=XYZ\nARC_BLEND_OPTIMIZATION_DEPTH=200\n{axes}")
    found = imported("linuxcnc", tmp_path / "m.ini")

    assert "look_ahead: 200" in found.text.splitlines()
    run(found, tmp_path, PROGRAM.replace(b"T1 M6\n", b""))


def test_everything_else_of_the_ini_is_listed_with_its_line(mill: Path) -> None:
    found = imported("linuxcnc", mill)
    lines = MILL.splitlines()

    told = left(found)
    assert told["[EMC]VERSION"] == (2, False)
    assert told["[RS274NGC]SUBROUTINE_PATH"] == (6, True)
    assert [(one.setting.line, one.matters) for one in found.left if one.setting.name.endswith("REMAP")] == [
        (8, True),
        (9, True),
    ]
    assert told["[HAL]HALFILE"] == (lines.index("HALFILE = mill.hal") + 1, False)
    assert told["[JOINT_0]BACKLASH"] == (AXES.splitlines().index("BACKLASH = 0.002") + 1, True)
    assert told["[JOINT_3]FERROR"][1] is False
    whole = [line for line in (MILL + AXES).splitlines() if "=" in line]
    assert found.taken + len(found.left) == len(whole)


def test_kinematics_with_what_hal_files_set(tmp_path: Path) -> None:
    (tmp_path / "trt.ini").write_text(
        TRUNNION + "".join(f"[AXIS_{a}]\nMIN_LIMIT=-300\nMAX_LIMIT=300\nMAX_VELOCITY=40\n" for a in "XYZAC")
    )
    (tmp_path / "trt.hal").write_text("loadrt x\nsetp xyzac-trt-kins.y-offset [OFFSETS]Y\n# setp a.b 3\n")
    found = imported("linuxcnc", tmp_path / "trt.ini")

    assert "kinematics: {type: xyzac-trt-kins, y_offset: 7.5 mm, z_offset: 20 mm, identity_first: true}" in found.text
    job = run(found, tmp_path, b"G21 G90\nM428\nG0 A10 C20\nG1 X5 F300\nM2\n")
    assert job.plan is not None


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[EMC]\nVERSION=1\n", "no INI of LinuxCNC"),
        ("[TRAJ]\nCOORDINATES=UVW\n[KINS]\nJOINTS=3\n", "moves none"),
        ("[TRAJ]\nCOORDINATES=X\n[AXIS_X]\nMIN_LIMIT=5\nMAX_LIMIT=1\n", "limits from 5 to 1"),
        ("#INCLUDE mill.ini\n", "circle"),
    ],
)
def test_what_is_no_ini_is_refused(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "mill.ini").write_text(text)
    with pytest.raises(NoSettingsError, match=says):
        IMPORTERS["linuxcnc"]().read(tmp_path / "mill.ini", tmp_path)


def test_joints_that_are_not_simulated_are_told(tmp_path: Path) -> None:
    axes = "".join(f"[AXIS_{a}]\nMIN_LIMIT=-300\nMAX_LIMIT=300\nMAX_VELOCITY=40\n" for a in "XYZ")
    (tmp_path / "d.ini").write_text(
        f"[TRAJ]\nCOORDINATES=XYZ\n[KINS]\nKINEMATICS=lineardeltakins\nJOINTS=3\n{axes}[JOINT_0]\nMAX_VELOCITY=1\n"
    )
    found = imported("linuxcnc", tmp_path / "d.ini")

    assert left(found)["[KINS]KINEMATICS"] == (4, True)
    assert left(found)["[JOINT_0]MAX_VELOCITY"][1] is True
    assert "speed: 40 mm/s" in found.text
    run(found, tmp_path, PROGRAM.replace(b"T1 M6\n", b""))


@pytest.mark.parametrize(
    ("laser", "offsets", "expected"),
    [
        ("0", "", "limits: {spindle_speed: 12000 rpm}"),
        ("1", "[G54:-200.000,-100.000,-20.000]\nok\n", "laser_mode: 12000"),
    ],
)
def test_a_list_of_grbl(tmp_path: Path, laser: str, offsets: str, expected: str) -> None:
    (tmp_path / "grbl.txt").write_text(GRBL.format(laser=laser, offsets=offsets))
    found = imported("grbl", tmp_path / "grbl.txt")
    job = run(found, tmp_path, b"G21 G90\nG0 X5 Y5 Z5\nG1 X10 F300\nM2\n")

    assert job.shop is not None
    joints = job.shop.kinematics.joints
    assert (joints.lower * 1e3).tolist() == pytest.approx([-300, -180, -45])
    assert (joints.speed * 1e3).tolist() == pytest.approx([50, 40, 10])
    assert (joints.acceleration * 1e3).tolist() == pytest.approx([200, 200, 50])
    assert (job.shop.home * 1e3).tolist() == pytest.approx([-1, -179, -1])  # Y homes to the other side
    assert expected in found.text
    assert ("xyz: [-200, -100, -20 mm]" in found.text) == bool(offsets)
    assert left(found)["$100"] == (7, False) and left(found)["$10"] == (1, False)


def test_offsets_of_grbl_are_in_the_units_of_its_reports(tmp_path: Path) -> None:
    """$13: the list of `$#` is in inches; that of `$$` is not."""
    (tmp_path / "grbl.txt").write_text(GRBL.format(laser=0, offsets="$13=1\n[G54:-4.000,-2.000,-1.000]\n"))
    found = imported("grbl", tmp_path / "grbl.txt")

    assert "G54: {xyz: [-101.6, -50.8, -25.4 mm]}" in found.text and "X: {travel: [-300, 0 mm]" in found.text


def test_corners_of_grbl_are_those_of_its_deviation(tmp_path: Path) -> None:
    (tmp_path / "grbl.txt").write_text(GRBL.format(laser=0, offsets="").replace("$11=0.010", "$11=0.025"))
    found = imported("grbl", tmp_path / "grbl.txt")

    assert "firmware: {junction_deviation: 0.025 mm}" in found.text and "$11" not in left(found)
    assert limits_of(run(found, tmp_path, b"G21 G90\nG1 X-10 Y-10 F300\nM2\n"))["deviation"] == pytest.approx(2.5e-5)


def test_what_only_grblhal_means(tmp_path: Path) -> None:
    """A lathe is no laser, zero may be at home, and an axis may have no travel."""
    own = "$22=9\n$113=3600\n$123=100\n$133=0\n"
    (tmp_path / "grbl.txt").write_text(GRBL.format(laser=2, offsets=own))
    found = imported("grbl", tmp_path / "grbl.txt")

    assert "laser_mode" not in found.text and left(found)["$32"][1] and left(found)["$133"][1]
    assert "X: {travel: [-300, 0 mm], speed: 50 mm/s, acceleration: 200 mm/s^2, home: 0 mm}" in found.text
    assert "Y: {travel: [0, 180 mm], speed: 40 mm/s, acceleration: 200 mm/s^2, home: 0 mm}" in found.text
    run(found, tmp_path, b"G21 G90\nG0 X5 Y0 Z-1\nG1 X10 F300\nM2\n")


@pytest.mark.parametrize("kinematics", ["corexy", "delta"])
def test_a_configuration_of_klipper(tmp_path: Path, kinematics: str) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "head.cfg").write_text("[extruder]\nnozzle_diameter: 0.6\nfilament_diameter: 2.85\n")
    (tmp_path / "printer.cfg").write_text(KLIPPER.format(kinematics=kinematics))
    found = imported("klipper", tmp_path / "printer.cfg")
    job = run(found, tmp_path, PRINT)

    assert job.shop is not None and job.cell is not None
    joints = job.shop.kinematics.joints
    assert joints.speed[2] == pytest.approx(0.015) and joints.acceleration[0] == pytest.approx(4.0)
    upper = [0.235, 0.24, 0.25] if kinematics == "corexy" else [0.1, 0.1, 0.2]
    assert joints.upper.tolist() == pytest.approx(upper)
    assert "bead_width: 0.72" in found.text and "filament_diameter: 2.85" in found.text
    assert limits_of(job) == {
        "speed": (0.3, 0.3, 0.015, 0.3), "acceleration": (4.0, 4.0, 4.0, 1000.0), "corner": 0.008, "deviation": 0.0,
        "jerk": (0.0, 0.0, 0.0, 1000.0), "printing": 4.0, "travel": 4.0, "retracting": 4.0, "buffer": 1000,
        "plain": False,
    }  # fmt: skip
    assert left(found)["[printer]minimum_cruise_ratio"] == (8, True)
    assert left(found)["[gcode_macro START_PRINT]"] == (16, True)
    assert ("[printer]kinematics" in left(found)) == (kinematics == "delta")


def test_carriages_of_klipper_that_are_not_called_after_their_axes(tmp_path: Path) -> None:
    text = KLIPPER.format(kinematics="generic_cartesian")
    for letter in "xyz":
        text = text.replace(f"[stepper_{letter}]", f"[carriage the_{letter}]\naxis: {letter}")
    (tmp_path / "printer.cfg").write_text(text.replace("position_max: 250", "position_max: 20000000"))
    found = imported("klipper", tmp_path / "printer.cfg")
    job = run(found, tmp_path, PRINT)

    assert job.shop is not None
    assert job.shop.kinematics.joints.upper.tolist() == pytest.approx([0.235, 0.24, 0.998])
    assert left(found)["[carriage the_z]position_max"][1]  # a belt that carries parts away


BRANCHES = """#define DELTA
#define SMALL 0
#if ENABLED(DELTA) && !ENABLED(SMALL)
  #define PRINTABLE_RADIUS 185.0f // mm
  #define DELTA_HEIGHT 437.25
#elif ANY(MORGAN_SCARA, MP_SCARA)
  #define PRINTABLE_RADIUS 82
#else
  #define DELTA_HEIGHT 1
#endif
#ifndef DELTA_HEIGHT
  #define X_MAX_POS 5
#elif HAS_WHATEVER > 3
  #define Y_MAX_POS PRINTABLE_RADIUS
#endif
#define X_BED_SIZE ((PRINTABLE_RADIUS) * 2)
#define X_MIN_POS -(PRINTABLE_RADIUS)
#define X_MAX_POS PRINTABLE_RADIUS
#define Z_MAX_POS MANUAL_Z_HOME_POS
#define MANUAL_Z_HOME_POS DELTA_HEIGHT
"""


def test_branches_of_marlin_that_do_not_hold(tmp_path: Path) -> None:
    own = ("_POS", "X_BED", "/*")
    text = "".join(line for line in MARLIN.splitlines(keepends=True) if not any(part in line for part in own))
    (tmp_path / "Configuration.h").write_text(BRANCHES + text)
    found = imported("marlin", tmp_path / "Configuration.h")

    assert "X: {travel: [-185, 185 mm]" in found.text
    assert "Y: {travel: [0, 185 mm]" in found.text  # of what is not known all branches count
    assert "Z: {travel: [0, 437.25 mm]" in found.text
    assert left(found)["DELTA"] == (1, True)


CORNERS = """{classic}#define CLASSIC_JERK
#define DEFAULT_XJERK 12.0
#define DEFAULT_YJERK 11.0
#define DEFAULT_ZJERK 0.3
#define DEFAULT_EJERK 5.0
#define JUNCTION_DEVIATION_MM 0.02
"""


@pytest.mark.parametrize("classic", ["", "//"])
def test_corners_of_marlin(tmp_path: Path, classic: str) -> None:
    """By classic jerk where that is defined, else by junction deviation."""
    text = MARLIN.replace("//#define CLASSIC_JERK\n", CORNERS.format(classic=classic))
    (tmp_path / "Configuration.h").write_text(text)
    found = imported("marlin", tmp_path / "Configuration.h")
    limits = limits_of(run(found, tmp_path, PRINT))

    assert limits["deviation"] == (2e-5 if classic else 0.0)
    if not classic:
        assert limits["jerk"] == pytest.approx((0.012, 0.011, 0.0003, 0.005))
    assert ("DEFAULT_XJERK" in left(found)) == bool(classic)
    assert ("JUNCTION_DEVIATION_MM" in left(found)) != bool(classic)


def limits_of(job: Job) -> dict[str, object]:
    """Of the planner before the first line; the program gives none, and nothing is assumed."""
    assert job.plan is not None
    assert not any(finding.code == "GS210" for finding in job.findings)
    limits = job.plan.path.states[0].limits
    assert limits is not None
    return limits._asdict()


def test_a_configuration_of_marlin(tmp_path: Path) -> None:
    (tmp_path / "Configuration.h").write_text(MARLIN)
    found = imported("marlin", tmp_path / "Configuration.h")
    job = run(found, tmp_path, PRINT)

    assert job.shop is not None and job.cell is not None
    joints = job.shop.kinematics.joints
    assert joints.upper.tolist() == pytest.approx([0.1255, 0.235, 0.25])
    assert joints.lower.tolist() == pytest.approx([0.0, -0.005, 0.0])
    assert joints.speed.tolist() == pytest.approx([0.3, 0.28, 0.005])
    assert sorted(job.cell.tools) == [0, 1]
    limits = limits_of(job)
    assert (limits["printing"], limits["travel"], limits["retracting"]) == (1.25, 2.0, 3.0)
    assert limits["speed"] == pytest.approx((0.3, 0.28, 0.005, 0.025))
    assert list(left(found)) == ["TEMP_SENSOR_0"]


def package(folder: Path, model: str, limits: str, pairs: str, pose: str) -> Path:
    """A MoveIt configuration as the setup assistant writes it, with the description in a package of its own."""
    description, config = folder / f"{model}_description", folder / f"{model}_moveit_config"
    (description / "urdf").mkdir(parents=True)
    (config / "config").mkdir(parents=True)
    (description / "package.xml").write_text(f"<package><name>{model}_description</name></package>")
    (description / "urdf" / f"{model}.urdf").write_bytes(model_path(model).read_bytes())
    (config / ".setup_assistant").write_text(
        f"moveit_setup_assistant_config:\n  URDF:\n    package: {model}_description\n"
        f"    relative_path: urdf/{model}.urdf\n"
    )
    (config / "config" / "joint_limits.yaml").write_text(limits)
    far = 'value="9" was='
    joints = "".join(f'<joint name="joint_{k}" value="{v}"/>' for k, v in enumerate(pose.split(), start=1))
    (config / "config" / f"{model}.srdf").write_text(
        f'<?xml version="1.0"?>\n<robot name="{model}">\n'
        '<group name="arm"><chain base_link="base" tip_link="tool0"/></group>\n'
        f'<group_state name="ready" group="arm">{joints}</group_state>'
        f'<group_state name="far" group="arm">{joints.replace("value=", far)}</group_state>\n'
        f'<virtual_joint name="fixed" type="fixed" parent_frame="world" child_link="base"/>\n{pairs}\n</robot>\n'
    )
    return config


LIMITS = """default_velocity_scaling_factor: 0.1
joint_limits:
""" + "".join(
    f"  joint_{k}:\n    has_velocity_limits: true\n    max_velocity: {k}.5\n    has_acceleration_limits: true\n"
    f"    max_acceleration: {k}\n    max_position: 3\n"
    for k in range(1, 7)
)


@pytest.mark.parametrize(
    ("model", "pose"),
    [("ur10e", "0 -1.57 1.57 -1.57 -1.57 0"), ("kuka_kr10_r1100_2", "0 -1.5708 1.5708 0 1.5708 0")],
)
def test_a_moveit_configuration(tmp_path: Path, model: str, pose: str) -> None:
    pairs = (
        '<disable_collisions link1="link_3" link2="link_6" reason="Never"/>\n'
        '<disable_collisions link1="link_3" link2="hand"/>'
    )
    config = package(tmp_path, model, LIMITS, pairs, pose)
    found = IMPORTERS["moveit"]().read(config, tmp_path)
    job = run(found, tmp_path, b"G21 G90 G94\nT1 M6\nG0 X0 Y0 Z20\nG1 X20 F600\nM2\n")

    assert job.shop is not None and job.cell is not None
    joints = job.shop.kinematics.joints
    assert joints.speed.tolist() == pytest.approx([1.5, 2.5, 3.5, 4.5, 5.5, 6.5])
    assert joints.acceleration.tolist() == pytest.approx([1, 2, 3, 4, 5, 6])
    assert job.shop.home.tolist() == pytest.approx([float(v) for v in pose.split()], abs=1e-6)
    assert list(job.cell.robots["arm"].poses.values()) == [tuple(job.shop.home)]
    assert job.cell.robots["arm"].allow_collisions == (("link_3", "link_6"),)
    told = [(one.setting.name, one.setting.line) for one in found.left]
    assert "`joint_1` is outside its travel there" in [one.why for one in found.left]
    assert ("virtual_joint", 5) in told and ("disable_collisions", 7) in told
    assert ("default_velocity_scaling_factor", 1) in told
    assert sum(name.endswith("max_position") for name, _ in told) == 6


def test_a_moveit_configuration_that_cannot_be_read(tmp_path: Path) -> None:
    config = package(tmp_path, "ur10e", "", "", "0 0 0 0 0 0")
    srdf = config / "config" / "ur10e.srdf"
    srdf.rename(srdf.with_suffix(".srdf.xacro"))
    with pytest.raises(NoSettingsError, match=r"expand ur10e\.srdf\.xacro"):
        IMPORTERS["moveit"]().read(config, tmp_path)
    srdf.write_text("<robot>")
    with pytest.raises(NoSettingsError, match=re.escape(f"{srdf}:1: no XML")):
        IMPORTERS["moveit"]().read(config, tmp_path)


@pytest.mark.parametrize("kind", IMPORTERS)
def test_declares_itself(kind: str) -> None:
    importer = IMPORTERS[kind]

    assert issubclass(importer, Importer) and importer.kind == kind
    assert importer.says and "\n" not in importer.says


@pytest.mark.parametrize("kind", [kind for kind in IMPORTERS if kind != "moveit"])
@pytest.mark.parametrize("data", [b"", b"\x00\xff\xfe[", b"[\n]=\n#define\n$=\n" * 50])
def test_any_bytes_are_refused_in_words(kind: str, data: bytes, tmp_path: Path) -> None:
    (tmp_path / "x").write_bytes(data)
    with pytest.raises(NoSettingsError):
        IMPORTERS[kind]().read(tmp_path / "x", tmp_path)


def test_blocks_that_grbl_runs_at_its_start(tmp_path: Path) -> None:
    (tmp_path / "grbl.txt").write_text(GRBL.format(laser=0, offsets="$N0=G20 G54 M8\n$N1=G91\n"))
    found = imported("grbl", tmp_path / "grbl.txt")

    assert "startup: G20 G54 G91" in found.text and left(found)["$N0"][1] and "$N1" not in left(found)


@pytest.mark.parametrize("before", ["", "$$ < ", "<<< ", "[12:04:11] ", "Recv: ", "12:04:11.250 > "])
@pytest.mark.parametrize("behind", ["", "    (X-axis maximum rate, mm/min)", " ; said", "\r"])
def test_lists_of_grbl_as_senders_keep_them(tmp_path: Path, before: str, behind: str) -> None:
    plain = tmp_path / "plain.txt"
    plain.write_text(GRBL.format(laser=0, offsets=""))
    (tmp_path / "kept.txt").write_text("".join(f"{before}{line}{behind}\n" for line in plain.read_text().splitlines()))

    assert imported("grbl", tmp_path / "kept.txt").lines[1:] == imported("grbl", plain).lines[1:]


def test_a_list_of_grbl_in_json_and_in_utf_16(tmp_path: Path) -> None:
    plain = tmp_path / "plain.txt"
    plain.write_text(GRBL.format(laser=0, offsets=""))
    pairs = dict(line.partition("(")[0].split("=") for line in plain.read_text().splitlines() if line.startswith("$"))
    (tmp_path / "saved.json").write_text(json.dumps({name: value.strip() for name, value in pairs.items()}))
    (tmp_path / "wide.txt").write_text(plain.read_text(), encoding="utf-16")

    for name in ("saved.json", "wide.txt"):
        assert imported("grbl", tmp_path / name).lines[1:] == imported("grbl", plain).lines[1:], name


def test_a_comment_about_a_setting_of_grbl_is_none(tmp_path: Path) -> None:
    (tmp_path / "grbl.txt").write_text("; before: $110=1\n(was: $111=1)\n" + GRBL.format(laser=0, offsets=""))

    assert "speed: 50 mm/s" in imported("grbl", tmp_path / "grbl.txt").text

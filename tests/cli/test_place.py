"""`gcodesim place`: a part that cannot be reached gets a place where it can."""

import json
import subprocess
import sys

import pytest

PROGRAM = "G21 G90 G17\nT1 M6\nM3 S9000\nG0 X0 Y0 Z50\nG1 Z0 F2000\nG1 X200\nG1 Y200\nG0 Z50\nM5\nM2\n"
CELL = """gcodesim: 1
frames:
  table: {in: world, xyz: [1000, 0, 250]}   # too far
robots: {arm: {model: kuka_kr10_r1100_2}}
work_offsets: {G54: {in: table}}
tools: {1: {type: flat_end_mill, diameter: 6, length: 40}}
"""


def gcodesim(folder, *words):
    return subprocess.run(
        [sys.executable, "-m", "gcodesim", *words], cwd=folder, capture_output=True, text=True, timeout=600, check=False
    )


def files(folder, cell=CELL):
    (folder / "part.nc").write_text(PROGRAM)
    (folder / "cell.yaml").write_text(cell)


def test_the_part_gets_a_place_that_check_accepts(tmp_path):
    files(tmp_path)
    within = ("--within", "400,0,0", "--step", "200")
    before = gcodesim(tmp_path, "check", "part.nc", "--cell", "cell.yaml")
    assert before.returncode == 1 and "GS202" in before.stdout
    said = gcodesim(tmp_path, "place", "part.nc", "--cell", "cell.yaml", *within, "-o", "seen")
    assert said.returncode == 0, said.stderr
    assert (
        "now: the program cannot be run whole" in said.stdout and "collision" not in said.stdout
    )  # it is out of reach
    assert "frames.table: xyz [600, 0, 250 mm]" in said.stdout
    assert sorted(path.name for path in (tmp_path / "seen").iterdir()) == ["reach.stl", "reach.svg"]
    assert (tmp_path / "cell.yaml").read_text() == CELL
    told = gcodesim(tmp_path, "place", "part.nc", "--cell", "cell.yaml", *within, "--write", "--format", "json")
    result = json.loads(told.stdout)
    assert result["best"]["shift_mm"] == [-400.0, 0.0, 0.0] and result["written"] is True
    assert result["good_shifts_mm"] == [[-200.0, 0.0, 0.0], [-400.0, 0.0, 0.0]]
    assert result["now"] == {"good": False, "margin_deg": None}
    assert (tmp_path / "cell.yaml").read_text() == CELL.replace("[1000, 0, 250]", "[600, 0, 250 mm]")
    after = gcodesim(tmp_path, "check", "part.nc", "--cell", "cell.yaml")
    assert after.returncode == 0, after.stdout


def test_the_arm_moves_the_other_way(tmp_path):
    files(tmp_path)
    said = gcodesim(
        tmp_path, "place", "part.nc", "--cell", "cell.yaml", "--arm", "--within", "400,0,0", "--step", "200"
    )
    assert "the arm shifted by X+400 mm" in said.stdout and "robots.arm.base: xyz [400, 0, 0 mm]" in said.stdout


def test_where_nothing_fits_the_status_is_1(tmp_path):
    files(tmp_path, CELL.replace("1000", "9000"))
    said = gcodesim(tmp_path, "place", "part.nc", "--cell", "cell.yaml", "--within", "100", "--step", "100")
    assert said.returncode == 1 and "no place was found" in said.stdout


def test_a_machine_tool_has_no_use_for_it(tmp_path):
    files(tmp_path, "machine: gantry_xyz\ntools: {1: {type: flat_end_mill, diameter: 6, length: 40}}\n")
    said = gcodesim(tmp_path, "place", "part.nc", "--cell", "cell.yaml")
    assert said.returncode == 2 and "is for arms" in said.stderr
    wrong = gcodesim(tmp_path, "place", "part.nc", "--cell", "cell.yaml", "--within", "1,2")
    assert wrong.returncode == 2


POST = CELL.replace("1000", "600") + "fixtures: {post: {box: [60, 60, 700], in: %s}}\n"


def good_shifts(folder, *words):
    said = gcodesim(
        folder,
        "place",
        "part.nc",
        "--cell",
        "cell.yaml",
        "--within",
        "0,200,0",
        "--step",
        "200",
        "--format",
        "json",
        *words,
    )
    return json.loads(said.stdout)["good_shifts_mm"]


def test_a_place_where_the_arm_hits_a_fixture_is_not_good(tmp_path):
    files(tmp_path, POST.split("fixtures")[0])
    everywhere = [[0.0, 0.0, 0.0], [0.0, 200.0, 0.0], [0.0, -200.0, 0.0]]
    assert good_shifts(tmp_path) == everywhere
    files(tmp_path, POST % "world, xyz: [300, 250, 0]")
    assert good_shifts(tmp_path) == [[0.0, 0.0, 0.0], [0.0, -200.0, 0.0]]
    assert sorted(good_shifts(tmp_path, "--arm")) == [[0.0, -200.0, 0.0], [0.0, 0.0, 0.0]]  # the post stays
    for y, status in ((0, 0), (200, 1)):  # as the check of the whole motion says
        files(tmp_path, (POST % "world, xyz: [300, 250, 0]").replace("[600, 0,", f"[600, {y},"))
        assert gcodesim(tmp_path, "check", "part.nc", "--cell", "cell.yaml").returncode == status


def test_fixtures_on_the_frame_of_the_work_go_along(tmp_path):
    """A post beside the work stays in the way of a part that is shifted to it only if it stands on the ground."""
    files(tmp_path, POST % "world, xyz: [700, -260, 200]")
    assert good_shifts(tmp_path) == [[0.0, 0.0, 0.0], [0.0, 200.0, 0.0]]
    files(tmp_path, POST % "table, xyz: [100, -260, -50]")
    assert len(good_shifts(tmp_path)) == 3


CLAMP = CELL.replace("1000", "600") + "fixtures: {clamp: {box: [20, 20, 20], in: %s}}\n"


def test_a_place_where_a_tool_enters_a_fixture_that_stays_is_not_good(tmp_path):
    """A low clamp that no link comes near; one on the frame of the work is entered at each place, as `check` says."""
    files(tmp_path, CLAMP % "world, xyz: [800, 350, 245]")
    assert good_shifts(tmp_path) == [[0.0, 0.0, 0.0], [0.0, -200.0, 0.0]]
    for y, status in ((0, 0), (200, 1)):
        files(tmp_path, (CLAMP % "world, xyz: [800, 350, 245]").replace("[600, 0,", f"[600, {y},"))
        assert gcodesim(tmp_path, "check", "part.nc", "--cell", "cell.yaml").returncode == status
    files(tmp_path, CLAMP % "table, xyz: [200, 150, -5]")
    assert len(good_shifts(tmp_path)) == 3


EXTERNALS = {
    "rail": """externals:
  rail: {carries: arm, free: true, axes: {U: {travel: [0, 2 m], speed: 1 m/s, acceleration: 2 m/s^2}}}
work_offsets: {G54: {in: table}}
frames: {table: {in: world, xyz: [900, FAR, 300]}}
""",
    "positioner": """externals:
  table:
    axes: {C: {travel: [-180, 180 deg], speed: 90 deg/s, acceleration: 300 deg/s^2}}
    base: {in: world, xyz: [620, 0, 250]}
work_offsets: {G54: {in: table, xyz: [0, FAR, 60]}}
""",
}


@pytest.mark.parametrize(("name", "step"), [pytest.param("rail", 1000, marks=pytest.mark.slow), ("positioner", 700)])
def test_external_axes_are_asked_at_each_place(tmp_path, name, step):
    """The places are those at which a check of the whole program finds nothing out of reach."""
    cell = CELL[: CELL.index("frames:")] + CELL[CELL.index("robots:") : CELL.index("work_offsets")]
    cell += CELL[CELL.index("tools:") :] + EXTERNALS[name]
    turned = " C40" if name == "positioner" else ""
    program = f"G21 G90 G17\nT1 M6\nG43 H1\nG0 X0 Y0 Z50{turned}\nG1 Z0 F2000\nG1 X100\nG1 Y100\nG0 Z50\nM2\n"
    (tmp_path / "part.nc").write_text(program)
    (tmp_path / "cell.yaml").write_text(cell.replace("FAR", "0"))
    within = f"0,{step},0"
    said = gcodesim(
        tmp_path, "place", "part.nc", "--cell", "cell.yaml", "--within", within, "--step", str(step), "--format", "json"
    )
    good = [y for _, y, _ in json.loads(said.stdout)["good_shifts_mm"]]
    expected = []
    for y in (0, step, -step):
        (tmp_path / "cell.yaml").write_text(cell.replace("FAR", str(y)))
        if gcodesim(tmp_path, "check", "part.nc", "--cell", "cell.yaml").returncode == 0:
            expected.append(float(y))
    assert 0.0 in good and len(good) < 3
    assert good == expected

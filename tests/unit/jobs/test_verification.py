"""A run with a target: the part is compared with it, and the lines behind every place out of tolerance are named."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import trimesh

from gcodesim.cell import load_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.simulation import prepare, run
from tests.slow import some_slow

BLOCK = "stock: {min: [0, 0, -10], max: [40, 30, 0], resolution: 0.5}"
FLAT = "{type: flat_end_mill, diameter: 6, length: 40}"
HEAD = ["G21 G90 G17 G94 G54 G61", "T1 M6", "G43 H1", "S8000 M3"]
END = ["G0 Z20", "M5", "M2"]


def extruded(outline, caps):
    """A body along X from 0 to 40 mm: outline (k, 2) in Y and Z, counter-clockwise, its ends made of convex `caps`."""
    count = len(outline)
    points = np.array([(x, y, z) for x in (0.0, 40.0) for y, z in outline])
    faces = []
    for k in range(count):
        n = (k + 1) % count
        faces += [(k, n, n + count), (k, n + count, k + count)]
    for cap in caps:
        for k in range(1, len(cap) - 1):
            faces += [(cap[0], cap[k + 1], cap[k]), tuple(count + c for c in (cap[0], cap[k], cap[k + 1]))]
    return trimesh.Trimesh(points, np.array(faces), process=False)


def block(right=30, top=0):
    return extruded([(0, -10), (right, -10), (right, top), (0, top)], [(0, 1, 2, 3)])


SLOT = [(0, -10), (30, -10), (30, -2), (30, 0), (18, 0), (18, -2), (12, -2), (12, 0), (0, 0), (0, -2)]
SLOTTED = extruded(SLOT, [(0, 1, 2, 9), (5, 2, 3, 4), (9, 6, 7, 8)])


@pytest.fixture
def outcome(tmp_path):
    """Results and findings of a program in a cell with a target."""

    def of(lines, mesh, *, stock=BLOCK, target="tolerance: 0.1", tool=FLAT, more=""):
        mesh.export(tmp_path / "part.stl")
        (tmp_path / "cell.yaml").write_text(
            "gcodesim: 1\nmachine: gantry_xyz\nwork_offsets: {G54: {xyz: [500, 400, -150]}}\n"
            f"{stock}\ntools:\n  1: {tool}\n"
            f"target: {{mesh: part.stl, unit: mm, {target}}}\nsimulation: {{world: kinematic, rate: 100 Hz}}\n{more}"
        )
        program = SourceText("part.nc", ("\n".join([*HEAD, *lines, *END]) + "\n").encode())
        job = prepare(program, load_cell(tmp_path / "cell.yaml"), Options())
        results, _ = run(job, tmp_path / "out")
        assert json.loads((tmp_path / "out" / "results.json").read_text()) == json.loads(results.text())
        return results

    return of


def told(results):
    return [(finding.code, finding.span.line) for finding in results.findings if finding.code.startswith("GS44")]


GOOD = ["G0 X-5 Y15 Z2", "G1 Z-2 F300", "X45 F600"]


def test_a_part_within_its_tolerance_has_no_finding(outcome):
    results = outcome(GOOD, SLOTTED)
    assert told(results) == []
    target = results.as_json()["target"]
    assert (target["gouges"], target["excesses"], target["share_outside"]) == (0, 0, 0.0)
    assert abs(target["least_deviation_mm"]) < 0.01 and abs(target["most_deviation_mm"]) < 0.01


def test_a_gouge_is_told_with_its_line_depth_place_and_tool(outcome):
    results = outcome(["G0 X-5 Y15 Z2", "G1 Z-2 F300", "X10 F600", "X20 Z-2.6", "X30 Z-2", "X45"], SLOTTED)
    assert told(results) == [("GS441", 8)]
    (region,) = results.as_json()["target"]["regions"]
    assert (region["kind"], region["line"], region["tool"], region["gap_mm"]) == ("gouge", 8, 1, None)
    assert region["depth_mm"] == pytest.approx(0.6, abs=0.01)
    assert region["z_mm"] == pytest.approx(-2.6, abs=0.01)
    assert 17 < region["x_mm"] < 23
    assert {line["line"] for line in region["lines"] if line["share"] > 0.02} == {8, 9}
    assert sum(line["share"] for line in region["lines"]) == pytest.approx(1.0, abs=1e-6)


def test_what_a_tool_left_is_blamed_on_its_line_and_what_none_touched_on_the_nearest(outcome):
    shallow = outcome(["G0 X-5 Y15 Z2", "G1 Z-1.5 F300", "X45 F600"], SLOTTED)
    assert told(shallow) == [("GS442", 7)]
    (region,) = shallow.as_json()["target"]["regions"]
    assert (region["depth_mm"], region["gap_mm"]) == (pytest.approx(0.5, abs=0.01), None)
    assert region["volume_mm3"] == pytest.approx(40 * 6 * 0.5, rel=0.02)
    beside = outcome(["G0 X-5 Y4 Z2", "G1 Z1 F300", "X45 F600"], SLOTTED)
    assert told(beside) == [("GS442", 0)]  # nothing came to the stock at all
    (region,) = beside.as_json()["target"]["regions"]
    assert (region["line"], region["lines"]) == (None, [])
    assert region["depth_mm"] == pytest.approx(2.0, abs=0.25)


def test_a_rapid_that_gouges_is_named(outcome):
    results = outcome([*GOOD, "G0 X45 Y4 Z-0.4", "G0 X-5"], SLOTTED)
    assert [code for code, _ in told(results)] == ["GS441"]
    assert told(results)[0][1] == 9


def test_loose_pieces_and_a_target_beyond_the_stock(outcome, tmp_path):
    raw = trimesh.util.concatenate([block(), trimesh.creation.box(bounds=[[46, 0, -10], [60, 30, 0]])])
    raw.export(tmp_path / "raw.stl")
    stock = "stock: {mesh: raw.stl, unit: mm, in: G54, resolution: 0.5}"
    loose = outcome([], block(), stock=stock)
    assert told(loose) == [("GS443", 0)]
    assert loose.as_json()["target"]["loose"][0]["volume_mm3"] == pytest.approx(14 * 30 * 10, rel=1e-3)
    beyond = outcome([], block(top=2))
    assert told(beyond) == [("GS441", 0)]  # no line took it
    wider = outcome([], SLOTTED, stock="stock: {min: [0, 0, -10], max: [35, 30, 0], resolution: 0.5}")
    assert "GS444" in {code for code, _ in told(wider)}


def test_what_cannot_be_compared_is_told(outcome):
    apart = outcome([], SLOTTED, target="xyz: [0, 0, 80]")
    assert [code for code, _ in told(apart)] == ["GS444"] and apart.target is None
    failed = outcome([*GOOD, "G1 X30 Y"], SLOTTED)
    assert [code for code, _ in told(failed)] == ["GS444"]


def test_checks_of_the_cell_decide_how_much_it_counts(outcome):
    results = outcome(["G0 X-5 Y15 Z2", "G1 Z-1.5 F300", "X45 F600"], SLOTTED, more="checks: {GS442: error}\n")
    assert results.status == "findings"
    assert [finding.level.word for finding in results.findings if finding.code == "GS442"] == ["error"]


def results_of_cell(folder, cell, program, mesh):
    mesh.export(folder / "part.stl")
    (folder / "cell.yaml").write_text(cell)
    job = prepare(SourceText("part.ngc", program.encode()), load_cell(folder / "cell.yaml"), Options())
    return run(job, None)[0]


def test_a_turned_part_has_its_gouge_on_the_line_that_cut_it(tmp_path):
    profile = np.array([(0, -30), (10, -30), (10, -20), (8, -20), (8, 0), (0, 0)], dtype=float)
    cell = (
        "gcodesim: 1\nmachine: lathe_xz\nstock: {cylinder: [20, 60], xyz: [0, 0, -60]}\n"
        "tools:\n  1: {type: turning_tool}\ntarget: {mesh: part.stl, unit: mm, tolerance: 0.02}\n"
        "simulation: {world: kinematic, rate: 100 Hz}\n"
    )
    lines = ["G21 G18 G7 G90 G40 G49", "T1 M6 G43", "G97 S1000 M3", "G95 F0.2", "G0 X16 Z2"]
    lines += ["G1 Z-8", "X15.6 Z-9", "Z-11", "X16 Z-12", "Z-20", "X20.5", "G0 X30", "M5", "M2"]
    results = results_of_cell(tmp_path, cell, "\n".join(lines) + "\n", trimesh.creation.revolve(profile, sections=360))
    assert told(results) == [("GS441", 7)]
    (region,) = results.as_json()["target"]["regions"]
    assert region["depth_mm"] == pytest.approx(0.2, abs=0.002)
    cones = 2 * np.pi / 3 * (3 * 64 - (64 + 8 * 7.8 + 7.8**2))
    assert region["volume_mm3"] == pytest.approx(2 * np.pi * (64 - 7.8**2) + cones, rel=0.02)
    assert {line["line"] for line in region["lines"] if line["share"] > 0.05} == {7, 8, 9}


def test_a_printed_part_that_ends_early_lacks_its_end(tmp_path):
    plate = extruded([(-5, -1), (5, -1), (5, 0), (-5, 0)], [(0, 1, 2, 3)])
    outline = [(-5, -1), (5, -1), (5, 0), (0.5, 0), (0.5, 0.4), (-0.5, 0.4), (-0.5, 0), (-5, 0)]
    wall = extruded(outline, [(0, 1, 2, 7), (6, 3, 4, 5)])
    assert wall.volume > plate.volume
    cell = (
        "gcodesim: 1\nmachine: gantry_xyz\nwork_offsets: {G54: {xyz: [500, 400, -150]}}\n"
        "stock: {min: [0, -5, -1], max: [40, 5, 0], resolution: 0.1}\n"
        "tools:\n  1: {type: extruder, bead_width: 1, bead_height: 0.4, length: 40}\n"
        "m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}\n"
        "target: {mesh: part.stl, unit: mm, tolerance: 0.3}\nsimulation: {world: kinematic, rate: 100 Hz}\n"
    )
    lines = ["G21 G90 G94", "T1 M6", "G43 H1", "G0 X0 Y0 Z0.4", "M10", "G1 X30 F600", "M11", "M2"]
    results = results_of_cell(tmp_path, cell, "\n".join(lines) + "\n", wall)
    assert [code for code, _ in told(results)] == ["GS441"]
    (region,) = results.as_json()["target"]["regions"]
    assert region["volume_mm3"] == pytest.approx(10 * 1 * 0.4, rel=0.1)
    assert region["low_mm"][0] == pytest.approx(30, abs=0.3)


@pytest.mark.parametrize("left", some_slow([0.0, 0.05], 0.0))
def test_ridges_of_a_ball_are_as_high_as_their_formula(outcome, left):
    """R - sqrt(R^2 - (s/2)^2), also above a face that was not finished; passes know a ball by chords."""
    radius, step = 4.0, 1.5
    rows = [f"G0 X-5 Y{y:g} Z2\nG1 Z{left - 1:g} F2000\nX45" for y in np.arange(-3.0, 33.1, step)]
    ball = f"{{type: ball_end_mill, diameter: {2 * radius}, length: 40}}"
    results = outcome(rows, block(top=-1), stock=BLOCK.replace("0.5", "0.2"), tool=ball)
    (ridges,) = results.as_json()["target"]["scallops"]
    height = radius - math.sqrt(radius**2 - (step / 2) ** 2)

    assert ridges["tool"] == 1 and ridges["area_mm2"] > 0.8 * 40 * 30
    assert 0.95 * height < ridges["typical_mm"] <= ridges["most_mm"] < 1.02 * height


def test_ridges_and_volumes_are_told_of_each_operation(outcome):
    """The same ball, coarse and fine: half of the plate with rows 1.2 mm apart, half with 0.8 mm."""
    radius, rows = 3.0, []
    for name, steps in (("Rough", np.arange(-3.0, 15.1, 1.2)), ("Operation: Fine", np.arange(15.0, 33.1, 0.8))):
        rows += [f"({name})", *(f"G0 X-5 Y{y:g} Z2\nG1 Z-1 F2000\nX45" for y in steps)]
    ball = f"{{type: ball_end_mill, diameter: {2 * radius}, length: 40}}"
    found = outcome(rows, block(top=-1), stock=BLOCK.replace("0.5", "0.2"), tool=ball).as_json()

    coarse, fine = found["target"]["scallops"]
    assert [each["operation"] for each in (coarse, fine)] == ["Rough", "Fine"]
    for ridges, step in ((coarse, 1.2), (fine, 0.8)):
        height = radius - math.sqrt(radius**2 - (step / 2) ** 2)
        assert 0.85 * height < ridges["typical_mm"] < 1.03 * height
    volumes = [each["removed_mm3"] for each in found["operations"]]
    assert volumes[0] > 1.2 * volumes[1] > 0
    assert sum(volumes) == pytest.approx(found["tools"][0]["removed_mm3"], rel=1e-6)


def test_a_flat_mill_leaves_no_ridges(outcome):
    assert outcome(GOOD, SLOTTED).as_json()["target"]["scallops"] == []


@pytest.mark.parametrize("middle", [13, 18, 23])
def test_a_line_that_is_too_high_is_to_blame_and_not_those_beside_it(outcome, middle):
    """Its neighbours made walls of what it left, and the one before it was there first."""
    rows = [
        line
        for number, y in ((8, 3.74), (13, 9.24), (18, 14.74), (23, 20.24), (28, 25.74), (33, 29.0))
        for line in ("G0 X-5", f"Y{y}", f"G1 Z{-1.3 if number == middle else -2} F300", "X45 F600", "G0 Z2")
    ]
    floor = extruded([(0, -10), (30, -10), (30, -2), (0, -2)], [(0, 1, 2, 3)])
    results = outcome(rows, floor, tool="{type: flat_end_mill, diameter: 8, length: 40}")

    assert told(results) == [("GS442", middle)]
    (region,) = results.as_json()["target"]["regions"]
    assert region["depth_mm"] == pytest.approx(0.7, abs=0.01)


def test_a_second_line_that_gouges_the_same_place_is_told(outcome):
    """Once the first is mended it would be the next; lines that only lead away from there are none."""
    deep = [
        "G0 X-5 Y15 Z2",
        "G1 Z-2.8 F300",
        "X45 F600",
        "G0 Z2",
        "X-5",
        "G1 Z-2 F300",
        "X45 F600",
        "G0 Z2",
        "X20",
    ]  # of 40 mm
    results = outcome([*deep, "G1 Z-2.6 F300", "G0 Z2", "X-5", "G1 Z-2.8 F300", "X45 F600"], SLOTTED)
    assert told(results) == [("GS441", 7)]
    (region,) = results.as_json()["target"]["regions"]
    assert [line["line"] for line in region["others"]] == [14, 18]
    (finding,) = (f for f in results.findings if f.code == "GS441")
    assert finding.message.endswith("by T1; lines 14, 18 go there as well")

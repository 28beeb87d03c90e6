"""Scenarios of first users, in the words that they see."""

from __future__ import annotations

import re
import time
from pathlib import Path

import pytest

BROKEN_CELLS = Path(__file__).parents[1] / "data" / "cells" / "broken"


def test_first_five_minutes(cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A 6 mm slot, 2 mm deep, 50 mm long: 2 (6 * 50 + pi 3^2) = 656.5 mm³; 7 mm at F200 and 50 mm at F600: 7.1 s."""
    assert cli("init", "demo").status == 0
    monkeypatch.chdir(tmp_path / "demo")
    done = cli("run", "part.nc", "--cell", "cell.yaml", "--world", "kinematic")

    assert done.status == 0
    assert "part.nc: no errors, no warnings" in done.out
    removed, bound = re.search(r"removed +([\d.]+) mm³ +± ([\d.]+) mm³", done.out).groups()
    assert abs(float(removed) - 656.5) <= min(float(bound), 3.3)
    assert re.search(r"feed distance +57\.0 mm", done.out)
    assert re.search(r"feed +7\.[01] s", done.out)
    assert "files in out:" in done.out and "look at it:" in done.out
    assert cli("init", ".").status == 2  # nothing is overwritten


WRONG = """G21 G90 G17
T1 M6
G0 X0 Y0
F300
G2 X10 Y0 I4
G0 Z5
G0 X20 Y10
G1 X30 Y
G1 X40
G0 Z10
G33.0 Z3
M5
M2
"""


def test_wrong_program(cli, write) -> None:
    write("bad.nc", WRONG)
    done = cli("check", "bad.nc", "--cell", "cell.yaml")

    assert done.status == 1 and "Traceback" not in done.err
    heads = re.findall(r"^bad\.nc:(\d+):(\d+): error (GS\d+): (.*)$", done.out, re.MULTILINE)
    assert [(line, column) for line, column, _, _ in heads] == [("5", "1"), ("8", "8"), ("11", "1")]
    for number in ("4.000 mm", "6.000 mm", "2.000 mm"):
        assert number in heads[0][3]
    assert "  8 | G1 X30 Y\n    |        ^\n" in done.out
    assert "G0 Z3" in done.out  # what the post meant
    for _, _, code, _ in heads:
        assert cli("explain", code).status == 0


def test_wrong_cell(cli, write) -> None:
    write(
        "cell.yaml",
        "gcodesim: 1\nmachine: gantry_xyz\ntols:\n  1: {type: flat_end_mill, diameter: 10 deg}\n"
        "fixtures:\n  vise: {mesh: vise.stl, unit: mm}\n",
    )
    done = cli("cell", "validate", "cell.yaml")

    assert done.status == 1
    heads = re.findall(r"^cell\.yaml:(\d+):(\d+): error GS\d+: (.*)$", done.out, re.MULTILINE)
    assert [(line, column) for line, column, _ in heads] == [("3", "1"), ("4", "38"), ("6", "16")]
    assert "did you mean `tools`" in done.out and "a length" in heads[1][2] and "vise.stl" in heads[2][2]
    assert cli("cell", "validate", "absent.yaml").status == 2


def test_a_resolution_that_no_memory_holds(cli, write, tmp_path: Path) -> None:
    text = (tmp_path / "cell.yaml").read_text().replace("100, 60, 20", "400, 300, 50")
    write("fine.yaml", text.replace("resolution: 1", "resolution: 0.005"))
    begin = time.perf_counter()
    done = cli("run", "slot.nc", "--cell", "fine.yaml")

    assert time.perf_counter() - begin < 2.0
    assert done.status == 1
    assert re.search(r"fine\.yaml:3:\d+: error GS411: .* needs .*\(\d{10,} bytes\)", done.out)
    assert re.search(r"the finest resolution that fits is 0\.0\d+ mm", done.out)


def test_nothing_is_cut_and_nothing_is_invented(cli, write, tmp_path: Path) -> None:
    import trimesh

    write("air.nc", "G21 G90\nT1 M6\nG0 Z50\nM2\n")
    done = cli("run", "air.nc", "--cell", "cell.yaml", "--format", "json")

    assert done.status == 0
    stock = done.json["stocks"]["stock"]
    assert stock["removed_mm3"] == 0 and stock["remaining_mm3"] == 120_000 == stock["initial_mm3"]
    box = trimesh.load_mesh(tmp_path / "out" / "stock.stl")
    assert box.volume == pytest.approx(120_000, rel=1e-9)
    assert box.is_watertight
    assert box.extents.tolist() == pytest.approx([100, 60, 20])


def test_a_tool_that_starts_inside_the_stock(cli, write) -> None:
    write(
        "inside.yaml",
        "gcodesim: 1\nmachine: {model: gantry_xyz, home: {X: 100, Y: 100, Z: -100}}\n"
        "work_offsets: {G54: {xyz: [100, 100, -90]}}\n"
        "stock: {min: [-20, -20, -20], max: [20, 20, 10], in: G54, material: al6082_t6, resolution: 1}\n"
        "tools: {1: {type: flat_end_mill, diameter: 6}}\nsimulation: {world: kinematic}\n",
    )
    write("air.nc", "G21 G90\nT1 M6\nG0 Z50\nM2\n")
    done = cli("run", "air.nc", "--cell", "inside.yaml", "--format", "json")

    assert done.status == 1
    assert {code for code, _, _ in done.errors} & {"GS402", "GS403"}
    assert done.json["stocks"]["stock"]["removed_mm3"] == 0


@pytest.mark.parametrize("path", sorted(BROKEN_CELLS.glob("*.yaml")), ids=lambda path: path.stem)
def test_broken_cells_through_the_command_line(cli, path: Path) -> None:
    expected = re.findall(rb"# expect: (GS\d{3}) (\d+):(\d+)", path.read_bytes())
    done = cli("cell", "validate", path, "--format", "json")

    assert done.status == 1
    places = [(code.decode(), int(line), int(column)) for code, line, column in expected]
    assert done.errors == sorted(places, key=lambda place: place[1:])
    assert all(f["file"] == path.name or f["code"].startswith("GS76") for f in done.json["findings"])

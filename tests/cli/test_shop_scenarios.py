"""A clamp in the way, a tool table, a part in two set-ups: from the command line, as a shop meets them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tests.cli.conftest import CELL

CLAMP = "fixtures: {clamp: {box: [10, 8, 30], zero: bottom-front-left, in: G54, xyz: [20, 24, 0]}}\n"
HEAD = "G21 G90 G17 G94\nT2 M6\nG43 H2\nS8000 M3\nG0 Z10\n"
ACROSS = HEAD + "G0 X0 Y0\nG0 X100 Y40\n"


def errors(outcome) -> list[tuple[str, int, str]]:
    return [(f["code"], f["line"], f["message"]) for f in outcome.json["findings"] if f["severity"] == "error"]


def test_a_clamp_beside_the_straight_line_is_hit_by_axes_that_go_on_their_own(cli, write) -> None:
    write("across.nc", ACROSS + "G0 Z50\nM5\nM2\n")
    write("linear.yaml", CELL + CLAMP)
    write("own.yaml", CELL.replace("gantry_xyz", "{model: gantry_xyz, rapids: independent}") + CLAMP)

    straight = cli("check", "across.nc", "--cell", "linear.yaml", "--format", "json")
    assert straight.status == 0 and errors(straight) == []
    bent = cli("check", "across.nc", "--cell", "own.yaml", "--format", "json")
    ((code, line, message),) = errors(bent)
    assert bent.status == 1 and (code, line) == ("GS301", 7)
    assert "T2 hits clamp" in message and "of G54" in message
    (found,) = [f for f in bent.json["findings"] if f["code"] == "GS301"]
    assert 0.5 < found["time_s"] < 3.0
    # both axes go at the same speed: the tip is on the diagonal where its side first meets the corner of the clamp
    place = float(message.split("X")[1].split()[0])
    assert abs(place - float(message.split(" Y")[1].split()[0])) < 0.1 and 15.0 < place < 20.0


def test_a_holder_in_the_stock_is_told_with_all_other_contacts(cli, write) -> None:
    tool = "diameter: 10 mm, flute_length: 12, length: 12, holder: {diameter: 40, length: 40}}"
    cell = CELL.replace("gantry_xyz", "{model: gantry_xyz, rapids: independent}").replace("diameter: 10 mm}", tool)
    write("own.yaml", cell + CLAMP)
    write("slot.nc", ACROSS + "G0 X60 Y10\nG1 Z-15 F300\nG1 X80\nG0 Z50\nM5\nM2\n")
    done = cli("run", "slot.nc", "--cell", "own.yaml", "--format", "json")

    found = errors(done)
    assert done.status == 1
    assert any(line == 9 and "holder of T2 runs into stock, 3.000 mm deep" in text for _, line, text in found)
    assert any(line == 7 and "of T2 hits clamp" in text for _, line, text in found)


FUSION = {
    "data": [
        {
            "type": kind, "unit": unit, "description": name, "post-process": {"number": number}, "geometry": geometry,
        }
        for number, (kind, unit, name, geometry) in enumerate(
            [
                ("flat end mill", "millimeters", "6 mm", {"DC": 6, "LCF": 20, "OAL": 60, "NOF": 3, "LB": 40}),
                ("chamfer mill", "inches", "90 deg",
                 {"DC": 0.5, "LCF": 0.25, "OAL": 2, "TA": 45, "NOF": 2, "tip-diameter": 0.02, "LB": 1.5}),
                ("probe", "millimeters", "touch", {"DC": 6, "OAL": 100, "LB": 60}),
                ("form mill", "millimeters", "ogee", {"DC": 20, "OAL": 60}),
            ],
            start=1,
        )
    ],
    "version": 2,
}  # fmt: skip


def test_a_library_of_tools_says_what_became_of_each(cli, write) -> None:
    write("shop.tools", json.dumps(FUSION))
    first = cli("import", "tools", "shop.tools", "--out", "tools.yaml")
    text = Path("tools.yaml").read_text()
    cli("import", "tools", "shop.tools", "--out", "again.yaml")

    assert "read 3, approximated 0, refused 1: T4 (ogee): gcodesim knows no `form mill`" in first.out + first.err
    assert "diameter: 0.5 in" in text and "length: 1.5 in" in text
    assert Path("again.yaml").read_bytes() == Path("tools.yaml").read_bytes()
    tools = text[text.index("tools:") :]
    write("cell.yaml", CELL[: CELL.index("tools:")] + tools + "simulation: {world: kinematic}\n")
    write("seven.nc", "G21 G90\nT7 M6\nM2\n")
    called = cli("check", "seven.nc", "--cell", "cell.yaml")
    assert called.status == 1
    assert "tool T7 is not in the tool table" in called.out and "known are T1, T2, T3" in called.out


def test_a_tool_table_of_linuxcnc_is_read_line_by_line(cli, write) -> None:
    write("tool.tbl", "T1 P1 Z50 D6 ;6 mm end mill\nT2 P2 Z40 D10 ;chamfer mill\nT3 P3 Z80 D6 ;probe\n")
    done = cli("import", "tools", "tool.tbl", "--out", "tools.yaml")

    said = done.out + done.err
    assert "refused 0" in said and all(f"T{number}" in said for number in (1, 2, 3))
    assert "probe" in Path("tools.yaml").read_text() and "chamfer_mill" in Path("tools.yaml").read_text()


def test_a_part_in_two_set_ups(cli, write) -> None:
    offset = "work_offsets: {G54: {xyz: [550, 370, -150]}}\n"
    drill = "  3: {type: drill, diameter: 6, length: 60}\n"
    first = CELL.replace("simulation:", drill + "simulation:").replace("lution: 1}", "lution: 0.5, in: G54}") + offset
    turned = "in: G54, xyz: [0, 60, -20], rpy: [180, 0, 0]"
    stock = next(line for line in first.splitlines() if line.startswith("stock:"))
    write("op1.yaml", first)
    write(
        "op2.yaml",
        first.replace(stock, f"stock: {{from: out1, {turned}}}")
        + f"target: {{mesh: part.stl, unit: mm, tolerance: 0.6, {turned}}}\n",
    )
    hole = "G21 G90 G17 G94\nT3 M6\nG43 H3\nS3000 M3\nG0 X50 Y{} Z5\nG1 Z-12 F250\nG0 Z20\nM5\nM2\n"
    write("op1.nc", hole.format(20))
    write("op2.nc", hole.format(40))
    plate = trimesh.creation.box((100, 60, 20), transform=trimesh.transformations.translation_matrix((50, 30, -10)))
    plate.export("part.stl")  # without the hole, which is then a deviation

    assert cli("run", "op1.nc", "--cell", "op1.yaml", "--out", "out1").status == 0
    done = cli("run", "op2.nc", "--cell", "op2.yaml", "--out", "out2")
    one, two = (json.loads(Path(f"out{n}/results.json").read_text()) for n in (1, 2))
    before, after = one["stocks"]["stock"], two["stocks"]["stock"]
    bounds = before["error_bound_mm3"] + after["error_bound_mm3"]
    assert after["initial_mm3"] == pytest.approx(before["remaining_mm3"], abs=bounds)
    target = two["target"]
    assert "deviation" in done.out and done.status == 1
    assert target["least_deviation_mm"] == pytest.approx(-10.0, abs=0.5) and abs(target["most_deviation_mm"]) < 0.1
    rim = 2 * 9 * np.pi / (2 * (100 * 60 + 100 * 20 + 60 * 20))  # the two round openings, of the whole surface
    assert target["share_outside"] == pytest.approx(rim, rel=0.15)
    assert cli("export", "out2", "--to", "stl", "-o", "end.stl").status == 0
    end = trimesh.load("end.stl")
    assert end.is_watertight and end.euler_number == 0  # a ring: the hole is through
    section = end.section(plane_origin=(50, 20, -10), plane_normal=(0, 0, 1))
    assert section is not None and len(section.entities) >= 2
    assert np.allclose(end.extents, (100, 60, 20), atol=1e-3)


def test_a_cell_from_a_project_of_camotics(cli, write) -> None:
    tool = {"units": "metric", "shape": "cylindrical", "length": 20, "diameter": 6}
    bounds = {"automatic": False, "bounds": {"min": [0, 0, -10], "max": [40, 20, 0]}}
    content = {"units": "metric", "resolution": 1, "tools": {"1": tool}, "workpiece": bounds, "files": ["slot.nc"]}
    write("part.camotics", json.dumps(content))
    done = cli("init", "made", "--from", "part.camotics")

    assert done.status == 0 and "then gcodesim run slot.nc --cell made/cell.yaml" in done.out
    assert cli("run", "slot.nc", "--cell", "made/cell.yaml", "--only", "shape").status == 0
    assert json.loads(Path("out/results.json").read_text())["stocks"]["stock"]["initial_mm3"] == 8000.0
    write("part.camotics", json.dumps({**content, "files": ["part.tpl"]}))
    refused = cli("init", "other", "--from", "part.camotics")
    assert refused.status == 2 and "tplang part.tpl" in refused.err and not Path("other").exists()

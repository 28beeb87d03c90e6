"""Tools from the files of others: each read, approximated or refused by name, and what is read is a sound cell."""

import json
import math
import zipfile

import numpy as np
import pytest

from gcodesim.cli.main import main
from gcodesim.starter.tool_files import ToolFileError, read_tools
from tests.unit.cell.text import sound

CHAMFER = {
    "type": "chamfer mill",
    "unit": "millimeters",
    "description": "chamfer 90",
    "geometry": {"DC": 12, "LCF": 6, "LB": 30, "NOF": 4, "TA": 45, "tip-diameter": 1},
    "post-process": {"number": 3},
    "holder": {
        "segments": [
            {"height": 20, "lower-diameter": 20, "upper-diameter": 30},
            {"height": 30, "lower-diameter": 40, "upper-diameter": 40},
        ]
    },
}
INCH = {"DC": 0.5, "RE": 0.03, "NOF": 3, "LCF": 1, "LB": 2}
LIBRARY = {
    "data": [
        CHAMFER,
        {"type": "form mill", "unit": "inches", "description": "ogee", "geometry": {}, "post-process": {"number": 4}},
        {"type": "bull nose end mill", "unit": "inches", "geometry": INCH, "post-process": {"number": 5}},
        {"type": "holder", "description": "alone"},
        {"type": "drill", "unit": "millimeters", "geometry": {"DC": 5, "SIG": 140}, "post-process": {"number": 6}},
    ]
}
VBIT = {
    "version": 2,
    "name": "60 Deg. V-Bit",
    "shape": "v-bit.fcstd",
    "parameter": {
        "CuttingEdgeAngle": "60.0000 °",
        "Diameter": "10.0000 mm",
        "FlatHeight": "1.0000 mm",
        "FlatRadius": "0.5000 mm",
        "Length": "20.0000 mm",
        "ShankDiameter": "5.0000 mm",
    },
    "attribute": {},
}
PROJECT = {
    "units": "metric",
    "tools": {
        "1": {"shape": "conical", "length": 5, "diameter": 10, "number": 1},
        "2": {"units": "imperial", "shape": "snubnose", "length": 0.5, "diameter": 0.5, "snub_diameter": 0.1},
        "3": {"shape": "spheroid", "length": 4, "diameter": 10},
    },
    "workpiece": {"automatic": False, "bounds": {"min": [0, 0, -10], "max": [50, 40, 0]}},
}


def tools_of(found, head="machine: gantry_xyz\n"):
    """The tools as a cell reads them."""
    lines = [
        f"  {tool.number}: {{{', '.join(f'{key}: {value}' for key, value in tool.keys.items())}}}\n"
        for tool in found.tools
        if tool.keys
    ]
    return sound(f"{head}{found.stock}tools:\n{''.join(lines)}").tools


def notes_of(found, number):
    return [note for tool in found.tools if tool.number == number for note in tool.notes]


def test_a_table_of_linuxcnc(tmp_path):
    file = tmp_path / "tool.tbl"
    file.write_text(
        "T0 P0 D0 ;empty\nT1 P1 Z50.8 D6.35 ;1/4 in flat end mill\nT2 D12 ;90 deg V bit\nT3 D3 ;6 mm ball end mill\n"
        "T4 D8\nT5 Zx\n"
    )
    found = read_tools(file)
    tools = tools_of(found)

    assert [tools[n].kind for n in (1, 2, 3, 4)] == ["flat_end_mill", "v_bit", "ball_end_mill", "flat_end_mill"]
    assert tools[1].length == pytest.approx(50.8e-3)
    assert tools[2].angle == pytest.approx(math.radians(90.0))
    assert "empty spindle" in notes_of(found, 0)[0]
    assert not found.tools[0].refused
    assert any("D is 3 mm, the comment says 6 mm" in note for note in notes_of(found, 3))
    assert any("a flat end mill is assumed" in note for note in notes_of(found, 4))
    assert any(tool.refused and "`Zx`" in tool.notes[0] for tool in found.tools)
    assert tools_of(read_tools(file, inch=True))[1].diameter == pytest.approx(6.35 * 25.4e-3)


@pytest.mark.parametrize("packed", [False, True])
def test_a_library_of_fusion(tmp_path, packed):
    file = tmp_path / ("library.tools" if packed else "library.json")
    if packed:
        with zipfile.ZipFile(file, "w") as archive:
            archive.writestr("tools.json", json.dumps(LIBRARY))
    else:
        file.write_text(json.dumps(LIBRARY))
    found = read_tools(file)
    tools = tools_of(found)

    assert [tool.number for tool in found.tools] == [3, 4, 5, 6]
    assert tools[3].kind == "chamfer_mill"
    assert (tools[3].angle, tools[3].tip_diameter) == pytest.approx((math.radians(90.0), 1e-3))
    assert np.array(tools[3].holder_frusta) == pytest.approx(
        np.array([[10e-3, 15e-3, 30e-3, 50e-3], [20e-3, 20e-3, 50e-3, 80e-3]])
    )
    assert notes_of(found, 3) == []
    assert notes_of(found, 4) == ["refused: gcodesim knows no `form mill`; `profile_mill` takes its outline"]
    assert (tools[5].diameter, tools[5].corner_radius) == pytest.approx((12.7e-3, 0.03 * 25.4e-3))
    assert tools[6].point_angle == pytest.approx(math.radians(140.0))


def test_a_holder_of_fusion_has_its_own_unit_and_ends_at_its_gauge_line(tmp_path):
    """In inches on a tool in mm: 1 in of cone, 1 in of collar up to the gauge line; the taper is in the spindle."""
    segments = [
        {"height": 1, "lower-diameter": 1, "upper-diameter": 1.5},
        {"height": 1.25, "lower-diameter": 2, "upper-diameter": 2},
        {"height": 2, "lower-diameter": 1.75, "upper-diameter": 1},
    ]
    holder = {"unit": "inches", "gaugeLength": 2, "segments": segments}
    file = tmp_path / "shop.json"
    file.write_text(json.dumps({"data": [{**CHAMFER, "holder": holder}]}))
    tool = tools_of(read_tools(file))[3]

    assert np.array(tool.holder_frusta) * 1e3 == pytest.approx(
        np.array([[12.7, 19.05, 30, 55.4], [25.4, 25.4, 55.4, 80.8]])
    )


def test_a_shaft_of_fusion(tmp_path):
    """A shoulder of 5.6 mm up to 14 mm, 4 mm of cone, and the shaft of 10 mm up to the holder at 30 mm."""
    geometry = {"DC": 6, "LCF": 9, "LB": 30, "NOF": 3, "SFDM": 10, "shoulder-length": 14, "shoulder-diameter": 5.6}
    necked = {
        "type": "flat end mill", "unit": "millimeters", "geometry": geometry, "post-process": {"number": 1},
        "shaft": {"type": "shaft", "segments": [{"height": 4, "lower-diameter": 5.6, "upper-diameter": 10}]},
    }  # fmt: skip
    plain = {**necked, "geometry": {**geometry, "SFDM": 6, "shoulder-length": 9}, "post-process": {"number": 2}}
    del plain["shaft"]
    file = tmp_path / "shop.json"
    file.write_text(json.dumps({"data": [necked, plain]}))
    tools = tools_of(read_tools(file))

    assert np.array(tools[1].shank_frusta) * 1e3 == pytest.approx(
        np.array([[2.8, 2.8, 9, 14], [2.8, 5, 14, 18], [5, 5, 18, 30]])
    )
    assert tools[2].shank is None


def test_tables_of_strangers(tmp_path):
    """Comments as they stand in tables that people share."""
    table = tmp_path / "tool.tbl"
    table.write_text(
        ";Tool  Pocket Z Offset Diameter Remark\n"
        "T1   P1  Z+0.0    D+1.0   ; 150 Series High-Speed Steel Jobber\n"
        "T14  P14 Z+69.67  D+50.0  ; Face Mill\n"
        "T21  P21 Z+61.14  D+0.0   ; unknown - 90deg 6mm engraver\n"
        "T99  P99 Z+129.25 D+3.175 ; touch probe\n"
    )
    found = read_tools(table)

    assert [tool.keys["type"] for tool in found.tools] == ["drill", "face_mill", "engraver", "probe"]
    assert [notes_of(found, number)[0].partition("speaks of ")[2] for number in (1, 14, 21, 99)] == [
        "a drill", "a face mill", "an engraver", "a probe",
    ]  # fmt: skip


def test_words_about_edges_in_a_table(tmp_path):
    """Coated mills are no spray guns, `90deg-v` is a V-bit, and edges that press down have a left-hand helix."""
    table = tmp_path / "tool.tbl"
    table.write_text(
        "T19 P0 Z58.6 ; 4mm Endmill - 3F - No Coating - Alu\nT34 P0 Z38.2 ; 6mm 90deg-v - altisin - alu\n"
        "T50 P0 Z50 ; 6mm downcut spiral - wood\nT215 P0 Z53.5 ; 6mm Compression - wood\n"
        "T7 P0 Z40 ; 6mm tapered endmill\nT1 P1 X78.695 Z37.63 ;\n"
    )
    found = read_tools(table)
    tools = tools_of(found)

    assert {number: tool.kind for number, tool in tools.items()} == {
        7: "flat_end_mill", 19: "flat_end_mill", 34: "v_bit", 50: "flat_end_mill", 215: "flat_end_mill",
    }  # fmt: skip
    assert tools[34].angle == pytest.approx(math.radians(90.0))
    assert (tools[50].helix, tools[215].helix) == (
        pytest.approx(math.radians(-30.0)),
        pytest.approx(math.radians(30.0)),
    )
    assert any("`up_cut` is not told" in note for note in notes_of(found, 215))
    assert any("a lathe's" in note for note in notes_of(found, 1))


def test_turning_tools_of_fusion(tmp_path):
    def entry(number, kind, geometry, holder, unit="millimeters"):
        post = {"number": number}
        return {"type": kind, "unit": unit, "geometry": geometry, "holder": holder, "post-process": post}

    rhomb = {"SC": "C", "RE": 0.03125, "INSD": 0.5, "EPSR": 0, "TC": "M", "OAL": 1.18}
    library = [
        entry(1, "turning general", rhomb, {"HAND": "R", "W": 0.75, "THSC": "L"}, "inches"),
        entry(2, "turning general", {"SC": "D", "RE": 0.4, "INSD": 9.525}, {"HAND": "L"}),
        entry(
            3, "turning boring", {"SC": "T", "RE": 0.4, "INSD": 9.525}, {"HAND": "R", "THSC": "boring bar f", "W": 16}
        ),
        entry(4, "turning grooving", {"SC": "groove square", "tool_insertWidth": 2.7, "CDX": 9}, {}),
        entry(5, "turning threading", {"thread-profile-angle": 55, "tool_internalThread": True}, {}),
        entry(6, "turning general", {"SC": "R", "INSD": 8}, {"HAND": "N"}),
        entry(7, "turning general", {"SC": "custom"}, {}),
        {"type": "tool block", "description": "20MM ID", "post-process": {"number": None}},
    ]
    file = tmp_path / "lathe.json"
    file.write_text(json.dumps({"data": library}))
    found = read_tools(file)
    tools = tools_of(found)

    assert [tool.number for tool in found.tools] == [1, 2, 3, 4, 5, 6, 7]
    first = tools[1]
    assert (first.kind, first.orientation, tools[2].orientation, tools[3].orientation) == ("turning_tool", 2, 1, 3)
    assert first.nose_radius == pytest.approx(0.79375e-3) and first.width == pytest.approx(19.05e-3)
    assert first.edge == pytest.approx(12.9e-3, abs=0.01e-3)  # as ISO 883 has it for 12.7 mm
    assert tools[3].kind == "boring_tool" and tools[3].edge == pytest.approx(16.5e-3, abs=0.01e-3)
    assert (tools[4].kind, tools[4].side) == ("grooving_tool", "outside")
    assert tools[4].width == pytest.approx(2.7e-3)
    assert (tools[5].side, tools[5].angle) == ("inside", pytest.approx(math.radians(55.0)))
    assert tools[6].round and tools[6].nose_radius == pytest.approx(4e-3)
    assert notes_of(found, 7) == ["refused: it does not say its tip_angle"]
    assert any("usual one" in note for note in notes_of(found, 1)) and any("CDX" in note for note in notes_of(found, 4))


def test_bits_and_libraries_of_freecad(tmp_path):
    (tmp_path / "Bit").mkdir()
    (tmp_path / "Library").mkdir()
    (tmp_path / "Bit" / "v.fctb").write_text(json.dumps(VBIT), encoding="utf-8")
    library = tmp_path / "Library" / "shop.fctl"
    library.write_text(json.dumps({"version": 1, "tools": [{"nr": 7, "path": "v.fctb"}, {"nr": 8, "path": "no.fctb"}]}))
    one, many = read_tools(tmp_path / "Bit" / "v.fctb"), read_tools(library)

    assert tools_of(one)[1].angle == pytest.approx(math.radians(60.0))
    assert tools_of(many)[7].tip_diameter == pytest.approx(1e-3)
    assert notes_of(many, 8) == ["refused: `no.fctb` is not beside the library"]


@pytest.mark.parametrize(
    ("text", "millimetres"),
    [("6.35 mm", 6.35), ("3,17 mm", 3.17), ("1 cm", 10.0), ('0.375 "', 9.525), ("1/4 in", 6.35),
     ("25,0 \u03bcm", 0.025), ("1,234.5 mm", 1234.5), ("1.234,5 mm", 1234.5), ("8", 8.0)],
)  # fmt: skip
def test_lengths_as_freecad_shows_them(tmp_path, text, millimetres):
    """Settings of another language show 3,17 mm: once that was a tool of 3 mm."""
    bit = {"version": 2, "name": "x", "shape": "endmill.fcstd", "parameter": {"Diameter": text}}
    (tmp_path / "x.fctb").write_text(json.dumps(bit), encoding="utf-8")

    assert tools_of(read_tools(tmp_path / "x.fctb"))[1].diameter == pytest.approx(millimetres * 1e-3)


def test_an_insert_of_freecad(tmp_path):
    sizes = {"EdgeLength": "6.35 mm", "Rotation": "45.00 \u00b0", "TipAngle": "80.00 \u00b0", "TipRadius": "0.40 mm"}
    bit = {"version": 2, "name": "CCMT070204R", "shape": "Iso_shape_C.fcstd", "parameter": sizes}
    (tmp_path / "c.fctb").write_text(json.dumps(bit), encoding="utf-8")
    tool = tools_of(read_tools(tmp_path / "c.fctb"))[1]

    assert (tool.kind, tool.nose_radius, tool.edge) == ("turning_tool", pytest.approx(0.4e-3), pytest.approx(6.35e-3))
    assert tool.tip_angle == pytest.approx(math.radians(80.0))


def test_edges_that_lie_in_front_of_the_nose_are_left_out(tmp_path):
    """As in a configuration that comes with LinuxCNC."""
    file = tmp_path / "tool.tbl"
    file.write_text("T3 P3 D0.1 I+5 J+85 Q3 ;\n")
    found = read_tools(file, inch=True)

    assert tools_of(found)[3].problems() == []
    assert notes_of(found, 3)[0].startswith("differs: its edges (I, J) do not lie behind a nose of Q3")


def test_tips_of_a_lathe_in_a_table_of_linuxcnc(tmp_path):
    """Each orientation with the edges that LinuxCNC's own example of a lathe has: the tool leads its edges that way."""
    corners = {1: (95, 155), 2: (85, 25), 3: (275, 335), 4: (265, 205)}
    edges = {**corners, 5: (210, 150), 6: (120, 60), 7: (-30, 30), 8: (240, 300)}
    lines = [f"T{q} P{q} D0.8 I{i:+f} J{j:+f} Q{q} ;" for q, (i, j) in edges.items()]
    file = tmp_path / "tool.tbl"
    file.write_text("\n".join([*lines, "T10 Q2 ; SDJCR1212H07", "T11 D3 Q7 ; 3 mm drill", ""]))
    found = read_tools(file)
    tools = tools_of(found)

    for q, both in edges.items():
        tool = tools[q]
        assert (tool.kind, tool.orientation, tool.nose_radius) == ("turning_tool", q, pytest.approx(0.4e-3))
        own = sorted(math.degrees(edge) % 360.0 for edge in tool.edges)
        assert own == pytest.approx(sorted(edge % 360.0 for edge in both)), q
    assert tools[10].kind == "turning_tool" and "slim tip" in notes_of(found, 10)[0]
    assert tools[11].kind == "drill"


def test_prose_above_a_table_is_no_tool(tmp_path):
    """As interfaces of LinuxCNC write it: lines without a T word, which the control skips."""
    file = tmp_path / "tool.tbl"
    file.write_text("LinuxCNC Tool Table\n-----\n\n(kept)\n---\nGenerated by: x (v0.1)\nT1 P1 D6 ;end mill\n")
    found = read_tools(file)

    assert [tool.refused for tool in found.tools] == [False, False]
    assert found.tools[1].name == "lines 1, 2, 4, 5, 6" and "no T word" in found.tools[1].notes[0]


def test_a_project_of_camotics(tmp_path):
    file = tmp_path / "part.camotics"
    file.write_text(json.dumps(PROJECT))
    found = read_tools(file)
    tools = tools_of(found)

    assert tools[1].angle == pytest.approx(math.radians(90.0))
    assert tools[2].tip_height == pytest.approx(0.5 * 25.4e-3, rel=1e-5)
    assert notes_of(found, 3) == ["refused: gcodesim knows no tool of the shape `spheroid`"]
    assert found.stock == "stock: {min: [0, 0, -10 mm], max: [50, 40, 0 mm], in: G54}\n"


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.json", b"{"),
        ("a.json", b"[]"),
        ("a.json", b"{}"),
        ("a.tools", b"PK\x03\x04rubbish"),
        ("a.json", b"\xff\xfe"),
    ],
)
def test_what_is_no_tool_file_is_told(tmp_path, name, content):
    file = tmp_path / name
    file.write_bytes(content)
    with pytest.raises(ToolFileError):
        read_tools(file)
    assert main(["import", "tools", str(file)]) == 2


def test_the_command_prints_keys_and_tells_what_is_refused(tmp_path, capsys):
    file = tmp_path / "library.json"
    file.write_text(json.dumps(LIBRARY))
    assert main(["import", "tools", str(file)]) == 1
    out, told = capsys.readouterr()
    assert "  6: {type: drill, " in out
    assert "T4 (ogee): refused: gcodesim knows no `form mill`" in told
    assert "read 3, approximated 0, refused 1: T4 (ogee): gcodesim knows no `form mill`" in told


def test_the_command_writes_the_same_file_again(tmp_path, capsys):
    """Scenario 10: an import into a file, twice, with lengths in inches, and a table of LinuxCNC with odd tools."""
    library, table = tmp_path / "library.json", tmp_path / "tool.tbl"
    library.write_text(json.dumps(LIBRARY))
    table.write_text(
        "T1 P1 Z+50.5 D6 ;6 mm end mill\nT2 P2 Z+40 D10 ;90 deg chamfer mill\n"
        "T3 P3 Z+60 D3 ;touch probe\nT4 P4 Z+60 D12 ;form tool ogee\n"
    )
    for name in ("one.yaml", "two.yaml"):
        assert main(["import", "tools", str(library), "--out", str(tmp_path / name)]) == 1
    assert (tmp_path / "one.yaml").read_bytes() == (tmp_path / "two.yaml").read_bytes()
    assert "tools:\n" in (tmp_path / "one.yaml").read_text()
    out = capsys.readouterr().out
    assert "read 3, approximated 0, refused 1" in out and "tools:" not in out

    assert main(["import", "tools", str(table)]) == 1
    out, told = capsys.readouterr()
    assert "  3: {type: probe, " in out and "  4:" not in out
    assert "read 0, approximated 3, refused 1: T4 (form tool ogee): a table has no sizes of a form tool" in told

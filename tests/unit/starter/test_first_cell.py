"""What `init` writes."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import place, read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.starter.example import CELL, PROGRAM, start_files
from gcodesim.starter.first_cell import cell_for
from gcodesim.starter.scan import scan
from gcodesim.tools.flat_end_mill import FlatEndMill

PROGRAMS = sorted(p for p in (Path(__file__).parents[3] / "programs").glob("*.n*c") if p.stem != "pin")  # for a lathe


def codes_of(cell: bytes) -> list[str]:
    return [finding.code for finding in read_cell(SourceText(CELL, cell), Path(CELL)).findings]


def test_the_first_cell_is_the_one_of_the_first_five_minutes() -> None:
    files = start_files()
    loaded = read_cell(SourceText(CELL, files[CELL]), Path(CELL))

    assert len(loaded.findings) == 0 and loaded.cell is not None
    tool = loaded.cell.tools[1]
    assert isinstance(tool, FlatEndMill) and tool.diameter == pytest.approx(6e-3)
    np.testing.assert_allclose(place(loaded.cell).work_offsets[1].p, [0.55, 0.37, -0.15])
    material = loaded.cell.material(loaded.cell.stocks["stock"])
    assert material is not None and material.id == "al6082_t6"
    assert b"G1 Z-2 F200" in files[PROGRAM] and b"G1 X70 F600" in files[PROGRAM]


def test_both_files_explain_themselves() -> None:
    for text in start_files().values():
        assert text.endswith(b"\n") and b"\r" not in text and text.isascii()
    assert start_files()[CELL].count(b"#") > 10


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_a_cell_for_each_program_is_whole(path: Path) -> None:
    assert codes_of(cell_for(SourceText.read(path))) == []


def test_comments_of_posts_become_tools() -> None:
    program = SourceText(
        "x.nc",
        b"%\n(T1 D=6. CR=0. - ZMIN=-2. - flat end mill)\n(T2  D=0.25 CR=0.03 - ZMIN=-1 - bullnose end mill)\n"
        b"(T3 D=5. TAPER=118deg - drill)\n(TOOL 4: ball 8 mm)\n(T9 not used)\n(Stock: 100 x 60 x 20)\n"
        b"T1 M6\nG0 X0 Y0\nT2 M6\nN10 T03 M6 ;T8\nT4M6\nT7 M6\nM30\n%",
    )

    found = scan(program)

    assert [tool.number for tool in found.tools] == [1, 2, 3, 4, 7]
    assert [tool.type for tool in found.tools] == [
        "flat_end_mill",
        "bull_nose_end_mill",
        "drill",
        "ball_end_mill",
        "flat_end_mill",
    ]
    assert [tool.diameter for tool in found.tools] == [6.0, 0.25, 5.0, 8.0, None]
    assert found.tools[1].corner_radius == 0.03 and found.tools[2].point_angle == 118.0
    assert found.stock == (100.0, 60.0, 20.0) and found.stock_line == 7
    cell = cell_for(program)
    assert codes_of(cell) == [] and cell.count(b"ITS DIAMETER IS A GUESS") == 1  # T7


def test_an_inch_program_gives_an_inch_cell() -> None:
    cell = cell_for(
        SourceText("x.nc", b"G20\n(T1 D=0.5 - flat)\nT1 M6\nG0 X-1 Y-1 Z1\nG1 Z-.25 F10\nX3 Y2\nG28 Z9\nM2")
    )
    loaded = read_cell(SourceText(CELL, cell), Path(CELL))

    assert loaded.cell is not None
    assert loaded.cell.tools[1].diameter == pytest.approx(0.5 * 0.0254)
    shape = loaded.cell.stocks["stock"].shape
    # a floor is left below the deepest cut
    assert shape.lower == pytest.approx([-0.0254, -0.0254, -0.25 * 0.0254 - 0.001], abs=1e-6)
    assert shape.upper == pytest.approx([3 * 0.0254, 2 * 0.0254, 0.0])


def test_a_program_without_anything_gives_a_cell_that_loads() -> None:
    assert codes_of(cell_for(SourceText("x.nc", b"M2\n"))) == []
    assert codes_of(cell_for(SourceText("x.nc", b""))) == []
    assert codes_of(cell_for(SourceText("x.nc", b"\xff\x00(T)(T0)(T1 \x07\x85 D=)\nT1 M6"))) == []


@pytest.mark.parametrize(
    ("comment", "kind", "angle"),
    [
        ("T1 90 deg V bit D12", "v_bit", 90.0),
        ("T1 D=6. CR=0. TAPER=45deg - ZMIN=-1. - chamfer mill", "chamfer_mill", 90.0),
        ("T1 30 degree engraver D6", "engraver", 30.0),
        ("T1 V-bit 12 mm", "chamfer_mill", None),
        ("T1 6 mm end mill D6", "flat_end_mill", None),
    ],
)
def test_a_cone_is_no_end_mill(comment, kind, angle):
    (tool,) = scan(SourceText("a.nc", f"({comment})\nT1 M6\nG1 X1 F100\nM2\n".encode())).tools
    assert (tool.type, tool.angle) == (kind, angle)


def test_nothing_is_said_of_what_follows_an_error() -> None:
    """A tool change and a start of the spindle may stand there; to lower GS501 for good would hide a fault."""
    program = b"%\nO1000 (BRACKET (REV 2))\n(T1 12MM ENDMILL)\nT1 M6\nS3000 M3\nG0 X0\nG1 Z-1 F100\nM30\n%\n"
    text = cell_for(SourceText("part.nc", program)).decode()
    assert "nothing behind that line is known" in text
    assert "GS501" not in text and "loaded_tool" not in text


def test_a_program_whose_cut_has_no_width_has_no_stock() -> None:
    square = "G1 X1000\nG1 Y1000\nG1 X0\nG1 Y0\nG91 G1 Z10\nG90 "
    cell = cell_for(SourceText("square.nc", f"G21 G90\nM3 S1000\nG0 X0 Y0 Z0\nF10000 {square * 4}\n".encode()))

    assert codes_of(cell) == [] and b"\nstock:" not in cell


@pytest.mark.parametrize("word", ["G2", "G3"])
def test_travel_holds_arcs_where_they_reach_farthest(word: str) -> None:
    """The zero is the program's own, so that travel is no wider than what it asks for: 99.65 mm and the radius."""
    turned = math.radians(7.0)  # so that none of the points in place of the arc is an extreme
    x, y = 20.4 * math.cos(turned), 20.4 * math.sin(turned)
    program = f"G21 G90 G10 L2 P1 X-99.65 Y0 Z0\nG0 X{x} Y{y} Z1\n{word} X{x} Y{y} I{-x} J{-y} F600\nM2\n"
    text = cell_for(SourceText("round.nc", program.encode())).decode()

    assert codes_of(text.encode()) == []
    assert float(text.split("X: {travel: [")[1].split(",")[0]) <= -99.65 - 20.4


def test_two_tools_that_share_an_offset_have_it_once() -> None:
    """A key that stands twice makes a cell that cannot be read (GS702)."""
    text = "%\nO1\nG21 G90 G54\nT3 M6\nG0 X0 Y0 S900 M3\nG43 H19 Z5\nG1 Z-2 F100\nX30\nG0 Z5\n"
    text += "T5 M6\nG43 H19 Z5\nG1 Z-3 F100\nX0\nG0 Z5\nM30\n%\n"
    cell = cell_for(SourceText("p.nc", text.encode()))

    assert cell.decode().count("  19: {") == 1
    assert "GS702" not in codes_of(cell)


@pytest.mark.parametrize(
    ("notes", "size"),
    [
        ("(STOCK DX=100. DY=60. DZ=20.)", (100, 60, 20)),
        ("(STOCK: DX: 100mm DY: 60mm DZ: 20mm)", (100, 60, 20)),
        ("(STOCK DX 100)\n(STOCK DY 60)\n(STOCK DZ 20)", (100, 60, 20)),
        ("(STOCK TO LEAVE DX 0.1)", None),
        ("(PART DX=90. DY=50. DZ=18.)", None),
    ],
)
def test_sides_of_the_stock_by_their_letters(notes: str, size: tuple[float, ...] | None) -> None:
    assert scan(SourceText("x.nc", f"{notes}\nT1 M6\nM30\n".encode())).stock == size


def test_a_block_of_carbide_create_says_where_zero_is_in_it() -> None:
    program = SourceText("x.nc", b"(STOCK/BLOCK,100.00, 60.00, 20.00,50.00, 30.00, 20.00)\nG21\nM6T102\nM30\n")

    assert scan(program).corners == ((-50.0, -30.0, -20.0), (50.0, 30.0, 0.0))


def test_lengths_that_h0_takes_away_are_those_of_touched_off_tools() -> None:
    """As old posts for Fanuc write them; with the nose of the spindle at Z-3 it stood in the stock."""
    program = b"%\nO0001\nG0G17G40G49G80G90\nT1M6\nG0G54X0Y0S3000M3\nG43H0Z50.\nG1Z-3.F100\nX60.\nG0Z50.\nM30\n%\n"
    h1 = program.replace(b"H0", b"H1")

    assert b"loaded_tool: 1 " in cell_for(SourceText("x.nc", program))
    assert b"loaded_tool" not in cell_for(SourceText("x.nc", h1))


@pytest.mark.parametrize(
    ("note", "diameter"),
    [("CHAMFER MILL 90 DEG", None), ("SPOT DRILL 120\N{DEGREE SIGN}", None), ("END MILL 6", 6.0), ("DRILL 5.5", 5.5)],
)
def test_an_angle_is_no_diameter(note: str, diameter: float | None) -> None:
    (tool,) = scan(SourceText("x.nc", f"G21\nT2 M6 ({note})\nM30\n".encode())).tools

    assert tool.diameter == diameter

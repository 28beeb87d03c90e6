"""What a program tells a first cell about itself; programs are written here, by the habits of the controls."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import read_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.simulation import check, prepare, run
from gcodesim.starter.example import CELL
from gcodesim.starter.first_cell import NoCellError, cell_for
from gcodesim.starter.scan import scan
from gcodesim.starter.survey import survey

HAND = "G21 G90\nM3 S12000\nG0 X10 Y10 Z5\nG1 Z-2 F200\nG1 X40 F800\nG1 Y30\nG0 Z5\nM5\n"
FANUC = (
    "%\nO0012 (PLATE)\n(T3 D=8. CR=0. - ZMIN=-3. - FLAT END MILL)\n(T4 D=5. CR=0. TAPER=118DEG - DRILL)\n"
    "G90 G94 G17 G49 G40 G80\nG21\nG28 G91 Z0.\nG90\nT3 M06\nS4000 M03\nG54\nG00 X-12. Y5.\nG43 Z15. H03\n"
    "G01 Z-3. F300.\nX52. F600.\nG00 Z15.\nM05\nG28 G91 Z0.\nG90\nG49\nT4 M06\nS3000 M03\nG54\nG00 X20. Y15.\n"
    "G43 Z15. H04\nG98 G83 X20. Y15. Z-9. R2. Q3. F150.\nX30.\nG80\nM05\nG28 G91 Z0.\nM30\n%\n"
)
FABTOTUM = (
    "; milled on a FABtotum\nG21\nG90\nM3 S10000\nG4 S3\nG0 Z5 F1000\nG0 X10 Y10\nG1 Z-1 F200\nG1 X40 F600\nG0 Z5\n"
    "M5\nM732 S0\n"
)


def source(text: str) -> SourceText:
    return SourceText("p.nc", text.encode())


def verdict(text: str, tmp_path: Path) -> tuple[str, set[str], dict[str, float]]:
    """Status, codes of what is worse than a note, volumes removed [mm³]: of a run in the cell that `init` writes."""
    loaded = read_cell(SourceText(CELL, cell_for(source(text))), tmp_path / CELL)
    assert not [f for f in loaded.findings if f.level > Severity.NOTE]
    results, execution = run(prepare(source(text), loaded))
    assert execution is not None
    worse = {f.code for f in results.findings if f.level > Severity.NOTE}
    return results.status, worse, {name: stock.removed * 1e9 for name, stock in results.stocks.items()}


@pytest.mark.parametrize(
    ("text", "dialect"),
    [
        (HAND, "grbl"),
        (FANUC, "fanuc"),
        (FANUC.replace("%\nO0012", "%\nG90\nO0012"), "fanuc"),
        (FABTOTUM, "marlin"),
        (FABTOTUM.replace("G4 S3\n", "").replace("; milled on a FABtotum\n", "; post for Marlin\n"), "marlin"),
        ("#1=3\nWHILE[#1GT0]DO1\n#1=#1-1\nEND1\nG0 X1\nM30\n", "fanuc"),
        ("G21 G90\no100 while [#1 lt 3]\n#1=[#1+1]\nG1 X#1 F100\no100 endwhile\nM2\n", "linuxcnc"),
        ("(post for grbl)\nG21\nG1 X1 Y1 F100\nM30\n", "grbl"),
        ("G21\nT1 M6\nG43 H1\nG0 Z5\nG1 X1 F100\nM2\n", "linuxcnc"),
        # a feed that is missing in every line is one fault, and Fanuc does not know named parameters and O-words
        ("G21\nT1 M6\n#<a>=1\no1 if [#<a>]\no1 endif\n" + "G1 X1\nG1 X2\n" * 50 + "M2\n", "linuxcnc"),
        # a bracket too many is a slip in a comment, not a word that the control of a laser does not know
        ("(S1000 (--- laser on))\nG21 G90\nM3 S1000\nG1 X5 Y5 F500\nG3 I2 J0 K0 X9 Y5\nM5\n", "grbl"),
        ("(Grbl)\nG21\nT1 M6\nG43 H1\nG0 Z5\nG1 X1 F100\nM2\n", "linuxcnc"),  # whatever it says of itself
    ],
)
def test_the_dialect_that_understands_it(text: str, dialect: str) -> None:
    assert survey(source(text)).dialect == dialect


def test_a_program_for_a_router_by_hand_cuts_at_once(tmp_path: Path) -> None:
    status, worse, removed = verdict(HAND, tmp_path)

    assert (status, worse) == ("ok", set())
    # two slots whose middle is the edge of the stock: half of the tool's width, and no more than all of it
    assert 0.4 * 50 * 6 * 2 < removed["stock"] < 50 * 6 * 2 + 60


def test_two_tools_of_a_control_with_a_changer(tmp_path: Path) -> None:
    status, worse, removed = verdict(FANUC, tmp_path)

    assert (status, worse) == ("ok", set())
    assert removed["stock"] > 2 * np.pi / 4 * 25 * 7
    cell = cell_for(source(FANUC)).decode()
    assert "3: {type: flat_end_mill, diameter: 8 mm}" in cell and "4: {type: drill, diameter: 5 mm" in cell


def test_each_work_system_has_its_place_and_stock(tmp_path: Path) -> None:
    part = "G0 X0 Y0\nG0 Z5\nG1 Z-2 F200\nX30 F600\nY20\nG0 Z120\n"
    text = f"G21 G90\nT1 M6 (END MILL D6)\nS9000 M3\nG54\n{part}G55\n{part}M5\nM2\n"
    status, worse, removed = verdict(text, tmp_path)

    assert (status, worse) == ("ok", set())
    assert set(removed) == {"in_g54", "in_g55"} and removed["in_g54"] == pytest.approx(removed["in_g55"], rel=0.02)


def test_a_program_that_counts_from_where_it_starts(tmp_path: Path) -> None:
    text = "G21 G91\nM3 S9000\nG1 Z-2 F100\nX20 F400\nY10\nG0 Z10\nM5\n"
    seen = survey(source(text))
    status, worse, removed = verdict(text, tmp_path)

    assert seen.from_zero and status == "ok" and not worse and removed["stock"] > 100.0


@pytest.mark.parametrize(
    ("text", "there"),
    [
        ("G92 X0 Y0 Z0\nG90 G1 X1 F9\n", True),
        ("G91\nG1 X1 F9\n", True),
        ("G91 G28 Z0\nG90\nG0 X1\n", False),
        ("G91\nG28 Z0\nG90 G0 X1\n", False),
        ("G91\nG90\nG0 X1\n", False),
        ("G0 X1\nG91\nG0 X1\n", False),
    ],
)
def test_whether_it_counts_from_where_it_stands(text: str, there: bool) -> None:
    assert survey(source(text + "M2\n")).from_zero is there


def test_heights_are_those_of_the_work(tmp_path: Path) -> None:
    """Z0 is the table: the top is where the tool feeds sideways, not where it waits."""
    text = (
        "G21 G90\nG1 Z30 F2000\nM3 S9000\nG1 X0 Y0\nG1 Z18 F200\nG1 X50 F900\nG1 Z16\nG1 X0\nG1 Z30 F2000\nG1 X80\nM5\n"
    )
    cut = survey(source(text)).systems[1].cut

    assert cut is not None
    np.testing.assert_allclose(cut[1][2], 0.018)
    np.testing.assert_allclose([cut[0][0], cut[1][0]], [0.0, 0.05])


def test_no_stock_where_a_rapid_comes_down_beside_the_part() -> None:
    text = "G21 G90\nT1 M6 (END MILL D10)\nS9000 M3\nG0 X-9 Y10\nG0 Z-2\nG1 X60 F500\nG0 Z5\nM5\nM2\n"

    assert "min: [-4, " in cell_for(source(text)).decode()


def test_rapids_of_holes_are_no_sides_of_the_stock(tmp_path: Path) -> None:
    text = "G21 G90\nT1 M6 (DRILL D3)\nS3000 M3\nG0 X0 Y0 Z5\nG83 X0 Y0 Z-8 R1 Q2 F100\nX20\nY20\nG80\nM5\nM2\n"
    status, worse, removed = verdict(text, tmp_path)

    assert (status, worse) == ("ok", set())
    assert removed["stock"] == pytest.approx(3 * np.pi / 4 * 9 * (8 - 0.6), rel=0.15)


def test_a_pen_has_no_stock() -> None:
    """What is switched without a speed, and nothing moves Z: a pen, or a knife."""
    cell = cell_for(source("G21 G90\nM3\nG0 X1 Y2\nG1 X10 F900\nY20\nM5\n")).decode()

    assert "\nstock:" not in cell and "\ntools:" not in cell and "loaded_tool" not in cell


def test_work_that_turns_has_no_stock_yet(tmp_path: Path) -> None:
    text = "G21 G90\nT1 M6 (BALL D4)\nS9000 M3\nG0 X0 Y0 Z9\nG1 Z-1 F200\nX30 A90 F600\nG0 Z9\nM5\nM2\n"
    status, worse, removed = verdict(text, tmp_path)

    assert (status, worse, removed) == ("ok", set(), {}) and "    A: {travel: unlimited" in cell_for(
        source(text)
    ).decode()


def test_a_lathe_program_of_linuxcnc_cuts_a_bar(tmp_path: Path) -> None:
    text = "G21 G18 G8\nS800 M3\nG0 X30 Z60\nG1 X12 Z0 F80\nZ-20\nG0 X40 Z20\nM5\nM2\n"

    status, codes, removed = verdict(text, tmp_path)

    assert (status, codes) == ("ok", set())
    assert removed["stock"] == pytest.approx(np.pi * (12.5**2 - 12.0**2) * 20.0, rel=1e-3)


def test_probes_ask_for_travel_and_cut_nothing(tmp_path: Path) -> None:
    text = "G21 G90\nT9 M6\nG0 X5 Y5 Z60\nG38.3 Z-250 F100\nG0 Z60\nM2\n"
    status, worse, removed = verdict(text, tmp_path)

    assert (status, worse, removed) == ("ok", set(), {})


def test_what_no_dialect_reads_has_no_cell() -> None:
    with pytest.raises(NoCellError, match="lathe"):
        cell_for(source("%\nO0007\nG50 S2000\nT0101\nG96 S180 M3\nG0 X52. Z2.\nM30\n%\n"))


@pytest.mark.parametrize(
    ("text", "diameter"),
    [
        ('(T1 | 1/4" END MILL)\nT1 M6', 6.35),
        ("( T1 | 1/2 FLAT ENDMILL | H1 )\nT1 M6", 12.7),
        ("T1 M6 (DRILL 9/32)", 25.4 * 9 / 32),
        ("(TOOL/MILL,3.17, 0.00, 0.00, 0.00)\nM6T1", 3.17),
        ("T1\n(MSG, Change tool bit to drill size 0.8mm)\nM6", 0.8),
        ("T1 M6 (MILL_D50_ROUGH)", 50.0),
        ("T1 M6\n(Tool Diameter: 6.35)", 6.35),
        ("( T1 : 6.0 )\nT1 M6", 6.0),
        ("(3 mm End mill)\nM3 S1", 3.0),
        ("( T212 |    3. FLAT ENDMILL | H0 )\nT212 M6", 3.0),
        ("(T1 .5 ENDMILL 03-0086)\nT1 M6", 0.5),
        ("T1 M6 (DRILL 03-0018)", None),
        ("T1 M6 (2.5 DEEP POCKET MILL)", None),
        ("T1 M6\n(PART 20 mm wide)", None),
        ("T1 M6 (PART 7)", None),
        ("T1 M6\n(cutter does not go below 12 mm)", None),
        ("T1 M6\n(cutter does not go below 12 mm, 6 mm end mill)", 6.0),
        ("T1 M6\n(mill 5 mm deep)", None),
        ("T1 M6\nG0 X1\nG0 X2\nG0 X3\nG0 X4\nG0 X5\nG0 X6\n(8 mm end mill)\nT1 M6", 8.0),
    ],
)
def test_diameters_in_comments(text: str, diameter: float | None) -> None:
    [tool] = scan(source("G21\n" + text + "\nG1 X1 F1\nM2\n")).tools

    assert tool.diameter == pytest.approx(diameter) if diameter is not None else tool.diameter is None


def test_corners_of_the_stock_and_offsets_of_other_numbers() -> None:
    found = scan(
        source("(stockMin:0.00mm, -5.00mm, -19.05mm)\n(stockMax:100.00mm, 95mm, 0.00mm)\nT3 M6\nG43 H33\nM2\n")
    )

    assert found.corners == ((0.0, -5.0, -19.05), (100.0, 95.0, 0.0))
    assert dict(found.offsets) == {33: 3}


def test_check_and_run_agree(tmp_path: Path) -> None:
    for text in (HAND, FANUC):
        loaded = read_cell(SourceText(CELL, cell_for(source(text))), tmp_path / CELL)
        checked = check(prepare(source(text), loaded))
        ran, _ = run(prepare(source(text), loaded))
        assert [f.code for f in checked.findings] == [f.code for f in ran.findings]
        assert checked.times.total == ran.times.total > 0.0


def test_a_tap_on_its_way_out_is_no_misuse(tmp_path: Path) -> None:
    text = "G21 G90\nT1 M6 (TAP D6)\nS300 M3\nG0 X0 Y0 Z5\nG84 X0 Y0 Z-9 R2 F300\nX20\nG80\nM5\nM2\n"

    assert verdict(text, tmp_path)[:2] == ("ok", set())
    left = text.replace("M3", "M4").replace("G84", "G74")
    assert verdict(left, tmp_path)[:2] == ("ok", set())
    drilled = text.replace("M3", "M4").replace("G84", "G81")
    assert verdict(drilled, tmp_path)[1] == {"GS502"}


def test_a_probe_needs_no_spindle(tmp_path: Path) -> None:
    text = "G21 G90\nT1 M6 (END MILL D6)\nS9000 M3\nG0 X0 Y0 Z5\nG1 Z-3 F200\nX30\nG0 Z5\nM5\n"

    assert verdict(text + "G0 X15\nG38.3 Z-3 F50\nG0 Z5\nM2\n", tmp_path)[:2] == ("ok", set())
    assert verdict(text + "G0 X15 Y4\nG38.3 Z-3 F50\nG0 Z5\nM2\n", tmp_path)[:2] == ("ok", set())
    assert verdict(text + "G0 X15 Y4\nG1 Z-3 F50\nG0 Z5\nM2\n", tmp_path)[1] >= {"GS501"}


def test_additional_systems_of_fanuc_have_their_place(tmp_path: Path) -> None:
    text = FANUC.replace("G54\n", "G54.1 P2\n")
    status, worse, _removed = verdict(text, tmp_path)

    assert (status, worse) == ("ok", set())
    assert b"G54.1 P2: {xyz" in cell_for(source(text))


OWN_ZEROS = (
    "G21 G90 G40 G49\nT1 M6\nG43 H1\nG10 L2 P1 X-320 Y-210 Z-410\nG10 L2 P2 X-120 Y-210 Z-410\nM3 S5000\n"
    "G54\nG0 X0 Y0 Z20\nZ2\nG1 Z-1 F200\nX40 F600\nG0 Z20\nG55\nG0 X0 Y0\nZ2\nG1 Z-1 F200\nX40 F600\nG0 Z20\nM5\nM2\n"
)


def test_zeros_that_the_program_sets_itself_are_those_of_the_cell(tmp_path: Path) -> None:
    seen = survey(source(OWN_ZEROS))
    assert seen.own == {1: pytest.approx((-0.32, -0.21, -0.41)), 2: pytest.approx((-0.12, -0.21, -0.41))}
    status, worse, removed = verdict(OWN_ZEROS, tmp_path)
    assert (status, worse) == ("ok", set())
    assert min(removed.values()) > 100.0 and len(removed) == 2


@pytest.mark.parametrize("shift", ["G92 X0 Y0", "G10 L20 P1 X0 Y0", "G52 X40 Y0"])
def test_a_shift_within_the_work_makes_the_stock_longer(tmp_path: Path, shift: str) -> None:
    """The second cut lies 40 mm further; the first is not cut twice."""
    cut = "G0 Z2\nG1 Z-1 F200\nX30 F600\nG0 Z20\n"
    dialect = "%\nO0001\n" if "G52" in shift else ""
    text = f"{dialect}G21 G90\nT1 M6\nG43 H1\nM3 S5000\nG0 X0 Y0 Z20\n{cut}G0 X40 Y0\n{shift}\nG0 X0 Y0\n{cut}M5\nM30\n"
    status, worse, removed = verdict(text, tmp_path)
    assert status == "ok" and worse <= {"GS187"}  # the shift is still in force at the end
    assert removed["stock"] == pytest.approx(2 * 6.0 * 30.0, rel=0.25)


def test_an_offset_of_the_tool_that_the_program_sets_counts_for_travel(tmp_path: Path) -> None:
    text = "G21 G90\nM3 S5000\nG43.1 Z180\nG0 X0 Y0 Z40\nG1 Z-1 F200\nX40\nG0 Z40\nM5\nM2\n"
    status, worse, _ = verdict(text, tmp_path)
    assert status != "failed" and "GS201" not in worse


@pytest.mark.parametrize("head", ["#1=3\n", "%\nO0001\n"])
def test_a_program_without_end_gets_a_cell_in_which_it_runs(tmp_path: Path, head: str) -> None:
    text = head + "G21 G90\nT1 M6\nG43 H1\nM3 S5000\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG1 X20.\nG0 Z5\nM5\n"
    loaded = read_cell(SourceText(CELL, cell_for(source(text))), tmp_path / CELL)
    results, _ = run(prepare(source(text), loaded))
    assert [f.code for f in results.findings if f.level >= Severity.ERROR] == []
    assert results.stocks["stock"].removed > 0.0


def test_rapids_before_the_first_feed_pass_no_material(tmp_path: Path) -> None:
    start = "G21 G90\nT1 M6\nG43 H1\nM3 S5000\nG0 X10 Y10 Z0\nG0 X0 Y0\n"
    text = start + "G1 Z-2 F100\nG1 X40\nG1 Y20 Z5\nG1 X0\nG1 Y0 Z-2\nM5\nM2\n"
    status, worse, _ = verdict(text, tmp_path)
    assert status != "failed" and "GS401" not in worse


def test_tools_whose_numbers_are_computed_are_there(tmp_path: Path) -> None:
    text = "G21 G90\n#1=7\nT#1 M6\nG43\nM3 S5000\nG0 X0 Y0 Z5\nG1 Z-1 F100\nX30\nG0 Z5\nM5\nM2\n"
    status, worse, _ = verdict(text, tmp_path)
    assert (status, worse) == ("ok", set())


def test_a_word_that_no_control_but_one_knows_decides() -> None:
    """Whatever else is wrong with it there."""
    text = "G19\nG0 Y0 Z0\nF100\nG5.2 P1 L3\nY0 Z1 P1\nY2 Z2 P2\nY2 Z0 P3\nG5.3\nM2\n"
    assert survey(source(text)).dialect == "linuxcnc"


def test_a_loop_that_waits_for_a_probe_is_surveyed_without_end() -> None:
    text = "G21 G90\n#1=1\no1 while [#1 gt 0]\nG38.3 X[#1] F100\nG0 X0\n#1=[#1+0.001]\no1 endwhile\nM2\n"
    assert survey(source(text)).failed.code == "GS134"


def test_a_system_that_the_program_puts_at_machine_zero_stands_there(tmp_path: Path) -> None:
    """Setting it to zero changes nothing that could be seen from outside; the cell has to say so anyway."""
    text = "G21 G90\nG10 L2 P2 X0 Y0 Z0\nG55\nT1 M6\nG43 H1\nM3 S5000\nG0 X5 Y5 Z2\nG1 Z-3 F200\nX40\nG0 Z20\nM5\nM2\n"
    assert survey(source(text)).own == {2: (0.0, 0.0, 0.0)}
    status, worse, removed = verdict(text, tmp_path)
    assert (status, worse) == ("ok", set())
    assert removed["stock"] > 500.0


def test_words_of_several_lines_set_no_zero() -> None:
    assert survey(source("G21 G90\nG10\nL2\nP1\nG0 X0\nM2\n")).own == {}


@pytest.mark.parametrize("hostile", ["(", "IF[", "WHILE[", "(TOOL T1 ", "G10L2"])
def test_a_line_without_end_is_read_in_one_go(hostile: str) -> None:
    """Each of them took minutes once, the square of its length."""
    assert survey(source(f"G21\n{hostile * 200_000}\nM2\n")).systems == {}


def test_a_nurbs_curve_alone_does_not_make_a_program_fanucs() -> None:
    """G6.2 is a code of LinuxCNC 2.10, too, and as little simulated there."""
    curve = "G21 G90 F200\nM3 S200\nG6.2 X1 Y0 R1 K0 P3 Q1\nX2 Y1 R1 K0\nX3 Y0 R1 K1\nG6.2 K1\nG0 Z50\nM5\nM2\n"

    assert survey(source("T1 M6\n" + curve)).dialect == "linuxcnc"


def test_a_program_without_a_unit_has_that_of_its_tools(tmp_path) -> None:
    """Many mills in America have inches in force when they are switched on, and their programs never say G20."""
    text = (
        "%\nO0012\n(TOOL 4 = 3/8IN ENDMILL)\nG00 G17 G40 G49 G54 G80 G90\nT4 M06\nS2000 M03\nG43 H04 Z1.\n"
        "X-.5 Y0.\nG01 Z-.1 F20.\nX4.5\nG00 Z1.\nM05\nM30\n%\n"
    )
    cell = cell_for(source(text)).decode()
    status, found, _ = verdict(text, tmp_path)

    assert "startup: G20" in cell and "units: {length: in}" in cell and "diameter: 0.375 in" in cell
    assert status == "ok" and not found
    said = text.replace("G90", "G90 G21")
    assert "startup" not in cell_for(source(said)).decode()


def test_a_mill_of_a_printers_firmware_cuts_in_its_first_cell(tmp_path: Path) -> None:
    """A slot 1 mm deep over 30 mm with the guessed end mill of 6 mm."""
    status, worse, removed = verdict(FABTOTUM, tmp_path)

    assert (status, worse) == ("ok", set())
    assert 0.4 * 30 * 6 < removed["stock"] < 30 * 6 + 60


def test_an_error_far_behind_asks_the_other_dialects_as_well() -> None:
    """K0 in an arc of XY, which LinuxCNC refuses and grbl does not, stands behind what is read to choose a dialect."""
    lines = "".join(f"G1 X{number % 97} Y{number % 89}\n" for number in range(12_000))
    text = f"G21 G17 G90\n( M6 T2 )\nM3 S10000\nG0 Z5\nG1 Z-1 F200\n{lines}X26 Y0\nG2 X20 Y0 I-3 J0 K0\nG0 Z5\nM5\nM2\n"

    assert len(text) > 100_000
    seen = survey(source(text.replace("K0", "")))
    assert (seen.dialect, seen.failed) == ("linuxcnc", None)
    seen = survey(source(text))
    assert (seen.dialect, seen.failed) == ("grbl", None)


def test_before_an_error_a_tool_is_there_that_nothing_changes() -> None:
    text = "G21 G90\n( M6 T2 )\n(T2 3mm Endmill)\nM3 S9000\nG0 Z5\nG1 Z-1 F200\nX20\nG1 X30 Q\nX40\nM2\n"

    assert b"loaded_tool: 2 " in cell_for(source(text))
    assert b"loaded_tool" not in cell_for(source(text.replace("( M6 T2 )", "T2 M6")))

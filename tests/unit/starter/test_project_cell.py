"""A project of CAMotics gives a whole cell: its programs run in it, with its tools, stock and resolution."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from gcodesim.cell import load_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.simulation import prepare, run
from gcodesim.starter.first_cell import NoCellError
from gcodesim.starter.project_cell import cell_of_project, read_project

SLOT = "G21 G90\nF600\nG0 Z5\nG0 X10 Y10\nG1 Z-2\nG1 X30\nG0 Z5\n"
BITS = {
    "1": {"units": "imperial", "shape": "cylindrical", "length": 1, "diameter": 0.125, "description": "eighth"},
    "2": {"units": "metric", "shape": "ballnose", "length": 20, "diameter": 4, "description": ""},
    "9": {"units": "metric", "shape": "spheroid", "length": 3, "diameter": 4, "description": "egg"},
}


def project(folder: Path, programs: dict[str, str], **changes: Any) -> Path:
    for name, text in programs.items():
        (folder / name).write_text(text)
    content = {
        "units": "metric", "resolution-mode": "medium", "resolution": 0.5, "tools": BITS, "files": list(programs),
        "workpiece": {"automatic": False, "margin": 5, "bounds": {"min": [0, 0, -10], "max": [40, 20, 0]}},
    }  # fmt: skip
    path = folder / "part.camotics"
    path.write_text(json.dumps({**content, **changes}))
    return path


def test_a_project_runs_as_it_says(tmp_path):
    path = project(tmp_path, {"part.nc": SLOT + "M2\n"})
    (tmp_path / "cell.yaml").write_bytes(cell_of_project(read_project(path)))
    loaded = load_cell(tmp_path / "cell.yaml")
    assert loaded.cell is not None, list(loaded.findings)
    job = prepare(SourceText.read(tmp_path / "part.nc"), loaded, Options(only="shape"))
    results, _ = run(job)

    stock = results.stocks["stock"]
    assert stock.initial == pytest.approx(40 * 20 * 10 * 1e-9) and stock.resolution == pytest.approx(0.5e-3)
    d = 3.175
    assert stock.removed * 1e9 == pytest.approx(2 * (20 * d + 3.14159265 / 4 * d * d), rel=5e-3)  # T1 is in the spindle
    assert results.stopped_at is None


def test_what_it_refuses_and_what_is_missing_is_said(tmp_path):
    path = project(tmp_path, {"part.nc": "T3 M6\n" + SLOT + "M2\n"})
    text = cell_of_project(read_project(path)).decode()

    assert "# T9: refused: gcodesim knows no tool of the shape `spheroid`" in text
    assert "3: {type: flat_end_mill" in text and "ITS DIAMETER IS A GUESS" in text
    assert "resolution: 0.5 mm" in text and '1: {type: flat_end_mill, name: "eighth", diameter: 0.125 in' in text


def test_several_programs_share_a_cell(tmp_path):
    path = project(tmp_path, {"one.nc": SLOT, "two.nc": SLOT.replace("X30", "X900") + "M2\n"})
    found = read_project(path)

    assert [program.name for program in found.programs] == ["one.nc", "two.nc"]
    assert "# as large as the program asks for" in cell_of_project(found).decode()  # the second needs more travel


def test_without_bounds_the_stock_is_a_guess(tmp_path):
    path = project(tmp_path, {"part.nc": SLOT + "M2\n"}, workpiece={"automatic": True, "margin": 5})
    assert "# a guess from what is cut" in cell_of_project(read_project(path)).decode()


@pytest.mark.parametrize(
    ("files", "says"),
    [
        (["box.tpl"], "a script that makes G-code: run `tplang box.tpl > box.nc`"),
        (["gone.nc"], "names `gone.nc`, which is not there"),
        (["../part.nc"], "which is outside of its folder"),
        ([], "names no program"),
    ],
)
def test_programs_that_cannot_be_read(tmp_path, files, says):
    (tmp_path / "box.tpl").write_text("cut(1, 2, 3);\n")
    with pytest.raises(NoCellError, match=says.replace("(", r"\(")):
        read_project(project(tmp_path, {}, files=files))


def test_no_project(tmp_path):
    (tmp_path / "part.camotics").write_text("[1]")
    with pytest.raises(NoCellError, match="a mapping is expected"):
        read_project(tmp_path / "part.camotics")

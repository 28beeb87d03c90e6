"""Which files travel with a run."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell import load_cell
from gcodesim.scale.inputs import CannotTravelError, files_of_cell, gathered, subprograms


def test_subprograms_count_when_their_names_stand_in_a_text_that_counts(tmp_path: Path):
    for name, text in {
        "main.ngc": "O<One> CALL\nM98 P0200\nM2\n",
        "one.ngc": "o<one> sub\no<two> call\no<one> endsub\n",
        "two.ngc": "",
        "three.ngc": "",
        "O200.nc": "",
        "picture.png": "one two",
    }.items():
        (tmp_path / name).write_text(text)

    found = {path.name for path in subprograms(tmp_path / "main.ngc", [])}

    assert found == {"one.ngc", "two.ngc", "O200.nc"}


def test_a_computed_call_takes_all(tmp_path: Path):
    (tmp_path / "main.ngc").write_text("O#1 CALL\n")
    (tmp_path / "sub.ngc").write_text("")

    assert [path.name for path in subprograms(tmp_path / "main.ngc", [])] == ["sub.ngc"]


def test_files_keep_their_places_below_a_common_folder(tmp_path: Path):
    for name in ("a/x.nc", "b/c/y.stl"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text(name)

    inputs = gathered([tmp_path / "a/x.nc", tmp_path / "b/c/y.stl"], root=tmp_path / "a")

    assert inputs.bundle.files == {"a/x.nc": b"a/x.nc", "b/c/y.stl": b"b/c/y.stl"}


def test_an_absolute_name_cannot_travel(tmp_path: Path):
    table = tmp_path / "tool.tbl"
    table.write_text("T1 P1 D6\n")
    (tmp_path / "cell.yaml").write_text(f"machine: gantry_xyz\ntool_table: {table}\n")
    loaded = load_cell(tmp_path / "cell.yaml")

    assert loaded.cell is not None
    with pytest.raises(CannotTravelError, match="absolute"):
        list(files_of_cell(loaded))


def test_macros_of_a_printer_travel_with_the_folders_that_they_are_in(tmp_path: Path):
    for name, text in {
        "main.gcode": 'M98 P"0:/macros/park head"\nM98 P"../../away.g"\n',
        "macros/park head": 'M98 P"wipe.g" S1\nM98 P"/macros/park head"\n',
        "sys/wipe.g": "G1 X1\n",
        "sys/other.g": "G1 X1\n",
        "../away.g": "G1 X1\n",
    }.items():
        (tmp_path / "card" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "card" / name).write_text(text)
    found = [path.relative_to(tmp_path / "card").as_posix() for path in subprograms(tmp_path / "card/main.gcode", [])]
    assert found == ["macros/park head", "sys/wipe.g"]

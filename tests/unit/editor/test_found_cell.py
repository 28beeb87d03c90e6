"""Which cell belongs to a program that is open in an editor."""

from __future__ import annotations

from pathlib import Path

from gcodesim.editor.found_cell import cell_of


def test_a_name_that_no_file_can_have_has_the_cell_beside_it_or_none(tmp_path: Path) -> None:
    program = tmp_path / ("x" * 5000 + ".nc")

    assert cell_of(program, None) is None
    (tmp_path / "cell.yaml").write_text("gcodesim: 1\n")
    assert cell_of(program, None) == tmp_path / "cell.yaml"
    assert cell_of(tmp_path / "part.nc", program) is None

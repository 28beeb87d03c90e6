"""A test file comes from whoever is judged: it opens what lies below the folder of the run, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cli.main import main


@pytest.mark.parametrize("folder", ["inside", "outside"])
def test_a_test_file_opens_what_lies_below(
    folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    top = tmp_path / "run"
    place = tmp_path / "outside" if folder == "outside" else top / "inside"
    (top / "suite").mkdir(parents=True)
    place.mkdir()
    (place / "t.tbl").write_text("T1 P1 D6 Z40\n")
    named = "../../outside" if folder == "outside" else "../inside"
    (top / "suite" / "a.nc").write_text("G21\nG0 X1\nM2\n")
    (top / "suite" / "cell.yaml").write_text(f"gcodesim: 1\nmachine: gantry_xyz\ntool_table: {named}/t.tbl\n")
    (top / "suite" / "a.test.yaml").write_text(f"cell: cell.yaml\nallow_path: {named}\n")
    monkeypatch.chdir(top)
    main(["test", "."])
    assert ("GS715" in capsys.readouterr().out) is (folder == "outside")
    main(["test", ".", "--allow-path", "../outside"])
    assert "GS715" not in capsys.readouterr().out
    monkeypatch.setenv("GCODESIM_ALLOW_PATH", str(tmp_path / "outside"))
    main(["test", "."])
    assert "GS715" not in capsys.readouterr().out

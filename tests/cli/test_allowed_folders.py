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


PROGRAM = "G21\nG0 X1\nM2\n(expect: GS101)\n"


@pytest.fixture
def strange(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which somebody else's tests run; what they must not read lies beside it."""
    top = tmp_path / "run"
    (top / "suite").mkdir(parents=True)
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "part.nc").write_text("TOP SECRET\n" + PROGRAM)
    (tmp_path / "secret" / "cell.yaml").write_text("gcodesim: 1\nmachine: [TOP SECRET]\n")
    (tmp_path / "secret" / "part.test.yaml").write_text("cell: [TOP SECRET]\n")
    (top / "suite" / "own.nc").write_text("G21\nG0 X1\nM2\n")
    (top / "suite" / "cell.yaml").write_text("gcodesim: 1\nmachine: gantry_xyz\n")
    monkeypatch.chdir(top)
    return top


@pytest.mark.parametrize(
    "text",
    [
        "{program: ../../secret/part.nc, cell: cell.yaml}",
        "{program: '../../secret/*.nc', cell: cell.yaml}",
        "{program: '../../*/part.nc', cell: cell.yaml}",
        "{program: own.nc, cell: ../../secret/cell.yaml}",
        "{program: '%s/secret/part.nc', options: {mode: lint}}",
    ],
)
def test_a_test_file_names_no_program_or_cell_outside(
    strange: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    (strange / "suite" / "a.test.yaml").write_text(text.replace("%s", str(strange.parent)))
    for paths in (["."], ["suite"], ["suite/a.test.yaml"]):
        assert main(["test", *paths]) == 1
        said = capsys.readouterr().out
        assert "GS715" in said and "SECRET" not in said
    main(["test", ".", "--allow-path", ".."])
    assert "GS715" not in capsys.readouterr().out


@pytest.mark.parametrize("name", ["part.nc", "part.test.yaml"])
@pytest.mark.parametrize("named", [False, True])
def test_a_link_leads_nowhere_else(strange: Path, capsys: pytest.CaptureFixture[str], name: str, named: bool) -> None:
    (strange / "suite" / name).symlink_to(Path("../../secret") / name)
    if name == "part.test.yaml":
        (strange / "suite" / "part.nc").write_text(PROGRAM)
    assert main(["test", f"suite/{name}" if named else "."]) == 1
    said = capsys.readouterr().out
    assert "GS715" in said and "SECRET" not in said and "link" in said


def test_accepted_results_go_to_no_folder_behind_a_link(strange: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (strange / "suite" / "a.test.yaml").write_text("{program: '*.nc', cell: cell.yaml}")
    (strange / "suite" / "a.golden").symlink_to(Path("../../secret"))
    assert main(["accept", "."]) != 0
    assert "GS715" in "".join(capsys.readouterr()) or sorted(p.name for p in (strange.parent / "secret").iterdir()) == [
        "cell.yaml",
        "part.nc",
        "part.test.yaml",
    ]


def test_what_the_command_line_names_may_lie_anywhere(strange: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = strange.parent / "other"
    other.mkdir()
    (other / "x.nc").write_text("G21\nG0 X1\nM2\n")
    (other / "x.test.yaml").write_text("{options: {mode: lint}}")
    for path in (other, other / "x.nc", other / "x.test.yaml"):
        main(["test", str(path)])
        assert "GS715" not in capsys.readouterr().out

"""Programs without a cell: what they need is told, and `--cell auto` runs them in the one that `init --from` writes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

TWO = """G21 G90 G17
T1 M6 (6 mm end mill)
G43 H1
S9000 M3
G0 X10 Y10
G0 Z2
G1 Z-2 F200
G1 X70 F600
G0 Z20
T2 M6
G43 H2
S2000 M3
G0 X20 Y20
Z2
G1 Z-5 F100
G0 Z20
M5
M2
"""
INCH = "G20 G90\n(STOCK 4 x 3 x 0.5)\nT1 M6 (1/4 end mill)\nS9000 M3\nG0 Z1\nG1 Z-.1 F10\nX2\nG0 Z1\nM2\n"
KLARTEXT = "0 BEGIN PGM PART MM\n1 TOOL CALL 1 Z S5000\n2 L X+10 Y+10 R0 FMAX\n3 END PGM PART MM\n"


@pytest.mark.parametrize("command", ["run", "check"])
def test_what_the_program_needs_is_told(cli, write, tmp_path: Path, command: str) -> None:
    write("two.nc", TWO)
    before = sorted(tmp_path.iterdir())
    done = cli(command, "two.nc")

    assert done.status == 2 and not done.out
    rows = done.err.splitlines()
    assert rows[1:-2] == [
        "  dialect  linuxcnc (it understands every line)",
        "  tools    T1 flat end mill, diameter 6 mm (line 2)",
        "           T2 drill, diameter not told, perhaps 5 mm (line 10)",
        "  stock    X 10 to 70, Y 10 to 20, Z -5 to 0 mm in G54 (at least, by what is cut)",
        "  travel   X 10 to 70, Y 10 to 20, Z -5 to 20 mm in G54",
    ]
    assert "`gcodesim init DIR --from two.nc`" in rows[-2]
    assert f"`gcodesim {command} two.nc --cell auto`" in rows[-1]
    assert sorted(tmp_path.iterdir()) == before


def test_it_is_told_in_the_units_of_the_program(cli, write) -> None:
    write(
        "inch.nc", "G20 G90\n(STOCK 4 x 3 x 0.5)\nT1 M6 (1/4 end mill)\nS9000 M3\nG0 Z1\nG1 Z-.1 F10\nX2\nG0 Z1\nM2\n"
    )
    said = cli("run", "inch.nc").err

    assert "T1 flat end mill, diameter 0.25 in (line 3)" in said
    assert "Z -0.5 to 0 in in G54 (from line 2)" in said and "X 0 to 2, Y 0 to 0, Z -0.1 to 1 in in G54" in said


def test_auto_runs_in_the_cell_that_init_writes(cli, write, tmp_path: Path) -> None:
    write("two.nc", TWO)
    done = cli("run", "two.nc", "--cell", "auto", "--out", "auto_run")
    assert done.status == 0, done.out + done.err
    assert cli("init", "own", "--from", "two.nc").status == 0

    made = tmp_path / "auto_run" / "cell.yaml"
    assert made.read_bytes() == (tmp_path / "own" / "cell.yaml").read_bytes()
    assert (
        "note GS752: the cell was made from the program; guessed: the stock, the material, the diameter of T2"
        in done.out
    )
    assert "cell.yaml" in next(line for line in done.out.splitlines() if "files in" in line)


def test_the_run_is_reproducible_from_its_folder(cli, write, tmp_path: Path) -> None:
    write("two.nc", TWO)
    assert cli("run", "two.nc", "--cell", "auto", "--out", "one").status == 0
    assert cli("run", "two.nc", "--cell", "one/cell.yaml", "--out", "two").status == 0

    for name in ("lines.csv", "stock.stl", "stock.stock"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    one, two = (json.loads((tmp_path / name / "results.json").read_text()) for name in ("one", "two"))
    [note] = [finding for finding in one["findings"] if finding["code"] == "GS752"]
    one["findings"].remove(note)
    assert note["severity"] == "note" and one == two


def test_a_cell_that_was_changed_is_not_overwritten(cli, write, tmp_path: Path) -> None:
    write("two.nc", TWO)
    arguments = ("run", "two.nc", "--cell", "auto")
    assert cli(*arguments).status == 0 and cli(*arguments).status == 0  # the same again
    made = tmp_path / "out" / "cell.yaml"
    mine = made.read_bytes() + b"# mine\n"
    made.write_bytes(mine)

    done = cli(*arguments)
    assert done.status == 1 and "error GS750: the run would overwrite `cell.yaml`" in done.out
    assert made.read_bytes() == mine
    assert cli(*arguments, "--force").status == 0
    assert made.read_bytes() + b"# mine\n" == mine


def test_each_checked_program_gets_its_own(cli, write) -> None:
    write("two.nc", TWO)
    write("inch.nc", INCH)
    done = cli("check", "two.nc", "inch.nc", "slot.nc", "--cell", "auto")

    assert done.status == 0 and done.out.count("GS752") == 3
    assert "diameter of T2" in done.out and "two.nc: no errors" in done.out and "inch.nc: no errors" in done.out


def test_what_no_dialect_reads_is_told(cli, write, tmp_path: Path) -> None:
    write("part.h", KLARTEXT)
    for arguments in (("run", "part.h"), ("run", "part.h", "--cell", "auto")):
        done = cli(*arguments)
        assert done.status == 2 and "Klartext" in done.err and "no dialect of gcodesim reads it" in done.err
    assert not (tmp_path / "out").exists()


def test_a_file_called_auto_is_named_by_its_folder(cli, tmp_path: Path) -> None:
    (tmp_path / "auto").write_bytes((tmp_path / "cell.yaml").read_bytes())
    done = cli("check", "slot.nc", "--cell", "./auto")

    assert done.status == 0 and "GS752" not in done.out

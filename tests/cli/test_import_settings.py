"""`gcodesim import` of settings, as a user runs it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from gcodesim.cli import main

GRBL = "$0=10\n$110=3000\n$111=3000\n$112=800\n$120=200\n$130=300\n$131=180\n$132=45\n"


def test_a_cell_and_the_list_of_what_is_not_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("grbl.txt").write_text(GRBL)

    assert main(["import", "grbl", "grbl.txt", "-o", "cell.yaml"]) == 0
    said = capsys.readouterr().out
    assert "  grbl.txt:1: $0 = 10: " in said
    assert "7 settings taken over, 1 not, of which 0 (!)" in said
    Path("part.nc").write_text("G21 G90\nG0 X5 Y5 Z5\nG1 Z0 F200\nM2\n")
    assert main(["check", "part.nc", "--cell", "cell.yaml"]) == 0

    capsys.readouterr()
    assert main(["import", "grbl", "grbl.txt"]) == 0
    out = capsys.readouterr()
    assert out.out == Path("cell.yaml").read_text()
    assert "$0 = 10" in out.err

    assert main(["import", "grbl", "grbl.txt", "--format", "json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["cell"] == Path("cell.yaml").read_text()
    assert [(one["name"], one["line"], one["matters"]) for one in told["left"]] == [("$0", 1, False)]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["grbl", "nothing.txt"], "nothing.txt"),
        (["grbl", "part.nc"], "no list of the settings of grbl"),
        (["grbll", "part.nc"], "grbl"),
        (["grbl", "part.nc", "--inch"], "--inch"),
        (["tools", "part.nc", "--format", "json"], "json"),
    ],
)
def test_wrong_use(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    says: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("part.nc").write_text("G0 X5\n")
    assert main(["import", *words]) == 2
    assert says in capsys.readouterr().err

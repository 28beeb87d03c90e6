"""`canon`, `lint`, `check` and `run` say the same about a program: codes, words, places, callers and counts."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from gcodesim.cli.main import main

DATA = Path(__file__).parents[1] / "data" / "programs"
CELL = DATA / "cell.yaml"
PROGRAMS = [*sorted((DATA / "broken").glob("*.nc")), *sorted((DATA / "posts").glob("linuxcnc_*.nc"))]
# what the cell and the machine add is no matter of the program alone
OF_THE_CELL = ("GS2", "GS3", "GS4", "GS5", "GS7", "GS909", "GS910", "GS911")
# what a probe meets: nothing for who reads the program alone, the stock as it comes for `check`, what is left for `run`
OF_PROBES = ("GS913", "GS919")


def findings(capsys: pytest.CaptureFixture[str], command: str, program: Path, *options: str) -> list[str]:
    main([command, str(program), "--cell", str(CELL), "--max-blocks", "20000", "--format", "json", *options])
    found = json.loads(capsys.readouterr().out)["findings"]
    for finding in found:
        finding.pop("time_s")
    return [
        json.dumps(finding, sort_keys=True)
        for finding in found
        if not finding["code"].startswith(OF_THE_CELL + OF_PROBES)
    ]


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_all_commands_say_the_same(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = findings(capsys, "lint", path)

    assert findings(capsys, "canon", path) == told
    assert findings(capsys, "check", path) == told


@pytest.mark.parametrize("path", PROGRAMS[::9], ids=lambda path: path.stem)
def test_run_says_the_same(path: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert findings(capsys, "run", path, "--out", str(tmp_path)) == findings(capsys, "lint", path)

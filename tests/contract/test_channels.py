"""Several programs at once: the times of their blocks, and who waits in vain, as worked out by hand for each case.

The cases go through the command line, by the program that also runs other cases of the same form.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from scripts.channel_cases import files_of, result_of

FOLDER = Path(__file__).parents[1] / "data" / "channels"
FILES = [FOLDER / "cases.json", FOLDER / "own_cases.json"]
CASES = [case for file in FILES for case in json.loads(file.read_text())["cases"]]


def judged(results: dict[str, Any], folder: Path, *files: Path) -> subprocess.CompletedProcess[str]:
    (folder / "results.json").write_text(json.dumps(results))
    command = [sys.executable, str(FOLDER / "compare.py"), *map(str, files), str(folder / "results.json")]
    return subprocess.run(command, capture_output=True, text=True)


def test_every_case_is_as_expected(tmp_path: Path) -> None:
    results = {case["id"]: result_of(case, tmp_path / case["id"]) for case in CASES}

    verdict = judged(results, tmp_path, *FILES)

    assert verdict.returncode == 0, verdict.stdout
    assert verdict.stdout == f"{len(CASES)} passed, 0 failed\n"


def test_a_wrong_time_is_noticed(tmp_path: Path) -> None:
    case = CASES[0]
    result = result_of(case, tmp_path / "case")
    result["blocks"]["a"][1][2] += 0.002

    assert judged({case["id"]: result}, tmp_path, FILES[0]).returncode == 1


@pytest.mark.parametrize("case", [CASES[2], CASES[6]], ids=lambda case: case["id"])
def test_the_order_of_channels_does_not_count(case: dict[str, Any], tmp_path: Path) -> None:
    turned = {**case, "programs": dict(reversed(case["programs"].items()))}

    assert result_of(turned, tmp_path / "turned") == result_of(case, tmp_path / "as_given")
    assert list(json.loads((tmp_path / "turned" / "cell.yaml").read_text())["channels"]) == list(turned["programs"])


def test_the_cell_may_name_the_programs(tmp_path: Path) -> None:
    case = CASES[0]
    program, _, cell, *_ = files_of(case, tmp_path / "named")
    written = json.loads(Path(cell).read_text())
    written["channels"]["b"]["program"] = "b.nc"
    Path(cell).write_text(json.dumps(written))

    printed = subprocess.run(
        [sys.executable, "-m", "gcodesim", "check", program, "--cell", cell, "--format", "json"],
        capture_output=True,
        text=True,
    )

    channels = json.loads(printed.stdout)["channels"]
    assert channels["a"]["waits"] == [{"mark": "m0", "file": "a.nc", "line": 2, "begin_s": 2, "end_s": 5}]
    assert channels["b"]["end_s"] == 5.5

"""Programs of millions of lines are read within a bound of memory: a whole process, by the most that it ever held."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

LINES = 5_000_000
MOST_BYTES = 1_500_000_000
WAYS = {
    "lint": "import sys; from gcodesim.cli import main; sys.exit(main(['lint', {program!r}]))",
    "read": "import gcodesim; assert len(gcodesim.read({program!r})) >= {lines}",
}


@pytest.fixture(scope="module")
def five_million_lines(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five axes at once, the longest lines of the kind."""
    path = tmp_path_factory.mktemp("long") / "long.nc"
    some = []
    for number in range(10_000):
        t = 0.01 * number
        x, y, z, b, c = 50 * math.cos(t), 50 * math.sin(t), 2 * math.sin(3 * t), 20 * math.sin(t), math.degrees(t) % 360
        some.append(f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f} B{b:.4f} C{c:.4f}\n")
    with path.open("w") as file:
        file.write("G21 G90 G94\nF1500\n")
        for _ in range(LINES // len(some)):
            file.writelines(some)
        file.write("M2\n")
    return path


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
def test_five_million_lines(five_million_lines: Path, way: str) -> None:
    code = WAYS[way].format(program=str(five_million_lines), lines=LINES)
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    assert usage.ru_maxrss * 1024 < MOST_BYTES

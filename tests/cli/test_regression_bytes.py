"""Accepted results and verdicts have the same bytes whoever makes them: workers, processes, folders, order, caches."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 X10 Y{y}\nG0 Z2\nG1 Z-1 F400\nG1 X30\nG0 Z20\nM5\nM2\n"
FILES = ("--junit", "j.xml", "--sarif", "s.sarif", "--gitlab", "g.json", "--write-baseline", "known.json")


def _cases(folder: Path, cells: dict[str, str]) -> None:
    """Three programs in two cells; one feeds with the spindle off."""
    folder.mkdir(parents=True)
    for name, text in cells.items():
        (folder / name).write_text(text)
    for number, (cell, y) in enumerate((("cell.yaml", 8), ("arm.yaml", 8), ("cell.yaml", 15))):
        text = PROGRAM.format(y=y)
        (folder / f"p{number}.nc").write_text(text.replace(" M3", "") if number == 2 else text)
        (folder / f"p{number}.test.yaml").write_text(f"cell: {cell}\n")


def _made(folder: Path, jobs: int, paths: list[str], **more: str) -> dict[str, bytes]:
    """What `accept` and `test` write and print in a folder, by name."""
    env = {**os.environ, "GCODESIM_TEST_CACHE": str(folder.parent / f"{folder.name}-memory"), **more}
    printed = {}
    for name, arguments in {
        "accept": ("accept", "-j", jobs, *paths),
        "json": ("test", "-j", jobs, "--format", "json", *FILES, *paths),
        "known": ("test", "--changed", "--format", "json", *paths),
    }.items():
        command = [sys.executable, "-m", "gcodesim", *map(str, arguments)]
        done = subprocess.run(command, cwd=folder, env=env, capture_output=True, timeout=900)
        assert done.returncode == 0, done.stdout + done.stderr
        printed[name] = done.stdout
    # what is known from an earlier run is the same
    assert printed["known"] == printed["json"]
    return {**printed, **{path.name: path.read_bytes() for path in sorted(folder.iterdir())}}


def test_workers_folders_hash_seeds_and_order_leave_no_trace(cli, tmp_path: Path) -> None:
    cells = {name: (tmp_path / name).read_text() for name in ("cell.yaml", "arm.yaml")}
    _cases(tmp_path / "a", cells)
    _cases(tmp_path / "other" / "folder", cells)
    files = [f"p{i}.test.yaml" for i in range(3)]
    one = _made(tmp_path / "a", 1, files, PYTHONHASHSEED="1")
    four = _made(tmp_path / "other" / "folder", 4, files[::-1], PYTHONHASHSEED="4321")
    assert {"p0.golden.json", "p2.golden.json", "j.xml", "s.sarif", "g.json", "known.json"} <= set(one)
    assert [name for name in one if one[name] != four.get(name)] == [] and set(one) == set(four)
    assert b"GS501" in one["json"] and not any(str(tmp_path).encode() in data for data in one.values())


@pytest.mark.slow
def test_a_cold_cache_of_kernels_leaves_no_trace(cli, tmp_path: Path) -> None:
    cells = {name: (tmp_path / name).read_text() for name in ("cell.yaml", "arm.yaml")}
    made = []
    for name, more in (("known", {}), ("cold", {"XDG_CACHE_HOME": str(tmp_path / "cache")})):
        _cases(tmp_path / name, cells)
        made.append(_made(tmp_path / name, 2, ["."], **more))
    known, cold = made
    assert [name for name in known if known[name] != cold.get(name)] == [] and set(known) == set(cold)

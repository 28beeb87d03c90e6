"""Files that are none, and budgets: status 2 or a finding, at once, never a traceback."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

COMMANDS = [
    ["lint", "{}"],
    ["canon", "{}"],
    ["check", "{}", "--cell", "cell.yaml"],
    ["run", "{}", "--cell", "cell.yaml"],
]
FILES = [
    ["lint", "slot.nc", "--tools", "{}"],
    ["lint", "slot.nc", "--parameters", "{}"],
    ["check", "slot.nc", "--cell", "{}"],
]


@pytest.mark.parametrize("command", [*COMMANDS, *FILES], ids=" ".join)
def test_files_that_are_none(cli, tmp_path: Path, command: list[str]) -> None:
    """A folder, a pipe that nobody writes to, a device without end, nothing at all: status 2, at once, in one line."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "loop").symlink_to("loop")
    for name in ("folder", "pipe", "/dev/zero", "absent", "loop", "slot.nc/more", "a\0b", "n" * 300):
        done = cli(*(part.format(name) for part in command))

        assert done.status == 2, (name, done)
        assert done.err.count("\n") == 1 and "Traceback" not in done.err
        assert done.out == ""


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may read everything")
def test_a_file_that_may_not_be_read(cli, write) -> None:  # pragma: no cover
    path = write("secret.nc", "G0 X1\nM2\n")
    path.chmod(0)
    assert cli("lint", "secret.nc").status == 2
    path.chmod(stat.S_IRUSR | stat.S_IWUSR)


def test_a_file_whose_reading_fails(cli, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(self: Path) -> bytes:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_bytes", fail)
    done = cli("lint", "slot.nc")

    assert done.status == 2
    assert "slot.nc cannot be read: Permission denied" in done.err


def test_a_budget_on_the_command_line(cli, write) -> None:
    write("endless.nc", "#1=0\no1 while [1]\n#1=[#1+1]\no1 endwhile\nM2\n")

    assert "within 50 blocks" in cli("lint", "endless.nc", "--max-blocks", "50").out
    assert "longer than 0 s" in cli("canon", "endless.nc", "--time-limit", "0").out

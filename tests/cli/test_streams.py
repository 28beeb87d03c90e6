"""What the system refuses: a full or closed standard output, a full disk, a name that is too long."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

COMMANDS = (
    ("lint", "slot.nc"),
    ("canon", "slot.nc"),
    ("check", "slot.nc", "--cell", "cell.yaml", "--format", "json"),
    ("run", "slot.nc", "--cell", "cell.yaml"),
    ("info", "out"),
    ("export", "out", "--to", "csv"),
    ("report", "out", "--times"),
    ("explain", "GS203"),
    ("list", "codes"),
    ("schema", "results"),
    ("cell", "show", "cell.yaml"),
)


def _gcodesim(*arguments: str, cwd: Path, redirected: str) -> subprocess.CompletedProcess[str]:
    shell = f'exec "$0" -m gcodesim "$@" {redirected}'
    return subprocess.run(
        ["sh", "-c", shell, sys.executable, *arguments], cwd=cwd, stderr=subprocess.PIPE, text=True, check=False
    )


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full here")
@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_a_full_standard_output_is_told(cli, tmp_path: Path, command: tuple[str, ...]) -> None:
    assert cli("run", "slot.nc", "--cell", "cell.yaml").status == 0
    done = _gcodesim(*command, cwd=tmp_path, redirected="> /dev/full")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == f"gcodesim: the output: {os.strerror(errno.ENOSPC)}"
    assert "Traceback" not in done.stderr and "Exception" not in done.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full here")
@pytest.mark.parametrize("command", [("--help",), ("--version",), ("run", "--help")], ids=" ".join)
def test_help_that_cannot_be_written_is_told(tmp_path: Path, command: tuple[str, ...]) -> None:
    done = _gcodesim(*command, cwd=tmp_path, redirected="> /dev/full")
    assert (done.returncode, done.stderr) == (2, f"gcodesim: the output: {os.strerror(errno.ENOSPC)}\n")


def test_a_closed_standard_output_is_told_before_anything_is_done(cli, tmp_path: Path) -> None:
    done = _gcodesim("run", "slot.nc", "--cell", "cell.yaml", cwd=tmp_path, redirected=">&-")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "the standard output is closed" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_closed_standard_error_is_nobodys_fault(cli, tmp_path: Path) -> None:
    done = _gcodesim("lint", "slot.nc", cwd=tmp_path, redirected="2>&-")
    assert done.returncode == 0


@pytest.mark.parametrize("redirected", ["2>&-", "2>&- <&-"])
def test_workers_run_without_a_standard_error(cli, write, tmp_path: Path, redirected: str) -> None:
    """Nothing that is opened gets its number, and the engine, which is kept from writing there, is loaded."""
    pytest.importorskip("pybullet")
    write("cell.yaml", (tmp_path / "cell.yaml").read_text().replace("world: kinematic", "world: bullet"))
    for name in ("one.nc", "two.nc"):
        write(name, "G21 G90\nG0 X1\nM2\n")
    assert cli("accept", "one.nc", "two.nc", "--cell", "cell.yaml").status == 0
    done = _gcodesim("test", "-j", "2", "one.nc", "two.nc", "--cell", "cell.yaml", cwd=tmp_path, redirected=redirected)
    assert done.returncode == 0


@pytest.mark.parametrize(
    "command",
    [
        ("run", "slot.nc", "--cell", "cell.yaml", "--out", "x" * 300),
        ("lint", "x" * 300),
        ("check", "slot.nc", "--cell", "x" * 300),
        ("test", "x" * 300),
        ("init", "x" * 300),
        ("info", "x" * 300),
        ("info", "out", "--extract", "x" * 300),
        ("report", "x" * 300),
        ("report", "out", "-o", "x" * 300),
        ("plot", "out", "-o", "x" * 296 + ".svg"),
        ("export", "out", "--to", "csv", "-o", "x" * 300),
        ("export", "out", "--to", "rosbag2", "-o", "x" * 300),
        ("diff", "x" * 300, "slot.nc"),
        ("lint", "slot.nc", "--junit", "x" * 300),
        ("lint", "slot.nc", "--baseline", "x" * 300),
        ("lint", "slot.nc", "--write-baseline", "x" * 300),
        ("lint", "slot.nc", "--tools", "x" * 300),
        ("lint", "slot.nc", "--subs", "x" * 300),
        ("canon", "slot.nc", "--write-parameters", "x" * 300),
        ("run", "slot.nc", "--cell", "cell.yaml", "--allow-path", "x" * 300),
    ],
    ids=lambda command: " ".join(word[:20] for word in command),
)
def test_a_name_that_is_too_long_is_told(cli, command: tuple[str, ...]) -> None:
    assert cli("run", "slot.nc", "--cell", "cell.yaml").status == 0
    done = cli(*command)
    if "--allow-path" in command:
        assert done.status == 0
        return
    assert done.status == 2, done.err
    assert done.err.count("\n") == 1 and os.strerror(errno.ENAMETOOLONG) in done.err


def test_what_failed_is_told_by_its_name(cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A disk that is full when the results are written, when the log is complete already."""

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("gcodesim.material.stl.write_stl", full)
    done = cli("run", "slot.nc", "--cell", "cell.yaml")
    assert done.status == 2
    assert done.err == (
        "gcodesim: out/stock.stl cannot be written: No space left on device; out/run.mcap is complete, files beside it "
        "are missing\n"
    )


def test_accept_accepts_also_when_nobody_reads_what(cli, tmp_path: Path) -> None:
    done = _gcodesim("accept", "slot.nc", "--cell", "cell.yaml", cwd=tmp_path, redirected="| true")
    assert "Traceback" not in done.stderr
    begin = time.monotonic()
    while not list(tmp_path.glob("**/*.golden.json")) and time.monotonic() - begin < 600:
        time.sleep(0.02)  # the shell waits for the reader only
    assert list(tmp_path.glob("**/*.golden.json"))


def test_a_program_that_cannot_be_read_is_no_fault_of_ours(cli, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.nc")
    done = cli("test", "pipe.nc", "slot.nc", "--cell", "cell.yaml")
    assert done.status == 1 and "Traceback" not in done.err
    assert "GS612" in done.out and "pipe.nc cannot be read: it is no regular file" in done.out


@pytest.mark.parametrize("option", ["--junit", "--sarif"])
def test_a_device_may_be_named_for_writing(cli, tmp_path: Path, option: str) -> None:
    done = _gcodesim(
        "check", "slot.nc", "--cell", "cell.yaml", option, "/dev/stdout", cwd=tmp_path, redirected="| cat > got"
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "got").read_text()

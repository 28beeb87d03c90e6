"""A disk on which nothing more can be written: every command says which file it was, and leaves none that is cut off.

A limit on the size of files does what a full disk does, at the same calls of the system, and needs no rights.
"""

from __future__ import annotations

import errno
import os
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

LOG = "good/run.mcap"
COMMANDS = {
    "run": (("run", "slot.nc", "--cell", "cell.yaml"), "out/run.mcap"),
    "report": (("report", "good", "-o", "r.html"), "r.html"),
    "plot": (("plot", "good", "-o", "p.svg"), "p.svg"),
    **{
        f"export {to}": (("export", LOG, "--to", to, "-o", "x"), "x")
        for to in ("csv", "jsonl", "glb", "stl", "rosbag2")
    },
    "init": (("init", "demo"), "demo"),
    "init --from": (("init", "demo", "--from", "slot.nc"), "demo"),
    "accept": (("accept", "slot.test.yaml"), "slot.golden.json"),
    "junit": (("lint", "slot.nc", "--junit", "j.xml"), "j.xml"),
    "sarif": (("lint", "slot.nc", "--sarif", "s.json"), "s.json"),
    "gitlab": (("lint", "slot.nc", "--gitlab", "g.json"), "g.json"),
    "baseline": (("lint", "slot.nc", "--write-baseline", "b.json"), "b.json"),
    "test": (("test", "slot.test.yaml", "--junit", "j.xml"), "j.xml"),
}


@contextmanager
def full_disk() -> Iterator[None]:
    """No file can grow in here."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("name", COMMANDS)
def test_the_file_that_could_not_be_written_is_named(cli, write, tmp_path: Path, name: str) -> None:
    write("slot.test.yaml", "cell: cell.yaml\n")
    assert cli("run", "slot.nc", "--cell", "cell.yaml", "--out", "good").status == 0
    before = {path for path in tmp_path.rglob("*") if path.is_file()}
    command, file = COMMANDS[name]
    with full_disk():
        done = cli(*command)
    assert done.status == 2, done.err
    last = done.err.splitlines()[-1]
    assert last.startswith("gcodesim: ") and file in last and os.strerror(errno.EFBIG) in last
    assert "Traceback" not in done.err and "1 accepted" not in done.out
    left = {
        path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file() and path not in before
    }
    assert left <= {"out/run.mcap.part"}


def test_accepted_as_json_is_what_has_been_written(cli, write, tmp_path: Path) -> None:
    write("slot.test.yaml", "cell: cell.yaml\n")
    with full_disk():
        done = cli("accept", "slot.test.yaml", "--format", "json")
    assert done.status == 2 and done.out == ""
    assert cli("accept", "slot.test.yaml", "--format", "json").json["cases"][0]["accepted"]


def test_a_fault_without_a_file_is_not_blamed_on_the_output(cli, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object, **__: object) -> None:
        raise FileNotFoundError(errno.ENOENT, "No usable temporary directory found")

    monkeypatch.setattr("gcodesim.cli.commands.lint.run", none)
    done = cli("lint", "slot.nc")
    assert (done.status, done.err) == (2, "gcodesim: No usable temporary directory found\n")

"""The promised exit statuses, and which stream says what."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

from gcodesim.files import whole_file

SLOT = ("slot.nc", "--cell", "cell.yaml")
WRONG = "G21 G90\nT1 M6\nG1 X5 Y\nM2\n"


def test_clean_run_ends_with_0(cli, tmp_path: Path) -> None:
    done = cli("run", *SLOT)

    assert done.status == 0, done.out + done.err
    assert "no errors, no warnings" in done.out
    assert "words not simulated" in done.out
    for name in ("run.mcap", "results.json", "lines.csv", "stock.stl", "stock.stock"):
        assert (tmp_path / "out" / name).stat().st_size and name in done.out
    assert not list((tmp_path / "out").glob("*.part"))
    assert "peak memory" in done.err and "peak memory" not in done.out
    assert "\033[" not in done.out + done.err


@pytest.mark.parametrize("command", ["run", "check", "lint", "canon"])
def test_findings_end_with_1(cli, write, command: str) -> None:
    write("bad.nc", WRONG)
    done = cli(command, "bad.nc", "--cell", "cell.yaml")

    assert done.status == 1
    assert "bad.nc:3:7: error GS004: Y has no number" in done.out
    assert "  3 | G1 X5 Y\n    |       ^\n" in done.out
    assert "Traceback" not in done.err


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        ("nonsense",),
        ("run", "slot.nc"),
        ("run", "slot.nc", "--cell", "cell.yaml", "--format", "yaml"),
        ("run", "absent.nc", "--cell", "cell.yaml"),
        ("run", "slot.nc", "--cell", "absent.yaml"),
        ("check", "slot.nc", "--cell", "absent.yaml"),
        ("check", ".", "--cell", "cell.yaml"),
        ("lint", "absent.nc"),
        ("canon", "absent.nc"),
        ("canon", "slot.nc", "--dialect", "klingon"),
        ("canon", "slot.nc", "--tools", "absent.tbl"),
        ("canon", "slot.nc", "--subs", "absent"),
        ("cell", "validate", "absent.yaml"),
        ("cell", "show", "absent.yaml"),
        ("info", "absent.mcap"),
        ("info", "slot.nc"),
        ("explain", "GS999"),
        ("explain", "rubbish"),
        ("list", "rubbish"),
        ("run", "slot.nc", "--cell", "cell.yaml", "--out", "slot.nc"),
    ],
    ids=lambda arguments: " ".join(arguments) or "nothing",
)
def test_wrong_usage_ends_with_2(cli, arguments: tuple[str, ...]) -> None:
    done = cli(*arguments)

    assert done.status == 2
    assert not done.out
    assert done.err and "Traceback" not in done.err


def test_a_fault_of_ours_ends_with_70(cli, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("a fault")

    monkeypatch.setattr("gcodesim.cli.simulate.check", broken)
    done = cli("check", *SLOT)

    assert done.status == 70
    assert not done.out
    assert "fault of gcodesim" in done.err and "Please report" in done.err and "ZeroDivisionError" in done.err


def test_an_interrupt_ends_with_130(cli, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("gcodesim.cli.simulate.check", interrupted)

    assert cli("check", *SLOT).status == 130


def test_fail_on_moves_the_border(cli, write) -> None:
    write("spindle_on.nc", "G21 G90\nT1 M6\nG43 H1\nS8000 M3\nG0 Z20\nM8\nM2\n")
    arguments = ("check", "spindle_on.nc", "--cell", "cell.yaml", "--fail-on")

    assert cli(*arguments, "error").status == 0
    assert cli(*arguments, "note").status == 1
    write("bad.nc", WRONG)
    done = cli("check", "bad.nc", "--cell", "cell.yaml", "--fail-on", "never", "--format", "json")
    assert done.status == 0
    assert done.json["status"] == "failed" and done.json["stopped_at"] == {"file": "bad.nc", "line": 3}


def test_a_full_disk_leaves_no_half_file(cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The disk takes the log's beginning, but no result: nothing that is not whole has a final name."""

    def full(path: Path, **how: object) -> object:
        if path.name.startswith(("results.json", "lines.csv", "stock")):
            raise OSError(errno.ENOSPC, "No space left on device")
        return new_file(path, **how)

    new_file = whole_file.new_file
    monkeypatch.setattr(whole_file, "new_file", full)
    done = cli("run", *SLOT)

    assert done.status == 2
    assert "cannot be written: No space left on device" in done.err and "Traceback" not in done.err
    left = {path.name for path in (tmp_path / "out").iterdir() if not path.name.endswith(".part")}
    assert left <= {"run.mcap"}
    if "run.mcap" in left:
        assert cli("info", "out/run.mcap").out.startswith("out/run.mcap: finished")


def test_a_full_disk_in_the_log(cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from gcodesim.log import LogWriteError, LogWriter

    def full(*_: object, **__: object) -> None:
        raise LogWriteError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(LogWriter, "close", full)
    done = cli("run", *SLOT)

    assert done.status == 2 and "No space left on device" in done.err
    assert [p.name for p in (tmp_path / "out").iterdir() if not p.name.endswith(".part")] == []


def test_a_cell_with_errors_leaves_results_and_nothing_old(cli, write, tmp_path: Path) -> None:
    assert cli("run", *SLOT).status == 0
    write("cell.yaml", (tmp_path / "cell.yaml").read_text().replace("tools:", "tols:"))
    done = cli("run", *SLOT)

    assert done.status == 1
    assert "did you mean `tools`" in done.out and "nothing was simulated" in done.out
    assert not (tmp_path / "out" / "run.mcap").exists()
    assert '"status": "failed"' in (tmp_path / "out" / "results.json").read_text()

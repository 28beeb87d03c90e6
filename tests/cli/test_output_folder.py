"""Files that a command writes: none that it reads, none of the user's, none of another run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import gcodesim
from gcodesim.files.output_folder import FolderInUseError, claimed

MESH = Path(__file__).parents[2] / "gcodesim" / "data" / "examples" / "wedge.stl"
CELL = """gcodesim: 1
machine: gantry_xyz
stock: {{{stock}, resolution: 1}}
tools:
  1: {{type: flat_end_mill, diameter: 6 mm}}
simulation: {{world: kinematic}}
"""
RUN = ("run", "slot.nc", "--cell", "cell.yaml")


def _files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_the_mesh_of_a_stock_is_not_overwritten(cli, write, tmp_path: Path) -> None:
    write("cell.yaml", CELL.format(stock="mesh: stock.stl, unit: mm"))
    write("stock.stl", MESH.read_bytes())
    before = _files(tmp_path)
    done = cli(*RUN, "--out", ".")
    assert done.status == 1 and "error GS750" in done.out and "`stock.stl`" in done.out and "--force" in done.out
    assert _files(tmp_path) == before
    results = gcodesim.simulate("slot.nc", "cell.yaml", ".")
    assert results.status == "failed" and "GS750" in [finding.code for finding in results.findings]
    assert _files(tmp_path) == before

    assert "GS750" not in cli(*RUN, "--out", ".", "--force").out
    assert (tmp_path / "stock.stl").read_bytes() != before["stock.stl"] and (tmp_path / "run.mcap").exists()


def test_an_input_is_known_under_any_name(cli, write, tmp_path: Path) -> None:
    """Through a link of a folder, a link of a file, and a hard link."""
    write("cell.yaml", CELL.format(stock="mesh: own.stl, unit: mm"))
    write("own.stl", MESH.read_bytes())
    for link in (os.link, os.symlink):
        (tmp_path / "out").mkdir(exist_ok=True)
        link(tmp_path / "own.stl", tmp_path / "out" / "stock.stl")
        assert "which it reads" in cli(*RUN).out
        (tmp_path / "out" / "stock.stl").unlink()
    (tmp_path / "folder").symlink_to(tmp_path)
    write("cell.yaml", CELL.format(stock="mesh: stock.stl, unit: mm"))
    (tmp_path / "own.stl").rename(tmp_path / "stock.stl")
    assert "which it reads" in cli(*RUN, "--out", str(Path("..", tmp_path.name))).out


@pytest.mark.parametrize("out", ["out", "link/out", "{here}/out"])
def test_a_folder_behind_a_link_is_not_written_to(cli, tmp_path: Path, out: str) -> None:
    """A repository of somebody else may have one where the run writes by default."""
    (tmp_path / "elsewhere" / "out").mkdir(parents=True)
    (tmp_path / "link").symlink_to("elsewhere")
    (tmp_path / "out").symlink_to("elsewhere/out")
    done = cli(*RUN, "--out", out.format(here=tmp_path))
    assert done.status == 2 and "is a link" in done.err and "--force" in done.err
    assert list((tmp_path / "elsewhere" / "out").iterdir()) == []
    assert cli(*RUN, "--out", out.format(here=tmp_path), "--force").status == 0
    assert (tmp_path / "elsewhere" / "out" / "run.mcap").exists()


@pytest.mark.parametrize("how", ["suppress: [{code: GS750, reason: quiet}]", "checks: {GS750: note}", "baseline"])
def test_a_refused_run_is_never_a_good_one(cli, write, tmp_path: Path, how: str) -> None:
    """Whatever the cell or a baseline says about the finding."""
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "results.json").write_text("mine")
    options: tuple[str, ...] = ()
    if how == "baseline":
        cli(*RUN, "--write-baseline", "known.json")
        options = ("--baseline", "known.json") if (tmp_path / "known.json").exists() else ()
    else:
        write("cell.yaml", (tmp_path / "cell.yaml").read_text() + how + "\n")
    done = cli(*RUN, *options)
    assert done.status == 1 and "error GS750" in done.out and "nothing was simulated" in done.out
    assert (tmp_path / "out" / "results.json").read_text() == "mine"


def test_a_run_does_not_replace_the_stock_it_goes_on_from(cli, write, tmp_path: Path) -> None:
    assert cli(*RUN, "--out", "chain").status == 0
    write("next.yaml", CELL.format(stock="from: chain").replace(", resolution: 1", ""))
    before = _files(tmp_path / "chain")
    done = cli("run", "slot.nc", "--cell", "next.yaml", "--out", "chain")
    assert done.status == 1 and "`stock.stock` in the output folder, which it reads" in done.out
    assert _files(tmp_path / "chain") == before
    assert cli("run", "slot.nc", "--cell", "next.yaml", "--out", "other").status == 0
    assert cli("run", "slot.nc", "--cell", "next.yaml", "--out", "chain", "--force").status == 0


@pytest.mark.parametrize(
    "name", ["run.mcap", "results.json", "lines.csv", "stock.stl", "stock.stock", "stock.stl.part"]
)
def test_a_file_of_the_user_is_not_overwritten(cli, tmp_path: Path, name: str) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).write_bytes(b"mine: months of work")
    done = cli(*RUN)
    assert done.status == 1 and f"`{name}` in the output folder, which gcodesim did not write" in done.out
    assert _files(tmp_path / "out") == {name: b"mine: months of work"}
    assert cli(*RUN, "--force").status == 0


def test_what_an_earlier_run_left_is_overwritten(cli, tmp_path: Path) -> None:
    assert cli(*RUN).status == 0
    first = _files(tmp_path / "out")
    for name, data in first.items():  # as a run leaves it that is killed
        (tmp_path / "out" / f"{name}.part").write_bytes(data[: len(data) // 2])
    (tmp_path / "out" / "stock.stl.part").write_bytes(b"")
    (tmp_path / "out" / "notes.txt").write_text("mine")
    assert cli(*RUN).status == 0
    assert _files(tmp_path / "out") == {**first, "notes.txt": b"mine"}


def test_a_second_run_into_a_folder_is_refused_while_the_first_lives(cli, tmp_path: Path) -> None:
    with claimed(tmp_path / "out"):
        done = cli(*RUN)
        assert done.status == 1 and "error GS751" in done.out
        assert not list((tmp_path / "out").iterdir())
        assert cli(*RUN, "--force").status == 1  # the files of both would be mixed
        assert cli(*RUN, "--out", "other").status == 0
    assert cli(*RUN).status == 0
    with claimed(tmp_path / "out"), pytest.raises(FolderInUseError), claimed(tmp_path / "out"):
        pass


def test_a_claim_ends_with_the_process_that_is_killed(cli, tmp_path: Path) -> None:
    script = (
        "import pathlib, time\nfrom gcodesim.files.output_folder import claimed\n"
        "with claimed(pathlib.Path('out')):\n    print('held', flush=True)\n    time.sleep(600)\n"
    )
    with subprocess.Popen([sys.executable, "-c", script], cwd=tmp_path, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None and holder.stdout.readline() == "held\n"
        assert "GS751" in cli(*RUN).out
        holder.send_signal(signal.SIGKILL)
        holder.wait()
        begin = time.monotonic()
        while (status := cli(*RUN).status) != 0 and time.monotonic() - begin < 600:
            time.sleep(0.01)
        assert status == 0


@pytest.mark.parametrize(
    ("target", "command"),
    [
        ("slot.nc", ("lint", "slot.nc", "--junit", "slot.nc")),
        ("slot.nc", ("lint", "slot.nc", "--write-baseline", "slot.nc")),
        ("slot.nc", ("canon", "slot.nc", "--write-parameters", "slot.nc")),
        ("cell.yaml", ("check", "slot.nc", "--cell", "cell.yaml", "--sarif", "cell.yaml")),
        ("cell.yaml", (*RUN, "--gitlab", "cell.yaml")),
        ("out/run.mcap", ("report", "out", "-o", "out/run.mcap")),
        ("out/run.mcap", ("report", "out/run.mcap", "-o", "out/run.mcap")),
        ("out/results.json", ("plot", "out", "-o", "out/results.json")),
        ("out/run.mcap", ("export", "out", "--to", "csv", "-o", "out/run.mcap")),
        ("out/stock.stl", ("export", "out", "--to", "stl", "-o", "out/stock.stl")),
        ("out/run.mcap", ("diff", "out", "out", "--html", "out/run.mcap")),
        ("slot.svg", ("plot", "out")),
        ("slot.stl", ("export", "out", "--to", "stl")),
        ("slot.glb", ("export", "out", "--to", "glb")),
        ("report.html", ("report", "out")),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else value,
)
def test_no_command_writes_over_what_it_reads_or_what_nobody_named(
    cli, write, tmp_path: Path, target: str, command: tuple[str, ...]
) -> None:
    assert cli(*RUN).status == 0
    if not (tmp_path / target).exists():
        write(target, "a drawing of mine")
    before = (tmp_path / target).read_bytes()
    done = cli(*command)
    assert done.status == 2, done.out + done.err
    assert (tmp_path / target).read_bytes() == before


@pytest.mark.parametrize(
    "command", [("plot", "out"), ("export", "out", "--to", "stl"), ("export", "out", "--to", "glb"), ("report", "out")]
)
def test_what_a_command_wrote_itself_it_writes_again(cli, command: tuple[str, ...]) -> None:
    assert cli(*RUN).status == 0
    assert [cli(*command).status for _ in range(2)] == [0, 0]

"""`gcodesim watch`: what is done again, by strokes that come while it waits."""

import os
import signal
import subprocess
import sys

import pytest

from gcodesim.cli.commands import watch
from gcodesim.cli.parser import build_parser


def tasks(*words):
    arguments = build_parser(["watch"]).parse_args(["watch", *map(str, words)])
    return [watch.WatchedPath(path, arguments) for path in arguments.paths]


def acts(given, strokes):
    """The tasks that are done, when each stroke happens in one wait."""
    done = []
    left = iter(strokes)

    def wait():
        try:
            stroke = next(left)
        except StopIteration:
            raise KeyboardInterrupt from None
        if stroke is not None:
            stroke()

    with pytest.raises(KeyboardInterrupt):
        watch.watch(given, wait, lambda task: done.append(task.path.name))
    return done


def test_only_what_changed_is_done_again(cli, write):
    one = write("one.nc", "G0 X1\nM2\n")
    two = one.parent / "two" / "two.nc"
    two.parent.mkdir()
    two.write_text("M2\n")
    given = tasks(one, two)

    assert acts(given, [None, lambda: two.write_text("M30\n"), None, None]) == ["one.nc", "two.nc", "two.nc"]


def test_several_strokes_in_a_row_are_one_change(cli, write):
    one = write("one.nc", "M2\n")
    strokes = [lambda text=text: one.write_text(text) for text in ("G\nM2\n", "G1\nM2\n", "G1 X\nM2\n")]

    assert acts(tasks(one), [*strokes, None, None]) == ["one.nc", "one.nc"]


def test_a_cell_and_its_files_are_watched(cli, write, tmp_path):
    write("tools.tbl", "T1 P1 D6 Z50\n")
    cell = write("mill.yaml", "gcodesim: 1\nmachine: gantry_xyz\ntool_table: tools.tbl\n")
    given = tasks(write("one.nc", "M2\n"), "--cell", cell)

    assert given[0].command[:4] == ["check", str(tmp_path / "one.nc"), "--cell", str(cell)]
    assert len(acts(given, [lambda: cell.write_text(cell.read_text() + "\n"), None])) == 2
    assert len(acts(given, [lambda: (tmp_path / "tools.tbl").write_text("T1 P1 D8 Z50\n"), None])) == 2


def test_results_are_no_inputs(cli, tmp_path, write):
    out = tmp_path / "suite" / "out"
    out.mkdir(parents=True)
    (tmp_path / "suite" / "a.nc").write_text("M2\n")
    (out / "results.json").write_text("{}")
    (out / "cell.yaml").write_text("gcodesim: 1\n")
    (task,) = tasks(tmp_path / "suite")

    assert task.command == ["test", str(tmp_path / "suite"), "--changed"]
    assert acts([task], [lambda: (out / "cell.yaml").write_text("x: 1\n"), None]) == ["suite"]


def test_a_case_that_is_new_is_tested_and_a_folder_may_go_and_come(cli, tmp_path):
    suite = tmp_path / "suite"
    suite.mkdir()
    (suite / "a.nc").write_text("M2\n")
    given = tasks(suite)

    assert acts(given, [lambda: (suite / "b.nc").write_text("M2\n"), None]) == ["suite", "suite"]

    gone = tmp_path / "elsewhere"
    strokes = [lambda: suite.rename(gone), None, None, lambda: gone.rename(suite), None, None]
    assert acts(given, strokes) == ["suite"] * 3


def test_a_subprogram_that_comes_or_goes(cli, write, tmp_path):
    sub = tmp_path / "sub.ngc"
    (task,) = tasks(write("one.nc", "o<sub> call\nM2\n"))

    assert acts([task], [lambda: sub.write_text("M2\n"), None, sub.unlink, None, None, None]) == ["one.nc"] * 3


def test_an_editor_that_saves_by_rename(cli, write, tmp_path):
    one, new = write("one.nc", "G0 X1\nM2\n"), tmp_path / "one.nc~"

    def save():
        one.rename(tmp_path / "one.bak")
        new.write_text("G0 X2\nM2\n")

    strokes = [save, lambda: new.rename(one), None, None]
    assert acts(tasks(one), strokes) == ["one.nc", "one.nc"]


def test_options_go_on(cli, tmp_path):
    (task,) = tasks("slot.nc", "--cell", "cell.yaml", "--do", "run", "--with=--only shape")

    assert task.command == ["run", "slot.nc", "--cell", "cell.yaml", "--only", "shape"]


def test_wrong_usage(cli):
    assert cli("watch", "absent.nc").status == 2
    assert cli("watch", "-").status == 2
    assert cli("watch", "slot.nc", "--cell", "absent.yaml").status == 2
    assert cli("watch", "slot.nc", "--every", "0").status == 2


def test_an_interrupt_ends_it(cli, tmp_path):
    command = [sys.executable, "-m", "gcodesim", "watch", "slot.nc"]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # tests may run in the background
    )
    try:
        for line in process.stderr:
            if "waiting" in line:
                break
        os.kill(process.pid, signal.SIGINT)
        said, told = process.communicate(timeout=600)
    finally:
        process.kill()

    assert process.returncode == 130
    assert "slot.nc: no errors" in said
    assert told == "gcodesim: interrupted\n"

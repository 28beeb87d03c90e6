"""A study made ready: what travels, and what must not."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.scale.hands import Alone
from gcodesim.sweep.design import points
from gcodesim.sweep.one import run_one
from gcodesim.sweep.prepared import Allowed, prepared
from gcodesim.sweep.study_file import read_study

CELL = "machine: gantry_xyz\nstock: {box: [20, 20, 8], material: al6082_t6, resolution: 1}\n"


@pytest.fixture
def ready(tmp_path: Path):
    """Read and prepare a study beside a program, a cell in another folder, and two tool tables."""
    (tmp_path / "cells").mkdir()
    (tmp_path / "a.ngc").write_text("O<sub> CALL\nM2\n")
    (tmp_path / "sub.ngc").write_text("O<sub> SUB\nO<sub> ENDSUB\n")
    (tmp_path / "other.ngc").write_text("M2\n")
    (tmp_path / "cells" / "c.yaml").write_text(CELL)
    for name in ("one.tbl", "two.tbl"):
        (tmp_path / name).write_text("T1 P1 D6\n")

    def ready(text: str, cell: str = CELL):
        (tmp_path / "cells" / "c.yaml").write_text(cell)
        path = tmp_path / "study.yaml"
        path.write_text("program: a.ngc\ncell: cells/c.yaml\n" + text)
        file = read_study(SourceText.read(path), path)
        assert file.study is not None, list(file.findings)
        return prepared(file, file.study, Allowed(paths=[tmp_path]))

    return ready


def test_all_files_that_a_value_may_name_travel_and_no_others(ready):
    done, found = ready("vary: {tool_table: [one.tbl, two.tbl]}\n")

    assert not found
    assert set(done.inputs.bundle.files) == {"a.ngc", "sub.ngc", "cells/c.yaml", "one.tbl", "two.tbl"}


def test_the_key_of_a_run_follows_from_what_decides_it(ready, tmp_path: Path):
    def keys(text: str, cell: str = CELL) -> list[str]:
        done, _ = ready(text, cell)
        return [done.task(point).key for point in points(done.study)]

    text = "vary: {n: {parameter: 5, values: [1, 2]}}\n"
    before = keys(text)

    assert len(set(before)) == 2
    assert keys("\n# moved\nfail: time > 3 s\n" + text) == before
    assert keys("vary: {n: {parameter: 5, from: 1, to: 2, steps: 2}}\n") == before
    assert not set(keys("vary: {n: {parameter: 6, values: [1, 2]}}\n")) & set(before)
    assert not set(keys(text, CELL.replace("20, 20", "20, 21"))) & set(before)
    (tmp_path / "other.ngc").write_text("G0 X1\nM2\n")
    assert keys(text) == before
    (tmp_path / "sub.ngc").write_text("O<sub> SUB\nG0 X1\nO<sub> ENDSUB\n")
    assert not set(keys(text)) & set(before)


def test_a_run_needs_nothing_but_what_travels(ready, tmp_path: Path):
    done, _ = ready("vary: {tool_table: [one.tbl, two.tbl]}\n")
    tasks = [done.task(point) for point in points(done.study)]
    for path in tmp_path.rglob("*.*"):
        path.unlink()

    ends = list(Alone().do(run_one, tasks))

    assert [end.fault for end in ends] == ["", ""]
    assert [end.made.said["status"] for end in ends] == ["ok", "ok"]
    assert len({end.made.said["results_sha256"] for end in ends}) == 2


def test_an_absolute_name_is_told_before_anything_runs(ready, tmp_path: Path):
    done, found = ready("vary: {simulation.seed: [1]}\n", CELL + f"tool_table: {tmp_path / 'one.tbl'}\n")

    assert done is None
    assert [(one.code, one.span.file, one.span.line) for one in found] == [("GS631", "study.yaml", 2)]


def test_a_path_through_a_word_or_a_list_is_told(ready):
    done, found = ready("vary: {machine.axes.X: [1], stock.box.7: [2 mm]}\n")

    assert done is None
    assert sorted(one.code for one in found) == ["GS704", "GS706"]

"""Set-ups one after the other: what is handed on, what need not run again, what later ones find missing."""

from pathlib import Path

import pytest
import trimesh

from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.setups.results import setups_as_json
from gcodesim.setups.running import How, run_setups
from gcodesim.setups.setup_file import read_job_file

CELL = """gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {xyz: [200, 200, -200]}}
tools: {1: {type: drill, diameter: 6, length: 60}}
simulation: {world: kinematic}
"""
DRILL = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS3000 M3\nG0 X10 Y8 Z5\nG1 Z-12 F250\nG0 Z20\nM5\nM2\n"
JOB = """gcodesim-job: 1
setups:
  top:
    program: drill.nc
    cell: cell.yaml
    stock: {box: [24, 20, 16], zero: top-front-left, in: G54, material: al6082_t6, resolution: 0.25}
  bottom:
    program: below.nc
    cell: cell.yaml
    stock: {from: top, in: G54, xyz: [0, 20, -16], rpy: [180, 0, 0]}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A plate that is drilled from both sides at one place: turned over about X, Y8 is Y12."""
    for name, text in (("cell.yaml", CELL), ("drill.nc", DRILL), ("below.nc", DRILL.replace("Y8", "Y12"))):
        (tmp_path / name).write_text(text)
    (tmp_path / "job.yaml").write_text(JOB)
    return tmp_path


def ran(folder: Path, out: str | None = "out", **how):
    path = folder / "job.yaml"
    job = read_job_file(SourceText.read(path), path)
    assert job.setups is not None, list(job.findings)
    return list(run_setups(job, How(options=Options(), out=None if out is None else folder / out, **how)))


def test_a_hole_from_both_sides_is_through(folder):
    top, bottom = ran(folder)

    first, second = (one.results["stocks"]["stock"] for one in (top, bottom))
    bound = first["error_bound_mm3"] + second["error_bound_mm3"]
    assert second["initial_mm3"] == pytest.approx(first["remaining_mm3"], abs=bound)
    assert not {finding.code for finding in bottom.findings} & {"GS410"}
    assert [trimesh.load(one.folder / "stock.stl").euler_number for one in (top, bottom)] == [2, 0]  # 0: a ring
    # two cones of 118 degrees overlap; a whole cylinder of 6 mm is gone
    assert 48e3 / 6.25 - second["remaining_mm3"] == pytest.approx(9 * 3.14159 * 16, rel=0.02)


def test_files_or_none_give_the_same(folder):
    with_files, without = ran(folder), ran(folder, out=None)

    assert [one.results["stocks"] for one in with_files] == [one.results["stocks"] for one in without]
    assert setups_as_json(with_files)["setups"]["top"]["time"] == without[0].results["time"]


def test_what_did_not_change_does_not_run_again(folder):
    before = ran(folder)
    again = ran(folder)

    assert [one.state for one in before] == ["ran", "ran"]
    assert [one.state for one in again] == ["unchanged", "unchanged"]
    assert setups_as_json(again) == setups_as_json(before)
    assert [list(map(str, one.findings)) for one in again] == [list(map(str, one.findings)) for one in before]


@pytest.mark.parametrize(
    ("file", "old", "new", "wanted"),
    [
        ("below.nc", "Z-12", "Z-11", ["unchanged", "ran"]),
        ("drill.nc", "Z-12", "Z-11", ["ran", "ran"]),  # the second gets another stock
        ("drill.nc", "(", "(", ["unchanged", "unchanged"]),
        ("cell.yaml", "6,", "7,", ["ran", "ran"]),
        ("job.yaml", "-16]", "-16.5]", ["unchanged", "ran"]),
        ("out/top/results.json", "findings", "finding", ["ran", "unchanged"]),  # it leaves the same stock again
        ("out/bottom/stock.stock", None, None, ["unchanged", "ran"]),
    ],
)
def test_what_changed_runs_again_and_what_depends_on_it(folder, file, old, new, wanted):
    ran(folder)
    path = folder / file
    if old is None:
        path.write_bytes(path.read_bytes()[:-1])
    else:
        path.write_text(path.read_text().replace(old, new))

    assert [one.state for one in ran(folder)] == wanted


def test_a_set_up_that_is_left_out_leaves_no_stock(folder):
    path = folder / "job.yaml"
    ran(folder)
    path.write_text(path.read_text().replace("  top:\n", "  top:\n    skip: true\n"))

    (bottom,) = ran(folder)

    assert bottom.setup.name == "bottom" and bottom.results["status"] == "failed"
    (fault,) = [finding for finding in bottom.findings if finding.code == "GS410"]
    assert "`top`" in fault.message and (fault.span.file, fault.span.line) == ("job.yaml", 11)


def test_a_check_hands_on_the_uncut_stock(folder):
    top, bottom = ran(folder, only_check=True)

    assert not (folder / "out").exists()
    assert "GS919" in [finding.code for finding in bottom.findings]
    assert top.results["status"] == bottom.results["status"] == "ok"


def test_files_named_by_the_job_are_seen_from_it(folder):
    """The cell lies in another folder; a mesh that the job names lies beside the job."""
    inner = folder / "cells"
    inner.mkdir()
    (folder / "cell.yaml").rename(inner / "cell.yaml")
    trimesh.creation.box((0.5, 0.5, 0.5)).export(folder / "clamp.stl")
    path = folder / "job.yaml"
    clamp = "    fixtures: {clamp: {mesh: clamp.stl, unit: mm, in: G54, xyz: [-9, 0, 0]}}\n"
    path.write_text(path.read_text().replace("cell.yaml", "cells/cell.yaml") + clamp)

    top, bottom = ran(folder)

    assert list(bottom.loaded.cell.fixtures) == ["clamp"] and not top.loaded.cell.fixtures
    assert [file["name"] for file in bottom.results["inputs"]["files"]] == [
        "../clamp.stl",
        "job.yaml#bottom",
        "top/stock.stock",
    ]


def test_a_file_of_a_stranger_is_not_overwritten(folder):
    (folder / "out/top").mkdir(parents=True)
    (folder / "out/top/setup.json").write_text("mine")

    top, bottom = ran(folder)

    assert [finding.code for finding in top.findings if finding.code == "GS750"] and not top.simulated
    assert (folder / "out/top/setup.json").read_text() == "mine"
    assert [finding.code for finding in bottom.findings] == ["GS410"]

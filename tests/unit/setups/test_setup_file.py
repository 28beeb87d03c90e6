"""What a job file may say, and what is wrong with one, with places."""

from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.setups.setup_file import read_job_file


@pytest.fixture
def read(tmp_path: Path):
    """Read a job file in a folder that has two programs and a cell."""
    for name in ("a.nc", "b.nc", "cell.yaml"):
        (tmp_path / name).write_text("")

    def read(text: str):
        path = tmp_path / "job.yaml"
        path.write_text(text)
        return read_job_file(SourceText.read(path), path)

    return read


def told(job):
    return [(finding.code, finding.span.line, finding.span.column) for finding in job.findings]


def test_set_ups_stand_in_the_order_of_the_file(read, tmp_path):
    job = read(
        "setups:\n  zoe: {program: b.nc, cell: cell.yaml}\n"
        "  anna: {program: a.nc, cell: cell.yaml, skip: true, stock: {from: zoe}, target: {mesh: t.stl}}\n"
    )

    first, second = job.setups
    assert (first.name, first.program, first.skip, first.entries) == ("zoe", tmp_path / "b.nc", False, ())
    assert second.skip and [name.text for name, _ in second.entries] == ["stock", "target"]
    assert len(job.findings) == 0


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("setups: {}\n", [("GS705", 1, 1)]),
        ("setups: {top: {program: a.nc}}\n", [("GS705", 1, 10)]),
        ("setups: {top: {program: c.nc, cell: cell.yaml}}\n", [("GS714", 1, 25)]),
        ("setups: {top: {program: a.nc, cell: cell.yaml, stok: {box: [1, 1, 1]}}}\n", [("GS704", 1, 48)]),
        ("setups:\n  top: {program: a.nc, cell: cell.yaml, stock: {from: top}}\n", [("GS711", 2, 55)]),
        (
            "setups:\n  one: {program: a.nc, cell: cell.yaml, stock: {plate: {from: two}}}\n"
            "  two: {program: a.nc, cell: cell.yaml}\n",
            [("GS711", 2, 63)],
        ),
        ("setups: {top: {program: ../a.nc, cell: cell.yaml}}\n", [("GS715", 1, 25)]),
        ("machine: gantry_xyz\n", [("GS705", 1, 1)]),
        ("gcodesim-job: 2\nsetups: {top: {program: a.nc, cell: cell.yaml}}\n", [("GS711", 1, 15)]),
    ],
)
def test_faults_have_their_places(read, text, wanted):
    job = read(text)

    assert job.setups is None and told(job) == wanted


def test_a_misspelled_key_is_suggested(read):
    (finding,) = read("setups: {top: {program: a.nc, cell: cell.yaml, skipp: true}}\n").findings

    assert "did you mean `skip`" in finding.hint

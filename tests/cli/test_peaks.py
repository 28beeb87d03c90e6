"""One run, one greatest force: results, lines, log, table, charts, page and `info` name the same."""

from __future__ import annotations

import csv
import json
import re

import numpy as np
import pytest

from gcodesim.playback import Recording
from gcodesim.playback.quantities import charts_of
from gcodesim.report.pack import Pack
from gcodesim.report.page import run_data

from .conftest import CELL, HEAD

# the full depth is reached and left between two samples, whose distance is a second
PEAK = HEAD + "G0 X10 Y10\nG0 Z2\nG1 Z-1 F400\nG1 X30\nG1 Z-3 F800\nG1 X32 F1200\nG1 Z-0.5\nG1 X90\nG0 Z20\nM5\nM2\n"
RARE = CELL + "log: {period: 1 s}\n"


@pytest.fixture
def folder(cli, tmp_path):
    (tmp_path / "peak.nc").write_text(PEAK)
    (tmp_path / "rare.yaml").write_text(RARE)
    assert cli("run", "peak.nc", "--cell", "rare.yaml", "--out", "out").status == 0
    return tmp_path / "out"


@pytest.fixture
def known(folder):
    """The greatest force [N], torque [N·m] and power [W] of the results."""
    (tool,) = json.loads((folder / "results.json").read_text())["tools"]
    return tool["max_force_N"], tool["max_torque_Nm"], tool["max_power_W"]


def test_the_samples_alone_miss_it(folder, known):
    series = Recording.open(folder).series("/process")

    assert series.column("force_n").max() < 0.9 * known[0]


def test_table_and_charts_have_the_peaks_of_the_results(cli, folder, known):
    assert cli("export", "out", "--to", "csv", "--topics", "/process", "-o", "peak.csv").status == 0
    with (folder.parent / "peak.csv").open() as file:
        rows = list(csv.DictReader(file))
    for name, value in zip(("max_force_N", "max_torque_Nm", "max_power_W"), known, strict=True):
        assert max(float(row[f"process.{name}"]) for row in rows) == pytest.approx(value, rel=1e-8)
    for name, value in zip(("force", "torque", "power"), known, strict=True):
        (chart,) = charts_of(Recording.open(folder), [name])
        assert chart.curves[0].values.max() == pytest.approx(value, rel=1e-8)


def test_page_lines_and_times_have_them(cli, folder, known):
    page = run_data(Recording.open(folder), "peak", Pack())
    with (folder / "lines.csv").open() as file:
        lines = {int(row["line"]): float(row["max_force_N"]) for row in csv.DictReader(file)}

    assert {line["line"]: line["max_force_N"] for line in page["times"]["lines"] if line["max_force_N"]} == {
        line: force for line, force in lines.items() if force
    }
    assert max(lines.values()) == pytest.approx(known[0], rel=1e-5)
    assert page["times"]["tools"][0]["max_force_N"] == known[0]
    times = json.loads(cli("report", "out", "--times", "--format", "json").out)
    assert times["tools"][0]["max_power_W"] == known[2]


def test_a_log_alone_gives_no_line_the_force_of_another(folder):
    (folder / "lines.csv").rename(folder.parent / "lines.csv")
    with (folder.parent / "lines.csv").open() as file:
        lines = {int(row["line"]): float(row["max_force_N"]) for row in csv.DictReader(file)}
    page = run_data(Recording.open(folder / "run.mcap"), "peak", Pack())

    assert all(line["max_force_N"] <= lines.get(line["line"], 0.0) * 1.00001 for line in page["times"]["lines"])


def test_info_tells_them(cli, folder, known):
    told = json.loads(cli("info", "out", "--format", "json").out)["result"]

    assert [float(told[name]) for name in ("max_force_n", "max_torque_nm", "max_power_w")] == pytest.approx(known)
    assert re.search(rf"greatest force +{known[0]:.4g} N", cli("info", "out").out)


def test_peaks_do_not_depend_on_how_often_the_log_looks(cli, folder, known, tmp_path):
    (tmp_path / "often.yaml").write_text(CELL + "log: {period: 20 ms}\n")
    assert cli("run", "peak.nc", "--cell", "often.yaml", "--out", "often").status == 0
    often, rare = (Recording.open(tmp_path / name).series("/process") for name in ("often", "out"))

    for name in ("max_force_n", "max_torque_nm", "max_power_w"):
        every = np.searchsorted(rare.t_ns, often.t_ns)
        most = np.zeros(len(rare.t_ns))
        np.maximum.at(most, every, often.column(name))
        assert np.array_equal(most, rare.column(name))
        sampled = often.column(name.removeprefix("max_"))
        assert (often.column(name) >= sampled * (1.0 - 1e-12)).all()

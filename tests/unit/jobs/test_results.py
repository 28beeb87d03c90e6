"""Rows of `lines.csv`: which line they belong to, and how their numbers are written."""

import numpy as np
import pytest

from gcodesim.diagnostics import Span
from gcodesim.jobs.results import LineRows, line_rows
from gcodesim.motion.tool_path import ToolPath
from gcodesim.numbers import clean, rounded


def test_numbers_are_written_as_everywhere():
    rng = np.random.default_rng(5)
    values = np.concatenate(
        [
            rng.normal(size=2000) * 10.0 ** rng.integers(-12, 18, 2000),
            rng.integers(-(10**7), 10**7, 500).astype(float),
            [0.0, -0.0, 1e-4, 9.9999999e-5, 999999.5, 999999.49, 1e15, 1e16, 1e22, np.inf, -np.inf, np.nan],
        ]
    )
    numbers = np.tile(values[:, None], (1, 5))
    count = len(values)
    rows = LineRows(files=("a,b.nc",), file=np.zeros(count, int), line=np.arange(count), numbers=numbers)
    lines = rows.csv().splitlines()
    assert lines[0] == "file,line,time_s,distance_mm,feed_mm_min,removed_mm3,max_force_N"
    texts = [str(clean(rounded(value, 6))) for value in values.tolist()]
    assert lines[1:] == [",".join(['"a,b.nc"', str(i), *[text] * 5]) for i, text in enumerate(texts)]


@pytest.fixture
def path():
    """Lines 3, 4, 3, 4 of one file, as a loop runs them, and line 3 of another between."""
    path = ToolPath.from_points(np.arange(15.0).reshape(5, 3))
    spans = tuple(Span.of_line(name, line, "") for name, line in (("a.nc", 4), ("a.nc", 3), ("b.nc", 3)))
    path.source[:] = [1, 0, 2, 1]
    object.__setattr__(path, "spans", spans)
    return path


def test_passes_of_a_loop_are_added_up(path):
    time, way = np.array([1.0, 2.0, 4.0, 8.0]), np.array([0.1, 0.2, 0.4, 0.8])
    places = (0, "a.nc", 1, 0.5), (2, "a.nc", 4, 16.0), (4, "c.nc", 9, 3.0)
    rests = [(row, Span.of_line(name, line, ""), seconds) for row, name, line, seconds in places]
    rows = line_rows(path, time, way, None, rests)
    found = [(rows.files[file], line) for file, line in zip(rows.file, rows.line.tolist(), strict=True)]
    assert found == [("a.nc", 1), ("a.nc", 3), ("a.nc", 4), ("b.nc", 3), ("c.nc", 9)]
    assert rows.numbers[:, 0].tolist() == [0.5, 9.0, 18.0, 4.0, 3.0]
    assert rows.numbers[:, 1] == pytest.approx([0.0, 900.0, 200.0, 400.0, 0.0])
    assert rows.numbers[:, 2] == pytest.approx([0.0, 6000.0, 6000.0, 6000.0, 0.0])


def test_lines_that_were_not_reached_are_left_out(path):
    rows = line_rows(path, np.ones(4), np.ones(4), None, ran=2)
    assert rows.line.tolist() == [3, 4]
    assert line_rows(ToolPath.from_points(np.zeros((0, 3))), np.zeros(0), np.zeros(0), None).csv().count("\n") == 1

"""Columns in UTF-16 units and in code points."""

import pytest

from gcodesim.diagnostics import SourceText, Span
from gcodesim.editor.place import column_of, range_of, units_before

TEXT = "G1 (ä 🔩 x) X1"


@pytest.mark.parametrize(("column", "units"), [(0, 0), (5, 5), (6, 6), (7, 8), (10, 11), (13, 14)])
def test_columns_there_and_back(column, units):
    assert units_before(TEXT, column) == units
    assert column_of(TEXT, units) == column
    assert units_before(TEXT, column) == len(TEXT[:column].encode("utf-16-le")) // 2


def test_behind_the_end():
    assert column_of(TEXT, 99) == len(TEXT)
    assert column_of("G1", 99) == 2


def test_range_of_a_finding():
    source = SourceText("p.nc", b"G0\nG1 X\n")

    assert range_of(Span("p.nc", 2, 4, 2, 5), source) == (1, 3, 1, 4)
    assert range_of(Span("p.nc"), source) == (0, 0, 0, 2)

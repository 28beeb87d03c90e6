"""Rows of an edge stay from step to step where nothing has changed, and are laid anew where anything has."""

import numpy as np

from gcodesim.compiled import as_python
from gcodesim.processes.drill_point import edge_pieces
from gcodesim.processes.edge_kernels import COLUMNS, FROM, LEVER_COSINES, MORE_SINES, SLICES, TO, lay_rows
from gcodesim.processes.rim_kernels import SEEN, may_cross
from gcodesim.tools import TOOLS
from gcodesim.units import MM

CELL = 0.25 * MM
SETTLED = [*range(FROM), *range(MORE_SINES, LEVER_COSINES + 1)]  # what contact does not fill in


def laid(pieces, height, rows):
    """The rows of all pieces below a height, as a step lays them: one piece behind the other."""
    used = 0
    for piece in range(len(pieces)):
        used += as_python(lay_rows)(pieces, piece, height, CELL, rows[used:])
    return rows[:used]


def test_rows_that_stay_are_those_that_would_be_laid():
    tool = TOOLS["bull_nose_end_mill"](number=1, diameter=6 * MM, flutes=2, length=60 * MM, corner_radius=1 * MM)
    kept = np.zeros((4 * SLICES, COLUMNS))
    for height in (3 * MM, 3 * MM, 0.4 * MM, 0.4 * MM, 0.7 * MM, 5 * MM, 3 * MM):
        rows = laid(edge_pieces(tool, None), height, kept)
        fresh = laid(edge_pieces(tool, None), height, np.zeros_like(kept))
        assert np.array_equal(rows[:, SETTLED], fresh[:, SETTLED])
        rows[:, [FROM, TO, MORE_SINES, LEVER_COSINES]] = 7.0  # as contact leaves them


def test_an_arc_is_laid_anew_where_another_piece_had_its_place():
    tool = TOOLS["bull_nose_end_mill"](number=1, diameter=6 * MM, flutes=2, length=60 * MM, corner_radius=1 * MM)
    pieces, kept = edge_pieces(tool, None), np.zeros((4 * SLICES, COLUMNS))
    lay, arc = as_python(lay_rows), 1
    for first in (arc, 2, arc, 0, arc):
        number = lay(pieces, first, 3 * MM, CELL, kept)
        fresh = np.zeros_like(kept)
        assert lay(pieces, first, 3 * MM, CELL, fresh) == number > 0
        assert np.array_equal(kept[:number, SETTLED], fresh[:number, SETTLED])


def test_only_a_surface_that_passes_a_row_or_dips_below_it_is_looked_at():
    crosses = as_python(may_cross)
    flat = np.full(SEEN, 2.0)
    assert not crosses(flat, 3.0)
    assert not crosses(flat, 1.0)
    assert not crosses(np.full(SEEN, -np.inf), 1.0)
    assert crosses(np.arange(SEEN, dtype=float), 2.5)
    assert not crosses(np.arange(SEEN, dtype=float), -1.0)
    groove = np.array([5.0, 4.0, 3.0, 2.0, 3.0, 4.0, 5.0])
    assert crosses(groove, 1.0)
    assert not crosses(-groove, -9.0)

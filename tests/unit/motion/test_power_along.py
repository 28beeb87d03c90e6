"""Where a control stops for S, M3 and M8: in laser mode not for an S beside a move, and grbl only where they change."""

import numpy as np
import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.motion.build import PathBuilder
from gcodesim.rs274 import Settings, interpret

PROGRAM = """G21 G90
F100
M3 S500
G1 X1
X2 S100
X3 S100
G0 X4 S0
G1 X5 S7
S9
X6
M4
X7 S8
M5
X8 S9
M2
"""
STOPS_IN_LASER_MODE = [5, 6, 7]
"""Ends of moves, X in mm: before the S alone, before M4, before M5. The first M3 comes before all moves."""


def stops(lane, text=PROGRAM, **habits):
    """At which X [mm] the moves of a program end at rest."""
    source = SourceText("p.nc", text.encode())
    builder = PathBuilder(**habits)
    for event in interpret(source, Settings(dialect="grbl", lane=lane)).stream():
        builder.add(event)
    path = builder.leg()
    return np.round(path.end[:-1][path.stop[:-1], 0] * 1e3).astype(int).tolist()


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_an_s_beside_a_move_goes_along_in_laser_mode(lane):
    assert stops(lane, power_goes_along=True) == STOPS_IN_LASER_MODE


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_it_stops_the_machine_otherwise(lane):
    assert stops(lane, power_goes_along=False) == [1, 2, 3, 4, 5, 6, 7]


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_an_s_that_repeats_its_value_stops_nothing_where_only_changes_do(lane):
    """Steps 4 and 7 of grbl 1.1's `gc_execute_line`: X3 has the S of X2; behind M5 no S matters."""
    assert stops(lane, only_changes_stop=True) == [1, 3, 4, 5, 6, 7]


REPEATED = """G21 G90
F100
M3 S500
M8
G1 X1
M3
X2
M8
X3
M3 S500
X4
S500
X5
M9
X6
M9
X7
M5
X8
M5
S100
X9
M3
X10
M2
"""


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_words_that_say_what_holds_already(lane):
    """The machine stops before M9, M5 and M3 that change something, and otherwise goes on."""
    assert stops(lane, REPEATED, only_changes_stop=True) == [5, 7, 9]
    assert stops(lane, REPEATED, only_changes_stop=False) == list(range(1, 10))

"""Where a control in laser mode stops for an S: not beside a move that goes on with the same M3 or M4."""

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


def stops(lane, *, along):
    """At which X [mm] the moves of the program end at rest."""
    source = SourceText("p.nc", PROGRAM.encode())
    builder = PathBuilder(power_goes_along=along)
    for event in interpret(source, Settings(dialect="grbl", lane=lane)).stream():
        builder.add(event)
    path = builder.leg()
    return np.round(path.end[:-1][path.stop[:-1], 0] * 1e3).astype(int).tolist()


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_an_s_beside_a_move_goes_along_in_laser_mode(lane):
    assert stops(lane, along=True) == STOPS_IN_LASER_MODE


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_it_stops_the_machine_otherwise(lane):
    assert stops(lane, along=False) == [1, 2, 3, 4, 5, 6, 7]

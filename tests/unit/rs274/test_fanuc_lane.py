"""The compiled lane of Fanuc programs gives what the executor gives, line by line."""

import random

import pytest

from gcodesim.cell.arm_point import ArmPoint
from gcodesim.kinematics.attitude import Direction
from tests.unit.rs274.lanes import assert_same, moves_in_batches, mutated

HEAD = "%\nO1\nG21 G90 G49 G94 G54\nT1 M6\nS12000 M3\nG43 H1\nG0 Z60.\n"
LINES = (
    "G1 X10. Y-2.5 F1500.\nX11.0005 Y.25\nN50 Y3. Z-1.23456\n  N60 G00 Z5. \nG1 Z-.5 F300\nX-0.\nA12.34567 B3. F600.\n"
    "X5. C-7.25\nx6. y7.\nN70X8.Y9.\nX+1.5\nX2 Y3\n"
)
OTHERS = (
    "G2 X20. Y9. R8.\nG1 X21. (note)\nG91 X1.\nX1.\nG90\n/X3.\nX[1.+2.]\n#100=5.\nX#100\nG4 P100\nX4. X5.\nM8\nX1. M9\n"
    "G20\nX1. Y.12345\nG21\nG93 X2. F60.\nG94 F100.\nX3.\nQ5. X2.\nI1. X2.\nG1\nF200.\n\nN90\nG92 X0. A5.\nX1. A6.\n"
    "G52 Y3.\nY4.\nG68 X0. Y0. R30.\nX5.\nG69\nX6.\nG51 P2.\nX7.\nG50\nX8.\nG16\nX9. Y10.\nG15\nF0 X1.\n"
)
END = "G0 Z60.\nM5\nM30\n%\n"
SLIPS = "G43.5 H1\nX5. A3.\nX6. I0. J0. K0.\nX7. I1.\nG49\nX8.\n"
VECTORS = (
    "G43.5 H1\nG0 X1. Y2. Z30. I0. J0. K1.\nG1 X1.5 I.1 J-.2 K.97 F900.\nI.11 J-.21 K.96\nX2.\nX3. K1.\n"
    "Y2.00049 I.5 K2\nN10 X4. J.123456 K.9\nG2 X7. R8.\nG1 X8. I.2 K1.\nG92 A1.\nX9. I.3 K1.\nX10. J.2 K1.\n"
    "G49\nX1.\nG43.4 H1\nX2. A3.\nA4.\nG49\n"
)


@pytest.mark.parametrize("also", [{}, {"tool_length": "strict"}], ids=["as it is", "strict lengths"])
def test_straight_moves_are_the_same(also):
    stream = assert_same(HEAD + LINES * 40 + OTHERS + LINES + END, dialect="fanuc", **also)
    assert moves_in_batches(stream) > 400


def test_a_control_that_counts_increments_is_left_to_the_executor():
    stream = assert_same(HEAD + LINES * 3 + END, dialect="fanuc", options={"decimal_point": "increments"})
    assert moves_in_batches(stream) == 0


def test_directions_of_an_arm_are_the_same():
    law = ArmPoint(law=Direction(), letters=("A",))
    text = HEAD + VECTORS * 4 + "G43.5 H1\n" + "X1. I.1 K1.\nX2. J.1 K1.\n" * 50 + SLIPS + END
    stream = assert_same(text, dialect="fanuc", tool_point=law, has_cell=True)
    assert moves_in_batches(stream) > 100


def test_lines_end_with_the_program_they_belong_to():
    text = "O1\nM98 P2\nG1 X1. F100.\nX2.\nX3.\nM30\nO2\nG1 X5. F100.\nX6.\nX7.\nM99\n"
    assert_same(text, dialect="fanuc")
    assert_same("O1\nG1 X1. F100.\nX2.\nX3.\nO2\nX6.\nM30\n", dialect="fanuc")


def test_macro_calls_after_moves_are_heeded():
    text = "O1\nG1 F100. X0.\nG66 P2\nX1.\nX2.\nG67\nX3.\nX4.\nM30\nO2\nG91 Z1.\nG90\nM99\n"
    assert_same(text, dialect="fanuc")


def test_drawn_slips_are_told_alike():
    rng = random.Random(7)
    law = ArmPoint(law=Direction(), letters=("A",))
    for _ in range(60):
        text = HEAD + mutated(rng, LINES + OTHERS[: rng.randrange(len(OTHERS))] + "\n" + LINES) + END
        assert_same(text, dialect="fanuc")
        text = HEAD + mutated(rng, VECTORS) + SLIPS + END
        assert_same(text, dialect="fanuc", tool_point=law, has_cell=True)

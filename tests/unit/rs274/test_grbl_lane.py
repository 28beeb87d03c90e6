"""Grbl's programs in the compiled lane: the same events, findings and state as by its grammar."""

import random

import numpy as np
import pytest

from gcodesim.canon.batch import MoveBatch
from gcodesim.motion import build_tool_path
from tests.unit.rs274.lanes import assert_same, moves_in_batches, mutated

PLANES = {"G17": ("XY", "IJ", "K"), "G18": ("ZX", "KI", "J"), "G19": ("YZ", "JK", "I")}
HEAD = "G21 G90\nF100\nM3 S500\nG1 X0 Y0 Z0\n"

LEFT = [
    "S5", "X1 S5", "X1 S0\nX2 S7\nX3 S7.5\nX4 S0", "M4 S9\nX1 S0\nG0 X2 S300", "M5\nX1 S5\nX2 S6", "X1 S-5",
    "G2 X5 I2.5 S3", "M5", "/X3", "X[1+2]", "#1=5", "X#1", "O5", "G81 X1 Z-1 R1", "A5", "X1 A1", "X1 Q1", "X1 P1",
    "G98", "G2 I5", "I5", "G2 X5 I2.5 P1", "G2 X5 I2.5 K1", "G2 X0.0031 I5", "G2 X10.006 I5", "G2 X0.02 I0.01",
    "G2 R5", "G4 P1", "(a (b)", "(open", "X1?", "X1 ! Y2", "$H", "%", "G28", "X1 X2", "G53 G0 X0", "T1", "M1", "G54",
    "x1 . 5", "N10.5 X1", "X1 N5", "G90.1", "G1 F0 X1", "F-1", "G5 X1", "E1", "X", "X1 (a, b)", "(MSG, x)",
    "G93\nG1 X1", "G92 X1\nX2", "G80\nX1", "G1 X1" + "0" * 90, "G1 X1 (" + "c" * 90 + ")", "G1 X1 ;" + "c" * 90,
    "G20\nX1\nG2 X2 I.5", "G0.5 X1", "G1 X1 D1",
]  # fmt: skip


@pytest.mark.parametrize("line", LEFT)
def test_a_line_that_the_lane_does_not_know_means_what_the_grammar_says(line):
    stream = assert_same(HEAD + "X1\nX2\n" + line + "\nG1 X6 Y1\nX7\nG2 X17 Y1 I5\nM2\n", dialect="grbl")

    assert moves_in_batches(stream) > 0


def drawn(rng):
    """A program of straight moves and arcs that Grbl takes, and of some that it does not."""
    plane = "G17"
    lines = [rng.choice(["G21", "G20", ""]), rng.choice(["G90", "G91", ""]), "F100", "M3 S500"]

    def number():
        return rng.choice(
            [str(rng.randint(-9, 9)), f"{rng.uniform(-20, 20):.3f}", f"{rng.uniform(-1, 1):.5f}", ".5", "-3."]
        )

    for _ in range(rng.randint(20, 60)):
        pick, a, (i, j) = rng.random(), PLANES[plane][0][0], PLANES[plane][1]
        if pick < 0.55:
            words = [f"{axis}{number()}" for axis in rng.sample("XYZ", rng.randint(1, 3))]
            head = rng.choice(["", "G1 ", "G0", "g01 ", "N5 G1"])
            lines.append(head + rng.choice(["", " "]).join(words) + rng.choice(["", "", "F9", "(note)", ";x"]))
        elif pick < 0.8:
            radius, miss = rng.choice(["5", "-7.25", "30.5"]), rng.choice([0.0, 0.001, 0.004])
            end = f"{a}{2.0 * float(radius) + miss:.4f}"
            arc = (
                f"G91 {rng.choice(['G2', 'G3'])} {end} {i}{radius} {rng.choice(['', j + '0', PLANES[plane][2] + '1'])}"
            )
            lines.append(arc)
        elif pick < 0.85:
            plane = rng.choice(list(PLANES))
            lines.append(plane)
        elif pick < 0.985:
            lines.append(rng.choice(["G90", "G91", "G91.1", "G20", "G21", "G94 F99", "G40", "G61", "G1 F300", "", " "]))
        else:
            lines.append(rng.choice(LEFT))
    return "\n".join([*lines, "M2"]) + "\n"


@pytest.mark.parametrize("seed", range(12))
def test_drawn_programs(seed):
    rng, moves = random.Random(seed), 0
    for round_ in range(10):
        text = drawn(rng)
        stream = assert_same(mutated(rng, text) if round_ % 4 == 3 else text, dialect="grbl")
        moves += moves_in_batches(stream)

    assert moves > 20


@pytest.mark.parametrize("dialect", ["grbl", "linuxcnc"])
@pytest.mark.parametrize("start", ["M3 S500", "M4 S0\nS5", "S7\nM4", "M5 S9"])
def test_a_path_with_s_words_is_the_same_by_batches_and_by_events(dialect, start):
    rng, batches = random.Random(f"{dialect} {start}"), 0
    for _ in range(6):
        moves = "".join(
            f"{rng.choice(['G0', 'G1', 'G1', ''])} X{rng.randint(0, 9)} {rng.choice(['', 'S0', 'S5', 'S5', 'S7.5'])}\n"
            for _ in range(60)
        )
        stream = assert_same(f"G21\nF100\n{start}\nG1 X1\n{moves}M5\n{moves}M3\n{moves}M2\n", dialect=dialect)
        singly = [event for item in stream for event in (item.events() if isinstance(item, MoveBatch) else [item])]
        path, expected = build_tool_path(stream), build_tool_path(singly)
        assert np.array_equal(path.state, expected.state)
        assert np.array_equal(path.stop, expected.stop)
        assert repr(path.states) == repr(expected.states)
        assert repr(path.events) == repr(expected.events)
        batches += sum(item.speed is not None for item in stream if isinstance(item, MoveBatch))

    assert batches > 6

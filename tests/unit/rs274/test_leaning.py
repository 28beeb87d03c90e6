"""Work systems that lean against the machine: moves, arcs, offsets and readings go by their own axes."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.frames import rotation_about
from gcodesim.rs274.tilt import Tilt

AXIS = np.array([1.0, 2.0, -0.5]) / np.linalg.norm([1.0, 2.0, -0.5])
R = rotation_about(AXIS, 0.7)
LEAN = {2: Tilt((0.0, 0.0, 0.0), tuple(map(tuple, R.tolist())))}
OFFSET = np.array([30.0, -20.0, 15.0])
PARAMETERS = {5241: 30.0, 5242: -20.0, 5243: 15.0}


def about_z(degrees):
    return rotation_about(np.array([0.0, 0.0, 1.0]), np.radians(degrees))


@pytest.fixture
def leaning(program):
    def run(*lines, **settings):
        given = {"leans": LEAN, "parameters": PARAMETERS, "lane": "grammar"} | settings
        done = program("\n".join(["G21 G90 G17", *lines, "M2"]) + "\n", **given)
        assert not done.errors, [finding.message for finding in done.errors]
        return done

    return run


@pytest.fixture
def fanuc(program):
    def run(*lines):
        text = "%\nO0001\n" + "\n".join(["G21 G90 G17", *lines, "M30"]) + "\n%\n"
        done = program(text, dialect="fanuc", leans=LEAN, parameters=PARAMETERS)
        assert not done.errors, [finding.message for finding in done.errors]
        return done

    return run


def test_points_and_arcs_lie_in_it(leaning):
    done = leaning("G55", "G0 X1 Y2 Z3", "G2 X3 Y2 I1 F100", "G54 G0 X0 Y0 Z0")

    np.testing.assert_allclose(done.ends[0], OFFSET + R @ [1, 2, 3], atol=1e-9)
    arc = done.acts("arc")[0]
    np.testing.assert_allclose(arc["end"][:3], OFFSET + R @ [3, 2, 3], atol=1e-9)
    np.testing.assert_allclose(arc["center"], OFFSET + R @ [2, 2, 3], atol=1e-9)
    np.testing.assert_allclose(arc["normal"], R @ [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(done.ends[-1], [0, 0, 0], atol=1e-12)


def test_turn_and_shift_come_before_it(leaning):
    done = leaning("G10 L2 P2 R30", "G55", "G0 X0 Y0 Z0", "G92 X5 Y6 Z7", "X6 Y8 Z10")

    np.testing.assert_allclose(done.ends[1], OFFSET + R @ about_z(30) @ [1, 2, 3], atol=1e-9)
    assert done.acts("work_system")[-2]["axes"] == pytest.approx(R, abs=1e-9)


def test_what_a_point_reads_stays_when_systems_change(leaning):
    done = leaning("G0 X10 Y11 Z12", "G55", "#1=#5420 #2=#5421 #3=#5422", "G91 G0 X1", "G90 G54", "Y#5421 Z#5422")
    wanted = np.array([10, 11, 12]) + R @ [1, 0, 0]

    np.testing.assert_allclose(done.ends[1], wanted, atol=1e-6)
    np.testing.assert_allclose(done.ends[2], wanted, atol=1e-6)


@pytest.mark.parametrize("words", ["X1 Y2 Z3", "Z3", "X0 A10"])
def test_touching_off_makes_the_point_read_as_wanted(leaning, words):
    """G10 L20: words are what the present point reads then; the others of X, Y, Z read as before."""
    done = leaning(
        "G55", "G0 X4 Y5 Z6", "G10 L2 P2 R20", "G0 X4 Y5 Z6", f"G10 L20 P2 {words}", "G91 G0 X0 Y0 Z0", "G90"
    )
    said = {word[0]: float(word[1:]) for word in words.split()}
    read = np.array([said.get("X", 4.0), said.get("Y", 5.0), said.get("Z", 6.0)])
    offset = np.array(done.acts("work_system")[-2]["offset"][:3])

    np.testing.assert_allclose(done.ends[-1], done.ends[-2], atol=1e-9)
    np.testing.assert_allclose(offset + R @ about_z(20) @ read, done.ends[-1], atol=1e-6)


def test_machine_coordinates_do_not_lean(leaning):
    done = leaning("G55", "G0 X1 Y1 Z1", "G53 G0 Z40", "G53 G0 X0 Y0 Z0")

    point = OFFSET + R @ [1, 1, 1]
    np.testing.assert_allclose(done.ends[1:], [[point[0], point[1], 40], [0, 0, 0]], atol=1e-9)


def test_drilling_goes_along_its_z(leaning):
    done = leaning("G55", "G0 X0 Y0 Z10", "G98 G81 X5 Y5 Z-3 R2 F100")

    deep = min(done.ends, key=lambda end: (R.T @ (np.array(end) - OFFSET))[2])
    np.testing.assert_allclose(deep, OFFSET + R @ [5, 5, -3], atol=1e-9)


def test_a_tool_that_leans_along_takes_its_length_with_it(leaning):
    """A change of length holds the axes; where the tool leans along, the tip moves along the Z of the system."""
    lines = ("G55", "G0 X1 Y2 Z3", "G43.1 Z10", "G91 G0 X0")
    stands, leans = leaning(*lines), leaning(*lines, length_leans=True)

    point = OFFSET + R @ [1, 2, 3]
    np.testing.assert_allclose(stands.ends[-1], point - [0, 0, 10], atol=1e-9)
    np.testing.assert_allclose(leans.ends[-1], point - R @ [0, 0, 10], atol=1e-9)
    back = leaning(*lines, "G90 G54", "G91 G0 X0", length_leans=True)
    np.testing.assert_allclose(back.ends[-1], leans.ends[-1], atol=1e-9)


def test_length_cannot_be_measured_in_it(program):
    text = "G55\nT1 M6\nG10 L10 P1 Z0\nM2\n"
    done = program(text, leans=LEAN, parameters=PARAMETERS, lane="grammar")

    assert "GS106" in {finding.code for finding in done.errors}


def test_fanuc_shifts_turns_and_tilts_within_it(fanuc):
    done = fanuc(
        "G55",
        "G52 X1. Y2. Z3.",
        "G00 X0. Y0. Z0.",
        "G52 X0. Y0. Z0.",
        "G68 X0. Y0. R90.",
        "X10. Y0. Z0.",
        "G69",
        "G68.2 X1. Y1. Z1. I0. J90. K0.",
        "X0. Y0. Z5.",
        "G69",
        "#1=#5041",
        "#2=#5042",
        "#3=#5043",
        "G18 G68 X0. Z0. R90.",
        "X0. Y7. Z4.",
        "G69",
        "G54 X#1 Y#2 Z#3",
    )
    tilt = rotation_about(np.array([1.0, 0.0, 0.0]), np.pi / 2)
    seen = np.array([1, 1, 1]) + tilt @ [0, 0, 5]
    wanted = [
        OFFSET + R @ [1, 2, 3],
        OFFSET + R @ [0, 10, 0],
        OFFSET + R @ seen,
        OFFSET + R @ rotation_about(np.array([0.0, 1.0, 0.0]), np.pi / 2) @ [0, 7, 4],
        seen,
    ]

    np.testing.assert_allclose(done.ends, wanted, atol=1e-6)

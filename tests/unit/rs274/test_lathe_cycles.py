"""LinuxCNC's G70, G71 and G72 make the moves that its own interpreter prints.

`linuxcnc.json` holds programs with what LinuxCNC 2.9.0 made of them: T rapids and F feeds to X, Z; A arcs to X, Z with
the centre's X, Z and the sense, 1 to the left.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

RECORDED = json.loads((Path(__file__).parents[2] / "data" / "lathe_cycles" / "linuxcnc.json").read_text())

CONTOUR = "G0 X4 Z0\nG1 Z-2\nG1 X9 Z-4\n"


def _text(contour: str, cycle: str = "G71 Q100 X10 Z2 I1") -> str:
    return f"G21 G18 G90 G8\nF100\nO100 SUB\n{contour}O100 ENDSUB\nG0 X10 Z2\n{cycle}\nM2\n"


def _moves(done) -> list[list[float | str]]:
    """As the recorded ones; units of events are mm."""
    found: list[list[float | str]] = []
    for event in done.acts("rapid", "line", "arc"):
        x, _, z = event["end"][:3]
        if event["kind"] == "arc":
            centre = event["center"]
            found.append(["A", x, z, centre[0], centre[2], 1 if event["ccw"] else -1])
        else:
            found.append(["T" if event["kind"] == "rapid" else "F", x, z])
    return found


@pytest.mark.parametrize("name", RECORDED)
def test_the_moves_are_those_of_linuxcnc(program, name: str) -> None:
    recorded = RECORDED[name]

    done = program("\n".join(recorded["program"]) + "\n")

    assert bool(done.errors) == recorded["refused"]
    if not recorded["refused"]:
        moves = _moves(done)
        assert [move[0] for move in moves] == [move[0] for move in recorded["moves"]]
        for ours, theirs in zip(moves, recorded["moves"], strict=True):
            assert ours[1:] == pytest.approx(theirs[1:], abs=1.5e-4)


def test_a_contour_may_hold_loops_conditions_and_parameters(program) -> None:
    plain = program(_text("G0 X2 Z0\nG1 X3 Z-1\nG1 X4 Z-2\nG1 X5 Z-3\nG1 X9\n"))
    looped = program(
        _text(
            "G0 X2 Z0\n#<deep>=1\nO101 REPEAT [3]\nG1 X[#<_x>+1] Z[-#<deep>]\n#<deep>=[#<deep>+1]\nO101 ENDREPEAT\n"
            "O102 IF [#<deep> GT 3]\nG1 X9\nO102 ENDIF\n"
        )
    )

    assert not looped.errors
    assert _moves(looped) == _moves(plain)


@pytest.mark.parametrize(
    ("contour", "cycle", "words"),
    [
        ("G0 X4 Z0\nG1 Z-2\nG1 X3 Z-1.5\nG1 Z-5\nG1 X9\n", "G71 Q100", "turns back in Z"),
        ("G0 X9 Z-4\nG1 X4\nG1 X5 Z-2\nG1 X1 Z0\n", "G72 Q100", "turns back in X"),
        ("G0 X4 Z0\n", "G71 Q100", "fewer than two moves"),
        (CONTOUR, "G71 Q100 I0", "must be more than 0"),
        (CONTOUR, "G71 Q100 I0.00001", "too small"),
        ("G0 X4 Z0\nO101 WHILE [1]\nG1 X5\nO101 ENDWHILE\n", "G71 Q100", "more than 1000 blocks"),
        ("G0 X4 Z0\nG1 X[1/0]\n", "G71 Q100", "in the contour"),
    ],
)
def test_what_is_no_contour_is_told(program, contour: str, cycle: str, words: str) -> None:
    done = program(_text(contour, cycle))

    assert len(done.errors) == 1
    assert words in done.errors[0].message
    assert done.errors[0].span.line == _text(contour, cycle).splitlines().index(cycle) + 1


def test_a_corner_is_rounded_by_a_and_broken_by_c(program) -> None:
    """A square corner loses as much of its sides as the word says."""
    done = program(_text("G1 X4 Z0\nG1 Z-14 A1\nG1 X10 C2\nG1 Z-30\nG1 X20\n", "G70 Q100 X15 Z0 D0"))

    assert not done.errors
    assert _moves(done)[-6:] == [
        ["F", 4, -13],
        ["A", 5, -14, 5, -13, -1],
        ["F", 8, -14],
        ["F", 10, -16],
        ["F", 10, -30],
        ["F", 20, -30],
    ]


def test_the_finish_of_a_slanted_corner_touches_both_sides(program) -> None:
    """Sides at 45 degrees: a circle of radius 1 touches them tan(22.5 degrees) from the corner."""
    away = math.tan(math.pi / 8.0)
    done = program(_text("G1 X4 Z0\nG1 Z-14 C1\nG1 X10 Z-20\nG1 X20\n", "G70 Q100 X15 Z0 D0"))

    begin, end = (move[1:3] for move in _moves(done)[-4:-2])
    assert begin == pytest.approx([4.0, -14.0 + away], abs=1e-9)
    assert end == pytest.approx([4.0 + away * math.sqrt(0.5), -14.0 - away * math.sqrt(0.5)], abs=1e-9)


def test_u_and_w_count_from_the_point_before(program) -> None:
    done = program(_text("G1 X4 Z0\nG1 W-3\nG1 U2.5 W-1\nG1 X20\n", "G70 Q100 X15 Z0 D0"))
    across = program(_text("G1 X8 Z0\nG1 W-3\nG1 U5 W-1\nG1 X40\n", "G7\nG70 Q100 X30 Z0 D0"))

    assert _moves(done)[-3:] == [["F", 4, -3], ["F", 6.5, -4], ["F", 20, -4]]
    assert _moves(across)[-3:] == _moves(done)[-3:]


def test_passes_come_from_where_the_contour_was_entered(program) -> None:
    """A contour that ends below its first point, in a slant: LinuxCNC 2.9.4 leads it out to where the cycle starts."""
    done = program(_text("G1 X7 Z0\nG1 Z-6\nG1 X5\nG1 X6 Z-8\n", "G71.1 Q100 X10 Z2 D0.5 I1 R0.3"))

    feeds = [move for move in _moves(done) if move[0] == "F"]
    assert not done.errors
    assert min(move[1] for move in feeds) == 7.5
    assert feeds[:2] == [["F", 10, -7.5], ["F", 9, -7.5]]
    assert feeds[-1] == ["F", 10, -7.5]


def test_a_contour_that_goes_both_ways_along_z_is_finished_as_a_face(program) -> None:
    done = program(_text("G1 X10 Z-4\nG1 X8\nG1 X7 Z-3\nG1 X4 Z-4\nG1 X2\n", "G70 Q100 X12 Z2 D0"))

    assert not done.errors
    assert [move[1:] for move in _moves(done)[-4:]] == [[8, -4], [7, -3], [4, -4], [2, -4]]


@pytest.mark.parametrize(
    ("contour", "words"),
    [
        ("G1 X4 Z0\nG1 Z-2 A1 C1\nG1 X9\n", "not both"),
        ("G1 X4 Z0\nG1 Z-2 A3\nG1 X9\n", "A3 does not fit"),
        ("G1 X4 Z0\nG1 Z-2 C1\nG1 Z-5\n", "C1 does not fit"),
        ("G1 X4 Z0\nG1 X5 U1\nG1 Z-5\n", "not both"),
        ("G1 X4 Z0\nG1 Z-5 W1\nG1 X9\n", "not both"),
    ],
)
def test_a_corner_that_cannot_be_is_told(program, contour: str, words: str) -> None:
    done = program(_text(contour, "G70 Q100"))

    assert len(done.errors) == 1
    assert words in done.errors[0].message

"""LinuxCNC's G70, G71 and G72 make the moves that its own interpreter prints.

`linuxcnc.json` holds programs with what LinuxCNC 2.9 made of them: T rapids and F feeds to X, Z; A arcs to X, Z with
the centre's X, Z and the sense, 1 to the left.
"""

from __future__ import annotations

import json
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

"""Steps: what a program means, without numbering, comments and spelling."""

from __future__ import annotations

import math

import pytest

from gcodesim.regress.motion import MotionStep, System
from gcodesim.regress.step_text import StepTextError, lines_of, steps_from

HEAD = "G21 G90 G17 G94\nT1 M6\nS1000 M3\n"


def bare(steps_list) -> list[tuple[object, ...]]:
    return [(s.kind, s.words, s.numbers, s.end) for s in steps_list]


def test_spelling_does_not_count(steps) -> None:
    one = steps(HEAD + "G0 X1 Y2\nG1 Z-1 F100\nX3\nM2\n")
    other = steps(
        "(a)\nn5 g21g90 g17 g94 (x)\n\nT1M6\nM3 S1000.0 ; on\ng00 x+01.0y2.\nG01z-1f100 (MSG, hello)\ng1 X3.000\nm2"
    )
    assert bare(one) == bare(other)


def test_states_that_nothing_finds_are_no_steps(steps) -> None:
    assert bare(steps(HEAD + "G0 X1\nM2\n")) == bare(steps(HEAD + "M5\nS5 M4\nS1000 M3\nM8\nM9\nG0 X1\nM2\n"))


def test_a_state_that_is_left_is_a_step(steps) -> None:
    kinds = [step.kind for step in steps(HEAD + "G0 X1\nM5\n")]
    assert kinds[-2:] == ["rapid", "spindle"]


def test_the_way_of_an_arc(steps) -> None:
    """A half circle of radius 5 that sinks by 3: sqrt((5 pi)² + 3²)."""
    arc = steps(HEAD + "G0 X0 Y0 Z0\nG2 X10 Y0 Z-3 I5 J0 F100\n")[-1]
    assert arc.length == pytest.approx(math.hypot(5 * math.pi, 3.0), rel=1e-9)
    assert arc.through[0] == pytest.approx((5.0, 5.0, -1.5), abs=1e-9)


@pytest.mark.parametrize("rotation", [0.0, 30.0, -120.0])
def test_a_work_system_turns_back(rotation: float) -> None:
    system = System(offset=(1, 2, 3, 0, 0, 5), g92=(0.5, 0, 0, 0, 0, 0), rotation=rotation)
    point = (4.0, -7.0, 2.0, 0.0, 10.0, 20.0)
    assert system.to_program(system.to_machine(point)) == pytest.approx(point, abs=1e-12)


PROGRAM = (
    HEAD
    + "G10 L2 P1 X5 Y6 R10\nG0 X0 Y0 Z1\nG1 Z-1 F100\nG2 X10 Y0 I5 J0\nG3 X10 Y0 I0 J5 P2\nG5 X20 Y5 I1 J2 P-1 Q0\n"
    + "G93 G1 X1 F2\nG94\nG64 P0.01\nG4 P0.5\nM8\nG61.1\nG1 X5 F80\nM64 P1\nG43 H1\nG0 Z5\nM30\n"
)


def test_steps_stand_in_text_and_come_back(steps) -> None:
    before = steps(PROGRAM)
    lines = lines_of(before)
    after = steps_from(lines)
    assert {step.kind for step in before} >= {"rapid", "line", "arc", "spline", "dwell", "coolant", "output", "end"}
    assert lines_of(after) == lines
    assert [(s.kind, s.file, s.line, dict(s.words), s.stops) for s in before] == [
        (s.kind, s.file, s.line, dict(s.words), s.stops) for s in after
    ]
    for a, b in zip(before, after, strict=True):
        assert (a.end or ()) == pytest.approx(b.end or (), abs=2e-6)
        assert [p for q in a.through for p in q] == pytest.approx([p for q in b.through for p in q], abs=2e-5)


@pytest.mark.parametrize("feature", ["External perimeter", "50% infill", "a:b=c(1)", "\u00fcber alles"])
def test_names_of_features_come_back(feature: str) -> None:
    step = MotionStep(kind="section", file="a.gcode", line=3, words=(("feature", feature),))
    (back,) = steps_from(lines_of([step]))
    assert back.words == step.words


def test_a_line_put_in_changes_one_line_of_the_text(steps) -> None:
    text = HEAD + "G0 X1\nG1 X2 F100\nX3\nX4\nM2\n"
    old, new = (lines_of(steps(t)) for t in (text, text.replace("X3\n", "X3\nY9\n")))
    assert [line for line in new if line not in old] == ["line Y9"]
    assert [line for line in old if line not in new] == []


@pytest.mark.parametrize("line", ["line Xa", "LINE X1", "arc X1 Y1", "rapid X1", "+1", ""])
def test_text_that_is_no_step(line: str) -> None:
    with pytest.raises(StepTextError):
        steps_from([line])

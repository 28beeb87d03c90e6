"""GS187: shifts of the origin that outlive the program."""

from __future__ import annotations

import pytest


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("G0 X10\nG92 X0\nG0 X5", [("GS187", 2, 1)]),
        ("G0 X10\nG52 X5 Y5", [("GS187", 2, 1)]),
        ("G0 X10\nG92 X0\nG92.1", []),
        ("G0 X10\nG92 X0\nG92.2", []),
        ("G0 X10\nG92 X0\nG92.2\nG92.3", [("GS187", 4, 1)]),
        ("G52 X5\nG52 X0", []),
        ("G0 X10\nG92 X10", []),  # reads as before
        ("G55\nG0 X5", []),  # M2 goes back to G54
        ("G53 G0 X5", []),  # for one block
        ("G10 L2 P1 X5", []),  # meant to stay
    ],
)
def test_left_in_force(warned, text: str, found: list[tuple[str, int, int]]) -> None:
    assert warned(text) == found


def test_what_was_there_before_is_not_the_programs_fault(warned) -> None:
    assert warned("G0 X5", parameters={5210: 1.0, 5211: 7.0}) == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("G68 X0 Y0 R30.\nG0 X5.", [("GS187", 1, 1)]),
        ("G68 X0 Y0 R30.\nG0 X5.\nG69", []),
        ("G51.1 X0\nG0 X5.", [("GS187", 1, 1)]),
        ("G51.1 X0\nG0 X5.\nG50.1 X0", []),
        ("G52 X5.\nG0 X0", [("GS187", 1, 1)]),
        ("G52 X5.\nG0 X0\nG52 X0", []),
    ],
)
def test_on_fanuc(warned, text: str, found: list[tuple[str, int, int]]) -> None:
    assert warned(text, end="\nM30\n", dialect="fanuc") == found


def test_a_rotary_axis_is_off_by_degrees(program):
    done = program("G0 X10 A10\nG92 X0 A0\nM2")

    assert done.findings[0].message.endswith("would be off by X10 mm, A10 deg")

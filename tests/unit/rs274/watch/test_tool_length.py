"""GS161 and GS162: the length of another tool, and of the tool before."""

from __future__ import annotations

import pytest

FIRST = "T1 M6\nG43 H1\nG0 Z5\nG1 X10 F200\nG0 Z50\n"


def test_h_is_not_t(warned) -> None:
    assert warned("T1 M6\nG43 H2\nG0 Z5") == [("GS161", 2, 5)]


def test_h_is_not_t_on_fanuc(warned) -> None:
    assert warned("T1 M6\nG43 H2 Z5.", end="\nM30\n", dialect="fanuc") == [("GS161", 2, 5)]


def test_a_finding_a_pair_of_numbers(warned) -> None:
    assert warned("T1 M6\nG43 H2\nG0 Z5\nG43 H2\nT2 M6\nG43 H1") == [("GS161", 2, 5), ("GS161", 6, 5)]


@pytest.mark.parametrize("text", ["T1 M6\nG43", "T1 M6\nG43 H1", "G43 H2\nG0 Z5", "T1 M6\nG43 H21", "T1 M6\nG43 H0"])
def test_lengths_in_order(warned, text: str) -> None:
    assert warned(text) == []


def test_a_tool_without_its_length(warned) -> None:
    assert warned(FIRST + "T2 M6\nG0 X5 Y5\nG0 Z5") == [("GS162", 8, 1)]


def test_feeding_sideways_counts_too(warned) -> None:
    assert warned(FIRST + "T2 M6\nG1 X5 Y5") == [("GS162", 7, 1)]


def test_g43_may_come_later_in_the_program(warned) -> None:
    assert warned("T2 M6\nG0 X1\nG0 Z9\n" + FIRST) == [("GS162", 3, 1)]


@pytest.mark.parametrize(
    "text",
    [
        "T1 M6\nG0 Z5\nT2 M6\nG0 Z6",  # no G43 anywhere
        FIRST + "T2 M6\nG0 X5 Y5\nG43 H2\nG0 Z5",
        FIRST + "T2 M6\nG43 H2 G0 Z5",
        FIRST + "T2 M6\nG53 G0 Z0\nG28\nG43 H2\nG0 Z5",  # places of the machine
        FIRST + "T2 M6\nG38.2 Z-10 F10\nG43.1 Z3\nG0 Z5",  # the tool is measured
        FIRST + "T1 M6\nG0 Z5",  # the same tool again
        FIRST + "T0 M6\nG0 Z5",  # none
        "G43 H1\nT1 M6\nG0 Z5",  # the length came first
        "T1 M6\nG0 X5 Y5\n" + FIRST,
        FIRST + "G28 Z60\nG49\nT2 M6\nG0 X0 Y0\nG43 H2\nG0 Z5",  # G49 changes what Z reads, not where it is
        FIRST + "G53 G0 Z0\nT2 M6\nG1 X5 Y5 F500\nG43 H2\nG0 Z5",  # sideways where the machine changes tools
    ],
)
def test_no_alarm(warned, text: str) -> None:
    assert warned(text) == []

"""GS186: the unit changes in mid-program."""

from __future__ import annotations

import pytest


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("G21\nF100\nG1 X10\nG20\nG1 X1", [("GS186", 4, 1)]),
        ("G20\nF100\nG1 X1\nN50 G90 G21\nG1 X10", [("GS186", 4, 9)]),
        ("F100\nG1 X10\nG20 G1 X1\nG21\nG1 X1", [("GS186", 3, 1)]),  # said once
        ("G20\nG21\nG20\nF10\nG1 X1", []),
        ("G0 X5\nG20\nF10\nG1 X1", []),  # to a place where the work begins
        ("G21\nF100\nG1 X10\nG21\nG1 X5", []),
        ("G20\nF10\nG1 X1\nG21", []),  # back to what the shop is used to
        ("G20\nF10\nG1 X1\nG21\nG28", []),
        # a subroutine may think in its own unit
        ("o1 sub\nM73\nG20\nG1 X1 F10\no1 endsub\nG21\nG1 X5 F100\no1 call\nG1 X6", []),
    ],
)
def test_unit_change(warned, text: str, found: list[tuple[str, int, int]]) -> None:
    assert warned(text) == found

"""GS154 and GS155: rapids along the contour, and compensation on at the end."""

from __future__ import annotations

import pytest

IN = "T1 M6\nG0 X0 Y0 Z50\nG0 Z2\nG1 Z-5 F200\nG41 D1 G1 X20 Y10\nG1 Y40\n"  # six lines
OUT = "G40 G1 X-20 Y0\nG0 Z50\n"


def test_a_rapid_in_the_groove(warned) -> None:
    assert warned(IN + "G0 X60\nG1 Y10\n" + OUT) == [("GS154", 7, 1)]


def test_entering_by_a_rapid(warned) -> None:
    text = "T1 M6\nG0 X0 Y0 Z2\nG1 Z-5 F200\nG41 D1 G0 X20 Y10\nG1 Y40\n"

    assert warned(text + OUT) == [("GS154", 4, 1)]


@pytest.mark.parametrize(
    "text",
    [
        IN + "G1 X60\nG1 Y10\n" + OUT,
        IN + "G0 Z2\nG0 X60\nG1 Z-5\nG1 Y10\n" + OUT,
        IN + "G0 Z0.5\nG0 X60\nG1 Z-5\nG1 Y10\n" + OUT,  # a small retract is one
        # down by a rapid beside the part: that height is safe
        "T1 M6\nG0 X0 Y0 Z50\nG0 Z-5\nG41 D1 G0 X20 Y10\nG1 Y40 F200\n" + OUT,
        IN + "G40 G0 X-20 Y0\nG0 Z50",  # the way out is not along the contour
        "G0 X0 Y0 Z2\nG1 Z-5 F200\nG0 X20",  # no compensation: a pocket may have been cleared
    ],
)
def test_no_alarm(warned, text: str) -> None:
    assert warned(text) == []


def test_on_at_the_end(warned) -> None:
    assert warned(IN + "G0 Z50") == [("GS155", 8, 1)]
    assert warned("%\n" + IN + "G0 Z50\n", end="%\n") == [("GS155", 9, 1)]
    assert warned(IN + OUT) == []

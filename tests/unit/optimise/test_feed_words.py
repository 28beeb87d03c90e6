"""F words are replaced and added; nothing else in a program changes."""

from __future__ import annotations

import re

import pytest

from gcodesim.optimise.feed_words import rewritten, written
from gcodesim.units import INCH, MINUTE, MM_PER_MINUTE

MM = MM_PER_MINUTE


def changed(text: str, feeds: dict[int, float], branching: bool = False) -> tuple[str, list[int]]:
    lines, refused = rewritten(text.splitlines(), feeds, branching)
    return "\n".join(lines), refused


def test_a_word_is_replaced_and_the_next_line_gets_its_own_back() -> None:
    text = "G1 X1 F1200 (F9)\nG1 X2 ; F8\nX3"

    assert changed(text, {1: 600 * MM, 2: 1200 * MM, 3: 1200 * MM}) == (
        "G1 X1 F600 (F9)\nG1 X2 F1200 ; F8\nX3",
        [],
    )


def test_nothing_changes_where_no_feed_does() -> None:
    text = "F1200\nG1 X1\n(F5) G1 X2 f 1200.0\nG0 X3\nG1 X4"

    assert changed(text, {2: 1200 * MM, 3: 1200 * MM, 5: 1200 * MM}) == (text, [])


def test_inches_and_branches() -> None:
    assert changed("G20\nG1 X1 F30", {2: 15.5 * INCH / MINUTE})[0] == "G20\nG1 X1 F15.5"
    assert changed("G1 X1 F100\nG1 X2", {1: 100 * MM, 2: 100 * MM}, branching=True)[0] == "G1 X1 F100\nG1 X2 F100"


@pytest.mark.parametrize("line", ["G1 X1 F[#1*2]", "G1 X1 F#<feed>", "G93 G1 X1 F2", "G95 G1 X1 F0.2", "G33 Z-5 K1"])
def test_feeds_that_cannot_be_written_are_told(line: str) -> None:
    assert changed(line, {1: 100 * MM}) == (line, [1])


@pytest.mark.parametrize(
    ("value", "text"), [(1234.56, "1234"), (123.46, "123.4"), (12.3456, "12.34"), (0.98766, "0.9876"), (600.0, "600")]
)
def test_a_feed_is_never_rounded_up(value: float, text: str) -> None:
    assert written(value) == text
    assert re.fullmatch(r"[0-9]+(\.[0-9]+)?", text)

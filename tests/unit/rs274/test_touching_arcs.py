"""Arcs that touch within the digits of a program are no inside corner, on a Fanuc: a post writes lead-ins like that."""

from __future__ import annotations

import math
import random

import pytest


def _block(words: str, centre: tuple[float, float], end: tuple[float, float], start: tuple[float, float]) -> str:
    """An arc with everything to four digits of an inch, as posts write it."""
    i, j = centre[0] - start[0], centre[1] - start[1]
    return f"{words} X{end[0]:.4f} Y{end[1]:.4f} I{i:.4f} J{j:.4f}"


def _boss(draw: random.Random) -> tuple[str, float]:
    """A program round a boss of some radius, in and out by arcs that touch it, and the tool's radius [inch]."""
    radius, tool = draw.uniform(0.1, 0.5), draw.uniform(0.05, 0.2)
    lead, turn = tool * draw.uniform(1.02, 1.6), draw.uniform(0.0, 2.0 * math.pi)
    x, y = draw.uniform(-3.0, 3.0), draw.uniform(-3.0, 3.0)
    foot = (x + radius * math.cos(turn), y + radius * math.sin(turn))
    middle = (x + (radius + lead) * math.cos(turn), y + (radius + lead) * math.sin(turn))
    along = (math.sin(turn), -math.cos(turn))  # clockwise
    far, off = (middle[0] - lead * along[0], middle[1] - lead * along[1]), (x, y)
    begin = (far[0] + 2.0 * tool * math.cos(turn), far[1] + 2.0 * tool * math.sin(turn))
    last = (middle[0] + lead * along[0], middle[1] + lead * along[1])
    half = (2.0 * x - foot[0], 2.0 * y - foot[1])
    lines = [
        "O0001",
        "G20 G17 G90 G94 F10.",
        f"G0 X{begin[0]:.4f} Y{begin[1]:.4f}",
        f"G1 G41 X{far[0]:.4f} Y{far[1]:.4f} D1",
        _block("G3", middle, foot, far),
        _block("G2", off, half, foot),
        _block("G2", off, foot, half),
        _block("G3", middle, last, foot),
        f"G1 G40 X{begin[0]:.4f} Y{begin[1]:.4f}",
        "M30",
    ]
    return "\n".join(lines), tool


@pytest.mark.parametrize("number", range(60))
def test_a_post_leads_in_and_out_by_arcs(program, number: int) -> None:
    from gcodesim.rs274 import ToolEntry, ToolTable

    text, tool = _boss(random.Random(number))
    table = ToolTable({1: ToolEntry(number=1, pocket=1, offset=(0,) * 9, diameter=2.0 * tool * 25.4e-3)})
    done = program(text, dialect="fanuc", tool_table=table)

    assert done.findings == []
    before = (0.0, 0.0)
    for event in done.events:
        if event["kind"] == "arc":
            (cx, cy, _), end = event["center"], event["end"]
            radii = [math.hypot(px - cx, py - cy) for px, py in (before, end[:2])]
            assert radii[0] == pytest.approx(radii[1], abs=0.01), event["line"]  # mm
        if "end" in event:
            before = (event["end"][0], event["end"][1])

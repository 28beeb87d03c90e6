"""Turning cycles in one block, as Haas and Fanuc's older controls have them, make the moves of the two-block form."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from gcodesim.diagnostics import Severity
from gcodesim.rs274 import ToolEntry, ToolTable

NOSE = ToolTable({1: ToolEntry(number=1, pocket=1, offset=(0,) * 9, diameter=1.6e-3, orientation=2)})
CONTOUR = "N10 G00 X12. Z1.\nG01 Z-10. F0.1\nX20. Z-14.\nG02 X26. Z-17. R3.\nN20 G01 X32.\n"
ALONG_X = "N10 G00 Z-17. X34.\nG01 X20. F0.1\nX12. Z-10.\nN20 G01 Z1.\n"


def _moves(program, cycle: str, contour: str = "", **settings):
    head = "O0001\nG21 G18 G40 G99\nT0101\nG97 S500 M3\nG00 X34. Z2.\n"
    done = program(f"{head}{cycle}\n{contour}G00 X100. Z100.\nM30", dialect="fanuc_lathe", **settings)
    kinds = ("rapid", "line", "arc", "sync_line", "spindle_sync")
    return done, [(e["kind"], [round(v, 9) for v in e["end"]]) for e in done.events if e["kind"] in kinds]


@pytest.mark.parametrize(
    ("one", "two", "contour"),
    [
        ("G71 P10 Q20 U0.4 W0.1 D2. F0.2", "G71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.2", CONTOUR),
        ("G71 P10 Q20 U0.4 W0.1 D2000 F0.2", "G71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.2", CONTOUR),
        ("G72 P10 Q20 U0.4 W0.1 D2. F0.2", "G72 W2. R0.5\nG72 P10 Q20 U0.4 W0.1 F0.2", ALONG_X),
        ("G73 P10 Q20 U0.4 W0.1 D3 I4. K1. F0.2", "G73 U4. W1. R3\nG73 P10 Q20 U0.4 W0.1 F0.2", CONTOUR),
        ("G74 Z-20. K5. F0.1", "G74 R0.\nG74 Z-20. Q5000 F0.1", ""),
        ("G75 X20. Z-6. I2. K4. F0.1", "G75 R0.\nG75 X20. Z-6. P2000 Q4000 F0.1", ""),
    ],
)
def test_moves_are_those_of_two_blocks(program, one: str, two: str, contour: str) -> None:
    done, moves = _moves(program, one, contour)
    _, other = _moves(program, two, contour)

    assert done.findings == []
    assert len(moves) > 6
    assert moves == other


def test_a_thread_in_one_block_has_its_depths_and_no_pass_twice(program) -> None:
    done, one = _moves(program, "G76 X28. Z-20. K1.2 D0.4 A60 F2.")
    _, two = _moves(program, "G76 P010060 Q0 R0.\nG76 X28. Z-20. P1200 Q400 F2.")

    assert done.findings == []
    bottoms = [end[0] for kind, end in one if end[2] == pytest.approx(-20.0) and end[0] < 17.0]
    depths = [15.2 - bottom for bottom in bottoms]  # of the peak, X as a radius
    assert depths[:2] == pytest.approx([0.4, 0.4 * 2**0.5], abs=1e-3)  # of an increment
    assert depths[-1] == pytest.approx(1.2)
    assert 0 < len(two) - len(one) <= 5  # two blocks ask for a pass at full depth


def test_an_allowance_of_a_pass_between_is_told(program) -> None:
    done, _ = _moves(program, "G71 P10 Q20 U0.4 W0.1 D2. I0.3 F0.2", CONTOUR)

    assert [(f.code, f.message) for f in done.findings] == [("GS913", "G71 I is read, but not simulated")]


def test_finishing_with_compensation_is_no_rapid_at_the_contour_of_a_mill(program) -> None:
    contour = CONTOUR.replace("N10 G00 X12.", "N10 G00 G42 X12.").replace("N20 G01 X32.", "N20 G00 G40 X34.")
    done, _ = _moves(program, "G71 P10 Q20 U0.4 W0.1 D2. F0.2", contour + "G70 P10 Q20\n", tool_table=NOSE)

    assert [f.code for f in done.findings] == []


def test_finishing_with_compensation_goes_along_the_contour(program) -> None:
    """As the same blocks do outside a cycle; they came in the opposite order."""
    contour = "N10 G00 G42 X10. Z1.\nG1 Z-10. F0.1\nX20. Z-15.\nN20 G40 G0 X34.\n"
    head = "O1\nG21 G18 G40 G99\nT0101\nG97 S500 M3\nG0 X34. Z2.\n"
    ways = []
    for text in (head + contour, head + "G70 P10 Q20\nM30\n" + contour):
        done = program(text + "M30", dialect="fanuc_lathe", tool_table=NOSE)
        ends = [event["end"][::2] for event in done.acts("line")]
        ways.append([end[:2] for end in ends])

    assert ways[0] == ways[1]
    assert ways[1][0][0] == pytest.approx(5.0)


def test_the_nose_is_that_of_the_offset_of_the_tool(program) -> None:
    """Behind a cylinder of D10 a cone of 45 degrees begins: the tip of a nose R is R (1 - tan 22.5) ahead there."""
    head = "O1\nG21 G18 G40 G99\nT0101\nG97 S500 M3\nG0 X34. Z2.\n"
    contour = "G42 X10. Z1.\nG1 Z-10. F0.1\nX20. Z-15.\nG40 G0 X34.\nM30"
    done = program(head + contour, dialect="fanuc_lathe", tool_table=NOSE)

    assert done.findings == []
    cylinder = next(event["end"] for event in done.acts("line"))
    assert [cylinder[0], cylinder[2]] == pytest.approx([5.0, -10.0 - 0.8 * (1.0 - math.tan(math.radians(22.5)))])


def test_a_contour_that_ends_the_program_is_refused(program) -> None:
    done = program("%\nO1\nG21\nG70 P10 Q20\nN10 G0 X5.\nM30\nN20 X4.\nM30\n%\n", dialect="fanuc_lathe")

    assert [finding.code for finding in done.findings if finding.level >= Severity.ERROR] == ["GS106"]


def test_a_last_block_back_to_before_the_face_changes_no_pass(program) -> None:
    """`N20 G00 G40 Z1.`, as people write it behind the contour: out and back, no work there."""
    _, plain = _moves(program, "G71 P10 Q20 U0.4 W0.1 D2. F0.2", CONTOUR)
    behind = CONTOUR.replace("N20 G01 X32.", "G01 X32.\nN20 G00 Z1.")
    done, moves = _moves(program, "G71 P10 Q20 U0.4 W0.1 D2. F0.2", behind)

    assert done.findings == []
    assert [m for m in moves if m not in plain] == [("rapid", [16.2, 0, 1.1, 0, 0, 0])]
    assert [m for m in moves if m in plain] == plain


def test_rapids_between_pockets_stay_above_the_contour(program) -> None:
    """G71 of type II: the way from one pocket to the next leads round the ridge between them."""
    contour = [(1.0, 12.0), (0.0, 12.0), (-8.0, 8.0), (-14.0, 14.0), (-20.0, 7.0), (-27.0, 15.0), (-30.0, 17.0)]
    blocks = "".join(f"G01 X{2 * x} Z{z}\n" for z, x in contour[1:])
    done, moves = _moves(program, "G71 U2. R0.5\nG71 P10 Q20 F0.2", f"N10 G00 X24. Z1.\n{blocks}N20 X34.\n")
    z, x = np.array(contour[::-1]).T

    assert done.findings == []
    for (_, before), (kind, after) in itertools.pairwise(moves):
        if kind == "rapid":
            way = np.linspace(before, after, 200)
            inside = (way[:, 2] < 0.0) & (way[:, 2] > -30.0)
            assert (way[inside, 0] >= np.interp(way[inside, 2], z, x) - 1e-6).all(), (before, after)


def test_increments_and_the_escape_are_those_of_the_unit(program) -> None:
    """P400 of an inch program is 0.04 inch; a roughing pass that no R is said for backs off by half a millimetre."""
    head = "O0001\nG20 G18 G40 G99\nT0101\nG97 S500 M3\nG00 X1.2 Z0.2\n"
    thread = "G76 P010060 Q0 R0.\nG76 X1. Z-1. P400 Q200 F0.1\nM30"
    done = program(head + thread, dialect="fanuc_lathe")
    bottoms = [e["end"][0] for e in done.events if e.get("pitch")]
    assert bottoms[0] == pytest.approx(25.4 * (0.54 - 0.02), abs=3e-3)
    assert bottoms[-1] == pytest.approx(12.7)

    rough = "G71 P10 Q20 D0.05 F0.01\nN10 G00 X0.8\nG01 Z-1.\nN20 X1.2\nM30"
    done = program(head + rough, dialect="fanuc_lathe")
    cut = next(k for k, e in enumerate(done.events) if e["kind"] == "line")
    before, after = done.events[cut]["end"], done.events[cut + 1]["end"]
    assert after[0] - before[0] == pytest.approx(0.5, abs=2e-3) == pytest.approx(after[2] - before[2], abs=2e-3)


def test_a_finish_has_the_feed_of_its_block(program) -> None:
    """As on a Haas: `G70 P Q F`; what the contour itself says goes before it."""
    done = program(
        "O1\nG21 G18 G40 G99\nT0101\nG97 S500 M3\nG00 X34. Z2.\nG70 P10 Q20 F0.07\nGOTO 30\n"
        "N10 G00 X12. Z1.\nG01 Z-10.\nX20. Z-14. F0.2\nN20 G01 X32.\nN30 M30\n",
        dialect="fanuc_lathe",
    )

    assert done.findings == []
    assert [e["feed"] for e in done.events if e["kind"] == "line"] == pytest.approx([0.07, 0.2, 0.2])

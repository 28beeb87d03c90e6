"""What a machine carries, against the stock as it is cut by then."""

from __future__ import annotations

import pytest

from gcodesim.diagnostics import Severity
from tests.physics.runs import run_texts

HEAD = """gcodesim: 1
machine:
  axes:
    X: {travel: [0, 500 mm], speed: 20 m/min, acceleration: 2 m/s^2}
    Y: {travel: [0, 400 mm], speed: 20 m/min, acceleration: 2 m/s^2}
    Z: {travel: [-350, 0 mm], speed: 12 m/min, acceleration: 1.5 m/s^2}
work_offsets: {G54: {xyz: [200, 200, -250]}}
stock: {min: [0, 0, -40], max: [100, 80, 0], in: G54, material: foam, resolution: 0.5}
tools: {1: {type: flat_end_mill, diameter: 10, length: 30}}
fixtures:
  head: {box: [20, 20, 60], zero: bottom-center, in: machine/flange, rpy: [180, 0, 0]}
limits: {clearance: 1.5 mm}
"""
BEGIN = "G21 G90 G94 G61\nT1 M6\nG43 H1\nS10000 M3\nG0 X30 Y30 Z5\n"
END = "G0 Z5\nM5\nM2\n"
DIP = "G0 X45 Y40 Z5\nG1 Z-35 F1000\nG0 Z5\n"


def layers(deep: tuple[float, ...], rows: tuple[float, ...] = (30, 38, 46, 50)) -> str:
    """A pocket from X25 Y25 to X65 Y55, in zigzags."""
    lines = []
    for z in deep:
        lines += ["G0 X30 Y30", f"G1 Z{z} F1000"]
        for k, y in enumerate(rows):
            lines += [f"Y{y}", f"X{60 if k % 2 == 0 else 30}"]
        lines.append("G0 Z5")
    return "\n".join(lines) + "\n"


def crashes(program: str, cell: str = HEAD, world: str = "kinematic") -> list[tuple[str, int, float]]:
    """Code, line and depth or distance [mm] of what links have to do with the stock; each crash is an error."""
    found = [f for f in run_texts(program, cell, world=world).results.findings if f.code in ("GS307", "GS308")]
    assert all(f.level == Severity.ERROR for f in found if f.code == "GS307")
    return [(f.code, f.span.line, round(f.value or 0.0, 2)) for f in found]


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_a_head_goes_into_what_has_been_cut(world: str) -> None:
    """The nose comes 5 mm below the top of the stock: into a pocket, or into what stands there."""
    assert crashes(BEGIN + layers((-10, -20)) + DIP + END, world=world) == []
    assert crashes(BEGIN + DIP + END, world=world) == [("GS307", 7, 5.0)]


def test_what_is_cut_afterwards_stands_before() -> None:
    assert crashes(BEGIN + DIP + layers((-10, -20)) + END) == [("GS307", 7, 5.0)]


def test_an_island_is_hit_where_it_stands() -> None:
    """First contact at its top; the block that stood around it counts no longer."""
    cut = BEGIN + layers((-10, -20), (30, 50)).replace("Y50\nX30", "Y50\nX30\nY30") + DIP + END
    ran = run_texts(cut, HEAD)
    (hit,) = (f for f in ran.results.findings if f.code == "GS307")
    assert "they touch first when the tip is at X45.000 Y40.000 Z-30.00" in hit.message
    assert hit.value == pytest.approx(5.0, abs=2e-3)
    assert hit.bodies == ("head", "stock")
    assert hit.span.line == cut.splitlines().index("G1 Z-35 F1000") + 1


def test_a_thin_wall_is_not_jumped_over() -> None:
    """Two slots 1 mm apart; a slim head goes from the one through the wall into the other, in a rapid of 60 ms."""
    slots = "".join(f"G0 X{x} Y30 Z5\nG1 Z-20 F1000\nY50\nG0 Z5\n" for x in (36, 47))
    across = "G0 X36 Y40 Z5\nG1 Z-24 F1000\nG0 X47\nG0 Z5\n"
    cell = HEAD.replace("[20, 20, 60]", "[6, 6, 60]").replace("length: 30}", "length: 20}")
    (hit,) = crashes(BEGIN + slots + across + END, cell.replace("limits: {clearance: 1.5 mm}\n", ""))
    assert hit[:2] == ("GS307", 5 + 8 + 3)
    assert hit[2] == pytest.approx(3.0, abs=0.3)  # out of the column in its middle, to the nearer side


def test_a_near_miss_of_what_is_left() -> None:
    """The nose stays 1 mm above the top of the block; where that has been cut away, it has room."""
    cell = HEAD.replace("length: 30}", "length: 12, flute_length: 12}")
    dip = "G0 X45 Y40 Z5\nG1 Z-11 F1000\n"
    (near,) = crashes(BEGIN + dip + END, cell)
    assert near == ("GS308", 7, pytest.approx(1.0, abs=0.02))
    assert crashes(BEGIN + layers((-10,)) + dip + END, cell) == []
    assert crashes(BEGIN + dip + END, cell.replace("1.5 mm", "0.9 mm")) == []

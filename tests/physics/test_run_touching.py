"""Tools that touch just so, and rapids close above a stock, in whole runs with drawn numbers: no false alarm."""

from __future__ import annotations

import numpy as np
import pytest

from tests.physics.runs import run_texts

Draw = np.random.Generator


def machine(draw: Draw, rotation: str = "") -> str:
    """A machine of any acceleration, and its G54 at any place."""
    acceleration, at = 10.0 ** draw.uniform(1, 5), draw.uniform([380, 280, -220], [420, 320, -180]).round(4)
    axes = {"X": "0, 800", "Y": "0, 600", "Z": "-450, 0"}
    limits = f"speed: {draw.uniform(5, 60):.3f} m/min, acceleration: {acceleration:.5g} m/s^2"
    lines = "".join(f"    {axis}: {{travel: [{travel} mm], {limits}}}\n" for axis, travel in axes.items())
    return f"gcodesim: 1\nmachine:\n  axes:\n{lines}work_offsets: {{G54: {{xyz: {at.tolist()}{rotation}}}}}\n"


def told(program: list[str], cell: str) -> set[tuple[str, int]]:
    ran = run_texts("\n".join(["G21 G90 G17 G94 G61", "T1 M6", "G43 H1", "S6000 M3", *program, "M5", "M2", ""]), cell)
    return {(finding.code, finding.span.line) for finding in ran.bad}


def touching(seed: int, deeper: float) -> set[tuple[str, int]]:
    """A holder on the top of the stock, a mill along a rail and over a fixture that is flush with the stock."""
    draw = np.random.default_rng(seed)
    flutes, diameter, holder = (round(float(draw.uniform(*size)), 3) for size in ((4, 12), (3, 9), (20, 30)))
    turn = float(draw.choice([0.0, 90.0, draw.uniform(0, 90)]))
    cell = machine(draw, f", rpy: [0, 0, {turn:.2f}]") + (
        f"stock: {{min: [0, 0, -20], max: [50, 40, 0], in: G54, resolution: {draw.choice([0.5, 0.31])}}}\n"
        "fixtures:\n"
        "  beside: {box: [10, 40, 20], zero: top-front-right, in: G54}\n"
        "  rail: {box: [60, 10, 24], zero: bottom-front-left, in: G54, xyz: [0, 40, -20]}\n"
        f"tools:\n  1: {{type: flat_end_mill, diameter: {diameter}, length: {flutes}, flute_length: {flutes}, "
        f"holder: {{diameter: {holder}, length: 40}}}}\n"
    )
    inside, along = 40.0 - 0.5 * holder - 1.0, 40.0 - 0.5 * diameter + deeper
    holder_down = [f"G0 X20 Y{inside:.6f} Z15", f"G1 Z{-flutes - deeper:.6f} F600", "X30", "G0 Z30"]
    along_rail = [f"G0 X-20 Y{along:.6f}", "Z1", "G1 X45 F3000", "G0 Z30"]
    over_fixture = ["G0 X-5 Y10", f"Z{-deeper:.6f}", "G1 Y25 F3000", "G0 Z30"]
    return told([*holder_down, *along_rail, *over_fixture], cell)


@pytest.mark.parametrize("seed", range(14))
def test_what_touches_is_no_collision_and_a_hundredth_deeper_is_one(seed: int) -> None:
    """Of these holders eight were in the stock by rounding (GS405, 0.000 mm deep)."""
    assert touching(seed, 0.0) == set()
    assert {code for code, _ in touching(seed, 0.01)} == {"GS301", "GS405"}


TOOLS = (
    "{type: flat_end_mill, diameter: 10, length: 60, flute_length: 10}",
    "{type: drill, diameter: 6, length: 60, flute_length: 10}",
    "{type: lollipop_mill, diameter: 8, neck_diameter: 5, length: 60}",
    "{type: profile_mill, outline: [[0, 0], [3, 0], [3, 10]], shank_diameter: 12, length: 40, "
    "holder: {diameter: 40, length: 30}}",
    "{type: flat_end_mill, diameter: 8, length: 10, flute_length: 10, holder: {diameter: 30, length: 30}}",
)


@pytest.mark.parametrize("seed", range(20))
def test_a_rapid_just_above_the_stock_is_no_collision(seed: int) -> None:
    """0 to 0.2 mm above it, at accelerations from 10 to 1e5 m/s²; a third of the stocks lean away from the tool."""
    draw = np.random.default_rng(seed)
    height, lean = float(draw.choice([0.0, 1e-6, 1e-3, draw.uniform(0, 0.2)])), 0.0
    if seed % 3 == 2:
        lean = float(draw.uniform(5, 60))
    cell = machine(draw) + (
        f"stock: {{box: [100, 80, 40], zero: top-front-left, in: G54, rpy: [0, {lean:.3f}, 0], "
        f"resolution: {draw.choice([0.5, 1.0, 2.0])}}}\ntools: {{1: {TOOLS[seed % len(TOOLS)]}}}\n"
    )
    program = [str(draw.choice(["G61", "G64", "G64 P0.05"])), "G0 X-20 Y-20 Z30", f"Z{height:.7f}"]
    for _ in range(12):
        x, y = draw.uniform(-20, 120), draw.choice([0.0, 80.0, draw.uniform(-20, 100)])
        program.append(f"X{x:.4f} Y{y:.4f}")
        if draw.random() < 0.3:
            program += [f"Z{draw.uniform(1, 30):.3f}", f"Z{height:.7f}"]
    assert told([*program, "Z30"], cell) == set()

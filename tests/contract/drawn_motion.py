"""Machines and programs drawn at random, for what every motion promises: texts of cells and of programs."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import cos, radians, sin
from random import Random

LOADS = {"kuka_kr10_r1100_2": 10, "abb_irb1200_5_90": 5, "staubli_tx2_90": 14, "ur10e": 12, "fanuc_m20ia": 20}
ARMS = tuple(LOADS)
FAR = ("kuka_kr10_r1100_2", "staubli_tx2_90", "ur10e")
"""Arms that reach work 0.7 m before them."""
TOOL = "tools: {1: {type: ball_end_mill, diameter: 8, flutes: 2, length: 60}}\n"
MODES = ("G61", "G64", "G64 P0.05", "G64 P0.5 Q0.01", "G61.1")
OFTEN = 0.5


@dataclass(frozen=True)
class Drawn:
    """A cell and a program for it; `others` are those of further channels."""

    cell: str
    program: str
    others: Mapping[str, str] = field(default_factory=dict)


def _axis(rng: Random, letter: str, *, rotary: bool = False, more: str = "") -> str:
    if rotary:
        speed, travel = rng.uniform(30, 400), "unlimited" if letter == "C" else "[-110, 110 deg]"
        return (
            f"    {letter}: {{travel: {travel}, speed: {speed:.1f} deg/s,"
            f" acceleration: {speed * rng.uniform(2, 12):.1f} deg/s^2{more}}}\n"
        )
    speed = rng.uniform(60, 900)
    return (
        f"    {letter}: {{travel: [-600, 600 mm], speed: {speed:.1f} mm/s,"
        f" acceleration: {speed * rng.uniform(3, 20):.1f} mm/s^2{more}}}\n"
    )


def _feed(rng: Random) -> str:
    return f"F{10 ** rng.uniform(2.2, 4.5):.0f}"


def _mode(rng: Random) -> str:
    return rng.choice(MODES)


def _points(rng: Random, count: int, size: float) -> list[tuple[float, float, float]]:
    """Far ones, near ones, and some that go on in nearly the same direction."""
    points, here, way = [], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]
    for _ in range(count):
        bend = rng.choice((0.0, 0.02, 0.5, 3.0))
        way = [w + bend * rng.uniform(-1, 1) for w in way]
        long = size * 10 ** rng.uniform(-2.5, -0.3) / max(sum(w * w for w in way) ** 0.5, 1e-3)
        here = [min(max(h + long * w, -size), size) for h, w in zip(here, way, strict=True)]
        points.append((here[0], here[1], here[2]))
    return points


def _arc(rng: Random) -> str:
    """A whole or part of a circle or helix from where the tool is, relative to there."""
    radius, turn = 10 ** rng.uniform(-0.3, 1.0), radians(rng.choice((30, 90, 200, 360)))
    x, y = radius * (1 - cos(turn)), radius * sin(turn)
    return f"G91 G2 X{x:.5f} Y{y:.5f} Z{rng.uniform(-1, 1):.3f} I{radius:.5f} J0 {_feed(rng)}\nG90"


def _moves(rng: Random, count: int, size: float, words: Callable[[], str], *, arcs: bool = True) -> str:
    """Lines of a program; `words` are added to every block."""
    lines = []
    for x, y, z in _points(rng, count, size):
        if arcs and rng.random() < 0.15:
            lines.append(_arc(rng))
        if rng.random() < 0.1:
            lines.append(_mode(rng))
        if rng.random() < 0.05:
            lines.append("G4 P0.01")
        word = "G0" if rng.random() < 0.15 else "G1"
        lines.append(f"{word} X{x:.4f} Y{y:.4f} Z{z:.4f} {words()} {_feed(rng) if word == 'G1' else ''}".strip())
    return "\n".join(lines) + "\n"


def mill(rng: Random) -> Drawn:
    """A machine tool with three axes, or four whose last one is commanded like the others."""
    letters = "XYZ" + rng.choice(("", "A", "B", "C"))
    axes = "".join(_axis(rng, letter, rotary=letter in "ABC") for letter in letters)
    rapids = rng.choice(("linear", "independent"))
    cell = f"gcodesim: 1\nmachine:\n  rapids: {rapids}\n  axes:\n{axes}{TOOL}"

    def words() -> str:
        return f"{letters[3]}{rng.uniform(-90, 90):.3f}" if len(letters) > 3 and rng.random() < OFTEN else ""

    return Drawn(cell, f"G21 G90 G94 {_mode(rng)}\n{_moves(rng, 25, 60, words)}M2\n")


def five_axes(rng: Random) -> Drawn:
    """A machine tool with two rotary axes in table or head; the tip is commanded by rotary words (G43.4)."""
    linear = "".join(_axis(rng, letter) for letter in "XYZ")
    at, pivot = (
        f", at: [0, 0, {rng.uniform(-150, 0):.0f} mm]",
        f", side: tool, at: [0, 0, {rng.uniform(80, 200):.0f} mm]",
    )
    first, more = rng.choice((("A", at), ("B", at), ("B", pivot), ("A", pivot)))
    rotary = _axis(rng, first, rotary=True, more=more) + _axis(rng, "C", rotary=True, more=at)
    cell = f"gcodesim: 1\nmachine:\n  axes:\n{linear}{rotary}{TOOL}"
    return Drawn(cell, _by_rotary_words(rng, first))


def _by_rotary_words(rng: Random, first: str) -> str:
    state = [0.0, 0.0]

    def words() -> str:
        if rng.random() < OFTEN:
            big = rng.choice((0.5, 5.0, 40.0))
            state[:] = [max(min(state[0] + big * rng.uniform(-1, 1), 80), -80), state[1] + big * rng.uniform(-2, 2)]
        return f"{first}{state[0]:.4f} C{state[1]:.4f}"

    moves = _moves(rng, 25, 40, words)
    return f"G21 G90 G94 {_mode(rng)}\nT1 M6\nG43 H1\nM428\nG0 X0 Y0 Z5 {first}0 C0\n{moves}M429\nM2\n"


def nutating(rng: Random) -> Drawn:
    """A table that tilts about an axis at 45 degrees and turns, or a head that does; the tip is commanded."""
    linear = "".join(_axis(rng, letter) for letter in "XYZ")
    slope = rng.choice(("[0, 1, 1]", "[0, 1, -1]"))
    table = f", at: [0, 0, {rng.uniform(-150, 0):.0f} mm]"
    head = f", side: tool, at: [0, {rng.uniform(-40, 40):.0f}, {rng.uniform(80, 200):.0f} mm]"
    place = rng.choice((table, head))
    rotary = _axis(rng, "B", rotary=True, more=f"{place}, direction: {slope}") + _axis(
        rng, "C", rotary=True, more=table
    )
    cell = f"gcodesim: 1\nmachine:\n  axes:\n{linear}{rotary}{TOOL}"
    return Drawn(cell, _by_rotary_words(rng, "B"))


def inverse_time(rng: Random) -> Drawn:
    """Four axes whose blocks have a time each (G93), many of them too short."""
    axes = "".join(_axis(rng, letter) for letter in "XYZ") + _axis(rng, "A", rotary=True)
    lines = [f"G21 G90 {_mode(rng)}", "G93"]
    for x, y, z in _points(rng, 25, 60):
        lines.append(f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f} A{rng.uniform(-90, 90):.3f} F{10 ** rng.uniform(1, 4):.3f}")
    return Drawn(f"gcodesim: 1\nmachine:\n  axes:\n{axes}{TOOL}", "\n".join([*lines, "M2\n"]))


def _bent(rng: Random, plane: int) -> str:
    """A circle in a plane, a helix about its axis, or a cubic or quadratic spline, relative to where the tool is."""
    radius, turn = 10 ** rng.uniform(-0.3, 1.0), radians(rng.choice((30, 90, 200, 360)))
    a, b, c, i, j = (("X", "Y", "Z", "I", "J"), ("Z", "X", "Y", "K", "I"), ("Y", "Z", "X", "J", "K"))[plane - 17]
    u, v = radius * (1 - cos(turn)), radius * sin(turn)
    if plane == 17 and rng.random() < OFTEN:
        p, q, x, y = (rng.uniform(-8, 8) for _ in range(4))
        spline = (
            f"G5.1 X{x:.4f} Y{y:.4f} I{p:.4f} J{q:.4f}",
            f"G5 X{x:.4f} Y{y:.4f} I{p:.4f} J{q:.4f} P{q:.4f} Q{p:.4f}",
        )
        return f"{rng.choice(spline)} {_feed(rng)}"
    word = f"G2 {a}{u:.5f} {b}{v:.5f} {c}{rng.uniform(-1, 1):.3f} {i}{radius:.5f} {j}0"
    return f"G{plane} {word} {_feed(rng)}"


def bent_ways(rng: Random) -> Drawn:
    """A mill with three axes that runs circles in all planes, helices and splines; feeds by time or by turns (G95)."""
    axes = "".join(_axis(rng, letter) for letter in "XYZ")
    lines = [f"G21 G91 G94 {_mode(rng)}"]
    if rng.random() < OFTEN:
        lines = [f"G21 G91 G95 S{rng.uniform(500, 20000):.0f} M3 {_mode(rng)}"]
    for _ in range(20):
        line = _bent(rng, rng.choice((17, 18, 19)))
        lines.append(re.sub(r"F([0-9]+)", lambda f: f"F{int(f[1]) / 5000:.4f}", line) if "G95" in lines[0] else line)
        if rng.random() < OFTEN:
            lines.append(f"G17 G1 X{rng.uniform(-9, 9):.3f} Y{rng.uniform(-9, 9):.3f} Z{rng.uniform(-3, 3):.3f}")
    return Drawn(f"gcodesim: 1\nmachine:\n  axes:\n{axes}{TOOL}", "\n".join([*lines, "M5", "M2\n"]))


def turning(rng: Random) -> Drawn:
    """A lathe: feeds per turn at a constant cutting speed, arcs, threads, and its turret's rest as machine zero."""
    nose = rng.choice(("", ", nose: [-150, -600 mm]"))
    slides = ", ".join(f"{letter}: {{acceleration: {rng.uniform(1, 6):.2f} m/s^2}}" for letter in "XZ")
    cell = (
        f"gcodesim: 1\nmachine: {{model: lathe_xz{nose}, axes: {{{slides}}}}}\n"
        "stock: {cylinder: [60, 120], xyz: [0, 0, -120]}\ntools: {1: {type: turning_tool}}\n"
    )
    speed, most = rng.uniform(30, 400), rng.uniform(500, 5000)
    lines = [f"G21 G18 G7 G90 {_mode(rng)}", "T1 M6 G43", f"G96 S{speed:.0f} D{most:.0f} M3", "G95"]
    for _ in range(6):
        x, z, feed = rng.uniform(0, 60), rng.uniform(-80, 0), 10 ** rng.uniform(-2, 0.3)
        lines += ["G0 X64 Z2", f"X{x:.3f}", f"G1 Z{z:.3f} F{feed:.4f}", f"G2 X{x + 4:.3f} Z{z - 2:.3f} R2"]
        lines += [f"G1 X{rng.uniform(x + 4, 64):.3f}", "G0 X66"]
    lines += [
        f"G97 S{rng.uniform(100, 1500):.0f}",
        "G0 X58 Z4",
        f"G33 Z-40 K{rng.uniform(0.5, 4):.3f}",
        "G0 X70",
        "G28",
    ]
    return Drawn(cell, "\n".join([*lines, "M5", "M2\n"]))


def five_axes_by_vectors(rng: Random) -> Drawn:
    """The same machines with the direction of the tool as a vector (G43.5)."""
    return Drawn(five_axes(rng).cell.replace("gcodesim: 1\n", "gcodesim: 1\ndialect: fanuc\n"), _by_vectors(rng))


def _by_vectors(rng: Random) -> str:
    lean, around = [radians(rng.uniform(2, 30))], [rng.uniform(0, 6.3)]

    def words() -> str:
        if rng.random() < OFTEN:
            lean[0] = min(max(lean[0] + radians(rng.uniform(-15, 15)), 0.0), radians(40))
            around[0] += rng.choice((0.02, 0.3, 1.0)) * rng.uniform(-1, 1)
        i, j = sin(lean[0]) * cos(around[0]), sin(lean[0]) * sin(around[0])
        return f"I{i:.6f} J{j:.6f} K{cos(lean[0]):.6f}"

    moves = _moves(rng, 25, 40, words, arcs=False)
    moves = "\n".join(line.split(" ")[0] if line.startswith(("G64", "G61")) else line for line in moves.splitlines())
    moves = moves.replace("G61.1", "G61")
    return (
        f"%\nO1\nG21 G90 G49 G94 G54 {rng.choice(('G61', 'G64'))}\nT1 M6\nG43.5 H1\nG0 Z20. I0. J0. K1.\n"
        f"{moves}\nG0 Z40. I0. J0. K1.\nG49\nM30\n%\n"
    )


def _arm(rng: Random, more: str = "") -> str:
    model = rng.choice(ARMS)
    reach = {"ur10e": 0.75, "fanuc_m20ia": 1.0}.get(model, 0.5)
    x, y, z = (1000 * reach * c for c in (rng.uniform(0.8, 1.1), rng.uniform(-0.5, 0.5), rng.uniform(0.3, 0.8)))
    payload = f"{{mass: {rng.uniform(0, 1.2) * LOADS[model]:.1f} kg}}"
    return (
        f"gcodesim: 1\nrobots:\n  arm: {{model: {model}, payload: {payload}}}\n"
        f"work_offsets: {{G54: {{in: world, xyz: [{x:.1f}, {y:.1f}, {z:.1f}]}}}}\n{more}{TOOL}"
    )


def arm(rng: Random) -> Drawn:
    """An arm with the tool upright, leaned, or nearly level, where its wrist may be singular; spin free or given."""
    spin = rng.choice(("", ", spin: 0", f", spin: {rng.uniform(-180, 180):.0f} deg"))
    axis = rng.choice(("-Z of G54", "+X of G54"))
    turn = rng.choice(("[0, 0, 0]", "[5 deg, 20 deg, 0]", f"[0, {rng.uniform(-8, 8):.3f} deg, 0]"))
    cell = _arm(rng, f"orientation: {{tool_axis: {axis}{spin}}}\n").replace("]}}\n", f"], rpy: {turn}}}}}\n", 1)
    return Drawn(cell, f"G21 G90 G94 {_mode(rng)}\nT1 M6\n{_moves(rng, 25, 80, str)}M2\n")


def arm_by_vectors(rng: Random) -> Drawn:
    """An arm whose tool leans along vectors (G43.5)."""
    return Drawn(_arm(rng, "").replace("gcodesim: 1\n", "gcodesim: 1\ndialect: fanuc\n"), _by_vectors(rng))


def arm_by_words(rng: Random) -> Drawn:
    """An arm whose tool leans by the words A and C."""
    angles = [0.0, 0.0]

    def words() -> str:
        if rng.random() < OFTEN:
            big = rng.choice((0.5, 5.0, 30.0))
            angles[:] = [max(min(angles[0] + big * rng.uniform(-1, 1), 40), -40), angles[1] + big * rng.uniform(-1, 1)]
        return f"A{angles[0]:.4f} C{angles[1]:.4f}"

    cell = _arm(rng, 'orientation: {words: "Z(-C) X(-A)"}\n')
    return Drawn(cell, f"G21 G90 G94 {_mode(rng)}\nT1 M6\nM428\nG0 X0 Y0 Z5 A0 C0\n{_moves(rng, 25, 60, words)}M2\n")


def arm_on_a_rail(rng: Random) -> Drawn:
    """A rail that carries the arm, commanded by its letter or chosen along the path."""
    free = rng.random() < OFTEN
    rail = (
        f"externals:\n  rail: {{carries: arm{', free: true' if free else ''}, axes: {{U: {{travel: [0, 2 m],"
        f" speed: {rng.uniform(0.2, 1.5):.2f} m/s, acceleration: {rng.uniform(0.5, 5):.2f} m/s^2, home: 900 mm}}}}}}\n"
    )
    cell = _arm(rng, rail).replace("xyz: [", "xyz: [900.0, 620.0, 400.0]}}\n# [", 1)
    place = [900.0]

    def words() -> str:
        if free or rng.random() < OFTEN:
            return ""
        place[0] = min(max(place[0] + rng.choice((3, 100)) * rng.uniform(-1, 1), 850), 950)
        return f"U{place[0]:.3f}"

    return Drawn(cell, f"G21 G90 G94 {_mode(rng)}\nT1 M6\n{_moves(rng, 20, 80, words)}M2\n")


def arm_at_a_table(rng: Random) -> Drawn:
    """A turn-tilt table that carries the work of an arm."""
    table = (
        "externals:\n  positioner:\n    axes:\n"
        + "  "
        + _axis(rng, "A", rotary=True, more=", at: [0, 0, 40]")
        + "  "
        + _axis(rng, "C", rotary=True)
        + "    base: {in: world, xyz: [600, 0, 250]}\n"
    )
    cell = (
        f"gcodesim: 1\nrobots: {{arm: {{model: kuka_kr10_r1100_2}}}}\n{table}"
        f"work_offsets: {{G54: {{in: positioner, xyz: [0, 0, 70]}}}}\n{TOOL}"
    )
    angles = [0.0, 0.0]

    def words() -> str:
        if rng.random() < OFTEN:
            big = rng.choice((0.5, 5.0, 30.0))
            angles[:] = [max(min(angles[0] + big * rng.uniform(-1, 1), 30), -30), angles[1] + big * rng.uniform(-1, 1)]
        return f"A{angles[0]:.4f} C{angles[1]:.4f}"

    return Drawn(cell, f"G21 G90 G94 {_mode(rng)}\nT1 M6\n{_moves(rng, 20, 30, words)}M2\n")


def arm_at_a_free_table(rng: Random) -> Drawn:
    """Work on a turntable, or on a turn-tilt table, that the planner turns to the arm; one axis may be commanded."""
    tilts = rng.choice(("", "  " + _axis(rng, "A", rotary=True, more=", at: [0, 0, 40]")))
    free = rng.choice(("whole", "turn")) if tilts else "whole"
    turns = "  " + _axis(rng, "C", rotary=True, more=", free: true" if free == "turn" else "")
    whole = "    free: true\n" if free == "whole" else ""
    lean = rng.choice(("", "orientation: {tool_axis: -Z of G54}\n"))
    cell = (
        f"gcodesim: 1\nrobots: {{arm: {{model: {rng.choice(FAR[:2])}}}}}\n"
        f"externals:\n  positioner:\n    axes:\n{tilts}{turns}    base: {{in: world, xyz: [650, 0, 250]}}\n{whole}"
        f"work_offsets: {{G54: {{in: positioner, xyz: [0, 0, 70]}}}}\n{lean}{TOOL}"
    )
    angle = [0.0]

    def words() -> str:
        if free == "whole" or rng.random() < OFTEN:
            return ""
        angle[0] = max(min(angle[0] + rng.choice((0.5, 5.0)) * rng.uniform(-1, 1), 25), -25)
        return f"A{angle[0]:.4f}"

    return Drawn(cell, f"G21 G90 G94 {_mode(rng)}\nT1 M6\n{_moves(rng, 20, 60, words)}M2\n")


def arm_at_a_bar(rng: Random) -> Drawn:
    """A bar that turns on and on below the tool, as printers of tubes have it, on a slide or not; any arm."""
    speed = rng.uniform(60, 720)
    about = f"speed: {speed:.0f} deg/s, acceleration: {speed * rng.uniform(2, 12):.0f} deg/s^2"
    slide = (
        f"      V: {{travel: [-200, 200 mm], speed: {rng.uniform(100, 800):.0f} mm/s}}\n"
        if rng.random() < OFTEN
        else ""
    )
    cell = (
        f"gcodesim: 1\nrobots: {{arm: {{model: {rng.choice(FAR)}}}}}\nexternals:\n  spindle:\n    axes:\n{slide}"
        f"      A: {{travel: unlimited, {about}}}\n"
        "    base: {in: world, xyz: [700, 0, 350]}\n"
        f"frames: {{above: {{in: world, xyz: [700, 0, 350]}}}}\n"
        f"work_offsets: {{G54: {{in: above}}}}\norientation: {{tool_axis: -Z of world}}\n{TOOL}"
    )
    lines, turn, place = [], 0.0, 0.0
    for k in range(20):
        turn += rng.choice((3.0, 60.0, 1000.0)) * rng.uniform(-0.3, 1.0)
        place = max(min(place + rng.uniform(-60, 60), 150), -150) if slide and rng.random() < OFTEN else place
        words = f"A{turn:.3f}" + (f" V{place:.3f}" if slide else "")
        x, z = rng.uniform(-60, 60), 20 + 0.3 * k
        lines.append(
            f"{rng.choice(('G0', 'G1', 'G1'))} X{x:.3f} Y{rng.uniform(-1, 1):.3f} Z{z:.2f} {words} {_feed(rng)}"
        )
    return Drawn(cell, f"G21 G90 G94 {_mode(rng)}\nT1 M6\nG0 X0 Y0 Z20\n" + "\n".join(lines) + "\nM2\n")


def arm_that_pushes(rng: Random) -> Drawn:
    """An arm whose motors have friction and rotors, with a spring at the tip and a force that its work is to make."""
    drawn = arm(rng)
    friction = ", ".join(f"{rng.uniform(0, 0.05) * most:.1f}" for most in (150, 150, 80, 20, 20, 10))
    arm_ = f"arm: {{controller: {{type: computed_torque, friction: [{friction} N·m]}}, model"
    spring = ", ".join(f"{rng.uniform(-20, 20):.0f}" for _ in range(3))
    load = f"load: {{force: [{spring} N], frame: {rng.choice(('world', 'tool'))}}}"
    tool = f"length: 60, {load}, expected_force: {rng.uniform(5, 80):.0f} N}}"
    return Drawn(drawn.cell.replace("arm: {model", arm_).replace("length: 60}", tool), drawn.program)


def arm_with_stands(rng: Random) -> Drawn:
    """An arm that drives to a rack to change its tools, and home in between."""
    turn, load = rng.uniform(-20, 20), rng.uniform(0, 8)
    cell = (
        "gcodesim: 1\nrobots:\n"
        f"  arm: {{model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], payload: {{mass: {load:.1f} kg}}}}\n"
        f"frames: {{rack: {{in: world, xyz: [{rng.uniform(250, 350):.0f}, {rng.uniform(420, 500):.0f}, 160]}}}}\n"
        f"work_offsets: {{G54: {{in: world, xyz: [{rng.uniform(520, 640):.0f}, -60, 200], rpy: [0, 0, {turn:.0f}]}}}}\n"
        "magazine:\n  stands:\n"
        "    1: {in: rack, xyz: [-100, 0, 200], rpy: [180, 0, 0], approach: 80, slide: [0, -140, 0]}\n"
        "    2: {in: rack, xyz: [100, 0, 200], rpy: [180, 0, 0], approach: 60, slide: [0, -100, 30]}\n"
        "tools:\n  1: {type: flat_end_mill, diameter: 10, length: 70, mass: 2 kg}\n"
        "  2: {type: ball_end_mill, diameter: 6, length: 120, mass: 0.4 kg}\n"
    )
    parts = [f"T{tool} M6\n{_moves(rng, 5, 40, str)}{rng.choice(('G28', 'G4 P0.2'))}\n" for tool in (1, 2, 1)]
    return Drawn(cell, f"G21 G90 G94 {_mode(rng)}\n{''.join(parts)}T0 M6\nM2\n")


def probing_mill(rng: Random) -> Drawn:
    """A mill that probes its stock: each trip begins to brake where the ball touches."""
    axes = "".join(_axis(rng, letter) for letter in "XYZ")
    stock = "stock: {box: [60, 40, 20], zero: top-front-left, material: al6082_t6, resolution: 1}\n"
    cell = f"gcodesim: 1\nmachine:\n  axes:\n{axes}{stock}tools: {{1: {{type: probe, diameter: 3, length: 60}}}}\n"
    lines = ["G21 G90 G94", _mode(rng), "T1 M6", "G43 H1", "G0 X5 Y5 Z10"]
    for _ in range(4):
        x, y, feed = rng.uniform(5, 55), rng.uniform(5, 35), 10 ** rng.uniform(1.5, 3.5)
        lines += [
            f"G0 X{x:.2f} Y{y:.2f}",
            f"G38.3 Z-3 F{feed:.0f}",
            "G91",
            "G0 Z2",
            f"G38.3 Z-4 F{feed / 8:.0f}",
            "G90",
        ]
        lines += [f"G1 Z10 {_feed(rng)}"]
    lines += ["G0 X-20 Y20", "G0 Z-8", f"G38.3 X5 {_feed(rng)}", "G0 X-20", "M2"]
    return Drawn(cell, "\n".join(lines) + "\n")


def spraying_arm(rng: Random) -> Drawn:
    """An arm with a spray gun that is switched on the way, in passes with overrun; outputs join no blocks."""
    gun = "tools: {1: {type: spray_gun, cone: 30 deg, efficiency: 0.65, solids: 0.45, length: 150, mass: 1.5 kg}}\n"
    cell = arm(rng).cell.replace(TOOL, gun) + "m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}\n"
    lines = []
    for k in range(5):
        x = 40.0 if k % 2 == 0 else -40.0
        lines += [f"G1 X{x} Y{8 * k} {_feed(rng)}", rng.choice(("M10", "M62 P1")), f"G1 X{-x} {_feed(rng)}", "M11"]
    return Drawn(cell, f"G21 G90 G94 {_mode(rng)}\nT1 M6\nG0 X-40 Y0 Z0\n" + "\n".join(lines) + "\nM2\n")


def two_arms(rng: Random) -> Drawn:
    """Two arms whose programs wait for each other; the one of the second is in the cell."""
    cell = (
        "gcodesim: 1\nframes: {table: {in: world, xyz: [770, 0, 300]}}\nrobots:\n"
        "  left: {model: kuka_kr10_r1100_2}\n"
        "  right: {model: kuka_kr10_r1100_2, base: {in: world, xyz: [1540, 0, 0], rpy: [0, 0, 180]}}\n"
        "channels:\n"
        "  main: {robot: left, work_offsets: {G54: {in: table}}, m_codes: {M200: {wait: half}}}\n"
        "  right: {robot: right, work_offsets: {G54: {in: table}}, m_codes: {M200: {wait: half}}}\n"
        "tools:\n  1: {type: flat_end_mill, diameter: 10, length: 60}\n"
        "  2: {type: flat_end_mill, diameter: 8, length: 60}\n"
    )
    programs = []
    for tool, side in ((1, -150), (2, 150)):
        begin = f"G21 G90 G94 {_mode(rng)}\nT{tool} M6\nG0 X{side} Y0 Z60\nG92 X0 Y0 Z0\n"
        parts = [_moves(rng, 6, 40, str), "M200\n", _moves(rng, 6, 40, str)]
        programs.append(f"{begin}{''.join(parts)}M2\n")
    return Drawn(cell, programs[0], {"right": programs[1]})


def with_jerk(drawn: Drawn, rng: Random) -> Drawn:
    """The same with limits of jerk: full acceleration takes from 10 to 200 ms to build up."""

    def of_axis(found: re.Match[str]) -> str:
        return f"{found[0]}, jerk: {float(found[1]) / 10 ** rng.uniform(-2.0, -0.7):.5g} {found[2]}^3"

    cell = re.sub(r"acceleration: ([0-9.]+) ((?:mm|deg|m)/s)\^2", of_axis, drawn.cell)
    joints = ", ".join(f"{900.0 / 10 ** rng.uniform(-2.0, -0.5):.0f}" for _ in range(6))
    return Drawn(
        re.sub(r"(model: (?!lathe)\w+)(?=[,}])", rf"\1, jerk: [{joints} deg/s^3]", cell), drawn.program, drawn.others
    )


KINDS: dict[str, Callable[[Random], Drawn]] = {
    "mill": mill,
    "mill with times": inverse_time,
    "mill along bent ways": bent_ways,
    "lathe": turning,
    "five axes": five_axes,
    "five axes, nutating": nutating,
    "five axes by vectors": five_axes_by_vectors,
    "arm": arm,
    "arm that pushes": arm_that_pushes,
    "arm by vectors": arm_by_vectors,
    "arm by words": arm_by_words,
    "arm with stands": arm_with_stands,
    "arm that sprays": spraying_arm,
    "arms, two": two_arms,
    "probing mill": probing_mill,
    "arm on a rail": arm_on_a_rail,
    "arm at a table": arm_at_a_table,
    "arm at a free table": arm_at_a_free_table,
    "arm at a bar": arm_at_a_bar,
}

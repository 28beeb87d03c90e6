"""Drawn five-axis machines and programs against products of matrices: rotary words, vectors, tilted planes.

The oracle has matrices of its own for tables, heads and axes that lean, and finds the turns of a direction from three
looks at the tool. Poles, axes that wind up and travel that makes them rewind are among what is drawn.
"""

from __future__ import annotations

from pathlib import Path
from random import Random

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import Options, prepare
from tests.unit.planning.test_tilted_planes import plane

UNIT = dict(zip("ABC", np.eye(3), strict=True))
FEW, MANY = range(8), range(8, 208)
WORDS, SWITCHED, VECTORS, PLANES = "rotary words", "M428", "vectors", "planes"
Angles = dict[str, float]


def turned(vector: np.ndarray, point: np.ndarray, degrees: float) -> np.ndarray:
    """The matrix (4, 4) of a turn about a line (Rodrigues 1840)."""
    v, angle = vector / np.linalg.norm(vector), np.radians(degrees)
    K = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    X = np.eye(4)
    X[:3, :3] += np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    X[:3, 3] = point - X[:3, :3] @ point
    return X


class Machine:
    """A drawn machine; lengths in mm, angles in degrees."""

    def __init__(self, rng: np.random.Generator) -> None:
        kind = str(rng.choice(["tables", "heads", "head and table", "leaning table", "leaning head"]))
        self.tilting = tilting = str(rng.choice(["A", "B"]))
        leans = "leaning" in kind
        along = UNIT[tilting] + rng.choice([-1.0, 1.0]) * UNIT["C"] if leans else rng.choice([-1, 1]) * UNIT[tilting]
        on_tool = kind in ("heads", "head and table", "leaning head")
        c_on_tool = kind == "heads" or (kind == "leaning head" and rng.random() < 0.5)
        sides = {tilting: "tool" if on_tool else "table", "C": "tool" if c_on_tool else "table"}
        vectors = {tilting: along, "C": rng.choice([-1.0, 1.0]) * UNIT["C"]}
        # C is nearest to the work on a table, and nearest to the frame in a head
        order = ["C", tilting] if c_on_tool else [tilting, "C"]
        self.axes = [(letter, sides[letter], vectors[letter], rng.uniform(-120, 120, 3).round(2)) for letter in order]
        self.zero, self.length = rng.uniform(-60, 60, 3).round(3), round(float(rng.uniform(20, 150)), 2)
        most = 180.0 if leans else float(rng.integers(95, 180))
        self.travel = {tilting: (-most, most), "C": (-900.0, 900.0)}
        if rng.random() < 0.5:  # so little that C has to rewind
            self.travel["C"] = (float(rng.integers(-400, -190)), float(rng.integers(190, 400)))

    def cell(self, dialect: str) -> str:
        axes = "".join(
            f"    {letter}: {{travel: [-3, 3 m], speed: 60 m/min, acceleration: 8 m/s^2}}\n" for letter in "XYZ"
        )
        for letter, side, vector, point in self.axes:
            low, high = self.travel[letter]
            axes += (
                f"    {letter}: {{travel: [{low}, {high} deg], speed: 720 deg/s, acceleration: 7200 deg/s^2,"
                f" side: {side}, at: {point.tolist()}, direction: {vector.tolist()}}}\n"
            )
        return (
            f"gcodesim: 1\ndialect: {dialect}\nmachine:\n  axes:\n{axes}"
            f"work_offsets: {{G54: {{xyz: {self.zero.tolist()}}}}}\n"
            f"tools:\n  1: {{type: ball_end_mill, diameter: 8, flutes: 2, length: {self.length} mm}}\n"
        )

    def sides(self, angles: Angles) -> tuple[np.ndarray, np.ndarray]:
        """Head and table (4, 4) with X, Y, Z at zero."""
        head, table = np.eye(4), np.eye(4)
        for letter, side, vector, point in self.axes:
            if side == "tool":
                head = head @ turned(vector, point, angles[letter])
            else:
                table = table @ turned(vector, point, angles[letter])
        return head, table

    def linear(self, tip: np.ndarray, angles: Angles) -> np.ndarray:
        """X, Y, Z of the axes with the tip at a point (3,) of the work, whose zero is G54."""
        head, table = self.sides(angles)
        tool: np.ndarray = (table @ [*(self.zero + tip), 1.0] - head @ [0.0, 0.0, -self.length, 1.0])[:3]
        return tool

    def direction(self, angles: Angles) -> np.ndarray:
        """From tip to holder, in the work."""
        head, table = self.sides(angles)
        return table[:3, :3].T @ head[:3, 2]

    def ways(self, w: np.ndarray, here: Angles) -> list[Angles]:
        """The turns that bring the tool along `w` (3,), each whole turns on inside the travel, nearest to `here`."""
        about = next(vector for letter, _, vector, _ in self.axes if letter == "C")
        on_tool = next(side for letter, side, _, _ in self.axes if letter == "C") == "tool"
        zero, quarter, half = (self.direction({self.tilting: angle, "C": 0.0}) @ about for angle in (0.0, 90.0, 180.0))
        a, b, middle = 0.5 * (zero - half), quarter - 0.5 * (zero + half), 0.5 * (zero + half)
        share = (w @ about - middle) / np.hypot(a, b)
        if abs(share) > 1.0 + 1e-9:
            return []
        base, spread = np.degrees(np.arctan2(b, a)), np.degrees(np.arccos(np.clip(share, -1.0, 1.0)))
        found = []
        for tilt in {base + spread, base - spread}:
            u = self.direction({self.tilting: tilt, "C": 0.0})
            u, v = u - (u @ about) * about, w - (w @ about) * about
            turn = np.degrees(np.arctan2(about @ np.cross(u, v), u @ v)) * (1.0 if on_tool else -1.0)
            at_pole = min(np.linalg.norm(u), np.linalg.norm(v)) < 5e-7
            wanted = {self.tilting: tilt, "C": here["C"] if at_pole else turn}
            way = {letter: self._inside(letter, value, here[letter]) for letter, value in wanted.items()}
            found += [{letter: value for letter, value in way.items() if value is not None}]
        return [way for way in found if len(way) == 2]

    def _inside(self, letter: str, value: float, here: float) -> float | None:
        low, high = self.travel[letter]
        turns = value + 360.0 * (np.arange(-6, 7) + np.round((here - value) / 360.0))
        turns = turns[(turns >= low - 1e-7) & (turns <= high + 1e-7)]
        return float(turns[np.argmin(np.abs(turns - here))]) if len(turns) else None

    def nearest(self, ways: list[Angles], here: Angles) -> Angles | None:
        """The way with the shortest turns; None where there is none, or two are as short."""
        costs = sorted((sum(abs(way[letter] - here[letter]) for letter in here), k) for k, way in enumerate(ways))
        if not costs or (len(costs) == 2 and costs[1][0] - costs[0][0] < 1e-4):
            return None
        return ways[costs[0][1]]


Expected = dict[int, tuple[np.ndarray, Angles]]  # tip in the work and angles by the line of the program


def by_words(machine: Machine, rng: np.random.Generator, begin: list[str]) -> tuple[list[str], Expected]:
    """Blocks with rotary words; every fourth one brings the tool to where C is open."""
    lines, expected = list(begin), {}
    for k in range(12):
        p = rng.uniform(-40, 40, 3).round(3)
        angles = {letter: round(float(rng.uniform(low, high)), 3) for letter, (low, high) in machine.travel.items()}
        if k % 4 == 3:
            angles[machine.tilting] = 0.0
        words = " ".join(f"{letter}{value:.3f}" for letter, value in angles.items())
        lines.append(f"G1 X{p[0]:.3f} Y{p[1]:.3f} Z{p[2]:.3f} {words} F4000.")
        expected[len(lines)] = p, angles
    return lines, expected


def by_vectors(machine: Machine, rng: np.random.Generator) -> tuple[list[str], Expected]:
    """Blocks with directions: any, upright, and within a degree of that down to the last decimals."""
    lines, expected, here = ["G43.5 H1"], {}, {machine.tilting: 0.0, "C": 0.0}
    for _ in range(14):
        p, around, lean = rng.uniform(-40, 40, 3).round(3), rng.uniform(0.0, 6.28), 10.0 ** rng.uniform(-5.5, -2.0)
        near = np.array([lean * np.cos(around), lean * np.sin(around), 1.0])
        v = (np.array([0.0, 0.0, 1.0]), near, *rng.normal(size=(2, 3)))[rng.integers(4)]
        v = (v * np.sign(v[2]) / np.linalg.norm(v)).round(7)
        way = machine.nearest(machine.ways(v / np.linalg.norm(v), here), here)
        if way is None:
            continue
        here = way
        lines.append(f"G1 X{p[0]:.3f} Y{p[1]:.3f} Z{p[2]:.3f} I{v[0]:.7f} J{v[1]:.7f} K{v[2]:.7f} F4000.")
        expected[len(lines)] = p, here
    return lines, expected


def by_planes(machine: Machine, random: Random) -> tuple[list[str], Expected]:
    """Moves in planes, into which G53.1 turns the tool, with and without a choice of the way."""
    lines, expected, here = ["G43 H1"], {}, {machine.tilting: 0.0, "C": 0.0}
    for _ in range(4):
        blocks, zero, R = plane(random.choice(("euler", "roll pitch yaw", "points", "projection")), random)
        choice = random.choice((0, 0, 1, 2))
        ways = machine.ways(R[:, 2], here)
        if choice:
            ways = [way for way in ways if (1 if choice == 1 else -1) * way[machine.tilting] >= -1e-7]
        way = machine.nearest(ways, here)
        if way is None:
            continue
        here = way
        lines += [*blocks, f"G53.1 P{choice}" if choice else "G53.1"]
        for _ in range(3):
            p = np.array([round(random.uniform(-20, 20), 3) for _ in range(3)])
            lines.append(f"G1 X{p[0]:.3f} Y{p[1]:.3f} Z{p[2]:.3f} F900.")
            expected[len(lines)] = zero + R @ p, here
        lines.append("G69")
    return lines, expected


def drawn(kind: str, machine: Machine, seed: int) -> tuple[str, str, Expected]:
    """Dialect, program and what its lines ask for."""
    rng = np.random.default_rng([seed, 78])
    if kind == SWITCHED:
        head = ["G21 G90 G94 G54 G61.1", "T1 M6"]
        lines, expected = by_words(machine, rng, ["G43 H1", "M428"])
        return "linuxcnc", "\n".join([*head, *lines, "M429", "M2", ""]), {len(head) + k: v for k, v in expected.items()}
    head = ["%", "O1", "G21 G90 G49 G94 G54 G61", "T1 M6"]
    if kind == WORDS:
        lines, expected = by_words(machine, rng, ["G43.4 H1"])
    else:
        lines, expected = by_vectors(machine, rng) if kind == VECTORS else by_planes(machine, Random(seed))
    text = "\n".join([*head, *lines, "G49", "M30", "%", ""])
    return "fanuc", text, {len(head) + k: v for k, v in expected.items()}


def check(kind: str, seed: int) -> int:
    """Compare all axes at the ends of blocks, to 1e-5 mm and degrees; how many blocks there were."""
    machine = Machine(np.random.default_rng([seed, 77]))
    dialect, text, expected = drawn(kind, machine, seed)
    loaded = read_cell(SourceText("cell.yaml", machine.cell(dialect).encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.nc", text.encode()), loaded, Options(world="kinematic"))
    assert job.plan is not None and not [f for f in job.findings if f.level.word == "error"], (seed, job.findings)
    path, law, joints = job.plan.path, job.plan.trajectory, job.plan.kinematics.joints
    q = job.plan.joints(law.sample(law.row_end))
    found = {path.span(row).line: dict(zip(joints.names, q[row], strict=True)) for row in range(len(path))}
    seen = 0
    for line, (tip, angles) in expected.items():
        if line not in found:  # it does not move
            continue
        for letter, angle in angles.items():
            assert np.degrees(found[line][letter]) == pytest.approx(angle, abs=1e-5), (seed, line)
        axes = np.array([found[line][letter] for letter in "XYZ"]) * 1e3
        assert axes == pytest.approx(machine.linear(tip, angles), abs=1e-5), (seed, line)
        seen += 1
    return seen


@pytest.mark.parametrize("kind", [WORDS, SWITCHED, VECTORS, PLANES])
def test_axes_are_those_of_the_matrices(kind: str) -> None:
    assert sum(check(kind, seed) for seed in FEW) > 5 * len(FEW)


@pytest.mark.slow
@pytest.mark.parametrize("kind", [WORDS, SWITCHED, VECTORS, PLANES])
def test_axes_of_many_are_those_of_the_matrices(kind: str) -> None:
    assert sum(check(kind, seed) for seed in MANY) > 5 * len(MANY)

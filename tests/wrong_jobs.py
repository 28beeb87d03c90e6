"""Long jobs with the part that they make, and faults of one line: drawn, so that no two are alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import trimesh

HEAD = ("G21 G90 G17 G94 G54 G64 P0.01", "T1 M6", "G43 H1", "S12000 M3")
TAIL = ("G0 Z15", "M5", "M2")
Height = Callable[[Any, Any], Any]
"""The design's height [mm] at x and y [mm]."""

SAFE, BOTTOM, BALL, MILL = 5.0, -8.0, 3.0, 2.0  # mm: rapids, underside of the part, radii of both cutters


@dataclass(frozen=True, kw_only=True)
class Move:
    """One line: G0 or G1 to a point [mm]; `top` is the design's height there, or None where a fault would not show."""

    word: str
    x: float
    y: float
    z: float
    top: float | None = None

    @property
    def text(self) -> str:
        feed = " F3000" if self.word == "G1" else ""
        return f"{self.word} X{self.x:.4f} Y{self.y:.4f} Z{self.z:.4f}{feed}"


@dataclass(frozen=True, kw_only=True)
class MilledJob:
    """Moves of one tool that make `mesh` out of a block; tolerance and grid [mm]."""

    moves: Sequence[Move]
    mesh: trimesh.Trimesh
    height: Height
    tool: str
    tolerance: float
    resolution: float

    @property
    def program(self) -> str:
        return "\n".join([*HEAD, *(move.text for move in self.moves), *TAIL]) + "\n"

    @property
    def cell(self) -> str:
        """A machine with the block and the part; `part.stl` stands beside it."""
        low, high = self.mesh.bounds
        return (
            "gcodesim: 1\nmachine: gantry_xyz\nwork_offsets: {G54: {xyz: [300, 300, -150]}}\n"
            f"stock: {{min: {low.tolist()}, max: {[*high[:2].tolist(), 0.0]}, resolution: {self.resolution}}}\n"
            f"tools:\n  1: {{{self.tool}}}\n"
            f"target: {{mesh: part.stl, unit: mm, in: G54, tolerance: {self.tolerance}}}\n"
            "simulation: {world: kinematic}\n"
        )

    def with_move(self, number: int, move: Move) -> MilledJob:
        """The same with one other line."""
        return replace(self, moves=[*self.moves[:number], move, *self.moves[number + 1 :]])


def line_of(number: int) -> int:
    """The line of the program in which a move stands."""
    return len(HEAD) + 1 + number


def relief(blocks: int, seed: int, pitch: float = 0.5, step: float = 0.5) -> MilledJob:
    """Waves that a ball finishes in rows there and back, with as many points as `blocks`."""
    draw = np.random.default_rng(seed)
    columns = max(8, round(math.sqrt(blocks * 1.5)))
    rows = max(8, blocks // columns)
    wide, deep = (columns - 1) * step, (rows - 1) * pitch
    waves = 2 * np.pi / draw.uniform(22, 34, 2)
    shift = draw.uniform(0, 2 * np.pi, 2)

    def height(x: Any, y: Any) -> Any:
        return -2.0 + 0.9 * np.sin(waves[0] * x + shift[0]) * np.cos(waves[1] * y + shift[1])

    def tip(x: float, y: float) -> tuple[float, float, float]:
        a, b = waves[0] * x + shift[0], waves[1] * y + shift[1]
        slope = (0.9 * waves[0] * math.cos(a) * math.cos(b), -0.9 * waves[1] * math.sin(a) * math.sin(b))
        size = math.sqrt(1 + slope[0] ** 2 + slope[1] ** 2)
        z = float(height(x, y)) + BALL * (1 / size - 1)
        return x - BALL * slope[0] / size, y - BALL * slope[1] / size, z

    moves = [Move(word="G0", x=-6.0, y=0.0, z=SAFE)]
    for row in range(rows):
        xs = np.linspace(-1.0, wide + 1.0, columns + 4)
        for x in xs if row % 2 == 0 else xs[::-1]:
            inside = 3 < x < wide - 3 and 3 < row * pitch < deep - 3
            top = float(height(x, row * pitch)) if inside else None
            at = tip(float(x), row * pitch)
            moves.append(Move(word="G1", x=at[0], y=at[1], z=at[2], top=top))
    moves.append(Move(word="G0", x=moves[-1].x, y=moves[-1].y, z=SAFE))
    mesh = _under(height, np.linspace(0, wide, 2 * columns), np.linspace(0, deep, 2 * rows))
    tool = "type: ball_end_mill, diameter: 6, length: 40"
    return MilledJob(moves=moves, mesh=mesh, height=height, tool=tool, tolerance=0.1, resolution=0.25)


def pockets(across: int, along: int, levels: int, seed: int) -> MilledJob:
    """Pockets with round corners, each of a depth of its own, cleared level by level from the middle to the wall."""
    draw = np.random.default_rng(seed)
    tile, wall, corner = 14.0, 4.5, 2.5
    moves, floors = [], {}
    for i in range(across):
        for j in range(along):
            x, y, floor = tile * (i + 0.5), tile * (j + 0.5), -float(draw.uniform(1.5, 4.0))
            floors[i, j] = floor
            moves.append(Move(word="G0", x=x, y=y, z=SAFE))
            for level in range(1, levels + 1):
                last = level == levels
                z = floor * level / levels
                for half, round_ in ((1.0, 0.2), (wall - MILL, corner - MILL)):
                    loop = _rounded(half, round_)
                    for k, (u, v) in enumerate([*loop, loop[0]]):
                        shows = last and half > 1.0 and k > 0
                        moves.append(Move(word="G1", x=x + u, y=y + v, z=z, top=z if shows else None))
            moves.append(Move(word="G0", x=moves[-1].x, y=moves[-1].y, z=SAFE))
    mesh = _plate_with_pockets(across, along, tile, floors, _rounded(wall, corner, 6))
    tool = "type: flat_end_mill, diameter: 4, length: 40, flutes: 2"
    walls = lambda x, y: 0.0  # noqa: E731  a tool that goes out of its pocket meets what stands around it
    return MilledJob(moves=moves, mesh=mesh, height=walls, tool=tool, tolerance=0.1, resolution=0.25)


def plunge(job: MilledJob, number: int, draw: np.random.Generator) -> Move:
    """One point too deep."""
    move = job.moves[number]
    return replace(move, z=move.z - float(draw.uniform(0.3, 1.5)))


def offset(job: MilledJob, number: int, draw: np.random.Generator) -> Move:
    """One point beside its place, where the part is higher, and a little too deep."""
    move, before = job.moves[number], job.moves[number - 1]
    way = np.array([move.x - before.x, move.y - before.y])
    aside = float(draw.uniform(0.6, 1.5)) * np.array([way[1], -way[0]]) / np.hypot(*way)
    right, left = np.array([move.x, move.y]) + aside, np.array([move.x, move.y]) - aside
    x, y = left if job.height(*left) > job.height(*right) else right
    return replace(move, x=float(x), y=float(y), z=move.z - 0.2)


def rapid(job: MilledJob, number: int, draw: np.random.Generator) -> Move:
    """G0 for G1."""
    return replace(job.moves[number], word="G0")


FAULTS: dict[str, Callable[[MilledJob, int, np.random.Generator], Move]] = {
    "plunge": plunge, "offset": offset, "rapid": rapid,
}  # fmt: skip


def planted(job: MilledJob, fault: str, draw: np.random.Generator) -> tuple[MilledJob, int]:
    """The job with one fault, and the line that has it."""
    number = int(draw.choice([k for k, move in enumerate(job.moves) if move.top is not None]))
    return job.with_move(number, FAULTS[fault](job, number, draw)), line_of(number)


def _rounded(half: float, corner: float, parts: int = 4) -> list[tuple[float, float]]:
    """A square with round corners about 0, counter-clockwise: 4 (parts + 1) points [mm]."""
    points = []
    for quarter in range(4):
        a = np.pi / 2 * (quarter + np.linspace(0, 1, parts + 1))
        c = np.pi / 4 + np.pi / 2 * quarter
        centre = (half - corner) * math.sqrt(2) * np.array([math.cos(c), math.sin(c)])
        points += [(float(centre[0] + corner * math.cos(t)), float(centre[1] + corner * math.sin(t))) for t in a]
    return points


def _under(height: Height, xs: np.ndarray, ys: np.ndarray) -> trimesh.Trimesh:
    """The body between a field of heights and the underside."""
    x, y = np.meshgrid(xs, ys, indexing="ij")
    number = np.arange(x.size).reshape(x.shape)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    top = np.r_[np.c_[a, b, c], np.c_[a, c, d]]
    rim = np.r_[number[:, 0], number[-1, 1:], number[-2::-1, -1], number[0, -2:0:-1]]
    points = np.array([(x, y, height(x, y)), (x, y, np.full(x.shape, BOTTOM))]).transpose(0, 2, 3, 1).reshape(-1, 3)
    n, following = x.size, np.roll(rim, -1)
    sides = np.r_[np.c_[rim, rim + n, following + n], np.c_[rim, following + n, following]]
    return trimesh.Trimesh(points, np.r_[top, top[:, ::-1] + n, sides], process=False)


def _plate_with_pockets(
    across: int, along: int, tile: float, floors: dict[tuple[int, int], float], outline: Sequence[tuple[float, float]]
) -> trimesh.Trimesh:
    """A plate of square tiles, each with a pocket of one outline about its middle."""
    rim = np.array(outline)
    edge = rim * (0.5 * tile / np.abs(rim).max(axis=1))[:, None]
    count = len(rim)
    points, faces = [], []
    for (i, j), floor in floors.items():
        middle = np.array([tile * (i + 0.5), tile * (j + 0.5)])
        flat = lambda ring, z, at=middle: np.c_[ring + at, np.full(len(ring), z)]  # noqa: E731
        first = sum(map(len, points))
        points += [flat(edge, 0.0), flat(rim, 0.0), flat(rim, floor), flat(edge, BOTTOM), flat(np.zeros((1, 2)), floor)]
        points += [flat(np.zeros((1, 2)), BOTTOM)]
        e, r, f, b = (first + count * k for k in range(4))
        centre, under = first + 4 * count, first + 4 * count + 1
        for k in range(count):
            n = (k + 1) % count
            faces += [(e + k, e + n, r + n), (e + k, r + n, r + k), (r + k, r + n, f + n), (r + k, f + n, f + k)]
            faces += [(f + k, f + n, centre), (b + n, b + k, under)]
            outward = 0.5 * (edge[k] + edge[n])
            axis = int(np.abs(outward).argmax())
            last = {(0, True): i == across - 1, (0, False): i == 0, (1, True): j == along - 1, (1, False): j == 0}
            if last[axis, bool(outward[axis] > 0)]:
                faces += [(e + k, b + k, b + n), (e + k, b + n, e + n)]
    mesh = trimesh.Trimesh(np.concatenate(points), np.array(faces), process=False)
    mesh.merge_vertices()
    return mesh

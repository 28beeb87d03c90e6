"""A coat on a curved panel of 50,000 triangles with some 10,000 steps of a spray gun, as users run it.

    python -m benchmarks.coating [TRIANGLES]

A gantry sprays in parallel passes. The yardstick lays the same steps on the same triangles with numpy: for each step
the flow through each triangle's middle, by its distance from the axis of the gun and its incidence, with no shadows,
no program, no log.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.compare import show
from benchmarks.reference import run

LENGTH, WIDTH, RISE = 400.0, 250.0, 30.0  # mm
OVER, GAP, SPEED, DISTANCE = 90.0, 19.0, 24_000.0, 200.0  # mm, mm, mm/min, mm
RATE = 500  # Hz
CONE = math.radians(30.0)

CELL = f"""gcodesim: 1
machine: gantry_xyz
simulation: {{rate: {RATE} Hz}}
frames: {{table: {{in: world, xyz: [350, 250, -450]}}}}
work_offsets: {{G54: {{in: table}}}}
signals: {{spray: {{word: M62 P1}}, flow: {{word: M67 E0, per: 1 cm^3/s}}}}
tools:
  8: {{type: spray_gun, cone: 30 deg, efficiency: 0.65, solids: 0.45, distance: 200, length: 120}}
parts:
  panel: {{mesh: panel.stl, unit: mm, in: table, mass: 1.6 kg, film: {{least: 1 um}}}}
"""


def triangles(count: int) -> np.ndarray:
    """A panel (t, 3, 3) [mm] that is an arc along X, of about `count` triangles."""
    nx = max(2, round(math.sqrt(0.5 * count * LENGTH / WIDTH)))
    ny = max(2, round(0.5 * count / nx))
    x, y = np.meshgrid(np.linspace(0.0, LENGTH, nx + 1), np.linspace(0.0, WIDTH, ny + 1), indexing="ij")
    corners = np.stack([x, y, RISE * (np.sin(np.pi * x / LENGTH) - 1.0)], axis=-1)
    a, b, c, d = corners[:-1, :-1], corners[1:, :-1], corners[1:, 1:], corners[:-1, 1:]
    return np.concatenate([np.stack(half, axis=2).reshape(-1, 3, 3) for half in ((a, b, c), (a, c, d))])


def write_stl(path: Path, corners: np.ndarray) -> None:
    """A binary STL."""
    rows = np.zeros(len(corners), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("rest", "<u2")])
    rows["v"] = corners
    path.write_bytes(b"panel".ljust(80) + np.uint32(len(corners)).tobytes() + rows.tobytes())


def passes() -> list[tuple[float, float, float]]:
    """Where each pass begins and ends along X, and its Y [mm]."""
    ways = []
    for k in range(int(WIDTH // GAP) + 1):
        ends = (-OVER, LENGTH + OVER)
        ways.append((*(ends if k % 2 == 0 else ends[::-1]), k * GAP))
    return ways


def program() -> str:
    lines = ["G21 G90 G94 G61", "T8 M6", "G43 H8", "M67 E0 Q2.5"]
    for begin, end, y in passes():
        lines += [f"G0 X{begin:g} Y{y:g} Z{DISTANCE:g}", "M62 P1", f"G1 X{end:g} F{SPEED:g}", "M63 P1"]
    return "\n".join([*lines, "M2", ""])


def theirs(corners: np.ndarray, steps: int) -> float:
    """Steps a second of numpy."""
    middles, normals = corners.mean(axis=1), np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.sqrt((normals**2).sum(axis=1))[:, None]
    film, spread = np.zeros(len(corners)), math.tan(0.5 * CONE)
    few = min(steps, 300)
    tips = [(begin + (end - begin) * share, y) for begin, end, y in passes() for share in np.linspace(0.0, 1.0, 24)]
    begin = time.process_time()
    for k in range(few):
        away = middles - (*tips[k % len(tips)], DISTANCE)
        depth = -away[:, 2]
        aside = np.sqrt(away[:, 0] ** 2 + away[:, 1] ** 2) / (depth * spread)
        incidence = -(away * normals).sum(axis=1) / np.sqrt((away**2).sum(axis=1))
        film += np.where(aside < 1.0, (1.0 - aside**2) * np.maximum(incidence, 0.0) / depth**2, 0.0)
    return few / (time.process_time() - begin)


def main(count: int = 50_000) -> None:
    corners = triangles(count)
    steps = round(RATE * len(passes()) * (LENGTH + 2.0 * OVER) / (SPEED / 60.0))
    run(["gcodesim", "warm-up"])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_stl(folder / "panel.stl", corners)
        (folder / "coat.nc").write_text(program())
        (folder / "cell.yaml").write_text(CELL)
        order = ["run", str(folder / "coat.nc"), "--cell", str(folder / "cell.yaml"), "--world", "kinematic"]
        wall, spent = run(["gcodesim", *order, "--out", str(folder / "out")])
        results = json.loads((folder / "out" / "results.json").read_text())
    seconds = float(results["time"]["total_s"])
    print(
        f"coat of {len(corners):,} triangles, {steps:,} steps of spray in a program of {seconds:.1f} s: "
        f"{wall:.1f} s of wall, {spent:.1f} s of processor"
    )
    show("steps, whole run", steps / spent, "numpy, footprint alone", theirs(corners, steps), "/s")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))

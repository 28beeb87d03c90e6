"""A print of 100,000 segments as users run it, beside the extruder of pybullet_industrial.

    python -m benchmarks.printing [SEGMENTS]

A solid cylinder of concentric walls in layers of 0.2 mm, its cell made by `--cell auto`, in the kinematic world; the
goal is 100 times real time. The yardstick calls `Extruder.extrude` of pybullet_industrial 1.0.4 for CALLS segments: one
step of the simulation, one ray and one particle a call, no robot, no G-code; it slows down as particles gather.
"""

from __future__ import annotations

import importlib.util
import json
import math
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.compare import show
from benchmarks.reference import run

GOAL = 100.0
CHORD, RADIUS, WALLS = 0.8, 20.0, 8  # mm
WIDTH, HEIGHT, FILAMENT = 0.45, 0.2, 1.75  # mm
CALLS = 2000

BODY = """<inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>"""
NOZZLE = f"""<robot name="nozzle"><link name="base">{BODY}</link><link name="tip">{BODY}</link>
<joint name="end" type="fixed"><parent link="base"/><child link="tip"/></joint></robot>
"""


def lines(segments: int) -> Iterator[str]:
    """The words of a slicer: layers from rings of chords, retraction between rings."""
    yield from ("M201 X2000 Y2000 Z200 E5000", "M203 X300 Y300 Z20 E120", "M204 P2000 R2000 T2000")
    yield from ("M205 X8 Y8 Z0.4 E1.5", "G28", "G21", "G90", "M83")
    section = (WIDTH - HEIGHT) * HEIGHT + math.pi * HEIGHT * HEIGHT / 4.0
    filament = section / (math.pi * (0.5 * FILAMENT) ** 2)
    laid, layer = 0, 0
    while laid < segments:
        layer += 1
        yield from (";LAYER_CHANGE", f";Z:{layer * HEIGHT:.2f}", f"G1 Z{layer * HEIGHT:.2f} F720", ";TYPE:Perimeter")
        for wall in range(WALLS):
            radius = RADIUS - wall * WIDTH
            count = int(2.0 * math.pi * radius / CHORD)
            chord = 2.0 * radius * math.sin(math.pi / count)
            yield from ("G1 E-0.8 F2100", f"G1 X{50 + radius:.4f} Y50 F9000", "G1 E0.8 F2100", "G1 F2400")
            for k in range(1, count + 1):
                turn = 2.0 * math.pi * k / count
                x, y = 50.0 + radius * math.cos(turn), 50.0 + radius * math.sin(turn)
                yield f"G1 X{x:.4f} Y{y:.4f} E{chord * filament:.5f}"
            laid += count
            if laid >= segments:
                break


def theirs(folder: Path) -> float | None:
    """Segments a second by `Extruder.extrude`; None where the package is not installed."""
    if importlib.util.find_spec("pybullet_industrial") is None:
        return None
    import pybullet
    import pybullet_industrial

    client = pybullet.connect(pybullet.DIRECT)
    urdf = folder / "nozzle.urdf"
    urdf.write_text(NOZZLE)
    plane = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[1.0, 1.0, 0.01])
    pybullet.createMultiBody(0, plane, basePosition=[0.0, 0.0, -0.01])
    properties = {
        "maximum distance": 0.5,
        "material properties": {"particle size": 1e-3 * WIDTH, "color": [1, 0, 0, 1]},
    }
    tool = pybullet_industrial.Extruder(str(urdf), [0, 0, 0.2], [0, 0, 0, 1], properties)
    begin = time.process_time()
    for k in range(CALLS):
        angle = k * CHORD / RADIUS
        tool.set_tool_pose([1e-3 * RADIUS * math.cos(angle), 1e-3 * RADIUS * math.sin(angle), 0.2], [0, 0, 0, 1])
        pybullet.stepSimulation()
        if not tool.extrude():
            raise RuntimeError("the ray hit nothing")
    spent = time.process_time() - begin
    pybullet.disconnect(client)
    return CALLS / spent


def main(segments: int = 100_000) -> None:
    run(["gcodesim", "warm-up"])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = folder / "print.gcode"
        program.write_text("\n".join(lines(segments)) + "\n")
        out = folder / "out"
        wall, spent = run(
            ["gcodesim", "run", str(program), "--cell", "auto", "--world", "kinematic", "--out", str(out)]
        )
        real = float(json.loads((out / "results.json").read_text())["time"]["total_s"])
        size = sum(file.stat().st_size for file in out.iterdir()) / 1e6
        print(
            f"print of {segments:,} segments: {real:.0f} s of printing in {wall:.1f} s of wall, "
            f"{real / wall:.0f} x real time   goal {GOAL:g} x; {spent:.1f} s of processor, {size:.0f} MB"
        )
        rate = theirs(folder)
    if rate is None:
        print("pybullet_industrial left out: not installed")
    else:
        show("segments", segments / spent, "pybullet_industrial's extruder", rate, "/s")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))

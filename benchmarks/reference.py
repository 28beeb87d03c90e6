"""The reference job as users run it: a whole process, in both cells and both worlds.

    python -m benchmarks.reference [BLOCKS]

Wall time includes start-up with a warm cache; stage shares come from a second run with a stopwatch on its stages
(processor time, see `stages`). Beside them stands the bare loop of pybullet over as many steps.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks import job
from benchmarks.stages import LOG

GOALS = {"kinematic": 6.0, "bullet": 15.0}  # s, of the whole job on two cores
RATE = 250


def bare_loop(steps: int) -> float:
    """Processor time [s] of `stepSimulation` alone, with the KR 10 on its own."""
    import pybullet

    from gcodesim.kinematics import MODELS

    client = pybullet.connect(pybullet.DIRECT)
    pybullet.loadURDF(str(MODELS["kuka_kr10_r1100_2"].path), useFixedBase=True, physicsClientId=client)
    begin = time.process_time()
    for _ in range(steps):
        pybullet.stepSimulation(physicsClientId=client)
    spent = time.process_time() - begin
    pybullet.disconnect(client)
    return spent


def run(arguments: list[str]) -> tuple[float, float]:
    """Wall and processor time [s] of a process; its words are shown when it fails."""
    before, begin = os.times(), time.perf_counter()
    done = subprocess.run([sys.executable, "-m", *arguments], check=False, capture_output=True, text=True)
    after, end = os.times(), time.perf_counter()
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stdout + done.stderr)
    return end - begin, sum(after[i] - before[i] for i in (2, 3))


def main(blocks: int = job.BLOCKS) -> None:
    has_bullet = importlib.util.find_spec("pybullet") is not None
    run(["gcodesim", "warm-up"])  # so that no compiling is timed
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for cell in job.CELLS:
            for world in GOALS:
                if world == "bullet" and not has_bullet:
                    print(f"{cell}, {world}: pybullet is not installed")
                    continue
                program, place = job.write(folder, cell, blocks)
                out = folder / f"{cell}-{world}"
                order = ["run", str(program), "--cell", str(place), "--world", world, "--out", str(out)]
                wall, spent = run(["gcodesim", *order])
                seconds = json.loads((out / "results.json").read_text())["time"]["total_s"]
                goal = f", goal {GOALS[world]:g} s" if blocks == job.BLOCKS else ""
                print(f"{cell}, {world}: {wall:.2f} s wall{goal}, {spent:.2f} s processor, ", end="")
                print(f"{seconds / wall:.0f} x real time ({seconds:.0f} s of machine time)")
                times = folder / "stages.json"
                run(["benchmarks.stages", str(times), *order])
                stages = json.loads(times.read_text())
                whole = sum(stages.values())
                for stage, share in stages.items():
                    print(f"    {stage:20} {share:8.2f} s {100.0 * share / whole:5.1f} %")
                writing, size = sum(stages[stage] for stage in LOG), (out / "run.mcap").stat().st_size
                print(f"    writing the log: {100.0 * writing / whole:.1f} %, goal 20 %; ", end="")
                print(f"{size / 1e6:.1f} MB, goal 60 MB")
                if has_bullet:
                    steps = round(seconds * RATE)
                    bare = bare_loop(steps)
                    print(f"    bare loop of pybullet over {steps} steps: {bare:.2f} s, ratio {spent / bare:.1f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))

"""Compiles everything that is compiled on first use, by small jobs of each kind, so that a first run need not wait."""

from __future__ import annotations

import compileall
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.rs274 import Settings, interpret
from gcodesim.simulation import prepare, run

_HEAD: Final = "G21 G90 G17 G94 G64 P0.01\nT1 M6\nG43 H1\nS8000 M3\nG0 X5 Y5 Z5\n"
_BODY: Final = "G1 Z-1 F300\nG1 X15\nG1 X15.5 Y5.2\nG3 X15 Y9 R2.5\nG1 X8\nG0 Z5\nM5\nM2\n"
_GANTRY: Final = (
    "gcodesim: 1\nmachine: gantry_xyz\n"
    "stock: {{box: [20, 15, 8], zero: top-front-left, material: {material}, resolution: 0.5}}\n"
    "tools: {{1: {{type: {tool}, diameter: 6, length: 40, flute_length: 20, "
    "holder: {{diameter: 20, length: 20}}{more}}}}}\n"
    "fixtures: {{clamp: {{box: [5, 5, 5], in: world, xyz: [0, 0, -300]}}}}\n"
)
_ARM: Final = (
    "gcodesim: 1\nrobots: {{arm: {{model: {model}}}}}\n"
    "work_offsets: {{G54: {{in: world, xyz: {place}}}}}\n"
    "stock: {{box: [20, 15, 8], in: world, xyz: {place}, zero: top-front-left, "
    "material: seed_42crmo4, resolution: 0.5}}\n"
    "tools: {{1: {{type: {tool}, length: 40}}}}\n"
)
_TABLE: Final = (
    "gcodesim: 1\n"
    "machine:\n  axes:\n    X: {travel: [0, 400 mm], speed: 20 m/min}\n    Y: {travel: [0, 300 mm], speed: 20 m/min}\n"
    "    Z: {travel: [-300, 0 mm], speed: 20 m/min}\n"
    "    A: {travel: unlimited, speed: 360 deg/s, side: table, at: [200, 150, -205]}\n"
    "work_offsets: {G54: {xyz: [200, 150, -200]}}\n"
    "stock: {min: [-20, -20, -10], max: [20, 20, 0], in: G54, material: al6082_t6, resolution: 2}\n"
    "tools: {1: {type: flat_end_mill, diameter: 6, length: 50}}\n"
)
_SWITCHED: Final = "m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}\n"
_MILL: Final = "flat_end_mill, diameter: 6"
_PRINT: Final = "extruder, bead_width: 2, bead_height: 1"

_JOBS: Final = (
    ("milling on a gantry", "bullet", _GANTRY.format(tool="flat_end_mill", material="al6082_t6", more=""), _BODY),
    ("ball ends", "kinematic", _GANTRY.format(tool="ball_end_mill", material="al6082_t6", more=""), _BODY),
    (
        "bull noses",
        "kinematic",
        _GANTRY.format(tool="bull_nose_end_mill", material="al6082_t6", more=", corner_radius: 1"),
        _BODY,
    ),
    (
        "drills",
        "kinematic",
        _GANTRY.format(tool="drill", material="al6082_t6", more=""),
        "G81 X5 Y5 Z-4 R1 F200\nG80\nM2\n",
    ),
    (
        "an arm",
        "bullet",
        _ARM.format(model="kuka_kr10_r1100_2", place="[600, 0, 300]", tool=_MILL),
        _BODY,
    ),
    (
        "printing",
        "kinematic",
        _ARM.format(model="kuka_kr10_r1100_2", place="[600, 0, 300]", tool=_PRINT) + _SWITCHED,
        "G0 Z1\nM10\nG1 X15 F600\nM11\nM2\n",
    ),
    (
        "an arm without closed form",
        "kinematic",
        _ARM.format(model="ur10e", place="[-600, 100, 300]", tool=_MILL),
        _BODY,
    ),
    ("a leaning tool", "kinematic", _TABLE, "G0 X-30 Y0 Z30\nG0 A20\nG0 Z-2\nG1 X10 A25 F900\nG0 Z30\nM5\nM2\n"),
)


def warm_up(say: Callable[[str], None]) -> None:
    """Run the jobs, with a line for each; kernels that are already compiled take only a moment."""
    from importlib.util import find_spec

    # a package installed with `-e` has no byte code, which costs 0.2 s at each start if none can be written
    compileall.compile_dir(Path(__file__).parent, quiet=2)
    say("compiling: the reader of long programs")
    for _ in interpret(SourceText("warm_up.nc", (_HEAD + _BODY).encode()), Settings(lane="compiled")).stream():
        pass
    with TemporaryDirectory() as folder:
        for number, (what, world, cell, program) in enumerate(_JOBS, 1):
            say(f"compiling {number}/{len(_JOBS)}: {what}")
            place = Path(folder) / f"cell{number}.yaml"
            loaded = read_cell(SourceText("cell.yaml", cell.encode()), place)
            usable = world if find_spec("pybullet") is not None else "kinematic"
            job = prepare(SourceText("warm_up.nc", (_HEAD + program).encode()), loaded, Options(world=usable))
            run(job, Path(folder) / str(number))
            if job.loaded.cell is None or job.reading is None or job.reading.failed is not None:
                raise AssertionError(f"the warm-up job for {what} is broken: {[f.message for f in job.findings]}")

"""Write the list of kernels that are compiled ahead of time, with the types they are called with.

    scripts/list_kernels.py [--check]

Small jobs of each kind say what they call. What else the cache holds for these sources, from tests and from use,
comes behind, so run the tests first; what was found so before stays while its kernel exists. `--check` writes nothing;
status 1 if a kernel is missing in the list, or is in it and exists no longer.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from gcodesim.compiled.folder import folders
from gcodesim.compiled.known import LIST, kernel_of, known_parts, missing
from gcodesim.compiled.object_code import ObjectCode, codes_in, symbol_of
from gcodesim.compiled.parallel import compile_all

ROOT: Final = Path(__file__).parents[1]
OTHERS: Final = "what is rarer"
INNER: Final = "gcodesim.rs274.plain.text_kernels:byte_at "
"""Only other kernels call it, and tests, to which a part of the list would bring all its kernels to compile."""

_HEAD: Final = "G21 G90 G17 G94 G64 P0.01\nT1 M6\nG43 H1\nS8000 M3\nG0 X5 Y5 Z5\n"
_BODY: Final = "G1 Z-1 F300\nG1 X15\nG1 X15.5 Y5.2\nG3 X15 Y9 R2.5\nG1 X8\nG0 Z5\nM5\nM2\n"
_GANTRY: Final = (
    "gcodesim: 1\nmachine: gantry_xyz\n"
    "stock: {{box: [20, 15, 8], zero: top-front-left, material: al6082_t6, resolution: 0.5}}\n"
    "tools: {{1: {{type: {tool}, length: 40, holder: {{diameter: 20, length: 20}}}}}}\n"
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
_EXTRUDER: Final = "extruder, bead_width: 2, bead_height: 1"
_MILL: Final = "flat_end_mill, diameter: 6"
_BEFORE, _BESIDE = "[600, 0, 300]", "[-600, 100, 300]"
_PRINT: Final = "G0 Z1\nM10\nG1 X15 F600\nM11\nM2\n"


def example(cell: str) -> tuple[str, str, str]:
    """World, cell and program of a shipped example: `engraving_kr10` is `engraving` in another cell."""
    program = next((ROOT / "programs").glob(f"{cell.partition('_kr10')[0].partition('_mill')[0]}.n*c"))
    return "bullet", (ROOT / "cells" / f"{cell}.yaml").read_text(), program.read_text()


def small(world: str, cell: str, body: str = _BODY) -> tuple[str, str, str]:
    """World, cell and program of a job of a few lines."""
    return world, cell, _HEAD + body


# not by the command line, which would compile whole parts
_JOB: Final = """
import sys
from pathlib import Path
from gcodesim.cell import load_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.rs274 import Settings, interpret
from gcodesim.simulation import prepare, run

program, world = SourceText.read(Path("job.nc")), sys.argv[1]
if not world:
    for _ in interpret(program, Settings(lane="compiled")).stream():
        pass
    sys.exit()
job = prepare(program, load_cell(Path("cell.yaml")), Options(world=world))
run(job, Path("out"))
assert job.cell is not None and job.reading is not None and job.reading.failed is None, job.findings
"""

PARTS: Final = {
    "milling on a machine tool": (
        example("bracket"),
        small("bullet", _GANTRY.format(tool=_MILL)),
        small("kinematic", _GANTRY.format(tool=_MILL)),
        small("kinematic", _GANTRY.format(tool="drill, diameter: 6"), "G81 X5 Y5 Z-4 R1 F200\nG80\nM2\n"),
    ),
    "long programs": (
        ("", _GANTRY.format(tool=_MILL), _HEAD + _BODY),
        ("kinematic", _GANTRY.format(tool=_MILL), _HEAD + "G1 X15 F600\nG1 X5\n" * 2000 + _BODY),
    ),
    "arms": (
        small("bullet", _ARM.format(model="kuka_kr10_r1100_2", place=_BEFORE, tool=_MILL)),
        small("kinematic", _ARM.format(model="kuka_kr10_r1100_2", place=_BEFORE, tool=_MILL)),
        small("kinematic", _ARM.format(model="ur10e", place=_BESIDE, tool=_MILL)),
    ),
    "printing": (
        small("kinematic", _ARM.format(model="kuka_kr10_r1100_2", place=_BEFORE, tool=_EXTRUDER) + _SWITCHED, _PRINT),
        small("kinematic", _GANTRY.format(tool=_EXTRUDER) + _SWITCHED, _PRINT),
    ),
    "leaning tools": (small("kinematic", _TABLE, "G0 X-30 Y0 Z30\nG0 A20\nG0 Z-2\nG1 X10 A25 F900\nG0 Z30\nM5\nM2\n"),),
    OTHERS: tuple(
        map(
            example,
            ("bracket_kr10", "contour", "engraving", "engraving_kr10", "heavy", "inspection", "probe_pocket", "wall"),
        )
    ),
}
"""World, cell and program of jobs by the name of their part, those that most runs need first; "" is only read."""


def main() -> int:
    """Write or check the list; returns the exit status."""
    if sys.argv[1:] == ["--check"]:
        return check()
    listed: dict[str, int] = {}
    text = ""
    with tempfile.TemporaryDirectory() as name:
        for part, jobs in PARTS.items():
            for number, job in enumerate(jobs):
                run(Path(name), f"{part} {number}", *job)
            sizes = {code.signature: len(code.code) for code in codes(name)}
            if part == OTHERS:
                sizes |= {code.signature: len(code.code) for code in codes()} | dict.fromkeys(known_before(), 0) | sizes
            text += lines_of(part, sizes, listed)
    LIST.write_text(text, encoding="ascii")
    print(f"{len(listed)} kernels, {sum(listed.values())} bytes of code")
    return 0


def known_before() -> list[str]:
    """What is rarer according to the list as it stands, unless the kernel is gone or takes other arguments now."""
    there = [signature for signature in known_parts().get(OTHERS, ()) if exists(signature)]
    failed = compile_all(missing(tuple(there)), lambda done: None)
    return [signature for signature in there if signature not in failed]


def exists(signature: str) -> bool:
    """Whether there is such a kernel."""
    try:
        kernel_of(signature)
    except ValueError:
        return False
    return True


def run(folder: Path, name: str, world: str, cell: str, program: str) -> None:
    """Run a job with a cache in `folder`."""
    place = folder / name
    place.mkdir()
    (place / "job.nc").write_text(program)
    (place / "cell.yaml").write_text(cell)
    environment = os.environ | {"XDG_CACHE_HOME": str(folder / "cache")}
    subprocess.run([sys.executable, "-c", _JOB, world], check=True, env=environment, cwd=place)


def is_of_today(code: ObjectCode) -> bool:
    """Whether code is that of the sources as they are; a cache keeps that of earlier ones, too."""
    return exists(code.signature) and symbol_of(*kernel_of(code.signature)) == code.symbol


def codes(folder: str = "") -> Iterator[ObjectCode]:
    """Code of this package's kernels in a cache; without a folder in that of the user."""
    before = os.environ.get("XDG_CACHE_HOME")
    if folder:
        os.environ["XDG_CACHE_HOME"] = f"{folder}/cache"
    try:
        for place in folders():
            ours = (
                code
                for code in codes_in(place)
                if code.signature.startswith("gcodesim.") and not code.signature.startswith(INNER)
            )
            yield from filter(is_of_today, ours)
    finally:
        if folder and before is None:
            del os.environ["XDG_CACHE_HOME"]
        elif folder:
            os.environ["XDG_CACHE_HOME"] = str(before)


def lines_of(part: str, sizes: dict[str, int], listed: dict[str, int]) -> str:
    """A part of the list with what is not listed yet; the longest code comes first, since it takes longest."""
    new = {signature: size for signature, size in sizes.items() if signature not in listed}
    listed |= new
    order = sorted(new, key=lambda signature: (-new[signature], signature))
    return "".join(f"{line}\n" for line in (f"# {part}", *order, ""))


def check() -> int:
    """Compare the list with the cache and with the kernels; returns the exit status."""
    listed = {signature for part in known_parts().values() for signature in part}
    faults = [f"{signature}: no kernel" for signature in sorted(listed) if not exists(signature)]
    faults += [f"{code.signature}: not in the list" for code in codes() if code.signature not in listed]
    for fault in faults:
        print(fault)
    if faults:
        print(f"{LIST.name} is out of date: scripts/list_kernels.py writes it anew")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

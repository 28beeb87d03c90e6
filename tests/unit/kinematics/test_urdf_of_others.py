"""Every robot description in two packages of the registry: a cell with it runs, or is refused with a remedy."""

from __future__ import annotations

from importlib.metadata import files
from pathlib import Path

import pytest

from gcodesim.cell import load_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.jobs.job import Options
from gcodesim.simulation import prepare, run

PACKAGES = ("example-robot-data", "pybullet")
WAIT = SourceText("wait.nc", b"G21 G90 G54\nG4 P0.05\nM2\n")
LEAST_RUNS = {"example-robot-data": 60, "pybullet": 25}
"""So many of them are robots that can be simulated."""


def descriptions(package: str) -> list[Path]:
    """Those of `package`; of pybullet's thousand random objects, which all are the same kind of fault, ten."""
    found = sorted(Path(str(f.locate())) for f in files(package) or () if f.name.endswith(".urdf"))
    return [f for f in found if "random_urdfs" not in f.parts or f.parent.name.endswith("00")]


@pytest.mark.slow
@pytest.mark.parametrize("package", PACKAGES)
def test_each_runs_or_is_refused_with_a_remedy(tmp_path, package):
    ran = 0
    for urdf in descriptions(package):
        above = next(folder for folder in urdf.parents if folder.name in ("example-robot-data", "pybullet_data"))
        text = f"gcodesim: 1\nrobots: {{arm: {{urdf: {urdf}}}}}\nwork_offsets: {{G54: {{xyz: [0, 0, 0]}}}}\n"
        (tmp_path / "cell.yaml").write_text(text)
        loaded = load_cell(tmp_path / "cell.yaml", allow_paths=(above,))
        faults = [f for f in loaded.findings if f.level is Severity.ERROR]
        if faults:
            assert all(f.hint for f in faults), (urdf.name, [(f.code, f.message) for f in faults if not f.hint])
            continue
        assert loaded.cell is not None
        results, _ = run(prepare(WAIT, loaded, Options(world="kinematic")), tmp_path / "out" / str(ran))
        said = [(f.code, f.message, f.hint) for f in results.findings if f.level is Severity.ERROR]
        assert results.status == "ok" or all(hint for _, _, hint in said), (urdf.name, said)
        ran += results.status == "ok"
    assert ran >= LEAST_RUNS[package]

"""`run --only`: the part of a run that somebody asks for, with the numbers of a whole run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest


def results(folder: Path) -> Any:
    return json.loads((folder / "results.json").read_text())


def volumes(found: Any) -> tuple[float, float]:
    stock = found["stocks"]["stock"]
    return stock["removed_mm3"], stock["remaining_mm3"]


@pytest.mark.parametrize("cell", ["cell.yaml", "arm.yaml"])
def test_shape(cli, tmp_path: Path, cell: str) -> None:
    """A rigid machine cuts the same shape; an arm that yields does not, and cuts as it was told."""
    assert cli("run", "slot.nc", "--cell", cell, "--out", "whole").status in (0, 1)
    told = cli("run", "slot.nc", "--cell", cell, "--out", "some", "--only", "shape")
    whole, some = results(tmp_path / "whole"), results(tmp_path / "some")

    assert "without forces and log" in told.out and "run.mcap" not in told.out
    assert some["inputs"]["only"] == "shape" and "only" not in whole["inputs"]
    assert sorted(path.name for path in (tmp_path / "some").iterdir()) == [
        "lines.csv", "results.json", "stock.stl", "stock.stock",
    ]  # fmt: skip
    near = {"rel": 1e-6} if cell == "cell.yaml" else {"rel": 0.06}
    assert volumes(some) == pytest.approx(volumes(whole), **near)
    assert some["tools"][0]["max_force_N"] == 0.0 < whole["tools"][0]["max_force_N"]
    assert whole["joints"][0]["max_speed"] > 0.0 and some["joints"][0]["max_speed"] is None
    assert [(joint["least"], joint["most"]) for joint in some["joints"]] == [
        pytest.approx((joint["least"], joint["most"])) for joint in whole["joints"]
    ]
    slowest = 1.0 / (400 / 60)  # the time of a step of one cell
    assert some["time"]["engaged_s"] == pytest.approx(whole["time"]["engaged_s"], abs=2 * slowest)


def test_motion_and_force(cli, tmp_path: Path) -> None:
    for only in ("motion", "force"):
        assert cli("run", "slot.nc", "--cell", "cell.yaml", "--out", only, "--only", only).status == 0
    cli("run", "slot.nc", "--cell", "cell.yaml", "--out", "whole")
    whole, motion, force = (results(tmp_path / name) for name in ("whole", "motion", "force"))

    assert sorted(path.name for path in (tmp_path / "motion").iterdir()) == ["lines.csv", "results.json", "run.mcap"]
    assert motion["stocks"] == {} and motion["joints"] == whole["joints"]
    assert sorted(path.name for path in (tmp_path / "force").iterdir()) == ["lines.csv", "results.json"]
    assert force["tools"] == whole["tools"] and volumes(force) == volumes(whole)
    assert (tmp_path / "force" / "lines.csv").read_bytes() == (tmp_path / "whole" / "lines.csv").read_bytes()


def test_files_of_a_whole_run_do_not_stay_beside_others(cli, tmp_path: Path) -> None:
    cli("run", "slot.nc", "--cell", "cell.yaml")
    cli("run", "slot.nc", "--cell", "cell.yaml", "--only", "force")

    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["lines.csv", "results.json"]


def test_misuse_is_told_without_forces_too(cli, write) -> None:
    from tests.cli.conftest import SLOT

    write("stopped.nc", SLOT.replace("S8000 M3\n", ""))
    write("rapid.nc", SLOT.replace("G1 X30", "G0 X30"))
    for program in ("stopped.nc", "rapid.nc"):
        found = []
        for rest in ((), ("--only", "shape")):
            told = cli("run", program, "--cell", "cell.yaml", "--format", "json", *rest).json
            found.append({(finding["code"], finding["line"]) for finding in told["findings"]})
        assert {"GS401", "GS501"} & {code for code, _ in found[0]}
        assert found[0] == found[1]


def test_what_goes_against_each_other(cli) -> None:
    for rest in (("--world", "bullet"), ("--live", "0")):
        told = cli("run", "slot.nc", "--cell", "cell.yaml", "--only", "shape", *rest)
        assert told.status == 2 and "which --only shape leaves out" in told.err


def test_parts_are_carried_although_nothing_is_cut(cli, tmp_path: Path) -> None:
    top = Path(__file__).resolve().parents[2]
    program, cell = top / "programs" / "palletising.nc", top / "cells" / "palletising.yaml"
    told = cli("run", str(program), "--cell", str(cell), "--only", "motion")

    assert told.status == 0, told.out
    assert all(part["error_from"] == "goal" for part in results(tmp_path / "out")["parts"].values())


def test_a_turned_stock_of_an_earlier_run_may_be_overwritten(tmp_path: Path) -> None:
    from gcodesim.diagnostics import Span
    from gcodesim.files.output_folder import overwriting

    for name, raw in (("a.stock", b"gcodesim-stock/1\n"), ("b.stock", b"gcodesim-revolved/1\n"), ("c.stock", b"mine")):
        (tmp_path / name).write_bytes(raw)
    lost = overwriting(tmp_path, ["a.stock", "b.stock", "c.stock"], [], Span("x.nc"))
    assert len(lost) == 1 and "c.stock" in lost[0].message

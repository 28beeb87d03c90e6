"""A machine on which pybullet cannot be installed: all works in the kinematic world, and what does not says why."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(autouse=True)
def no_pybullet(monkeypatch: pytest.MonkeyPatch) -> None:
    find = PathFinder.find_spec

    def found(name: str, path: Sequence[str] | None = None, target: ModuleType | None = None) -> ModuleSpec | None:
        return None if name.partition(".")[0] == "pybullet" else find(name, path, target)

    monkeypatch.setattr(PathFinder, "find_spec", staticmethod(found))
    monkeypatch.delitem(sys.modules, "pybullet", raising=False)


def test_the_first_five_minutes(cli, tmp_path: Path) -> None:
    """Scenario 1 of a newcomer: the slot removes its swept volume, with one note more."""
    assert cli("init", "demo").status == 0
    done = cli("run", "demo/part.nc", "--cell", "demo/cell.yaml", "--format", "json")

    assert done.status == 0
    assert done.json["inputs"]["world"] == "kinematic"
    assert [f["severity"] for f in done.json["findings"] if f["code"] == "GS731"] == ["note"]
    assert not [f for f in done.json["findings"] if f["severity"] != "note"]
    stock = done.json["stocks"]["stock"]
    assert abs(stock["removed_mm3"] - 656.5) <= stock["error_bound_mm3"]
    assert done.json["distance"]["feed_mm"] == pytest.approx(57.0)
    assert done.json["time"]["feed_s"] == pytest.approx(7.1, rel=0.01)
    assert cli("info", "out/run.mcap").status == 0


def test_a_cell_that_names_the_bullet_world(cli, write) -> None:
    write("bullet.yaml", "gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: bullet}\n")
    done = cli("run", "slot.nc", "--cell", "bullet.yaml", "--format", "json")

    assert done.status == 1
    assert done.errors == [("GS728", 3, 21)]


def test_a_command_line_that_asks_for_it_touches_nothing(cli, tmp_path: Path) -> None:
    assert cli("run", "slot.nc", "--cell", "cell.yaml").status == 0
    before = {path: path.read_bytes() for path in sorted((tmp_path / "out").iterdir())}
    done = cli("run", "slot.nc", "--cell", "cell.yaml", "--world", "bullet")

    assert done.status == 2
    assert "pybullet" in done.err and "kinematic" in done.err and "Traceback" not in done.err
    assert {path: path.read_bytes() for path in sorted((tmp_path / "out").iterdir())} == before

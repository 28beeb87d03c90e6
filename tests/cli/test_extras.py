"""Extras that are not installed: told at once, with the name of the extra, before anything is read or made."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from gcodesim import extras

TOP = Path(__file__).parents[2]


@pytest.fixture
def bare(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine on which no extra is installed."""
    for name in extras.EXTRAS:
        monkeypatch.setitem(extras.EXTRAS, name, (f"{name}-that-is-not-there",))


@pytest.mark.parametrize(
    ("extra", "arguments"),
    [
        ("report", ("report", "absent")),
        ("plot", ("plot", "absent")),
        ("ros", ("export", "absent", "--to", "rosbag2")),
        ("live", ("run", "absent.nc", "--cell", "absent.yaml", "--live")),
    ],
)
def test_the_extra_is_named_before_any_input_is_looked_at(cli, bare, tmp_path: Path, extra: str, arguments) -> None:
    before = sorted(tmp_path.iterdir())
    done = cli(*arguments)

    assert done.status == 2 and not done.out
    assert f"needs the extra `{extra}`" in done.err and f"pip install 'gcodesim[{extra}]'" in done.err
    assert "absent" not in done.err
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    "arguments", [("report", "out", "--times"), ("export", "out", "--to", "csv"), ("export", "out", "--to", "stl")]
)
def test_what_needs_no_extra_goes_on(cli, bare, arguments: tuple[str, ...]) -> None:
    assert cli("run", "slot.nc", "--cell", "cell.yaml").status == 0

    assert cli(*arguments).status == 0


def test_the_table_is_that_of_the_project() -> None:
    project = tomllib.loads((TOP / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = {
        name: tuple(re.split(r"[<>=;\s]", package)[0] for package in packages)
        for name, packages in project["optional-dependencies"].items()
    }
    assert {name: declared[name] for name in extras.EXTRAS} == extras.EXTRAS

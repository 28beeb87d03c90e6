"""`gcodesim optimise`: feeds that keep to limits."""

from __future__ import annotations

import json
import re

import jsonschema
import pytest

CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [40, 30, 10], zero: top-front-left, material: al6082_t6, resolution: 1}
tools:
  1: {type: flat_end_mill, diameter: 6, flutes: 2, substrate: carbide, length: 30, flute_length: 15}
simulation: {world: kinematic}
"""
PROGRAM = """G21 G90 G17 G94
T1 M6
G43 H1
S8000 M3
G0 X-10 Y15
G0 Z-4
G1 X20 F1200 (slot)
G1 Y60 ; out
G0 Z20
M5
M2
"""


@pytest.fixture
def shop(cli, tmp_path):
    (tmp_path / "part.nc").write_text(PROGRAM)
    (tmp_path / "mill.yaml").write_text(CELL)
    return lambda *more: cli("optimise", "part.nc", "--cell", "mill.yaml", *more)


def test_a_force_is_kept_and_only_f_words_differ(shop, cli, tmp_path) -> None:
    done = shop("--limit", "force=90 N", "-o", "new.nc", "--format", "json")
    new = (tmp_path / "new.nc").read_text()
    word = re.compile(r" ?F[0-9.]+")

    assert done.status == 0 and done.json["lines_above"] == []
    jsonschema.validate(done.json, json.loads(cli("schema", "optimise").out))
    assert float(done.json["loads"]["force"]["before"].split()[0]) > 100.0
    assert 80.0 < float(done.json["loads"]["force"]["after"].split()[0]) <= 90.0
    assert done.json["time_s"]["after"] > done.json["time_s"]["before"]
    assert new != PROGRAM and word.sub("", new) == word.sub("", PROGRAM)

    assert cli("run", "new.nc", "--cell", "mill.yaml", "--format", "json").status == 0
    forces = [tool["max_force_N"] for tool in json.loads((tmp_path / "out" / "results.json").read_text())["tools"]]
    assert 80.0 < max(forces) <= 90.0


def test_feeds_may_rise_to_a_chip(shop, tmp_path) -> None:
    done = shop("--limit", "chip=0.1 mm", "--raise", "3", "-o", "new.nc")

    assert done.status == 0 and "chip: 0.07" in done.out
    feed = float(re.search(r"X20 F([0-9.]+)", (tmp_path / "new.nc").read_text())[1])
    assert feed == pytest.approx(1600.0, rel=0.02)


def test_a_limit_that_no_feed_keeps_is_told_and_the_feed_is_left(shop, tmp_path) -> None:
    """A crawl of a fiftieth of the feed was written, at which the edge would rub."""
    done = shop("--limit", "deflection=1 um", "-o", "new.nc")

    assert done.status == 1 and "lines above a limit: 7" in done.out
    assert "also at a tenth of their feed, which is left as it was: 7, 8\n" in done.out
    assert (tmp_path / "new.nc").read_text() == PROGRAM


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ((), "what is the limit?"),
        (("--limit", "forze=3 N"), "there is no limit forze"),
        (("--limit", "force=3 mm"), "such as force='400 N'"),
        (("--limit", "force=3 N", "--raise", "0.5"), "a factor from 1"),
        (("--limit", "force=3 N", "-o", "part.nc"), "would overwrite what the command reads"),
    ],
)
def test_misuse_is_one_line(shop, more: tuple[str, ...], told: str) -> None:
    done = shop(*more)

    assert done.status == 2 and told in done.err and len(done.err.splitlines()) == 1

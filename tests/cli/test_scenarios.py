"""Scenarios of first users, in the words that they see."""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

BROKEN_CELLS = Path(__file__).parents[1] / "data" / "cells" / "broken"


def test_first_five_minutes(cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A 6 mm slot, 2 mm deep, 50 mm long: 2 (6 * 50 + pi 3^2) = 656.5 mm³; 7 mm at F200 and 50 mm at F600: 7.1 s."""
    assert cli("init", "demo").status == 0
    monkeypatch.chdir(tmp_path / "demo")
    done = cli("run", "part.nc", "--cell", "cell.yaml", "--world", "kinematic")

    assert done.status == 0
    assert "part.nc: no errors, no warnings" in done.out
    removed, bound = re.search(r"removed +([\d.]+) mm³ +± ([\d.]+) mm³", done.out).groups()
    assert abs(float(removed) - 656.549) <= min(float(bound), 3.3)
    assert re.search(r"feed distance +57\.0 mm", done.out)
    assert re.search(r"feed +7\.[01] s", done.out)
    assert "files in out:" in done.out and "look at it:" in done.out
    assert cli("init", ".").status == 2  # nothing is overwritten


WRONG = """G21 G90 G17
T1 M6
G0 X0 Y0
F300
G2 X10 Y0 I4
G0 Z5
G0 X20 Y10
G1 X30 Y
G1 X40
G0 Z10
G33.0 Z3
M5
M2
"""


def test_wrong_program(cli, write) -> None:
    write("bad.nc", WRONG)
    done = cli("check", "bad.nc", "--cell", "cell.yaml")

    assert done.status == 1 and "Traceback" not in done.err
    heads = re.findall(r"^bad\.nc:(\d+):(\d+): error (GS\d+): (.*)$", done.out, re.MULTILINE)
    assert [(line, column) for line, column, _, _ in heads] == [("5", "1"), ("8", "8"), ("11", "1")]
    for number in ("4.000 mm", "6.000 mm", "2.000 mm"):
        assert number in heads[0][3]
    assert "  8 | G1 X30 Y\n    |        ^\n" in done.out
    assert "G0 Z3" in done.out  # what the post meant
    for _, _, code, _ in heads:
        assert cli("explain", code).status == 0


def test_wrong_cell(cli, write) -> None:
    write(
        "cell.yaml",
        "gcodesim: 1\nmachine: gantry_xyz\ntols:\n  1: {type: flat_end_mill, diameter: 10 deg}\n"
        "fixtures:\n  vise: {mesh: vise.stl, unit: mm}\n",
    )
    done = cli("cell", "validate", "cell.yaml")

    assert done.status == 1
    heads = re.findall(r"^cell\.yaml:(\d+):(\d+): error GS\d+: (.*)$", done.out, re.MULTILINE)
    assert [(line, column) for line, column, _ in heads] == [("3", "1"), ("4", "38"), ("6", "16")]
    assert "did you mean `tools`" in done.out and "a length" in heads[1][2] and "vise.stl" in heads[2][2]
    assert cli("cell", "validate", "absent.yaml").status == 2


def test_a_resolution_that_no_memory_holds(cli, write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (tmp_path / "cell.yaml").read_text().replace("100, 60, 20", "400, 300, 50")
    write("fine.yaml", text.replace("resolution: 1", "resolution: 0.005"))
    monkeypatch.setattr("gcodesim.material.stock.Stock.box", lambda *_: pytest.fail("it is made all the same"))
    done = cli("run", "slot.nc", "--cell", "fine.yaml")

    assert done.status == 1
    assert re.search(r"fine\.yaml:3:\d+: error GS411: .* needs .*\(\d{10,} bytes\)", done.out)
    assert re.search(r"the finest resolution that fits is 0\.0\d+ mm", done.out)


@pytest.mark.slow
def test_a_heavy_program(write, tmp_path: Path) -> None:
    """100,000 blocks of a raster on an arm at 0.25 mm, in the world with dynamics, into a pipe."""
    rows = []
    for row in range(100):
        columns = range(1000) if row % 2 == 0 else range(999, -1, -1)
        for column in columns:
            x, y = 5 + 0.19 * column, 5 + 1.1 * row
            rows.append(f"G1 X{x:.3f} Y{y:.3f} Z{-2 + math.sin(x / 9) * math.cos(y / 7):.3f} F4000\n")
    head = "G21 G90 G17 G64 P0.02\nT1 M6\nG43 H1\nS12000 M3\nG0 X5 Y5 Z10\nG1 Z-1 F600\n"
    write("big.nc", head + "".join(rows) + "G0 Z50\nM5\nM2\n")
    write(
        "arm.yaml",
        "gcodesim: 1\nrobots: {arm: {model: kuka_kr10_r1100_2}}\nwork_offsets: {G54: {xyz: [450, -60, 250]}}\n"
        "stock: {box: [200, 120, 20], zero: top-front-left, in: G54, material: al6082_t6, resolution: 0.25}\n"
        "tools: {1: {type: ball_end_mill, diameter: 8, length: 60}}\nsimulation: {world: bullet}\n",
    )
    command = [sys.executable, "-m", "gcodesim", "run", "big.nc", "--cell", "arm.yaml"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=900)

    assert done.returncode == 0, done.stdout + done.stderr
    assert "big.nc: no errors, no warnings" in done.stdout
    last = done.stderr.strip().splitlines()[-1]
    ratio, memory = re.search(r"([\d.]+) simulated seconds in a real one, peak memory (\d+) MB", last).groups()
    assert float(ratio) > 0.0 and int(memory) < 1000
    assert "block " not in done.stderr and "\x1b" not in done.stderr  # no bar in a pipe
    results = (tmp_path / "out" / "results.json").read_text()
    assert "memory" not in results and json.loads(results)["time"]["total_s"] > 200
    assert len((tmp_path / "out" / "lines.csv").read_text().splitlines()) > 100_000


def test_nothing_is_cut_and_nothing_is_invented(cli, write, tmp_path: Path) -> None:
    import trimesh

    write("air.nc", "G21 G90\nT1 M6\nG0 Z50\nM2\n")
    done = cli("run", "air.nc", "--cell", "cell.yaml", "--format", "json")

    assert done.status == 0
    stock = done.json["stocks"]["stock"]
    assert stock["removed_mm3"] == 0 and stock["remaining_mm3"] == 120_000 == stock["initial_mm3"]
    box = trimesh.load_mesh(tmp_path / "out" / "stock.stl")
    assert box.volume == pytest.approx(120_000, rel=1e-9)
    assert box.is_watertight
    assert box.extents.tolist() == pytest.approx([100, 60, 20])


def test_a_tool_that_starts_inside_the_stock(cli, write) -> None:
    write(
        "inside.yaml",
        "gcodesim: 1\nmachine: {model: gantry_xyz, home: {X: 100, Y: 100, Z: -100}}\n"
        "work_offsets: {G54: {xyz: [100, 100, -90]}}\n"
        "stock: {min: [-20, -20, -20], max: [20, 20, 10], in: G54, material: al6082_t6, resolution: 1}\n"
        "tools: {1: {type: flat_end_mill, diameter: 6}}\nsimulation: {world: kinematic}\n",
    )
    write("air.nc", "G21 G90\nT1 M6\nG0 Z50\nM2\n")
    done = cli("run", "air.nc", "--cell", "inside.yaml", "--format", "json")

    assert done.status == 1
    assert {code for code, _, _ in done.errors} & {"GS402", "GS403"}
    assert done.json["stocks"]["stock"]["removed_mm3"] == 0


@pytest.mark.parametrize("path", sorted(BROKEN_CELLS.glob("*.yaml")), ids=lambda path: path.stem)
def test_broken_cells_through_the_command_line(cli, path: Path) -> None:
    expected = re.findall(rb"# expect: (GS\d{3}) (\d+):(\d+)", path.read_bytes())
    done = cli("cell", "validate", path, "--format", "json")

    assert done.status == 1
    places = [(code.decode(), int(line), int(column)) for code, line, column in expected]
    assert done.errors == sorted(places, key=lambda place: place[1:])
    assert all(f["file"] == path.name or f["code"].startswith("GS76") for f in done.json["findings"])


PLUNGE = """G21 G90 G17 G94
T2 M6
G43 H2
S6000 M3
G0 X50 Y30
G0 Z2
G1 Z-5 F200
G0 Z20
M5
M2
"""
SARIF_LEVELS = {"error", "warning", "note", "none"}


def test_ci_of_a_post_processor(cli, write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GCODESIM_TEST_CACHE", str(tmp_path / "cache"))
    (tmp_path / "suite").mkdir()
    for name in ("clean", "part"):
        write(f"suite/{name}.nc", PLUNGE)
        write(f"suite/{name}.test.yaml", "cell: cell.yaml\n")
    (tmp_path / "suite" / "cell.yaml").write_bytes((tmp_path / "cell.yaml").read_bytes())
    assert cli("accept", "suite").status == 0
    arguments = ("test", "suite/", "--junit", "j.xml", "--sarif", "s.sarif", "--github")

    write("suite/part.nc", PLUNGE.replace(" M3", ""))  # the commit
    done = cli(*arguments)
    assert done.status == 1
    assert re.search(
        r"suite/part\.nc:7:1: error GS501: T2 feeds through [\d.]+ mm³ of stock with the spindle", done.out
    )
    assert re.search(r"^::error file=suite/part\.nc,line=7,.*GS501", done.out, re.MULTILINE)
    suites = ElementTree.parse(tmp_path / "j.xml").getroot()
    cases = list(suites.iter("testcase"))
    assert len(cases) == 2 and [len(case.findall("failure")) for case in cases] == [0, 1]
    (sarif,) = json.loads((tmp_path / "s.sarif").read_text())["runs"]
    rules = [rule["id"] for rule in sarif["tool"]["driver"]["rules"]]
    assert {result["ruleId"] for result in sarif["results"]} <= set(rules) and "GS501" in rules
    places = [place["physicalLocation"] for result in sarif["results"] for place in result["locations"]]
    uris = {place["artifactLocation"]["uri"] for place in places}
    assert "suite/part.nc" in uris and not any(uri.startswith("/") or ":" in uri for uri in uris)
    assert {result["level"] for result in sarif["results"]} <= SARIF_LEVELS

    write("suite/part.nc", PLUNGE)  # the repair
    assert cli(*arguments).status == 0
    outputs = []
    for number, jobs in ((1, 1), (2, 2)):
        out = tmp_path / f"out{number}"
        out.mkdir()
        files = ("--junit", out / "j.xml", "--sarif", out / "s.sarif", "--gitlab", out / "g.json", "--format", "json")
        done = subprocess.run(
            [sys.executable, "-m", "gcodesim", "test", "suite", "-j", str(jobs), *map(str, files)],
            capture_output=True,
            env={**os.environ, "PYTHONHASHSEED": str(number)},
            check=True,
        )
        outputs.append({"stdout": done.stdout, **{path.name: path.read_bytes() for path in sorted(out.iterdir())}})
    assert set(outputs[0]) == {"stdout", "j.xml", "s.sarif", "g.json"} and outputs[0] == outputs[1]


def test_replay(cli, write, tmp_path: Path) -> None:
    """What the viewer is given; `test_processes.py` interrupts a run, `scripts/view_log.py` opens a real viewer."""
    import trimesh

    from gcodesim.playback import Recording

    write("part.nc", "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 X5 Y5\nG0 Z2\nG1 Z-1 F300\nG1 X35\nG0 Y25\nM5\nM2\n")
    assert cli("run", "part.nc", "--cell", "arm.yaml").status == 1
    assert cli("info", "out/run.mcap", "--layout").json  # the layout is inside
    log = Recording.open(tmp_path / "out" / "run.mcap")  # the file alone
    assert {"arm/link_6", "tool", "tcp", "stock"} <= set(log.frames().parents)
    volumes: dict[float, float] = {}
    for share in (0.0, 0.6, 1.0, 0.6, 0.0):  # jumping to any time, backwards too
        seconds = share * log.end_ns * 1e-9
        assert cli("export", "out/run.mcap", "--to", "stl", "--at", f"{seconds:.6f}", "-o", "then.stl").status == 0
        volume = float(trimesh.load_mesh(tmp_path / "then.stl").volume)
        assert volumes.setdefault(share, volume) == volume
    assert volumes[0.0] == pytest.approx(12_000, rel=1e-4)
    assert 12_000 > volumes[0.6] + 20 > volumes[1.0] + 40
    told = [(event.code, event.file, event.line) for event in log.events if event.is_finding]
    assert ("GS401", "part.nc", 9) in told


def test_comparison_after_a_change(cli, write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """0.4 mm deeper with 10 mm: pi/4 · 10² · 0.4 = 31.4 mm³ more, 0.4 mm at 200 mm/min = 0.12 s more."""
    monkeypatch.setenv("GCODESIM_TEST_CACHE", str(tmp_path / "cache"))
    write("fine.yaml", (tmp_path / "cell.yaml").read_text().replace("resolution: 1", "resolution: 0.2"))
    renumbered = "".join(f"N{10 * i} {line} (op {i})\n" for i, line in enumerate(PLUNGE.splitlines(), 1))
    for folder, text in (("old", PLUNGE), ("new", renumbered)):
        (tmp_path / folder).mkdir()
        write(f"{folder}/part.nc", text)
        write("part.nc", text)
        assert cli("run", "part.nc", "--cell", "fine.yaml", "--out", f"runs_{folder}").status == 0
    for sides in (("old/", "new/"), ("runs_old/", "runs_new/")):
        done = cli("diff", *sides)
        assert done.status == 0 and done.out.startswith("no difference in motion or result")

    write("part.nc", PLUNGE)
    write("part.test.yaml", "cell: fine.yaml\n")
    assert cli("accept").status == 0
    write("part.nc", PLUNGE.replace("Z-5", "Z-5.4"))
    done = cli("diff", "part.golden.json", "part.nc", "--cell", "fine.yaml")
    assert done.status == 1
    assert "− part.nc:7\n" in done.out and "+ part.nc:7: G1 Z-5.4 F200" in done.out and "Z −5 → −5.4 mm" in done.out
    removed = re.search(r"stocks\.stock\.removed_mm3: \S+ → \S+ mm³ \(\+([\d.]+); tolerance `volume` allows", done.out)
    assert float(removed[1]) == pytest.approx(31.4, abs=0.3)
    seconds = re.search(r"time\.feed_s: \S+ → \S+ s \(\+([\d.]+); tolerance `time` allows", done.out)
    assert float(seconds[1]) == pytest.approx(0.12, abs=0.005)
    taken = cli("accept").out.splitlines()
    assert taken[0] == "part: accepting part.golden.json"
    assert taken[1:-1] == [f"  {line}" for line in done.out.splitlines()]  # exactly that list
    assert cli("diff", "part.golden.json", "part.nc", "--cell", "fine.yaml").status == 0

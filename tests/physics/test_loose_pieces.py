"""In an engine a piece that is cut free falls as a body of its own, lies, is in the log, and is hit where it lies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.log.topics import LOOSE
from gcodesim.playback import Recording
from tests.physics.runs import Ran, run_texts

MM = 1e-3
CELL = """
gcodesim: 1
machine: gantry_xyz
stock: {{box: [60, 40, 6], zero: top-front-left, material: al6082_t6, resolution: 0.5}}
tools: {{1: {{type: flat_end_mill, diameter: 3, length: 60, flute_length: 50}}}}
{more}
"""
OVER_A_BED = """fixtures:
  left: {box: [5, 40, 30], zero: top-front-left, in: G54, xyz: [0, 0, -6]}
  right: {box: [5, 40, 30], zero: top-front-left, in: G54, xyz: [55, 0, -6]}
  bed: {box: [60, 40, 10], zero: top-front-left, in: G54, xyz: [0, 0, -36]}"""
SQUARE = """G21 G90 G61
T1 M6
G43 H1
S8000 M3
G0 X20 Y10 Z5
G1 Z-6.5 F600
X40
Y30
X20
Y10
G0 Z20
X30 Y20
G1 Z{z} F600
G0 Z20
M5
M2
"""


def ran(out: Path, more: str = "", *, z: float = -3.0, world: str = "bullet", program: str = SQUARE) -> Ran:
    return run_texts(program.format(z=z), CELL.format(more=more), out, world=world)


def hits(run: Ran) -> list[tuple[int, str]]:
    return [(found.span.line, found.message) for found in run.results.findings if found.code == "GS309"]


def test_a_piece_on_its_table_stays_there_and_is_hit(tmp_path: Path) -> None:
    """It stands on what the stock stands on. Line 13 plunges into it; lines 10 and 11, which part it, do not hit it."""
    run = ran(tmp_path)
    (fallen,) = run.stock.as_json()["fallen"]
    ((line, message),) = hits(run)

    assert (fallen["body"], fallen["fell_mm"], fallen["lies_on"]) == ("loose/1", 0.0, "")
    assert line == 13
    assert message.startswith("the cutter of T1 hits loose piece 1,")


def test_a_piece_falls_onto_what_is_below(tmp_path: Path) -> None:
    """30 mm onto the bed, where a plunge of 3 mm does not reach it: free fall lasts 78 ms.

    The engine adds speeds up before ways, in parts of 1 ms, and slows bodies down by 4 % a second.
    """
    run = ran(tmp_path, OVER_A_BED)
    (fallen,) = run.stock.as_json()["fallen"]
    (body,) = run.execution.loose

    assert fallen["lies_on"] == "bed"
    assert fallen["fell_mm"] == pytest.approx(30.0, abs=0.05)
    assert hits(run) == []
    drop = body.fall[:, 2, 3] - body.X_W[2, 3]
    t = 4e-3 * np.arange(1, len(drop) + 1)
    free = t < 0.07
    assert np.allclose(drop[free], -0.5 * 9.80665 * t[free] * (t[free] + 1e-3), rtol=2e-3)


def test_a_tool_that_goes_down_to_it_hits_it(tmp_path: Path) -> None:
    """Its top is at Z-30."""
    assert [line for line, _ in hits(ran(tmp_path, OVER_A_BED, z=-32.0))] == [13]
    assert hits(ran(tmp_path, OVER_A_BED, z=-29.0)) == []


def test_the_log_shows_it_on_its_way_and_where_it_lies(tmp_path: Path) -> None:
    run = ran(tmp_path, OVER_A_BED)
    shown = Recording.open(tmp_path).drawings(LOOSE.name)
    (body,) = run.execution.loose
    heights = [content[0].shapes[0].p[2] for _, content in shown[1:]]

    assert shown[0] == (0, ())
    assert shown[1][0] == body.begin * 4_000_000
    assert shown[-1][0] == body.end * 4_000_000
    assert heights[0] == pytest.approx(heights[-1] + 30 * MM, abs=5e-5)
    assert len(heights) > 3
    mesh = shown[1][1][0].shapes[0]
    assert np.ptp(mesh.points, axis=0)[2] == pytest.approx(6 * MM, abs=1e-5)


def test_two_runs_are_the_same_to_the_byte(tmp_path: Path) -> None:
    for name in ("one", "other"):
        ran(tmp_path / name, OVER_A_BED)

    one, other = ((tmp_path / name / "run.mcap").read_bytes() for name in ("one", "other"))
    assert one == other


def test_a_ring_goes_down_around_the_disc_in_it(tmp_path: Path) -> None:
    """Both lie on the bed, the ring around the disc: neither is taken for its convex hull."""
    program = SQUARE.split("G1 Z-6.5", maxsplit=1)[0].replace("X20 Y10", "X40 Y20")
    program += "G1 Z-6.5 F600\nG2 I-10\nG0 Z5\nX46\nG1 Z-6.5\nG2 I-16\nG0 Z20\nM5\nM2\n"
    run = ran(tmp_path, OVER_A_BED, program=program)
    fallen = run.stock.as_json()["fallen"]

    assert [(piece["lies_on"], piece["body"]) for piece in fallen] == [("bed", "loose/1"), ("bed", "loose/2")]
    assert [piece["fell_mm"] for piece in fallen] == [pytest.approx(30.0, abs=0.1)] * 2
    assert hits(run) == []


def test_the_kinematic_world_knows_no_free_bodies(tmp_path: Path) -> None:
    run = ran(tmp_path, world="kinematic")
    (fallen,) = run.stock.as_json()["fallen"]

    assert "lies_on" not in fallen
    assert run.execution.loose == ()
    assert hits(run) == []

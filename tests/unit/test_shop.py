"""A cell come to life: what stands on what, where it is drawn, where it is cut and what it is hit by."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gcodesim
from gcodesim.jobs.results import Results
from gcodesim.playback import Recording
from gcodesim.shop import open_shop

MILL = """gcodesim: 1
machine:
  axes:
    X: {travel: [-300, 300 mm], speed: 20 m/min, acceleration: 2 m/s^2, side: table}
    Y: {travel: [-200, 200 mm], speed: 20 m/min, acceleration: 2 m/s^2}
    Z: {travel: [-350, 0 mm], speed: 12 m/min, acceleration: 1.5 m/s^2}
  base: {xyz: [100, 200, 900], rpy: [0, 0, 30]}
work_offsets: {G54: {xyz: [0, 0, -148]}}
tools: {1: {type: flat_end_mill, diameter: 8, flutes: 2, length: 50}}
simulation: {world: kinematic}
"""
PROGRAM = """G21 G90
T1 M6
S8000 M3
G0 X-10 Y10 Z10
G1 Z-2 F2000
G1 X50
G0 Z10
M2
"""


def run(folder: Path, *lines: str) -> Results:
    folder.mkdir()
    (folder / "part.nc").write_text(PROGRAM)
    (folder / "cell.yaml").write_text(MILL + "\n".join(lines) + "\n")
    return gcodesim.simulate(folder / "part.nc", folder / "cell.yaml", out=folder / "out")


def place_of(recording: Recording, body: str, t_ns: int) -> np.ndarray:
    """Where the middle of a fixture is drawn in the world [m]."""
    drawings = [drawing for _, drawn in recording.drawings("/scene/cell") for drawing in drawn if drawing.id == body]
    (shape,) = drawings[-1].shapes
    X = recording.frames().at(drawings[-1].frame, t_ns)
    return X[:3, :3] @ shape.p + X[:3, 3]


def test_stock_on_the_table_is_cut_as_it_lies_there(tmp_path: Path) -> None:
    """The table frame lies on machine zero, so both cells say the same, and stock without a link goes along too."""
    shape = "box: [60, 40, 12], material: al6082_t6, resolution: 0.5, xyz: [0, 0, -160]"
    plain = run(tmp_path / "plain", f"stock: {{{shape}, in: machine}}")
    linked = run(tmp_path / "linked", f"stock: {{{shape}, in: machine/table}}")

    assert plain.stocks["stock"].removed > 700e-9
    assert linked.stocks["stock"].removed == pytest.approx(plain.stocks["stock"].removed, rel=1e-9)
    assert (tmp_path / "linked/out/stock.stl").read_bytes() == (tmp_path / "plain/out/stock.stl").read_bytes()


def test_stock_on_the_spindle_side_is_never_met_by_the_table(tmp_path: Path) -> None:
    """Stock on the slide of Y goes along with Y, not with X: the tool bores one place of it, and nothing more."""
    stock = "stock: {box: [60, 40, 12], material: al6082_t6, resolution: 0.5, xyz: [-9, -20, -160], in: machine/link_Y}"
    results = run(tmp_path / "run", stock)

    bore = np.pi * 4e-3**2 * 2e-3
    assert results.stocks["stock"].removed == pytest.approx(bore, rel=0.03)


@pytest.mark.parametrize(
    ("frame", "codes"),
    [
        ("machine", ["GS301"]),  # on the table, as everything that names no link
        ("machine/table", ["GS301"]),
        ("machine/base", []),  # X of the tool stays zero in the machine
        ("machine/link_Z", []),
    ],
)
def test_a_fixture_is_hit_where_it_is(tmp_path: Path, frame: str, codes: list[str]) -> None:
    results = run(tmp_path / "run", f"fixtures: {{pin: {{box: [5, 40, 30], in: {frame}, xyz: [20, 0, -170]}}}}")

    assert [finding.code for finding in results.findings if finding.code.startswith("GS3")] == codes


@pytest.mark.parametrize("frame", ["machine", "machine/table"])
def test_a_fixture_on_the_table_is_drawn_where_it_is(tmp_path: Path, frame: str) -> None:
    run(tmp_path / "run", f"fixtures: {{pin: {{box: [10, 10, 10], in: {frame}, xyz: [100, 0, -170]}}}}")
    recording = Recording.open(tmp_path / "run/out")
    end = recording.series("/joint_states").t_ns[-1]

    begin, there = place_of(recording, "fixture/pin", 0), place_of(recording, "fixture/pin", int(end))

    # X goes to +50, so the table to -50, along the X of a machine that stands turned by 30 degrees
    way = -0.05 * np.array([np.cos(np.pi / 6.0), np.sin(np.pi / 6.0), 0.0])
    assert there - begin == pytest.approx(way, abs=1e-5)


def test_what_stands_on_a_robot_that_nobody_moves_stands_at_its_home(tmp_path: Path) -> None:
    (tmp_path / "cell.yaml").write_text(
        """gcodesim: 1
robots:
  arm: {model: ur10e}
  feeder: {model: ur10e, base: {xyz: [2000, 0, 0]}, home: [0, -90, 90, 0, 90, 0]}
robot: arm
fixtures: {bracket: {box: [10, 10, 10], in: feeder/flange}}
"""
    )
    shop = open_shop(gcodesim.load_cell(tmp_path / "cell.yaml"))
    feeder = shop.scene.movers["feeder"]
    q = {"arm": np.zeros((3, 6))}

    X = shop.scene.track("fixture/bracket", q)

    expected = feeder.X_WB.matrix @ feeder.kinematics.forward(feeder.home[None])[0]
    assert np.abs(X - expected).max() < 1e-12

"""Parts that another program's machine carries are drawn where that machine has them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import gcodesim
from gcodesim.playback.recording import Recording

CELL = """gcodesim: 1
robots:
  left: {model: kuka_kr10_r1100_2}
  right: {model: kuka_kr10_r1100_2, base: {in: world, xyz: [1600, 0, 0], rpy: [0, 0, 180]}}
channels:
  main: {robot: left, work_offsets: {G54: {in: world, xyz: [600, 0, 400]}}}
  other: {robot: right, work_offsets: {G54: {in: world, xyz: [1000, 0, 400]}}}
parts: {panel: {box: [200, 160, 3], zero: bottom-center, in: right/flange, mass: 0.4 kg}}
simulation: {world: kinematic, rate: 50 Hz}
"""


def test_a_panel_goes_with_the_arm_that_holds_it(tmp_path: Path) -> None:
    (tmp_path / "cell.yaml").write_text(CELL)
    (tmp_path / "a.nc").write_text("G21 G90\nG0 X0 Y0 Z100\nM2\n")
    (tmp_path / "b.nc").write_text("G21 G90\nG0 X0 Y-100 Z50\nG1 Y100 F20000\nM2\n")
    channels = {"other": tmp_path / "b.nc"}
    gcodesim.simulate(tmp_path / "a.nc", tmp_path / "cell.yaml", tmp_path / "out", channels=channels)
    frames = Recording.open(tmp_path / "out").frames()
    for t_ns in (0, 1_000_000_000, frames.t_ns[-1]):
        np.testing.assert_allclose(frames.at("part/panel", t_ns), frames.at("right/flange", t_ns), atol=1e-6)
    travel = frames.at("part/panel", frames.t_ns[-1])[:3, 3] - frames.at("part/panel", 0)[:3, 3]
    assert np.linalg.norm(travel) > 0.1

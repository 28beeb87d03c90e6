"""Sensors of an open cell: what they see follows what the script does."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gcodesim
from gcodesim.session.cell_in_hand import MisuseError

CELL = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {in: machine, xyz: [500, 300, -300]}}
stock: {min: [0, 0, -10], max: [60, 40, 0], in: G54, material: al6082_t6, resolution: 0.5}
tools: {9: {type: camera, width: 30, height: 20}}
sensors:
  deep: {type: depth_camera, in: G54, xyz: [30, 20, 100], rpy: [180, 0, 0], width: 60, height: 40, range: [1, 900 mm]}
  felt: {type: force_sensor, in: machine/flange}
simulation: {world: kinematic}
"""


def test_pictures_of_an_open_cell(tmp_path: Path) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text(CELL)
    with gcodesim.open_cell(path) as cell:
        depth = cell.camera("deep").depth()
        picture = cell.picture([0.53, 0.32, 0.3], [0.53, 0.32, -0.3], up=[0, 1, 0], width=40, height=30)
        with pytest.raises(MisuseError, match="couple"):
            cell.camera("T9").picture()
        with pytest.raises(MisuseError, match="no sensor `eye`"):
            cell.camera("eye")
        with pytest.raises(MisuseError, match="no pictures"):
            cell.camera("felt")
        with pytest.raises(MisuseError, match="along `up`"):
            cell.picture([0, 0, 1], [0, 0, 0])
        with pytest.raises(MisuseError, match="pixels"):
            cell.picture([1, 0, 1], [0, 0, 0], width=100_000, height=100_000)
        assert cell.sensor("felt").read()["wrench"].values.shape == (6,)

    assert depth.shape == (40, 60) and depth[20, 30] == pytest.approx(0.1, abs=1e-6)
    assert picture.shape == (30, 40, 3) and len(np.unique(picture.reshape(-1, 3), axis=0)) > 1

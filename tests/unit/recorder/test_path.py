"""The planned path is drawn where the tool passes, whichever axes carry the work."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import gcodesim
from gcodesim.log.reader import read_messages
from gcodesim.playback import Recording
from tests.log_columns import read_columns

CHECK_LOG = Path(__file__).parents[2] / "data" / "log" / "check_log.py"
PROGRAM = (
    "G21 G90 G54\nT1 M6\nG43 H1\nM3 S8000\nG61\n"
    "G0 X20 Y10 Z5\nG1 Z-2 F200\nG1 X40 F600\nG3 X40 Y30 J10\nG0 Z5\nM5\nM2\n"
)
CELL = """gcodesim: 1
machine:
  axes:
    X: {{travel: [-300, 300], speed: 10 m/min{0}}}
    Y: {{travel: [-300, 300], speed: 10 m/min{1}}}
    Z: {{travel: [-400, 0], speed: 10 m/min}}
tools: {{1: {{type: flat_end_mill, diameter: 6, flutes: 2, length: 60}}}}
stock: {{box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 2}}
simulation: {{world: kinematic}}
"""


def off_path(points, segments):
    """Distance (n,) of points (n, 3) from the nearest of the segments (m, 2, 3)."""
    start, way = segments[:, 0], segments[:, 1] - segments[:, 0]
    length2 = np.maximum((way**2).sum(axis=1), 1e-18)
    share = np.clip(((points[:, None] - start) * way).sum(axis=2) / length2, 0.0, 1.0)
    return np.linalg.norm(start + share[..., None] * way - points[:, None], axis=2).min(axis=1)


def lines_of(update):
    """Frame and segments (m, 2, 3) of the lines of a SceneUpdate."""
    found = []
    for entity in update.entities:
        for line in entity.lines:
            points = np.array([(p.x, p.y, p.z) for p in line.points])
            pairs = np.reshape(line.indices, (-1, 2)) if line.indices else np.arange(len(points) - 1)[:, None] + [0, 1]
            found.append((entity.frame_id, points[pairs]))
    return found


@pytest.mark.parametrize(
    ("sides", "frame"),
    [(("", ""), "world"), ((", side: table", ""), "path"), ((", side: table", ", side: table"), "path")],
)
def test_the_tip_runs_along_the_drawn_path(tmp_path, sides, frame):
    (tmp_path / "part.nc").write_text(PROGRAM)
    (tmp_path / "cell.yaml").write_text(CELL.format(*sides))
    gcodesim.simulate(tmp_path / "part.nc", tmp_path / "cell.yaml", tmp_path / "out")
    log = tmp_path / "out" / "run.mcap"

    ((_, update),) = read_messages(log, "/scene/path")
    drawn = lines_of(update)
    assert {name for name, _ in drawn} == {frame}
    tips = read_columns(log, "/tcp", [f"pose.position.{axis}" for axis in "xyz"])
    p_W = np.stack([tips[f"pose.position.{axis}"] for axis in "xyz"], axis=1)
    X_WF = np.linalg.inv(Recording.open(log).frames().in_world(frame))
    p = np.einsum("nij,nj->ni", X_WF[:, :3, :3], p_W) + X_WF[:, :3, 3]
    assert np.ptp(p, axis=0)[0] > 0.025
    assert off_path(p, np.concatenate([segments for _, segments in drawn])).max() < 1e-4  # arcs in pieces of 5 degrees

    for t_ns, block in read_messages(log, "/scene/block"):
        for name, segments in lines_of(block):
            assert name == frame
            now = np.searchsorted(tips["t_ns"], t_ns, side="right")
            if now + 1 < len(p):
                assert off_path(p[now : now + 1], segments)[0] < 1e-4

    spec = importlib.util.spec_from_file_location("check_log", CHECK_LOG)
    checker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(checker)
    assert checker.check_log(str(log))[0] == []

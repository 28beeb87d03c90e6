"""Sensors see parts and devices where these are by then, and the fingers as far open as they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.physics.runs import run_texts
from tests.unit.observation.test_sensors_in_a_run import depths, messages

CELL = """
gcodesim: 1
machine: gantry_xyz
frames: {table: {in: world, xyz: [400, 300, -400]}}
work_offsets: {G54: {in: table}}
m_codes: {M62 P1: {gripper: close}, M63 P1: {gripper: open}}
loaded_tool: 1
tools: {1: {type: finger_gripper, stroke: 60, force: 60 N, friction: 0.5, length: 120}}
fixtures: {deck: {box: [600, 300, 20], zero: top-center, in: table}}
devices:
  door: {box: [40, 40, 20], zero: bottom-center, in: table, xyz: [0, 110, 0], word: M64 P3, travel: [150, 0, 0]}
parts: {plate: {box: [40, 90, 50], zero: bottom-center, in: table, mass: 0.5 kg}}
sensors:
"""
CAMERA = (
    "  deep: {{type: depth_camera, in: table, xyz: [{x}, {y}, {z}], rpy: [{turn}, 0, 0], width: 9, height: 9, "
    "field_of_view: 5 deg, trigger: M111, range: [10, 900 mm]}}\n"
)
PROGRAM = """G21 G90 G17 G94
G43 H1
G0 X0 Y0 Z150
G1 Z30 F9000
M62 P1
G4 P0.2
G1 Z90
G1 X160
M111
G1 Z30
M63 P1
G4 P0.2
G1 Z150
G0 X-100
M64 P3
G4 P0.1
M111
M2
"""


def seen(folder: Path, x: float, y: float, world: str, z: float = 200, turn: float = 180) -> list[float]:
    """The depth [m] in the middle of both pictures of a camera that looks down at a place, or as it is turned."""
    run_texts(PROGRAM, CELL + CAMERA.format(x=x, y=y, z=z, turn=turn), folder, world=world)
    _, *pictures = messages(folder / "run.mcap", "/camera/deep/depth")
    return [float(depths(picture)[4, 4]) for _, picture in pictures]


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ((0, 0), [0.2, 0.2]),  # it has been taken away
        ((160, 40), [0.2 - 0.11, 0.15]),  # in the hand, 60 mm up; then set down
        ((0, 110), [0.18, 0.2]),  # the door, before it opens and after that
        ((150, 110), [0.2, 0.18]),
    ],
)
def test_a_camera_sees_what_was_moved_where_it_is(
    place: tuple[float, float], expected: list[float], world: str, tmp_path: Path
) -> None:
    assert seen(tmp_path, *place, world) == pytest.approx(expected, abs=1e-6)


def test_a_camera_sees_fingers_close(tmp_path: Path) -> None:
    """Fingers are 10 mm thick and 20 wide: about a part of 40 mm they are 20 to 30 mm from the tip, not 30 to 40."""
    near, far = (seen(tmp_path / str(x), 160 + x, -300, "kinematic", 120, -90)[0] for x in (25, 35))

    assert near == pytest.approx(0.29, abs=1e-6) and np.isnan(far)

"""Lines, frames and names in the window of the client, and what the mouse points at."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pybullet as p

from gcodesim.arithmetic.matrices import norm
from gcodesim.frames import Array
from gcodesim.pybullet_industrial.robot_base import RobotBase
from gcodesim.pybullet_industrial.turns import matrix_of

_GREEN = (0.0, 1.0, 0.0)
_FAR = 10_000  # [m] to which the mouse points
_MOUSE_BUTTON, _LEFT = 2, 0


def draw_point(point: Any, color: Sequence[float] = _GREEN, length: float = 0.05, width: float = 2.0) -> None:
    """A cross of three lines, `length` [m] to each side of `point` (3,) [m]."""
    at = np.asarray(point, dtype=float)
    for arm in length * np.eye(3):
        p.addUserDebugLine(at + arm, at - arm, lineColorRGB=color, lineWidth=width, lifeTime=0)


def draw_path(path: Array, color: Sequence[float] = _GREEN, width: float = 2.0) -> None:
    """Lines from point to point of `path` (3, n) [m]."""
    points = np.asarray(path).T
    for before, after in pairwise(points):
        p.addUserDebugLine(after, before, lineColorRGB=color, lineWidth=width, lifeTime=0)


def draw_coordinate_system(
    position: Any,
    orientation: Any,
    length: float = 0.1,
    width: float = 2.0,
    life_time: float = 0,
    parent_id: int = -1,
    parent_index: int = -1,
) -> None:
    """X red, Y green, Z blue, `length` [m] long, at a pose in the world or of a link; `life_time` [s], 0: for ever."""
    at = np.asarray(position, dtype=float)
    for axis, color in zip(matrix_of(orientation).T, np.eye(3).tolist(), strict=True):
        p.addUserDebugLine(
            at,
            at + length * axis,
            lineColorRGB=color,
            lineWidth=width,
            lifeTime=life_time,
            parentObjectUniqueId=parent_id,
            parentLinkIndex=parent_index,
        )


def draw_robot_frames(
    robot: RobotBase, text_size: int = 1, length: float = 0.1, width: float = 2.0, life_time: float = 0
) -> None:
    """The frame of every link of a robot, with its name."""
    for name, index in robot._link_name_to_index.items():
        draw_coordinate_system([0, 0, 0], [0, 0, 0, 1], length, width, life_time, robot.urdf, index)
        p.addUserDebugText(
            name,
            [0, 0, 0],
            textSize=text_size,
            lifeTime=life_time,
            parentObjectUniqueId=robot.urdf,
            parentLinkIndex=index,
        )


def get_object_id_from_mouse() -> tuple[int, int]:
    """Body and link under the mouse if its left button has just been pressed, else -1, -1."""
    for kind, x, y, button, state in p.getMouseEvents():
        if kind == _MOUSE_BUTTON and button == _LEFT and state & p.KEY_WAS_TRIGGERED:
            start, end = _ray_of_pixel(x, y)
            hit = p.rayTest(start, end)[0]
            return hit[0], hit[1]
    return -1, -1


def _ray_of_pixel(x: float, y: float) -> tuple[Array, Array]:
    """Start and end (3,) of the ray from the camera of the window through a pixel."""
    camera = p.getDebugVisualizerCamera()
    width, height, distance = camera[0], camera[1], camera[10]
    forward, across, up, target = (np.array(camera[k]) for k in (5, 6, 7, 11))
    start = target - distance * forward
    ahead = _FAR * (target - start) / norm(target - start)
    end = start + ahead + (x / width - 0.5) * across - (y / height - 0.5) * up
    return start, end

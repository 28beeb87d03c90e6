"""pybullet's own window: bodies as triangles, each moved by its pose; lines; and what the mouse points at."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norm
from gcodesim.frames import Array, quaternion_from_rotation
from gcodesim.world.bullet import import_pybullet
from gcodesim.world.protocol import WorldUnavailable

_LONGEST: Final = 30_000
"""Points of a body that pybullet's window takes; larger bodies are drawn in pieces."""

_MOUSE_BUTTON, _LEFT = 2, 0
_TRIGGERED: Final = 1 << 1
"""Of the states of a button: a press and its release are one event for who looks only after both."""

_SHIFT: Final = 1 << 0


class BodyWindow:
    """An open window. With `hidden` nothing is shown, for machines without a screen; everything else is the same.

    `WorldUnavailable` where pybullet or a screen is missing.
    """

    def __init__(self, title: str = "gcodesim", *, hidden: bool = False) -> None:
        self._p: Any = import_pybullet()
        if not hidden and not screen_is_there():
            raise WorldUnavailable("there is no screen here for pybullet's window (DISPLAY); leave out --gui")
        p = self._p
        self._client = p.connect(p.DIRECT) if hidden else p.connect(p.GUI, options=f"--window_title={title}")
        if self._client < 0:
            raise WorldUnavailable("pybullet opens no further window; one is open already")
        if not hidden:
            self._p.configureDebugVisualizer(self._p.COV_ENABLE_GUI, 0, physicsClientId=self._client)
        self._bodies: dict[str, list[int]] = {}
        self._lines: list[int] = []

    @property
    def is_open(self) -> bool:
        """Whether nobody has closed it."""
        return self._client >= 0 and bool(self._p.isConnected(self._client))

    def shape(self, name: str, triangles: Array, colors: NDArray[np.uint8]) -> None:
        """Draw the body `name` as triangles (t, 3, 3) [m] in its frame, with colours (t, 3) or (3,); replaces it."""
        self.forget(name)
        made = []
        for part, color in _by_color(triangles, colors):
            step = _LONGEST // 3
            for first in range(0, len(part), step):
                made.append(self._body(part[first : first + step], color))
        self._bodies[name] = made

    def forget(self, name: str) -> None:
        """Take a body away; one that is not there is none."""
        for body in self._bodies.pop(name, []):
            self._p.removeBody(body, physicsClientId=self._client)

    def place(self, name: str, X: Array) -> None:
        """Put a body at `X` (4, 4) in the world."""
        p, q = X[:3, 3].tolist(), quaternion_from_rotation(X[:3, :3]).tolist()
        for body in self._bodies.get(name, []):
            self._p.resetBasePositionAndOrientation(body, p, q, physicsClientId=self._client)

    def line(self, points: Array, color: tuple[float, float, float], width: float = 2.0) -> None:
        """Draw a line through points (n, 3) [m] of the world."""
        for start, end in zip(points[:-1].tolist(), points[1:].tolist(), strict=True):
            self._lines.append(self._p.addUserDebugLine(start, end, list(color), width, physicsClientId=self._client))

    def look_at(self, target: Array, distance: float) -> None:
        """Turn the camera to a point (3,) [m] from a distance [m], from the front left and above."""
        self._p.resetDebugVisualizerCamera(distance, 40.0, -30.0, target.tolist(), physicsClientId=self._client)

    def clicks(self) -> Iterator[tuple[Array, Array]]:
        """Rays of the clicks since the last call: where the eye is (3,), and the direction (3,), in the world."""
        for kind, x, y, button, state in self._p.getMouseEvents(physicsClientId=self._client):
            if kind == _MOUSE_BUTTON and button == _LEFT and state & _TRIGGERED:
                yield self._ray(x, y)

    def _ray(self, x: float, y: float) -> tuple[Array, Array]:
        seen = self._p.getDebugVisualizerCamera(physicsClientId=self._client)
        return ray_through(
            x, y, (int(seen[0]), int(seen[1])), np.array(seen[2]).reshape(4, 4).T, np.array(seen[3]).reshape(4, 4).T
        )

    def close(self) -> None:
        """Close it; a second call does nothing."""
        if self.is_open:
            self._p.disconnect(self._client)
        self._client = -1

    def _body(self, triangles: Array, color: NDArray[np.uint8]) -> int:
        points = triangles.reshape(-1, 3)
        normals = np.repeat(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), 3, axis=0)
        length = np.linalg.norm(normals, axis=1)[:, None]
        shape = self._p.createVisualShape(
            self._p.GEOM_MESH,
            vertices=points.tolist(),
            indices=list(range(len(points))),
            normals=(normals / np.where(length > 0.0, length, 1.0)).tolist(),
            rgbaColor=[*(color / 255.0).tolist(), 1.0],
            physicsClientId=self._client,
        )
        body: int = self._p.createMultiBody(0.0, -1, shape, physicsClientId=self._client)
        return body


def ray_through(x: float, y: float, size: tuple[int, int], view: Array, projection: Array) -> tuple[Array, Array]:
    """The ray through a pixel of a picture of `size` (width, height), drawn with matrices (4, 4) as OpenGL means them.

    Where the eye is (3,), and the direction (3,) of length 1, in the world.
    """
    back = np.linalg.inv(projection @ view)
    near, far = (
        back @ np.array([2.0 * x / size[0] - 1.0, 1.0 - 2.0 * y / size[1], depth, 1.0]) for depth in (-1.0, 1.0)
    )
    way = far[:3] / far[3] - near[:3] / near[3]
    eye: Array = np.asarray(np.linalg.inv(view)[:3, 3], dtype=np.float64)
    direction: Array = np.asarray(way / norm(way), dtype=np.float64)
    return eye, direction


def screen_is_there() -> bool:
    """Whether an X server answers; pybullet ends the whole process where none does."""
    if not os.environ.get("DISPLAY"):
        return False
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        return False
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    display = x11.XOpenDisplay(None)
    if not display:
        return False
    x11.XCloseDisplay(display)
    return True


def _by_color(triangles: Array, colors: NDArray[np.uint8]) -> Iterator[tuple[Array, NDArray[np.uint8]]]:
    if colors.ndim == 1:
        yield triangles, colors
        return
    kinds, which = np.unique(colors, axis=0, return_inverse=True)
    for number, color in enumerate(kinds):
        yield triangles[which.reshape(-1) == number], color

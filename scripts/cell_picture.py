"""Draw the cell of a run at a moment: `python scripts/cell_picture.py out/demo docs/demo.png --at 3.5`.

Everything that the log draws is seen: robot or machine, tools, fixtures, parts, stock as it is then, films, paths. The
camera stands so that all of it, or what lies within `--span` of `--target`, fills the picture.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from math import cos, radians, sin, tan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gcodesim.playback.recording import Recording
from gcodesim.playback.scenes import Drawing
from gcodesim.playback.skins import skin_of
from gcodesim.sensors.optics import Optics
from gcodesim.sensors.png import png_of
from gcodesim.sensors.scenery import Scenery
from gcodesim.session.sensor_in_hand import looking

Array = NDArray[np.float64]

FINER = 2  # the picture is drawn so much larger and then averaged, which smooths the edges
TRAIL = np.array([40.0, 90.0, 200.0])
MARGIN = 0.88  # of the picture's width that is used
VIEW = 0.6  # [rad] from the left border to the right one
TOPICS = ("/scene/cell", "/scene/tool", "/scene/drawn")


def drawings_at(recording: Recording, t_ns: int, *, paths: bool) -> list[Drawing]:
    """What the log shows at a time."""
    topics = [*TOPICS, *(["/scene/path"] if paths else [])]
    topics += [f"/{name}{topic}" for name in recording.channels for topic in topics]
    found: list[Drawing] = []
    for topic in topics:
        past = [content for time, content in recording.drawings(topic) if time <= t_ns]
        found += past[-1] if past else ()
    return [*found, *recording.stock_at(t_ns)]


def parts_of(recording: Recording, t_ns: int, *, paths: bool) -> Iterator[tuple[str, Array, Array]]:
    """Shapes in the world: `triangles`, `clear` triangles or `lines` (n, 3 or 2, 3), and their colour from 0 to 255."""
    frames = recording.frames()
    for drawing in drawings_at(recording, t_ns, paths=paths):
        X = frames.at(drawing.frame, t_ns)
        for shape in drawing.shapes:
            skin = skin_of(shape)
            if len(skin.triangles):
                kind = "triangles" if skin.color[3] == 1.0 else "clear"
                yield kind, _moved(skin.points, X)[skin.triangles], 255.0 * np.array(skin.color[:3])
        for lines in drawing.lines:
            if len(lines.segments):
                yield "lines", _moved(lines.points, X)[lines.segments], 255.0 * np.array(lines.color[:3])


def trail_of(recording: Recording, t_ns: int) -> tuple[Array, Array]:
    """The way of the tip until a time: lines (n, 2, 3) in the world, and their colour."""
    tip = recording.series("/tcp")
    points = np.stack([tip.column(f"pose.position.{axis}") for axis in "xyz"], axis=1)[tip.t_ns <= t_ns]
    return np.stack([points[:-1], points[1:]], axis=1), TRAIL


def _moved(points: Array, X: Array) -> Array:
    moved: Array = points @ X[:3, :3].T + X[:3, 3]
    return moved


def _eye(cloud: Array, back: Array, ratio: float) -> tuple[Array, Array]:
    """Where the camera stands, and a point before it, so that all points (n, 3) [m] are in a picture of this ratio."""
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    x, y, z = cloud @ right, cloud @ up, cloud @ back
    half = MARGIN * tan(0.5 * VIEW)
    middle = np.array([0.5 * (x.max() + x.min()), 0.5 * (y.max() + y.min())])
    away = max(np.ptp(x), np.ptp(y) * ratio) / (2.0 * half)
    for _ in range(60):  # what is nearer looks larger, so neither is known at once
        depth = z.max() + away - z
        seen = np.stack([x - middle[0], y - middle[1]]) / depth
        middle += 0.5 * (seen.max(axis=1) + seen.min(axis=1)) * depth.mean()
        away *= (0.5 * max(np.ptp(seen[0]), np.ptp(seen[1]) * ratio) / half) ** 0.7
    eye = middle[0] * right + middle[1] * up + (z.max() + away) * back
    return eye, eye - back


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, help="folder of the run")
    parser.add_argument("png", type=Path)
    parser.add_argument("--at", type=float, help="time [s] (default: the end)")
    parser.add_argument("--turn", type=float, default=-35.0, help="where the camera stands about Z, from -Y [deg]")
    parser.add_argument("--tilt", type=float, default=28.0, help="how far it looks down [deg]")
    parser.add_argument("--target", type=float, nargs=3, help="the middle of the picture in the world [m]")
    parser.add_argument("--span", type=float, help="what fits across the picture [m]")
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--height", type=int, default=480)
    parser.add_argument("--paths", action="store_true", help="draw the paths too")
    parser.add_argument("--trail", action="store_true", help="draw the way of the tip")
    said = parser.parse_args()
    recording = Recording.open(said.out)
    t_ns = recording.end_ns if said.at is None else round(said.at * 1e9)
    if t_ns > recording.end_ns:
        parser.error(f"the run ends at {recording.end_ns * 1e-9:.3f} s")
    shapes = list(parts_of(recording, t_ns, paths=said.paths))
    solid = [(points, color.astype(np.uint8)) for kind, points, color in shapes if kind == "triangles"]
    clear = [(points, color.astype(np.uint8)) for kind, points, color in shapes if kind == "clear"]
    lines = [(points, color.astype(np.uint8)) for kind, points, color in shapes if kind == "lines"]
    if said.trail:
        points, color = trail_of(recording, t_ns)
        lines.append((points, color.astype(np.uint8)))
    cloud = np.concatenate([points.reshape(-1, 3) for points, _ in solid])
    turn, tilt = radians(said.turn), radians(said.tilt)
    back = np.array([sin(turn) * cos(tilt), -cos(turn) * cos(tilt), sin(tilt)])
    eye, target = _eye(cloud, back, said.width / said.height)
    if said.target is not None:
        target = np.array(said.target)
        eye = target + np.linalg.norm(eye - target) * back
    if said.span is not None:
        eye = target + 0.5 * said.span / tan(0.5 * VIEW) * back
    optics = Optics.of_view(FINER * said.width, FINER * said.height, VIEW)
    camera = looking(eye, target, (0.0, 0.0, 1.0))
    sharp = optics.exposure(camera, Scenery.of(solid, lines)).picture().astype(float)
    if clear:  # what one sees through, half
        sharp = 0.5 * (sharp + optics.exposure(camera, Scenery.of([*solid, *clear], lines)).picture())
    coarse = sharp.reshape(said.height, FINER, said.width, FINER, 3).mean(axis=(1, 3))
    said.png.write_bytes(png_of(np.rint(coarse).astype(np.uint8)))


if __name__ == "__main__":
    main()

"""A made-up run for tests of the log: a six-joint arm that moves, a part in tiles, tool changes, findings."""

from __future__ import annotations

import hashlib
import sys
from pathlib import Path

import numpy as np

from gcodesim.log import (
    DrawnMesh,
    DrawnSolid,
    Entity,
    LogDescription,
    LogWriter,
    MotionColumns,
    Polylines,
    ProcessColumns,
    StaticFrame,
)
from gcodesim.solids import Box, Cone, Cylinder, Sphere

MS = 1_000_000
ROD = DrawnSolid(solid=Cylinder.about_origin(0.05, 0.2))
PLATE = DrawnSolid(solid=Box.about_origin((1.0, 1.0, 0.05)))
SHANK = Cylinder.about_origin(3e-3, 0.05)
POINT = Cone(bottom_radius=0.0, top_radius=3e-3, bottom=-1e-3, top=1e-3)
PROGRAM = b"G21 G90\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F200\nG1 X30\nM2\n"
CELL = b"robot: arm\n"
LINKS = [f"arm/link_{i}" for i in range(1, 7)]
UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
MOVING = (*zip(["arm/base", *LINKS[:-1]], LINKS, strict=True), (LINKS[-1], "arm/flange"), ("arm/flange", "tool"))
MOVING += (("tool", "tcp"), ("world", "part"))


def description(**changes):
    return LogDescription(
        **{
            "run": {
                "program": "part.nc",
                "program_sha256": hashlib.sha256(PROGRAM).hexdigest(),
                "cell": "cell.yaml",
                "cell_sha256": hashlib.sha256(CELL).hexdigest(),
                "seed": "0",
                "step_ns": "1000000",
                "log_period_ns": str(20 * MS),
                "numpy": np.__version__,
            },
            "static_frames": (
                StaticFrame(parent="world", child="arm/base", p=np.zeros(3), q=UPRIGHT),
                StaticFrame(parent="world", child="stock", p=np.array([0.5, 0.0, 0.1]), q=UPRIGHT),
            ),
            "moving_frames": MOVING,
            "joint_names": tuple(f"arm/joint_{i}" for i in range(1, 7)),
            "cell": (
                *(Entity(id=link, frame=link, shapes=(ROD,)) for link in LINKS),
                Entity(id="table", frame="world", shapes=(PLATE, DrawnSolid(solid=Sphere(radius=0.02)))),
            ),
            "feed_path": Polylines(np.array([[0.5, 0, 0.1], [0.5, 0, 0.09], [0.53, 0, 0.09]]), np.array([0])),
            "rapid_path": Polylines(np.array([[0.4, 0, 0.2], [0.5, 0, 0.1]]), np.array([0])),
            "process_kinds": ("", "milling", "extrusion"),
            "stock_tiles": 4,
            "added_tiles": 2,
            "attachments": {"program.nc": PROGRAM, "cell.yaml": CELL, "arm.urdf": b"<robot name='arm'/>"},
            **changes,
        }
    )


def columns(t_ns, joints=6, kind=1):
    """Keyword arguments of `window` for the instants `t_ns` (n,)."""
    frames = len(MOVING)
    t = np.asarray(t_ns) * 1e-9
    n = len(t)
    angle = 0.3 * np.sin(t[:, None] + np.arange(frames))
    tf = np.zeros((n, frames, 7))
    tf[:, :, 2] = 0.1
    tf[:, :, 3] = np.sin(angle / 2)
    tf[:, :, 6] = -np.cos(angle / 2)
    q = np.cos(t[:, None] * np.arange(1, joints + 1))
    pose = np.stack([0.5 + 0.01 * t, 0 * t, 0 * t + 0.1, 0 * t + 1.0, 0 * t, 0 * t, 0 * t], axis=1)
    wrench = np.stack([100 * np.sin(t), 50 * np.cos(t), -20 + 0 * t, 0 * t, 0 * t, 0.5 * np.sin(t)], axis=1)
    return {
        "tf": tf,
        "joint_position": q,
        "joint_velocity": -np.sin(t[:, None] * np.arange(1, joints + 1)),
        "joint_effort": 10.0 * q,
        "joint_command": q + 1e-4,
        "target": pose,
        "tcp": pose + np.array([1e-5, 0, 0, 0, 0, 0, 0]),
        "wrench": wrench,
        "motion": MotionColumns(
            feed=0.01 + 0 * t,
            feed_command=0.01 + 0 * t,
            position_error=np.full(n, 1e-5),
            orientation_error=np.zeros(n),
            block_fraction=t % 1.0,
            position=pose[:, :3],
            limit=t > 1.0,
            travel_used=np.abs(np.sin(t)),
            speed_used=np.abs(np.cos(t)),
            effort_used=0.5 * np.abs(np.cos(t)),
        ),
        "process": ProcessColumns(
            kind=np.broadcast_to(kind, n),
            engaged=t > 0.5,
            spindle=np.full(n, 800.0),
            force=np.linalg.norm(wrench[:, :3], axis=1),
            torque=wrench[:, 5],
            power=800.0 * wrench[:, 5],
            removal=np.full(n, 1e-7),
            removed=1e-7 * t,
            max_force=2.0 * np.linalg.norm(wrench[:, :3], axis=1),
            max_torque=2.0 * np.abs(wrench[:, 5]),
            max_power=1600.0 * np.abs(wrench[:, 5]),
        ),
    }


def tile(x, depth, n=9):
    """A square of 20 mm as an original and a cut mesh."""
    u, v = np.meshgrid(np.linspace(0, 0.02, n), np.linspace(0, 0.02, n), indexing="ij")
    points = np.stack([x + u, v, -depth * np.sin(40 * u)], axis=-1).reshape(-1, 3)
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).reshape(-1)
    triangles = np.concatenate([np.stack([i, i + n, i + 1], 1), np.stack([i + 1, i + n, i + n + 1], 1)])
    half = len(triangles) // 2
    return [
        DrawnMesh(points=points, triangles=triangles[:half], color=(0.7, 0.7, 0.7, 1.0)),
        DrawnMesh(points=points, triangles=triangles[half:], color=(0.9, 0.8, 0.3, 1.0)),
    ]


def change_messages(log, until_ns):
    """All change messages of the made-up run up to its end, in no order."""
    lines = PROGRAM.decode().splitlines()
    for index in range(2):
        log.film(0, index, f"added/{index:02d}", tile(0.02 * index, 0.0), "stock")
    log.event(750 * MS, "GS602", "rapid through material", severity="error", file="part.nc", line=3, value=0.003)
    log.event(500 * MS, "toolchange", "T1 in the spindle", file="part.nc", line=2)
    log.tool(500 * MS, [DrawnSolid(solid=SHANK), DrawnSolid(solid=POINT)])
    for number, text in enumerate(lines, start=1):
        at = (number - 1) * 333 * MS
        if at > until_ns:
            break
        log.program(at, file="part.nc", line=number, text=text, motion="G1", wcs="G54", block=number - 1, feed=0.01)
        log.block_polyline(at, np.array([[0.5, 0, 0.1], [0.5 + 0.01 * number, 0, 0.1]]))
    for k, at in enumerate(range(0, until_ns + 1, 100 * MS)):
        log.forces(np.array([at]), np.array([[0.5, 0, 0.1]]), np.array([[10.0 * k, -5.0 * k, 1.0 * k]]))
        if k % 5 == 0:
            log.stock_tile(at, (k // 5) % 4, tile(0.02 * (k // 5 % 4), 1e-4 * k))


def write(path: Path, seconds=2.0, period_ns=20 * MS, kinds=None, window=37, **changes):
    """A complete log."""
    end_ns = round(seconds * 1e9)
    times = np.arange(0, end_ns + 1, period_ns)
    log = LogWriter(path, description(**changes))
    change_messages(log, end_ns)
    for first in range(0, len(times), window):
        t = times[first : first + window]
        log.window(t, **columns(t, kind=1 if kinds is None else kinds[first : first + len(t)]))
    log.close(end_ns, "finished", {"blocks": "6"}, {"results.json": b"{}"})
    return path


if __name__ == "__main__":
    write(Path(sys.argv[1]))

"""Speed of the log: columns against `mcap` with new message objects, in the same run.

    python -m benchmarks.log [INSTANTS]

Prints instants a second for the seven periodic topics of a six-joint arm (ten
moving frames), the ratio, and the cost of a program block and of a part tile.
Then a run at 1 kHz that logs every step: what the log takes of it, from the
joints to the packed chunk, in steps a second. Processor time throughout.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, Writer

from benchmarks import job
from gcodesim.log import (
    BlockColumns,
    BlockMessages,
    ByteStrings,
    DrawnMesh,
    LogDescription,
    LogWriter,
    MotionColumns,
    ProcessColumns,
    ProgramShown,
)
from gcodesim.log.schema import message_class, schema_data
from gcodesim.log.topics import PERIODIC

LINKS = [f"arm/link_{i}" for i in range(1, 7)]
FRAMES = [("world", LINKS[0]), *pairwise(LINKS), (LINKS[-1], "arm/flange")]
FRAMES += [("arm/flange", "tool"), ("tool", "tcp"), ("world", "part")]
JOINTS = [f"arm/joint_{i}" for i in range(1, 7)]
PERIOD = 1_000_000
WINDOW = 1000


def description() -> LogDescription:
    return LogDescription(
        run={"program": "bench.nc"},
        static_frames=(),
        moving_frames=tuple(FRAMES),
        joint_names=tuple(JOINTS),
        process_kinds=("", "milling"),
    )


def columns(n: int) -> dict[str, Any]:
    """Smooth motion at n instants."""
    t = np.arange(n) * (PERIOD * 1e-9)
    tf = np.zeros((n, len(FRAMES), 7))
    angle = 0.3 * np.sin(t[:, None] + np.arange(len(FRAMES)))
    tf[:, :, 2], tf[:, :, 3], tf[:, :, 6] = 0.1, np.sin(angle / 2), np.cos(angle / 2)
    q = np.cos(t[:, None] * np.arange(1, 7))
    wrench = np.stack([np.sin(k * t) * 100 for k in range(1, 7)], axis=1)
    names = ("feed", "feed_command", "position_error", "orientation_error", "block_fraction")
    names += ("travel_used", "speed_used", "effort_used")
    motion = MotionColumns(**{name: np.sin(t) for name in names}, position=tf[:, 0, :3], limit=t < 0)
    names = ("spindle", "force", "torque", "power", "removal", "removed", "max_force", "max_torque", "max_power")
    process = ProcessColumns(kind=np.ones(n, dtype=int), engaged=t > 0, **{name: np.cos(t) for name in names})
    poses = {"target": tf[:, 0], "tcp": tf[:, 1]}
    joints = {"joint_position": q, "joint_velocity": -q, "joint_effort": 10 * q, "joint_command": q}
    return {"tf": tf, **poses, **joints, "motion": motion, "process": process, "wrench": wrench}


def part(given: dict[str, Any], rows: slice) -> dict[str, Any]:
    cut = {}
    for name, value in given.items():
        if isinstance(value, np.ndarray):
            cut[name] = value[rows]
        else:
            names = [name for name in value.__dataclass_fields__ if name != "fields"]
            cut[name] = type(value)(**{field: getattr(value, field)[rows] for field in names})
    return cut


def by_columns(path: Path, n: int) -> float:
    """Seconds for n instants with the writer of gcodesim."""
    given, times = columns(n), np.arange(n) * PERIOD
    windows = [(times[i : i + WINDOW], part(given, slice(i, i + WINDOW))) for i in range(0, n, WINDOW)]
    log = LogWriter(path, description())
    start = time.process_time()
    for t_ns, window in windows:
        log.window(t_ns, **window)
    log.close(int(times[-1]), "finished")
    return time.process_time() - start


def by_objects(path: Path, n: int, topics: tuple[str, ...]) -> float:
    """Seconds for n instants with a message object for each message and the writer of `mcap`."""
    given = {name: np.asarray(value).tolist() for name, value in columns(n).items() if isinstance(value, np.ndarray)}
    kinds = {topic.name: message_class(topic.schema) for topic in PERIODIC}

    def frames(message: Any, i: int, t_ns: int) -> None:
        for (parent, child), pose in zip(FRAMES, given["tf"][i], strict=True):
            one = message.transforms.add(parent_frame_id=parent, child_frame_id=child)
            one.timestamp.FromNanoseconds(t_ns)
            one.translation.x, one.translation.y, one.translation.z = pose[:3]
            one.rotation.x, one.rotation.y, one.rotation.z, one.rotation.w = pose[3:]

    def joints(message: Any, i: int, t_ns: int) -> None:
        message.timestamp.FromNanoseconds(t_ns)
        for k, name in enumerate(JOINTS):
            q, qd, effort = (given[f"joint_{what}"][i][k] for what in ("position", "velocity", "effort"))
            message.joints.add(name=name, position=q, velocity=qd, effort=effort)

    def pose(message: Any, i: int, t_ns: int) -> None:
        message.timestamp.FromNanoseconds(t_ns)
        message.frame_id = "world"
        p, q = message.pose.position, message.pose.orientation
        p.x, p.y, p.z, q.x, q.y, q.z, q.w = given["tcp"][i]

    def numbers(message: Any, i: int, t_ns: int) -> None:
        message.timestamp.FromNanoseconds(t_ns)
        for field in message.DESCRIPTOR.fields[2 if "kind" in message.DESCRIPTOR.fields_by_name else 1 :]:
            if field.name == "joints":
                for k, name in enumerate(JOINTS):
                    q, command = given["joint_position"][i][k], given["joint_command"][i][k]
                    message.joints.add(name=name, command=command, position_shown=q, command_shown=command)
            elif field.name not in ("limit", "engaged"):
                setattr(message, field.name, 1.5)

    def wrench(message: Any, i: int, t_ns: int) -> None:
        message.timestamp.FromNanoseconds(t_ns)
        message.frame_id = "world"
        f, m = message.force, message.torque
        f.x, f.y, f.z, m.x, m.y, m.z = given["wrench"][i]

    fill: dict[str, Callable[[Any, int, int], None]] = {
        "/tf": frames, "/joint_states": joints, "/target": pose, "/tcp": pose,
        "/motion": numbers, "/process": numbers, "/wrench": wrench,
    }  # fmt: skip
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD, enable_data_crcs=True)
        writer.start()
        schemas = {t.name: writer.register_schema(t.schema, "protobuf", schema_data(t.schema)) for t in PERIODIC}
        channels = {topic: writer.register_channel(topic, "protobuf", schemas[topic]) for topic in topics}
        start = time.process_time()
        for i in range(n):
            for topic in topics:
                message = kinds[topic]()
                fill[topic](message, i, i * PERIOD)
                data = message.SerializeToString(deterministic=True)
                writer.add_message(channels[topic], i * PERIOD, data, i * PERIOD, i)
        writer.finish()
        return time.process_time() - start


def blocks(path: Path, m: int) -> float:
    """Seconds for m program blocks of one segment."""
    points = np.random.default_rng(0).random((m + 1, 3))
    rows = np.arange(m)
    log = LogWriter(path, description())
    texts = [f"X{i * 0.013:.3f} Y{i * 0.007:.3f}" for i in range(m)]
    start = time.process_time()
    log.blocks(
        BlockMessages(
            BlockColumns(
                t_ns=rows * PERIOD,
                line=rows + 1,
                block=rows,
                text=ByteStrings.of(text.encode() for text in texts),
                modal=np.zeros(m, dtype=int),
                modals=[ProgramShown(file="bench.nc", motion="G1", wcs="G54")],
                points=points[np.stack([rows, rows + 1], axis=1).reshape(-1)],
                point_starts=2 * np.arange(m + 1),
            )
        )
    )
    log.close(m * PERIOD, "finished")
    return time.process_time() - start


def tiles(path: Path, count: int, side: int = 100) -> tuple[float, int]:
    """Seconds and bytes for `count` tiles of side x side points."""
    u, v = np.meshgrid(np.linspace(0, 0.1, side), np.linspace(0, 0.1, side), indexing="ij")
    points = np.stack([u, v, 0.001 * np.sin(90 * u) * np.cos(70 * v)], axis=-1).reshape(-1, 3)
    i = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).reshape(-1)
    triangles = np.concatenate([np.stack([i, i + side, i + 1], 1), np.stack([i + 1, i + side, i + side + 1], 1)])
    mesh = DrawnMesh(points=points, triangles=triangles)
    d = description()
    frames = (*d.moving_frames, ("world", "stock"))
    log = LogWriter(path, LogDescription(run=d.run, static_frames=(), moving_frames=frames, joint_names=d.joint_names))
    start = time.process_time()
    for k in range(count):
        log.stock_tile(k * PERIOD, 0, [mesh])
    log.close(count * PERIOD, "finished")
    return time.process_time() - start, count * (len(points) * 29 + len(triangles) * 12)


def of_a_run(folder: Path, count: int) -> tuple[float, float]:
    """Seconds a step that the log takes in a run of `count` blocks on the arm at 1 kHz, and its bytes a step."""
    program, cell = job.write(folder, "kr10", count)
    fast = job.CELLS["kr10"].replace("rate: 250 Hz", "rate: 1 kHz").replace("period: 20 ms", "period: 1 ms")
    cell.write_text(fast)
    out, times = folder / "out", folder / "stages.json"
    order = ["run", str(program), "--cell", str(cell), "--world", "kinematic", "--out", str(out)]
    subprocess.run([sys.executable, "-m", "gcodesim", *order], check=False, capture_output=True)  # warms the kernels
    subprocess.run([sys.executable, "-m", "benchmarks.stages", str(times), *order], check=False, capture_output=True)
    stages = json.loads(times.read_text())
    steps = json.loads((out / "results.json").read_text())["time"]["total_s"] * 1000.0
    columns = stages["log: columns"] + stages["log: packing"]
    return columns / steps, (out / "run.mcap").stat().st_size / steps


def main(n: int = 100_000) -> None:
    all_topics = tuple(topic.name for topic in PERIODIC)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bench.mcap"
        by_columns(path, 5000)
        ours = n / by_columns(path, n)
        size = path.stat().st_size / n
        objects = 3000 / by_objects(path, 3000, all_topics)
        three = 3000 / by_objects(path, 3000, ("/tf", "/joint_states", "/wrench"))
        print(f"columns, 7 topics        {ours:10.0f} instants/s  {7 * ours:10.0f} messages/s  {size:.0f} bytes each")
        print(f"mcap + objects, 7 topics {objects:10.0f} instants/s  ratio {ours / objects:.1f}")
        print(f"mcap + objects, 3 topics {three:10.0f} instants/s  ratio {ours / three:.1f} (ours with all 7), goal 5")
        print(f"a program block          {blocks(path, 20_000) / 20_000 * 1e6:10.1f} us (3 messages)")
        seconds, size = of_a_run(Path(folder), max(n // 100, 20))
        run = 1.0 / seconds
        print(f"a whole run at 1 kHz     {run:10.0f} steps/s     ratio {run / three:.1f}, {size:.0f} bytes each")
        seconds, count = tiles(path, 200)
        print(f"part tiles               {count / seconds / 1e6:10.0f} MB/s")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))

"""A log as a ROS 2 bag: motion, poses, wrench and program lines in the messages that ROS tools know."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar, Final, Literal

import numpy as np

from gcodesim.export.exporter import RANGE, Exporter, NoExportError, Option, Request
from gcodesim.export.joint_trajectory import KIND, TOPIC, JointTrajectory
from gcodesim.export.select import TimeRange
from gcodesim.export.table import NoTableError
from gcodesim.extras import require_extra
from gcodesim.log.shop_units import without_twins
from gcodesim.playback.recording import Recording
from gcodesim.units import NS_PER_SECOND

TOPICS: Final = (
    *("/tf_static", "/tf", "/joint_states", "/joint_trajectory"),
    *("/target", "/tcp", "/motion", "/process", "/wrench", "/log"),
)
_LEVELS: Final = {"note": 20, "warning": 30, "error": 40}  # rcl_interfaces/msg/Log
_NO_FRAME = "world"

BagMessage = tuple[int, str, str, Any]  # time [ns], topic, type, content


def write_bag(recording: Recording, folder: Path, topics: Sequence[str] = (), part: TimeRange | None = None) -> int:
    """Write a bag (version 9, MCAP storage, CDR) into the new `folder`; returns how many messages.

    `/motion` and `/process` become one `std_msgs/Float64` topic a number, and
    `/log` has the block texts and findings. URDFs of the run are on
    `robot_description`, kept for late readers like `/tf_static`. FileExistsError
    if the folder exists; ExtraMissingError without `rosbags`; NoTableError for a
    topic that has no ROS message.
    """
    require_extra("ros", "a ROS 2 bag")
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    for topic in topics:
        if topic not in TOPICS:
            raise NoTableError(f"{topic} has no message of ROS; there are {', '.join(TOPICS)}")
    if folder.exists():
        raise FileExistsError(f"{folder} is there already; a bag is a new folder")
    store = get_typestore(Stores.ROS2_HUMBLE)
    latched = Qos(
        history=QosHistory.KEEP_LAST,
        depth=1,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL,
        deadline=(forever := QosTime(0, 0)),
        lifespan=forever,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=forever,
        avoid_ros_namespace_conventions=False,
    )
    messages = list(_messages(recording, store.types, tuple(topics) or TOPICS, part or TimeRange()))
    order = sorted(range(len(messages)), key=lambda i: (messages[i][0], i))
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections: dict[str, Any] = {}
        for i in order:
            t_ns, topic, kind, content = messages[i]
            if topic not in connections:
                kept = topic == "/tf_static" or topic.endswith("robot_description")
                connections[topic] = writer.add_connection(
                    topic, kind, typestore=store, offered_qos_profiles=[latched] if kept else []
                )
            writer.write(connections[topic], t_ns, store.serialize_cdr(content, kind))
    return len(messages)


class RosBag(Exporter):
    """`--to rosbag2`."""

    kind: ClassVar[str] = "rosbag2"
    says: ClassVar[str] = "a folder that ROS 2 tools read: /tf, /joint_states, /wrench, /robot_description …"
    suffix: ClassVar[str] = "_bag"
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "folder"
    takes: ClassVar[frozenset[Option]] = RANGE
    extra: ClassVar[str] = "ros"

    def write(self, recording: Recording, out: Path, request: Request) -> str:
        try:
            return f"{write_bag(recording, out, request.topics, request.part)} messages"
        except FileExistsError as error:
            raise NoExportError(str(error)) from None


def _messages(recording: Recording, types: Any, topics: Sequence[str], part: TimeRange) -> Iterator[BagMessage]:
    """All messages, topic by topic in the order of `TOPICS`."""
    ros = _Types(types)
    for name in recording.log.attachments:
        if name.endswith(".urdf") and "/tf_static" in topics:
            urdfs = [other for other in recording.log.attachments if other.endswith(".urdf")]
            topic = "/robot_description" if len(urdfs) == 1 else f"/{name[: -len('.urdf')]}/robot_description"
            model = recording.log.attached(name)
            if model is not None:
                text = model.decode("utf-8", "replace")
                yield part.first_ns, topic, "std_msgs/msg/String", types["std_msgs/msg/String"](data=text)
    writers: dict[str, Callable[[Recording, _Types, TimeRange], Iterator[BagMessage]]] = {
        "/tf_static": _static,
        "/tf": _moving,
        "/joint_states": _joints,
        "/joint_trajectory": _trajectory,
        "/target": _pose("/target"),
        "/tcp": _pose("/tcp"),
        "/motion": _motion,
        "/process": _numbers("/process"),
        "/wrench": _wrench,
        "/log": _log,
    }
    for topic in TOPICS:
        if topic in topics:
            yield from writers[topic](recording, ros, part)


class _Types:
    """The message types that are needed, made from numbers."""

    def __init__(self, types: Any) -> None:
        self.types = types

    def stamp(self, t_ns: int) -> Any:
        return self.types["builtin_interfaces/msg/Time"](sec=t_ns // NS_PER_SECOND, nanosec=t_ns % NS_PER_SECOND)

    def header(self, t_ns: int, frame: str) -> Any:
        return self.types["std_msgs/msg/Header"](stamp=self.stamp(t_ns), frame_id=frame)

    def vector(self, row: Sequence[float]) -> Any:
        return self.types["geometry_msgs/msg/Vector3"](x=float(row[0]), y=float(row[1]), z=float(row[2]))

    def quaternion(self, row: Sequence[float]) -> Any:
        x, y, z, w = (float(value) for value in row)
        return self.types["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w)

    def transform(self, t_ns: int, parent: str, child: str, row: Sequence[float]) -> Any:
        transform = self.types["geometry_msgs/msg/Transform"](
            translation=self.vector(row[:3]), rotation=self.quaternion(row[3:])
        )
        header = self.header(t_ns, parent)
        return self.types["geometry_msgs/msg/TransformStamped"](
            header=header, child_frame_id=child, transform=transform
        )


def _static(recording: Recording, ros: _Types, part: TimeRange) -> Iterator[BagMessage]:
    from gcodesim.frames import quaternion_from_rotation

    tree = recording.frames()
    still = [name for name, poses in tree.poses.items() if len(poses) == 1 and name not in _moving_frames(recording)]
    transforms = []
    for child in still:
        X = tree.poses[child][0]
        row = [*X[:3, 3], *quaternion_from_rotation(X[:3, :3])]
        transforms.append(ros.transform(part.first_ns, tree.parents[child], child, row))
    kind = "tf2_msgs/msg/TFMessage"
    yield part.first_ns, "/tf_static", kind, ros.types[kind](transforms=transforms)


def _moving_frames(recording: Recording) -> dict[str, str]:
    """Parent by child of the frames on `/tf`."""
    series = recording.series("/tf")
    return {
        texts[0]: series.texts[name.replace("child_frame_id", "parent_frame_id")][0]
        for name, texts in series.texts.items()
        if name.endswith(".child_frame_id")
    }


def _moving(recording: Recording, ros: _Types, part: TimeRange) -> Iterator[BagMessage]:
    series, frames = recording.series("/tf"), _moving_frames(recording)
    fields = [f"translation.{a}" for a in "xyz"] + [f"rotation.{a}" for a in "xyzw"]
    columns = [series.columns(*(f"transforms[{child}].{field}" for field in fields)) for child in frames]
    kind = "tf2_msgs/msg/TFMessage"
    for i in part.chosen(series.t_ns):
        t_ns = int(series.t_ns[i])
        transforms = [
            ros.transform(t_ns, parent, child, rows[i])
            for (child, parent), rows in zip(frames.items(), columns, strict=True)
        ]
        yield t_ns, "/tf", kind, ros.types[kind](transforms=transforms)


def _joints(recording: Recording, ros: _Types, part: TimeRange) -> Iterator[BagMessage]:
    series = recording.series("/joint_states")
    names = [name for key, (name, *_) in series.texts.items() if key.endswith("].name")]
    position, velocity, effort = (
        series.columns(*(f"joints[{name}].{what}" for name in names)) for what in ("position", "velocity", "effort")
    )
    kind = "sensor_msgs/msg/JointState"
    for i in part.chosen(series.t_ns):
        t_ns = int(series.t_ns[i])
        content = ros.types[kind](
            header=ros.header(t_ns, ""), name=names, position=position[i], velocity=velocity[i], effort=effort[i]
        )
        yield t_ns, "/joint_states", kind, content


def _trajectory(recording: Recording, ros: _Types, part: TimeRange) -> Iterator[BagMessage]:
    """All commanded joints in one message, as controllers of ros2_control take them."""
    told = JointTrajectory.of(recording, part)
    if not len(told.t_ns):
        return
    point, duration = "trajectory_msgs/msg/JointTrajectoryPoint", "builtin_interfaces/msg/Duration"
    none = np.zeros(0)
    points = [
        ros.types[point](
            positions=q,
            velocities=v,
            accelerations=none,
            effort=none,
            time_from_start=ros.types[duration](sec=int(t) // NS_PER_SECOND, nanosec=int(t) % NS_PER_SECOND),
        )
        for t, q, v in zip(told.t_ns, told.position, told.velocity, strict=True)
    ]
    content = ros.types[KIND](header=ros.header(part.first_ns, ""), joint_names=list(told.names), points=points)
    yield part.first_ns, TOPIC, KIND, content


def read_states(folder: Path, topic: str) -> list[dict[str, Any]]:
    """The messages sensor_msgs/JointState of a topic of a bag, as rosbridge would send them.

    OSError, or ValueError where the folder is no bag; ExtraMissingError without `rosbags`.
    """
    require_extra("ros", "a ROS 2 bag")
    from rosbags.highlevel import AnyReader, AnyReaderError
    from rosbags.typesys import Stores, get_typestore

    found: list[dict[str, Any]] = []
    try:
        with AnyReader([folder], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            wanted = [one for one in reader.connections if one.topic == topic and one.msgtype.endswith("/JointState")]
            for connection, _, raw in reader.messages(wanted) if wanted else ():
                message: Any = reader.deserialize(raw, connection.msgtype)
                stamp = {"sec": message.header.stamp.sec, "nanosec": message.header.stamp.nanosec}
                told = {"name": list(message.name), "position": [float(v) for v in message.position]}
                found.append({"header": {"stamp": stamp}, **told})
    except AnyReaderError as error:
        raise ValueError(str(error)) from None
    return found


def _motion(recording: Recording, ros: _Types, part: TimeRange) -> Iterator[BagMessage]:
    """Its numbers, and the commanded joints as ROS has them."""
    yield from _numbers("/motion")(recording, ros, part)
    series, kind = recording.series("/motion"), "sensor_msgs/msg/JointState"
    names = [name for key, (name, *_) in series.texts.items() if key.endswith("].name")]
    position = series.columns(*(f"joints[{name}].command" for name in names)) if names else np.zeros((0, 0))
    none = np.zeros(0)
    for i in part.chosen(series.t_ns) if names else ():
        t_ns = int(series.t_ns[i])
        content = ros.types[kind](
            header=ros.header(t_ns, ""), name=names, position=position[i], velocity=none, effort=none
        )
        yield t_ns, "/joint_commands", kind, content


def _pose(topic: str) -> Callable[[Recording, _Types, TimeRange], Iterator[BagMessage]]:
    def messages(recording: Recording, ros: _Types, part: TimeRange) -> Iterator[BagMessage]:
        series = recording.series(topic)
        position = series.columns(*(f"pose.position.{a}" for a in "xyz"))
        orientation = series.columns(*(f"pose.orientation.{a}" for a in "xyzw"))
        frame, kind = _frame(series), "geometry_msgs/msg/PoseStamped"
        point = ros.types["geometry_msgs/msg/Point"]
        for i in part.chosen(series.t_ns):
            t_ns = int(series.t_ns[i])
            x, y, z = (float(value) for value in position[i])
            pose = ros.types["geometry_msgs/msg/Pose"](
                position=point(x=x, y=y, z=z), orientation=ros.quaternion(orientation[i])
            )
            yield t_ns, topic, kind, ros.types[kind](header=ros.header(t_ns, frame), pose=pose)

    return messages


def _wrench(recording: Recording, ros: _Types, part: TimeRange) -> Iterator[BagMessage]:
    series = recording.series("/wrench")
    force = series.columns(*(f"force.{a}" for a in "xyz"))
    torque = series.columns(*(f"torque.{a}" for a in "xyz"))
    frame, kind = _frame(series), "geometry_msgs/msg/WrenchStamped"
    for i in part.chosen(series.t_ns):
        t_ns = int(series.t_ns[i])
        wrench = ros.types["geometry_msgs/msg/Wrench"](force=ros.vector(force[i]), torque=ros.vector(torque[i]))
        yield t_ns, "/wrench", kind, ros.types[kind](header=ros.header(t_ns, frame), wrench=wrench)


def _numbers(topic: str) -> Callable[[Recording, _Types, TimeRange], Iterator[BagMessage]]:
    def messages(recording: Recording, ros: _Types, part: TimeRange) -> Iterator[BagMessage]:
        series, kind = recording.series(topic), "std_msgs/msg/Float64"
        chosen = part.chosen(series.t_ns)
        for name in without_twins(series.names):
            if "[" in name:  # of joints, which have messages of their own
                continue
            column = series.column(name)
            for i in chosen:
                yield int(series.t_ns[i]), f"{topic}/{name}", kind, ros.types[kind](data=float(column[i]))

    return messages


def _log(recording: Recording, ros: _Types, part: TimeRange) -> Iterator[BagMessage]:
    kind = "rcl_interfaces/msg/Log"
    timeline = recording.timeline
    texts = [
        (int(t_ns), 20, timeline.modals[modal].file, int(line), text)
        for t_ns, line, text, modal in zip(timeline.t_ns, timeline.line, timeline.text, timeline.modal, strict=True)
        if line
    ]
    texts += [(e.t_ns, _LEVELS.get(e.severity, 20), e.file, e.line, f"{e.code} {e.message}") for e in recording.events]
    inside = np.zeros(0, dtype=np.int64)
    times = np.array([text[0] for text in texts], dtype=np.int64)
    order = np.argsort(times, kind="stable")
    inside = (
        order[TimeRange(first_ns=part.first_ns, last_ns=part.last_ns).chosen(times[order])] if len(order) else order
    )
    for i in inside:
        t_ns, level, file, line, text = texts[i]
        content = ros.types[kind](
            stamp=ros.stamp(t_ns), level=level, name="gcodesim", msg=text, file=file, function="", line=line
        )
        yield t_ns, "/log", kind, content


def _frame(series: Any) -> str:
    return next(iter(series.texts.get("frame_id", ())), _NO_FRAME)

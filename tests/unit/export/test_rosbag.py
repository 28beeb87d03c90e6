"""A log as a ROS 2 bag, read back by its own library."""

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from gcodesim.export.rosbag import write_bag
from gcodesim.export.select import TimeRange
from gcodesim.export.table import NoTableError
from tests.log_columns import read_columns

TENTH = TimeRange(period_ns=100_000_000)


@pytest.fixture(scope="module")
def bag(slot_folder, tmp_path_factory):
    from gcodesim.playback import Recording

    folder = tmp_path_factory.mktemp("bags") / "bag"
    write_bag(Recording.open(slot_folder), folder, (), TENTH)
    return folder


def read(bag, topic):
    with AnyReader([bag]) as reader:
        connections = [c for c in reader.connections if c.topic == topic]
        return [(t, reader.deserialize(raw, c.msgtype)) for c, t, raw in reader.messages(connections)]


def test_joints_are_those_of_the_log(bag, slot):
    messages = read(bag, "/joint_states")
    truth = read_columns(slot.log.path, "/joint_states", ["joints.position", "joints.name"])
    rows = np.searchsorted(truth["t_ns"], [t for t, _ in messages])

    assert messages[0][1].name == list(truth["joints.name"][0])
    assert np.array_equal([m.position for _, m in messages], truth["joints.position"][rows])
    assert messages[10][1].header.stamp.sec * 10**9 + messages[10][1].header.stamp.nanosec == messages[10][0]


def test_commanded_joints_are_messages_of_their_own(bag, slot):
    messages = read(bag, "/joint_commands")
    truth = read_columns(slot.log.path, "/motion", ["joints.command", "joints.name"])
    rows = np.searchsorted(truth["t_ns"], [t for t, _ in messages])

    assert messages[0][1].name == list(truth["joints.name"][0])
    assert np.array_equal([m.position for _, m in messages], truth["joints.command"][rows])
    with AnyReader([bag]) as reader:
        assert not [c.topic for c in reader.connections if "[" in c.topic or c.topic.endswith("_mm_min")]


def test_wrench_and_frames_come_along(bag, slot):
    force = read_columns(slot.log.path, "/wrench", ["force.x"])
    wrench = read(bag, "/wrench")
    rows = np.searchsorted(force["t_ns"], [t for t, _ in wrench])
    _, first = read(bag, "/tf")[0]
    _, static = read(bag, "/tf_static")[0]

    assert np.array_equal([m.wrench.force.x for _, m in wrench], force["force.x"][rows])
    frames = {t.child_frame_id: t.header.frame_id for m in (first, static) for t in m.transforms}
    assert frames["tool"] == "machine/flange" and frames["stock"] == "world"


def test_the_robot_describes_itself_and_lines_are_logged(bag):
    (urdf,) = read(bag, "/robot_description")
    log = read(bag, "/log")

    assert "<robot" in urdf[1].data
    assert ("slot.nc", 9, "G1 X30") in [(m.file, m.line, m.msg) for _, m in log]


def test_the_same_log_gives_the_same_bag(bag, slot, tmp_path):
    write_bag(slot, tmp_path / "bag", (), TENTH)

    for file in sorted(bag.iterdir()):
        assert (tmp_path / "bag" / file.name).read_bytes() == file.read_bytes(), file.name


def test_a_bag_is_a_new_folder_and_takes_known_topics(bag, slot, tmp_path):
    with pytest.raises(FileExistsError):
        write_bag(slot, bag)
    with pytest.raises(NoTableError, match="/scene/cell"):
        write_bag(slot, tmp_path / "other", ["/scene/cell"])

"""Trajectories for ROS 2: in bags, over rosbridge to an arm that follows, and its joint states compared."""

from __future__ import annotations

import base64
import hashlib
import json
import os
import socket
import struct
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from gcodesim.cli import main
from gcodesim.export.joint_trajectory import JointTrajectory, StateRecord, deviations, read_state_table
from gcodesim.export.rosbag import write_bag
from gcodesim.export.select import TimeRange
from gcodesim.playback import Recording
from tests.log_columns import read_columns

TENTH = TimeRange(period_ns=100_000_000)


def test_a_bag_has_the_trajectory(slot, tmp_path):
    write_bag(slot, tmp_path / "bag", ("/joint_trajectory",), TENTH)
    with AnyReader([tmp_path / "bag"]) as reader:
        ((connection, _, raw),) = reader.messages()
        message = reader.deserialize(raw, connection.msgtype)

    truth = read_columns(slot.log.path, "/motion", ["joints.command", "joints.name"])
    times = [p.time_from_start.sec * 10**9 + p.time_from_start.nanosec for p in message.points]
    rows = np.searchsorted(truth["t_ns"], times)
    assert connection.msgtype == "trajectory_msgs/msg/JointTrajectory"
    assert message.joint_names == [name.rpartition("/")[2] for name in truth["joints.name"][0]]
    assert np.array_equal([p.positions for p in message.points], truth["joints.command"][rows])
    assert times == sorted(set(times)) and times[0] == 0
    velocity = np.array([p.velocities for p in message.points])
    slope = np.gradient(np.array([p.positions for p in message.points]), np.array(times) * 1e-9, axis=0)
    np.testing.assert_allclose(velocity[5:-5], slope[5:-5], atol=0.02)
    assert not velocity[0].any() and not velocity[-1].any()


def record(told: JointTrajectory, *, later: float, off: float = 0.0, order: int = 1) -> StateRecord:
    """What an arm says that follows `later` by its own clock, its last joint off by so much at one moment."""
    t = np.arange(0.0, told.t_ns[-1] * 1e-9 + 1.0, 0.013)
    position = told.at(t)
    position[len(t) // 2, -1] += off
    return StateRecord(told.names[::order], t + 1e6 + later, position[:, ::order])


@pytest.mark.parametrize("later", [0.0, 0.37, 3.0])
@pytest.mark.parametrize("order", [1, -1])
def test_deviations_do_not_depend_on_clocks_or_order(slot, later, order):
    told = JointTrajectory.of(slot, TENTH)
    shift, found = deviations(told, record(told, later=later, off=0.004, order=order))

    assert shift == pytest.approx(1e6 + later, abs=2e-3)
    assert [joint.name for joint in found] == list(told.names)
    assert found[-1].most == pytest.approx(0.004, abs=2e-4)
    assert found[-1].at == pytest.approx(0.5 * (told.t_ns[-1] * 1e-9 + 1.0), abs=0.05)
    assert max(joint.most for joint in found[:-1]) < 5e-4


def test_states_without_a_joint_are_refused(slot):
    told = JointTrajectory.of(slot, TENTH)
    with pytest.raises(ValueError, match="do not tell joint"):
        deviations(told, StateRecord(("other",), np.zeros(3), np.zeros((3, 1))))


def test_states_of_a_bag_are_those_of_its_run(slot_folder, tmp_path, capsys):
    write_bag(Recording.open(slot_folder), tmp_path / "bag", ("/joint_states",), None)

    assert main(["ros", str(slot_folder), "--states", str(tmp_path / "bag"), "--format", "json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["same"] and told["shift_s"] == pytest.approx(0.0, abs=2e-3)
    assert main(["ros", str(slot_folder), "--states", str(tmp_path)]) == 2
    assert main(["ros", str(slot_folder)]) == 2
    assert main(["ros", str(slot_folder), "--to", "nowhere"]) == 2


class Bridge(threading.Thread):
    """Plays rosbridge on loopback, and the arm behind it, which follows at once and is off by `off` [rad, m].

    It has gone when the arm has followed: whoever listens waits for that, not for a time.
    """

    def __init__(self, off: float) -> None:
        super().__init__(daemon=True)
        self.off = off
        self.door = socket.create_server(("127.0.0.1", 0))
        self.port = self.door.getsockname()[1]
        self.heard: list[dict] = []

    def run(self) -> None:
        line, _ = self.door.accept()
        with line:
            self._greet(line)
            try:
                while (text := self._take(line)) is not None:
                    message = json.loads(text)
                    self.heard.append(message)
                    if message["op"] == "publish":
                        self._follow(line, message["msg"])
                        self.door.close()  # else the client would come again
                        line.shutdown(socket.SHUT_WR)
            except OSError:
                return

    def _greet(self, line: socket.socket) -> None:
        head = b""
        while b"\r\n\r\n" not in head:
            head += line.recv(4096)
        words = dict(row.split(": ", 1) for row in head.decode().split("\r\n")[1:] if ": " in row)
        key = next(value for name, value in words.items() if name.lower() == "sec-websocket-key")
        digest = hashlib.sha1(f"{key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11".encode()).digest()
        line.sendall(
            b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Accept: " + base64.b64encode(digest) + b"\r\n\r\n"
        )

    def _take(self, line: socket.socket) -> str | None:
        """The next message: frames of RFC 6455, masked, joined."""
        whole = b""
        while True:
            first, second = self._exactly(line, 2)
            length = second & 127
            if length == 126:
                (length,) = struct.unpack(">H", self._exactly(line, 2))
            elif length == 127:
                (length,) = struct.unpack(">Q", self._exactly(line, 8))
            mask = self._exactly(line, 4)
            data = bytes(b ^ mask[k % 4] for k, b in enumerate(self._exactly(line, length)))
            if first & 15 == 8:
                return None
            if first & 15 in (0, 1, 2):
                whole += data
                if first & 128:
                    return whole.decode()

    def _exactly(self, line: socket.socket, count: int) -> bytes:
        data = b""
        while len(data) < count:
            part = line.recv(count - len(data))
            if not part:
                raise OSError("closed")
            data += part
        return data

    def _follow(self, line: socket.socket, trajectory: dict) -> None:
        for point in trajectory["points"]:
            span = point["time_from_start"]
            position = [*point["positions"][:-1], point["positions"][-1] + self.off]
            message = {
                "header": {"stamp": {"sec": 1000 + span["sec"], "nanosec": span["nanosec"]}, "frame_id": ""},
                "name": trajectory["joint_names"],
                "position": position,
                "velocity": [],
                "effort": [],
            }
            data = json.dumps({"op": "publish", "topic": "/joint_states", "msg": message}).encode()
            head = bytes([129, 126]) + struct.pack(">H", len(data)) if len(data) > 125 else bytes([129, len(data)])
            line.sendall(head + data)


@pytest.mark.parametrize(("off", "status"), [(0.0, 0), (0.02, 1)])
def test_an_arm_follows_over_rosbridge(slot_folder: Path, off: float, status: int) -> None:
    bridge = Bridge(off)
    bridge.start()
    words = [sys.executable, "-m", "gcodesim", "ros", str(slot_folder), "--to", f"127.0.0.1:{bridge.port}"]
    ran = subprocess.run(
        [*words, "--period", "50 ms", "--listen", "600", "--format", "json"],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
        env=os.environ,
    )

    assert ran.returncode == status, ran.stderr
    sent = next(message for message in bridge.heard if message["op"] == "publish")
    assert sent["topic"] == "/joint_trajectory_controller/joint_trajectory"
    told = JointTrajectory.of(Recording.open(slot_folder), TimeRange(period_ns=50_000_000))
    assert sent["msg"]["joint_names"] == list(told.names)
    assert [point["positions"] for point in sent["msg"]["points"]] == told.position.tolist()
    found = json.loads(ran.stdout)
    assert found["states"] == len(told.t_ns)
    greatest = found["joints"][-1]["greatest"]
    unit = 1e3 if found["joints"][-1]["unit"] == "mm" else 180 / np.pi
    assert greatest == pytest.approx(off * unit, abs=0.2 + 0.05 * off * unit)  # a shift in time makes up for some


def test_a_joint_that_does_not_follow_is_a_finding(slot_folder: Path) -> None:
    bridge = Bridge(0.02)
    bridge.start()
    words = [sys.executable, "-m", "gcodesim", "ros", str(slot_folder), "--to", f"127.0.0.1:{bridge.port}"]
    ran = subprocess.run([*words, "--listen", "600"], capture_output=True, text=True, timeout=600, check=False)

    assert ran.returncode == 1
    assert "error GS805" in ran.stdout + ran.stderr


def test_nobody_there_is_said_in_words(slot_folder: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as door:
        port = door.getsockname()[1]
    ran = subprocess.run(
        [sys.executable, "-m", "gcodesim", "ros", str(slot_folder), "--to", f"127.0.0.1:{port}", "--wait", "0.2"],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert ran.returncode == 2
    assert f"no rosbridge answers at 127.0.0.1:{port}" in ran.stderr


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "the first line has to name the columns"),
        ("t,X\n", "the first line has to name the columns"),
        ("time_s,X,X\n", "the first line has to name the columns"),
        ("time_s,X\n0,1\n\n1\n", "line 4 has not 2 numbers"),
        ("time_s,X\n0,1_0\n", "line 2 has not 2 numbers"),
        ("time_s,X\n0,3 mm\n", "line 2 has not 2 numbers"),
    ],
)
def test_a_table_that_is_none(tmp_path: Path, text: str, why: str) -> None:
    (tmp_path / "states.csv").write_text(text)
    with pytest.raises(ValueError, match=why):
        read_state_table(tmp_path / "states.csv")


def test_states_of_a_table(tmp_path: Path) -> None:
    (tmp_path / "states.csv").write_text("arm/joint_1,time_s,joint_2\n0.5,10,-1e-2\n0.75,10.5,0\n")
    states = read_state_table(tmp_path / "states.csv")

    assert states.names == ("joint_1", "joint_2")
    assert states.t.tolist() == [10.0, 10.5]
    assert states.position.tolist() == [[0.5, -0.01], [0.75, 0.0]]

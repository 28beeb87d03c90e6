"""A trajectory to an arm of ROS 2, and its joint states back, over rosbridge."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any, Final

from gcodesim.export.joint_trajectory import JointTrajectory
from gcodesim.extras import require_extra

CONTROLLER: Final = "/joint_trajectory_controller/joint_trajectory"
"""Where a `joint_trajectory_controller` of ros2_control listens."""
WAIT: Final = 3.0
"""Seconds for the connection, where nobody says another."""


class NoBridgeError(ConnectionError):
    """Nobody answers there; the text says where."""


def follow(
    trajectory: JointTrajectory,
    host: str,
    port: int,
    *,
    topic: str,
    states: str,
    seconds: float,
    wait: float = WAIT,
    heard: Callable[[int], None] = lambda count: None,
) -> list[Mapping[str, Any]]:
    """Send a trajectory, and return what joint states came within `seconds` after it, or until the bridge closes.

    NoBridgeError where nobody answers within `wait` [s], ExtraMissingError without `roslibpy`.
    """
    require_extra("rosbridge", "a connection to rosbridge")
    import roslibpy

    client = roslibpy.Ros(host=host, port=port)
    try:
        client.run(timeout=wait)
    except Exception as error:  # roslibpy raises errors of its own, of its reactor and of sockets
        client.close()
        raise NoBridgeError(f"no rosbridge answers at {host}:{port}: {error}") from None
    told: list[Mapping[str, Any]] = []
    listener = roslibpy.Topic(client, states, "sensor_msgs/msg/JointState")
    talker = roslibpy.Topic(client, topic, "trajectory_msgs/msg/JointTrajectory")
    try:
        if seconds > 0.0:
            listener.subscribe(told.append)
        talker.advertise()
        talker.publish(roslibpy.Message(trajectory.as_json()))
        end = time.monotonic() + seconds
        while time.monotonic() < end and client.is_connected:
            time.sleep(0.05)
            heard(len(told))
        if seconds <= 0.0:
            time.sleep(0.5)  # until the message has left
    finally:
        client.terminate()
    return told

"""A viewer at the websocket of a live log: it subscribes to everything and keeps what it gets.

The protocol is Foxglove's (`foxglove.sdk.v1`): text is JSON; binary is an operation, for 1 the subscription (u32), the
log time (u64) and the message, for 2 the server's time (u64).
"""

from __future__ import annotations

import base64
import json
import re
import struct
import threading
import time
from collections.abc import Callable
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect


class Viewer:
    """Connects at once and reads until the server closes."""

    def __init__(self, address: str) -> None:
        self.channels: dict[str, dict[str, Any]] = {}
        self.messages: list[tuple[str, int, bytes]] = []
        self.times: list[int] = []
        self.error: Exception | None = None
        self._address = address
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def _read(self) -> None:
        try:
            with connect(
                self._address, subprotocols=["foxglove.sdk.v1"], max_size=None, open_timeout=600
            ) as self._socket:
                while True:
                    self._take(self._socket.recv(timeout=600))
        except ConnectionClosed:
            pass
        except Exception as error:
            self.error = error

    def _take(self, frame: str | bytes) -> None:
        if isinstance(frame, str):
            told = json.loads(frame)
            if told["op"] == "advertise":
                self.channels |= {channel["topic"]: channel for channel in told["channels"]}
                self._subscribe([channel["id"] for channel in told["channels"]])
            elif told["op"] == "status" and (unknown := re.fullmatch(r"Unknown channel ID: (\d+)", told["message"])):
                self._subscribe([int(unknown[1])])
        elif frame[0] == 1:
            number, t_ns = struct.unpack_from("<IQ", frame, 1)
            topic = next(topic for topic, channel in self.channels.items() if channel["id"] == number)
            self.messages.append((topic, t_ns, frame[13:]))
        elif frame[0] == 2:
            self.times.append(struct.unpack_from("<Q", frame, 1)[0])

    def _subscribe(self, channels: list[int]) -> None:
        time.sleep(0.01)  # the server of foxglove-sdk 0.30 tells of a channel a moment before it knows it
        wanted = [{"id": number, "channelId": number} for number in channels]
        self._socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))

    def schema(self, topic: str) -> tuple[str, bytes]:
        channel = self.channels[topic]
        return channel["schemaName"], base64.b64decode(channel["schema"])

    def wait(self, until: Callable[[], bool], seconds: float = 600.0) -> None:
        """Until something is so; fails when that takes too long, or nothing more can come."""
        end = time.monotonic() + seconds
        while not until():
            if not self._thread.is_alive() and not until():
                raise AssertionError("the server has closed the connection") from self.error
            assert time.monotonic() < end, f"waited {seconds} s in vain"
            self._thread.join(0.01)

    def leave(self) -> None:
        """Close the connection."""
        self._socket.close()
        self.end()

    def end(self) -> None:
        """Until the connection is closed."""
        self._thread.join(600)
        if self.error is not None:
            raise self.error

"""A log while it is being written, for viewers that are connected by websocket.

A viewer gets all that goes into the file, message by message. One that joins late first gets the last message of every
topic that shows something, so that cell, path, tool and part are there at once. Nothing waits for a viewer: one
that does not keep up misses the oldest messages.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Sequence
from threading import Lock
from typing import Any, Final

from gcodesim.extras import require_extra
from gcodesim.log.live_door import Door, hidden_host
from gcodesim.log.rows import MESSAGE_HEAD, RECORD_HEAD, RecordRows
from gcodesim.log.topics import Topic

_WAITING: Final = 1 << 15  # messages on their way to a viewer: more than a window of the run brings
_LINGER: Final = 2.0  # s; the server does not say when a viewer has everything
_TOLD_ONCE: Final = ("/event", "/log")  # the last message of these is not a state, so it is not repeated
_HEAD: Final = RECORD_HEAD + MESSAGE_HEAD


class LiveViewError(Exception):
    """The port is taken, or nothing may listen there; the message says what to do."""


class LiveView:
    """A websocket on this machine, at `port`, to which a `Container` hands its messages as they come."""

    def __init__(self, port: int, origins: Collection[str] = ()) -> None:
        """Listen; port 0 is any free one, `origins` are those of further pages that may watch.

        LiveViewError if that fails, ExtraMissingError without the library.
        """
        require_extra("live", "a live view")
        import foxglove
        from foxglove.websocket import Capability

        self._context = foxglove.Context()
        self._channels: list[Any] = []
        self._numbers: dict[str, int] = {}
        self._last: dict[int, Callable[[], tuple[int, bytes]]] = {}
        self._lock = Lock()  # between the run and viewers that arrive
        try:
            self._door = Door(port, origins)
        except OSError as error:
            raise LiveViewError(f"a live view cannot listen at port {port}: {error.strerror}") from None
        host = hidden_host()
        try:
            self._server = foxglove.start_server(
                name="gcodesim",
                host=host,
                port=0,
                context=self._context,
                capabilities=[Capability.Time],
                server_listener=_Arrivals(self._repeat),
                message_backlog_size=_WAITING,
            )
        except RuntimeError as error:
            self._door.close()
            raise LiveViewError(f"a live view cannot be served: {error}") from None
        self.port = self._door.port
        self.address = f"ws://localhost:{self.port}/?token={self._door.token}"
        self._door.open(host, self._server.port)

    # ---- called by a container

    def open(self, topics: Sequence[tuple[Topic, bytes]]) -> None:
        """The channels of a log, with their schemas; their numbers count from 1."""
        from foxglove import Schema

        for number, (topic, data) in enumerate(topics, start=1):
            self._numbers[topic.name] = number
            schema = Schema(name=topic.schema, encoding="protobuf", data=data)
            self._channels.append(self._context._create_channel(topic.name, message_encoding="protobuf", schema=schema))

    def message(self, channel: int, t_ns: int, data: bytes) -> None:
        """One message."""
        with self._lock:
            self._last[channel] = lambda: (t_ns, data)
            self._send(channel, t_ns, data)

    def rows(self, rows: RecordRows, channels: Sequence[int]) -> None:
        """The periodic messages of many instants."""
        last, matrix = len(rows.times) - 1, rows.matrix()
        ends = (*rows.starts[1:], rows.width)
        newest = {c: matrix[last, a + _HEAD : b].tobytes() for c, a, b in zip(channels, rows.starts, ends, strict=True)}
        with self._lock:
            watched = [(i, channel) for i, channel in enumerate(channels) if self._channels[channel - 1].has_sinks()]
            if watched:
                for k, t_ns in enumerate(rows.times.tolist()):
                    for i, channel in watched:
                        self._send(channel, t_ns, matrix[k, rows.starts[i] + _HEAD : ends[i]].tobytes())
            for channel, data in newest.items():
                self._last[channel] = lambda data=data: (int(rows.times[last]), data)  # type: ignore[misc]
        self._server.broadcast_time(int(rows.times[last]))

    def close(self) -> None:
        """End; connected viewers get a moment to take what is on its way."""
        end = time.monotonic() + _LINGER
        while time.monotonic() < end and any(channel.has_sinks() for channel in self._channels):
            time.sleep(0.02)
        self._door.close()
        self._server.stop()

    # ----

    def _send(self, channel: int, t_ns: int, data: bytes) -> None:
        self._channels[channel - 1].log(data, log_time=t_ns)

    def _repeat(self, topic: str) -> None:
        """For a viewer that has just subscribed. The others get it as well, but they show the same already."""
        number = self._numbers.get(topic, 0)
        with self._lock:
            if topic not in _TOLD_ONCE and number in self._last:
                self._send(number, *self._last[number]())


class _Arrivals:
    """Called by the server for messages from a viewer, of which only subscriptions matter."""

    def __init__(self, subscribed: Callable[[str], None]) -> None:
        self._subscribed = subscribed

    def on_subscribe(self, _client: Any, channel: Any) -> None:
        self._subscribed(channel.topic)

    def __getattr__(self, name: str) -> Callable[..., None]:
        if not name.startswith("on_"):
            raise AttributeError(name)
        return lambda *_: None

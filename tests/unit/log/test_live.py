"""What a viewer at the websocket sees: the log, message by message; and nobody waits for it."""

import socket
import time

import numpy as np
import pytest

from gcodesim import extras
from gcodesim.extras import ExtraMissingError
from gcodesim.log import LogWriter
from gcodesim.log.live import LiveView, LiveViewError
from gcodesim.log.logfile import LogFile
from tests.viewer import Viewer

MS = 1_000_000
PERIOD = 20 * MS


@pytest.fixture
def live():
    view = LiveView(0)
    yield view
    view.close()


def _arrived(live):
    """A viewer that gets whatever is logged from now on."""
    viewer = Viewer(live.address)
    viewer.wait(lambda: all(channel.has_sinks() for channel in live._channels))
    return viewer


def _windows(run, log, first, last):
    for begin in range(first, last, 25):
        t = np.arange(begin, min(begin + 25, last)) * PERIOD
        log.window(t, **run.columns(t))


def _stored(path):
    log = LogFile.open(path)
    return [(log.channels[m.channel].topic, m.t_ns, m.data) for m in log.messages()]


def test_a_viewer_gets_what_the_file_gets(run, live, tmp_path):
    log = LogWriter(tmp_path / "run.mcap", run.description(), live)
    viewer = _arrived(live)
    run.change_messages(log, 2_000 * MS)
    _windows(run, log, 0, 101)
    log.close(2_000 * MS, "finished")
    stored = _stored(tmp_path / "run.mcap")
    viewer.wait(lambda: viewer.times[-1:] == [2_000 * MS] and len(viewer.messages) >= len(stored))
    viewer.leave()

    assert viewer.messages == stored
    log = LogFile.open(tmp_path / "run.mcap")
    for number, channel in log.channels.items():
        assert viewer.schema(channel.topic) == (log.schema_name(number), log.schemas[channel.schema_id].data)
    assert viewer.times[-1] == 2_000 * MS and viewer.times == sorted(viewer.times)


def test_who_comes_late_sees_all_that_stands_there(run, live, tmp_path):
    log = LogWriter(tmp_path / "run.mcap", run.description(), live)
    run.change_messages(log, 1_000 * MS)
    _windows(run, log, 0, 101)
    log.flush_before(1_500 * MS)
    viewer = Viewer(live.address)
    told_once = {"/event", "/log"}
    viewer.wait(lambda: {topic for topic, _, _ in viewer.messages} | told_once >= {*viewer.channels} > told_once)
    seen = {topic: (t_ns, data) for topic, t_ns, data in viewer.messages}
    log.close(2_000 * MS, "finished")
    viewer.leave()

    stored = [message for message in _stored(tmp_path / "run.mcap") if message[1] < 1_500 * MS]
    last = {topic: (t_ns, data) for topic, t_ns, data in stored if topic not in told_once}
    assert seen == last
    assert seen["/tf"][0] == 1_480 * MS and seen["/scene/cell"][0] == 0


def test_the_log_is_the_same_with_viewers_and_without(run, live, tmp_path):
    run.write(tmp_path / "alone.mcap")
    log = LogWriter(tmp_path / "run.mcap", run.description(), live)
    viewer = _arrived(live)
    run.change_messages(log, 2_000 * MS)
    for first in range(0, 101, 37):
        t = np.arange(first, min(first + 37, 101)) * PERIOD
        log.window(t, **run.columns(t))
    log.close(2_000 * MS, "finished", {"blocks": "6"}, {"results.json": b"{}"})
    live.close()
    viewer.end()

    assert (tmp_path / "run.mcap").read_bytes() == (tmp_path / "alone.mcap").read_bytes()


def test_nobody_waits_for_a_viewer_that_does_not_read(run, live, tmp_path):
    log = LogWriter(tmp_path / "run.mcap", run.description(), live)
    with socket.create_connection(("127.0.0.1", live.port)) as mute:
        mute.sendall(
            f"GET /?{live.address.partition('?')[2]} HTTP/1.1\r\n".encode()
            + b"Host: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n"
            b"Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n"
        )
        answer = b""
        while not answer.endswith(b"\r\n\r\n") and (more := mute.recv(1)):
            answer += more
        assert b" 101 " in answer
        text = b'{"op":"subscribe","subscriptions":[{"id":1,"channelId":%d}]}' % live._channels[1].id()
        mute.sendall(bytes([0x81, 0x80 | len(text)]) + bytes(4) + text)
        begin = time.monotonic()
        while not live._channels[1].has_sinks() and time.monotonic() - begin < 600:
            time.sleep(0.01)
        assert live._channels[1].has_sinks()
        _windows(run, log, 0, 20_000)  # 20 MB of /tf, more than sockets hold
    log.close(20_000 * PERIOD, "finished")


def test_without_viewers_there_is_nothing_to_wait_for(live, monkeypatch):
    monkeypatch.setattr("gcodesim.log.live.time.sleep", lambda _: pytest.fail("it waits"))
    live.close()


def test_a_port_that_is_taken(live):
    with pytest.raises(LiveViewError, match=f"cannot listen at port {live.port}: .*in use"):
        LiveView(live.port)


def test_without_the_package_it_says_which(monkeypatch):
    monkeypatch.setitem(extras.EXTRAS, "live", ("foxglove-that-is-not-there",))
    with pytest.raises(ExtraMissingError, match=r"pip install 'gcodesim\[live\]'"):
        LiveView(0)

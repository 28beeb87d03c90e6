"""Who may read a run while it is computed: no page of another site."""

from __future__ import annotations

import socket

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from gcodesim.log.live import LiveView
from gcodesim.log.live_door import hidden_host, is_origin, may_enter

TOKEN = "right"
PROTOCOL = [Subprotocol("foxglove.sdk.v1")]


@pytest.fixture
def live():
    view = LiveView(0)
    yield view
    view.close()


def head(path: str = "/", *fields: str) -> bytes:
    return "\r\n".join([f"GET {path} HTTP/1.1", "Host: localhost", "Upgrade: websocket", *fields, "", ""]).encode()


@pytest.mark.parametrize(
    "origin",
    [
        *("https://evil.example", "http://evil.example:8765", "null", "", "NULL", "https://localhost.evil.example"),
        *("http://127.0.0.1.evil.example", "http://evil.example/http://localhost", "http://localhost@evil.example"),
        *("data:text/html,x", "blob:https://evil.example", "//localhost", "http://[", "localhost"),
    ],
)
def test_a_page_of_another_site_may_not_enter_with_the_token_either(origin: str) -> None:
    for name in ("Origin", "origin", "ORIGIN "):
        assert not may_enter(head("/", f"{name}: {origin}"), TOKEN)
        assert not may_enter(head("/", "Origin: http://localhost", f"{name}: {origin}"), TOKEN)
        assert not may_enter(head("/?token=wrong", f"{name}: {origin}"), TOKEN)
        assert not may_enter(head("/?token=", f"{name}: {origin}"), TOKEN)
        assert not may_enter(head(f"/?token={TOKEN}", f"{name}: {origin}"), TOKEN)
        assert not may_enter(head(f"/?token={TOKEN}", "Origin: file://", f"{name}: {origin}"), TOKEN)
    assert may_enter(head(f"/x?a=1&token={TOKEN}", "Origin: https://app.foxglove.dev"), TOKEN)


def test_pages_that_the_user_names_may_enter() -> None:
    own = head(f"/?token={TOKEN}", "Origin: https://viewer.example.org:8443")
    assert not may_enter(own, TOKEN) and may_enter(own, TOKEN, ["https://viewer.example.org:8443"])
    assert is_origin("https://viewer.example.org:8443") and is_origin("http://viewer")
    for text in ("viewer.example.org", "https://viewer/x", "https://a@b", "https://*", "null", "https://b\r\nx", ""):
        assert not is_origin(text)


@pytest.mark.parametrize(
    "origin", ["http://localhost:8080", "http://127.0.0.1", "http://[::1]:3000", "file://", "app://x"]
)
def test_whoever_is_on_this_machine_needs_it_too(origin: str) -> None:
    """Other users have programs and pages here as well; a program sends no origin."""
    own = f"/?token={TOKEN}"
    assert not may_enter(head("/", f"Origin: {origin}"), TOKEN) and not may_enter(head(), TOKEN)
    assert may_enter(head(own, f"Origin: {origin}"), TOKEN) and may_enter(head(own), TOKEN)


@pytest.mark.parametrize(
    "request_", [b"POST / HTTP/1.1\r\n\r\n", b"x\r\n\r\n", b"GET / HTTP/1.1\r\nA: b\r\n Origin: x\r\n\r\n"]
)
def test_what_is_no_request_of_a_viewer(request_: bytes) -> None:
    assert not may_enter(request_, TOKEN)


def test_a_server_with_a_door(live: LiveView) -> None:
    def comes_in(address: str, origin: str | None) -> bool:
        try:
            with connect(address, origin=origin, subprotocols=PROTOCOL, open_timeout=600) as viewer:  # type: ignore[arg-type]
                return "serverInfo" in str(viewer.recv(timeout=600))
        except InvalidStatus as refused:
            assert refused.response.status_code == 403
            return False

    plain = f"ws://localhost:{live.port}"
    assert not comes_in(plain, None) and not comes_in(plain, "http://localhost:8080")
    assert not comes_in(plain, "https://evil.example") and not comes_in(plain, "null")
    assert not comes_in(f"{plain}/?token=guess", "https://evil.example")
    assert not comes_in(live.address, "https://evil.example") and not comes_in(live.address, "null")
    assert comes_in(live.address, "http://localhost:8080") and comes_in(live.address, None)


def test_the_door_is_of_this_machine_only_and_patient_with_nobody(live: LiveView) -> None:
    assert live._door._listening.getsockname()[0] == "127.0.0.1"
    assert len({hidden_host() for _ in range(8)}) > 1
    for data in (b"GET / HTTP/1.1\r\nA: " + b"b" * 20_000, head() + b"more"):
        with socket.create_connection(("127.0.0.1", live.port)) as guest:
            try:
                guest.sendall(data)
                assert guest.recv(100) == b""
            except ConnectionResetError:
                pass

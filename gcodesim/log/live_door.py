"""The door of a live view. It decides who may connect to the viewer's server, which itself admits everybody.

Any web page may open a websocket to this machine, and so may the programs of other users. So the door reads the request
first and forwards it only with the token of the printed address, which nobody else knows, and from a page only if that
is one of a viewer: a page that got hold of the token reads nothing. On Linux the server behind it
listens at an address of this machine that is not told; who may read the system's list of sockets can still find it.
"""

from __future__ import annotations

import hmac
import re
import secrets
import socket
import sys
from collections.abc import Collection
from contextlib import suppress
from threading import Thread
from typing import Final
from urllib.parse import parse_qs, urlsplit

_LONGEST_HEAD: Final = 16_384  # bytes of a request
_PATIENCE: Final = 30.0  # s to say who one is; a busy machine is slow to hear it
_REFUSED: Final = (
    b"HTTP/1.1 403 Forbidden\r\nContent-Type: text/plain; charset=utf-8\r\nConnection: close\r\n\r\n"
    b"Open the address that gcodesim has printed, with its token: others may not read this run. A viewer on a page of "
    b"another host needs `--live-from` with the beginning of its address.\n"
)
_HERE: Final = re.compile(r"https?://(?:localhost|127\.0\.0\.1|\[::1\])(?::[0-9]{1,5})?")
_APPS: Final = re.compile(r"file://|app://[a-z0-9.-]*")  # pages of viewers that are installed
VIEWERS: Final = ("https://app.foxglove.dev", "https://studio.foxglove.dev", "https://lichtblick-suite.github.io")
"""Origins of the viewers' own sites, known by memory."""
_ORIGIN: Final = re.compile(r"https?://(?:[a-z0-9-]+\.)*[a-z0-9-]+(?::[0-9]{1,5})?")


class Door:
    """Listens at `port` of this machine (0: any free one) and forwards permitted clients. OSError when it is taken."""

    def __init__(self, port: int, origins: Collection[str] = ()) -> None:
        """`origins` are those of further pages that may enter, see `is_origin`."""
        self._origins = frozenset((*VIEWERS, *origins))
        self.token = secrets.token_urlsafe(16)
        self._listening = socket.create_server(("127.0.0.1", port))
        self.port = int(self._listening.getsockname()[1])
        self._server: tuple[str, int] | None = None

    def open(self, host: str, port: int) -> None:
        """Start to admit clients, to the server at `host` and `port`."""
        self._server = host, port
        Thread(target=self._welcome, daemon=True).start()

    def close(self) -> None:
        """Admit no more clients; connected ones stay until the server ends."""
        with suppress(OSError):
            self._listening.shutdown(socket.SHUT_RDWR)  # or the thread that accepts would stay
        self._listening.close()

    def _welcome(self) -> None:
        while True:
            try:
                guest, _ = self._listening.accept()
            except OSError:
                return
            Thread(target=self._hear, args=(guest,), daemon=True).start()

    def _hear(self, guest: socket.socket) -> None:
        """Read the request, and forward or refuse it."""
        assert self._server is not None
        with guest:
            try:
                guest.settimeout(_PATIENCE)
                head = _head(guest)
                if head is None:
                    return
                if not may_enter(head, self.token, self._origins):
                    guest.sendall(_REFUSED)
                    return
                guest.settimeout(None)
                with socket.create_connection(self._server) as server:
                    for end in (guest, server):
                        end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    server.sendall(head)
                    back = Thread(target=_pass_on, args=(server, guest), daemon=True)
                    back.start()
                    _pass_on(guest, server)
                    back.join()
            except OSError:  # either side has gone away
                return


def hidden_host() -> str:
    """An address of this machine for the server behind the door that no web page can guess, on systems with many."""
    if not sys.platform.startswith("linux"):
        return "127.0.0.1"
    return f"127.{secrets.randbelow(254) + 1}.{secrets.randbelow(256)}.{secrets.randbelow(254) + 1}"


def is_origin(text: str) -> bool:
    """Whether this is the origin of a page: scheme, host and perhaps a port, in small letters, and nothing behind."""
    return bool(_ORIGIN.fullmatch(text))


def may_enter(head: bytes, token: str, origins: Collection[str] = VIEWERS) -> bool:
    """Whether the request with this head has the token, and comes from a program or a permitted page.

    Browsers name the origin of the page; programs need not. Pages of this machine and of installed viewers may enter.
    """
    first, *lines = head.decode("latin-1").split("\r\n")
    words = first.split(" ")
    if len(words) != 3 or words[0] != "GET" or any(line[:1] in (" ", "\t") for line in lines):
        return False
    pages = [line.split(":", 1)[1].strip() for line in lines if line.split(":", 1)[0].strip().lower() == "origin"]
    if len(pages) > 1 or not all(_is_permitted(page, origins) for page in pages):
        return False
    given = parse_qs(urlsplit(words[1]).query).get("token", [""])[0]
    return hmac.compare_digest(given.encode(), token.encode())


def _is_permitted(page: str, origins: Collection[str]) -> bool:
    return page in origins or bool(_HERE.fullmatch(page) or _APPS.fullmatch(page))


def _head(guest: socket.socket) -> bytes | None:
    """A request up to the empty line after its fields; None if that does not arrive, or if more arrives."""
    head = b""
    while not head.endswith(b"\r\n\r\n"):
        data = guest.recv(4096)
        head += data
        if not data or len(head) > _LONGEST_HEAD or b"\r\n\r\n" in head[:-4]:
            return None
    return head


def _pass_on(one: socket.socket, other: socket.socket) -> None:
    """Forward everything from one side until it ends."""
    with suppress(OSError):
        while data := one.recv(1 << 16):
            other.sendall(data)
    for end in (one, other):
        with suppress(OSError):
            end.shutdown(socket.SHUT_RDWR)

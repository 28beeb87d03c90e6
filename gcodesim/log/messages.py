"""The messages that come when something changes: program line, event, text for people; and the frames that stand still.

A program of 100,000 blocks makes hundreds of thousands of these, so they are
put together from bytes, and what rarely changes is kept as made.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from gcodesim.log.description import StaticFrame
from gcodesim.log.wire import FIXED32, chunk, double, stamp, tag, text, unsigned

SEVERITIES: Final = {"note": 2, "warning": 3, "error": 4}  # as levels of foxglove.Log: info, warning, error
STATES: Final = ("running", "paused", "toolchange", "finished", "failed")
_LOG_LINE: Final = tag(6, FIXED32)
_short_text = lru_cache(maxsize=1024)(text)


@dataclass(slots=True)
class ProgramState:
    """What `/program` shows; see `gcodesim.Program`. `feed` [m/s], `spindle` [rad/s, + = M3]."""

    file: str = ""
    line: int = 0
    text: str = ""
    motion: str = ""
    tool: int = 0
    tool_name: str = ""
    wcs: str = ""
    feed: float = 0.0
    spindle: float = 0.0
    state: str = "running"
    block: int = 0


@lru_cache(maxsize=64)
def _program_tail(tool: int, tool_name: str, wcs: str, feed: float, spindle: float, state: str) -> bytes:
    names = unsigned(6, tool) + text(7, tool_name) + text(8, wcs)
    return names + double(9, feed) + double(10, spindle) + text(11, state)


def program_message(t_ns: int, s: ProgramState) -> bytes:
    """A `gcodesim.Program`."""
    block = _short_text(2, s.file) + unsigned(3, s.line) + text(4, s.text) + _short_text(5, s.motion)
    tail = _program_tail(s.tool, s.tool_name, s.wcs, s.feed, s.spindle, s.state)
    return stamp(1, t_ns) + block + tail + unsigned(12, s.block)


def log_message(t_ns: int, level: int, message: str, file: str, line: int) -> bytes:
    """A `foxglove.Log` under the name of the program."""
    place = _short_text(5, file) + _LOG_LINE + line.to_bytes(4, "little")
    return stamp(1, t_ns) + unsigned(2, level) + text(3, message) + _short_text(4, "gcodesim") + place


def event_message(
    t_ns: int, code: str, severity: str, file: str, line: int, message: str, bodies: Sequence[str], value: float
) -> bytes:
    """A `gcodesim.Event`."""
    named = b"".join(chunk(7, body.encode()) for body in bodies)
    place = text(4, file) + unsigned(5, line)
    return stamp(1, t_ns) + text(2, code) + text(3, severity) + place + text(6, message) + named + double(8, value)


def frames_message(t_ns: int, frames: Sequence[StaticFrame]) -> bytes:
    """A `foxglove.FrameTransforms`, quaternions complete."""
    message = b""
    for frame in frames:
        names = text(2, frame.parent) + text(3, frame.child)
        p = b"".join(double(i + 1, float(value)) for i, value in enumerate(frame.p))
        q = b"".join(double(i + 1, float(value)) for i, value in enumerate(frame.q))
        message += chunk(1, stamp(1, t_ns) + names + chunk(4, p) + chunk(5, q))
    return message

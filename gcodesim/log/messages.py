"""Messages that are written when something changes: program line, event, text; and the frames that stand still.

A program of 100,000 blocks makes hundreds of thousands of these, so they are
assembled from bytes, and parts that rarely change are kept.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

from gcodesim.log.description import StaticFrame
from gcodesim.log.wire import FIXED32, chunk, double, stamp, tag, text, unsigned

SEVERITIES: Final = {"note": 2, "warning": 3, "error": 4}  # as levels of foxglove.Log: info, warning, error
STATES: Final = ("running", "paused", "toolchange", "finished", "failed")
_LOG_LINE: Final = tag(6, FIXED32)


class OutputState(NamedTuple):
    """An output of the control with its value, or a device of the cell with the last verb that it was given."""

    name: str
    value: float = 0.0
    verb: str = ""


@dataclass(slots=True)
class ProgramShown:
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
    flood: bool = False
    mist: bool = False
    outputs: tuple[OutputState, ...] = ()


def program_frame(s: ProgramShown) -> tuple[bytes, bytes]:
    """The parts of a `gcodesim.Program` that many blocks share: before its line and after its text."""
    names = text(5, s.motion) + unsigned(6, s.tool) + text(7, s.tool_name) + text(8, s.wcs)
    numbers = double(9, s.feed) + double(10, s.spindle)
    coolant = unsigned(13, int(s.flood)) + unsigned(14, int(s.mist))
    outputs = b"".join(chunk(15, text(1, o.name) + double(2, o.value) + text(3, o.verb)) for o in s.outputs)
    return text(2, s.file), names + numbers + text(11, s.state) + coolant + outputs


def program_message(t_ns: int, s: ProgramShown) -> bytes:
    """A `gcodesim.Program`."""
    before, after = program_frame(s)
    return stamp(1, t_ns) + before + unsigned(3, s.line) + text(4, s.text) + after + unsigned(12, s.block)


@lru_cache(maxsize=64)
def log_frame(level: int, file: str) -> tuple[bytes, bytes]:
    """The parts of a `foxglove.Log` that many lines share: before its text, and between text and line number."""
    return unsigned(2, level), text(4, "gcodesim") + text(5, file)


def log_message(t_ns: int, level: int, message: str, file: str, line: int) -> bytes:
    """A `foxglove.Log` under the name of the program."""
    before, place = log_frame(level, file)
    return stamp(1, t_ns) + before + text(3, message) + place + _LOG_LINE + line.to_bytes(4, "little")


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

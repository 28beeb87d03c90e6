"""What an exporter is, whoever adds one: it writes what a log holds in the form of another program."""

from __future__ import annotations

from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, ClassVar, Literal, TextIO

from gcodesim.export.select import TimeRange
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.playback.columns import UnitSystem
    from gcodesim.playback.recording import Recording

Destination = TextIO | BinaryIO | Path

Option = Literal["topics", "time", "lines", "period", "units", "at", "stock", "world", "by", "section", "simplify"]

RANGE: frozenset[Option] = frozenset(("topics", "time", "lines", "period"))
"""Options of an exporter that writes what happened over a time."""


class NoExportError(ValueError):
    """There is no such thing to write; the text says why."""


@frozen
class Request:
    """What of a log is asked for: `topics` (none: the usual ones) in a range of time, in `units`, or the state at a
    moment `at_ns` (None: the end), of one `stock` where there are several, in the world or in its own frame, coloured
    `by` deviation, tool or line; `section`: across which of x, y, z, and where [m]; `simplify`: how far [m] a surface
    may be off for fewer triangles, 0 for not at all."""

    topics: tuple[str, ...] = ()
    part: TimeRange = field(default_factory=TimeRange)
    units: UnitSystem = "si"
    at_ns: int | None = None
    stock: str | None = None
    world: bool = False
    by: str | None = None
    section: tuple[str, float] | None = None
    simplify: float = 0.0

    def moment(self, recording: Recording) -> int:
        """The moment [ns]."""
        return recording.end_ns if self.at_ns is None else self.at_ns


class Exporter:
    """The base of all exporters. `kind` is the name in the table `EXPORTERS` and on the command line.

    `says` tells in a line what comes out. `writes` is where to: `text` and `bytes` go into a stream, a `folder` is made
    by the exporter. A file without a name is called as the run, with `suffix` behind. `takes` names the options that
    mean something here; others are refused before anything is read. `extra` names the one of `gcodesim.extras` that is
    needed; whether it is installed is asked first.
    """

    kind: ClassVar[str] = ""
    says: ClassVar[str] = ""
    suffix: ClassVar[str] = ""
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "text"
    takes: ClassVar[frozenset[Option]] = frozenset()
    extra: ClassVar[str] = ""

    def write(self, recording: Recording, out: Any, request: Request) -> str:
        """Write into `out`, a stream or the path of a new folder; returns what was written, such as `12 rows`.

        NoExportError when the log does not have what is asked for.
        """
        raise NotImplementedError


def counted(count: int, what: str) -> str:
    """`1 row`, `12 rows`."""
    return f"{count} {what}{'' if count == 1 else 's'}"

"""The messages of many program blocks at once: `/program`, `/log` and `/scene/block`.

A finishing program has tens of thousands of blocks, three messages each, so
the parts that they share are made once, and numbers are written by columns.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frozen import frozen
from gcodesim.log.byte_strings import ByteStrings
from gcodesim.log.messages import SEVERITIES, ProgramShown, log_frame, program_frame
from gcodesim.log.scene import block_piece, polyline_update, rounded
from gcodesim.log.template import STAMP_WIDTH, Template, padded_stamps, padded_varints
from gcodesim.log.wire import FIXED32, tag

Array = NDArray[np.float64]
PORTION: Final = 4096  # blocks: a window of the run begins a hundred, and one by one costs little less than all
_MOST_TEMPLATE_POINTS: Final = 40  # of a polyline; longer ones are rare and made one by one


@frozen(eq=False)
class BlockColumns:
    """m blocks in the order in which they begin.

    `t_ns`, `line`, `block` (m,) as in `ProgramShown`, `text` m blocks as
    written, in UTF-8. `modal` (m,) points into `modals`, which say the rest: file,
    motion, tool, work coordinates, feed, spindle, state. `points` (p, 3) [m] in
    `frame` are the ways of all blocks, block i from `point_starts[i]` to
    `point_starts[i + 1]` (m + 1,).
    """

    t_ns: NDArray[np.int64]
    line: NDArray[np.integer]
    block: NDArray[np.integer]
    text: ByteStrings
    modal: NDArray[np.integer]
    modals: Sequence[ProgramShown]
    points: Array
    point_starts: NDArray[np.integer]
    frame: str = "world"

    def __len__(self) -> int:
        return len(self.t_ns)

    def part(self, first: int, last: int) -> BlockColumns:
        """Blocks first ≤ i < last."""
        starts = self.point_starts[first : last + 1]
        return BlockColumns(
            t_ns=self.t_ns[first:last],
            line=self.line[first:last],
            block=self.block[first:last],
            text=self.text[first:last],
            modal=self.modal[first:last],
            modals=self.modals,
            points=self.points[starts[0] : starts[-1]],
            point_starts=starts - starts[0],
            frame=self.frame,
        )


class BlockMessages:
    """The messages of a program's blocks; they are asked for in order and made some thousands at a time."""

    def __init__(self, columns: BlockColumns) -> None:
        """ValueError when the blocks are not in the order in which they begin."""
        if (np.diff(columns.t_ns) < 0).any():
            raise ValueError("the blocks are not in the order of their begin")
        self.columns = columns
        self._first = self._last = 0  # of those that are made
        self._made: dict[str, ByteStrings] = {}

    def between(self, first: int, last: int) -> Iterator[tuple[NDArray[np.int64], dict[str, ByteStrings]]]:
        """Times of blocks first ≤ i < last and their messages by topic, in the parts in which they are made."""
        while first < last:
            if not self._first <= first < self._last:
                self._first, self._last = first, min(first + PORTION, len(self.columns))
                part = self.columns.part(self._first, self._last)
                programs, logs = program_messages(part)
                self._made = {"/program": programs, "/log": logs, "/scene/block": way_messages(part)}
            end = min(last, self._last)
            inside = slice(first - self._first, end - self._first)
            yield self.columns.t_ns[first:end], {topic: made[inside] for topic, made in self._made.items()}
            first = end


def program_messages(blocks: BlockColumns) -> tuple[ByteStrings, ByteStrings]:
    """The `gcodesim.Program` and the `foxglove.Log` message of each block."""
    m = len(blocks.t_ns)
    stamps = np.empty((m, STAMP_WIDTH + 2), dtype=np.uint8)
    stamps[:, :2] = 10, STAMP_WIDTH  # field 1, a message
    stamps[:, 2:] = padded_stamps(np.asarray(blocks.t_ns, dtype=np.int64))
    places = np.empty((m, 5), dtype=np.uint8)
    places[:, 0] = tag(6, FIXED32)[0]
    places[:, 1:] = np.asarray(blocks.line, dtype="<u4")[:, None].view(np.uint8)
    begin = ByteStrings.rows(stamps)
    used, which = np.unique(np.asarray(blocks.modal), return_inverse=True)
    modals = [blocks.modals[i] for i in used.tolist()]
    before, after = _shared([program_frame(modal) for modal in modals], which)
    level, file = _shared([log_frame(SEVERITIES["note"], modal.file) for modal in modals], which)
    line, count = padded_varints(3, blocks.line), padded_varints(12, blocks.block)
    program = (begin, before, ByteStrings.rows(line), blocks.text.as_field(4), after, ByteStrings.rows(count))
    log = (begin, level, blocks.text.as_field(3), file, ByteStrings.rows(places))
    return ByteStrings.joined(program), ByteStrings.joined(log)


def _shared(frames: Sequence[tuple[bytes, bytes]], which: NDArray[np.integer]) -> tuple[ByteStrings, ByteStrings]:
    """First and second part of frame `which` (m,) for each block."""
    first, second = (ByteStrings.of(parts) for parts in zip(*frames, strict=True))
    return first.chosen(which), second.chosen(which)


def way_messages(blocks: BlockColumns) -> ByteStrings:
    """The `/scene/block` message of each block; blocks with equally many points are made together."""
    times = np.asarray(blocks.t_ns, dtype=np.int64)
    starts = np.asarray(blocks.point_starts, dtype=np.int64)
    counts = np.diff(starts)
    if len(counts) != len(times) or (counts < 0).any() or (len(starts) and starts[-1] != len(blocks.points)):
        raise ValueError("the point starts do not divide the points of the blocks")
    points = rounded(blocks.points)
    groups = []
    for count in distinct(counts).tolist():
        chosen = np.flatnonzero(counts == count)
        if 2 <= count <= _MOST_TEMPLATE_POINTS:
            rows = points[starts[chosen][:, None] + np.arange(count)].reshape(len(chosen), -1)
            made = ByteStrings.rows(_way_template(count, blocks.frame).fill(times[chosen], rows))
        else:
            made = ByteStrings.of(
                polyline_update(int(times[i]), "block", blocks.frame, points[starts[i] : starts[i + 1]]) for i in chosen
            )
        groups.append((chosen, made))
    return ByteStrings.mixed(groups)


@lru_cache(maxsize=64)
def _way_template(count: int, frame: str) -> Template:
    return Template(block_piece(count, frame))

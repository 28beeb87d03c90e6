"""The messages of many program blocks at once: `/program`, `/log` and `/scene/block`.

A finishing program has tens of thousands of blocks, three messages each, so
what all have in common is made once, and numbers are written by columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.log.messages import SEVERITIES, ProgramState, log_frame, program_frame
from gcodesim.log.scene import block_piece, polyline_update, rounded
from gcodesim.log.template import STAMP_WIDTH, Template, padded_stamps, padded_varints, split_rows
from gcodesim.log.wire import FIXED32, chunk, tag

Array = NDArray[np.float64]
_MOST_TEMPLATE_POINTS: Final = 40  # of a polyline; longer ones are rare and made one by one


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BlockColumns:
    """m blocks in the order of their begin.

    `t_ns`, `line`, `block` (m,) as in `ProgramState`, `text` m blocks as
    written. `modal` (m,) points into `modals`, which say the rest: file,
    motion, tool, work coordinates, feed, spindle, state. `points` (p, 3) [m] in
    `frame` are the ways of all blocks, block i from `point_starts[i]` to
    `point_starts[i + 1]` (m + 1,).
    """

    t_ns: NDArray[np.int64]
    line: NDArray[np.integer]
    block: NDArray[np.integer]
    text: Sequence[str]
    modal: NDArray[np.integer]
    modals: Sequence[ProgramState]
    points: Array
    point_starts: NDArray[np.integer]
    frame: str = "world"


def program_messages(blocks: BlockColumns) -> tuple[list[bytes], list[bytes]]:
    """The `gcodesim.Program` and the `foxglove.Log` message of each block."""
    m = len(blocks.t_ns)
    heads = np.empty((m, STAMP_WIDTH + 2), dtype=np.uint8)
    heads[:, :2] = 10, STAMP_WIDTH  # field 1, a message
    heads[:, 2:] = padded_stamps(np.asarray(blocks.t_ns, dtype=np.int64))
    stamps = split_rows(heads)
    lines, counts = split_rows(padded_varints(3, blocks.line)), split_rows(padded_varints(12, blocks.block))
    log_lines = np.empty((m, 5), dtype=np.uint8)
    log_lines[:, 0] = tag(6, FIXED32)[0]
    log_lines[:, 1:] = np.asarray(blocks.line, dtype="<u4")[:, None].view(np.uint8)
    places = split_rows(log_lines)
    program_frames = [program_frame(modal) for modal in blocks.modals]
    log_frames = [log_frame(SEVERITIES["note"], modal.file) for modal in blocks.modals]
    programs, logs = [], []
    modal_of = np.asarray(blocks.modal).tolist()
    for i, (modal, written) in enumerate(zip(modal_of, blocks.text, strict=True)):
        before, after = program_frames[modal]
        level, place = log_frames[modal]
        raw = written.encode()
        programs.append(b"".join((stamps[i], before, lines[i], chunk(4, raw), after, counts[i])))
        logs.append(b"".join((stamps[i], level, chunk(3, raw), place, places[i])))
    return programs, logs


def way_messages(blocks: BlockColumns) -> list[bytes]:
    """The `/scene/block` message of each block; blocks with equally many points are made together."""
    times = np.asarray(blocks.t_ns, dtype=np.int64)
    starts = np.asarray(blocks.point_starts, dtype=np.int64)
    counts = np.diff(starts)
    if len(counts) != len(times) or (counts < 0).any() or (len(starts) and starts[-1] != len(blocks.points)):
        raise ValueError("the point starts do not divide the points of the blocks")
    points = rounded(blocks.points)
    messages = [b""] * len(times)
    for count in np.unique(counts):
        chosen = np.flatnonzero(counts == count)
        if 2 <= count <= _MOST_TEMPLATE_POINTS:
            rows = points[starts[chosen][:, None] + np.arange(count)].reshape(len(chosen), -1)
            made = split_rows(_way_template(int(count), blocks.frame).fill(times[chosen], {"points": rows}))
        else:
            made = [
                polyline_update(int(times[i]), "block", blocks.frame, points[starts[i] : starts[i + 1]]) for i in chosen
            ]
        for i, message in zip(chosen.tolist(), made, strict=True):
            messages[i] = message
    return messages


@lru_cache(maxsize=64)
def _way_template(count: int, frame: str) -> Template:
    return Template(block_piece(count, frame))

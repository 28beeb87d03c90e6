"""What a further program writes into the log of a run in which several run at once."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Final

import numpy as np

from gcodesim.log.byte_strings import ByteStrings
from gcodesim.log.columns import ColumnBatch
from gcodesim.log.description import LogDescription
from gcodesim.log.messages import ProgramShown
from gcodesim.log.rows import MESSAGE_HEAD, RECORD_HEAD, RowBuilder
from gcodesim.log.scene import path_update
from gcodesim.log.topics import OF_EACH, PERIODIC
from gcodesim.log.writer import LogWriter

_HEAD: Final = RECORD_HEAD + MESSAGE_HEAD


class FurtherLog(LogWriter):
    """A writer whose topics have the name of its channel in front; its messages go into the log of another one.

    It is used like that one between its beginning and its end. Static frames, bodies of the cell and tiles of stock
    are given to the other.
    """

    def __init__(self, first: LogWriter, name: str, description: LogDescription) -> None:
        """`first` was made with this description among its `further` ones."""
        self._description = description
        self._first, self._settled_ns = first, 0
        numbers = first.join(self)
        own = [*(topic.name for topic in PERIODIC), *OF_EACH]
        self._channels = {topic: numbers[f"/{name}{topic}"] for topic in own}
        self._frames = first._frames
        self._backlog = first._backlog
        self._periodic = tuple(self._channels[topic.name] for topic in PERIODIC)
        self._batch = ColumnBatch(description)
        self._builder = RowBuilder(description, self._periodic, self._batch.columns)
        self._rows = deque()
        self._last_ns = -1
        self._program = ProgramShown()
        self._at_start = set()
        self._others = []
        d = description
        self._add_one("/scene/path", 0, path_update(0, d.path_frame, d.feed_path, d.rapid_path, d.path_ahead))
        self.event(0, "start", f"{d.run.get('program', 'program')} starts")

    @property
    def _written_ns(self) -> int:  # type: ignore[override]
        return self._first.settled_ns

    @property
    def settled_ns(self) -> int:
        return self._settled_ns

    def _build(self) -> None:
        """Put the instants of the batch among the other messages."""
        if not self._batch.count:
            return
        for rows in self._builder.build(*self._batch.take()):
            records = rows.matrix()
            ends = [*rows.starts[1:], rows.width]
            for channel, start, end in zip(self._periodic, rows.starts, ends, strict=True):
                messages = ByteStrings.rows(np.ascontiguousarray(records[:, start + _HEAD : end]))
                self._backlog.add_many(channel, rows.times, messages)

    def _drain(self, t_ns: int) -> None:
        self._settled_ns = max(self._settled_ns, t_ns)

    def end(self, end_ns: int, state: str, peaks: Mapping[str, float]) -> None:
        """The last state, as in `close`; to be called before the log itself is closed."""
        self._close_rows(end_ns, state, peaks)
        self._build()

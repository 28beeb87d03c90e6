"""One chunk of a log: message records, their index, and both packed for the file."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import zstandard
from mcap.opcode import Opcode

from gcodesim.log.rows import MESSAGE_HEAD, MESSAGE_OPCODE, Rows

LEVEL: Final = 3  # of zstd: a log with a part is a third smaller than at 1 for a third more time of the packing thread
_RECORD: Final = struct.Struct("<BQ")
_MESSAGE: Final = struct.Struct("<BQHIQQ")
_INDEX_ENTRY: Final = struct.Struct("<QQ")
_INDEX_HEAD: Final = struct.Struct("<BQHI")
_CHUNK_HEAD: Final = struct.Struct("<QQQII4sQ")


class ChunkBuilder:
    """Message records of one chunk and their index."""

    def __init__(self) -> None:
        self.size = 0
        self.count = 0
        self.first_ns = 0
        self.last_ns = 0
        self._parts: list[bytes | memoryview] = []
        self._index: dict[int, list[bytes]] = {}

    def _take(self, first_ns: int, last_ns: int, part: bytes | memoryview, size: int, count: int) -> None:
        if self.count == 0:
            self.first_ns = first_ns
        self.last_ns = last_ns
        self._parts.append(part)
        self.size += size
        self.count += count

    def add_message(self, channel: int, sequence: int, t_ns: int, data: bytes) -> None:
        """One message record; times must not decrease."""
        self._index.setdefault(channel, []).append(_INDEX_ENTRY.pack(t_ns, self.size))
        head = _MESSAGE.pack(MESSAGE_OPCODE, MESSAGE_HEAD + len(data), channel, sequence, t_ns, t_ns)
        self._parts.append(head)
        self._take(t_ns, t_ns, data, len(head) + len(data), 1)

    def add_rows(self, rows: Rows, channels: Sequence[int]) -> None:
        """The records of several instants, one for each of `channels` an instant."""
        n = len(rows.times)
        if n == 1:  # as often as not, when something changes at every instant
            for channel, start in zip(channels, rows.starts, strict=True):
                entry = _INDEX_ENTRY.pack(rows.times[0], self.size + start)
                self._index.setdefault(channel, []).append(entry)
        else:
            entries = np.empty((n, 2), dtype="<u8")
            entries[:, 0] = rows.times
            offsets = self.size + rows.width * np.arange(n, dtype=np.uint64)
            for channel, start in zip(channels, rows.starts, strict=True):
                entries[:, 1] = offsets + np.uint64(start)
                self._index.setdefault(channel, []).append(entries.tobytes())
        self._take(rows.times[0], rows.times[-1], rows.data, len(rows.data), n * len(channels))

    def records(self) -> bytes:
        return b"".join(self._parts)

    def index_records(self) -> dict[int, bytes]:
        """A message index record for each channel of this chunk, channels in order."""
        found = {}
        for channel in sorted(self._index):
            entries = b"".join(self._index[channel])
            found[channel] = _INDEX_HEAD.pack(Opcode.MESSAGE_INDEX, 6 + len(entries), channel, len(entries)) + entries
        return found


@dataclass(frozen=True, slots=True)
class PackedChunk:
    """A chunk record and its message index records as bytes; `offsets` of the latter from the start of the former."""

    chunk: bytes
    indexes: bytes
    offsets: dict[int, int]
    first_ns: int
    last_ns: int
    packed_size: int
    unpacked_size: int


def pack(chunk: ChunkBuilder) -> PackedChunk:
    """Compress; touches nothing but `chunk`, so that another thread may do it."""
    records = chunk.records()
    packed = zstandard.ZstdCompressor(level=LEVEL).compress(records)
    crc = zlib.crc32(records)
    head = _CHUNK_HEAD.pack(chunk.first_ns, chunk.last_ns, len(records), crc, 4, b"zstd", len(packed))
    record = b"".join((_RECORD.pack(Opcode.CHUNK, len(head) + len(packed)), head, packed))
    indexes = chunk.index_records()
    offsets, at = {}, len(record)
    for channel, index in indexes.items():
        offsets[channel] = at
        at += len(index)
    joined = b"".join(indexes.values())
    return PackedChunk(record, joined, offsets, chunk.first_ns, chunk.last_ns, len(packed), len(records))

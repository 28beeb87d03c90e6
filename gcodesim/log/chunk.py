"""One chunk of a log: message records, their index, and both packed for the file."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from typing import Final

import numpy as np
import zstandard
from mcap.opcode import Opcode
from numpy.typing import NDArray

from gcodesim.log.order import Cut

LEVEL: Final = 3  # of zstd: a log with a part is a third smaller than at 1 for a third more time of the packing thread
_RECORD: Final = struct.Struct("<BQ")
_INDEX_HEAD: Final = struct.Struct("<BQHI")
_CHUNK_HEAD: Final = struct.Struct("<QQQII4sQ")


class ChunkBuilder:
    """Message records of one chunk and their index."""

    def __init__(self, room: NDArray[np.uint8]) -> None:
        """`room` takes the records; a larger one replaces it when they are more."""
        self.room = room
        self.size = 0
        self.count = 0
        self.first_ns = 0
        self.last_ns = 0
        self._index: dict[int, list[bytes]] = {}

    def add(self, cut: Cut) -> None:
        """Records whose times do not decrease; the places in their index count from the begin of the chunk."""
        if self.count == 0:
            self.first_ns = cut.first_ns
        self.last_ns = cut.last_ns
        size = self.size + cut.size
        if size > len(self.room):
            larger = np.empty(size, dtype=np.uint8)
            larger[: self.size] = self.room[: self.size]
            self.room = larger
        cut.write(self.room)
        self.size = size
        self.count += cut.count
        for channel, entries in cut.index.items():
            self._index.setdefault(channel, []).append(entries)

    def records(self) -> memoryview:
        return self.room[: self.size].data

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

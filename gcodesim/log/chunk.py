"""One chunk of a log: message records, their index, and both packed for the file."""

from __future__ import annotations

import struct
from typing import Final

import numpy as np
import zstandard
from mcap.opcode import Opcode
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.log.checksum import crc32
from gcodesim.log.order import ChunkPiece

PACKING: Final = zstandard.ZstdCompressionParameters(
    strategy=zstandard.STRATEGY_FAST,
    hash_log=14,
    chain_log=10,
    search_log=1,
    min_match=6,
    target_length=1,  # literals are not entropy-coded: the last digits of numbers are random
    window_log=20,
)
"""Of zstd: as quick as its level -1, a third quicker than 3, for a log that is 5 to 15 % larger than at 3; 2^14 places
to look for repeats are a fourth of what level 3 takes, and stay in the caches beside everything else."""

_RECORD: Final = struct.Struct("<BQ")
_INDEX_HEAD: Final = struct.Struct("<BQHI")
_CHUNK_HEAD: Final = struct.Struct("<QQQII4sQ")


class ChunkBuilder:
    """Message records of one chunk and their index."""

    def __init__(self, room: NDArray[np.uint8]) -> None:
        """`room` takes the records; it is replaced by a larger one when they need more."""
        self.room = room
        self.size = 0
        self.count = 0
        self.first_ns = 0
        self.last_ns = 0
        self._index: dict[int, list[bytes]] = {}

    def add(self, cut: ChunkPiece) -> None:
        """Records whose times do not decrease; the places in their index count from the start of the chunk."""
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


@frozen(kw_only=False)
class PackedChunk:
    """A chunk record, `chunk_size` bytes of `records`, and behind it its message index records; `offsets` of the latter

    from the start of all.
    """

    records: bytes
    chunk_size: int
    offsets: dict[int, int]
    first_ns: int
    last_ns: int
    packed_size: int
    unpacked_size: int


def pack(chunk: ChunkBuilder) -> PackedChunk:
    """Compress; changes nothing but `chunk`, so that another thread may do it."""
    data = chunk.records()
    packed = zstandard.ZstdCompressor(compression_params=PACKING).compress(data)
    crc = crc32(data)
    head = _CHUNK_HEAD.pack(chunk.first_ns, chunk.last_ns, len(data), crc, 4, b"zstd", len(packed))
    size = _RECORD.size + len(head) + len(packed)
    indexes = chunk.index_records()
    offsets, at = {}, size
    for channel, index in indexes.items():
        offsets[channel] = at
        at += len(index)
    records = b"".join((_RECORD.pack(Opcode.CHUNK, size - _RECORD.size), head, packed, *indexes.values()))
    return PackedChunk(records, size, offsets, chunk.first_ns, chunk.last_ns, len(packed), len(data))

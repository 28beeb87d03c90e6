"""The MCAP container, written so that a file cut off anywhere is readable up to its last whole record.

Chunks are built by us (`chunk.py`) from rows and single messages, because a
library call for each message would cost more than making the message. The rare
records are those of the `mcap` package.
"""

from __future__ import annotations

import errno
import os
import struct
from collections import deque
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from numpy.typing import NDArray

from gcodesim.files.whole_file import new_file
from gcodesim.log.backlog import Messages
from gcodesim.log.checksum import crc32
from gcodesim.log.chunk import ChunkBuilder, PackedChunk, pack
from gcodesim.log.order import Ordered
from gcodesim.log.rows import RecordRows
from gcodesim.log.topics import Topic

MAGIC: Final = b"\x89MCAP0\r\n"
CHUNK_SIZE: Final = 1 << 20
ROOM: Final = CHUNK_SIZE * 5 // 4  # a chunk ends with the message that makes it larger than wanted
MOST_PACKING: Final = 3  # chunks that may wait for the packing thread; beyond that the run waits as well
_RECORD: Final = struct.Struct("<BQ")


class LogWriteError(OSError):
    """The log cannot be written: disk full, folder gone, no permission. What was written so far stays readable."""


class Sink(Protocol):
    """A receiver of all messages in the order of the file: first `open`, then messages and rows of messages."""

    def open(self, topics: Sequence[tuple[Topic, bytes]]) -> None: ...

    def message(self, channel: int, t_ns: int, data: bytes) -> None: ...

    def rows(self, rows: RecordRows, channels: Sequence[int]) -> None: ...


class Container:
    """An MCAP file under construction: `NAME.part` until it is complete.

    Every record goes to the system in one unbuffered write, so that a killed
    process loses only the chunks that are being filled or packed. Packing is
    done by a thread of its own, in order, so the bytes do not depend on it.
    """

    def __init__(
        self, path: Path, library: str, topics: Sequence[tuple[Topic, bytes]], sink: Sink | None = None
    ) -> None:
        """Open `path` + `.part` and write header, schemas and channels (ids from 1 in the order of `topics`).

        An older log under the final name is removed, since it would be taken for the
        result of this run. LogWriteError if the folder cannot be written to.
        """
        self.path = path
        self.part_path = path.with_name(path.name + ".part")
        self._offset = 0
        self._crc = 0
        self._rooms: list[NDArray[np.uint8]] = []  # of chunks that are written
        self._chunk = self._new_chunk()
        self._packer = ThreadPoolExecutor(1, thread_name_prefix="log")
        self._packing: deque[tuple[ChunkBuilder, Future[PackedChunk]]] = deque()
        self._schemas: dict[str, Schema] = {}
        self._channels: list[Channel] = []
        self._chunks: list[ChunkIndex] = []
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._counts = np.zeros(len(topics) + 1, dtype=np.int64)  # messages by channel
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = new_file(self.part_path, buffering=0)
            path.unlink(missing_ok=True)
        except OSError as error:
            raise self._failure(error) from error
        self._write(MAGIC + _bytes_of(Header("", library)))
        for topic, data in topics:
            self._open_channel(topic, data)
        self._sink = sink
        if sink is not None:
            sink.open(topics)

    def _open_channel(self, topic: Topic, data: bytes) -> None:
        schema = self._schemas.get(topic.schema)
        if schema is None:
            schema = Schema(id=len(self._schemas) + 1, data=data, encoding="protobuf", name=topic.schema)
            self._schemas[topic.schema] = schema
            self._write(_bytes_of(schema))
        channel = Channel(len(self._channels) + 1, topic.name, "protobuf", {}, schema.id)
        self._channels.append(channel)
        self._write(_bytes_of(channel))

    def add(self, messages: Messages, rows: Sequence[RecordRows], channels: Sequence[int]) -> None:
        """Messages and rows of the periodic `channels`; chunks are closed as they fill.

        Times must not be earlier than those given before. The sequence counts from 0 for each channel.
        """
        ordered = Ordered(messages, rows, channels, self._counts)
        if self._sink is not None:
            _hand_over(ordered, channels, self._sink)
        for cut in ordered.cut(self._chunk.size, CHUNK_SIZE):
            self._chunk.add(cut)
            if self._chunk.size > CHUNK_SIZE:
                self._close_chunk()

    def _close_chunk(self) -> None:
        """Have the chunk packed while the run goes on, and write those that are ready."""
        self._check_open()
        if self._chunk.count:
            self._packing.append((self._chunk, self._packer.submit(pack, self._chunk)))
            self._chunk = self._new_chunk()
        while self._packing and (self._packing[0][1].done() or len(self._packing) > MOST_PACKING):
            self._write_first()

    def flush(self) -> None:
        """Put all messages so far on disk."""
        self._close_chunk()
        while self._packing:
            self._write_first()

    def _new_chunk(self) -> ChunkBuilder:
        """An empty chunk; the room of an old one is reused, because the system is slow to provide new memory."""
        return ChunkBuilder(self._rooms.pop() if self._rooms else np.empty(ROOM, dtype=np.uint8))

    def _write_first(self) -> None:
        """Wait for the first of the chunks that are being packed, and write it."""
        chunk, packed = self._packing.popleft()
        self._write_chunk(packed.result())
        self._rooms.append(chunk.room)

    def _write_chunk(self, chunk: PackedChunk) -> None:
        start = self._offset
        self._write(chunk.records)
        self._chunks.append(
            ChunkIndex(
                chunk_length=chunk.chunk_size,
                chunk_start_offset=start,
                compression="zstd",
                compressed_size=chunk.packed_size,
                message_end_time=chunk.last_ns,
                message_index_length=len(chunk.records) - chunk.chunk_size,
                message_index_offsets={channel: start + offset for channel, offset in chunk.offsets.items()},
                message_start_time=chunk.first_ns,
                uncompressed_size=chunk.unpacked_size,
            )
        )

    def add_attachment(self, name: str, t_ns: int, media_type: str, data: bytes) -> None:
        """A file inside the log; both of its times are simulated time."""
        if any(index.name == name for index in self._attachments):
            raise ValueError(f"the log has an attachment '{name}' already")
        start = self._offset
        record = Attachment(create_time=t_ns, log_time=t_ns, name=name, media_type=media_type, data=data)
        self._write(_bytes_of(record))
        self._attachments.append(AttachmentIndex(start, self._offset - start, t_ns, t_ns, len(data), name, media_type))

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """A record of names and texts, sorted by name."""
        start = self._offset
        self._write(_bytes_of(Metadata(name, dict(sorted(values.items())))))
        self._metadata.append(MetadataIndex(start, self._offset - start, name))

    def finish(self) -> None:
        """Write the rest and the summary, close, and give the file its final name."""
        self.flush()
        self._write(_bytes_of(DataEnd(self._crc)))
        start = self._offset
        groups = (
            (Opcode.SCHEMA, list(self._schemas.values())),
            (Opcode.CHANNEL, self._channels),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.ATTACHMENT_INDEX, self._attachments),
            (Opcode.METADATA_INDEX, self._metadata),
        )
        summary, offsets = b"", []
        for opcode, records in groups:
            data = b"".join(_bytes_of(record) for record in records)
            if data:
                offsets.append(SummaryOffset(opcode, start + len(summary), len(data)))
            summary += data
        offset_start = start + len(summary)
        summary += b"".join(_bytes_of(record) for record in offsets)
        # the summary's checksum covers the footer up to the checksum itself
        crc = crc32(_RECORD.pack(Opcode.FOOTER, 20) + struct.pack("<QQ", start, offset_start), crc32(summary))
        self._write(summary + _bytes_of(Footer(start, offset_start, crc)) + MAGIC)
        try:
            self.abandon()
            os.replace(self.part_path, self.path)
        except OSError as error:
            raise self._failure(error) from error

    @property
    def closed(self) -> bool:
        return self._file.closed

    def abandon(self) -> None:
        """Close the file as it is: the `.part` file keeps every record that was written."""
        self._packer.shutdown(cancel_futures=True)
        self._file.close()

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts={i: n for i, n in enumerate(self._counts.tolist()) if n},
            chunk_count=len(self._chunks),
            message_count=int(self._counts.sum()),
            message_end_time=max((chunk.message_end_time for chunk in self._chunks), default=0),
            message_start_time=min((chunk.message_start_time for chunk in self._chunks), default=0),
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )

    def _write(self, data: bytes) -> None:
        """Hand one or more whole records to the system; on failure cut the file back to whole records."""
        self._check_open()
        rest = memoryview(data)
        try:
            while rest:
                rest = rest[self._file.write(rest) or 0 :]
        except BaseException as error:  # an interrupt, too, may come after a part was written
            try:
                self._file.truncate(self._offset)
            finally:
                self.abandon()
            if isinstance(error, OSError):
                raise self._failure(error) from error
            raise
        self._crc = crc32(data, self._crc)
        self._offset += len(data)

    def _check_open(self) -> None:
        if self._file.closed:
            raise LogWriteError(errno.EBADF, "the log is closed already", str(self.part_path))

    def _failure(self, error: OSError) -> LogWriteError:
        return LogWriteError(error.errno, f"the log cannot be written: {error.strerror}", str(self.part_path))


def _hand_over(ordered: Ordered, channels: Sequence[int], sink: Sink) -> None:
    for item in ordered.each():
        if isinstance(item, RecordRows):
            sink.rows(item, channels)
        else:
            sink.message(item.channel, item.t_ns, item.data)


def _bytes_of(record: Any) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    data: bytes = builder.end()
    return data

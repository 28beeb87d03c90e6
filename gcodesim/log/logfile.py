"""A log on disk: what it holds and where, also when its end is missing.

A complete log is opened by its summary. From a log that was cut off (a killed
run, a full disk, a copy that stopped) everything up to the last whole chunk is
found by walking its records.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO, Final, NamedTuple

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)

from gcodesim.log.container import MAGIC
from gcodesim.log.rows import MESSAGE_OPCODE, RECORD_HEAD

_RECORD: Final = struct.Struct("<BQ")
_MESSAGE: Final = struct.Struct("<HIQQ")
_CHUNK: Final = struct.Struct("<QQQII")
_DAMAGE: Final = (struct.error, UnicodeDecodeError, EndOfFile)  # what reading a damaged record may raise
_FOOTER_SIZE: Final = RECORD_HEAD + 20 + len(MAGIC)


class LogReadError(Exception):
    """The file is no log, or a part of it that was asked for is damaged."""


class RawMessage(NamedTuple):
    """A message as stored."""

    channel: int
    sequence: int
    t_ns: int
    data: bytes


@dataclass(frozen=True, slots=True)
class ChunkPlace:
    """Where a chunk lies; `channels` is None when its index is not there to tell."""

    offset: int
    first_ns: int
    last_ns: int
    channels: frozenset[int] | None


@dataclass(slots=True)
class LogFile:
    """The contents of a log. `complete`: the file has its end; `problem` says what is wrong otherwise."""

    path: Path
    complete: bool = False
    problem: str = ""
    library: str = ""
    schemas: dict[int, Any] = field(default_factory=dict)
    channels: dict[int, Any] = field(default_factory=dict)
    chunks: list[ChunkPlace] = field(default_factory=list)
    metadata: dict[str, Mapping[str, str]] = field(default_factory=dict)
    attachments: dict[str, tuple[int, int]] = field(default_factory=dict)  # name: offset of the record, data size
    counts: dict[int, int] = field(default_factory=dict)  # messages by channel
    size: int = 0  # of the file
    whole: int = 0  # bytes in whole records; less than `size` in a file that was cut off

    @staticmethod
    def open(path: Path) -> LogFile:
        """Read what there is. When `path` is missing, `path` + `.part` is taken, the log of a run that did not end.

        OSError when neither can be read, LogReadError when it is no MCAP file.
        """
        part = path.with_name(path.name + ".part")
        log = LogFile(part if part.exists() and not path.exists() else path)
        with log.path.open("rb") as stream:
            head = stream.read(len(MAGIC))
            if head != MAGIC and not (log.path == part and MAGIC.startswith(head)):
                raise LogReadError(f"{log.path.name} is no log: it does not begin like an MCAP file")
            try:
                if log._read_summary(stream):
                    return log
            except _DAMAGE:
                log.problem = "the index at the end of the file is damaged"
            log = LogFile(log.path, problem=log.problem or "the file ends before its index")
            with suppress(*_DAMAGE):
                log._walk(stream)
        return log

    @property
    def end_ns(self) -> int:
        return max((chunk.last_ns for chunk in self.chunks), default=0)

    def channel_id(self, topic: str) -> int | None:
        return next((i for i, channel in self.channels.items() if channel.topic == topic), None)

    def schema_name(self, channel: int) -> str:
        """The schema of a channel, empty when it has none."""
        schema = self.schemas.get(self.channels[channel].schema_id)
        return schema.name if schema is not None else ""

    def messages(
        self,
        channels: Collection[int] | None = None,
        *,
        first_ns: int = 0,
        last_ns: int | None = None,
        backwards: bool = False,
    ) -> Iterator[RawMessage]:
        """Messages in the order of the file, of some channels or all, in a span of time.

        LogReadError when a chunk does not agree with its checksum.
        """
        wanted = None if channels is None else frozenset(channels)
        with self.path.open("rb") as stream:
            for chunk in reversed(self.chunks) if backwards else self.chunks:
                if chunk.last_ns < first_ns or (last_ns is not None and chunk.first_ns > last_ns):
                    continue
                if wanted is not None and chunk.channels is not None and wanted.isdisjoint(chunk.channels):
                    continue
                found = _chunk_messages(_read_chunk(stream, chunk.offset), wanted)
                for message in reversed(list(found)) if backwards else found:
                    if message.t_ns >= first_ns and (last_ns is None or message.t_ns <= last_ns):
                        yield message

    def attachment(self, name: str) -> bytes:
        """The contents of an attached file. KeyError when there is none."""
        offset, _ = self.attachments[name]
        with self.path.open("rb") as stream:
            return bytes(Attachment.read(_record_at(stream, offset)).data)

    # ---- a file with its end

    def _read_summary(self, stream: BinaryIO) -> bool:
        """Fill in from the summary; False when the file has none or it is damaged."""
        size = stream.seek(0, 2)
        if size < _FOOTER_SIZE + len(MAGIC):
            return False
        self.size = self.whole = size
        stream.seek(size - _FOOTER_SIZE)
        tail = stream.read(_FOOTER_SIZE)
        if tail[-len(MAGIC) :] != MAGIC or tail[0] != Opcode.FOOTER:
            return False
        footer = Footer.read(_stream_of(tail[RECORD_HEAD:]))
        if not len(MAGIC) <= footer.summary_start < size - _FOOTER_SIZE:
            return False
        stream.seek(footer.summary_start)
        summary = stream.read(size - _FOOTER_SIZE - footer.summary_start)
        covered = summary + tail[: RECORD_HEAD + 16]
        if footer.summary_crc and zlib.crc32(covered) != footer.summary_crc:
            self.problem = "the index at the end of the file is damaged"
            return False
        metadata = []
        for opcode, record in _records_of(summary):
            match opcode:
                case Opcode.SCHEMA | Opcode.CHANNEL:
                    self._take_definition(opcode, record)
                case Opcode.CHUNK_INDEX:
                    index = ChunkIndex.read(record)
                    channels = frozenset(index.message_index_offsets) if index.message_index_length else None
                    self.chunks.append(
                        ChunkPlace(index.chunk_start_offset, index.message_start_time, index.message_end_time, channels)
                    )
                case Opcode.STATISTICS:
                    self.counts = dict(Statistics.read(record).channel_message_counts)
                case Opcode.ATTACHMENT_INDEX:
                    attached = AttachmentIndex.read(record)
                    self.attachments[attached.name] = (attached.offset, attached.data_size)
                case Opcode.METADATA_INDEX:
                    metadata.append(MetadataIndex.read(record).offset)
        for offset in metadata:
            self._take_metadata(_record_at(stream, offset))
        self.library = Header.read(_record_at(stream, len(MAGIC))).library
        self.complete = True
        return True

    # ---- a file without

    def _walk(self, stream: BinaryIO) -> None:
        """Fill in record by record up to the first that is not whole."""
        self.size = size = stream.seek(0, 2)
        self.whole = at = len(MAGIC)
        while at + RECORD_HEAD <= size:
            stream.seek(at)
            opcode, length = _RECORD.unpack(stream.read(RECORD_HEAD))
            if at + RECORD_HEAD + length > size:
                break
            match opcode:
                case Opcode.DATA_END:  # what follows is the index, not all of it
                    self.whole = at + RECORD_HEAD + length
                    break
                case Opcode.HEADER:
                    self.library = Header.read(_stream_of(stream.read(length))).library
                case Opcode.SCHEMA | Opcode.CHANNEL:
                    self._take_definition(opcode, _stream_of(stream.read(length)))
                case Opcode.METADATA:
                    self._take_metadata(_stream_of(stream.read(length)))
                case Opcode.ATTACHMENT:
                    attached = Attachment.read(_stream_of(stream.read(length)))
                    self.attachments[attached.name] = (at, len(attached.data))
                case Opcode.CHUNK:
                    try:
                        messages = list(_chunk_messages(_read_chunk(stream, at), None))
                    except LogReadError as error:
                        self.problem = str(error)
                        break
                    self._take_chunk(at, messages)
            self.whole = at = at + RECORD_HEAD + length

    def _take_chunk(self, offset: int, messages: list[RawMessage]) -> None:
        for message in messages:
            self.counts[message.channel] = self.counts.get(message.channel, 0) + 1
        channels = frozenset(message.channel for message in messages)
        if messages:
            self.chunks.append(ChunkPlace(offset, messages[0].t_ns, messages[-1].t_ns, channels))

    def _take_definition(self, opcode: int, record: Any) -> None:
        if opcode == Opcode.SCHEMA:
            schema = Schema.read(record)
            self.schemas[schema.id] = schema
        else:
            channel = Channel.read(record)
            self.channels[channel.id] = channel

    def _take_metadata(self, record: Any) -> None:
        found = Metadata.read(record)
        self.metadata[found.name] = found.metadata


def _stream_of(data: bytes) -> Any:
    return ReadDataStream(BytesIO(data))


def _record_at(stream: BinaryIO, offset: int) -> Any:
    """The contents of the record at `offset`."""
    stream.seek(offset)
    _, length = _RECORD.unpack(stream.read(RECORD_HEAD))
    return _stream_of(stream.read(length))


def _records_of(data: bytes) -> Iterator[tuple[int, Any]]:
    at = 0
    while at < len(data):
        opcode, length = _RECORD.unpack_from(data, at)
        yield opcode, _stream_of(data[at + RECORD_HEAD : at + RECORD_HEAD + length])
        at += RECORD_HEAD + length


def _read_chunk(stream: BinaryIO, offset: int) -> bytes:
    """The records of the chunk at `offset`, unpacked and checked."""
    stream.seek(offset)
    _, length = _RECORD.unpack(stream.read(RECORD_HEAD))
    body = stream.read(length)
    try:
        first_ns, _, size, crc, name_length = _CHUNK.unpack_from(body)
        start = _CHUNK.size + name_length
        compression = body[_CHUNK.size : start].decode()
        packed = body[start + 8 :]
        if compression not in ("", "zstd"):
            raise LogReadError(f"a chunk is packed with {compression}, which gcodesim does not write")
        records = zstandard.ZstdDecompressor().decompress(packed, max_output_size=size) if compression else packed
    except (struct.error, UnicodeDecodeError, zstandard.ZstdError) as error:
        raise LogReadError(f"a chunk at byte {offset} is damaged") from error
    if len(records) != size or (crc and zlib.crc32(records) != crc):
        raise LogReadError(f"the chunk at {first_ns * 1e-9:.3f} s does not agree with its checksum")
    return records


def _chunk_messages(records: bytes, channels: frozenset[int] | None) -> Iterator[RawMessage]:
    at, end = 0, len(records)
    while at < end:
        opcode, length = _RECORD.unpack_from(records, at)
        start = at + RECORD_HEAD
        at = start + length
        if opcode == MESSAGE_OPCODE:
            id, sequence, t_ns, _ = _MESSAGE.unpack_from(records, start)
            if channels is None or id in channels:
                yield RawMessage(id, sequence, t_ns, records[start + _MESSAGE.size : at])

"""A log on disk: what it contains and where, even when its end is missing.

A complete log is opened by its summary. From a log that was cut off (a killed
run, a full disk, a copy that stopped) everything up to the last whole chunk is
found by walking its records. A chunk that is damaged costs its own messages only.
"""

from __future__ import annotations

import zlib
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, BinaryIO, Final

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

from gcodesim.frozen import frozen
from gcodesim.log.container import MAGIC
from gcodesim.log.damage import Damage
from gcodesim.log.rows import RECORD_HEAD
from gcodesim.log.stored import (
    DAMAGE,
    RECORD,
    LogReadError,
    RawMessage,
    messages_in,
    read_chunk,
    record_at,
    records_of,
    stream_of,
)

__all__ = ["ChunkPlace", "LogFile", "LogReadError", "RawMessage"]

_FOOTER_SIZE: Final = RECORD_HEAD + 20 + len(MAGIC)
_DATA_END_SIZE: Final = RECORD_HEAD + 4
_BLOCK: Final = 1 << 20
_PRIVATE: Final = 0x80  # opcodes from here on are free for private use


@frozen(kw_only=False)
class ChunkPlace:
    """Where a chunk is; `channels` is None if its index is missing."""

    offset: int
    first_ns: int
    last_ns: int
    channels: frozenset[int] | None


@dataclass(slots=True)
class LogFile:
    """The contents of a log. `complete`: the file has its end; `problem` says what is wrong otherwise.

    `lenient`: damaged parts are left out and noted in `damage`; otherwise reading them raises.
    """

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
    data_end: int = 0  # where the records before the index end, in a complete file
    whole: int = 0  # bytes in whole records; less than `size` in a file that was cut off
    lenient: bool = False
    damage: list[Damage] = field(default_factory=list)  # as far as it was found, in the order of the file

    @staticmethod
    def open(path: Path, *, lenient: bool = False) -> LogFile:
        """Read what there is. If `path` is missing, `path` + `.part` is read, the log of a run that did not end.

        OSError when neither can be read, LogReadError when it is no MCAP file.
        """
        part = path.with_name(path.name + ".part")
        log = LogFile(part if part.exists() and not path.exists() else path, lenient=lenient)
        with log.path.open("rb") as stream:
            head = stream.read(len(MAGIC))
            if head != MAGIC and not (log.path == part and MAGIC.startswith(head)):
                raise LogReadError(f"{log.path.name} is no log: it does not begin like an MCAP file")
            try:
                if log._read_summary(stream):
                    return log
            except DAMAGE:
                log.problem = "the index at the end of the file is damaged"
            log = LogFile(log.path, problem=log.problem or "the file ends before its index", lenient=lenient)
            with suppress(*DAMAGE):
                log._walk(stream)
            log._settle_times()
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

        LogReadError when a chunk does not agree with its checksum, but for a lenient log.
        """
        wanted = None if channels is None else frozenset(channels)
        with self.path.open("rb") as stream:
            for chunk in reversed(self.chunks) if backwards else self.chunks:
                if chunk.last_ns < first_ns or (last_ns is not None and chunk.first_ns > last_ns):
                    continue
                if wanted is not None and chunk.channels is not None and wanted.isdisjoint(chunk.channels):
                    continue
                try:
                    found = list(messages_in(read_chunk(stream, chunk.offset), wanted))
                except LogReadError as error:
                    self._note_chunk(chunk, error)
                    if not self.lenient:
                        raise LogReadError(str(self.damage_at(chunk.offset))) from error
                    continue
                for message in reversed(found) if backwards else found:
                    if message.t_ns >= first_ns and (last_ns is None or message.t_ns <= last_ns):
                        yield message

    def attachment(self, name: str) -> bytes:
        """The contents of an attached file. KeyError if it does not exist, LogReadError if it is damaged."""
        offset, size = self.attachments[name]
        with suppress(*DAMAGE), self.path.open("rb") as stream:
            record = record_at(stream, offset, Opcode.ATTACHMENT)
            attached, crc = Attachment.read(stream_of(record)), int.from_bytes(record[-4:], "little")
            if attached.name == name and len(attached.data) == size and crc in (0, zlib.crc32(record[:-4])):
                return bytes(attached.data)
        raise LogReadError(f"the attached file {name} is damaged")

    def attached(self, name: str) -> bytes | None:
        """The same for a lenient log: None if it does not exist, or if it is damaged, which is noted."""
        if name not in self.attachments:
            return None
        try:
            return self.attachment(name)
        except LogReadError:
            self._note(Damage(offset=self.attachments[name][0], what=name, reason="is damaged"))
            return None

    def check(self) -> None:
        """Read the whole file once and note all that is damaged in it.

        One checksum covers a complete file, so each chunk is looked at only when that does not agree.
        """
        with self.path.open("rb") as stream:
            if self.complete and self._agrees(stream):
                return
            for chunk in self.chunks:
                try:
                    for _ in messages_in(read_chunk(stream, chunk.offset), frozenset()):
                        pass
                except LogReadError as error:
                    self._note_chunk(chunk, error)
        for name in self.attachments:
            self.attached(name)
        if self.complete and not self.damage and self.library.startswith("gcodesim"):
            self._note(Damage(offset=len(MAGIC), what="record", reason="does not agree with the checksum of the file"))

    def _agrees(self, stream: BinaryIO) -> bool:
        """Whether the records before the index have the checksum given at their end; False if none is given."""
        stream.seek(self.data_end)
        end = stream.read(_DATA_END_SIZE)
        crc = int.from_bytes(end[RECORD_HEAD:], "little")
        if end[:1] != bytes([Opcode.DATA_END]) or not crc:
            return False
        stream.seek(0)
        left, found = self.data_end, 0
        while left and (block := stream.read(min(_BLOCK, left))):
            left -= len(block)
            found = zlib.crc32(block, found)
        return not left and found == crc

    def _note_chunk(self, chunk: ChunkPlace, error: LogReadError) -> None:
        self._note(
            Damage(offset=chunk.offset, what="chunk", reason=str(error), first_ns=chunk.first_ns, last_ns=chunk.last_ns)
        )

    def damage_at(self, offset: int) -> Damage | None:
        """What is known to be wrong with the record at `offset`."""
        return next((damage for damage in self.damage if damage.offset == offset), None)

    def _note(self, damage: Damage) -> None:
        if self.damage_at(damage.offset) is None:
            self.damage.append(damage)
            self.damage.sort(key=lambda known: known.offset)

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
        footer = Footer.read(stream_of(tail[RECORD_HEAD:]))
        if not len(MAGIC) <= footer.summary_start < size - _FOOTER_SIZE:
            return False
        self.data_end = footer.summary_start - _DATA_END_SIZE
        stream.seek(footer.summary_start)
        summary = stream.read(size - _FOOTER_SIZE - footer.summary_start)
        covered = summary + tail[: RECORD_HEAD + 16]
        if footer.summary_crc and zlib.crc32(covered) != footer.summary_crc:
            self.problem = "the index at the end of the file is damaged"
            return False
        metadata = []
        for opcode, record in records_of(summary):
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
            try:
                self._take_metadata(stream_of(record_at(stream, offset, Opcode.METADATA)))
            except DAMAGE:
                self._note(Damage(offset=offset, what="record", reason="is damaged"))
        with suppress(*DAMAGE):
            self.library = Header.read(stream_of(record_at(stream, len(MAGIC), Opcode.HEADER))).library
        self.complete = True
        return True

    # ---- a file without

    def _walk(self, stream: BinaryIO) -> None:
        """Fill in record by record up to the first that is not whole."""
        self.size = size = stream.seek(0, 2)
        at = len(MAGIC)
        self.whole = min(at, size)  # a run may be killed before its first byte is written
        while at + RECORD_HEAD <= size:
            stream.seek(at)
            opcode, length = RECORD.unpack(stream.read(RECORD_HEAD))
            if at + RECORD_HEAD + length > size:
                break
            if not opcode or Opcode.DATA_END < opcode < _PRIVATE:
                self.problem = f"the file is damaged from byte {at} on, and its index is not there"
                break
            match opcode:
                case Opcode.DATA_END:  # what follows is the index, not all of it
                    self.whole = at + RECORD_HEAD + length
                    break
                case Opcode.HEADER:
                    self.library = Header.read(stream_of(stream.read(length))).library
                case Opcode.SCHEMA | Opcode.CHANNEL:
                    self._take_definition(opcode, stream_of(stream.read(length)))
                case Opcode.METADATA:
                    self._take_metadata(stream_of(stream.read(length)))
                case Opcode.ATTACHMENT:
                    attached = Attachment.read(stream_of(stream.read(length)))
                    self.attachments[attached.name] = (at, len(attached.data))
                case Opcode.CHUNK:
                    try:
                        messages = list(messages_in(read_chunk(stream, at), None))
                    except LogReadError as error:
                        self._note_chunk(place := ChunkPlace(at, self.end_ns, self.end_ns, None), error)
                        self.chunks.append(place)
                    else:
                        self._take_chunk(at, messages)
            self.whole = at = at + RECORD_HEAD + length

    def _take_chunk(self, offset: int, messages: list[RawMessage]) -> None:
        for message in messages:
            self.counts[message.channel] = self.counts.get(message.channel, 0) + 1
        channels = frozenset(message.channel for message in messages)
        if messages:
            self.chunks.append(ChunkPlace(offset, messages[0].t_ns, messages[-1].t_ns, channels))

    def _settle_times(self) -> None:
        """Give a damaged chunk the times between its neighbours, because its own times may be damaged too."""
        after = self.end_ns
        damaged = {damage.offset: i for i, damage in enumerate(self.damage)}
        for i, chunk in reversed(list(enumerate(self.chunks))):
            if chunk.offset in damaged:
                self.chunks[i] = replace(chunk, last_ns=after)
                at = damaged[chunk.offset]
                self.damage[at] = replace(self.damage[at], last_ns=after)
            else:
                after = chunk.first_ns

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

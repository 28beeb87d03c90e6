"""Records of a log as they are stored: found, bounded, unpacked and checked, whatever the bytes are."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import Any, BinaryIO, Final, NamedTuple

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode

from gcodesim.log.rows import MESSAGE_OPCODE, RECORD_HEAD

RECORD: Final = struct.Struct("<BQ")
DAMAGE: Final = (struct.error, UnicodeDecodeError, EndOfFile)
"""What reading the contents of a damaged record may raise."""

LARGEST_CHUNK: Final = 1 << 30
"""A chunk that claims to be larger than this unpacked is damaged; ours have little more than a megabyte."""

_MESSAGE: Final = struct.Struct("<BQHIQQ")  # with the head of its record
_CHUNK: Final = struct.Struct("<QQQII")


class LogReadError(Exception):
    """The file is not a log, or a requested part of it is damaged."""


class RawMessage(NamedTuple):
    """A message as stored."""

    channel: int
    sequence: int
    t_ns: int
    data: bytes


def stream_of(data: bytes) -> Any:
    return ReadDataStream(BytesIO(data))


def record_at(stream: BinaryIO, offset: int, opcode: int) -> bytes:
    """The contents of the record at `offset`; struct.error if there is no complete one of that kind."""
    size = stream.seek(0, 2)
    stream.seek(offset)
    found, length = RECORD.unpack(stream.read(RECORD_HEAD))
    if found != opcode or offset + RECORD_HEAD + length > size:
        raise struct.error("no whole record")
    return stream.read(length)


def records_of(data: bytes) -> Iterator[tuple[int, Any]]:
    at = 0
    while at < len(data):
        opcode, length = RECORD.unpack_from(data, at)
        yield opcode, stream_of(data[at + RECORD_HEAD : at + RECORD_HEAD + length])
        at += RECORD_HEAD + length


def read_chunk(stream: BinaryIO, offset: int) -> bytes:
    """The records of the chunk at `offset`, unpacked and checked. LogReadError says what is wrong with it."""
    try:
        body = record_at(stream, offset, Opcode.CHUNK)
        _, _, size, crc, name_length = _CHUNK.unpack_from(body)
        start = _CHUNK.size + name_length
        compression = body[_CHUNK.size : start].decode()
        packed = body[start + 8 :]
        if compression == "lz4":
            raise LogReadError("is packed with lz4, which gcodesim does not write")
        if compression not in ("", "zstd") or size > LARGEST_CHUNK:
            raise LogReadError("is damaged")
        if compression and zstandard.frame_content_size(packed) > size:
            raise LogReadError("is damaged")
        records = zstandard.ZstdDecompressor().decompress(packed, max_output_size=size) if compression else packed
    except (struct.error, UnicodeDecodeError, zstandard.ZstdError) as error:
        raise LogReadError("is damaged") from error
    if len(records) != size or (crc and zlib.crc32(records) != crc):
        raise LogReadError("does not agree with its checksum")
    return records


def messages_in(records: bytes, channels: frozenset[int] | None) -> Iterator[RawMessage]:
    """The messages among the records of a chunk, of some channels or all. LogReadError if they are not complete."""
    at, end = 0, len(records)
    opened = end - _MESSAGE.size  # the last place where a message may begin
    while at < end:
        if at <= opened:
            opcode, length, channel, sequence, t_ns, _ = _MESSAGE.unpack_from(records, at)
        else:
            opcode, length = RECORD.unpack(records[at : at + RECORD_HEAD].ljust(RECORD_HEAD, b"\xff"))
        start = at + _MESSAGE.size
        at += RECORD_HEAD + length
        if at > end or (opcode == MESSAGE_OPCODE and start > at):  # only where nothing was checked: ours has a checksum
            raise LogReadError("ends within a record")
        if opcode == MESSAGE_OPCODE and (channels is None or channel in channels):
            yield RawMessage(channel, sequence, t_ns, records[start:at])

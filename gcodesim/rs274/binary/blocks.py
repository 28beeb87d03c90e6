"""The blocks of a binary file: header, checksum, and the data as they were before they were compressed."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import Final

import numpy as np

from gcodesim.frozen import frozen
from gcodesim.rs274.binary.heatshrink_kernels import expand

FILE_METADATA, GCODE, SLICER_METADATA, PRINTER_METADATA, PRINT_METADATA, THUMBNAIL = range(6)
NAMES: Final = ("file metadata", "G-code", "slicer metadata", "printer metadata", "print metadata", "thumbnail")

LARGEST: Final = 2_000_000_000
"""Bytes that a file may become, as many as a file that a cell names may have: few bytes can stand for very many."""

_VERSION: Final = 1
_NONE, _DEFLATE, _HEATSHRINK_11, _HEATSHRINK_12 = range(4)
_WINDOWS: Final = {_HEATSHRINK_11: 11, _HEATSHRINK_12: 12}
_LOOK_AHEAD: Final = 4
_MOST_OF_A_BYTE: Final = {_NONE: 1, _DEFLATE: 1032, _HEATSHRINK_11: 8, _HEATSHRINK_12: 8}
"""Bytes that one compressed byte can stand for: deflate by zlib's own statement, heatshrink 16 for 16 bits."""

_HEADER: Final = struct.Struct("<4sIH")
_BLOCK: Final = struct.Struct("<HHI")
_SIZE: Final = struct.Struct("<I")
_ENCODING: Final = struct.Struct("<H")
_THUMBNAIL: Final = struct.Struct("<HHH")


class BinaryReadError(Exception):
    """Why a binary file cannot be read."""


@frozen
class BinaryBlock:
    """One block: `kind` is an index of `NAMES`, `parameters` its encoding, or format, width and height of a picture.

    `data` is compressed as `compression` says, and has `size` bytes once it is not.
    """

    place: str
    kind: int
    parameters: tuple[int, ...]
    compression: int
    size: int
    data: memoryview

    def expanded(self) -> bytes:
        """The data as they were before they were compressed; raises `BinaryReadError`."""
        if self.compression == _NONE:
            return bytes(self.data)
        whole = _inflated(self.data, self.size) if self.compression == _DEFLATE else self._unshrunk()
        if whole is None:
            raise BinaryReadError(f"the data of {self.place} are damaged: they do not expand to {self.size} bytes")
        return whole

    def _unshrunk(self) -> bytes | None:
        out = np.empty(self.size, dtype=np.uint8)
        packed = np.frombuffer(self.data, dtype=np.uint8)
        return out.tobytes() if expand(packed, out, _WINDOWS[self.compression], _LOOK_AHEAD) else None


def blocks_of(raw: bytes) -> Iterator[BinaryBlock]:
    """The blocks of a file in their order, each with a right checksum; raises `BinaryReadError`."""
    if len(raw) < _HEADER.size:
        raise BinaryReadError("the file ends in its header")
    _, version, checksum = _HEADER.unpack_from(raw)
    if version != _VERSION:
        raise BinaryReadError(f"it is of version {version}, and version {_VERSION} is the only known one")
    if checksum > 1:
        raise BinaryReadError(f"its checksums are of kind {checksum}, and only 0 (none) and 1 (CRC32) are known")
    view, at, number, total = memoryview(raw), _HEADER.size, 0, 0
    while at < len(raw):
        number += 1
        block, end = _block_at(view, at, number)
        if checksum:
            if end + _SIZE.size > len(raw):
                raise BinaryReadError(f"the file ends in {block.place}")
            (told,) = _SIZE.unpack_from(raw, end)
            if zlib.crc32(view[at:end]) != told:
                raise BinaryReadError(f"the checksum of {block.place} is wrong: the file is damaged")
            end += _SIZE.size
        total += block.size
        if total > LARGEST:
            raise BinaryReadError(f"it says that it becomes larger than {LARGEST / 1e9:g} GB")
        yield block
        at = end


def _block_at(view: memoryview, at: int, number: int) -> tuple[BinaryBlock, int]:
    """The block at offset `at` without its checksum, and the offset behind it."""
    place = f"block {number} at byte {at}"
    if at + _BLOCK.size > len(view):
        raise BinaryReadError(f"the file ends in {place}")
    kind, compression, size = _BLOCK.unpack_from(view, at)
    if kind >= len(NAMES):
        raise BinaryReadError(f"{place} is of kind {kind}, which is unknown: it is damaged, or of a newer version")
    place = f"block {number} ({NAMES[kind]}) at byte {at}"
    cut = BinaryReadError(f"the file ends in {place}")
    if compression not in _MOST_OF_A_BYTE:
        raise BinaryReadError(f"{place} is compressed in way {compression}, which is unknown")
    begin, stored = at + _BLOCK.size, size
    shape = _THUMBNAIL if kind == THUMBNAIL else _ENCODING
    if begin + (_SIZE.size if compression else 0) + shape.size > len(view):
        raise cut
    if compression:
        (stored,) = _SIZE.unpack_from(view, begin)
        begin += _SIZE.size
    if size > _MOST_OF_A_BYTE[compression] * stored:
        raise BinaryReadError(f"{place} says that {stored} bytes expand to {size}, which they cannot")
    data = begin + shape.size
    if data + stored > len(view):
        raise cut
    parameters = shape.unpack_from(view, begin)
    return BinaryBlock(
        place=place,
        kind=kind,
        parameters=parameters,
        compression=compression,
        size=size,
        data=view[data : data + stored],
    ), data + stored


def _inflated(data: memoryview, size: int) -> bytes | None:
    """What zlib makes of `data`, None unless that are `size` bytes."""
    stream = zlib.decompressobj()
    try:
        out = stream.decompress(data, size + 1)
    except zlib.error:
        return None
    return out if len(out) == size and stream.eof else None

"""Binary G-code made from text, as a slicer makes it: the other way than gcodesim reads it, and none of its code."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable

NONE, DEFLATE, HEATSHRINK_11, HEATSHRINK_12 = range(4)
PLAIN, MEATPACK, MEATPACK_WITH_COMMENTS = range(3)
FILE_METADATA, GCODE, SLICER_METADATA, PRINTER_METADATA, PRINT_METADATA, THUMBNAIL = range(6)

_PACKED = "0123456789.E\nGX"  # without blanks, E has the place of the blank


def file_of(text: str, *, checksum: int = 1, compression: int = HEATSHRINK_12, encoding: int = MEATPACK) -> bytes:
    """A file with a little metadata, a thumbnail and `text`, which is cut between lines into blocks."""
    blocks = [
        block(FILE_METADATA, b"Producer=gcodesim tests\n", NONE, checksum),
        block(PRINTER_METADATA, b"nozzle_diameter=0.4\n", NONE, checksum),
        block(THUMBNAIL, bytes(range(256)), NONE, checksum, parameters=(0, 16, 16)),
        block(PRINT_METADATA, b"filament used [mm]=12.3\n", compression, checksum),
        block(SLICER_METADATA, b"layer_height=0.2\nnotes=a = b\n", compression, checksum),
    ]
    lines = text.splitlines(keepends=True)
    for at in range(0, len(lines), 400):
        data = encoded("".join(lines[at : at + 400]), encoding)
        blocks.append(block(GCODE, data, compression, checksum, parameters=(encoding,)))
    return header(checksum=checksum) + b"".join(blocks)


def header(*, version: int = 1, checksum: int = 1) -> bytes:
    return b"GCDE" + struct.pack("<IH", version, checksum)


def block(
    kind: int,
    data: bytes,
    compression: int,
    checksum: int,
    *,
    parameters: tuple[int, ...] = (0,),
    size: int | None = None,
) -> bytes:
    """One block; `size` is what it says of its data before compression, when that is not true."""
    size = len(data) if size is None else size
    stored = compressed(data, compression)
    made = struct.pack("<HHI", kind, compression, size)
    if compression != NONE:
        made += struct.pack("<I", len(stored))
    made += struct.pack(f"<{len(parameters)}H", *parameters) + stored
    return made + (struct.pack("<I", zlib.crc32(made)) if checksum else b"")


def compressed(data: bytes, compression: int) -> bytes:
    if compression == NONE:
        return data
    return zlib.compress(data) if compression == DEFLATE else shrunk(data, 11 if compression == HEATSHRINK_11 else 12)


def shrunk(data: bytes, window: int, look_ahead: int = 4) -> bytes:
    """Heatshrink: the last place with the same three bytes is repeated, as far as it is alike."""
    bits: list[str] = []
    seen: dict[bytes, int] = {}
    at = 0
    while at < len(data):
        before, count = seen.get(data[at : at + 3]), 0
        if before is not None and at - before <= 1 << window:
            while count < 1 << look_ahead and at + count < len(data) and data[before + count] == data[at + count]:
                count += 1
        if count >= 3:
            assert before is not None
            bits.append(f"0{at - before - 1:0{window}b}{count - 1:0{look_ahead}b}")
        else:
            bits.append(f"1{data[at]:08b}")
            count = 1
        for k in range(at, at + count):
            seen[data[k : k + 3]] = k
        at += count
    whole = "".join(bits)
    whole += "0" * (-len(whole) % 8)
    return bytes(int(whole[k : k + 8], 2) for k in range(0, len(whole), 8))


def encoded(text: str, encoding: int) -> bytes:
    """The lines as they stand, or with MeatPack, which drops empty lines, and comments unless it keeps their lines."""
    if encoding == PLAIN:
        return text.encode()
    out = bytearray(b"\xff\xff\xfb\xff\xff\xf7")  # packing is switched on, and blanks are left out
    packing = True
    for line in text.splitlines():
        if line.startswith(";"):
            if encoding == MEATPACK_WITH_COMMENTS:
                out += (b"\xff\xff\xfa" if packing else b"") + line.encode() + b"\n"
                packing = False
            continue
        words = line.partition(";")[0].strip()
        if not words:
            continue
        if not packing:
            out += b"\xff\xff\xfb"
            packing = True
        out += bytes(_packed((words.replace(" ", "") if words.startswith("G") else words) + "\n"))
    return bytes(out)


def _packed(line: str) -> Iterable[int]:
    if len(line) % 2:
        line += "\n"
    for first, second in zip(line[::2], line[1::2], strict=True):
        low, high = (_PACKED.find(one) if one in _PACKED else 15 for one in (first, second))
        yield low | high << 4
        yield from (ord(one) for one, code in ((first, low), (second, high)) if code == 15)

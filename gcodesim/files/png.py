"""Grey pictures as PNG (ISO/IEC 15948), 8 or 16 bits a point."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

SIGNATURE = b"\x89PNG\r\n\x1a\n"
SOFTWARE = b"Software\0gcodesim"
"""Text behind the header, so that a file of ours is known; it stands at byte `SOFTWARE_AT`."""
SOFTWARE_AT = 41


def grey_png(points: NDArray[np.uint8], comment: str = "") -> bytes:
    """A picture with rows (h, w) from the top; `comment` goes with it as text (Latin-1)."""
    return _grey(points, points.shape[1], 8, comment)


def deep_grey_png(points: NDArray[np.uint16], comment: str = "") -> bytes:
    """The same with 16 bits a point."""
    import numpy as np

    height, width = points.shape
    content = np.ascontiguousarray(points, dtype=">u2").view(np.uint8).reshape(height, 2 * width)
    return _grey(content, width, 16, comment)


def _grey(content: NDArray[np.uint8], width: int, bits: int, comment: str) -> bytes:
    """A picture of `width` points from the bytes of its rows."""
    import numpy as np

    height = len(content)
    rows = np.zeros((height, content.shape[1] + 1), dtype=np.uint8)  # each begins with the number of its filter: none
    rows[:, 1:] = content
    text = png_chunk(b"tEXt", SOFTWARE)
    if comment:
        text += png_chunk(b"tEXt", b"Comment\0" + comment.encode("latin-1", "replace"))
    return b"".join(
        (
            SIGNATURE,
            png_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)),
            text,
            png_chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)),
            png_chunk(b"IEND", b""),
        )
    )


def png_chunk(kind: bytes, content: bytes) -> bytes:
    """A chunk of a file, with its length and checksum."""
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

"""Pictures as PNG files (W3C PNG specification, third edition); the same pixels give the same bytes."""

from __future__ import annotations

import struct
import zlib
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.files.png import SIGNATURE, SOFTWARE, png_chunk

_COLOR_TYPES: Final = {1: 0, 3: 2}
_UP: Final = 2
"""The filter of every row: how much it differs from the row above, since much of a picture of bodies is even."""


def png_of(pixels: NDArray[np.uint8 | np.uint16]) -> bytes:
    """A picture (h, w, 3), or one of greys (h, w) with 8 or 16 bits, as a file."""
    height, width = pixels.shape[:2]
    depth = pixels.dtype.itemsize
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    rows = np.ascontiguousarray(pixels, dtype=pixels.dtype.newbyteorder(">")).view(np.uint8).reshape(height, -1)
    above = np.vstack([np.zeros((1, rows.shape[1]), dtype=np.uint8), rows[:-1]])
    lines = np.empty((height, rows.shape[1] + 1), dtype=np.uint8)
    lines[:, 0] = _UP
    lines[:, 1:] = rows - above  # modulo 256, as the filter wants it
    head = struct.pack(">IIBBBBB", width, height, 8 * depth, _COLOR_TYPES[channels], 0, 0, 0)
    data = zlib.compress(lines.tobytes(), 6)
    chunks = ((b"IHDR", head), (b"tEXt", SOFTWARE), (b"IDAT", data), (b"IEND", b""))
    return SIGNATURE + b"".join(png_chunk(kind, content) for kind, content in chunks)

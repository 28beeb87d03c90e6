"""CRC-32 of what goes into a log, the same as zlib's: where the package `isal` is there, in a twentieth of the time."""

from __future__ import annotations

try:
    from isal.isal_zlib import crc32
except ImportError:  # on processors for which it has no wheel
    from zlib import crc32

__all__ = ["crc32"]
